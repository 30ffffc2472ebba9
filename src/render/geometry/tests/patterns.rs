//! Rays along axes, diagonals and in planes: every pattern of signs and zeros, with every kind of zero.

use super::super::{GeomObject, Geometry, MeshData};
use super::support::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::stats::Pcg;
use crate::render::accel::scene::Instructions;
use crate::render::ray::{PrimRef, Ray};
use crate::render::shape::{Shape, Solid};
use glam::{DAffine3, DVec3, Vec3};

/// The 27 patterns of −, 0 and + in three coordinates, with +0 and −0 apart: 64 directions, the zero ones included.
fn directions() -> impl Iterator<Item = Vec3> {
    const SIGNS: [f32; 4] = [-1.0, -0.0, 0.0, 1.0];
    (0..64).map(|i| Vec3::new(SIGNS[i % 4], SIGNS[i / 4 % 4], SIGNS[i / 16]))
}

/// Triangle meshes on a grid of whole numbers, so that f64 decides exactly: t, and which triangle.
fn grid_mesh(rng: &mut Pcg) -> MeshData {
    let mut mesh = MeshData::default();
    let mut whole = || (rng.next_u32() % 9) as f32 - 4.0;
    for i in 0..60u32 {
        // Every third triangle lies in a plane of the grid, so that boxes are flat.
        for _ in 0..3 {
            let mut p = Vec3::new(whole(), whole(), whole());
            if i % 3 == 0 {
                p[i as usize / 3 % 3] = (i % 5) as f32 - 2.0;
            }
            mesh.positions.push(p);
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

/// Möller and Trumbore in f64 on small whole numbers, where all products are exact: t of all triangles met. Edges and
/// corners count. An independent formula, not the one of the renderer. `None` for starts on a triangle, where t is 0 up to
/// rounding.
fn brute_force(mesh: &MeshData, o: Vec3, d: Vec3) -> Option<Vec<(u32, f64)>> {
    let (o, d) = (o.as_dvec3(), d.as_dvec3());
    let mut all = Vec::new();
    for (i, t) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = t.map(|k| mesh.positions[k as usize].as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            continue;
        }
        let s = o - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p), d.dot(q), e2.dot(q));
        let inside = |x: f64| x * det.signum() >= 0.0;
        if !(inside(u) && inside(v) && inside(det - u - v)) {
            continue;
        }
        let t = t / det;
        if t == 0.0 {
            return None;
        }
        if t > 0.0 {
            all.push((i as u32, t));
        }
    }
    Some(all)
}

#[test]
fn all_patterns_of_signs_and_zeros_agree_with_brute_force() {
    let mut rng = Pcg::new(7);
    let mut hits = 0;
    for _ in 0..40 {
        let mesh = grid_mesh(&mut rng);
        let mut geometry = single(mesh.clone(), DAffine3::IDENTITY);
        for d in directions() {
            // Starts on the grid, in its planes and along its lines: edges and corners are met all the time.
            for _ in 0..12 {
                let mut whole = || (rng.next_u32() % 13) as f32 - 6.0;
                let o = Vec3::new(whole(), whole(), whole());
                let Some(all) = brute_force(&mesh, o, d) else { continue };
                let nearest = all.iter().map(|a| a.1).fold(f64::INFINITY, f64::min);
                for instructions in [Instructions::Baseline, Instructions::detect()] {
                    geometry.use_instructions(instructions);
                    let ray = Ray::new(o, d);
                    let got = geometry.closest(&ray);
                    assert_eq!(got.is_some(), !all.is_empty(), "{o} + t {d}: {got:?}, {all:?}");
                    assert_eq!(geometry.occluded(&ray), !all.is_empty());
                    // The triangle is truly met. t is a sum of three terms of at most 10, each rounded some six times; of
                    // several triangles in one place any may come out first.
                    if let Some(hit) = got {
                        let own = all.iter().find(|a| a.0 == hit.prim.prim);
                        let tolerance = 60.0 * f64::from(UNIT_ROUNDOFF);
                        let off = |exact: f64| (f64::from(hit.t) - exact).abs();
                        let right = own.is_some_and(|a| off(a.1) <= tolerance) && off(nearest) <= tolerance;
                        assert!(right, "{o} + t {d}: {hit:?}, {all:?}");
                    }
                }
                hits += usize::from(!all.is_empty());
            }
        }
    }
    assert!(hits > 3000, "{hits}");
}

/// The slabs of a box, exactly, in f64 on whole numbers; rays that run in a face's plane touch it.
fn brute_box(min: DVec3, max: DVec3, o: DVec3, d: DVec3) -> Option<f64> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if o[axis] < min[axis] || o[axis] > max[axis] {
                return None;
            }
        } else {
            let (a, b) = ((min[axis] - o[axis]) / d[axis], (max[axis] - o[axis]) / d[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    if enter > leave {
        return None;
    }
    [enter, leave].into_iter().find(|t| *t > 0.0)
}

/// Boxes, flat ones and mere segments among them, hit along faces, edges and through corners. Exact.
#[test]
fn boxes_are_hit_along_faces_edges_and_corners() {
    let mut rng = Pcg::new(8);
    let mut hits = 0;
    for case in 0..300 {
        let mut whole = |n: u32| f64::from(rng.next_u32() % n);
        let min = DVec3::new(whole(5), whole(5), whole(5)) - 2.0;
        let mut size = DVec3::new(whole(3), whole(3), whole(3)) + 1.0;
        if case % 2 == 0 {
            size[case / 2 % 3] = 0.0;
        }
        let max = min + size;
        // A second box far away makes a tree with boxes of its own.
        let far = Shape::placed(
            Solid::Box {
                min: DVec3::splat(50.0),
                max: DVec3::splat(51.0),
            },
            DAffine3::IDENTITY,
        );
        let own = Shape::placed(Solid::Box { min, max }, DAffine3::IDENTITY);
        let objects = [own, far].map(|s| GeomObject::new(s, 0)).to_vec();
        let mut geometry = Geometry::build(objects, Vec::new());
        for d in directions().filter(|d| *d != Vec3::ZERO) {
            for i in 0..6 {
                let mut whole = |n: u32| f64::from(rng.next_u32() % n);
                // Through a corner, or from anywhere on the grid.
                let corner = DVec3::new(
                    if whole(2) == 0.0 { min.x } else { max.x },
                    if whole(2) == 0.0 { min.y } else { max.y },
                    if whole(2) == 0.0 { min.z } else { max.z },
                );
                let o = if i % 2 == 0 {
                    corner - d.as_dvec3() * (1.0 + whole(5))
                } else {
                    DVec3::new(whole(13), whole(13), whole(13)) - 6.0
                };
                let want = brute_box(min, max, o, d.as_dvec3());
                for instructions in [Instructions::Baseline, Instructions::detect()] {
                    geometry.use_instructions(instructions);
                    let ray = Ray::new(o.as_vec3(), d);
                    let got = geometry.closest(&ray).filter(|h| h.prim.object == 0);
                    assert_eq!(got.map(|h| f64::from(h.t)), want, "{min} {max}: {o} + t {d}");
                }
                hits += usize::from(want.is_some());
            }
        }
    }
    assert!(hits > 10_000, "{hits}");
}

/// Spheres, planes and discs met along the axes at whole numbers.
#[test]
fn round_shapes_are_met_along_all_patterns() {
    let sphere = |center, radius| Shape::Sphere { center, radius };
    for d in directions().filter(|d| *d != Vec3::ZERO) {
        let w = d.as_dvec3();
        // Starts 8 directions away: hits where |8 − t|·|d| = r.
        let o = -w * 8.0;
        for shape in [
            sphere(DVec3::ZERO, 3.0),
            Shape::placed(Solid::Sphere, DAffine3::from_scale(DVec3::splat(3.0))),
        ] {
            let geometry = Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new());
            let t = geometry.closest(&Ray::new(o.as_vec3(), d)).map(|h| f64::from(h.t));
            let want = 8.0 - 3.0 / w.length();
            assert!(
                t.is_some_and(|t| (t - want).abs() <= 6e-8 * want),
                "{d}: {t:?} instead of {want}"
            );
        }
        for normal in DVec3::AXES {
            let geometry = Geometry::build(
                vec![GeomObject::new(Shape::Plane { normal, distance: 0.0 }, 0)],
                Vec::new(),
            );
            let hit = geometry.closest(&Ray::new(o.as_vec3(), d));
            let want = (normal.dot(w) != 0.0).then_some((8.0, PrimRef { object: 0, prim: 0 }));
            assert_eq!(
                hit.map(|h| (h.t, h.prim)),
                want.map(|w| (w.0 as f32, w.1)),
                "{d} and {normal}"
            );
        }
    }
}
