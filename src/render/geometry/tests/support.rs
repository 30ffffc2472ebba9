//! Random scenes and rays with fixed seeds.

use super::super::{GeomObject, Geometry, MeshData};
use crate::math::stats::Pcg;
use crate::math::warp::uniform_sphere;
use crate::render::ray::Ray;
use crate::render::shape::{Shape, Solid};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

/// Uniform in [−1, 1].
pub fn signed(rng: &mut Pcg) -> f64 {
    2.0 * rng.next_f64() - 1.0
}

/// Uniform in the cube [−1, 1]³.
pub fn in_cube(rng: &mut Pcg) -> DVec3 {
    DVec3::new(signed(rng), signed(rng), signed(rng))
}

/// Uniform over the unit sphere.
pub fn direction(rng: &mut Pcg) -> Vec3 {
    uniform_sphere(rng.next_vec2())
}

/// A random rotation, stretch (1/3 to 3 by axis), perhaps a mirror, and a move within `reach`.
pub fn random_map(rng: &mut Pcg, size: f64, reach: f64) -> DAffine3 {
    let axis = direction(rng).as_dvec3().normalize();
    let turn = DQuat::from_axis_angle(axis, signed(rng) * 3.0);
    let mut stretch = DVec3::new(signed(rng), signed(rng), signed(rng)).map(|x| 3f64.powf(x)) * size;
    if rng.next_f64() < 0.5 {
        stretch.x = -stretch.x;
    }
    DAffine3::from_mat3_translation(
        DMat3::from_quat(turn) * DMat3::from_diagonal(stretch),
        in_cube(rng) * reach,
    )
}

/// One of each kind of solid, by number.
pub fn solid(kind: usize) -> Solid {
    let flat = DVec3::new(0.7, 0.0, 0.5);
    match kind % 11 {
        0 => Solid::Sphere,
        1 => Solid::Box {
            min: DVec3::splat(-1.0),
            max: DVec3::ONE,
        },
        2 => Solid::Box { min: -flat, max: flat },
        3 => Solid::Cylinder { open: false },
        4 => Solid::Cylinder { open: true },
        5 => Solid::Cone {
            r0: 1.0,
            r1: 0.3,
            open: false,
        },
        6 => Solid::Cone {
            r0: 0.0,
            r1: 1.2,
            open: true,
        },
        7 => Solid::Disc { hole: 0.0 },
        8 => Solid::Disc { hole: 0.6 },
        9 => Solid::Torus {
            major: 1.0,
            minor: 0.25,
        },
        _ => Solid::Torus { major: 0.5, minor: 0.8 },
    }
}

/// Triangles thrown into the unit cube.
pub fn soup(rng: &mut Pcg, count: usize, size: f64) -> MeshData {
    let mut mesh = MeshData::default();
    for _ in 0..count {
        let center = in_cube(rng);
        let first = mesh.positions.len() as u32;
        for _ in 0..3 {
            mesh.positions.push((center + in_cube(rng) * size).as_vec3());
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}

/// A closed mesh: the icosahedron divided `levels` times and pushed onto the unit sphere.
pub fn icosphere(levels: u32) -> MeshData {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        points.push(DVec3::new(0.0, a, b));
        points.push(DVec3::new(a, b, 0.0));
        points.push(DVec3::new(b, 0.0, a));
    }
    let mut faces = Vec::new();
    for i in 0..12u32 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let p = [i, j, k].map(|x| points[x as usize]);
                let near = |a: DVec3, b: DVec3| (a - b).length() < 2.1;
                if near(p[0], p[1]) && near(p[1], p[2]) && near(p[2], p[0]) {
                    let outward = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[0]) > 0.0;
                    faces.push(if outward { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let mut next = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]) / 2.0);
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = next;
        points.iter_mut().for_each(|p| *p = p.normalize());
    }
    MeshData {
        positions: points.iter().map(|p| p.normalize().as_vec3()).collect(),
        triangles: faces,
        ..MeshData::default()
    }
}

/// One mesh in one place.
pub fn single(mesh: MeshData, map: DAffine3) -> Geometry {
    Geometry::build(vec![GeomObject::new(Shape::mesh(0, map), 0)], vec![mesh])
}

/// Everything mixed: solids, spheres, planes, meshes shared by several objects.
pub fn mixed(seed: u64, objects: usize) -> Geometry {
    let mut rng = Pcg::new(seed);
    let meshes = vec![soup(&mut rng, 300, 0.2), icosphere(2), MeshData::default()];
    let mut list = Vec::new();
    for i in 0..objects {
        let map = random_map(&mut rng, 0.3, 4.0);
        let shape = match i % 5 {
            0 => Shape::Sphere {
                center: in_cube(&mut rng) * 4.0,
                radius: 0.1 + rng.next_f64() * 0.5,
            },
            1 | 2 => Shape::placed(solid(rng.next_u32() as usize), map),
            _ => Shape::mesh(rng.next_u32() % 3, map),
        };
        let mut object = GeomObject::new(shape, i as u32);
        object.visibility = 1 + (rng.next_u32() % 7) as u8;
        list.push(object);
    }
    list.push(GeomObject::new(
        Shape::Plane {
            normal: DVec3::Y,
            distance: -4.0,
        },
        0,
    ));
    Geometry::build(list, meshes)
}

/// A ray from somewhere around towards somewhere in the scene.
pub fn random_ray(rng: &mut Pcg, reach: f64) -> Ray {
    let origin = (in_cube(rng) * reach * 1.5).as_vec3();
    let target = (in_cube(rng) * reach).as_vec3();
    let mut ray = Ray::new(origin, target - origin);
    ray.mask = 1 << (rng.next_u32() % 3);
    ray
}
