//! Where the faces of analytic shapes truly are: signed functions with their gradients, in double-double.

use super::exact::{Dd, Exact3, Inverse};
use crate::render::shape::{Shape, Solid};
use glam::{DAffine3, DQuat, DVec3};

/// A face by its function, zero on it, and what the function is like nearby.
pub struct Value {
    /// The function at the point, in units of the shape's own space.
    pub g: f64,
    /// Its gradient in the world.
    pub gradient: DVec3,
    /// Its gradient in the shape's own space.
    pub local_gradient: DVec3,
    /// Bound on its second derivative along any direction, by squared length in the shape's own space.
    pub curvature: f64,
}

/// The unbounded surface of which a face is part, under the map that places it.
pub struct Truth {
    solid: Option<Solid>,
    plane: Option<(DVec3, f64)>,
    /// From the world to the shape's own space.
    pub inverse: Inverse,
}

impl Truth {
    /// For an analytic shape; planes are exact in the world.
    pub fn of(shape: &Shape) -> Truth {
        let (solid, plane, map) = match shape {
            Shape::Sphere { center, radius } => {
                let scale = DVec3::splat(*radius);
                let map = DAffine3::from_scale_rotation_translation(scale, DQuat::IDENTITY, *center);
                (Some(Solid::Sphere), None, map)
            }
            Shape::Plane { normal, distance } => (None, Some((*normal, *distance)), DAffine3::IDENTITY),
            Shape::Placed(p) => (Some(p.kind.clone()), None, p.world_from_object),
            Shape::Mesh { .. } => unreachable!("meshes have their own test"),
        };
        Truth {
            solid,
            plane,
            inverse: Inverse::of(&map),
        }
    }

    /// The function of a face at a world point.
    pub fn at(&self, face: u32, world: Exact3) -> Value {
        let p = self.inverse.point(world);
        let (g, local_gradient, curvature) = match (&self.plane, &self.solid) {
            (Some((n, distance)), _) => (Exact3::new(*n).dot(world) - Dd::new(*distance), *n, 0.0),
            (None, Some(solid)) => local(solid, face, p),
            (None, None) => unreachable!("one of the two is set"),
        };
        Value {
            g: g.value(),
            gradient: self.inverse.gradient(local_gradient),
            local_gradient,
            curvature,
        }
    }
}

fn local(solid: &Solid, face: u32, p: Exact3) -> (Dd, DVec3, f64) {
    let one = Dd::new(1.0);
    let [x, y, z] = p.0;
    let q = p.value();
    let across = (x * x + z * z).sqrt();
    let rho = across.value();
    let out = if rho > 0.0 {
        DVec3::new(q.x / rho, 0.0, q.z / rho)
    } else {
        DVec3::X
    };
    match *solid {
        Solid::Sphere => {
            let r = p.dot(p).sqrt();
            (
                r - one,
                q.normalize_or(DVec3::Y),
                1.0 / r.value().max(f64::MIN_POSITIVE),
            )
        }
        Solid::Box { min, max } => {
            let axis = (face / 2) as usize;
            let side = if face.is_multiple_of(2) { min[axis] } else { max[axis] };
            (p.0[axis] - Dd::new(side), DVec3::AXES[axis], 0.0)
        }
        Solid::Disc { .. } => (y, DVec3::Y, 0.0),
        Solid::Cylinder { .. } | Solid::Cone { .. } if face > 0 => {
            let level = if face == 1 { Dd::ZERO } else { one };
            (y - level, DVec3::Y, 0.0)
        }
        Solid::Cylinder { .. } => (across - one, out, 1.0 / rho.max(f64::MIN_POSITIVE)),
        Solid::Cone { r0, r1, .. } => {
            let slope = Dd::new(r1) - Dd::new(r0);
            let g = across - (Dd::new(r0) + slope * y);
            (g, out - DVec3::Y * slope.value(), 1.0 / rho.max(f64::MIN_POSITIVE))
        }
        Solid::Torus { major, minor } => {
            let lobe = |center: Dd| {
                let w = across - center;
                let r = (w * w + y * y).sqrt();
                let n = (out * w.value() + DVec3::Y * q.y) / r.value().max(f64::MIN_POSITIVE);
                (r - Dd::new(minor), n)
            };
            let ((g, n), inner) = (lobe(Dd::new(major)), lobe(-Dd::new(major)));
            let (g, n) = if inner.0.abs().value() < g.abs().value() {
                inner
            } else {
                (g, n)
            };
            let sharpest = minor.min(rho).max(f64::MIN_POSITIVE);
            (g, n, 2.0 / sharpest)
        }
    }
}
