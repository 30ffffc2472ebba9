//! OpenEXR files: the colour of the first layer for textures, every channel by name for comparisons.
//!
//! Files are decoded on the calling thread: a damaged block that makes the library panic on one of its own
//! threads would end the whole program, here it is caught by [`super::decode`].

use super::decode::{Limits, check_size, damaged};
use super::{Picture, Texels};
use crate::diag::Diagnostic;
use exr::image::FlatSamples;
use exr::image::read::specific_channels::ReadSpecificChannel;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, read};
use std::io::Cursor;

const LABEL: &str = "OpenEXR";

/// The samples of one channel, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum ExrSamples {
    /// HALF and FLOAT channels.
    F32(Vec<f32>),
    /// UINT channels.
    U32(Vec<u32>),
}

/// One channel of an OpenEXR file.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrChannel {
    /// Its full name. In files of several parts the part's name and a dot come first unless it has them already.
    pub name: String,
    /// `width · height` samples.
    pub samples: ExrSamples,
}

/// All channels of an OpenEXR file that have the size of its first part.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The channels, sorted by name within each part.
    pub channels: Vec<ExrChannel>,
    /// Text attributes of the file by name, sorted.
    pub attributes: Vec<(String, String)>,
}

impl ExrImage {
    /// The float samples of a channel, if there is one of this name.
    pub fn f32_channel(&self, name: &str) -> Option<&[f32]> {
        match &self.channels.iter().find(|c| c.name == name)?.samples {
            ExrSamples::F32(v) => Some(v),
            ExrSamples::U32(_) => None,
        }
    }

    /// The integer samples of a channel, if there is one of this name.
    pub fn u32_channel(&self, name: &str) -> Option<&[u32]> {
        match &self.channels.iter().find(|c| c.name == name)?.samples {
            ExrSamples::U32(v) => Some(v),
            ExrSamples::F32(_) => None,
        }
    }

    /// The text of an attribute, if there is one of this name.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }
}

/// Which channels of a layer are its colour.
#[derive(Debug, PartialEq)]
enum Colour {
    Rgb([String; 3], Option<String>),
    Gray(String),
}

/// The colour of the first flat layer that has one.
pub(super) fn decode(bytes: &[u8], limits: Limits) -> Result<Picture, Diagnostic> {
    let headers = headers(bytes, limits)?;
    let colour = headers
        .iter()
        .find_map(colour_channels)
        .ok_or_else(|| no_colour(&headers))?;
    let invalid = |e: exr::error::Error| damaged(LABEL, &e.to_string());
    let flat = || read().no_deep_data().largest_resolution_level().specific_channels();
    match colour {
        Colour::Gray(name) => {
            let image = flat()
                .required::<f32>(Text::from(name.as_str()))
                .collect_pixels(
                    |size, _| Grid::new(size, 0.0),
                    |grid: &mut Grid<f32>, at, (v,): (f32,)| grid.set(at, v),
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(bytes))
                .map_err(invalid)?;
            image.layer_data.channel_data.pixels.picture(Texels::GrayF32)
        }
        Colour::Rgb([r, g, b], Some(a)) => {
            let image = flat()
                .required::<f32>(Text::from(r.as_str()))
                .required::<f32>(Text::from(g.as_str()))
                .required::<f32>(Text::from(b.as_str()))
                .required::<f32>(Text::from(a.as_str()))
                .collect_pixels(
                    |size, _| Grid::new(size, [0.0; 4]),
                    |grid: &mut Grid<[f32; 4]>, at, (r, g, b, a): (f32, f32, f32, f32)| grid.set(at, [r, g, b, a]),
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(bytes))
                .map_err(invalid)?;
            image.layer_data.channel_data.pixels.picture(Texels::RgbaF32)
        }
        Colour::Rgb([r, g, b], None) => {
            let image = flat()
                .required::<f32>(Text::from(r.as_str()))
                .required::<f32>(Text::from(g.as_str()))
                .required::<f32>(Text::from(b.as_str()))
                .collect_pixels(
                    |size, _| Grid::new(size, [0.0; 3]),
                    |grid: &mut Grid<[f32; 3]>, at, (r, g, b): (f32, f32, f32)| grid.set(at, [r, g, b]),
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(bytes))
                .map_err(invalid)?;
            image.layer_data.channel_data.pixels.picture(Texels::RgbF32)
        }
    }
}

/// Texels while they are filled in.
struct Grid<T> {
    width: usize,
    height: usize,
    texels: Vec<T>,
}

impl<T: Copy> Grid<T> {
    fn new(size: Vec2<usize>, value: T) -> Grid<T> {
        // The size was checked against the limits before reading began.
        Grid {
            width: size.width(),
            height: size.height(),
            texels: vec![value; size.width().saturating_mul(size.height())],
        }
    }

    fn set(&mut self, at: Vec2<usize>, value: T) {
        if let Some(texel) = self.texels.get_mut(at.y() * self.width + at.x()) {
            *texel = value;
        }
    }

    fn picture(self, texels: fn(Vec<T>) -> Texels) -> Result<Picture, Diagnostic> {
        Ok(Picture {
            width: self.width as u32,
            height: self.height as u32,
            texels: texels(self.texels),
        })
    }
}

/// Reads every flat channel of the file. All parts of the first one's size are taken; resolution levels other
/// than the largest are not. Errors carry no place; the caller knows the file's name.
pub fn read_channels(bytes: &[u8], limits: Limits) -> Result<ExrImage, Diagnostic> {
    let attempt = std::panic::catch_unwind(|| read_channels_unguarded(bytes, limits));
    attempt.unwrap_or_else(|_| Err(damaged(LABEL, "the decoder stopped on inconsistent data")))
}

fn read_channels_unguarded(bytes: &[u8], limits: Limits) -> Result<ExrImage, Diagnostic> {
    headers(bytes, limits)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| damaged(LABEL, &e.to_string()))?;
    let mut size = None;
    let mut channels = Vec::new();
    let mut attributes: Vec<(String, String)> = text_attributes(image.attributes.other.iter());
    for layer in image.layer_data {
        let first = *size.get_or_insert(layer.size);
        if layer.size != first {
            continue;
        }
        attributes.extend(text_attributes(layer.attributes.other.iter()));
        let software = layer
            .attributes
            .software_name
            .iter()
            .map(|t| ("software".to_owned(), t.to_string()));
        let comments = layer
            .attributes
            .comments
            .iter()
            .map(|t| ("comments".to_owned(), t.to_string()));
        attributes.extend(software.chain(comments));
        let part = layer.attributes.layer_name.map(|n| n.to_string()).unwrap_or_default();
        for channel in layer.channel_data.list {
            let own = channel.name.to_string();
            let name = if part.is_empty() || own.starts_with(&part) {
                own
            } else {
                format!("{part}.{own}")
            };
            let samples = match channel.sample_data {
                FlatSamples::F16(v) => ExrSamples::F32(v.into_iter().map(|h| h.to_f32()).collect()),
                FlatSamples::F32(v) => ExrSamples::F32(v),
                FlatSamples::U32(v) => ExrSamples::U32(v),
            };
            channels.push(ExrChannel { name, samples });
        }
    }
    attributes.sort();
    attributes.dedup();
    let size = size.ok_or_else(|| damaged(LABEL, "the file has no layer"))?;
    Ok(ExrImage {
        width: size.width() as u32,
        height: size.height() as u32,
        channels,
        attributes,
    })
}

fn text_attributes<'a>(all: impl Iterator<Item = (&'a Text, &'a AttributeValue)>) -> Vec<(String, String)> {
    let text = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(t) => Some((name.to_string(), latin1_or_utf8(t.bytes()))),
        _ => None,
    };
    all.filter_map(text).collect()
}

/// The bytes of an attribute as text: UTF-8 where they are, Latin-1 otherwise.
fn latin1_or_utf8(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}

/// The headers of all parts, each checked against the limits.
fn headers(bytes: &[u8], limits: Limits) -> Result<Vec<Header>, Diagnostic> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| damaged(LABEL, &e.to_string()))?;
    let mut total = 0_u64;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        check_size(LABEL, width, height, limits)?;
        let bytes_per_texel = header.channels.bytes_per_pixel as u64;
        total = total.saturating_add((width * height).saturating_mul(bytes_per_texel));
    }
    if total > limits.max_bytes {
        let found = total >> 20;
        return Err(damaged(
            LABEL,
            &format!("its channels take {found} MiB, at most {} MiB", limits.max_bytes >> 20),
        ));
    }
    Ok(meta.headers.into_vec())
}

/// The colour of one layer: `R G B [A]`, else the first `….R ….G ….B` (Blender's `ViewLayer.Combined` first),
/// else luminance, else the only channel there is. Letter case does not matter.
fn colour_channels(header: &Header) -> Option<Colour> {
    if header.deep {
        return None;
    }
    let full_size = header.channels.list.iter().filter(|c| c.sampling == Vec2(1, 1));
    let names: Vec<String> = full_size.map(|c| c.name.to_string()).collect();
    choose_colour(&names)
}

fn choose_colour(names: &[String]) -> Option<Colour> {
    let find = |prefix: &str, letters: [&str; 2]| {
        let wanted = letters.map(|l| format!("{prefix}{l}"));
        names
            .iter()
            .find(|n| wanted.iter().any(|w| n.eq_ignore_ascii_case(w)))
            .cloned()
    };
    let mut prefixes: Vec<&str> = names
        .iter()
        .map(|n| n.rfind('.').map_or("", |dot| n.get(..=dot).unwrap_or("")))
        .collect();
    // Stable: of equal rank the first in the file wins.
    prefixes.sort_by_key(|p| (!p.is_empty(), !p.to_ascii_lowercase().ends_with("combined.")));
    prefixes.dedup();
    for prefix in &prefixes {
        if let (Some(r), Some(g), Some(b)) = (
            find(prefix, ["R", "red"]),
            find(prefix, ["G", "green"]),
            find(prefix, ["B", "blue"]),
        ) {
            return Some(Colour::Rgb([r, g, b], find(prefix, ["A", "alpha"])));
        }
    }
    // The Y of `N.X N.Y N.Z` is a coordinate, not a luminance.
    let is_vector = |p: &&&str| find(p, ["X", "X"]).is_some();
    let luminance = prefixes
        .iter()
        .filter(|p| !is_vector(p))
        .find_map(|p| find(p, ["Y", "L"]));
    let only = if names.len() == 1 { names.first().cloned() } else { None };
    luminance.or(only).map(Colour::Gray)
}

fn no_colour(headers: &[Header]) -> Diagnostic {
    if headers.iter().all(|h| h.deep) {
        return Diagnostic::error(
            "I0006",
            "OpenEXR file holds only deep data, expected flat colour channels",
        )
        .hint("flatten it in a compositor and save it again");
    }
    let names = headers
        .iter()
        .flat_map(|h| h.channels.list.iter())
        .take(12)
        .map(|c| c.name.to_string());
    let names: Vec<String> = names.collect();
    Diagnostic::error(
        "I0006",
        format!(
            "OpenEXR file has no colour: found the channels {}, expected R, G and B (or Y)",
            names.join(", ")
        ),
    )
    .hint("rename the channels, or export the colour pass")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(|s| (*s).to_owned()).collect()
    }

    #[test]
    fn plain_rgb_wins_over_named_layers_and_combined_over_other_passes() {
        let rgb = |p: &str, a: bool| {
            let name = |l: &str| format!("{p}{l}");
            Some(Colour::Rgb([name("R"), name("G"), name("B")], a.then(|| name("A"))))
        };
        assert_eq!(
            choose_colour(&names(&["A", "B", "G", "R", "x.B", "x.G", "x.R"])),
            rgb("", true)
        );
        let passes = [
            "V.Albedo.B",
            "V.Albedo.G",
            "V.Albedo.R",
            "V.Combined.B",
            "V.Combined.G",
            "V.Combined.R",
        ];
        assert_eq!(choose_colour(&names(&passes)), rgb("V.Combined.", false));
        assert_eq!(choose_colour(&names(&["Y", "Z"])), Some(Colour::Gray("Y".to_owned())));
        assert_eq!(
            choose_colour(&names(&["density"])),
            Some(Colour::Gray("density".to_owned()))
        );
        assert_eq!(choose_colour(&names(&["N.X", "N.Y", "N.Z"])), None);
    }
}
