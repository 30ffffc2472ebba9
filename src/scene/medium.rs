//! What light passes through: the inside of solids, and the air between them.

use super::Place;
use glam::DVec3;

/// Where light goes that a medium scatters. All are normalised over the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Henyey and Greenstein's function of this eccentricity in (−1, 1): 0 is isotropic, 1 straight on, −1 back.
    HenyeyGreenstein(f64),
    /// 3/(16π)·(1 + cos²θ): molecules of air.
    Rayleigh,
    /// POV-Ray's Mie haze: (0.5 + 4.5·((1 + cos θ)/2)⁸)/4π.
    Hazy,
    /// POV-Ray's murky Mie atmosphere: (0.5 + 16.5·((1 + cos θ)/2)³²)/4π.
    Murky,
}

impl Default for Phase {
    /// Isotropic.
    fn default() -> Phase {
        Phase::HenyeyGreenstein(0.0)
    }
}

/// A homogeneous medium. Coefficients are per world unit and channel, ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Medium {
    /// Absorption: over a way d the share exp(−σ·d) is left.
    pub absorption: DVec3,
    /// Scattering; it takes from the way ahead what it sends elsewhere.
    pub scattering: DVec3,
    /// Radiance that the medium adds to a ray per unit of way.
    pub emission: DVec3,
    /// Where scattered light goes.
    pub phase: Phase,
}

impl Medium {
    /// A medium that only absorbs.
    pub fn absorbing(absorption: DVec3) -> Medium {
        Medium {
            absorption,
            ..Medium::default()
        }
    }

    /// Whether it does nothing to light.
    pub fn is_clear(&self) -> bool {
        [self.absorption, self.scattering, self.emission] == [DVec3::ZERO; 3]
    }

    /// This and another one in the same place. Where both scatter, the phase is that of the stronger.
    pub fn and(self, other: &Medium) -> Medium {
        let own_phase = self.scattering.element_sum() >= other.scattering.element_sum();
        Medium {
            absorption: self.absorption + other.absorption,
            scattering: self.scattering + other.scattering,
            emission: self.emission + other.emission,
            phase: if own_phase { self.phase } else { other.phase },
        }
    }
}

/// Fog between camera and surfaces, after POV-Ray: what lies behind a way of optical depth τ is seen by the share
/// exp(−τ), the rest is the fog's colour. It is not lit, and does not dim lamps; solids displace it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fog {
    /// Radiance of endless fog, linear RGB.
    pub color: DVec3,
    /// Way on which 1/e is left, > 0.
    pub distance: f64,
    /// For fog that lies on the ground: where it is.
    pub ground: Option<GroundFog>,
    /// Where it was written.
    pub place: Place,
}

/// Fog whose density is that of [`Fog::distance`] up to a height and falls off above by 1/(1 + (above/falloff)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundFog {
    /// Unit direction of up.
    pub up: DVec3,
    /// Height along `up` to which the density is constant.
    pub offset: f64,
    /// Height above `offset` at which the density is a half, > 0.
    pub falloff: f64,
}
