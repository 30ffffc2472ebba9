//! What robustness costs: each measure against its naive form, side by side in one run.

use crate::naive;
use glam::{Vec3, Vec4};
use pts::math::robust::offset_origin;
use pts::math::stats::Pcg;
use pts::math::warp::uniform_sphere;
use pts::render::accel::triangle::{Line, ShearedRay, TriangleBlock};
use pts::render::film::TileFilm;
use pts::render::ray::Ray;
use pts::render::shape::candidates::Candidates;
use pts::render::shape::sphere;
use std::fmt;
use std::hint::black_box;
use std::time::Instant;

/// Nanoseconds of a measure, done the usual way and the robust way.
pub struct Price {
    /// What is measured.
    pub what: &'static str,
    /// The usual way.
    pub naive: f64,
    /// As pts does it.
    pub robust: f64,
}

impl fmt::Display for Price {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Price { what, naive, robust } = self;
        write!(
            f,
            "price    {what}: usual {naive:.2} ns, robust {robust:.2} ns, ratio {:.2}",
            robust / naive
        )
    }
}

const ROUNDS: usize = 31;
const ITEMS: usize = 4096;

/// Median nanoseconds an item of two ways to do the same with one item.
fn compare(what: &'static str, mut naive: impl FnMut(usize) -> f32, mut robust: impl FnMut(usize) -> f32) -> Price {
    by_turns(
        what,
        || black_box((0..ITEMS).map(&mut naive).sum::<f32>()),
        || black_box((0..ITEMS).map(&mut robust).sum::<f32>()),
    )
}

/// The same where each way does all items at once.
fn by_turns<A, B>(what: &'static str, mut naive: impl FnMut() -> A, mut robust: impl FnMut() -> B) -> Price {
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        times[0].push(seconds(&mut naive));
        times[1].push(seconds(&mut robust));
    }
    let [naive, robust] = times.map(|mut t| {
        t.sort_by(f64::total_cmp);
        t[ROUNDS / 2] / ITEMS as f64 * 1e9
    });
    Price { what, naive, robust }
}

fn seconds<T>(work: &mut impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

/// All measures.
pub fn measure() -> Vec<Price> {
    vec![spheres(), triangles(), offsets(), sums()]
}

fn directions(seed: u64) -> Vec<Vec3> {
    let mut rng = Pcg::new(seed);
    (0..ITEMS).map(|_| uniform_sphere(rng.next_vec2())).collect()
}

fn spheres() -> Price {
    let directions = directions(1);
    let center = Vec3::new(0.3, 0.2, 0.4);
    compare(
        "ray against sphere: f32 for unit directions, and f64 by the foot of the perpendicular",
        |i| naive::sphere(-center, directions[i], Vec3::ZERO, 0.9, naive::EPS).unwrap_or(0.0),
        |i| {
            let d = directions[i].as_dvec3();
            let dd = d.length_squared();
            sphere::distance((-center).as_dvec3().to_array(), d.to_array(), dd, 1.0 / dd, 0.81, false) as f32
        },
    )
}

/// Möller and Trumbore's test of four triangles at a time, in the same layout as the watertight one.
fn four_at_once(o: Vec3, d: Vec3, block: &TriangleBlock) -> f32 {
    let corner = |k: usize, axis: usize| block.corners[k][axis];
    let edge = |k: usize| [0, 1, 2].map(|axis| corner(k, axis) - corner(0, axis));
    let cross = |a: [Vec4; 3], b: [Vec4; 3]| {
        [1, 2, 0].map(|y: usize| {
            let z = (y + 1) % 3;
            a[y] * b[z] - a[z] * b[y]
        })
    };
    let dot = |a: [Vec4; 3], b: [Vec4; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (e1, e2) = (edge(1), edge(2));
    let d = d.to_array().map(Vec4::splat);
    let s = [0, 1, 2].map(|axis| Vec4::splat(o[axis]) - corner(0, axis));
    let p = cross(d, e2);
    let inv = Vec4::ONE / dot(e1, p);
    let u = dot(s, p) * inv;
    let q = cross(s, e1);
    let (v, t) = (dot(d, q) * inv, dot(e2, q) * inv);
    let zero = Vec4::ZERO;
    let hit = u.cmpge(zero) & v.cmpge(zero) & (u + v).cmple(Vec4::ONE) & t.cmpgt(zero);
    Vec4::select(hit, t, Vec4::INFINITY).min_element()
}

fn triangles() -> Price {
    let mut rng = Pcg::new(2);
    let corner = |rng: &mut Pcg| uniform_sphere(rng.next_vec2()) * 0.4;
    let blocks: Vec<TriangleBlock> = (0..64)
        .map(|_| {
            let four: Vec<_> = (0..4).map(|i| (i, [0, 1, 2].map(|_| corner(&mut rng)))).collect();
            TriangleBlock::new(&four)
        })
        .collect();
    let directions = directions(3);
    let start = |i: usize| directions[(i + 7) % ITEMS];
    let toward = |i: usize| directions[i] * 0.3 - start(i);
    compare(
        "ray against eight leaves of four triangles: Möller–Trumbore, and watertight with the ray's shear",
        |i| {
            let leaves = (0..8).map(|k| four_at_once(start(i), toward(i), &blocks[(i + k) % 64]));
            leaves.fold(f32::INFINITY, f32::min)
        },
        |i| {
            let ray = Ray::new(start(i), toward(i));
            let line = Line {
                o: ray.origin.as_dvec3(),
                d: ray.direction(),
            };
            let (mut found, sheared) = (Candidates::new(&ray), ShearedRay::new(line, 0.0));
            (0..8).for_each(|k| sheared.intersect(&blocks[(i + k) % 64], &mut found));
            found.t
        },
    )
}

fn offsets() -> Price {
    let directions = directions(4);
    compare(
        "start of the next ray: p + 1e-4·n, and by the error bound",
        |i| {
            let (p, n) = (directions[i], directions[(i + 1) % ITEMS]);
            let w = directions[(i + 2) % ITEMS];
            (p + n * naive::EPS.copysign(w.dot(n))).x
        },
        |i| {
            let (p, n) = (directions[i], directions[(i + 1) % ITEMS]);
            offset_origin(p, p.abs() * 1e-7, n, directions[(i + 2) % ITEMS]).x
        },
    )
}

fn sums() -> Price {
    let values = directions(5);
    by_turns(
        "a sample into its pixel's sum: f32 in a row, and a fixed tree in f64",
        || {
            let mut sum = [0.0f32; 3];
            for value in &values {
                let v = black_box(*value).to_array();
                (0..3).for_each(|c| sum[c] += v[c]);
            }
            sum
        },
        || {
            let mut film = TileFilm::new(1, 1, 3, 0);
            film.extend(ITEMS as u32, |_, i, out| {
                out.copy_from_slice(&black_box(values[i as usize]).to_array().map(f64::from));
            });
            film
        },
    )
}
