//! Fog after POV-Ray: what lies behind a way of optical depth τ is seen by the share e^−τ, the rest is the fog's colour.

use crate::math::portable::exp_f64;
use glam::{DVec3, Vec3};

/// A fog. It is not lit and does not dim lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Radiance of fog without end.
    pub color: Vec3,
    /// Way in constant fog on which 1/e is left, world units, > 0.
    pub distance: f64,
    /// Fog on the ground, if it is that.
    pub ground: Option<Ground>,
}

/// Density 1 up to a height, above it 1/(1 + (above/falloff)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Unit direction of up.
    pub up: DVec3,
    /// Height along `up`, seen from the camera, to which the density is 1.
    pub offset: f64,
    /// Height above `offset` at which the density is a half, > 0.
    pub falloff: f64,
}

impl Fog {
    /// The share of light that is left from `from` over `distance` (may be infinite) along the unit direction `dir`.
    pub fn transmittance(&self, from: Vec3, dir: Vec3, distance: f32) -> f32 {
        let way = f64::from(distance).max(0.0);
        let thick = match &self.ground {
            None => way,
            Some(ground) => ground.way_in_fog(from.as_dvec3(), dir.as_dvec3(), way),
        };
        if thick > 0.0 {
            exp_f64(-thick / self.distance) as f32
        } else {
            1.0
        }
    }
}

impl Ground {
    /// ∫ density along the way: (F(h₁) − F(h₀))/h′ with F the integral of the density over the height.
    fn way_in_fog(&self, from: DVec3, dir: DVec3, way: f64) -> f64 {
        let height = from.dot(self.up) - self.offset;
        let rise = dir.dot(self.up);
        let end = height + rise * way;
        // Both ends in constant fog: nothing to integrate. This includes level ways there.
        if height <= 0.0 && end <= 0.0 {
            return way;
        }
        let (a, b) = (height / self.falloff, end / self.falloff);
        if rise == 0.0 {
            return way / (1.0 + a * a);
        }
        // atan b − atan a from their difference, which nearly level ways leave few digits in the atans themselves.
        let above = |a: f64, b: f64, step: f64| {
            let plain = libm::atan(b) - libm::atan(a);
            if b.is_finite() && step.is_finite() {
                libm::atan2(step, 1.0 + a * b)
            } else {
                plain
            }
        };
        let step = rise * way / self.falloff;
        let through = match (a > 0.0, b > 0.0) {
            (true, true) => above(a, b, step),
            (true, false) => b - libm::atan(a),
            (false, true) => libm::atan(b) - a,
            (false, false) => step,
        };
        through * self.falloff / rise
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: ∫ density by the midpoint rule, whose error for 10⁵ steps over these ways is below 1e-6 of them.
    #[test]
    fn ground_fog_is_the_integral_of_its_density() {
        let ground = Ground {
            up: DVec3::Y,
            offset: 1.0,
            falloff: 0.5,
        };
        let density = |p: DVec3| {
            let above = ((p.y - 1.0) / 0.5).max(0.0);
            1.0 / (1.0 + above * above)
        };
        let mut rng = crate::math::stats::Pcg::new(11);
        let mut number = || f64::from(rng.next_f32()) * 2.0 - 1.0;
        for i in 0..200 {
            let from = DVec3::new(number(), 1.0 + 3.0 * number(), number());
            let mut dir = DVec3::new(number(), number(), number());
            if i % 4 == 0 {
                dir.y *= 1e-9;
            }
            if i % 16 == 0 {
                dir.y = 0.0;
            }
            let dir = dir.normalize();
            for way in [0.0, 0.1, 3.0, 20.0] {
                let n = 100_000;
                let step = way / f64::from(n);
                let exact: f64 = (0..n)
                    .map(|k| density(from + dir * ((f64::from(k) + 0.5) * step)) * step)
                    .sum();
                let found = ground.way_in_fog(from, dir, way);
                assert!(
                    (found - exact).abs() <= 1e-6 * way,
                    "{from} along {dir} for {way}: {found}, exactly {exact}"
                );
            }
        }
    }

    /// Upwards without end ground fog ends, constant fog and ground fog downwards do not.
    #[test]
    fn ways_without_end_have_their_limits() {
        let ground = Ground {
            up: DVec3::Y,
            offset: 0.0,
            falloff: 2.0,
        };
        let fog = |ground| Fog {
            color: Vec3::ONE,
            distance: 3.0,
            ground,
        };
        // From the ground straight up: 2·π/2.
        let up = fog(Some(ground)).transmittance(Vec3::ZERO, Vec3::Y, f32::INFINITY);
        assert!(
            (f64::from(up) - (-std::f64::consts::PI / 3.0).exp()).abs() < 1e-7,
            "{up}"
        );
        for level in [Vec3::X, Vec3::NEG_Y] {
            assert_eq!(fog(Some(ground)).transmittance(Vec3::Y, level, f32::INFINITY), 0.0);
        }
        assert_eq!(fog(None).transmittance(Vec3::ZERO, Vec3::X, f32::INFINITY), 0.0);
        assert_eq!(fog(None).transmittance(Vec3::ZERO, Vec3::X, 0.0), 1.0);
    }
}
