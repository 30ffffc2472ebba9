//! JPEG at a quality that shows no blocks, with comments.

use super::EncodeError;
use super::quantize::Quantized;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

/// Quality of the quantisation tables, of 100: artefacts stay below the noise of a good render.
const QUALITY: u8 = 95;

/// Encodes pixels as JPEG; alpha is left out. Each entry of `metadata` becomes a comment `key: value`.
pub fn encode(pixels: &Quantized, metadata: &[(String, String)]) -> Result<Vec<u8>, EncodeError> {
    let error = |reason: String| EncodeError {
        format: "JPEG",
        width: pixels.width,
        height: pixels.height,
        reason,
    };
    if pixels.width.max(pixels.height) > 65_535 {
        return Err(error("a side may have at most 65535 pixels".to_owned()));
    }
    let opaque: Vec<u8>;
    let rgb = if pixels.has_alpha {
        opaque = pixels
            .bytes
            .chunks_exact(4)
            .flat_map(|p| p.iter().take(3).copied())
            .collect();
        &opaque
    } else {
        &pixels.bytes
    };
    let mut out = Vec::new();
    JpegEncoder::new_with_quality(&mut out, QUALITY)
        .encode(rgb, pixels.width, pixels.height, ExtendedColorType::Rgb8)
        .map_err(|e| error(e.to_string()))?;
    let comments: Vec<u8> = metadata.iter().flat_map(comment_segment).collect();
    let at = after_app0(&out);
    out.splice(at..at, comments);
    Ok(out)
}

/// A COM segment: marker, length with itself, text.
fn comment_segment((key, value): &(String, String)) -> Vec<u8> {
    let mut text = format!("{key}: {value}").into_bytes();
    text.truncate(65_533);
    let length = (text.len() as u16 + 2).to_be_bytes();
    [&[0xff, 0xfe], length.as_slice(), text.as_slice()].concat()
}

/// Where the first segment after the JFIF header begins: readers expect that header right after the start marker.
fn after_app0(jpeg: &[u8]) -> usize {
    match jpeg {
        [0xff, 0xd8, 0xff, 0xe0, high, low, ..] => 4 + usize::from(u16::from_be_bytes([*high, *low])),
        _ => 2,
    }
    .min(jpeg.len())
}

#[cfg(test)]
mod tests {
    use super::super::{Limits, Transfer, decode, quantize};
    use super::*;

    #[test]
    fn a_smooth_picture_comes_back_nearly_unchanged_and_keeps_its_comment() {
        let rgb: Vec<[f32; 3]> = (0..64 * 48)
            .map(|i| [(i % 64) as f32 / 63.0, (i / 64) as f32 / 47.0, 0.5])
            .collect();
        let q = quantize([64, 48], &rgb, Some(&vec![0.5; 64 * 48]), Transfer::Srgb, false);
        let bytes = encode(&q, &[("Software".to_owned(), "pts ∞".to_owned())]).expect("encodes");
        let comment = "Software: pts ∞".as_bytes();
        assert!(bytes.windows(comment.len()).any(|w| w == comment));
        let picture = decode(&bytes, "a.jpg", Limits::default()).expect("decodes");
        for (i, q) in q.bytes.chunks_exact(4).enumerate() {
            let found = picture.texels.rgba(i).expect("all pixels");
            for c in 0..3 {
                let difference = (found[c] * 255.0 - f32::from(q[c])).abs();
                assert!(difference < 12.0, "pixel {i} channel {c}: off by {difference} of 255");
            }
        }
    }
}
