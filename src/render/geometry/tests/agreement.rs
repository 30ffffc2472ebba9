//! Trees, instruction sets and brute force give the same bits.

use super::super::{GeomObject, Geometry, MeshData};
use super::support::*;
use crate::math::stats::Pcg;
use crate::render::accel::scene::Instructions;
use crate::render::ray::{PrimRef, Ray};
use crate::render::shape::Shape;
use crate::render::technique::{BuildPreset, Choice};
use glam::{DAffine3, DVec3, Vec3};

/// Oracle: every primitive tested, no boxes.
fn agrees_with_brute_force(geometry: &mut Geometry, seed: u64, rays: usize, reach: f64) {
    let mut rng = Pcg::new(seed);
    let mut hits = 0;
    for i in 0..rays {
        let mut ray = random_ray(&mut rng, reach);
        if i % 3 == 0 {
            ray.t_max = rng.next_f32() * 2.0;
        }
        if i % 4 == 0 {
            ray.dir[i / 4 % 3] = 0.0;
        }
        let want = geometry.closest_by_force(&ray);
        for instructions in [Instructions::Baseline, Instructions::detect()] {
            geometry.use_instructions(instructions);
            assert_eq!(geometry.closest(&ray), want, "{instructions:?}, ray {i}: {ray:?}");
            assert_eq!(
                geometry.occluded(&ray),
                want.is_some(),
                "{instructions:?}, ray {i}: {ray:?}"
            );
        }
        hits += usize::from(want.is_some());
        // Go on from the hit, so that rays that start on surfaces and ends that do not block are met too.
        if let Some(hit) = want {
            let surface = geometry.surface(&ray, &hit);
            let w = direction(&mut rng);
            let mut next = Ray::new(
                crate::math::robust::offset_origin(surface.p, surface.p_error, surface.ng, w),
                w,
            );
            next.from = hit.prim;
            next.to = PrimRef {
                object: rng.next_u32() % 16,
                prim: rng.next_u32() % 4,
            };
            let want = geometry.closest_by_force(&next);
            assert_eq!(geometry.closest(&next), want, "{next:?}");
            assert_eq!(geometry.occluded(&next), want.is_some(), "{next:?}");
        }
    }
    assert!(hits > rays / 20, "only {hits} of {rays} rays hit anything");
}

/// The trees differ, what they find does not; brute force judges.
#[test]
fn trees_of_all_presets_agree_with_brute_force() {
    let mut trees = Vec::new();
    for (preset, word, _) in BuildPreset::ALL {
        let mesh = soup(&mut Pcg::new(31), 3000, 0.1);
        let objects = vec![GeomObject::new(Shape::mesh(0, DAffine3::IDENTITY), 0)];
        let mut geometry = Geometry::build_as(*preset, objects, vec![mesh]);
        agrees_with_brute_force(&mut geometry, 32, 200, 1.0);
        trees.push((word, format!("{:?}", geometry.tree)));
    }
    for (i, (word, tree)) in trees.iter().enumerate() {
        assert!(
            trees[i + 1..].iter().all(|(_, other)| other != tree),
            "{word} builds no tree of its own"
        );
    }
}

#[test]
fn trees_agree_with_brute_force_on_meshes() {
    let mut rng = Pcg::new(1);
    for (count, size) in [(1, 1.0), (5, 1.0), (40, 0.5), (3000, 0.1)] {
        let map = random_map(&mut rng, 1.0, 1.0);
        let mut geometry = single(soup(&mut rng, count, size), map);
        let rays = if count == 3000 { 4000 } else { 2000 };
        let inside = map.inverse();
        let reach = 1.0 / inside.matrix3.determinant().abs().cbrt();
        if count > 5 {
            agrees_with_brute_force(&mut geometry, 2 + count as u64, rays, reach);
        }
    }
}

#[test]
fn trees_agree_with_brute_force_on_mixed_scenes() {
    for (seed, objects) in [(3, 12), (4, 60), (5, 300)] {
        agrees_with_brute_force(&mut mixed(seed, objects), seed + 100, 4000, 4.0);
    }
}

/// Small things beside large ones: areas of boxes under- and overflow f32, and the tree must not care.
#[test]
fn trees_agree_with_brute_force_over_forty_orders_of_magnitude() {
    let mut rng = Pcg::new(6);
    let mut objects = Vec::new();
    for i in 0..80 {
        let size = 10f64.powi(i % 40 - 20);
        let map = random_map(&mut rng, size, 0.0);
        let shape = match i % 3 {
            0 => Shape::Sphere {
                center: in_cube(&mut rng) * size * 2.0,
                radius: size * 0.3,
            },
            1 => Shape::placed(solid(i as usize), map),
            _ => Shape::mesh(0, map),
        };
        objects.push(GeomObject::new(shape, 0));
    }
    let geometry = Geometry::build(objects, vec![soup(&mut rng, 50, 0.3)]);
    let mut hits = 0;
    for i in 0..8000 {
        let size = 10f64.powi(i % 40 - 20);
        let mut ray = random_ray(&mut rng, size);
        ray.mask = 7;
        let want = geometry.closest_by_force(&ray);
        assert_eq!(geometry.closest(&ray), want, "{ray:?}");
        hits += usize::from(want.is_some());
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn trees_too_deep_for_the_stack_answer_from_the_heap() {
    let mut geometry = mixed(7, 100);
    geometry.tree.pretend_deep();
    agrees_with_brute_force(&mut geometry, 8, 1000, 4.0);
}

#[test]
fn an_empty_geometry_is_never_hit() {
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let nothing = Geometry::build(Vec::new(), Vec::new());
    let empty_mesh = single(MeshData::default(), DAffine3::IDENTITY);
    let no_mesh = Geometry::build(vec![GeomObject::new(Shape::mesh(7, DAffine3::IDENTITY), 0)], Vec::new());
    for geometry in [nothing, empty_mesh, no_mesh] {
        assert_eq!(geometry.closest(&ray), None);
        assert!(!geometry.occluded(&ray) && geometry.bounds().is_none());
    }
}

#[test]
fn triangles_with_missing_or_infinite_corners_are_never_hit() {
    let mesh = MeshData {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::INFINITY), Vec3::NAN],
        triangles: vec![[0, 1, 9], [0, 1, 3], [4, 1, 2], [0, 1, 2], [0, 0, 0], [1, 2, 2]],
        ..MeshData::default()
    };
    let geometry = single(mesh, DAffine3::IDENTITY);
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    assert_eq!(geometry.closest(&ray).map(|h| h.prim.prim), Some(3));
    // Rays that make no sense hit nothing and end.
    for (o, d) in [
        (Vec3::NAN, Vec3::X),
        (Vec3::ZERO, Vec3::NAN),
        (Vec3::ZERO, Vec3::ZERO),
        (Vec3::INFINITY, Vec3::X),
    ] {
        assert_eq!(geometry.closest(&Ray::new(o, d)), None);
    }
}

/// Coincident primitives: the lower one answers, whatever the tree looks like.
#[test]
fn of_two_hits_at_equal_t_the_lower_primitive_wins() {
    let mut rng = Pcg::new(9);
    let mut mesh = soup(&mut rng, 50, 0.3);
    let copy: Vec<_> = mesh.triangles.clone();
    mesh.triangles.extend(copy.iter().rev());
    let object = || GeomObject::new(Shape::mesh(0, DAffine3::from_translation(DVec3::splat(0.1))), 0);
    let sphere = || {
        GeomObject::new(
            Shape::Sphere {
                center: DVec3::ZERO,
                radius: 0.2,
            },
            0,
        )
    };
    let geometry = Geometry::build(vec![sphere(), object(), object(), sphere()], vec![mesh]);
    let mut hits = 0;
    for _ in 0..5000 {
        let ray = random_ray(&mut rng, 1.0);
        if let Some(hit) = geometry.closest(&ray) {
            assert!(hit.prim.object <= 1 && hit.prim.prim < 50, "{hit:?}");
            hits += 1;
        }
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn a_hundred_thousand_identical_triangles_build_and_answer() {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = MeshData {
        positions,
        triangles: vec![[0, 1, 2]; 100_000],
        ..MeshData::default()
    };
    let geometry = single(mesh, DAffine3::IDENTITY);
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    assert_eq!(geometry.closest(&ray).map(|h| h.prim.prim), Some(0));
    assert!(geometry.occluded(&ray));
}

/// Almost equal triangles: every box overlaps every other one.
#[test]
fn twenty_thousand_nearly_identical_triangles_build_quickly() {
    let mut rng = Pcg::new(21);
    let mut mesh = MeshData::default();
    for i in 0..20_000u32 {
        for corner in [Vec3::ZERO, Vec3::X, Vec3::Y] {
            mesh.positions.push(corner + (in_cube(&mut rng) * 1e-6).as_vec3());
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let started = std::time::Instant::now();
    let mut geometry = single(mesh, DAffine3::IDENTITY);
    assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
    agrees_with_brute_force(&mut geometry, 22, 100, 0.5);
}

/// In a row of equal triangles no neighbour is nearer than the other.
#[test]
fn a_long_row_of_equal_triangles_builds_quickly() {
    let mut mesh = MeshData::default();
    for i in 0..30_000u32 {
        let x = i as f32;
        mesh.positions.extend([
            Vec3::new(x, 0.0, 0.0),
            Vec3::new(x + 1.0, 0.0, 0.0),
            Vec3::new(x, 1.0, 0.0),
        ]);
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let started = std::time::Instant::now();
    let geometry = single(mesh, DAffine3::IDENTITY);
    assert!(started.elapsed().as_secs() < 5, "{:?}", started.elapsed());
    let ray = Ray::new(Vec3::new(29_000.25, 0.25, 1.0), -Vec3::Z);
    assert_eq!(geometry.closest(&ray).map(|h| h.prim.prim), Some(29_000));
}

/// Concentric boxes have one centre and, on the builder's curve, one place.
#[test]
fn nested_triangles_around_one_centre_build_quickly() {
    let mut mesh = MeshData::default();
    for i in 0..20_000u32 {
        let r = 1.0 + i as f32 / 1000.0;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)] {
            mesh.positions.push(Vec3::new(x * r, y * r, 0.0));
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let started = std::time::Instant::now();
    let mut geometry = single(mesh, DAffine3::IDENTITY);
    assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
    agrees_with_brute_force(&mut geometry, 8, 60, 2.0);
}
