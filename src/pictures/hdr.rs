//! Radiance HDR (RGBE, run-length coded): linear light with a shared exponent, about 1 % per component.

use super::EncodeError;
use image::Rgb;
use image::codecs::hdr::HdrEncoder;

/// The largest number that a shared exponent of 2¹²⁷ holds, rounded down.
const LARGEST: f32 = 1.6e38;

/// The bytes of a file and how many pixels could not be shown as they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoded {
    /// The file.
    pub bytes: Vec<u8>,
    /// Pixels with a component that is not finite; NaN and −∞ became 0, +∞ the largest number.
    pub non_finite: u64,
}

/// Encodes linear colours, row by row from the top left. Negative components become 0 (the format has no sign).
/// Each entry of `metadata` becomes a header line `# key: value`.
pub fn encode(size: [u32; 2], rgb: &[[f32; 3]], metadata: &[(String, String)]) -> Result<Encoded, EncodeError> {
    let [width, height] = size;
    let error = |reason: String| EncodeError {
        format: "HDR",
        width,
        height,
        reason,
    };
    if width > 32_767 {
        return Err(error("a row may have at most 32767 pixels".to_owned()));
    }
    if rgb.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(error(format!("found {} colours", rgb.len())));
    }
    let non_finite = rgb.iter().filter(|p| p.iter().any(|v| !v.is_finite())).count() as u64;
    let pixels: Vec<Rgb<f32>> = rgb
        .iter()
        .map(|p| Rgb(p.map(|v| if v.is_nan() { 0.0 } else { v.clamp(0.0, LARGEST) })))
        .collect();
    let mut coded = Vec::new();
    HdrEncoder::new(&mut coded)
        .encode(&pixels, width as usize, height as usize)
        .map_err(|e| error(e.to_string()))?;
    // The header ends with an empty line; ours replaces it, since the encoder takes no comments.
    let end = coded
        .windows(2)
        .position(|w| w == b"\n\n")
        .ok_or_else(|| error("no header was written".to_owned()))?;
    let mut bytes = b"#?RADIANCE\n".to_vec();
    for (key, value) in metadata {
        let line: String = format!("# {key}: {value}")
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        bytes.extend_from_slice(line.as_bytes());
        bytes.push(b'\n');
    }
    bytes.extend_from_slice(b"FORMAT=32-bit_rle_rgbe");
    bytes.extend_from_slice(coded.get(end..).unwrap_or_default());
    Ok(Encoded { bytes, non_finite })
}

#[cfg(test)]
mod tests {
    use super::super::{Limits, Texels, decode};
    use super::*;

    #[test]
    fn colours_come_back_within_the_precision_of_a_shared_exponent() {
        for width in [1_u32, 7, 8, 300] {
            let rgb: Vec<[f32; 3]> = (0..width * 2)
                .map(|i| [0.0, 0.3, 0.6].map(|o| ((i as f32 * 0.37 + o).sin() * 12.0).exp2()))
                .collect();
            let meta = [("Software".to_owned(), "pts\nY 1".to_owned())];
            let file = encode([width, 2], &rgb, &meta).expect("encodes");
            let picture = decode(&file.bytes, "a.hdr", Limits::default()).expect("decodes");
            let Texels::RgbF32(texels) = picture.texels else {
                panic!("not float")
            };
            assert_eq!(texels.len(), rgb.len());
            for (found, expected) in texels.iter().zip(&rgb) {
                let largest = expected.iter().copied().fold(0.0, f32::max);
                for c in 0..3 {
                    let error = (found[c] - expected[c]).abs() / largest;
                    assert!(error <= 1.0 / 127.0, "{found:?} for {expected:?}");
                }
            }
        }
    }

    #[test]
    fn values_that_are_not_numbers_are_counted_and_do_not_spoil_the_file() {
        let rgb = [[f32::NAN, 1.0, -3.0], [f32::INFINITY, 0.0, 0.0]];
        let file = encode([2, 1], &rgb, &[]).expect("encodes");
        assert_eq!(file.non_finite, 2);
        let picture = decode(&file.bytes, "a.hdr", Limits::default()).expect("decodes");
        let first = picture.rgba(0, 0).expect("inside");
        assert_eq!((first[0], first[2]), (0.0, 0.0));
        assert!((first[1] - 1.0).abs() < 0.01);
        assert!(picture.rgba(1, 0).expect("inside")[0] > 1e38);
    }
}
