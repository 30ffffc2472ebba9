//! Speed of the parts that a render spends its time in: `cargo bench`.
//! Compare figures of one run with each other; from hour to hour machines drift by a quarter.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use pts::math::stats::Pcg;
use pts::math::warp::uniform_sphere;
use pts::render::bsdf::Bsdf;
use pts::render::bsdf::diffuse::Diffuse;
use pts::render::geometry::{GeomObject, Geometry, MeshData};
use pts::render::ray::Ray;
use pts::render::sampler::{Group, Sampler};
use pts::render::shape::Shape;
use std::hint::black_box;

/// The walls and balls of the lecture's box.
fn spheres() -> Geometry {
    let walls = [
        (1e5, [1e5 + 1.0, 40.8, 81.6]),
        (1e5, [-1e5 + 99.0, 40.8, 81.6]),
        (1e5, [50.0, 40.8, 1e5]),
        (1e5, [50.0, 40.8, -1e5 + 170.0]),
        (1e5, [50.0, 1e5, 81.6]),
        (1e5, [50.0, -1e5 + 81.6, 81.6]),
        (16.5, [27.0, 16.5, 47.0]),
        (16.5, [73.0, 16.5, 78.0]),
        (600.0, [50.0, 681.33, 81.6]),
    ];
    let object = |(radius, center): (f64, [f64; 3])| {
        let center = DVec3::from(center);
        GeomObject::new(Shape::Sphere { center, radius }, 0)
    };
    Geometry::build(walls.map(object).to_vec(), Vec::new())
}

/// A bumpy sphere of about 2·n² triangles.
fn mesh(n: u32) -> Geometry {
    let point = |i: u32, j: u32| {
        let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
        uniform_sphere(Vec2::new(v, u % 1.0)) * (10.0 + (40.0 * u).fract() * (30.0 * v).fract())
    };
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| point(i, j))).collect();
    let corner = |i: u32, j: u32| j * (n + 1) + i;
    let quads = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let data = MeshData {
        positions,
        triangles: triangles.collect(),
        ..MeshData::default()
    };
    Geometry::build(vec![GeomObject::new(Shape::mesh(0, DAffine3::IDENTITY), 0)], vec![data])
}

fn rays(center: Vec3, count: usize) -> Vec<Ray> {
    let mut rng = Pcg::new(1);
    (0..count)
        .map(|_| Ray::new(center, uniform_sphere(rng.next_vec2())))
        .collect()
}

fn kernels(c: &mut Criterion) {
    let (box_of_spheres, ball) = (spheres(), mesh(300));
    let inside = rays(Vec3::new(50.0, 40.0, 80.0), 1024);
    let from_center = rays(Vec3::ZERO, 1024);
    let mut next = 0;
    let mut turn = move || {
        next = (next + 1) % 1024;
        next
    };
    c.bench_function("nearest of nine spheres", |b| {
        b.iter(|| box_of_spheres.closest(&inside[turn()]))
    });
    c.bench_function("nearest of 180 000 triangles", |b| {
        b.iter(|| ball.closest(&from_center[turn()]))
    });
    c.bench_function("four sample numbers", |b| {
        b.iter(|| Sampler::new(0, 7, black_box(turn() as u64), 4).get4(3, Group::Light));
    });
    let diffuse = Bsdf::Diffuse(Diffuse {
        albedo: Vec3::splat(0.5),
    });
    c.bench_function("a diffuse direction", |b| {
        b.iter(|| diffuse.sample(Vec3::Z, black_box(Vec2::new(0.3, 0.6)), 0.5));
    });
}

criterion_group!(benches, kernels);
criterion_main!(benches);
