//! Media and fog as they are written.

use crate::diag::Span;
use crate::scene::Phase;
use glam::DVec3;

/// One `media { … }`. Coefficients are per world unit, whatever transforms the solid has.
#[derive(Clone, Debug)]
pub struct MediaDesc {
    /// `absorption`.
    pub absorption: DVec3,
    /// `scattering`: its colour.
    pub scattering: DVec3,
    /// `extinction`: how much of the scattered light is taken from the way ahead; 1 takes all of it.
    pub extinction: f64,
    /// `emission`, in the scene's working gamma.
    pub emission: DVec3,
    /// Type of scattering with its eccentricity.
    pub phase: Phase,
    /// Product of the densities, of patterned ones the mean.
    pub density: DVec3,
    /// A pattern that a density stands for, with its place.
    pub pattern: Option<(&'static str, Span)>,
    /// Where POV-Ray is told how to sample it, if it is.
    pub effort: Option<Span>,
    /// Where it was written.
    pub span: Span,
}

impl MediaDesc {
    /// A medium that does nothing.
    pub fn new(span: Span) -> MediaDesc {
        MediaDesc {
            absorption: DVec3::ZERO,
            scattering: DVec3::ZERO,
            extinction: 1.0,
            emission: DVec3::ZERO,
            phase: Phase::default(),
            density: DVec3::ONE,
            pattern: None,
            effort: None,
            span,
        }
    }

    /// Whether it does nothing to light.
    pub fn is_clear(&self) -> bool {
        [self.absorption, self.scattering, self.emission].map(|c| c * self.density) == [DVec3::ZERO; 3]
    }
}

/// `fog { … }`.
#[derive(Clone, Debug)]
pub struct FogDesc {
    /// `fog_type 2`: fog that lies on the ground.
    pub is_ground: bool,
    /// `distance`, if written; 0 switches the fog off.
    pub distance: Option<f64>,
    /// Colour with filter and transmit, in the scene's working gamma.
    pub color: [f64; 5],
    /// `fog_offset`.
    pub offset: f64,
    /// `fog_alt`; a negative one turns the fog upside down.
    pub alt: f64,
    /// `up`, of any length but 0.
    pub up: DVec3,
    /// Where `turbulence` was written.
    pub turbulence: Option<Span>,
    /// Where it was written.
    pub span: Span,
}

impl FogDesc {
    /// POV-Ray's defaults: black fog of no distance.
    pub fn new(span: Span) -> FogDesc {
        FogDesc {
            is_ground: false,
            distance: None,
            color: [0.0; 5],
            offset: 0.0,
            alt: 0.0,
            up: DVec3::Y,
            turbulence: None,
            span,
        }
    }
}
