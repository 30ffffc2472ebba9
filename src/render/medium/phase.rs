//! Phase functions: where a medium sends the light that it scatters.
//!
//! `cos` is that of the angle between the way of the light before and after: 1 goes straight on. Each function is a
//! density of directions, in 1/sr, and directions are drawn from it exactly: scattering has weight 1.

use crate::math::frame::Frame;
use crate::math::portable::sin_cos_turns;
use glam::{Vec2, Vec3};
use std::f64::consts::PI;

/// A phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Henyey and Greenstein's of this eccentricity in (−1, 1); 0 is isotropic.
    /// Source: Henyey & Greenstein, Diffuse Radiation in the Galaxy, 1941.
    HenyeyGreenstein(f64),
    /// 3/(16π)·(1 + cos²θ).
    Rayleigh,
    /// (½ + (n + 1)/2·((1 + cos θ)/2)ⁿ)/4π: POV-Ray's Mie scattering, n = 8 for haze and 32 for murk.
    Mie(u8),
}

impl Phase {
    /// The same in all directions.
    pub const ISOTROPIC: Phase = Phase::HenyeyGreenstein(0.0);

    /// The density of a direction, in 1/sr. `cos` in [−1, 1].
    pub fn density(self, cos: f32) -> f32 {
        let cos = f64::from(cos);
        let times_4_pi = match self {
            Phase::HenyeyGreenstein(g) => {
                // 1 + g² − 2g·cos without losing what is left of it near g = 1, cos = 1.
                let d = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos);
                (1.0 - g) * (1.0 + g) / (d * d.sqrt())
            }
            Phase::Rayleigh => 0.75 * (1.0 + cos * cos),
            Phase::Mie(n) => {
                let h = 0.5 * (1.0 + cos);
                0.5 + 0.5 * (f64::from(n) + 1.0) * libm::pow(h, f64::from(n))
            }
        };
        (times_4_pi / (4.0 * PI)) as f32
    }

    /// A direction that light takes which arrives along the unit vector `dir`, and its density. `u` in [0, 1) is the
    /// direction, `lobe` in [0, 1) chooses between parts of the function.
    pub fn sample(self, dir: Vec3, u: Vec2, lobe: f32) -> (Vec3, f32) {
        let cos = self.sample_cos(f64::from(u.x), lobe).clamp(-1.0, 1.0);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt() as f32;
        let (s, c) = sin_cos_turns(u.y);
        let wi = Frame::from_normal(dir).to_world(Vec3::new(sin * c, sin * s, cos as f32));
        (wi, self.density(cos as f32))
    }

    /// The cosine whose share of all directions below it is `u`.
    fn sample_cos(self, u: f64, lobe: f32) -> f64 {
        let s = 2.0 * u - 1.0;
        match self {
            // The usual inverse, (1 + g² − ((1 − g²)/(1 + g·s))²)/2g, brought over one denominator and divided by g: it
            // loses no digits for small g, and is s for g = 0.
            Phase::HenyeyGreenstein(g) => {
                let a = 1.0 + g * s;
                (2.0 * s + g * (s * s + 3.0) + 2.0 * g * g * s + g * g * g * (s * s - 1.0)) / (2.0 * a * a)
            }
            // The root of cos³ + 3cos = 4s, by Cardano: with r = 2s + √(4s² + 1), ∛r − 1/∛r.
            Phase::Rayleigh => {
                let r = libm::cbrt(2.0 * s.abs() + (4.0 * s * s + 1.0).sqrt());
                (r - 1.0 / r).copysign(s)
            }
            Phase::Mie(n) => {
                if lobe < 0.5 {
                    s
                } else {
                    2.0 * libm::pow(u, 1.0 / (f64::from(n) + 1.0)) - 1.0
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Phase; 9] = [
        Phase::ISOTROPIC,
        Phase::HenyeyGreenstein(1e-9),
        Phase::HenyeyGreenstein(0.3),
        Phase::HenyeyGreenstein(-0.7),
        Phase::HenyeyGreenstein(0.99),
        Phase::HenyeyGreenstein(-0.999),
        Phase::Rayleigh,
        Phase::Mie(8),
        Phase::Mie(32),
    ];

    /// ∫ density dΩ by the midpoint rule in t, cos = 1 − 2t² and its mirror: fine where lobes are narrow.
    #[test]
    fn every_function_is_a_density() {
        for phase in ALL {
            let n = 200_000;
            let mut sum = 0.0;
            for i in 0..n {
                let t = (f64::from(i) + 0.5) / f64::from(n);
                // cos = 1 − t²: from 1 to 0; d cos = 2t dt; both hemispheres.
                for sign in [1.0, -1.0] {
                    let cos = sign * (1.0 - t * t);
                    sum += f64::from(phase.density(cos as f32)) * 2.0 * t / f64::from(n);
                }
            }
            let total = 2.0 * PI * sum;
            assert!((total - 1.0).abs() < 2e-3, "{phase:?}: {total}");
        }
    }

    /// The share of light that goes into cosines below `cos`, in closed form.
    fn share_below(phase: Phase, cos: f64) -> f64 {
        let c = cos;
        match phase {
            // (1 − g²)/2g·(1/√(1 + g² − 2gc) − 1/(1 + g)), of which a small g leaves few digits: its limit is (1 + c)/2.
            Phase::HenyeyGreenstein(g) if g.abs() < 1e-6 => 0.5 * (1.0 + c),
            Phase::HenyeyGreenstein(g) => {
                let d = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - c);
                (1.0 - g * g) / (2.0 * g) * (1.0 / d.sqrt() - 1.0 / (1.0 + g))
            }
            Phase::Rayleigh => 0.5 + 0.375 * (c + c * c * c / 3.0),
            Phase::Mie(n) => {
                let h = 0.5 * (1.0 + c);
                0.5 * h + 0.5 * libm::pow(h, f64::from(n) + 1.0)
            }
        }
    }

    /// Drawn cosines against the distribution: the share of what is drawn below each of them. Regular numbers are off by
    /// half a step, the choice of a lobe by a Kolmogorov–Smirnov statistic: 2.3/√n is passed once in 20 000 times.
    #[test]
    fn directions_follow_the_distribution() {
        for phase in ALL {
            let n = 4000;
            let mut rng = crate::math::stats::Pcg::new(5);
            let mut drawn: Vec<f64> = (0..n)
                .map(|i| phase.sample_cos((f64::from(i) + 0.5) / f64::from(n), rng.next_f32()))
                .collect();
            drawn.sort_by(f64::total_cmp);
            let off = |(i, cos): (usize, &f64)| (share_below(phase, *cos) - (i as f64 + 0.5) / f64::from(n)).abs();
            let worst = drawn.iter().enumerate().map(off).fold(0.0, f64::max);
            assert!(worst < 2.3 / f64::from(n).sqrt(), "{phase:?}: {worst}");
        }
    }

    /// The density is the slope of the distribution, by central differences in f64 where f32 cosines are exact.
    #[test]
    fn the_density_is_the_slope_of_the_distribution() {
        for phase in ALL {
            for k in -63..64 {
                let (c, h) = (f64::from(k) / 64.0, 1.0 / 8192.0);
                let slope = (share_below(phase, c + h) - share_below(phase, c - h)) / (2.0 * h) / (2.0 * PI);
                let found = f64::from(phase.density(c as f32));
                // The third derivative of the narrowest lobe, at a 64th from its tip, times h²/6.
                assert!(
                    (found / slope - 1.0).abs() < 1e-3,
                    "{phase:?} at {c}: {found}, slope {slope}"
                );
            }
        }
    }

    /// The mean cosine is the eccentricity; of Rayleigh 0; of Mie n/(2(n + 2)).
    #[test]
    fn mean_cosines_are_known() {
        for phase in ALL {
            let want = match phase {
                Phase::HenyeyGreenstein(g) => g,
                Phase::Rayleigh => 0.0,
                Phase::Mie(n) => 0.5 * f64::from(n) / (f64::from(n) + 2.0),
            };
            let n = 100_000;
            let mean = |lobe: f32| {
                let cos = |i| phase.sample_cos((f64::from(i) + 0.5) / f64::from(n), lobe);
                (0..n).map(cos).sum::<f64>() / f64::from(n)
            };
            let found = 0.5 * (mean(0.0) + mean(0.75));
            assert!((found - want).abs() < 1e-4, "{phase:?}: {found} instead of {want}");
        }
    }

    /// Straight on and straight back have their closed forms, and drawn directions are unit vectors with their density.
    #[test]
    fn ends_and_directions_are_right() {
        for g in [-0.99, -0.5, 0.0, 0.5, 0.99, 0.999_999f64] {
            let on = (1.0 - g * g) / (4.0 * PI * (1.0 - g).powi(3));
            let found = f64::from(Phase::HenyeyGreenstein(g).density(1.0));
            assert!((found / on - 1.0).abs() < 1e-6, "{g}: {found} instead of {on}");
        }
        let mut rng = crate::math::stats::Pcg::new(7);
        for phase in ALL {
            let dir = Vec3::new(0.36, -0.48, 0.8);
            for _ in 0..1000 {
                let (wi, pdf) = phase.sample(dir, Vec2::new(rng.next_f32(), rng.next_f32()), rng.next_f32());
                assert!((wi.length() - 1.0).abs() < 1e-6);
                let again = phase.density(wi.dot(dir).clamp(-1.0, 1.0));
                // A cosine of unit vectors is right to 8u, of which d = (1 − |g|)² + 2|g|(1 − cos) keeps 16u/(1 − |g|)².
                let tip = match phase {
                    Phase::HenyeyGreenstein(g) => (1.0 - g.abs()).powi(2),
                    _ => 1.0 / 32.0,
                };
                let allowed = 1.5 * 16.0 * f64::from(crate::math::robust::UNIT_ROUNDOFF) / tip;
                let off = (f64::from(again) / f64::from(pdf) - 1.0).abs();
                assert!(off < allowed, "{phase:?}: {again} and {pdf}");
            }
        }
    }
}
