//! How far a scene reaches in given directions: the support function of everything visible in it.

use crate::scene::{Mesh, Object, Scene, Shape};
use glam::{DAffine3, DVec3};
use std::collections::HashMap;

/// Vertices looked at before boxes must do.
const MAX_VERTICES: usize = 30_000_000;
/// Objects looked at before boxes must do (groups inside groups multiply).
const MAX_OBJECTS: usize = 3_000_000;
/// Nesting of groups that is followed.
const MAX_DEPTH: usize = 200;

/// For each direction a the greatest a·p over all points p of all finite visible shapes; `None` if there are none.
pub(super) fn farthest<const N: usize>(scene: &Scene, directions: [DVec3; N]) -> Option<[f64; N]> {
    let mut walk = Walk {
        scene,
        vertices: MAX_VERTICES,
        objects: MAX_OBJECTS,
        mesh_boxes: HashMap::new(),
        group_boxes: HashMap::new(),
    };
    let mut best = [f64::NEG_INFINITY; N];
    walk.objects(&scene.objects, DAffine3::IDENTITY, &directions, &mut best, 0);
    best.iter().all(|b| b.is_finite()).then_some(best)
}

/// A walk through objects and groups with what is left of its budgets.
struct Walk<'a> {
    scene: &'a Scene,
    vertices: usize,
    objects: usize,
    mesh_boxes: HashMap<u32, Option<[DVec3; 8]>>,
    group_boxes: HashMap<u32, Option<[DVec3; 8]>>,
}

impl<'a> Walk<'a> {
    fn objects(&mut self, objects: &'a [Object], to_world: DAffine3, a: &[DVec3], best: &mut [f64], depth: usize) {
        for object in objects {
            if !object.visibility.camera {
                continue;
            }
            // Also where it moves to while the shutter is open: between keys it is between their places.
            let still = [DAffine3::IDENTITY];
            let keys = if object.motion.is_empty() {
                &still
            } else {
                &object.motion[..]
            };
            for m in keys.iter().map(|key| to_world * object.transform * *key) {
                match &object.shape {
                    Shape::Mesh(id) => {
                        let Some(mesh) = self.scene.meshes.get(id.index()) else {
                            continue;
                        };
                        self.mesh(id.0, mesh, m, a, best);
                    }
                    Shape::Group(id) => {
                        let Some(group) = self.scene.groups.get(id.index()) else {
                            continue;
                        };
                        if depth >= MAX_DEPTH {
                            continue;
                        }
                        if self.objects >= group.objects.len() {
                            self.objects -= group.objects.len();
                            self.objects(&group.objects, m, a, best, depth + 1);
                        } else if let Some(corners) = self.group_box(id.0, depth) {
                            extend(best, a, m, |d| highest(&corners, d));
                        }
                    }
                    shape => extend(best, a, m, |d| shape_support(shape, d)),
                }
            }
        }
    }

    fn mesh(&mut self, id: u32, mesh: &Mesh, m: DAffine3, a: &[DVec3], best: &mut [f64]) {
        if mesh.triangles.is_empty() {
            return;
        }
        if self.vertices >= mesh.positions.len() {
            self.vertices -= mesh.positions.len();
            extend(best, a, m, |d| mesh_support(mesh, d));
            return;
        }
        let corners = self.mesh_boxes.entry(id).or_insert_with(|| {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
            corners(axes.map(|d| mesh_support(mesh, d)))
        });
        if let Some(corners) = corners {
            extend(best, a, m, |d| highest(corners, d));
        }
    }

    /// The corners of the box around a group, found once.
    fn group_box(&mut self, id: u32, depth: usize) -> Option<[DVec3; 8]> {
        if let Some(known) = self.group_boxes.get(&id) {
            return *known;
        }
        self.group_boxes.insert(id, None); // ends the walk should a group contain itself
        let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let mut best = [f64::NEG_INFINITY; 6];
        if let Some(group) = self.scene.groups.get(id as usize) {
            self.objects(&group.objects, DAffine3::IDENTITY, &axes, &mut best, depth + 1);
        }
        let found = corners(best);
        self.group_boxes.insert(id, found);
        found
    }
}

/// Raises `best` by a shape under the map m: max a·(Mp + t) = a·t + max (Mᵗa)·p.
fn extend(best: &mut [f64], directions: &[DVec3], m: DAffine3, support: impl Fn(DVec3) -> f64) {
    let transposed = m.matrix3.transpose();
    for (best, a) in best.iter_mut().zip(directions) {
        let reach = a.dot(m.translation) + support(transposed * *a);
        if reach.is_finite() {
            *best = best.max(reach);
        }
    }
}

/// The eight corners of the box that reaches so far along +x, +y, +z, −x, −y, −z; `None` if it is not finite.
fn corners(reach: [f64; 6]) -> Option<[DVec3; 8]> {
    let pick = |i: usize, axis: usize| {
        if i >> axis & 1 == 1 {
            reach[axis]
        } else {
            -reach[axis + 3]
        }
    };
    let corner = |i| DVec3::new(pick(i, 0), pick(i, 1), pick(i, 2));
    reach.iter().all(|r| r.is_finite()).then(|| std::array::from_fn(corner))
}

fn highest(points: &[DVec3], d: DVec3) -> f64 {
    points.iter().map(|p| p.dot(d)).fold(f64::NEG_INFINITY, f64::max)
}

fn mesh_support(mesh: &Mesh, d: DVec3) -> f64 {
    let reach = mesh
        .positions
        .iter()
        .map(|p| p.as_dvec3().dot(d))
        .filter(|r| r.is_finite());
    mesh.center.dot(d) + reach.fold(f64::NEG_INFINITY, f64::max)
}

/// max d·p over a shape in its own space; −∞ for planes, which end nowhere.
fn shape_support(shape: &Shape, d: DVec3) -> f64 {
    let disc = |center: DVec3, axis: DVec3, radius: f64| center.dot(d) + radius * (d - axis * axis.dot(d)).length();
    match shape {
        Shape::Sphere { center, radius } => center.dot(d) + radius * d.length(),
        Shape::Box { min, max } => (min * d).max(max * d).element_sum(),
        Shape::Cone {
            base,
            base_radius,
            cap,
            cap_radius,
            ..
        } => {
            let axis = (cap - base).normalize_or_zero();
            disc(*base, axis, *base_radius).max(disc(*cap, axis, *cap_radius))
        }
        Shape::Disc {
            center, normal, radius, ..
        } => disc(*center, *normal, *radius),
        Shape::Torus { major, minor } => major * d.x.hypot(d.z) + minor * d.length(),
        Shape::Triangle { vertices, .. } => highest(vertices, d),
        Shape::Plane { .. } | Shape::Mesh(_) | Shape::Group(_) => f64::NEG_INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::super::bounds;
    use super::*;
    use glam::DMat3;

    /// Points on a shape, dense enough to reach its bounds to some 1e-3 of its size.
    fn points_on(shape: &Shape) -> Vec<DVec3> {
        let n = 400;
        let turn = |i: i32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        let circles = |f: &dyn Fn(f64, f64) -> DVec3| {
            (0..n)
                .flat_map(|i| (0..n).map(move |j| (turn(i), turn(j))))
                .map(|(s, t)| f(s, t))
                .collect()
        };
        match shape {
            Shape::Sphere { center, radius } => {
                circles(&|s, t| *center + *radius * DVec3::new(s.cos() * t.sin(), s.sin() * t.sin(), t.cos()))
            }
            Shape::Torus { major, minor } => circles(&|s, t| {
                let ring = major + minor * t.cos();
                DVec3::new(ring * s.cos(), minor * t.sin(), ring * s.sin())
            }),
            Shape::Cone {
                base,
                base_radius,
                cap,
                cap_radius,
                ..
            } => circles(&|s, t| {
                let (x, y) = (cap - base).normalize().any_orthonormal_pair();
                let (c, r) = if t > 3.0 {
                    (cap, cap_radius)
                } else {
                    (base, base_radius)
                };
                *c + (x * s.cos() + y * s.sin()) * *r
            }),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn bounds_of_curved_shapes_under_sheared_maps_match_points_on_them() {
        let shear = DMat3::from_cols(
            DVec3::new(1.0, 0.5, 0.0),
            DVec3::new(-2.0, 1.0, 0.3),
            DVec3::new(0.1, 0.0, -3.0),
        );
        let m = DAffine3::from_mat3_translation(shear, DVec3::new(5.0, -1.0, 2.0));
        let shapes = [
            Shape::Sphere {
                center: DVec3::new(1.0, 2.0, 3.0),
                radius: 0.5,
            },
            Shape::Torus { major: 2.0, minor: 0.7 },
            Shape::Cone {
                base: DVec3::ZERO,
                base_radius: 1.0,
                cap: DVec3::new(1.0, 2.0, -1.0),
                cap_radius: 0.3,
                open: true,
            },
        ];
        for shape in shapes {
            let points: Vec<DVec3> = points_on(&shape).iter().map(|p| m.transform_point3(*p)).collect();
            let low = points.iter().fold(DVec3::INFINITY, |a, p| a.min(*p));
            let high = points.iter().fold(DVec3::NEG_INFINITY, |a, p| a.max(*p));
            let mut scene = Scene::default();
            scene.objects.push(Object::new(shape).transformed(m));
            let (min, max) = bounds(&scene).unwrap();
            assert!((min - low).abs().max_element() < 5e-3, "{min} {low}");
            assert!((max - high).abs().max_element() < 5e-3, "{max} {high}");
            assert!((min - 1e-9).cmple(low).all() && (max + 1e-9).cmpge(high).all());
        }
    }

    #[test]
    fn groups_of_groups_are_bounded_in_finite_time() {
        let mut scene = Scene::default();
        let ball = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 0.5,
        };
        let mut id = scene.add_group(vec![Object::new(ball)]);
        // 2^30 spheres in a row of 2^30 · 1 + … places.
        for level in 0..30 {
            let next =
                Object::new(Shape::Group(id)).transformed(DAffine3::from_translation(DVec3::X * f64::from(1 << level)));
            id = scene.add_group(vec![Object::new(Shape::Group(id)), next]);
        }
        scene.objects.push(Object::new(Shape::Group(id)));
        let (min, max) = bounds(&scene).unwrap();
        assert_eq!(min, DVec3::splat(-0.5));
        assert_eq!(max, DVec3::new(f64::from((1 << 30) - 1) + 0.5, 0.5, 0.5));
    }

    #[test]
    fn what_the_camera_cannot_see_is_not_bounded() {
        let mut scene = Scene::default();
        let mut hidden = Object::new(Shape::Box {
            min: DVec3::ZERO,
            max: DVec3::ONE,
        });
        hidden.visibility.camera = false;
        scene.objects.push(hidden);
        assert_eq!(bounds(&scene), None);
    }
}
