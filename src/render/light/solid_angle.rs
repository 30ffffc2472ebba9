//! Directions uniform over the solid angle of a triangle.
//!
//! Sampling the area of a light that is near or large puts most samples where the light is far and faint. Uniform in
//! solid angle, only the cosine at the receiver is left to vary.

use crate::math::portable::{atan2, sin_cos_turns};
use glam::{DVec3, Vec2};

/// A triangle on the unit sphere around the receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphericalTriangle {
    a: DVec3,
    /// The corner about which the sampled arcs turn.
    pivot: DVec3,
    c: DVec3,
    /// Its solid angle, in [0, 2π]; NaN if the receiver is a corner.
    pub solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle seen in the given directions, which need not be unit vectors.
    /// Source of the solid angle: Van Oosterom & Strackee, The Solid Angle of a Plane Triangle, 1983.
    pub fn new(a: DVec3, pivot: DVec3, c: DVec3) -> SphericalTriangle {
        let (a, b, c) = (a.normalize(), pivot.normalize(), c.normalize());
        let determinant = a.dot(b.cross(c)).abs();
        let half = atan2(determinant as f32, (1.0 + a.dot(b) + b.dot(c) + c.dot(a)) as f32);
        SphericalTriangle {
            a,
            pivot: b,
            c,
            solid_angle: 2.0 * f64::from(half),
        }
    }

    /// A unit direction, uniform over the triangle; u.x moves along the edge from `a` to `c`, u.y away from the pivot.
    ///
    /// First the point c' on the edge that cuts off the area u.x·Ω, then a point of the arc from the pivot to c'. With
    /// c' = a·cos φ + t·sin φ the formula for the solid angle gives tan(φ/2) without inverse functions:
    /// tan(S/2) = h·det(a, b, t)/(1 + a·b + h·b·t), h = tan(φ/2).
    /// Source of the two steps: Arvo, Stratified Sampling of Spherical Triangles, 1995.
    pub fn sample(&self, u: Vec2) -> Option<DVec3> {
        let (a, b, c) = (self.a, self.pivot, self.c);
        let t = (c - a * a.dot(c)).normalize();
        let turns = f64::from(u.x) * self.solid_angle * (0.5 / std::f64::consts::TAU);
        let (sin, cos) = sin_cos_turns(turns as f32);
        let (sin, cos) = (f64::from(sin), f64::from(cos));
        let determinant = a.dot(b.cross(t)).abs();
        // h = x/y; both may be near 0, so the angle is doubled without dividing.
        let x = sin * (1.0 + a.dot(b));
        let y = cos * determinant - sin * b.dot(t);
        let on_edge = (a * (y * y - x * x) + t * (2.0 * x * y)) / (x * x + y * y);
        // 1 − cos of the angle from the pivot is uniform; |b − c'|²/2 = 1 − b·c' keeps the digits of a short arc.
        let along = f64::from(u.y) * 0.5 * (on_edge - b).length_squared();
        let away = on_edge - b * b.dot(on_edge);
        let length = away.length();
        if length == 0.0 {
            return None;
        }
        let w = b * (1.0 - along) + away * ((along * (2.0 - along)).max(0.0).sqrt() / length);
        w.is_finite().then_some(w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::{Pcg, chi2_test};

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let octant = SphericalTriangle::new(DVec3::X * 3.0, DVec3::Y, DVec3::Z * 0.1);
        assert!((octant.solid_angle - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    }

    /// By symmetry each third of the octant, by its largest component, gets a third of the directions, and z is
    /// uniform over a triangle whose pivot is z (Archimedes): χ², false alarm 1e-4.
    #[test]
    fn directions_are_uniform_over_an_octant() {
        let mut rng = Pcg::new(13);
        for pivot in [DVec3::X, DVec3::Y, DVec3::Z] {
            let [a, c] = [[DVec3::Y, DVec3::Z], [DVec3::Z, DVec3::X], [DVec3::X, DVec3::Y]][pivot.abs().max_position()];
            let octant = SphericalTriangle::new(a, pivot, c);
            let mut heights = vec![0.0; 16];
            let mut thirds = [0.0; 3];
            let n = 100_000;
            for _ in 0..n {
                let w = octant.sample(rng.next_vec2()).unwrap_or(-DVec3::ONE);
                assert!((w.length() - 1.0).abs() < 1e-9 && w.min_element() > -1e-6, "{w}");
                heights[((w.z * 16.0) as usize).min(15)] += 1.0;
                thirds[w.max_position()] += 1.0;
            }
            let n = f64::from(n);
            assert!(chi2_test(&heights, &[n / 16.0; 16]) > 1e-4, "{heights:?}");
            assert!(chi2_test(&thirds, &[n / 3.0; 3]) > 1e-4, "{thirds:?}");
        }
    }
}
