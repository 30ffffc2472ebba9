//! Display-linear floats to 8 bits, with the transfer curve and a reproducible dither.

use crate::math::color::srgb_from_linear;
use rayon::prelude::*;

/// The curve between display light and stored numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Transfer {
    /// The piecewise sRGB curve.
    #[default]
    Srgb,
    /// The number itself: for scenes whose colours are meant as stored values.
    Linear,
}

/// 8-bit pixels, row by row from the top left, with 3 (RGB) or 4 (RGBA) bytes each.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantized {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whether there is a fourth byte, the alpha.
    pub has_alpha: bool,
    /// The curve that was applied.
    pub transfer: Transfer,
    /// `width · height · (3 or 4)` bytes.
    pub bytes: Vec<u8>,
    /// Pixels with a component that was not finite: NaN and −∞ are shown as 0, +∞ as 255.
    pub non_finite: u64,
}

/// Rounds display-linear colours in [0, 1] (values outside are clipped: the display has no more) to 8 bits.
///
/// With `dither` up to half a step is added before rounding, a function of the pixel's position alone. It keeps
/// the mean over an area exact, so that smooth gradients show no bands, and leaves values that are exactly
/// representable (black, white) as they are. Alpha is linear and not dithered. `alpha`, where given, and `rgb` hold
/// one value per pixel; missing ones are black.
pub fn quantize(
    size: [u32; 2],
    rgb: &[[f32; 3]],
    alpha: Option<&[f32]>,
    transfer: Transfer,
    dither: bool,
) -> Quantized {
    let [width, height] = size;
    let channels = if alpha.is_some() { 4 } else { 3 };
    let columns = (width as usize).max(1);
    let mut bytes = vec![0_u8; width as usize * height as usize * channels];
    let row = |(y, row): (usize, &mut [u8])| {
        let mut non_finite = 0_u64;
        for (x, out) in row.chunks_exact_mut(channels).enumerate() {
            let index = y * columns + x;
            let color = rgb.get(index).copied().unwrap_or_default();
            let mut finite = true;
            for (channel, (out, value)) in out.iter_mut().zip(color).enumerate() {
                finite &= value.is_finite();
                let offset = if dither {
                    dither_at(x as u32, y as u32, channel as u32)
                } else {
                    0.0
                };
                *out = byte_from(encode(value, transfer), offset);
            }
            if let (Some(alpha), Some(out)) = (alpha, out.get_mut(3)) {
                let value = alpha.get(index).copied().unwrap_or(1.0);
                finite &= value.is_finite();
                *out = byte_from(f64::from(value), 0.0);
            }
            non_finite += u64::from(!finite);
        }
        non_finite
    };
    let non_finite = bytes.par_chunks_mut(columns * channels).enumerate().map(row).sum();
    Quantized {
        width,
        height,
        has_alpha: alpha.is_some(),
        transfer,
        bytes,
        non_finite,
    }
}

fn encode(value: f32, transfer: Transfer) -> f64 {
    match transfer {
        Transfer::Srgb => srgb_from_linear(f64::from(value)),
        Transfer::Linear => f64::from(value),
    }
}

/// Rounds a value in [0, 1] plus `offset` steps to a byte. NaN gives 0 and infinities the nearer end.
fn byte_from(value: f64, offset: f64) -> u8 {
    // `as` saturates and takes NaN to 0, which is just what is wanted.
    (value * 255.0 + offset + 0.5).floor() as u8
}

/// A number in (−½, ½), equally distributed and the same for a pixel and channel in every run.
fn dither_at(x: u32, y: u32, channel: u32) -> f64 {
    let mut h = (u64::from(y) << 34) ^ (u64::from(x) << 2) ^ u64::from(channel);
    // The finaliser of SplitMix64: neighbouring keys give unrelated numbers.
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    h ^= h >> 31;
    ((h >> 12) as f64 + 0.5) / (1_u64 << 52) as f64 - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dither_keeps_the_mean_and_plain_rounding_does_not() {
        let value = 100.3 / 255.0;
        let image = vec![[value as f32; 3]; 256 * 256];
        let mean = |dither| {
            let q = quantize([256, 256], &image, None, Transfer::Linear, dither);
            q.bytes.iter().map(|&b| f64::from(b)).sum::<f64>() / q.bytes.len() as f64
        };
        // The mean of 196608 two-valued numbers has a standard deviation of 0.46 / 443 = 0.001.
        assert!((mean(true) - 100.3).abs() < 0.005, "dithered mean {}", mean(true));
        assert_eq!(mean(false), 100.0);
    }

    #[test]
    fn representable_values_survive_dithering() {
        let image: Vec<[f32; 3]> = (0..=255).map(|i| [i as f32 / 255.0; 3]).collect();
        let q = quantize([256, 1], &image, None, Transfer::Linear, true);
        let expected: Vec<u8> = (0..=255).flat_map(|i| [i, i, i]).collect();
        assert_eq!(q.bytes, expected);
    }

    #[test]
    fn values_that_are_not_numbers_are_shown_and_counted() {
        let (nan, inf) = (f32::NAN, f32::INFINITY);
        let image = [[nan, 0.5, inf], [-inf, 0.0, 1.0], [2.0, -1.0, 0.25]];
        for dither in [false, true] {
            let q = quantize([3, 1], &image, None, Transfer::Linear, dither);
            assert_eq!((q.bytes[0], q.bytes[2]), (0, 255));
            assert_eq!(q.bytes[3..6], [0, 0, 255]);
            assert_eq!(q.bytes[6..8], [255, 0]);
            assert_eq!(q.non_finite, 2);
        }
    }

    #[test]
    fn mid_grey_has_the_srgb_code_188() {
        let q = quantize([1, 1], &[[0.5; 3]], Some(&[0.5]), Transfer::Srgb, false);
        assert_eq!(q.bytes, [188, 188, 188, 128]); // IEC 61966-2-1: 0.5 → 0.735357
    }
}
