//! Tone curves: scene-linear radiance to display-linear [0, 1]. For display formats only; OpenEXR and HDR files
//! hold the radiance itself.

use crate::math::color::luminance;
use glam::{Mat3, Vec3};

/// How highlights are brought into the range of a display.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// Values above 1 are cut off.
    #[default]
    None,
    /// Khronos PBR Neutral: keeps base colours, compresses only highlights.
    Neutral,
    /// AgX (minimal fit): photographic, highlights turn white.
    Agx,
    /// ACES filmic curve (Narkowicz's fit), per channel.
    Aces,
    /// Reinhard's curve on the luminance.
    Reinhard,
}

impl ToneMap {
    /// All of them with the names that users write.
    pub const ALL: [(&'static str, ToneMap); 5] = [
        ("none", ToneMap::None),
        ("neutral", ToneMap::Neutral),
        ("agx", ToneMap::Agx),
        ("aces", ToneMap::Aces),
        ("reinhard", ToneMap::Reinhard),
    ];

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<ToneMap> {
        Self::ALL.iter().find(|(n, _)| *n == name).map(|(_, t)| *t)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, t)| *t == self).map_or("none", |(n, _)| n)
    }

    /// Display-linear colour of a scene-linear one. Not cut off: results may leave [0, 1] slightly where the curve
    /// does (always for `None`). Components that are not finite come out as they went in, so that whoever rounds
    /// them can count them.
    pub fn apply(self, color: Vec3) -> Vec3 {
        if !color.is_finite() {
            return color;
        }
        match self {
            ToneMap::None => color,
            ToneMap::Neutral => neutral(color),
            ToneMap::Agx => agx(color),
            ToneMap::Aces => aces(color),
            ToneMap::Reinhard => reinhard(color),
        }
    }
}

/// Khronos PBR Neutral. Takes away the 4 % that a dielectric reflects (less in the dark, so that black stays
/// black), keeps what is then below 0.76, compresses the peak above and fades towards white.
/// Source: Khronos PBR Neutral Tone Mapper specification, 2024.
fn neutral(color: Vec3) -> Vec3 {
    const F90: f32 = 0.04;
    const START: f32 = 0.8 - F90;
    const DESATURATION: f32 = 0.15;
    // The specification is for colours ≥ 0; the parabola would send large negative ones to −∞.
    let color = color.max(Vec3::ZERO);
    let x = color.min_element();
    let offset = if x < 2.0 * F90 { x - x * x / (4.0 * F90) } else { F90 };
    let color = color - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let range = 1.0 - START;
    let new_peak = 1.0 - range * range / (peak + range - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}

/// AgX with a polynomial for its contrast curve, without a look.
/// Source: T. Sobotka's AgX; matrices, range and 6th-order fit by B. Wrensch, "Minimal AgX Implementation" (2023).
fn agx(color: Vec3) -> Vec3 {
    const INSET: Mat3 = Mat3::from_cols_array(&[
        0.842_479_06,
        0.042_328_242,
        0.042_375_655,
        0.078_433_6,
        0.878_468_64,
        0.078_433_6,
        0.079_223_745,
        0.079_166_13,
        0.879_143,
    ]);
    const OUTSET: Mat3 = Mat3::from_cols_array(&[
        1.196_879,
        -0.052_896_85,
        -0.052_971_635,
        -0.098_020_88,
        1.151_903_1,
        -0.098_043_45,
        -0.099_029_74,
        -0.098_961_18,
        1.151_073_7,
    ]);
    /// Stops around 1 that the curve covers: mid grey (0.18) −10 and +6.5.
    const MIN_EV: f32 = -12.473_93;
    const MAX_EV: f32 = 4.026_069;
    let log = (INSET * color.max(Vec3::ZERO))
        .map(f32::log2) // log₂ 0 = −∞ is cut off next
        .clamp(Vec3::splat(MIN_EV), Vec3::splat(MAX_EV));
    let encoded = ((log - MIN_EV) / (MAX_EV - MIN_EV)).map(agx_contrast);
    // The curve's output is meant for a display of pure gamma 2.2; out-of-gamut negatives have no root.
    (OUTSET * encoded).max(Vec3::ZERO).map(|v| v.powf(2.2))
}

fn agx_contrast(x: f32) -> f32 {
    let c = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];
    c.into_iter().fold(0.0, |sum, c| sum * x + c)
}

/// A rational fit of the ACES reference and output transforms.
/// Source: K. Narkowicz, "ACES Filmic Tone Mapping Curve" (2015).
fn aces(color: Vec3) -> Vec3 {
    color.max(Vec3::ZERO).map(|x| {
        // Divided by x², so that the largest floats do not overflow.
        if x > 1.0 {
            (2.51 + 0.03 / x) / (2.43 + 0.59 / x + 0.14 / x / x)
        } else {
            (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)
        }
    })
}

/// L / (1 + L) on the luminance, hue kept.
/// Source: Reinhard et al., "Photographic Tone Reproduction for Digital Images" (2002), eq. 3.
fn reinhard(color: Vec3) -> Vec3 {
    color / (1.0 + luminance(color).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the specification's formula evaluated by hand for grey 1: 1 − 0.24² / (0.96 + 0.24 − 0.76).
    #[test]
    fn neutral_keeps_base_colours_less_four_percent_and_compresses_highlights() {
        for c in [Vec3::new(0.1, 0.5, 0.79), Vec3::splat(0.5), Vec3::new(0.08, 0.08, 0.2)] {
            assert!(
                (neutral(c) - (c - 0.04)).abs().max_element() < 1e-7,
                "{c} gave {}",
                neutral(c)
            );
        }
        assert!((neutral(Vec3::ONE).x - 0.869_091).abs() < 1e-6);
        assert_eq!(neutral(Vec3::ZERO), Vec3::ZERO);
        let bright = neutral(Vec3::new(1e4, 0.1, 0.1));
        assert!(
            bright.max_element() <= 1.0 && bright.min_element() > 0.9,
            "fades to white: {bright}"
        );
    }

    #[test]
    fn aces_has_the_published_values() {
        // (2.51 + 0.03) / (2.43 + 0.59 + 0.14) and the limit 2.51 / 2.43.
        assert!((aces(Vec3::ONE).x - 2.54 / 3.16).abs() < 1e-6);
        assert!((aces(Vec3::splat(0.18)).x - 0.086_724 / 0.324_932).abs() < 1e-6);
        assert!((aces(Vec3::splat(f32::MAX)).x - 2.51 / 2.43).abs() < 1e-6);
    }

    /// Source: the published polynomial at (log₂ 0.18 + 12.47393) / 16.5, worked out by hand: 0.4967.
    #[test]
    fn agx_maps_mid_grey_to_the_middle_and_its_ends_to_black_and_white() {
        let code = |v: f32| agx(Vec3::splat(v)).map(|v| v.powf(1.0 / 2.2));
        assert!(
            (code(0.18) - 0.4967).abs().max_element() < 1e-3,
            "mid grey at {}",
            code(0.18)
        );
        assert!(code(0.0).max_element() < 0.01, "black at {}", code(0.0));
        assert!(
            (code(100.0) - 1.0).abs().max_element() < 0.01,
            "white at {}",
            code(100.0)
        );
        let product = (0..3)
            .map(|i| agx(Vec3::AXES[i] * 1e3).min_element())
            .fold(f32::MAX, f32::min);
        assert!(
            product > 0.3,
            "bright primaries lose their saturation, the least component is {product}"
        );
    }

    #[test]
    fn reinhard_halves_white_and_keeps_hue() {
        let c = Vec3::new(2.0, 1.0, 0.5);
        let mapped = reinhard(c);
        assert!((luminance(mapped) - luminance(c) / (1.0 + luminance(c))).abs() < 1e-6);
        assert!((mapped / mapped.x - c / c.x).abs().max_element() < 1e-6);
    }

    #[test]
    fn every_curve_rises_on_greys_and_stays_a_number() {
        for (name, map) in ToneMap::ALL {
            assert_eq!(ToneMap::from_name(name), Some(map));
            let mut last = -1.0;
            for i in 0..400 {
                let v = map.apply(Vec3::splat((i as f32 * 0.1 - 25.0).exp2())).x;
                // AgX's fit is flat at its ends up to 3e-3.
                assert!(v >= last - 3e-3, "{name} falls at step {i}: {last} to {v}");
                last = v;
            }
            for c in [
                Vec3::splat(f32::MAX),
                Vec3::splat(-f32::MAX),
                Vec3::new(-1.0, 0.0, 1e30),
                Vec3::ZERO,
            ] {
                assert!(!map.apply(c).is_nan(), "{name} of {c}");
            }
            assert!(
                map.apply(Vec3::new(f32::NAN, 1.0, 1.0)).x.is_nan(),
                "{name} hides a NaN"
            );
        }
    }
}
