//! OpenEXR output: one part, ZIP, named 32-bit channels, byte-identical from run to run.

use super::EncodeError;
use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, LineOrder, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::WritableImage;
use std::io::Cursor;

/// The samples of a channel, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelData {
    /// FLOAT.
    F32(Vec<f32>),
    /// UINT.
    U32(Vec<u32>),
}

/// A channel to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedChannel {
    /// ASCII name, at most 255 characters, such as `stderr.R`.
    pub name: String,
    /// Its samples.
    pub data: ChannelData,
}

impl ChannelData {
    fn len(&self) -> usize {
        match self {
            ChannelData::F32(v) => v.len(),
            ChannelData::U32(v) => v.len(),
        }
    }
}

/// Encodes channels as one part with ZIP compression in blocks of 16 rows. Values are written as they are, NaN
/// and infinities included. `attribute`, where given, is a name and a text (ASCII; other characters become `?`).
///
/// There is room for one attribute only: the library keeps them in a hash map, and with two their order, hence the
/// bytes of the file, would change from run to run.
pub fn encode(
    size: [u32; 2],
    channels: Vec<NamedChannel>,
    attribute: Option<(&str, &str)>,
) -> Result<Vec<u8>, EncodeError> {
    let [width, height] = size;
    let error = |reason: String| EncodeError {
        format: "OpenEXR",
        width,
        height,
        reason,
    };
    let texels = u64::from(width) * u64::from(height);
    let mut list: Vec<AnyChannel<FlatSamples>> = Vec::new();
    for channel in channels {
        let (name, found) = (&channel.name, channel.data.len() as u64);
        if found != texels {
            return Err(error(format!("channel {name} has {found} samples, expected {texels}")));
        }
        if !is_name(name) || list.iter().any(|c| c.name.eq(name)) {
            return Err(error(format!(
                "channel name {name:?} is empty, too long, not ASCII or used twice"
            )));
        }
        let text = Text::new_or_none(name).ok_or_else(|| error(format!("channel name {name:?} is not valid")))?;
        let samples = match channel.data {
            ChannelData::F32(v) => FlatSamples::F32(v),
            ChannelData::U32(v) => FlatSamples::U32(v),
        };
        list.push(AnyChannel::new(text, samples));
    }
    list.sort_by(|a, b| a.name.bytes().cmp(b.name.bytes()));
    let mut attributes = LayerAttributes::default();
    if let Some((name, text)) = attribute {
        let ascii: String = text
            .chars()
            .map(|c| if c.is_ascii() && c != '\0' { c } else { '?' })
            .collect();
        let name = Text::new_or_none(name).filter(|_| is_name(name));
        let (Some(name), Some(ascii)) = (name, Text::new_or_none(ascii)) else {
            return Err(error("the attribute's name or text is not valid".to_owned()));
        };
        attributes.other.insert(name, AttributeValue::Text(ascii));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(list.into());
    let layer = Layer::new((width as usize, height as usize), attributes, encoding, channels);
    let mut out = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut out)
        .map_err(|e| error(e.to_string()))?;
    Ok(out.into_inner())
}

fn is_name(name: &str) -> bool {
    (1..=255).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic() || b == b' ')
}

#[cfg(test)]
mod tests {
    use super::super::{Limits, Texels, decode, read_exr_channels};
    use super::*;

    fn f32_channel(name: &str, values: &[f32]) -> NamedChannel {
        NamedChannel {
            name: name.to_owned(),
            data: ChannelData::F32(values.to_vec()),
        }
    }

    fn sample_file() -> Vec<u8> {
        let channels = vec![
            f32_channel("R", &[1.0, f32::INFINITY, 3.5e-41, -0.0]),
            f32_channel("G", &[5.0, f32::NAN, 7.0, 8.0]),
            f32_channel("B", &[9.0, 1e30, -11.0, 12.0]),
            f32_channel("A", &[1.0, 1.0, 0.5, 0.0]),
            f32_channel("stderr.R", &[0.1, 0.2, 0.3, 0.4]),
            NamedChannel {
                name: "samples".to_owned(),
                data: ChannelData::U32(vec![0, 1, 16_777_217, u32::MAX]),
            },
        ];
        encode([2, 2], channels, Some(("pts", r#"{"seed":1,"name":"a\u00fc"}"#))).expect("encodes")
    }

    /// Bits, not values: NaN is to come back too.
    fn bits(values: &[f32]) -> Vec<u32> {
        values.iter().map(|v| v.to_bits()).collect()
    }

    #[test]
    fn every_bit_of_every_channel_and_the_attribute_come_back() {
        let image = read_exr_channels(&sample_file(), Limits::default()).expect("reads");
        assert_eq!((image.width, image.height), (2, 2));
        let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "samples", "stderr.R"]);
        let r = image.f32_channel("R").expect("FLOAT");
        assert_eq!(bits(r), bits(&[1.0, f32::INFINITY, 3.5e-41, -0.0]));
        assert!(image.f32_channel("G").expect("FLOAT")[1].is_nan());
        assert_eq!(
            image.u32_channel("samples"),
            Some([0, 1, 16_777_217, u32::MAX].as_slice())
        );
        assert_eq!(image.attribute("pts"), Some(r#"{"seed":1,"name":"a\u00fc"}"#));
    }

    #[test]
    fn as_a_texture_it_is_its_rgba() {
        let picture = decode(&sample_file(), "a.exr", Limits::default()).expect("decodes");
        let Texels::RgbaF32(texels) = picture.texels else {
            panic!("not RGBA")
        };
        assert_eq!(texels[2], [3.5e-41, 7.0, -11.0, 0.5]);
    }

    #[test]
    fn the_same_channels_give_the_same_bytes() {
        let first = sample_file();
        for _ in 0..8 {
            assert_eq!(first, sample_file());
        }
    }

    #[test]
    fn wrong_channels_are_errors() {
        let reason = |channels| encode([2, 1], channels, None).expect_err("wrong").reason;
        assert!(reason(vec![f32_channel("R", &[1.0])]).contains("1 samples, expected 2"));
        assert!(reason(vec![f32_channel("", &[1.0, 2.0])]).contains("name"));
        assert!(reason(vec![f32_channel("R", &[0.0; 2]), f32_channel("R", &[0.0; 2])]).contains("twice"));
    }

    #[test]
    fn colour_without_alpha_luminance_and_named_layers_are_found() {
        let texels = |list: &[&str]| {
            let channels = list
                .iter()
                .enumerate()
                .map(|(i, n)| f32_channel(n, &[i as f32]))
                .collect();
            let file = encode([1, 1], channels, None).expect("encodes");
            decode(&file, "a.exr", Limits::default()).expect("decodes").texels
        };
        assert_eq!(texels(&["r", "g", "b"]), Texels::RgbF32(vec![[0.0, 1.0, 2.0]]));
        assert_eq!(texels(&["Y"]), Texels::GrayF32(vec![0.0]));
        let blender = [
            "V.Albedo.R",
            "V.Albedo.G",
            "V.Albedo.B",
            "V.Combined.R",
            "V.Combined.G",
            "V.Combined.B",
        ];
        assert_eq!(texels(&blender), Texels::RgbF32(vec![[3.0, 4.0, 5.0]]));
        let file = encode(
            [1, 1],
            vec![f32_channel("N.X", &[1.0]), f32_channel("N.Y", &[1.0])],
            None,
        )
        .expect("encodes");
        assert_eq!(
            decode(&file, "n.exr", Limits::default()).expect_err("no colour").code,
            "I0006"
        );
    }

    /// Files of other programs: half floats, every lossless compression, tiles, several parts.
    #[test]
    fn other_layouts_give_the_same_numbers() {
        use exr::prelude::f16;
        let (width, height) = (37_usize, 21_usize);
        let value = |i: usize, c: usize| f16::from_f32((i * 3 + c) as f32 * 0.01 - 1.0);
        let tiles = Blocks::Tiles(exr::math::Vec2(16, 8));
        let layouts = [
            (Compression::Uncompressed, Blocks::ScanLines),
            (Compression::RLE, Blocks::ScanLines),
            (Compression::ZIP1, Blocks::ScanLines),
            (Compression::PIZ, Blocks::ScanLines),
            (Compression::PIZ, tiles),
            (Compression::ZIP16, tiles),
        ];
        for (compression, blocks) in layouts {
            let layer = |name: &str, scale: f32| {
                let channels = ["R", "G", "B"].into_iter().enumerate().map(|(c, letter)| {
                    let samples = (0..width * height)
                        .map(|i| f16::from_f32(value(i, c).to_f32() * scale))
                        .collect();
                    AnyChannel::new(letter, FlatSamples::F16(samples))
                });
                let encoding = Encoding {
                    compression,
                    blocks,
                    line_order: LineOrder::Unspecified,
                };
                let encoding = match blocks {
                    Blocks::ScanLines => Encoding {
                        line_order: LineOrder::Increasing,
                        ..encoding
                    },
                    Blocks::Tiles(_) => encoding,
                };
                let channels = AnyChannels::sort(channels.collect());
                Layer::new((width, height), LayerAttributes::named(name), encoding, channels)
            };
            let window = exr::meta::attribute::IntegerBounds::from_dimensions((width, height));
            let attributes = exr::meta::header::ImageAttributes::new(window);
            let layers: Vec<_> = vec![layer("main", 1.0), layer("extra", 2.0)];
            let mut file = Cursor::new(Vec::new());
            Image::from_layers(attributes, layers)
                .write()
                .to_buffered(&mut file)
                .expect("encodes");
            let bytes = file.into_inner();
            let picture = decode(&bytes, "a.exr", Limits::default()).expect("decodes");
            let Texels::RgbF32(texels) = picture.texels else {
                panic!("not RGB")
            };
            for (i, texel) in texels.iter().enumerate() {
                assert_eq!(
                    *texel,
                    [0, 1, 2].map(|c| value(i, c).to_f32()),
                    "{compression:?} {blocks:?} pixel {i}"
                );
            }
            let image = read_exr_channels(&bytes, Limits::default()).expect("reads");
            let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["main.B", "main.G", "main.R", "extra.B", "extra.G", "extra.R"]);
            assert_eq!(
                image.f32_channel("extra.G").expect("there")[5],
                value(5, 1).to_f32() * 2.0
            );
        }
    }
}
