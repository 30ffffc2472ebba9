//! 8-bit PNG with an sRGB chunk and text.

use super::EncodeError;
use super::quantize::{Quantized, Transfer};
use png::{BitDepth, ColorType, Compression, Encoder, SrgbRenderingIntent};

/// The longest keyword that the format allows, in bytes.
const MAX_KEYWORD: usize = 79;

/// Encodes pixels as PNG. sRGB pixels are marked as such; pixels without a transfer curve carry no mark, since no
/// standard chunk says "as stored" and viewers then show the numbers as they are. Each entry of `metadata`
/// becomes a text chunk: Latin-1 where that can hold it, UTF-8 otherwise. The same input gives the same bytes.
pub fn encode(pixels: &Quantized, metadata: &[(String, String)]) -> Result<Vec<u8>, EncodeError> {
    let mut out = Vec::new();
    write(pixels, metadata, &mut out).map_err(|e| EncodeError {
        format: "PNG",
        width: pixels.width,
        height: pixels.height,
        reason: e.to_string(),
    })?;
    Ok(out)
}

fn write(pixels: &Quantized, metadata: &[(String, String)], out: &mut Vec<u8>) -> Result<(), png::EncodingError> {
    let mut encoder = Encoder::new(out, pixels.width, pixels.height);
    encoder.set_color(if pixels.has_alpha {
        ColorType::Rgba
    } else {
        ColorType::Rgb
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    if pixels.transfer == Transfer::Srgb {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    for (key, value) in metadata {
        let key = keyword(key);
        let value: String = value.chars().filter(|&c| c != '\0').collect();
        if value.chars().all(|c| u32::from(c) < 256) {
            encoder.add_text_chunk(key, value)?;
        } else {
            encoder.add_itxt_chunk(key, value)?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels.bytes)?;
    writer.finish()
}

/// A keyword the format accepts: 1 to 79 printable Latin-1 characters.
fn keyword(key: &str) -> String {
    let printable = |c: char| matches!(u32::from(c), 32..=126 | 161..=255);
    let mut key: String = key
        .chars()
        .map(|c| if printable(c) { c } else { '?' })
        .take(MAX_KEYWORD)
        .collect();
    key = key.trim().to_owned();
    if key.is_empty() { "Comment".to_owned() } else { key }
}

#[cfg(test)]
mod tests {
    use super::super::{Limits, Texels, decode, quantize};
    use super::*;

    fn noise(n: usize) -> Vec<[f32; 3]> {
        (0..n)
            .map(|i| [0.0, 0.37, 0.71].map(|o| (i as f32 * 0.618_034 + o).fract()))
            .collect()
    }

    #[test]
    fn pixels_come_back_with_and_without_alpha() {
        let alpha: Vec<f32> = (0..35).map(|i| i as f32 / 34.0).collect();
        let opaque = quantize([7, 5], &noise(35), None, Transfer::Srgb, true);
        let clear = quantize([7, 5], &noise(35), Some(&alpha), Transfer::Srgb, true);
        let decoded = |q| decode(&encode(q, &[]).expect("encodes"), "a.png", Limits::default()).expect("decodes");
        let Texels::Rgb8(rgb) = decoded(&opaque).texels else {
            panic!("not RGB")
        };
        assert_eq!(rgb.as_flattened(), opaque.bytes);
        let Texels::Rgba8(rgba) = decoded(&clear).texels else {
            panic!("not RGBA")
        };
        assert_eq!(rgba.as_flattened(), clear.bytes);
    }

    #[test]
    fn text_and_the_srgb_mark_are_readable_and_the_bytes_repeat() {
        let meta = [
            ("Software", "pts"),
            ("pts:scene", "Zürich.pts"),
            ("pts:note", "λ → ∞"),
            ("", "empty key"),
        ];
        let meta = meta.map(|(k, v)| (k.to_owned(), v.to_owned()));
        let q = quantize([2, 2], &noise(4), None, Transfer::Srgb, false);
        let bytes = encode(&q, &meta).expect("encodes");
        assert_eq!(bytes, encode(&q, &meta).expect("encodes"));
        let reader = png::Decoder::new(std::io::Cursor::new(&bytes))
            .read_info()
            .expect("reads");
        let info = reader.info();
        assert_eq!(info.srgb, Some(SrgbRenderingIntent::Perceptual));
        let latin1: Vec<_> = info
            .uncompressed_latin1_text
            .iter()
            .map(|t| (t.keyword.as_str(), t.text.as_str()))
            .collect();
        assert_eq!(
            latin1,
            [
                ("Software", "pts"),
                ("pts:scene", "Zürich.pts"),
                ("Comment", "empty key")
            ]
        );
        assert_eq!(info.utf8_text.first().expect("one").get_text().expect("plain"), "λ → ∞");
    }

    #[test]
    fn pixels_without_a_curve_carry_no_colour_mark() {
        let q = quantize([1, 1], &noise(1), None, Transfer::Linear, false);
        let bytes = encode(&q, &[]).expect("encodes");
        for chunk in [b"sRGB", b"gAMA", b"cHRM", b"iCCP"] {
            assert!(
                !bytes.windows(4).any(|w| w == chunk),
                "{}",
                String::from_utf8_lossy(chunk)
            );
        }
    }
}
