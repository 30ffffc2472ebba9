//! Moving objects against the same objects built where they are at a time, in f64.

use super::support::{direction, icosphere, in_cube, random_map, signed, solid};
use crate::math::robust::offset_origin;
use crate::math::stats::Pcg;
use crate::render::geometry::{GeomObject, Geometry, MeshData};
use crate::render::motion::Motion;
use crate::render::ray::{PrimRef, Ray};
use crate::render::shape::{Shape, Solid};
use glam::{DAffine3, DQuat, DVec3, Vec3};

/// From where an object was compiled to where it is: moves within 2, of two thirds also small turns and stretches.
fn random_motion(rng: &mut Pcg) -> Motion {
    let keys = 2 + rng.next_u32() % 4;
    let turns = f64::from(u8::from(!rng.next_u32().is_multiple_of(3)));
    let mut key = |_| {
        let axis = direction(rng).as_dvec3().normalize();
        let turn = DQuat::from_axis_angle(axis, signed(rng) * 0.8 * turns);
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(1.0 + 0.3 * signed(rng) * turns),
            turn,
            in_cube(rng) * 2.0,
        )
    };
    Motion::new((0..keys).map(&mut key).collect()).expect("it moves")
}

/// An object of a kind, where it is compiled; kinds 0 to 10 are solids, then spheres, planes and a mesh.
fn shape(kind: usize, rng: &mut Pcg) -> Shape {
    match kind % 14 {
        11 => Shape::Sphere {
            center: in_cube(rng) * 3.0,
            radius: 0.2 + rng.next_f64(),
        },
        12 => Shape::Plane {
            normal: direction(rng).as_dvec3().normalize(),
            distance: 4.0 + 3.0 * rng.next_f64(),
        },
        13 => Shape::mesh(0, random_map(rng, 0.7, 3.0)),
        k => Shape::placed(solid(k), random_map(rng, 0.5, 3.0)),
    }
}

/// The shape under a map, built anew.
fn there(shape: &Shape, map: &DAffine3) -> Shape {
    match shape {
        Shape::Sphere { center, radius } => {
            let unit = DAffine3::from_scale_rotation_translation(DVec3::splat(*radius), DQuat::IDENTITY, *center);
            Shape::placed(Solid::Sphere, *map * unit)
        }
        Shape::Plane { normal, distance } => {
            let n = (map.matrix3.inverse().transpose() * *normal).normalize();
            Shape::Plane {
                normal: n,
                distance: n.dot(map.transform_point3(*normal * *distance)),
            }
        }
        Shape::Placed(p) => Shape::placed(p.kind.clone(), *map * p.world_from_object),
        Shape::Mesh { mesh, placement } => Shape::mesh(*mesh, *map * placement.world_from_mesh),
    }
}

/// The mean of two neighbouring keys, entry by entry, independently of [`Motion::at`].
fn placed_at(motion: &Motion, time: f32) -> DAffine3 {
    let keys = motion.keys();
    let x = f64::from(time) * (keys.len() - 1) as f64;
    let i = (x.floor() as usize).min(keys.len() - 2);
    let (a, b) = (keys[i].to_cols_array(), keys[i + 1].to_cols_array());
    DAffine3::from_cols_array(&std::array::from_fn(|k| a[k] + (b[k] - a[k]) * (x - i as f64)))
}

fn uv_ball() -> MeshData {
    let mut mesh = icosphere(2);
    mesh.uvs = vec![mesh.positions.iter().map(|p| p.truncate()).collect()];
    mesh
}

/// Some dozen objects of all kinds, every third standing still; planes only where wanted, since nothing is seen behind.
fn scene(rng: &mut Pcg, count: usize, with_planes: bool) -> Vec<GeomObject> {
    let mut objects = Vec::new();
    for i in 0..count {
        let kind = if i % 14 == 12 && !with_planes { 11 } else { i };
        let mut object = GeomObject::new(shape(kind, rng), i as u32);
        object.motion = (i % 3 != 0).then(|| Box::new(random_motion(rng)));
        objects.push(object);
    }
    objects
}

fn ray(rng: &mut Pcg) -> Ray {
    let from = (in_cube(rng) * 6.0).as_vec3();
    let at = (in_cube(rng) * 3.0).as_vec3();
    Ray {
        time: rng.next_f32(),
        ..Ray::new(from, at - from)
    }
}

/// What is hit, where, and with which normals and coordinates. Both ways are f64 throughout: points agree within the two
/// bounds on their rounding, directions within a few units of f32.
#[test]
fn moving_objects_are_hit_where_they_are() {
    let mut rng = Pcg::new(501);
    let (mut hits, mut moved) = (0, 0);
    for round in 0..300 {
        let objects = scene(&mut rng, 28, round % 4 == 0);
        let geometry = Geometry::build(objects.clone(), vec![uv_ball()]);
        let ray0 = ray(&mut rng);
        let frozen = objects.iter().map(|o| match &o.motion {
            Some(m) => GeomObject {
                shape: there(&o.shape, &placed_at(m, ray0.time)),
                motion: None,
                ..o.clone()
            },
            None => o.clone(),
        });
        let frozen = Geometry::build(frozen.collect(), vec![uv_ball()]);
        for _ in 0..200 {
            let ray = Ray {
                time: ray0.time,
                ..ray(&mut rng)
            };
            let (a, b) = (geometry.closest(&ray), frozen.closest(&ray));
            assert_eq!(a.map(|h| h.prim), b.map(|h| h.prim), "{ray:?}");
            assert_eq!(geometry.occluded(&ray), frozen.occluded(&ray));
            let (Some(a), Some(b)) = (a, b) else { continue };
            hits += 1;
            moved += usize::from(objects[a.prim.object as usize].motion.is_some());
            let (s, t) = (geometry.surface(&ray, &a), frozen.surface(&ray, &b));
            // Along a surface that is met at a grazing angle the point moves further than off it.
            let off = (s.exact() - t.exact()).dot(t.ng.as_dvec3()).abs();
            let room = (s.p_error + t.p_error).as_dvec3().dot(t.ng.abs().as_dvec3());
            assert!(off <= room, "{off} off, room for {room}: {ray:?}");
            assert!(
                (s.ng - t.ng).length() < 1e-5 && (s.ns - t.ns).length() < 1e-5,
                "{s:?} {t:?}"
            );
            assert_eq!((s.material, s.light), (t.material, t.light));
            let (u, v) = (
                geometry.attributes(&a, &s, ray.time),
                frozen.attributes(&b, &t, ray.time),
            );
            let wrapped = |d: f32| (d - d.round()).abs();
            let d = u.uv[0] - v.uv[0];
            assert!(wrapped(d.x) < 1e-3 && wrapped(d.y) < 1e-3, "{u:?} {v:?}");
        }
    }
    assert!(hits > 15_000 && moved > 8_000, "{hits} hits, {moved} of what moves");
}

/// No box is too small: the same bits as without boxes.
#[test]
fn boxes_hold_what_moves_all_the_way() {
    let mut rng = Pcg::new(502);
    let mut hits = 0;
    for _ in 0..100 {
        let geometry = Geometry::build(scene(&mut rng, 14, true), vec![icosphere(1)]);
        for _ in 0..300 {
            let ray = ray(&mut rng);
            let hit = geometry.closest(&ray);
            assert_eq!(hit, geometry.closest_by_force(&ray), "{ray:?}");
            let Some(hit) = hit else { continue };
            hits += 1;
            if let Some((min, max)) = geometry.bounds_of(hit.prim.object) {
                let s = geometry.surface(&ray, &hit);
                let (low, high) = (s.p + s.p_error, s.p - s.p_error);
                assert!(
                    low.cmpge(min).all() && high.cmple(max).all(),
                    "{} in {min} to {max}",
                    s.p
                );
            }
        }
    }
    assert!(hits > 15_000, "{hits}");
}

/// Rays that leave a convex shape outwards do not meet it again, whenever they leave.
#[test]
fn rays_leave_what_moves() {
    let mut rng = Pcg::new(503);
    let mut left = 0;
    for round in 0..400 {
        let kind = [0, 1, 2, 3, 5, 7, 8, 11, 13][round % 9];
        let mut object = GeomObject::new(shape(kind, &mut rng), 0);
        object.motion = Some(Box::new(random_motion(&mut rng)));
        let geometry = Geometry::build(vec![object], vec![icosphere(2)]);
        for _ in 0..600 {
            let ray = ray(&mut rng);
            let Some(hit) = geometry.closest(&ray) else { continue };
            let s = geometry.surface(&ray, &hit);
            let front = ray.dir.dot(s.ng) < 0.0;
            if !front {
                continue; // open cylinders and discs are seen from behind
            }
            for k in 0..4 {
                let mut w = direction(&mut rng);
                // Half of them along the surface.
                if k % 2 == 0 {
                    w = (w - s.ng * w.dot(s.ng) + s.ng * 1e-6 * rng.next_f32()).normalize_or(s.ng);
                }
                let w = if w.dot(s.ng) < 0.0 { -w } else { w };
                let again = Ray {
                    from: s.prim,
                    time: ray.time,
                    ..Ray::new(offset_origin(s.p, s.p_error, s.ng, w), w)
                };
                left += 1;
                assert_eq!(geometry.closest(&again), None, "kind {kind}: {ray:?} then {again:?}");
            }
        }
    }
    assert!(left > 10_000, "{left}");
}

/// A ray that is sent to a primitive is not blocked by that, but by what stands in front at that time.
#[test]
fn rays_towards_what_moves_end_there() {
    let mut rng = Pcg::new(504);
    let mut sent = 0;
    for round in 0..200 {
        let kind = [1, 2, 7, 11, 13][round % 5];
        let mut object = GeomObject::new(shape(kind, &mut rng), 0);
        object.motion = Some(Box::new(random_motion(&mut rng)));
        let free = Geometry::build(vec![object.clone()], vec![icosphere(2)]);
        for _ in 0..600 {
            let ray = ray(&mut rng);
            let Some(hit) = free.closest(&ray) else { continue };
            let towards = Ray { to: hit.prim, ..ray };
            assert!(free.reaches(&towards) && !free.occluded(&towards), "{ray:?}");
            // A small ball half way, which flies through just then; not around the start of a short ray.
            let half = ray.at(0.5 * hit.exact);
            let away = direction(&mut rng).as_dvec3() * 50.0;
            let t = f64::from(ray.time);
            let keys = [-t, 1.0 - t].map(|w| DAffine3::from_translation(away * w)).to_vec();
            let mut ball = GeomObject::new(
                Shape::Sphere {
                    center: half,
                    radius: (0.1 * hit.exact * ray.direction().length()).min(1e-3),
                },
                1,
            );
            ball.motion = Motion::new(keys).map(Box::new);
            let crossed = Geometry::build(vec![object.clone(), ball], vec![icosphere(2)]);
            assert!(crossed.occluded(&towards), "{ray:?}");
            let later = Ray {
                time: if ray.time < 0.5 { ray.time + 0.4 } else { ray.time - 0.4 },
                ..towards
            };
            let hit_later = crossed.closest(&Ray {
                to: PrimRef::NONE,
                ..later
            });
            assert!(hit_later.is_none_or(|h| h.prim.object == 0), "the ball is gone");
            sent += 1;
        }
    }
    assert!(sent > 2_000, "{sent}");
}

/// Both kinds of instructions give the same bits, and what is flat for a moment is not there at that moment.
#[test]
fn instructions_agree_and_moments_without_extent_are_empty() {
    use crate::render::accel::scene::Instructions;
    let mut rng = Pcg::new(505);
    let mut geometry = Geometry::build(scene(&mut rng, 28, true), vec![icosphere(3)]);
    let rays: Vec<Ray> = (0..2000).map(|_| ray(&mut rng)).collect();
    let fast: Vec<_> = rays.iter().map(|r| geometry.closest(r)).collect();
    geometry.use_instructions(Instructions::Baseline);
    let plain: Vec<_> = rays.iter().map(|r| geometry.closest(r)).collect();
    assert_eq!(fast, plain);

    let mut object = GeomObject::new(Shape::mesh(0, DAffine3::IDENTITY), 0);
    // Through a point and out of it again, inside out.
    let keys = [1.0, -1.0].map(|s| DAffine3::from_scale(DVec3::splat(s))).to_vec();
    object.motion = Motion::new(keys).map(Box::new);
    let geometry = Geometry::build(vec![object], vec![icosphere(2)]);
    let at = |time: f32| {
        geometry.closest(&Ray {
            time,
            ..Ray::new(Vec3::new(0.01, 0.02, -5.0), Vec3::Z)
        })
    };
    assert_eq!(at(0.5), None);
    assert!(at(0.1).is_some() && at(0.9).is_some());
}
