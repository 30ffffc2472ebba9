//! Numbers as colours.

use crate::math::color::linear_from_srgb;

/// The sRGB code of places where there is no number: a grey, which the map does not have.
pub const UNKNOWN: [u8; 3] = [96; 3];

/// Colours of matplotlib's "magma" (S. van der Walt and N. Smith, 2015, CC0) at sixteenths, sRGB.
const MAGMA: [[u8; 3]; 17] = [
    [0, 0, 4],
    [10, 8, 34],
    [29, 17, 71],
    [54, 16, 107],
    [81, 18, 124],
    [106, 28, 129],
    [131, 38, 129],
    [156, 46, 127],
    [183, 55, 121],
    [207, 64, 112],
    [229, 80, 100],
    [244, 105, 92],
    [251, 135, 97],
    [254, 165, 113],
    [254, 194, 135],
    [253, 224, 161],
    [252, 253, 191],
];

/// The colour of a value in [0, 1], linear; values outside have that of the nearer end, NaN is [`UNKNOWN`]. The map goes from
/// black over violet and orange to pale yellow, in steps that look equal, lightness always rising: it can be read in
/// grey and by the colour-blind.
pub fn magma(value: f64) -> [f32; 3] {
    if value.is_nan() {
        return UNKNOWN.map(|c| linear_from_srgb(f64::from(c) / 255.0) as f32);
    }
    let last = MAGMA.len() - 1;
    let at = value.clamp(0.0, 1.0) * last as f64;
    let low = (at as usize).min(last - 1);
    let t = at - low as f64;
    let code = |c: usize| f64::from(MAGMA[low][c]) * (1.0 - t) + f64::from(MAGMA[low + 1][c]) * t;
    [0, 1, 2].map(|c| linear_from_srgb(code(c) / 255.0) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(color: [f32; 3]) -> [u8; 3] {
        color.map(|c| (crate::math::color::srgb_from_linear(f64::from(c)) * 255.0).round() as u8)
    }

    /// Source: matplotlib's own 256 entries.
    #[test]
    fn magma_has_the_published_colours() {
        assert_eq!(code(magma(0.0)), [0, 0, 4]);
        assert_eq!(code(magma(1.0)), [252, 253, 191]);
        assert_eq!(code(magma(0.5)), [183, 55, 121]);
        assert_eq!([magma(-1.0), magma(7.0)], [magma(0.0), magma(1.0)]);
        assert_eq!(magma(f64::NEG_INFINITY), magma(0.0));
        assert_eq!(code(magma(f64::NAN)), UNKNOWN);
    }

    #[test]
    fn lightness_always_rises() {
        let luminance = |i: u32| crate::math::color::luminance(magma(f64::from(i) / 256.0).into());
        assert!((0..256).all(|i| luminance(i) < luminance(i + 1)));
    }
}
