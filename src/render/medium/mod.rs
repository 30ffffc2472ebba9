//! What light passes through between surfaces: homogeneous media, fog, and the solids a path is inside of.

pub mod fog;
mod passage;
pub mod phase;
pub mod stack;

pub use passage::{Passage, passage};
pub use stack::MediumStack;

use crate::math::portable::exp;
use glam::Vec3;
use phase::Phase;

/// A homogeneous medium; coefficients are per world unit and channel, ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Share of light that each unit of way takes from a ray, by absorption and scattering together.
    pub extinction: Vec3,
    /// Of it what goes on in another direction; at most `extinction`.
    pub scattering: Vec3,
    /// Radiance that each unit of way adds.
    pub emission: Vec3,
    /// Where scattered light goes.
    pub phase: Phase,
}

/// Index of the medium that does nothing, in every scene.
pub const CLEAR: u32 = 0;

impl Medium {
    /// What does nothing to light.
    pub const CLEAR: Medium = Medium {
        extinction: Vec3::ZERO,
        scattering: Vec3::ZERO,
        emission: Vec3::ZERO,
        phase: Phase::ISOTROPIC,
    };

    /// A medium that only absorbs.
    pub fn absorbing(absorption: Vec3) -> Medium {
        Medium {
            extinction: absorption,
            ..Medium::CLEAR
        }
    }

    /// Whether it scatters in any channel.
    #[inline(always)]
    pub fn scatters(&self) -> bool {
        self.scattering != Vec3::ZERO
    }

    /// The share of light that is left after `distance`, per channel, in [0, 1]. No extinction gives exactly 1, whatever
    /// the distance, and so does no distance (a shadow ray to a light that is as good as touched may have a length below
    /// 0) however strong it is; full extinction gives 0, never NaN.
    pub fn transmittance(&self, distance: f32) -> Vec3 {
        let channel = |sigma: f32| {
            if sigma > 0.0 && distance > 0.0 {
                exp(-sigma * distance)
            } else {
                1.0
            }
        };
        let s = self.extinction;
        Vec3::new(channel(s.x), channel(s.y), channel(s.z))
    }

    /// Radiance that `distance` of the medium adds to a ray, extinction on the way included: ε·(1 − exp(−σd))/σ, the limit
    /// ε·d without extinction. A ray without end in a channel that shines and takes nothing has no finite value; such
    /// media are refused before.
    pub fn emitted(&self, distance: f32) -> Vec3 {
        let channel = |emission: f32, sigma: f32| {
            if emission == 0.0 || distance <= 0.0 {
                return 0.0;
            }
            let depth = f64::from(sigma) * f64::from(distance);
            let ways = if depth == 0.0 {
                1.0
            } else {
                -libm::expm1(-depth) / depth
            };
            // σ·d may be infinite where d is; then the limit is ε/σ.
            if depth.is_finite() {
                (f64::from(emission) * f64::from(distance) * ways) as f32
            } else {
                emission / sigma
            }
        };
        let (e, s) = (self.emission, self.extinction);
        Vec3::new(channel(e.x, s.x), channel(e.y, s.y), channel(e.z, s.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(sigma: f32, distance: f32) -> f32 {
        Medium::absorbing(Vec3::splat(sigma)).transmittance(distance).x
    }

    /// Beer–Lambert at its ends: nothing absorbs over any way, anything over no way; the rest ends at 0.
    #[test]
    fn absorption_is_exact_at_its_ends() {
        let m = Medium::absorbing(Vec3::new(0.0, 1e33, 0.5));
        assert_eq!(m.transmittance(f32::INFINITY), Vec3::new(1.0, 0.0, 0.0));
        for distance in [-1.0, -1e-30, 0.0, 1e-30, 1.0, 1e6, 1e38, f32::INFINITY] {
            assert_eq!(through(0.0, distance), 1.0, "nothing absorbs over {distance}");
        }
        for sigma in [1e-45, 1.0, 1e6, 1e33, f32::INFINITY] {
            for distance in [-1e30, -1e-6, 0.0] {
                assert_eq!(through(sigma, distance), 1.0, "{sigma} over {distance}");
            }
            assert_eq!(through(sigma, f32::INFINITY), 0.0, "{sigma} over an infinite way");
        }
    }

    /// Oracle: f64. The optical depth has one rounding, which changes the result by u times that depth; the
    /// exponential is right to one unit in the last place, 2u; below the normal numbers steps of 2⁻¹⁴⁹ are left.
    #[test]
    fn absorption_matches_f64_over_all_depths() {
        let u = f64::from(crate::math::robust::UNIT_ROUNDOFF);
        for sigma in [1e-33, 1e-9, 1e-3, 0.1, 0.7, 1.0, 30.0, 1e6, 1e33f32] {
            let mut last = 1.0;
            for i in 0..=1400 {
                let distance = 10f64.powf(f64::from(i) / 20.0 - 35.0) as f32;
                let depth = f64::from(sigma) * f64::from(distance);
                let (found, exact) = (f64::from(through(sigma, distance)), (-depth).exp());
                let allowed = exact * u * (depth + 2.0) + 2f64.powi(-149);
                assert!(
                    (found - exact).abs() <= allowed,
                    "{sigma} over {distance}: {found}, exactly {exact}"
                );
                assert!(
                    (0.0..=last).contains(&found),
                    "{sigma} over {distance}: {found} after {last}"
                );
                last = found;
            }
        }
    }

    /// Emission over a way, against its integral in f64 and at its ends: no way, no extinction, no end.
    #[test]
    fn emission_along_a_way_is_that_of_its_integral() {
        let u = f64::from(crate::math::robust::UNIT_ROUNDOFF);
        for sigma in [0.0, 1e-30, 1e-8, 1e-3, 0.5, 3.0, 1e4f32] {
            for distance in [-1.0, 0.0, 1e-20, 1e-3, 1.0, 50.0, 1e6f32] {
                let m = Medium {
                    emission: Vec3::splat(0.7),
                    ..Medium::absorbing(Vec3::splat(sigma))
                };
                let (s, d) = (f64::from(sigma), f64::from(distance.max(0.0)));
                // 1 − e^{−x} by its series where subtracting would lose digits.
                let (x, e) = (s * d, f64::from(0.7f32));
                let exact = if x < 1e-6 {
                    e * d * (1.0 - x / 2.0 + x * x / 6.0)
                } else {
                    e / s * (1.0 - (-x).exp())
                };
                let found = f64::from(m.emitted(distance).y);
                assert!(
                    (found - exact).abs() <= exact * 2.0 * u,
                    "{sigma} over {distance}: {found}, exactly {exact}"
                );
            }
        }
        let fire = Medium {
            emission: Vec3::new(0.0, 2.0, 3.0),
            ..Medium::absorbing(Vec3::new(0.0, 4.0, 0.5))
        };
        assert_eq!(fire.emitted(f32::INFINITY), Vec3::new(0.0, 0.5, 6.0));
    }
}
