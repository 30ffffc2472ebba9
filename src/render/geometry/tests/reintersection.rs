//! A ray that leaves a surface does not hit it again.

use super::super::{GeomObject, Geometry, MeshData};
use super::support::*;
use crate::math::robust::offset_origin;
use crate::math::stats::Pcg;
use crate::render::ray::{Hit, Ray};
use crate::render::shape::{Shape, Solid};
use crate::render::surface::Surface;
use glam::{DAffine3, DVec3, Vec3};

/// A place and size anywhere between 10⁻⁶ and 10⁶, in every combination.
fn anywhere(rng: &mut Pcg) -> (DVec3, f64) {
    let magnitude = |rng: &mut Pcg| 10f64.powf(signed(rng) * 6.0);
    let place = DVec3::new(magnitude(rng), magnitude(rng), magnitude(rng)) * in_cube(rng).signum();
    (place, magnitude(rng))
}

/// Rays start on a sphere around one point and aim into a cube around another.
struct Aim {
    start: (DVec3, f64),
    target: (DVec3, f64),
}

/// From all around at the middle of something of this size.
fn around(center: DVec3, size: f64) -> Aim {
    Aim {
        start: (center, 4.0 * size),
        target: (center, 0.4 * size),
    }
}

fn leave(surface: &Surface, w: Vec3) -> Ray {
    let mut ray = Ray::new(offset_origin(surface.p, surface.p_error, surface.ng, w), w);
    ray.from = surface.prim;
    ray
}

/// Hits the only object of many geometries and goes on around the hemisphere on the outside (or both sides).
fn self_hits(seed: u64, sheet: bool, make: impl FnMut(&mut Pcg) -> (Geometry, Aim)) -> (usize, usize) {
    self_hits_above(0.0, seed, sheet, make)
}

/// The same at more than an angle (its sine) from the surface.
fn self_hits_above(
    least: f32,
    seed: u64,
    sheet: bool,
    mut make: impl FnMut(&mut Pcg) -> (Geometry, Aim),
) -> (usize, usize) {
    let mut rng = Pcg::new(seed);
    let (mut tried, mut again) = (0, 0);
    for _ in 0..1500 {
        let (geometry, aim) = make(&mut rng);
        for _ in 0..4 {
            let start = aim.start.0 + direction(&mut rng).as_dvec3() * aim.start.1;
            let target = aim.target.0 + in_cube(&mut rng) * aim.target.1;
            let start = start.as_vec3();
            let ray = Ray::new(start, (target - start.as_dvec3()).as_vec3());
            let Some(hit) = geometry.closest(&ray) else { continue };
            let surface = geometry.surface(&ray, &hit);
            for i in 0..16 {
                let mut w = direction(&mut rng);
                if i % 2 == 0 {
                    // Grazing ones, down to angles of 1e-6.
                    let shrink = 10f32.powi(-(i / 2));
                    w = (w - surface.ng * w.dot(surface.ng) * (1.0 - shrink)).normalize();
                }
                if !sheet && w.dot(surface.ng) < 0.0 {
                    w = -w;
                }
                if w.dot(surface.ng).abs() <= least {
                    continue;
                }
                tried += 1;
                again += usize::from(geometry.closest(&leave(&surface, w)).is_some());
            }
        }
    }
    (again, tried)
}

fn single_shape(shape: Shape) -> Geometry {
    Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new())
}

#[test]
fn closed_convex_shapes_are_left_for_good() {
    let (again, tried) = self_hits(1, false, |rng| {
        let (center, radius) = anywhere(rng);
        (single_shape(Shape::Sphere { center, radius }), around(center, radius))
    });
    assert!(again == 0 && tried > 20_000, "spheres: {again} of {tried}");
    // Open walls too: their normals point outward, and to the outside they are convex.
    for kind in [0, 1, 3, 4, 5, 6] {
        let (again, tried) = self_hits(2 + kind as u64, false, |rng| {
            let (place, size) = anywhere(rng);
            let mut map = random_map(rng, size, 0.0);
            map.translation = place;
            let solid = solid(kind);
            let center = map.transform_point3(solid.center());
            (single_shape(Shape::placed(solid, map)), around(center, size))
        });
        assert!(again == 0 && tried > 5000, "{:?}: {again} of {tried}", solid(kind));
    }
}

#[test]
fn sheets_are_left_for_good_on_both_sides() {
    for kind in [2, 7, 8] {
        let (again, tried) = self_hits(20 + kind as u64, true, |rng| {
            let (place, size) = anywhere(rng);
            let mut map = random_map(rng, size, 0.0);
            map.translation = place;
            (single_shape(Shape::placed(solid(kind), map)), around(place, size))
        });
        assert!(again == 0 && tried > 2000, "{:?}: {again} of {tried}", solid(kind));
    }
    let (again, tried) = self_hits(30, true, |rng| {
        let (center, size) = anywhere(rng);
        let normal = direction(rng).as_dvec3().normalize();
        let distance = normal.dot(center);
        (single_shape(Shape::Plane { normal, distance }), around(center, size))
    });
    assert!(again == 0 && tried > 20_000, "planes: {again} of {tried}");
}

#[test]
fn convex_meshes_are_left_for_good() {
    let meshes: Vec<MeshData> = (0..3).map(icosphere).collect();
    let (again, tried) = self_hits(40, false, |rng| {
        let (place, size) = anywhere(rng);
        let mut map = random_map(rng, size, 0.0);
        map.translation = place;
        let mesh = meshes[rng.next_u32() as usize % 3].clone();
        (single(mesh, map), around(place, size))
    });
    assert!(again == 0 && tried > 20_000, "{again} of {tried}");
}

/// Single triangles with corners anywhere between 10⁻⁶ and 10⁶.
#[test]
fn triangles_are_left_for_good() {
    let (again, tried) = self_hits(41, true, |rng| {
        let mut mesh = MeshData::default();
        let corners = [0; 3].map(|_| anywhere(rng).0);
        let center = corners.iter().sum::<DVec3>() / 3.0;
        mesh.positions = corners.map(|p| (p - center).as_vec3()).to_vec();
        mesh.triangles = vec![[0, 1, 2]];
        let size = corners.iter().map(|p| (*p - center).length()).fold(0.0, f64::max);
        (single(mesh, DAffine3::from_translation(center)), around(center, size))
    });
    assert!(again == 0 && tried > 2000, "{again} of {tried}");
}

/// From inside, the far side is found at the distance the chord has: 2R·cos θ.
#[test]
fn inside_a_sphere_the_chord_is_right() {
    let mut rng = Pcg::new(50);
    for _ in 0..3000 {
        let (center, radius) = anywhere(&mut rng);
        if center.length() > 100.0 * radius {
            continue; // rounding the start moves it by a share of the chord there
        }
        let geometry = single_shape(Shape::Sphere { center, radius });
        let start = (center + direction(&mut rng).as_dvec3() * radius * 3.0).as_vec3();
        let ray = Ray::new(start, (center - start.as_dvec3()).as_vec3());
        let Some(hit) = geometry.closest(&ray) else {
            panic!("aimed at the centre")
        };
        let surface = geometry.surface(&ray, &hit);
        let mut w = direction(&mut rng);
        if w.dot(surface.ng) > 0.0 {
            w = -w;
        }
        let cos = -f64::from(w.dot(surface.ng));
        if cos < 0.05 {
            continue;
        }
        let next = geometry.closest(&leave(&surface, w)).map(|h: Hit| f64::from(h.t));
        let want = 2.0 * radius * cos;
        let near = next.is_some_and(|t| (t - want).abs() < 0.05 * want);
        assert!(near, "{next:?} instead of {want}");
    }
}

/// A torus may be hit again, but not where it was left.
#[test]
fn a_torus_is_not_hit_at_once() {
    let mut rng = Pcg::new(51);
    let mut tried = 0;
    for _ in 0..4000 {
        let (place, size) = anywhere(&mut rng);
        let mut map = random_map(&mut rng, size, 0.0);
        map.translation = place;
        let solid = Solid::Torus {
            major: 1.0,
            minor: 0.25,
        };
        let geometry = single_shape(Shape::placed(solid, map));
        let start = (place + direction(&mut rng).as_dvec3() * size * 6.0).as_vec3();
        let target = map.transform_point3(in_cube(&mut rng));
        let ray = Ray::new(start, (target - start.as_dvec3()).as_vec3());
        let Some(hit) = geometry.closest(&ray) else { continue };
        let surface = geometry.surface(&ray, &hit);
        if place.length() > 1e4 * size {
            continue;
        }
        for _ in 0..8 {
            let mut w = direction(&mut rng);
            if w.dot(surface.ng) < 0.0 {
                w = -w;
            }
            if w.dot(surface.ng) < 0.05 {
                continue;
            }
            tried += 1;
            let t = geometry
                .closest(&leave(&surface, w))
                .map_or(f64::INFINITY, |h| f64::from(h.t));
            assert!(t > 1e-3 * size, "hit again after {t}, size {size} at {place}");
        }
    }
    assert!(tried > 3000, "{tried}");
}

/// Shapes up to 10⁷ across whose surface passes close to the camera: a point there has far more digits than the shape.
#[test]
fn huge_convex_shapes_beside_the_camera_are_left_for_good() {
    // A point of the surface of each, and the normal there.
    let spots = [
        (0, DVec3::new(0.0, 0.6, 0.8), DVec3::new(0.0, 0.6, 0.8)),
        (1, DVec3::new(1.0, 0.3, -0.2), DVec3::X),
        (3, DVec3::new(0.6, 0.4, 0.8), DVec3::new(0.6, 0.0, 0.8)),
        (3, DVec3::new(0.3, 1.0, 0.1), DVec3::Y),
        (5, DVec3::new(0.0, 0.5, 0.65), DVec3::new(0.0, 0.7, 1.0)),
        (11, DVec3::ZERO, DVec3::ZERO),
    ];
    for (kind, q, n) in spots {
        let (again, tried) = self_hits(60 + kind as u64, false, |rng| {
            let size = 10f64.powf(rng.next_f64() * 7.0);
            let gap = 10f64.powf(signed(rng) * 3.0).min(0.01 * size);
            let near = in_cube(rng) * gap;
            if kind == 11 {
                let n = direction(rng).as_dvec3().normalize();
                let center = near - n * size;
                return (
                    single_shape(Shape::Sphere { center, radius: size }),
                    close(near, n, gap),
                );
            }
            let mut map = random_map(rng, size, 0.0);
            map.translation = near - map.transform_vector3(q);
            let n = (map.matrix3.inverse().transpose() * n).normalize();
            (single_shape(Shape::placed(solid(kind), map)), close(near, n, gap))
        });
        assert!(again == 0 && tried > 20_000, "kind {kind}: {again} of {tried}");
    }
}

/// From above the surface at a spot close by.
fn close(spot: DVec3, n: DVec3, gap: f64) -> Aim {
    Aim {
        start: (spot + n * gap, 0.5 * gap),
        target: (spot, 0.3 * gap),
    }
}

/// A flat mesh left at corners, edges and anywhere: the neighbours lie in the same plane and must not be met either.
#[test]
fn coplanar_neighbours_are_not_met() {
    let n = 6u32;
    let mut mesh = MeshData::default();
    for y in 0..=n {
        for x in 0..=n {
            let p = Vec3::new(x as f32, 0.0, y as f32) / n as f32 - Vec3::new(0.5, 0.0, 0.5);
            mesh.positions.push(p);
        }
    }
    for y in 0..n {
        for x in 0..n {
            let i = y * (n + 1) + x;
            mesh.triangles.push([i, i + 1, i + n + 1]);
            mesh.triangles.push([i + 1, i + n + 2, i + n + 1]);
        }
    }
    let (again, tried) = self_hits(70, true, |rng| {
        let (place, size) = anywhere(rng);
        let mut map = random_map(rng, size, 0.0);
        map.translation = place;
        let corner = mesh.positions[rng.next_u32() as usize % mesh.positions.len()].as_dvec3();
        let spread = [0.0, 1e-7, 1e-3][rng.next_u32() as usize % 3];
        let aim = Aim {
            start: (place, 3.0 * size),
            target: (map.transform_point3(corner * 0.99), spread * size),
        };
        (single(mesh.clone(), map), aim)
    });
    assert!(again == 0 && tried > 20_000, "{again} of {tried}");
    // The same with the rotation in the mesh's own coordinates, where the plane is only as flat as f32: its corners are
    // off by √3·2⁻²⁵ each and half a unit or more apart, so that one half may truly rise before the other by 4·2⁻²³.
    let (again, tried) = self_hits_above(4.0 * f32::EPSILON, 71, true, |rng| {
        let (place, size) = anywhere(rng);
        let turn = random_map(rng, 1.0, 0.0);
        let mut mesh = mesh.clone();
        // One large triangle in two halves.
        mesh.positions = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5)]
            .map(|(x, z)| turn.transform_point3(DVec3::new(x, 0.0, z)).as_vec3())
            .to_vec();
        mesh.positions.push(mesh.positions[0].midpoint(mesh.positions[1]));
        mesh.triangles = vec![[0, 3, 2], [3, 1, 2]];
        let map = DAffine3::from_translation(place) * DAffine3::from_scale(DVec3::splat(size));
        let along = rng.next_f64();
        let seam = mesh.positions[3].as_dvec3().lerp(mesh.positions[2].as_dvec3(), along);
        let aim = Aim {
            start: (place, 3.0 * size),
            target: (map.transform_point3(seam), 1e-7 * size),
        };
        (single(mesh, map), aim)
    });
    assert!(again == 0 && tried > 20_000, "seam: {again} of {tried}");
}
