//! Radiance to the 8-bit pixels of a display format.

use super::{Layers, ToneMap};
use crate::math::color::srgb_from_linear;
use crate::pictures::{Quantized, Transfer, quantize};
use crate::render::settings::DisplayCurve;
use glam::Vec3;
use rayon::prelude::*;

/// How radiance is shown. Nothing of it touches OpenEXR or HDR files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Develop {
    /// The tone curve.
    pub tonemap: ToneMap,
    /// Exposure in stops; +1 doubles the light.
    pub exposure_ev: f64,
    /// Whether numbers are stored as they are, without sRGB encoding
    /// ([`Scene::display_is_linear`](crate::scene::Scene::display_is_linear)).
    pub display_is_linear: bool,
    /// Whether rounding is dithered.
    pub dither: bool,
}

impl Default for Develop {
    /// No tone curve, exposure 0, sRGB, dithered.
    fn default() -> Develop {
        Develop {
            tonemap: ToneMap::None,
            exposure_ev: 0.0,
            display_is_linear: false,
            dither: true,
        }
    }
}

impl Develop {
    /// The curve from radiance to display values, without rounding and dither.
    pub fn curve(&self) -> DisplayCurve {
        let (how, gain) = (*self, self.exposure_ev.exp2() as f32);
        DisplayCurve::new(move |rgb| {
            let shown = how.tonemap.apply(Vec3::from_array(rgb) * gain);
            shown.to_array().map(|v| {
                let v = f64::from(v.clamp(0.0, 1.0)); // a display shows no more and no less
                if how.display_is_linear {
                    v as f32
                } else {
                    srgb_from_linear(v) as f32
                }
            })
        })
    }
}

/// What becomes of alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlphaUse {
    /// Alpha is kept, colours are divided by it (PNG).
    Keep,
    /// The picture is shown on black (JPEG, PPM).
    OnBlack,
}

/// Develops an image. Where there is no coverage there is no colour to store: light without coverage (a glow)
/// shows only in opaque formats.
pub fn develop(layers: &Layers, how: &Develop, target: AlphaUse) -> Quantized {
    let gain = how.exposure_ev.exp2() as f32;
    let alpha = layers.alpha.as_deref().filter(|_| target == AlphaUse::Keep);
    let pixel = |(i, rgb): (usize, &[f32; 3])| {
        let coverage = alpha.and_then(|a| a.get(i)).copied().unwrap_or(1.0);
        let light = Vec3::from_array(*rgb);
        let light = if coverage == 1.0 {
            light
        } else if coverage > 0.0 {
            light / coverage
        } else {
            Vec3::ZERO
        };
        how.tonemap.apply(light * gain).to_array()
    };
    let shown: Vec<[f32; 3]> = layers.rgb.par_iter().enumerate().map(pixel).collect();
    let transfer = if how.display_is_linear {
        Transfer::Linear
    } else {
        Transfer::Srgb
    };
    quantize([layers.width, layers.height], &shown, alpha, transfer, how.dither)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_pixel(rgb: [f32; 3], alpha: Option<f32>) -> Layers {
        Layers {
            alpha: alpha.map(|a| vec![a]),
            ..Layers::from_rgb(1, 1, vec![rgb])
        }
    }

    fn plain() -> Develop {
        Develop {
            dither: false,
            ..Develop::default()
        }
    }

    #[test]
    fn one_stop_doubles_the_light() {
        let brighter = Develop {
            exposure_ev: 1.0,
            ..plain()
        };
        let a = develop(&one_pixel([0.1, 0.2, 0.4], None), &brighter, AlphaUse::Keep);
        let b = develop(&one_pixel([0.2, 0.4, 0.8], None), &plain(), AlphaUse::Keep);
        assert_eq!(a, b);
    }

    #[test]
    fn colour_is_divided_by_alpha_for_png_and_shown_on_black_elsewhere() {
        let half = one_pixel([0.25, 0.5, 0.0], Some(0.5));
        let linear = Develop {
            display_is_linear: true,
            ..plain()
        };
        assert_eq!(develop(&half, &linear, AlphaUse::Keep).bytes, [128, 255, 0, 128]);
        assert_eq!(develop(&half, &linear, AlphaUse::OnBlack).bytes, [64, 128, 0]);
        let nothing = one_pixel([0.0; 3], Some(0.0));
        assert_eq!(develop(&nothing, &linear, AlphaUse::Keep).bytes, [0; 4]);
    }

    #[test]
    fn pixels_that_are_not_numbers_are_counted_under_every_curve() {
        for (_, tonemap) in ToneMap::ALL {
            let how = Develop { tonemap, ..plain() };
            let q = develop(
                &one_pixel([f32::NAN, 0.0, f32::INFINITY], None),
                &how,
                AlphaUse::OnBlack,
            );
            assert_eq!((q.bytes[0], q.bytes[2], q.non_finite), (0, 255, 1));
        }
    }
}
