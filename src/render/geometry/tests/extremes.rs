//! Boxes that hold what they should, trees over the largest numbers, over one place, and maps that flatten.

use super::super::{GeomObject, Geometry, MeshData};
use super::exact::{Dd, Exact3};
use super::placing::*;
use super::support::*;
use crate::math::robust::{UNIT_ROUNDOFF, offset_origin};
use crate::math::stats::Pcg;
use crate::render::accel::bounds::Bounds;
use crate::render::ray::Ray;
use crate::render::shape::{Shape, Solid};
use crate::render::surface::Surface;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use proptest::prelude::*;

/// The image of a point, exactly.
fn image(map: &DAffine3, p: DVec3) -> Exact3 {
    let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis].map(Exact3::new);
    let along = x.scaled(Dd::new(p.x)) + y.scaled(Dd::new(p.y)) + z.scaled(Dd::new(p.z));
    along + Exact3::new(map.translation)
}

/// Whether a point lies in a box, judged exactly.
fn holds(min: Vec3, max: Vec3, p: Exact3) -> bool {
    (0..3).all(|k| {
        let above = p.0[k] - Dd::new(min[k]);
        let below = Dd::new(max[k]) - p.0[k];
        above.value() >= 0.0 && below.value() >= 0.0
    })
}

#[test]
fn boxes_of_moved_and_stretched_things_hold_every_corner() {
    let ball = icosphere(1);
    for_all(31, 3000, placing(), |p| {
        let map = p.map();
        let mut rng = Pcg::new(p.seed);
        let (center, half) = (in_cube(&mut rng), in_cube(&mut rng).abs());
        let b = Bounds::transformed(&map, center, half);
        for i in 0..8 {
            let sign = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0;
            // The corner itself is a sum in f64; its own rounding is not the box's to hold.
            let corner = center + half * sign;
            prop_assert!(holds(b.min, b.max, image(&map, corner)), "{b:?} without {corner}");
        }
        let (min, max) = single(ball.clone(), map).bounds().expect("it has points");
        for v in &ball.positions {
            prop_assert!(holds(min, max, image(&map, v.as_dvec3())), "{min} {max} without {v}");
        }
        Ok(())
    });
}

/// Flat boxes aimed at by their edges, among many others in a tree: the tree loses none of the hits that the boxes
/// themselves find, and nearly every ray is one.
#[test]
fn rays_at_the_edges_of_flat_boxes_are_not_lost_in_the_tree() {
    let mut rng = Pcg::new(32);
    let flats: Vec<(DVec3, DVec3)> = (0..200)
        .map(|i| {
            let mut half = DVec3::new(0.1 + rng.next_f64(), 0.1 + rng.next_f64(), 0.1 + rng.next_f64());
            half[i % 3] = 0.0;
            (in_cube(&mut rng) * 20.0, half)
        })
        .collect();
    let mut mesh = MeshData::default();
    for (center, half) in &flats {
        let flat = (0..3).find(|&k| half[k] == 0.0).unwrap_or(0);
        let (mut a, mut b) = (DVec3::ZERO, DVec3::ZERO);
        a[(flat + 1) % 3] = half[(flat + 1) % 3];
        b[(flat + 2) % 3] = half[(flat + 2) % 3];
        let first = mesh.positions.len() as u32;
        mesh.positions
            .extend([-a - b, a - b, a + b, b - a].map(|p| (*center + p).as_vec3()));
        mesh.triangles
            .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let boxes = flats.iter().map(|&(c, half)| {
        let shape = Shape::placed(
            Solid::Box {
                min: c - half,
                max: c + half,
            },
            DAffine3::IDENTITY,
        );
        GeomObject::new(shape, 0)
    });
    let boxes = Geometry::build(boxes.collect(), Vec::new());
    let mesh = single(mesh, DAffine3::IDENTITY);
    let (mut hits, mut lost) = ([0, 0], [0, 0]);
    for i in 0..40_000 {
        let (center, half) = flats[i % flats.len()];
        let mut target = center + half * in_cube(&mut rng);
        let side = (i / 200) % 3;
        target[side] = center[side] + half[side];
        let start = (in_cube(&mut rng) * 30.0).as_vec3();
        let mut ray = Ray::new(start, (target - start.as_dvec3()).as_vec3());
        if i % 5 == 0 {
            // Along an axis through a point of the edge.
            let axis = rng.next_u32() as usize % 3;
            ray.origin = target.as_vec3();
            ray.origin[axis] -= 30.0;
            ray.dir = Vec3::AXES[axis];
        }
        for (k, geometry) in [&boxes, &mesh].into_iter().enumerate() {
            let want = geometry.closest_by_force(&ray);
            hits[k] += usize::from(want.is_some());
            lost[k] += usize::from(geometry.closest(&ray) != want);
        }
    }
    assert_eq!(lost, [0, 0]);
    assert!(hits.iter().all(|&n| n > 15_000), "{hits:?}");
}

/// Corners at 10²⁰ … 10³⁸: areas of their boxes overflow f32. The same mesh in a smaller unit, a power of two, gives the
/// same bits; and small triangles beside a huge one are still found.
#[test]
fn triangles_up_to_the_largest_numbers_are_hit_as_small_ones_are() {
    let mut rng = Pcg::new(33);
    let mesh = soup(&mut rng, 500, 0.3);
    let plain = single(mesh.clone(), DAffine3::IDENTITY);
    for exponent in [67, 100, 120, 125, -100] {
        let k = 2f32.powi(exponent);
        let mut large = mesh.clone();
        large.positions.iter_mut().for_each(|p| *p *= k);
        let large = single(large, DAffine3::IDENTITY);
        let mut hits = 0;
        for _ in 0..2000 {
            let ray = random_ray(&mut rng, 1.0);
            let mut scaled = Ray::new(ray.origin * k, ray.dir * k);
            scaled.mask = ray.mask;
            let want = plain.closest(&ray);
            hits += usize::from(want.is_some());
            assert_eq!(large.closest(&scaled), want, "2^{exponent}: {ray:?}");
        }
        assert!(hits > 500, "{hits}");
    }
    for huge in [1e20f32, 1e30, 1e37] {
        let mut both = mesh.clone();
        let first = both.positions.len() as u32;
        both.positions.extend([
            Vec3::new(-huge, -3.0, -huge),
            Vec3::new(huge, -3.0, -huge),
            Vec3::new(0.0, -3.0, huge),
        ]);
        both.triangles.push([first, first + 1, first + 2]);
        let both = single(both, DAffine3::IDENTITY);
        for _ in 0..500 {
            // In the unit of the huge triangle the small ones keep no digits; but nothing breaks, and the large one is found.
            let from = Vec3::new(rng.next_f32(), 2.0, rng.next_f32());
            let hit = both.closest(&Ray::new(from * (huge * 1e-3), -Vec3::Y));
            assert!(hit.is_some_and(|h| h.t.is_finite() && h.prim.prim == 500), "{hit:?}");
        }
    }
    // As objects of their own they keep them all: each has its own unit.
    let far = DVec3::new(0.0, -1e30, 0.0);
    let huge = DAffine3::from_translation(far) * DAffine3::from_scale(DVec3::splat(1e29));
    let objects = [DAffine3::IDENTITY, huge]
        .map(|m| GeomObject::new(Shape::mesh(0, m), 0))
        .to_vec();
    let both = Geometry::build(objects, vec![mesh]);
    for _ in 0..1000 {
        let ray = random_ray(&mut rng, 1.0);
        if let Some(want) = plain.closest(&ray) {
            assert_eq!(both.closest(&ray), Some(want), "{ray:?}");
        }
    }
}

/// Where all centres coincide the tree stays flat: eight children a node, so 10⁵ triangles in leaves of four need
/// log₈ 25 000 < 5 levels and one more for the odd ones; granted are 8. In less than 5 seconds.
#[test]
fn identical_centres_give_a_shallow_tree_in_time() {
    let square = |r: f32| [(-r, -r), (r, -r), (0.0, r)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let sizes: [&dyn Fn(u32) -> f32; 2] = [&|_| 1.0, &|i| 1.0 + i as f32 * 1e-5];
    for size in sizes {
        let mut mesh = MeshData::default();
        for i in 0..100_000 {
            mesh.positions.extend(square(size(i)));
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let started = std::time::Instant::now();
        let geometry = single(mesh, DAffine3::IDENTITY);
        assert!(started.elapsed().as_secs() < 5, "{:?}", started.elapsed());
        let depth = geometry.tree.mesh(0).expect("it is there").depth();
        assert!(depth <= 8, "{depth} levels");
        let hit = geometry.closest(&Ray::new(Vec3::new(0.1, 0.1, 1.0), -Vec3::Z));
        assert!(hit.is_some_and(|h| (h.t - 1.0).abs() < 1e-6), "{hit:?}");
    }
}

/// Maps that flatten to a plane or a line but for rounding (compilation refuses those that do so exactly): all answers are
/// finite, with unit normals, and nothing panics.
#[test]
fn maps_that_nearly_flatten_give_finite_answers() {
    let mut rng = Pcg::new(34);
    let mut hits = 0;
    for case in 0..2000 {
        let turn = random_map(&mut rng, 1.0, 0.0).matrix3;
        let other = random_map(&mut rng, 1.0, 0.0).matrix3;
        let thin = [1e-16, 1e-30, 1e-100, 1e-250, 0.0][case % 5];
        let scale = if case % 2 == 0 {
            DVec3::new(1.0, thin, 1.0)
        } else {
            DVec3::new(thin, thin, 1.0)
        };
        let map = DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(scale) * other, in_cube(&mut rng));
        if !map.inverse().is_finite() {
            continue;
        }
        let shape = if case % 3 == 0 {
            Shape::mesh(0, map)
        } else {
            Shape::placed(solid(case), map)
        };
        let geometry = Geometry::build(vec![GeomObject::new(shape, 0)], vec![icosphere(1)]);
        for _ in 0..10 {
            let start = (in_cube(&mut rng) * 4.0).as_vec3();
            let target = map.transform_point3(in_cube(&mut rng) * 0.5);
            let ray = Ray::new(start, (target - start.as_dvec3()).as_vec3());
            let Some(hit) = geometry.closest(&ray) else { continue };
            hits += 1;
            let s = geometry.surface(&ray, &hit);
            assert!(hit.t.is_finite() && s.p.is_finite(), "{map:?}: {s:?}");
            assert!((s.ng.length() - 1.0).abs() < 1e-6 && s.ns.is_finite(), "{map:?}: {s:?}");
        }
    }
    assert!(hits > 1000, "{hits}");
}

/// Slabs as thin as a hundred roundings of where they stand: a ray that enters finds the far side, a ray that leaves there
/// does not come back. As boxes and as two sheets of a mesh.
#[test]
fn thin_slabs_are_entered_and_left() {
    let mut rng = Pcg::new(35);
    let mut crossed = 0;
    for case in 0..600 {
        let thickness = [1e-5, 1e-4, 1e-2, 1.0, 1e2][case % 5];
        let wide = if thickness < 1e-3 { 1.0 } else { 10f64.max(thickness) };
        let half = DVec3::new(wide, thickness * 0.5, wide);
        let turn = DMat3::from_quat(glam::DQuat::from_scaled_axis(in_cube(&mut rng) * 3.0));
        let place = in_cube(&mut rng) * if thickness < 1e-3 { 1.0 } else { 100.0 };
        let map = DAffine3::from_mat3_translation(turn, place);
        let geometry = if case % 2 == 0 {
            let shape = Shape::placed(Solid::Box { min: -half, max: half }, map);
            Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new())
        } else {
            let mut mesh = MeshData::default();
            for (y, order) in [(half.y, [0, 2, 1]), (-half.y, [0, 1, 2])] {
                let first = mesh.positions.len() as u32;
                for (x, z) in [(-wide, -wide), (wide, -wide), (-wide, wide), (wide, wide)] {
                    mesh.positions.push(DVec3::new(x, y, z).as_vec3());
                }
                mesh.triangles.push(order.map(|i| first + i));
                mesh.triangles.push(order.map(|i| first + 3 - i));
            }
            single(mesh, map)
        };
        for _ in 0..20 {
            let mut above =
                |y: f64| map.transform_point3(DVec3::new(signed(&mut rng), y, signed(&mut rng)) * (0.3 * wide));
            let (target, start) = (above(0.0), above(1.0 + 2.0 * thickness / wide));
            let ray = Ray::new(start.as_vec3(), (target - start).normalize().as_vec3());
            let first = geometry.closest(&ray).expect("aimed at it");
            let near = geometry.surface(&ray, &first);
            assert!(near.ng.dot(ray.dir) < 0.0, "{near:?}");
            let inside = leave(&near, ray.dir);
            let second = geometry.closest(&inside);
            let second = second.unwrap_or_else(|| panic!("no far side: {thickness} thick, {inside:?}"));
            let far = geometry.surface(&inside, &second);
            assert!(far.ng.dot(ray.dir) > 0.0, "{thickness} thick: {far:?}");
            assert!(geometry.closest(&leave(&far, ray.dir)).is_none());
            // Through and through: the thickness over the cosine, but for the roundings of both points, some 20 each.
            let cos = f64::from(-near.ng.dot(ray.dir));
            let way = (far.p - near.p).as_dvec3().length();
            let rounding = 40.0 * f64::from(f32::EPSILON) * (near.p.as_dvec3().length() + wide) / cos;
            assert!(
                (way - thickness / cos).abs() <= rounding,
                "{way} through {thickness}, cosine {cos}"
            );
            crossed += 1;
        }
    }
    assert_eq!(crossed, 12_000);
}

fn leave(s: &Surface, w: Vec3) -> Ray {
    Ray {
        from: s.prim,
        ..Ray::new(offset_origin(s.p, s.p_error, s.ng, w), w)
    }
}

/// Triangles down to the smallest numbers: their normals are exact and they are hit, none is taken for empty.
#[test]
fn triangles_of_any_smallness_have_a_normal_and_are_hit() {
    let mut rng = Pcg::new(36);
    for exponent in [-5, -10, -15, -20, -30, -36] {
        for _ in 0..200 {
            let size = 10f64.powi(exponent);
            let corners = [0; 3].map(|_| (in_cube(&mut rng) * size).as_vec3());
            let mesh = MeshData {
                positions: corners.to_vec(),
                triangles: vec![[0, 1, 2]],
                ..MeshData::default()
            };
            let [a, b, c] = corners.map(|v| Exact3::new(v.as_dvec3()));
            let n = (b - a).cross(c - a);
            let n = n.scaled(Dd::new(1.0) / n.dot(n).sqrt()).value();
            let middle = (a + b + c).scaled(Dd::new(1.0) / Dd::new(3.0)).value();
            let geometry = single(mesh, DAffine3::IDENTITY);
            let ray = Ray::new((middle + n * size).as_vec3(), (n * -size).as_vec3());
            let hit = geometry.closest(&ray).expect("aimed at its middle");
            let s = geometry.surface(&ray, &hit);
            let off = (s.ng.as_dvec3() - n).abs().max_element();
            assert!(
                off <= 4.0 * f64::from(UNIT_ROUNDOFF),
                "10^{exponent}: {} instead of {n}",
                s.ng
            );
        }
    }
}
