//! An image as it is compared, and how files become one.

use crate::diag::Diagnostic;
use crate::math::color::linear_from_srgb;
use crate::pictures::{Limits, Picture, Texels, decode, exr::ExrImage, read_exr_channels};

/// Linear Rec. 709 colour row by row from the top left, `width · height` pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Radiance, multiplied by alpha where there is any: the picture on black.
    pub rgb: Vec<[f32; 3]>,
    /// Standard error of each pixel's mean; NaN where it is not known. `None` if the file says nothing.
    pub stderr: Option<Vec<[f32; 3]>>,
    /// From how many independent estimates each standard error was made, where the file says so.
    pub nets: Option<u32>,
    /// Samples of each pixel, where the file says so.
    pub samples: Option<Vec<u32>>,
    /// Whether it comes from integers, cut at white and rounded: what is lost there is no noise.
    pub is_developed: bool,
}

/// The first bytes of OpenEXR files.
const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

impl Image {
    /// An image without standard errors.
    pub fn from_rgb(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Image {
        Image {
            width,
            height,
            rgb,
            ..Image::default()
        }
    }

    /// Reads an image file of any format that textures may have. Integers are decoded from sRGB, floats are linear.
    /// Of OpenEXR files the channels `R G B` and, where there, `stderr.R stderr.G stderr.B` are taken; without
    /// `R G B`, the colour of the first layer. `name` is the place of errors.
    pub fn decode(bytes: &[u8], name: &str) -> Result<Image, Diagnostic> {
        let limits = Limits::default();
        if bytes.starts_with(&EXR_MAGIC) {
            let file = read_exr_channels(bytes, limits).map_err(|d| d.in_place(name))?;
            if let Some(rgb) = triple(&file, ["R", "G", "B"]) {
                return Ok(Image {
                    width: file.width,
                    height: file.height,
                    rgb,
                    stderr: triple(&file, ["stderr.R", "stderr.G", "stderr.B"]),
                    nets: nets(&file),
                    samples: file.u32_channel("samples").map(<[u32]>::to_vec),
                    is_developed: false,
                });
            }
        }
        decode(bytes, name, limits).map(|picture| from_picture(&picture))
    }

    /// Whether there is exactly one colour (and one standard error, if any) for each pixel.
    pub(super) fn is_complete(&self) -> bool {
        let pixels = self.width as usize * self.height as usize;
        self.rgb.len() == pixels
            && self.stderr.as_ref().is_none_or(|s| s.len() == pixels)
            && self.samples.as_ref().is_none_or(|s| s.len() == pixels)
    }
}

/// Three channels side by side, if the file has all of them.
fn triple(file: &ExrImage, names: [&str; 3]) -> Option<Vec<[f32; 3]>> {
    let [r, g, b] = names.map(|name| file.f32_channel(name));
    let pixels = r?.iter().zip(g?).zip(b?);
    Some(pixels.map(|((r, g), b)| [*r, *g, *b]).collect())
}

/// The number of independent sample nets, from the description that our own files carry.
fn nets(file: &ExrImage) -> Option<u32> {
    let description: serde_json::Value = serde_json::from_str(file.attribute("pts")?).ok()?;
    u32::try_from(description.get("nets")?.as_u64()?).ok()
}

fn from_picture(picture: &Picture) -> Image {
    let is_float = matches!(
        picture.texels,
        Texels::GrayF32(_) | Texels::RgbF32(_) | Texels::RgbaF32(_)
    );
    let color = |[r, g, b, alpha]: [f32; 4]| {
        if is_float {
            return [r, g, b]; // OpenEXR: multiplied by alpha already; HDR: opaque
        }
        [r, g, b].map(|c| (linear_from_srgb(f64::from(c)) * f64::from(alpha)) as f32)
    };
    let texels = 0..picture.texels.len();
    let rgb = texels.filter_map(|i| picture.texels.rgba(i)).map(color).collect();
    Image {
        is_developed: !is_float,
        ..Image::from_rgb(picture.width, picture.height, rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::exr::{ChannelData, NamedChannel};
    use crate::pictures::{Transfer, exr, png, ppm, quantize};

    #[test]
    fn eight_bit_files_are_decoded_from_srgb_and_shown_on_black() {
        let q = quantize([2, 1], &[[0.5; 3], [1.0; 3]], Some(&[1.0, 0.2]), Transfer::Srgb, false);
        let image = Image::decode(&png::encode(&q, &[]).unwrap(), "a.png").unwrap();
        assert_eq!((image.width, image.height, image.is_developed), (2, 1, true));
        // 0.5 has the code 188, which means 0.5029 (IEC 61966-2-1); 0.2 is 51/255 exactly.
        assert!((image.rgb[0][0] - 0.502_886).abs() < 1e-6, "{}", image.rgb[0][0]);
        assert!((image.rgb[1][2] - 0.2).abs() < 1e-6, "{}", image.rgb[1][2]);
        let q = quantize([1, 1], &[[1.0, 0.0, 0.5]], None, Transfer::Srgb, false);
        let image = Image::decode(&ppm::encode(&q, &[]), "a.ppm").unwrap();
        assert_eq!(image.rgb[0][..2], [1.0, 0.0]);
    }

    #[test]
    fn an_exr_file_brings_its_standard_errors_and_nets() {
        let channel = |name: &str, v: f32| NamedChannel {
            name: name.to_owned(),
            data: ChannelData::F32(vec![v, v + 1.0]),
        };
        let names = ["R", "G", "B", "stderr.R", "stderr.G", "stderr.B"];
        let mut channels: Vec<_> = names.iter().zip(0u8..).map(|(n, i)| channel(n, f32::from(i))).collect();
        channels.push(NamedChannel {
            name: "samples".to_owned(),
            data: ChannelData::U32(vec![16, 64]),
        });
        let file = exr::encode([2, 1], channels, Some(("pts", r#"{"nets": 8}"#))).unwrap();
        let image = Image::decode(&file, "a.exr").unwrap();
        assert_eq!(image.rgb, [[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]]);
        assert_eq!(image.stderr, Some(vec![[3.0, 4.0, 5.0], [4.0, 5.0, 6.0]]));
        assert_eq!((image.nets, image.is_developed), (Some(8), false));
        assert_eq!(image.samples, Some(vec![16, 64]));
    }

    #[test]
    fn what_is_no_image_is_told_with_its_name() {
        let error = Image::decode(b"hello", "x.png").unwrap_err();
        assert_eq!(error.place.as_deref(), Some("x.png"));
        assert!(Image::decode(&[0x76, 0x2f, 0x31, 0x01, 9], "x.exr").is_err());
    }
}
