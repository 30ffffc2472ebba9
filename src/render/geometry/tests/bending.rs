//! Meshes that change their form against the same meshes built in the form that they have at a time.

use super::support::{direction, icosphere, in_cube, random_map, signed};
use crate::math::stats::Pcg;
use crate::render::bend::{Bend, Form};
use crate::render::geometry::{GeomObject, Geometry, MeshData};
use crate::render::motion::Motion;
use crate::render::ray::Ray;
use crate::render::shape::Shape;
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

/// A ball that is pressed, bent and blown up on its way.
fn ball(rng: &mut Pcg, forms: usize) -> MeshData {
    let mut mesh = icosphere(2);
    mesh.normals = mesh.positions.clone();
    let mut form = |k: usize| {
        let (stretch, twist) = (in_cube(rng) * 0.4 + DVec3::splat(1.2), signed(rng) * 0.6);
        let place = |p: &Vec3| {
            let p = p.as_dvec3() * if k == 0 { DVec3::ONE } else { stretch };
            let turned = glam::DQuat::from_rotation_y(if k == 0 { 0.0 } else { twist * p.y });
            (turned * p).as_vec3()
        };
        let positions: Vec<Vec3> = mesh.positions.iter().map(place).collect();
        Form {
            normals: positions.iter().map(|p| p.normalize()).collect(),
            positions,
        }
    };
    let bend = Bend::new((0..forms).map(&mut form).collect()).expect("it bends");
    mesh.positions = bend.forms()[0].positions.clone();
    mesh.normals = bend.forms()[0].normals.clone();
    mesh.bend = Some(Arc::new(bend));
    mesh
}

/// The mesh as it is at a time, standing still.
fn frozen(mesh: &MeshData, time: f32) -> MeshData {
    let forms = mesh.bend.as_ref().map_or(&[][..], |b| b.forms());
    let x = f64::from(time) * (forms.len() - 1) as f64;
    let i = (x as usize).min(forms.len() - 2);
    let w = (x - i as f64) as f32;
    let mix = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| *a + (*b - *a) * w).collect();
    MeshData {
        positions: mix(&forms[i].positions, &forms[i + 1].positions),
        normals: mix(&forms[i].normals, &forms[i + 1].normals),
        bend: None,
        ..mesh.clone()
    }
}

fn placed(map: DAffine3, motion: Option<Motion>) -> GeomObject {
    GeomObject {
        motion: motion.map(Box::new),
        ..GeomObject::new(Shape::mesh(0, map), 0)
    }
}

/// Bit by bit: units of trees are powers of two, and the same corners are met.
#[test]
fn a_bending_mesh_is_hit_where_it_is() {
    let mut rng = Pcg::new(771);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..60 {
        let mesh = ball(&mut rng, 2 + round % 4);
        let map = random_map(&mut rng, 1.0, 2.0);
        let geometry = Geometry::build(vec![placed(map, Some(Motion::still()))], vec![mesh.clone()]);
        let time = [rng.next_f32(), 0.0, 1.0][round % 3];
        let still = Geometry::build(vec![placed(map, None)], vec![frozen(&mesh, time)]);
        for _ in 0..200 {
            let from = (in_cube(&mut rng) * 6.0).as_vec3();
            let at = (in_cube(&mut rng) * 3.0).as_vec3();
            let ray = Ray {
                time,
                ..Ray::new(from, at - from)
            };
            let (a, b) = (geometry.closest(&ray), still.closest(&ray));
            assert_eq!(a.map(|h| (h.prim, h.exact)), b.map(|h| (h.prim, h.exact)), "{ray:?}");
            assert_eq!(a.map(|h| h.prim), geometry.closest_by_force(&ray).map(|h| h.prim));
            assert_eq!(geometry.occluded(&ray), still.occluded(&ray));
            let (Some(a), Some(b)) = (a, b) else {
                misses += 1;
                continue;
            };
            hits += 1;
            let (s, t) = (geometry.surface(&ray, &a), still.surface(&ray, &b));
            assert_eq!((s.exact(), s.ng, s.ns), (t.exact(), t.ng, t.ns), "{ray:?}");
            assert!(geometry.reaches(&Ray { to: a.prim, ..ray }), "{ray:?}");
        }
    }
    assert!(hits > 1000 && misses > 1000, "{hits} hits, {misses} misses");
}

/// Triangles that share a vertex share it at all times: no ray from inside gets out.
#[test]
fn a_bending_ball_keeps_its_rays() {
    let mut rng = Pcg::new(772);
    for round in 0..20 {
        let mesh = ball(&mut rng, 3);
        let geometry = Geometry::build(vec![placed(DAffine3::IDENTITY, None)], vec![mesh.clone()]);
        for i in 0..2000 {
            let time = rng.next_f32();
            // At vertices and edges, where neighbours meet.
            let now = frozen(&mesh, time);
            let [a, b, _] = now.corners(i % now.triangles.len() as u32).expect("a triangle");
            let dir = match i % 3 {
                0 => a,
                1 => a + (b - a) * rng.next_f32(),
                _ => direction(&mut rng),
            };
            let ray = Ray {
                time,
                ..Ray::new(Vec3::ZERO, dir)
            };
            assert!(geometry.closest(&ray).is_some(), "round {round}: {ray:?} gets out");
        }
    }
}

/// The whole may move as well: a form in another place.
#[test]
fn bending_and_moving_go_together() {
    let mut rng = Pcg::new(773);
    let mesh = ball(&mut rng, 2);
    let shift = DVec3::new(3.0, -1.0, 2.0);
    let motion = Motion::new(vec![DAffine3::IDENTITY, DAffine3::from_translation(shift)]);
    let geometry = Geometry::build(vec![placed(DAffine3::IDENTITY, motion)], vec![mesh.clone()]);
    for time in [0.0, 0.25, 0.5, 1.0] {
        let there = DAffine3::from_translation(shift * f64::from(time));
        let still = Geometry::build(vec![placed(there, None)], vec![frozen(&mesh, time)]);
        for _ in 0..500 {
            let from = (in_cube(&mut rng) * 8.0).as_vec3();
            let at = (in_cube(&mut rng) * 3.0).as_vec3();
            let ray = Ray {
                time,
                ..Ray::new(from, at - from)
            };
            let (a, b) = (geometry.closest(&ray), still.closest(&ray));
            assert_eq!(a.map(|h| h.prim), b.map(|h| h.prim), "{ray:?}");
        }
    }
}
