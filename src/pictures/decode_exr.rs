//! OpenEXR files as textures: the colour of the first layer that has one.
//!
//! Files are decoded on the calling thread: a damaged block that makes the library panic on one of its own
//! threads would end the whole program, here it is caught by [`super::decode`].

use super::decode::{Limits, check_size, damaged};
use super::{Picture, Texels};
use crate::diag::Diagnostic;
use exr::image::read::specific_channels::ReadSpecificChannel;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::Text;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, read};
use std::io::Cursor;

pub(super) const LABEL: &str = "OpenEXR";

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

/// The headers of all parts, each checked against the limits.
pub(super) fn headers(bytes: &[u8], limits: Limits) -> Result<Vec<Header>, Diagnostic> {
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
    if names.len() < header.channels.list.len() && !names.iter().any(|n| n.eq_ignore_ascii_case("R")) {
        // Luminance with subsampled chroma: the luminance alone would be a colour picture turned grey.
        return None;
    }
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
