//! `min_extent` and `max_extent`: axis-aligned bounds of an object.

use super::words;
use crate::diag::Span;
use crate::lang::desc::{ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, T};
use crate::scene::Shape;
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::rc::Rc;

/// Half the size of what has no bounds (a plane), as POV-Ray has it.
const UNBOUNDED: f64 = 1e10;

/// Lower and upper corner; `None` for what cannot be measured yet.
type Bounds = Option<[DVec3; 2]>;

impl Interp<'_> {
    /// The bounds of the object that comes next, a name or a block. What is not supported yet counts as a unit box, and
    /// this is told.
    pub fn extent(&mut self, span: Span) -> Parsed<[DVec3; 2]> {
        let tok = self.peek();
        let object = match tok.t {
            T::Word(w) if words::OBJECTS.contains(&w) => self.object()?,
            _ => self.named_object()?,
        };
        let mut known = HashMap::new();
        match bounds(&object, &mut known) {
            Some(b) => Ok(b),
            None => {
                self.warn_once(
                    "P0409",
                    span,
                    "the extent of an object that is not supported yet is taken as <0, 0, 0> to <1, 1, 1>",
                );
                Ok([DVec3::ZERO, DVec3::ONE])
            }
        }
    }
}

/// Bounds of an object in its parent's space. Unions are shared, so each is measured once.
fn bounds(o: &ObjectDesc, known: &mut HashMap<*const (), Bounds>) -> Bounds {
    let [min, max] = match &o.shape {
        ShapeDesc::Primitive(shape) => shape_bounds(shape),
        ShapeDesc::Mesh(m) => {
            let points = m.mesh.positions.iter().map(|p| p.as_dvec3() + m.mesh.center);
            enclose(points)
        }
        ShapeDesc::Union(children) => {
            let key = Rc::as_ptr(children).cast::<()>();
            let inside = match known.get(&key) {
                Some(b) => *b,
                None => {
                    let all: Option<Vec<[DVec3; 2]>> = children.iter().map(|c| bounds(c, known)).collect();
                    let all = all.map(|boxes| enclose(boxes.into_iter().flatten()));
                    known.insert(key, all);
                    all
                }
            };
            inside?
        }
        ShapeDesc::Light(l) => [l.position, l.position],
        ShapeDesc::Model(_) | ShapeDesc::Unsupported(_) => return None,
    };
    if min.x > max.x || min.x.is_nan() {
        return Some([DVec3::ZERO, DVec3::ZERO]);
    }
    Some(moved([min, max], &o.transform))
}

fn enclose(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)])
}

/// The box around a moved box.
fn moved([min, max]: [DVec3; 2], t: &DAffine3) -> [DVec3; 2] {
    if *t == DAffine3::IDENTITY {
        return [min, max];
    }
    let corner = |i: usize| DVec3::from_array([0, 1, 2].map(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }));
    enclose((0..8).map(|i| t.transform_point3(corner(i))))
}

fn shape_bounds(shape: &Shape) -> [DVec3; 2] {
    let ball = |c: DVec3, r: f64| [c - DVec3::splat(r), c + DVec3::splat(r)];
    // A disc of radius r about c: r·√(1 − n²) along each axis.
    let ring = |c: DVec3, n: DVec3, r: f64| {
        let reach = (DVec3::ONE - n * n).max(DVec3::ZERO);
        let reach = DVec3::from_array(reach.to_array().map(f64::sqrt)) * r;
        [c - reach, c + reach]
    };
    match *shape {
        Shape::Sphere { center, radius } => ball(center, radius),
        Shape::Box { min, max } => [min, max],
        Shape::Cone {
            base,
            base_radius,
            cap,
            cap_radius,
            ..
        } => {
            let axis = (cap - base).normalize_or(DVec3::Y);
            let ends = [ring(base, axis, base_radius), ring(cap, axis, cap_radius)];
            enclose(ends.into_iter().flatten())
        }
        Shape::Disc {
            center, normal, radius, ..
        } => ring(center, normal, radius),
        Shape::Torus { major, minor } => {
            let reach = DVec3::new(major + minor, minor, major + minor);
            [-reach, reach]
        }
        Shape::Triangle { vertices, .. } => enclose(vertices.into_iter()),
        Shape::Plane { .. } | Shape::Mesh(_) | Shape::Group(_) => ball(DVec3::ZERO, UNBOUNDED),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: points of the shapes, found by hand.
    #[test]
    fn bounds_are_tight() {
        let cylinder = Shape::Cone {
            base: DVec3::ZERO,
            base_radius: 1.0,
            cap: DVec3::Y * 2.0,
            cap_radius: 1.0,
            open: false,
        };
        assert_eq!(
            shape_bounds(&cylinder),
            [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0)]
        );
        let turned = DAffine3::from_mat3(crate::lang::transform::rotation_deg(DVec3::Z * 90.0));
        let [min, max] = moved([DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)], &turned);
        assert_eq!([min, max], [DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 3.0)]);
    }
}
