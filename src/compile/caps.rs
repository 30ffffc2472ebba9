//! Spherical lamps that look through a wall: only the part in front of it is worth sampling.
//!
//! A lamp of radius 600 that sticks out of a ceiling by a quarter of a unit is a common way to write a round lamp.
//! Sampling all of it sends nearly every shadow ray into the ceiling. If one wall cuts a lamp and the lamp's
//! centre is not on the camera's side, the lamp is sampled on its cap on the camera's side. Nothing is lost: what
//! sees the rest of the lamp finds it by scattered rays, which then count fully.

use crate::render::light::{Light, SphereCapLight, SphereLight};
use crate::render::shape::Shape;
use glam::DVec3;

/// A cap larger than this share of a sphere (1 − cos, of 2) brings little: the whole is sampled.
const LARGEST_CAP: f64 = 0.5;

/// Replaces lamps that are cut by one of the shapes by their smallest cap on the side of `eye`.
pub fn cut_by_walls<'a>(lights: &mut [Light], shapes: impl Iterator<Item = &'a Shape> + Clone, eye: DVec3) {
    for light in lights {
        let Light::Sphere(sphere) = *light else { continue };
        let caps = shapes.clone().filter_map(|wall| cap(&sphere, wall, eye));
        let smallest = caps.min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((axis, one_minus_cos)) = smallest
            && one_minus_cos < LARGEST_CAP
        {
            *light = Light::SphereCap(Box::new(SphereCapLight {
                sphere,
                axis,
                one_minus_cos,
            }));
        }
    }
}

/// The part of a sphere that a wall leaves on the side of `eye`: axis and 1 − cos of its half angle. `None` if the wall
/// does not cut the sphere or leaves its centre on that side.
fn cap(sphere: &SphereLight, wall: &Shape, eye: DVec3) -> Option<(DVec3, f64)> {
    let (c, r) = (sphere.center, sphere.radius);
    match wall {
        Shape::Plane { normal, distance } => {
            let side = if normal.dot(eye) > *distance { 1.0 } else { -1.0 };
            let axis = *normal * side;
            // How far the sphere sticks out on the side of the eye.
            let out = r - (*distance * side - axis.dot(c));
            (out > 0.0 && out < r).then_some((axis, out / r))
        }
        Shape::Sphere { center, radius } => {
            let apart = *center - c;
            let d = apart.length();
            let inside = eye.distance(*center) < *radius;
            // A point of the lamp at angle θ from `apart` lies at √(d² + r² − 2·d·r·cos θ) from the wall's centre.
            let (axis, product) = if inside {
                (apart / d, (*radius - d + r) * (*radius + d - r))
            } else {
                (-apart / d, (d + r - *radius) * (d + r + *radius))
            };
            let one_minus_cos = product / (2.0 * d * r);
            let centre_hidden = (d < *radius) != inside;
            let cuts = one_minus_cos > 0.0 && one_minus_cos < 2.0;
            (d > 0.0 && centre_hidden && cuts).then_some((axis, one_minus_cos))
        }
        Shape::Placed(_) | Shape::Mesh { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::ray::PrimRef;
    use glam::Vec3;

    fn lamp(center: DVec3, radius: f64) -> SphereLight {
        SphereLight {
            center,
            radius,
            radiance: Vec3::ONE,
            two_sided: false,
            textured: false,
            prim: PrimRef::NONE,
        }
    }

    /// Geometry: a sphere of radius 5 with its centre 4 behind a plane sticks out by 1.
    #[test]
    fn a_plane_leaves_the_cap_in_front_of_it() {
        let wall = Shape::Plane {
            normal: DVec3::Y,
            distance: 2.0,
        };
        let found = cap(&lamp(DVec3::new(0.0, 6.0, 0.0), 5.0), &wall, DVec3::ZERO);
        assert_eq!(found, Some((-DVec3::Y, 0.2)));
        assert_eq!(cap(&lamp(DVec3::new(0.0, 1.0, 0.0), 5.0), &wall, DVec3::ZERO), None);
        assert_eq!(cap(&lamp(DVec3::new(0.0, 9.0, 0.0), 5.0), &wall, DVec3::ZERO), None);
    }

    /// The lecture's lamp: it sticks out of a nearly flat ceiling by 0.27, so the cap is nearly that of a plane.
    #[test]
    fn a_huge_spherical_ceiling_is_nearly_a_plane() {
        let ceiling = Shape::Sphere {
            center: DVec3::new(0.0, -1e5 + 81.6, 0.0),
            radius: 1e5,
        };
        let found = cap(
            &lamp(DVec3::new(0.0, 681.6 - 0.27, 0.0), 600.0),
            &ceiling,
            DVec3::new(0.0, 40.0, 0.0),
        );
        let (axis, x) = found.unwrap_or((DVec3::ZERO, 0.0));
        // Exactly: (R − d + r)(R + d − r)/(2·d·r) with R = 1e5, d = 1e5 + 599.73, r = 600.
        let exact = 0.27 * 199_999.73 / (2.0 * 100_599.73 * 600.0);
        assert_eq!(axis, -DVec3::Y);
        assert!((x / exact - 1.0).abs() < 1e-6, "{x} instead of {exact}");
    }
}
