//! Every channel of an OpenEXR file by name, for comparing renders.

use super::decode::{Limits, damaged};
use super::decode_exr::{LABEL, headers};
use crate::diag::{Diagnostic, guarded};
use exr::image::FlatSamples;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{ReadChannels, ReadLayers, read};
use std::io::Cursor;

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

/// Reads every flat channel of the file. All parts of the first one's size are taken; resolution levels other
/// than the largest are not. Errors carry no place; the caller knows the file's name.
pub fn read_channels(bytes: &[u8], limits: Limits) -> Result<ExrImage, Diagnostic> {
    guarded(|| read_channels_unguarded(bytes, limits))
        .unwrap_or_else(|| Err(damaged(LABEL, "the decoder stopped on inconsistent data")))
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
