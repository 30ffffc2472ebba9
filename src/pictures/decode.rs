//! Bytes of any supported image format to a [`Picture`], with bounded memory and without panics.

use super::{Picture, Texels};
use super::{decode_exr, decode_ktx2};
use crate::diag::{Diagnostic, guarded};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use std::io::Cursor;

/// What a decoder may use. Sizes are checked before any texel is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most texels of one picture.
    pub max_texels: u64,
    /// Most bytes one decoder may allocate at a time.
    pub max_bytes: u64,
}

impl Default for Limits {
    /// 2²⁸ texels (16384 × 16384) and 4 GiB.
    fn default() -> Limits {
        Limits {
            max_texels: 1 << 28,
            max_bytes: 1 << 32,
        }
    }
}

/// The formats [`decode`] reads, as error messages list them.
pub(super) const READABLE: &str = "PNG, JPEG, WebP, KTX2, BMP, TGA, GIF, PNM, Radiance HDR and OpenEXR";

/// Decodes an image. The format is told by its first bytes, for TGA (which has no signature) by the ending of
/// `name`, which is otherwise only used in messages. Of an animation the first frame is taken, of an OpenEXR
/// file the colour of the first layer.
///
/// Errors name the format, what failed, and how to mend it; they carry `name` as their place.
pub fn decode(bytes: &[u8], name: &str, limits: Limits) -> Result<Picture, Diagnostic> {
    // The decoders are other people's code fed with bytes we do not control: a panic in one of them is
    // reported like any other damage.
    guarded(|| decode_unguarded(bytes, name, limits))
        .unwrap_or_else(|| Err(damaged("image", "the decoder stopped on inconsistent data")))
        .map_err(|d| d.in_place(name))
}

fn decode_unguarded(bytes: &[u8], name: &str, limits: Limits) -> Result<Picture, Diagnostic> {
    if bytes.is_empty() {
        return Err(Diagnostic::error("I0001", "image file is empty (0 bytes)").hint("export or download it again"));
    }
    if bytes.starts_with(&EXR_MAGIC) {
        return decode_exr::decode(bytes, limits);
    }
    if bytes.starts_with(&decode_ktx2::MAGIC) {
        return decode_ktx2::decode(bytes, limits);
    }
    decode_with_image(bytes, format_of(bytes, name)?, limits)
}

/// The format of anything else.
fn format_of(bytes: &[u8], name: &str) -> Result<ImageFormat, Diagnostic> {
    match image::guess_format(bytes) {
        Ok(format) if format.reading_enabled() => Ok(format),
        Ok(format) => Err(unsupported(&format!("{format:?}").to_uppercase())),
        Err(_) if has_extension(name, "tga") => Ok(ImageFormat::Tga),
        Err(_) => Err(unknown(bytes)),
    }
}

/// What decoding costs, by what the header of the file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Bytes of the texels.
    pub result: u64,
    /// Bytes that the decoder holds at its peak, the result included; an estimate from above.
    pub peak: u64,
}

/// What [`decode`] would cost; `None` if the header cannot be read. Nothing of that size is allocated.
pub fn cost(bytes: &[u8], name: &str, limits: Limits) -> Option<Cost> {
    // Progressive JPEG keeps 16-bit coefficients, WebP its own colour planes, a GIF a canvas, the OpenEXR library blocks.
    let with = |result: u64, halves: u64| Cost {
        result,
        peak: (result / 2).saturating_mul(halves),
    };
    let measure = || -> Result<Cost, Diagnostic> {
        if bytes.starts_with(&EXR_MAGIC) {
            let headers = decode_exr::headers(bytes, limits)?;
            let texels = headers.iter().map(|h| h.layer_size.area() as u64).max();
            return Ok(with(texels.unwrap_or(0).saturating_mul(16), 3));
        }
        if bytes.starts_with(&decode_ktx2::MAGIC) {
            let (width, height, texel) = decode_ktx2::measure(bytes, limits)?;
            return Ok(with(u64::from(width) * u64::from(height) * texel, 3));
        }
        let format = format_of(bytes, name)?;
        let decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder();
        let decoder = decoder.map_err(|e| failed(label(format), e, limits))?;
        let halves = match format {
            ImageFormat::Jpeg => 6,
            ImageFormat::WebP | ImageFormat::Gif => 4,
            _ => 2,
        };
        Ok(with(decoder.total_bytes(), halves))
    };
    guarded(measure)?.ok()
}

/// The first bytes of every OpenEXR file.
pub(super) const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

fn decode_with_image(bytes: &[u8], format: ImageFormat, limits: Limits) -> Result<Picture, Diagnostic> {
    let label = label(format);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut bounds = image::Limits::no_limits();
    bounds.max_alloc = Some(limits.max_bytes);
    reader.limits(bounds);
    let decoder = reader.into_decoder().map_err(|e| failed(label, e, limits))?;
    let (width, height) = decoder.dimensions();
    check_size(label, width.into(), height.into(), limits)?;
    // Some decoders ignore the limit they are given, so that the size of the result is checked here too.
    if decoder.total_bytes() > limits.max_bytes {
        return Err(too_large(label, width.into(), height.into(), limits));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(|e| failed(label, e, limits))?;
    let texels = texels_from(image);
    if texels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(damaged(label, "it holds fewer texels than its header promises"));
    }
    Ok(Picture { width, height, texels })
}

/// Refuses empty pictures and such with more texels than allowed.
pub(super) fn check_size(label: &str, width: u64, height: u64, limits: Limits) -> Result<(), Diagnostic> {
    if width == 0 || height == 0 {
        return Err(damaged(label, &format!("its header says {width}x{height} texels")));
    }
    match width.checked_mul(height) {
        Some(n) if n <= limits.max_texels && width.max(height) <= u64::from(u32::MAX) => Ok(()),
        _ => Err(too_large(label, width, height, limits)),
    }
}

fn texels_from(image: DynamicImage) -> Texels {
    match image {
        DynamicImage::ImageLuma8(i) => Texels::Gray8(i.into_raw()),
        DynamicImage::ImageLumaA8(i) => Texels::Rgba8(i.pixels().map(|p| [p[0], p[0], p[0], p[1]]).collect()),
        DynamicImage::ImageRgb8(i) => Texels::Rgb8(pixels(i.into_raw())),
        DynamicImage::ImageRgba8(i) => Texels::Rgba8(pixels(i.into_raw())),
        DynamicImage::ImageLuma16(i) => Texels::Gray16(i.into_raw()),
        DynamicImage::ImageLumaA16(i) => Texels::Rgba16(i.pixels().map(|p| [p[0], p[0], p[0], p[1]]).collect()),
        DynamicImage::ImageRgb16(i) => Texels::Rgb16(pixels(i.into_raw())),
        DynamicImage::ImageRgba16(i) => Texels::Rgba16(pixels(i.into_raw())),
        DynamicImage::ImageRgb32F(i) => Texels::RgbF32(pixels(i.into_raw())),
        DynamicImage::ImageRgba32F(i) => Texels::RgbaF32(pixels(i.into_raw())),
        // `DynamicImage` may grow; its own conversion serves whatever it grows.
        other => Texels::RgbaF32(other.into_rgba32f().pixels().map(|p| p.0).collect()),
    }
}

/// N numbers a texel, without a copy where the allocation allows that.
pub(super) fn pixels<T: bytemuck::Pod, const N: usize>(mut numbers: Vec<T>) -> Vec<[T; N]> {
    numbers.truncate(numbers.len() / N * N);
    bytemuck::allocation::try_cast_vec(numbers).unwrap_or_else(|(_, numbers)| numbers.as_chunks::<N>().0.to_vec())
}

fn label(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::WebP => "WebP",
        ImageFormat::Bmp => "BMP",
        ImageFormat::Tga => "TGA",
        ImageFormat::Gif => "GIF",
        ImageFormat::Pnm => "PNM",
        ImageFormat::Hdr => "Radiance HDR",
        _ => "image",
    }
}

fn has_extension(name: &str, extension: &str) -> bool {
    name.rsplit_once('.')
        .is_some_and(|(_, e)| e.eq_ignore_ascii_case(extension))
}

/// An error of the decoder in our words; its own begin with the format, which has been named already.
fn failed(label: &str, error: ImageError, limits: Limits) -> Diagnostic {
    if let ImageError::Limits(_) = error {
        let most = limits.max_bytes >> 20;
        let message = format!("{label} image is too large: decoding it would take more than {most} MiB");
        return Diagnostic::error("I0004", message).hint(SCALE_DOWN);
    }
    let text = error.to_string();
    let reason = match text.split_once(": ") {
        Some((prefix, reason)) if prefix.starts_with("Format error") => reason,
        _ => &text,
    };
    damaged(label, reason)
}

const SCALE_DOWN: &str = "scale it down; a damaged header can also claim such a size";

/// A file of a known format whose content is broken.
pub(super) fn damaged(label: &str, reason: &str) -> Diagnostic {
    let reason: String = reason.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    Diagnostic::error("I0005", format!("{label} data cannot be decoded: {}", reason.trim()))
        .hint("open the file in an image editor and save it again, or fetch it anew if it is incomplete")
}

fn too_large(label: &str, width: u64, height: u64, limits: Limits) -> Diagnostic {
    Diagnostic::error(
        "I0004",
        format!(
            "{label} image of {width}x{height} texels is too large, at most {} texels and {} MiB are decoded",
            limits.max_texels,
            limits.max_bytes >> 20
        ),
    )
    .hint(SCALE_DOWN)
}

fn unsupported(format: &str) -> Diagnostic {
    Diagnostic::error(
        "I0003",
        format!("image format {format} is not supported, expected one of {READABLE}"),
    )
    .hint("convert the image to PNG (colour) or OpenEXR (high dynamic range)")
}

/// Bytes that no decoder claims: tells what they are where that can be seen.
fn unknown(bytes: &[u8]) -> Diagnostic {
    let at = |offset: usize, signature: &[u8]| bytes.get(offset..).is_some_and(|b| b.starts_with(signature));
    let known: [(usize, &[u8], &str); 11] = [
        (0, b"\xabKTX 11", "KTX"),
        (0, b"DDS ", "DDS"),
        (0, b"8BPS", "Photoshop (PSD)"),
        (0, b"\x00\x00\x00\x0cjP  ", "JPEG 2000"),
        (0, b"\xff\x4f\xff\x51", "JPEG 2000"),
        (4, b"ftypheic", "HEIC"),
        (4, b"ftypavif", "AVIF"),
        (4, b"ftypavis", "AVIF"),
        (0, b"\xff\x0a", "JPEG XL"),
        (0, b"\x00\x00\x00\x0cJXL ", "JPEG XL"),
        (0, b"%PDF", "PDF"),
    ];
    if let Some((_, _, format)) = known.iter().find(|(offset, signature, _)| at(*offset, signature)) {
        return unsupported(format);
    }
    if at(0, b"version https://git-lfs") {
        return Diagnostic::error("I0002", "image is a Git LFS pointer, not the picture itself")
            .hint("run `git lfs pull` in the repository it came from");
    }
    let head = &bytes[..bytes.len().min(64)];
    let is_text = head.iter().all(|b| matches!(b, 9 | 10 | 13 | 32..=126));
    let found = if is_text {
        let start: String = head.iter().take(24).map(|&b| char::from(b)).collect();
        format!("text that starts with {:?}", start.trim())
    } else {
        let start: Vec<String> = head.iter().take(8).map(|b| format!("{b:02x}")).collect();
        format!("data that starts with the bytes {}", start.join(" "))
    };
    Diagnostic::error(
        "I0002",
        format!("not an image: found {found}, expected one of {READABLE}"),
    )
    .hint("check that the name refers to the picture and that it was downloaded whole")
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageEncoder;

    fn encoded(format: ImageFormat, image: &DynamicImage) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        image.write_to(&mut out, format).expect("in-memory encoding");
        out.into_inner()
    }

    fn gradient() -> DynamicImage {
        image::RgbImage::from_fn(5, 3, |x, y| image::Rgb([x as u8 * 50, y as u8 * 100, 7])).into()
    }

    #[test]
    fn lossless_formats_give_back_every_texel() {
        for (format, name) in [
            (ImageFormat::Png, "a.png"),
            (ImageFormat::Bmp, "a"),
            (ImageFormat::Tga, "a.TGA"),
            (ImageFormat::Pnm, "a.ppm"),
            (ImageFormat::Gif, "a.gif"),
            (ImageFormat::WebP, "a.webp"),
        ] {
            let picture = decode(&encoded(format, &gradient()), name, Limits::default()).expect(name);
            assert_eq!((picture.width, picture.height), (5, 3), "{name}");
            for (x, y) in [(0, 0), (4, 0), (2, 1), (4, 2)] {
                let expected = [x as f32 * 50.0, y as f32 * 100.0, 7.0, 255.0].map(|v| v / 255.0);
                assert_eq!(picture.rgba(x, y), Some(expected), "{name} at {x},{y}");
            }
        }
    }

    #[test]
    fn sixteen_bit_png_keeps_sixteen_bits() {
        let mut out = Vec::new();
        let words: [u16; 4] = [0, 1, 40_000, 65_535];
        let raw: Vec<u8> = words.iter().flat_map(|w| w.to_ne_bytes()).collect();
        let encoder = image::codecs::png::PngEncoder::new(&mut out);
        encoder
            .write_image(&raw, 1, 1, image::ExtendedColorType::Rgba16)
            .expect("encodes");
        let picture = decode(&out, "x.png", Limits::default()).expect("decodes");
        assert_eq!(picture.texels, Texels::Rgba16(vec![words]));
    }

    #[test]
    fn a_picture_above_the_limit_is_refused_before_it_is_decoded() {
        let limits = Limits {
            max_texels: 14,
            ..Limits::default()
        };
        let error = decode(&encoded(ImageFormat::Png, &gradient()), "big.png", limits).expect_err("15 texels");
        assert_eq!(error.code, "I0004");
        assert!(error.message.contains("5x3"), "{}", error.message);
        assert_eq!(error.place.as_deref(), Some("big.png"));
    }

    #[test]
    fn a_git_lfs_pointer_and_plain_text_are_told_apart() {
        let message = |bytes: &[u8]| decode(bytes, "x.png", Limits::default()).expect_err("no image").message;
        assert!(message(b"version https://git-lfs.github.com/spec/v1\n").contains("Git LFS"));
        assert!(message(b"<html>not found</html>").contains("<html>"));
        assert!(message(b"DDS \x7c\0\0\0").contains("DDS"));
        assert!(message(b"").contains("empty"));
    }
}
