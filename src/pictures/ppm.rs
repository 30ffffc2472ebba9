//! Binary portable pixmaps (P6): the format every tool reads.

use super::quantize::Quantized;

/// Encodes pixels as P6; alpha is left out. Each entry of `metadata` becomes a comment `# key: value`.
pub fn encode(pixels: &Quantized, metadata: &[(String, String)]) -> Vec<u8> {
    let mut out = b"P6\n".to_vec();
    for (key, value) in metadata {
        let line: String = format!("# {key}: {value}")
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        out.extend_from_slice(line.as_bytes());
        out.push(b'\n');
    }
    out.extend_from_slice(format!("{} {}\n255\n", pixels.width, pixels.height).as_bytes());
    let channels = if pixels.has_alpha { 4 } else { 3 };
    for pixel in pixels.bytes.chunks_exact(channels) {
        out.extend(pixel.iter().take(3));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{Limits, Texels, Transfer, decode, quantize};
    use super::*;

    #[test]
    fn pixels_come_back_and_a_line_break_in_the_metadata_does_no_harm() {
        let rgb = [[0.1, 0.2, 0.3], [1.0, 0.0, 0.9]];
        let q = quantize([1, 2], &rgb, None, Transfer::Srgb, true);
        let bytes = encode(&q, &[("scene".to_owned(), "a\n9 9\n255\nb".to_owned())]);
        let picture = decode(&bytes, "a.ppm", Limits::default()).expect("decodes");
        let Texels::Rgb8(texels) = picture.texels else {
            panic!("not RGB")
        };
        assert_eq!(texels.as_flattened(), q.bytes);
    }
}
