//! No ray leaves a closed mesh.

use super::super::{Geometry, MeshData};
use super::support::*;
use crate::math::stats::Pcg;
use crate::render::ray::Ray;
use glam::{DAffine3, DVec3, Vec3};

/// A closed mesh of long thin triangles: a unit sphere of few rings and many meridians, poles included.
fn slivers(meridians: u32, rings: u32) -> MeshData {
    let mut mesh = MeshData::default();
    mesh.positions.push(Vec3::Y);
    for r in 1..rings {
        let theta = std::f64::consts::PI * f64::from(r) / f64::from(rings);
        for m in 0..meridians {
            let phi = std::f64::consts::TAU * f64::from(m) / f64::from(meridians);
            let p = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            mesh.positions.push(p.as_vec3());
        }
    }
    mesh.positions.push(-Vec3::Y);
    let at = |ring: u32, m: u32| match ring {
        0 => 0,
        r if r == rings => 1 + (rings - 1) * meridians,
        r => 1 + (r - 1) * meridians + m % meridians,
    };
    for r in 0..rings {
        for m in 0..meridians {
            if r > 0 {
                mesh.triangles.push([at(r, m), at(r, m + 1), at(r + 1, m)]);
            }
            if r + 1 < rings {
                mesh.triangles.push([at(r, m + 1), at(r + 1, m + 1), at(r + 1, m)]);
            }
        }
    }
    mesh
}

/// Rays from inside at corners, at edges, along axes (through corners too) and anywhere; counts those that escape.
fn leaks(mesh: &MeshData, size: f64, center: DVec3, rays: usize, seed: u64) -> usize {
    let map = DAffine3::from_translation(center) * DAffine3::from_scale(DVec3::splat(size));
    let geometry = single(mesh.clone(), map);
    let mut rng = Pcg::new(seed);
    let world = |p: Vec3| map.transform_point3(p.as_dvec3());
    let mut escaped = 0;
    for i in 0..rays {
        let t = mesh.triangles[rng.next_u32() as usize % mesh.triangles.len()];
        let corner = t.map(|k| world(mesh.positions[k as usize]));
        let inside = center + in_cube(&mut rng) * size * 0.3;
        let ray = match i % 5 {
            0 => aimed(inside, corner[0]),
            1 => aimed(inside, corner[0].lerp(corner[1], rng.next_f64())),
            2 => aimed(center, corner[0]),
            3 => {
                // Start on the parallel to an axis through a corner.
                let axis = rng.next_u32() as usize % 3;
                let mut start = corner[0];
                start[axis] = center[axis];
                let mut dir = Vec3::ZERO;
                dir[axis] = if corner[0][axis] < center[axis] { -1.0 } else { 1.0 };
                if (start - center).length() > 0.5 * size {
                    continue; // may start on or outside of a mesh with few rings
                }
                Ray::new(start.as_vec3(), dir)
            }
            _ => Ray::new(inside.as_vec3(), direction(&mut rng)),
        };
        escaped += usize::from(geometry.closest(&ray).is_none());
    }
    escaped
}

fn aimed(from: DVec3, to: DVec3) -> Ray {
    let from = from.as_vec3();
    Ray::new(from, (to - from.as_dvec3()).as_vec3())
}

#[test]
fn a_closed_sphere_of_any_size_and_place_has_no_leaks() {
    let mesh = icosphere(4);
    for (i, size) in [1e-5, 1e-3, 1.0, 1e4].into_iter().enumerate() {
        let far = DVec3::new(30.0, -20.0, 50.0) * size;
        for (j, center) in [DVec3::ZERO, far].into_iter().enumerate() {
            assert_eq!(
                leaks(&mesh, size, center, 150_000, (2 * i + j) as u64),
                0,
                "size {size} at {center}"
            );
        }
    }
}

#[test]
fn slivers_have_no_leaks() {
    for (meridians, rings) in [(4096, 3), (16, 600), (1024, 64)] {
        let mesh = slivers(meridians, rings);
        for size in [1e-5, 1.0, 1e4] {
            let leaks = leaks(&mesh, size, DVec3::new(2.0, 1.0, -3.0) * size, 25_000, 77);
            assert_eq!(leaks, 0, "{meridians} × {rings}, size {size}");
        }
    }
}

/// Flat boxes of the tree are met edge on.
#[test]
fn a_flat_grid_is_hit_at_every_corner_and_edge_from_any_side() {
    let n = 64u32;
    let mut mesh = MeshData::default();
    for y in 0..=n {
        for x in 0..=n {
            mesh.positions
                .push(Vec3::new(x as f32 / n as f32 - 0.5, 0.0, y as f32 / n as f32 - 0.5));
        }
    }
    for y in 0..n {
        for x in 0..n {
            let i = y * (n + 1) + x;
            mesh.triangles.push([i, i + 1, i + n + 1]);
            mesh.triangles.push([i + 1, i + n + 2, i + n + 1]);
        }
    }
    let geometry: Geometry = single(mesh.clone(), DAffine3::IDENTITY);
    let mut rng = Pcg::new(5);
    for i in 0..200_000 {
        // Keep off the rim, where a rounded ray may rightly pass by.
        let (x, y) = (1 + rng.next_u32() % (n - 1), 1 + rng.next_u32() % (n - 1));
        let mut target = mesh.positions[(y * (n + 1) + x) as usize];
        if i % 2 == 0 {
            target.x += rng.next_f32() / (2 * n) as f32;
        }
        // Far and low, high, straight down.
        let height = [1e-3, 1.0, 30.0][i % 3];
        let mut start = Vec3::new(rng.next_f32() - 0.5, height, rng.next_f32() - 0.5) * Vec3::new(3.0, 1.0, 3.0);
        if i % 7 == 0 {
            start.x = target.x;
        }
        if i % 11 == 0 {
            start.z = target.z;
        }
        let ray = Ray::new(start, target - start);
        assert!(geometry.occluded(&ray), "{ray:?} towards {target}");
    }
}
