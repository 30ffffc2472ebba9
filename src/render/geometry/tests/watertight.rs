//! No ray leaves a closed mesh or box, and all instruction sets find the same.

use super::super::{GeomObject, Geometry, MeshData};
use super::support::*;
use crate::math::stats::Pcg;
use crate::render::accel::scene::Instructions;
use crate::render::ray::{Hit, Ray};
use crate::render::shape::{Shape, Solid};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use rayon::prelude::*;

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

/// The box [−0.6, 0.6]³ as twelve triangles.
fn box_mesh() -> MeshData {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 1.2 - 0.6;
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    MeshData {
        positions: (0..8).map(corner).collect(),
        triangles: sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..MeshData::default()
    }
}

/// Where each closed surface stands: three sizes at the origin and a thousand sizes off, and two instances turned,
/// stretched and mirrored far away. Each is seen by rays of its own kind only.
fn places() -> [DAffine3; 8] {
    let aside = DVec3::new(1000.0, -700.0, 400.0);
    let at =
        |size: f64, place: DVec3| DAffine3::from_translation(place * size) * DAffine3::from_scale(DVec3::splat(size));
    let turn = DMat3::from_quat(DQuat::from_scaled_axis(DVec3::new(1.0, -0.4, 0.3)));
    let instance =
        |x: f64| DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(DVec3::new(x, 3.0, 1.0)), aside * 30.0);
    [
        at(1e-5, DVec3::ZERO),
        at(1.0, DVec3::ZERO),
        at(1e4, DVec3::ZERO),
        at(1e-5, aside),
        at(1.0, aside),
        at(1e4, aside),
        instance(1.0),
        instance(-0.5),
    ]
}

/// A closed surface in all places, and the triangles at whose corners and edges rays aim.
struct Closed {
    name: &'static str,
    places: [DAffine3; 8],
    targets: MeshData,
    baseline: Geometry,
    fastest: Geometry,
}

impl Closed {
    fn new(name: &'static str, targets: MeshData, shape: impl Fn(DAffine3) -> Shape, meshes: Vec<MeshData>) -> Closed {
        let object = |(bit, map): (usize, DAffine3)| GeomObject {
            visibility: 1 << bit,
            ..GeomObject::new(shape(map), 0)
        };
        let objects = places().into_iter().enumerate().map(object).collect();
        let fastest = Geometry::build(objects, meshes);
        let mut baseline = fastest.clone();
        baseline.use_instructions(Instructions::Baseline);
        Closed {
            name,
            places: places(),
            targets,
            baseline,
            fastest,
        }
    }

    fn mesh(name: &'static str, mesh: MeshData) -> Closed {
        Closed::new(name, mesh.clone(), |map| Shape::mesh(0, map), vec![mesh])
    }

    /// The same with the corners themselves moved a thousand sizes away, where they have three digits less.
    fn moved(name: &'static str, mesh: MeshData) -> Closed {
        let aside = Vec3::new(1000.0, -700.0, 400.0);
        let mut off = mesh.clone();
        off.positions.iter_mut().for_each(|p| *p += aside);
        let mut targets = off.clone();
        targets.positions.iter_mut().for_each(|p| *p -= aside);
        let back = DAffine3::from_translation(-aside.as_dvec3());
        Closed::new(name, targets, move |map| Shape::mesh(0, map * back), vec![off])
    }

    /// Aims from inside at a corner, at an edge, from the middle at a corner, along an axis through a corner, or anywhere.
    /// 1 if the ray escapes, and 1 if the instruction sets disagree in a single bit.
    fn leaks(&self, i: u32, rng: &mut Pcg) -> (usize, usize) {
        let bit = rng.next_u32() as usize % 8;
        let map = self.places[bit];
        let triangle = self.targets.triangles[rng.next_u32() as usize % self.targets.triangles.len()];
        let own = triangle.map(|k| self.targets.positions[k as usize].as_dvec3());
        let corner = own.map(|p| map.transform_point3(p));
        let center = map.translation;
        let inside = map.transform_point3(in_cube(rng) * 0.3);
        // Fans have their pole at the first corner; a ray there meets all of them, so it is tried less often.
        let tip = corner[if i % 40 < 5 { 0 } else { 1 }];
        let mut ray = match i % 5 {
            0 => aimed(inside, tip),
            1 => aimed(inside, corner[0].lerp(corner[1], rng.next_f64())),
            2 => aimed(center, tip),
            3 => {
                let axis = rng.next_u32() as usize % 3;
                let mut start = own[0];
                start[axis] = 0.0;
                if start.length() > 0.5 {
                    return (0, 0); // may be on or outside of a mesh of few rings
                }
                let mut dir = DVec3::ZERO;
                dir[axis] = if own[0][axis] < 0.0 { -1.0 } else { 1.0 };
                Ray::new(
                    map.transform_point3(start).as_vec3(),
                    map.transform_vector3(dir).as_vec3(),
                )
            }
            _ => Ray::new(inside.as_vec3(), direction(rng)),
        };
        ray.mask = 1 << bit;
        let (a, b) = (self.baseline.closest(&ray), self.fastest.closest(&ray));
        let blocked = !i.is_multiple_of(4) || self.fastest.occluded(&ray) == b.is_some();
        let differ = bits(a) != bits(b) || !blocked;
        (usize::from(b.is_none()), usize::from(differ))
    }
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32, u32, u32)> {
    hit.map(|h| (h.t.to_bits(), h.b.x.to_bits(), h.b.y.to_bits(), h.prim.prim))
}

fn aimed(from: DVec3, to: DVec3) -> Ray {
    let from = from.as_vec3();
    Ray::new(from, (to - from.as_dvec3()).as_vec3())
}

/// Ten million rays in a release build, one in debug builds, from inside closed surfaces: none escapes. Triangles of aspect
/// 1, 250, 1000 and 15 000; fans of 16 384 and more at a pole; meshes with their coordinates far from their origin;
/// analytic boxes. Fans get fewer rays, since one at the pole meets every triangle.
#[test]
fn ten_million_rays_do_not_leave_closed_surfaces() {
    let total: u32 = if cfg!(debug_assertions) { 1_000_000 } else { 10_000_000 };
    let cube = |map| {
        Shape::placed(
            Solid::Box {
                min: DVec3::splat(-0.6),
                max: DVec3::splat(0.6),
            },
            map,
        )
    };
    // Each with its share of the rays, in ten-thousandths.
    let surfaces = [
        (2600, Closed::mesh("icosphere", icosphere(4))),
        (2000, Closed::moved("moved icosphere", icosphere(4))),
        (100, Closed::mesh("needles of aspect 250", slivers(1110, 2))),
        (50, Closed::mesh("slivers of aspect 1000", slivers(4096, 3))),
        (2300, Closed::mesh("rings", slivers(16, 600))),
        (10, Closed::mesh("fans of 16 384", slivers(16_384, 2))),
        (10, Closed::moved("moved fans", slivers(16_384, 2))),
        (2, Closed::mesh("needles of aspect 15 000", slivers(65_536, 2))),
        (1000, Closed::mesh("triangle box", box_mesh())),
        (1000, Closed::moved("moved triangle box", box_mesh())),
        (928, Closed::new("box", box_mesh(), cube, Vec::new())),
    ];
    let blocks = 40u32;
    assert_eq!(surfaces.iter().map(|s| s.0).sum::<u32>(), 10_000);
    for (number, (share, surface)) in surfaces.iter().enumerate() {
        let each = total / 10_000 * share / blocks;
        let count = |block: u32| {
            let mut rng = Pcg::new(u64::from(block) << 8 | number as u64);
            let sum = |a: (usize, usize), b: (usize, usize)| (a.0 + b.0, a.1 + b.1);
            (0..each).map(|i| surface.leaks(i, &mut rng)).fold((0, 0), sum)
        };
        let sum = |a: (usize, usize), b: (usize, usize)| (a.0 + b.0, a.1 + b.1);
        let (leaks, differ) = (0..blocks).into_par_iter().map(count).reduce(|| (0, 0), sum);
        assert_eq!((leaks, differ), (0, 0), "leaks and differences: {}", surface.name);
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
