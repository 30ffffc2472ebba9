//! Instances, mirrors and the unit of length change nothing but what they must.

use super::super::{GeomObject, Geometry, LightMap, MeshData};
use super::support::*;
use crate::math::stats::Pcg;
use crate::render::ray::Ray;
use crate::render::shape::Shape;
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// Oracle: the mesh with its corners moved instead of the rays.
#[test]
fn an_instance_equals_the_flattened_mesh() {
    let mut rng = Pcg::new(1);
    for _ in 0..20 {
        let mesh = soup(&mut rng, 200, 0.3);
        let map = random_map(&mut rng, 1.0, 2.0);
        let mut flat = mesh.clone();
        flat.positions = mesh
            .positions
            .iter()
            .map(|p| map.transform_point3(p.as_dvec3()).as_vec3())
            .collect();
        // A mirror turns the corners' order round.
        flat.flip_winding = map.matrix3.determinant() < 0.0;
        let (instance, flat) = (single(mesh, map), single(flat, DAffine3::IDENTITY));
        let (mut same, mut hits) = (0, 0);
        for _ in 0..500 {
            let start = (in_cube(&mut rng) * 5.0).as_vec3();
            let target = map.transform_point3(in_cube(&mut rng)).as_vec3();
            let ray = Ray::new(start, target - start);
            let (a, b) = (instance.closest(&ray), flat.closest(&ray));
            hits += usize::from(a.is_some() || b.is_some());
            if let (Some(a), Some(b)) = (a, b)
                && a.prim == b.prim
            {
                let (s, q) = (instance.surface(&ray, &a), flat.surface(&ray, &b));
                let grazing = s.ng.dot(ray.dir.normalize()).abs().max(1e-3);
                assert!((a.t - b.t).abs() < 1e-5 / grazing, "{a:?} {b:?}");
                assert!(
                    (s.p - q.p).length() < 2e-5 / grazing && s.ng.dot(q.ng) > 0.999,
                    "{s:?} {q:?}"
                );
                same += 1;
            }
        }
        // Rays within rounding of an edge may choose differently.
        assert!(same + 2 >= hits && hits > 50, "{same} of {hits}");
    }
}

#[test]
fn normals_of_mirrored_and_flipped_meshes_stay_outside() {
    let mut rng = Pcg::new(2);
    for case in 0..40 {
        let mut mesh = icosphere(1);
        mesh.normals = mesh.positions.clone();
        if case % 2 == 0 {
            // The other winding with the flag that says so.
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            mesh.flip_winding = true;
        }
        let map = random_map(&mut rng, 1.0, 1.0);
        let geometry = single(mesh, map);
        for _ in 0..50 {
            let start = map.transform_point3(direction(&mut rng).as_dvec3() * 3.0).as_vec3();
            let ray = Ray::new(start, (map.translation - start.as_dvec3()).as_vec3());
            let hit = geometry.closest(&ray).expect("aimed at the centre");
            let s = geometry.surface(&ray, &hit);
            assert!(s.ng.dot(ray.dir) < 0.0 && s.ns.dot(ray.dir) < 0.3, "{s:?}");
            assert!(s.ng.dot(s.ns) > 0.5 && (s.ng.length() - 1.0).abs() < 1e-6);
        }
    }
}

/// A scene 2^k times as large answers with the same bits, t included (directions grow along).
#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let mut rng = Pcg::new(3);
    let mesh = soup(&mut rng, 300, 0.3);
    let map = random_map(&mut rng, 1.0, 1.0);
    let sphere = DVec3::new(0.3, 0.2, 0.1);
    let build = |k: f64| {
        let scale = DAffine3::from_scale(DVec3::splat(k));
        let objects = vec![
            GeomObject::new(Shape::mesh(0, scale * map), 0),
            GeomObject::new(
                Shape::Sphere {
                    center: sphere * k,
                    radius: 0.3 * k,
                },
                0,
            ),
            GeomObject::new(Shape::placed(solid(9), scale * map), 0),
            GeomObject::new(Shape::placed(solid(5), scale * map), 0),
        ];
        Geometry::build(objects, vec![mesh.clone()])
    };
    let plain = build(1.0);
    for exponent in [-90, -40, -10, 10, 40, 90] {
        let k = 2f64.powi(exponent);
        let scaled = build(k);
        for _ in 0..3000 {
            let ray = random_ray(&mut rng, 2.0);
            let mut large = ray;
            large.origin *= k as f32;
            large.dir *= k as f32;
            let (a, b) = (plain.closest(&ray), scaled.closest(&large));
            assert_eq!(a, b, "2^{exponent}: {ray:?}");
            if let (Some(a), Some(b)) = (a, b) {
                let (s, q) = (plain.surface(&ray, &a), scaled.surface(&large, &b));
                assert_eq!((s.p * k as f32, s.ng, s.ns), (q.p, q.ng, q.ns), "2^{exponent}");
            }
        }
    }
}

#[test]
fn a_degenerate_shading_normal_falls_back_to_the_face() {
    let mesh = MeshData {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::ZERO, Vec3::NAN, -Vec3::Z],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    let geometry = single(mesh, DAffine3::IDENTITY);
    let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
    let hit = geometry.closest(&ray).expect("aimed at it");
    let s = geometry.surface(&ray, &hit);
    assert_eq!((s.ng, s.ns), (Vec3::Z, Vec3::Z));
}

#[test]
fn materials_and_lights_come_by_slot_and_by_triangle() {
    let mut mesh = MeshData {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        face_materials: vec![1, 0],
        ..MeshData::default()
    };
    mesh.uvs = vec![vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE]];
    let mut object = GeomObject::new(Shape::mesh(0, DAffine3::from_scale(DVec3::new(2.0, 3.0, 1.0))), 5);
    object.materials = vec![5, 6];
    object.lights = LightMap::Table(vec![crate::render::surface::Surface::NOT_A_LIGHT, 9]);
    let geometry = Geometry::build(vec![object], vec![mesh]);
    for (x, y, material, light) in [(0.2, 0.2, 6, u32::MAX), (1.8, 2.7, 5, 9)] {
        let ray = Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z);
        let hit = geometry.closest(&ray).expect("aimed at it");
        let s = geometry.surface(&ray, &hit);
        assert_eq!((s.material, s.light), (material, light));
        let a = geometry.attributes(&hit, &s, 0.0);
        assert!((a.uv[0] - Vec2::new(x / 2.0, y / 3.0)).length() < 1e-6 && a.uv[3] == a.uv[0]);
        // u grows along x over 2 units, v along y over 3; the bitangent looks against v.
        assert!((a.tangent - Vec3::X * 2.0).length() < 1e-5 && (a.bitangent + Vec3::Y * 3.0).length() < 1e-5);
    }
}
