//! Flat surfaces of many triangles: what leaves them, and what arrives at them as lamps, is not stopped by the
//! neighbours in the same plane.

use super::super::{GeomObject, Geometry, MeshData};
use super::support::*;
use crate::math::robust::offset_origin;
use crate::math::stats::Pcg;
use crate::render::light::{ParallelogramLight, Receiver, TriangleLight};
use crate::render::ray::{PrimRef, Ray, ray_mask};
use crate::render::shape::{Shape, Solid};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec2, Vec3};

/// Angles above the plane.
const ANGLES: [f64; 7] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];

/// A square of 2·n² triangles, turned in f64 and then rounded: as flat as f32 allows. Its normal is the map's y axis.
fn tessellated(n: u32, turn: &DMat3) -> MeshData {
    let mut mesh = MeshData::default();
    for y in 0..=n {
        for x in 0..=n {
            let p = DVec3::new(f64::from(x), 0.0, f64::from(y)) / f64::from(n) - DVec3::new(0.5, 0.0, 0.5);
            mesh.positions.push((*turn * p).as_vec3());
        }
    }
    for y in 0..n {
        for x in 0..n {
            let i = y * (n + 1) + x;
            mesh.triangles.push([i, i + n + 1, i + 1]);
            mesh.triangles.push([i + 1, i + n + 1, i + n + 2]);
        }
    }
    mesh
}

fn random_turn(rng: &mut Pcg) -> DMat3 {
    DMat3::from_quat(DQuat::from_scaled_axis(in_cube(rng) * std::f64::consts::PI))
}

/// Size and place of what is tested.
fn spots(rng: &mut Pcg) -> [(f64, DVec3); 4] {
    let far = in_cube(rng);
    [
        (1.0, DVec3::ZERO),
        (1.0, far * 1e3),
        (1e-5, far * 1e-5),
        (1e4, far * 1e5),
    ]
}

/// A direction at a given angle above the plane with this frame (x, normal, z), rounded.
fn raised(frame: &DMat3, angle: f64, rng: &mut Pcg) -> Vec3 {
    let phi = rng.next_f64() * std::f64::consts::TAU;
    let along = frame.x_axis * phi.cos() + frame.z_axis * phi.sin();
    (along * angle.cos() + frame.y_axis * angle.sin()).as_vec3()
}

#[test]
fn a_flat_floor_of_many_triangles_is_left_at_any_angle() {
    let mut rng = Pcg::new(1);
    let mut blocked = [0usize; ANGLES.len()];
    let mut tried = [0usize; ANGLES.len()];
    for n in [1, 2, 7, 64] {
        for _ in 0..12 {
            let turn = random_turn(&mut rng);
            let mesh = tessellated(n, &turn);
            for (size, place) in spots(&mut rng) {
                let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(size)), place);
                let geometry = single(mesh.clone(), map);
                for i in 0..100 {
                    // Anywhere, at corners and at edges of the pattern; both sides.
                    let cell = |rng: &mut Pcg| f64::from(rng.next_u32() % (n + 1)) / f64::from(n) - 0.5;
                    let q = match i % 3 {
                        0 => DVec3::new(cell(&mut rng), 0.0, cell(&mut rng)),
                        1 => DVec3::new(signed(&mut rng) * 0.5, 0.0, cell(&mut rng)),
                        _ => DVec3::new(signed(&mut rng) * 0.5, 0.0, signed(&mut rng) * 0.5),
                    } * 0.999;
                    let side = if i % 2 == 0 { 1.0 } else { -1.0 };
                    let above = turn * (q + DVec3::new(signed(&mut rng), side, signed(&mut rng)) * 0.7);
                    let start = map.transform_point3(above).as_vec3();
                    let ray = Ray::new(start, (map.transform_point3(turn * q) - start.as_dvec3()).as_vec3());
                    let Some(hit) = geometry.closest(&ray) else { continue };
                    let s = geometry.surface(&ray, &hit);
                    for (k, &angle) in ANGLES.iter().enumerate() {
                        let frame = DMat3::from_cols(turn.x_axis, turn.y_axis * side, turn.z_axis);
                        let w = raised(&frame, angle, &mut rng);
                        if w.as_dvec3().dot(frame.y_axis) < 0.5 * angle || w.dot(s.ng) * side as f32 <= 0.0 {
                            continue; // rounded into the plane
                        }
                        let mut next = Ray::new(offset_origin(s.p, s.p_error, s.ng, w), w);
                        next.from = s.prim;
                        tried[k] += 1;
                        blocked[k] += usize::from(geometry.occluded(&next));
                    }
                }
            }
        }
    }
    assert!(tried.iter().all(|&n| n > 5000), "{tried:?}");
    assert_eq!(blocked, [0; ANGLES.len()], "of {tried:?}");
}

fn triangle_light(mesh: &MeshData, map: &DAffine3, triangle: u32) -> TriangleLight {
    let [a, b, c] = mesh
        .corners(triangle)
        .expect("in range")
        .map(|v| map.transform_point3(v.as_dvec3()));
    TriangleLight {
        p0: a,
        e1: (b - a).as_vec3(),
        e2: (c - a).as_vec3(),
        flipped: false,
        radiance: Vec3::ONE,
        two_sided: true,
        textured: false,
        prim: PrimRef {
            object: 0,
            prim: triangle,
        },
    }
}

/// Points at a given angle above a lamp's plane, at distances from 0.01 to 100 of its size.
fn beside(frame: &DMat3, angle: f64, rng: &mut Pcg) -> DVec3 {
    let distance = 10f64.powf(2.0 * signed(rng));
    raised(frame, angle, rng).as_dvec3() * distance
}

#[test]
fn a_flat_lamp_of_many_triangles_does_not_shade_itself() {
    let mut rng = Pcg::new(2);
    let mut blocked = [0usize; ANGLES.len()];
    let mut tried = [0usize; ANGLES.len()];
    for n in [1, 7, 64] {
        for _ in 0..12 {
            let turn = random_turn(&mut rng);
            let mesh = tessellated(n, &turn);
            for (size, place) in spots(&mut rng) {
                let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(size)), place);
                let geometry = single(mesh.clone(), map);
                // Rounded corners tilt triangles of size 1/n by n·√3·2⁻²³ at most against each other: below, the lamp
                // truly shades itself.
                let tilt = f64::from(n) * 3f64.sqrt() * f64::from(f32::EPSILON);
                for _ in 0..400 {
                    let triangle = rng.next_u32() % (2 * n * n);
                    let light = triangle_light(&mesh, &map, triangle);
                    for (k, &angle) in ANGLES.iter().enumerate().filter(|a| *a.1 > tilt) {
                        let q = DVec3::new(signed(&mut rng), 0.0, signed(&mut rng)) * 0.5;
                        let p = map
                            .transform_point3(turn * q + beside(&turn, angle, &mut rng))
                            .as_vec3();
                        let receiver = Receiver {
                            p,
                            n: Vec3::ZERO,
                            two_sided: true,
                        };
                        let Some(aim) = light.sample(&receiver, rng.next_vec2()) else {
                            continue;
                        };
                        tried[k] += 1;
                        // The start may be moved aside, as it is off a surface of loose points.
                        let aside = direction(&mut rng) * (aim.distance * 1e-6 * rng.next_f32().powi(8));
                        let origin = p + aside;
                        let ray = Ray {
                            t_max: aim.t_max - (origin - p).length() * aim.slant,
                            to: aim.to,
                            dir_low: aim.wi_low,
                            mask: ray_mask::SHADOW,
                            ..Ray::new(origin, aim.wi)
                        };
                        blocked[k] += usize::from(geometry.occluded(&ray));
                    }
                }
            }
        }
    }
    assert!(tried.iter().take(6).all(|&n| n > 10_000), "{tried:?}");
    assert_eq!(blocked, [0; ANGLES.len()], "of {tried:?}");
}

/// Seen from outside no face of a box hides a point of another.
#[test]
fn a_box_lamp_does_not_shade_its_own_faces() {
    let mut rng = Pcg::new(3);
    let mut blocked = [0usize; ANGLES.len()];
    let mut tried = [0usize; ANGLES.len()];
    for case in 0..120 {
        let turn = random_turn(&mut rng);
        let half = DVec3::new(1.5, [1.5, 0.025, 1e-4][case % 3], 1.5);
        for (size, place) in spots(&mut rng) {
            let map = DAffine3::from_mat3_translation(turn * size, place);
            let shape = Shape::placed(Solid::Box { min: -half, max: half }, map);
            let geometry = Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new());
            // The upper face and the one towards +x.
            for face in [3u32, 1] {
                let axis = (face / 2) as usize;
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                let edge = |k: usize| map.transform_vector3(DVec3::AXES[k] * 2.0 * half[k]);
                let mut corner = -half;
                corner[axis] = half[axis];
                let light = ParallelogramLight {
                    p0: map.transform_point3(corner),
                    e1: edge(a).as_vec3(),
                    e2: edge(b).as_vec3(),
                    radiance: Vec3::ONE,
                    two_sided: false,
                    textured: false,
                    prim: PrimRef { object: 0, prim: face },
                };
                let frame = DMat3::from_cols(DVec3::AXES[a], DVec3::AXES[axis], DVec3::AXES[b]);
                for (k, &angle) in ANGLES.iter().enumerate() {
                    for _ in 0..50 {
                        let mut q = in_cube(&mut rng) * half;
                        q[axis] = half[axis];
                        let p = map.transform_point3(q + beside(&frame, angle, &mut rng)).as_vec3();
                        let receiver = Receiver {
                            p,
                            n: Vec3::ZERO,
                            two_sided: true,
                        };
                        let u = Vec2::new(rng.next_f32(), rng.next_f32());
                        // Close to the rim more often than by chance.
                        let u = if k % 2 == 0 { u } else { u * 1e-5 };
                        let Some(aim) = light.sample(&receiver, u) else {
                            continue;
                        };
                        tried[k] += 1;
                        let ray = Ray {
                            t_max: aim.t_max,
                            to: aim.to,
                            dir_low: aim.wi_low,
                            mask: ray_mask::SHADOW,
                            ..Ray::new(p, aim.wi)
                        };
                        blocked[k] += usize::from(geometry.occluded(&ray));
                    }
                }
            }
        }
    }
    assert!(tried.iter().take(5).all(|&n| n > 10_000), "{tried:?}");
    assert_eq!(blocked, [0; ANGLES.len()], "of {tried:?}");
}

/// What hangs before a lamp, a ten-thousandth of its size away, does block: the end of a shadow ray is not short of it.
/// 20·2⁻²⁴ times all lengths over the cosine are granted to the end, here at most 4e-5 across the lamp.
#[test]
fn what_is_close_before_a_lamp_still_blocks() {
    let mut rng = Pcg::new(4);
    let mut tried = 0;
    for _ in 0..100 {
        let turn = random_turn(&mut rng);
        let lamp = tessellated(4, &turn);
        let map = DAffine3::from_mat3_translation(DMat3::IDENTITY, in_cube(&mut rng) * 10.0);
        let mut shade = map;
        shade.translation += turn.y_axis * 1e-4;
        let objects = [map, shade].map(|m| GeomObject::new(Shape::mesh(0, m), 0)).to_vec();
        let geometry = Geometry::build(objects, vec![lamp.clone()]);
        for i in 0..100 {
            let light = triangle_light(&lamp, &map, i % 32);
            // From above and near enough to meet the shade wherever the lamp is aimed at but at its rim.
            let q = DVec3::new(signed(&mut rng), 0.0, signed(&mut rng)) * 3.0 + DVec3::Y * 0.3;
            let p = map.transform_point3(turn * q).as_vec3();
            let receiver = Receiver {
                p,
                n: Vec3::ZERO,
                two_sided: true,
            };
            let Some(aim) = light.sample(&receiver, rng.next_vec2()) else {
                continue;
            };
            let aimed =
                turn.transpose() * (p.as_dvec3() + aim.wi.as_dvec3() * f64::from(aim.distance) - map.translation);
            if aimed.abs().max_element() > 0.49 {
                continue;
            }
            tried += 1;
            let ray = Ray {
                t_max: aim.t_max,
                to: aim.to,
                dir_low: aim.wi_low,
                mask: ray_mask::SHADOW,
                ..Ray::new(p, aim.wi)
            };
            assert!(geometry.occluded(&ray), "{ray:?}");
        }
    }
    assert!(tried > 5000, "{tried}");
}
