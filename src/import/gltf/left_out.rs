//! What the file holds and the chosen scene does not refer to. It was not read; it is only told.

use super::Loader;
use super::uri::inner_path;
use crate::scene::LeftOut;
use percent_encoding::percent_decode_str;
use serde_json::Value;
use std::collections::HashSet;
use std::path::PathBuf;

/// Most elements of a table that are told; nobody reads more.
const MOST_TOLD: usize = 10_000;

impl Loader<'_> {
    /// Lists scenes, meshes, materials, images and buffers that nothing has asked for.
    pub(super) fn tell_left_out(&mut self) {
        let materials: HashSet<usize> = self.materials.keys().map(|(index, _)| *index).collect();
        let fallback = |(first, second): &(usize, Option<usize>)| [Some(*first), *second];
        let images: HashSet<usize> = self.images.keys().flat_map(fallback).flatten().collect();
        let used = |table: &str, index: usize| match table {
            "scenes" => self.chosen_scene.is_none_or(|chosen| chosen == index),
            "meshes" => self.met_meshes.contains(&index),
            "materials" => materials.contains(&index),
            "images" => images.contains(&index),
            _ => self.buffers.contains_key(&index),
        };
        let mut found = Vec::new();
        for (table, kind, why) in [
            ("scenes", "scene", "another scene is shown"),
            ("meshes", "mesh", "nothing shown places it"),
            ("materials", "material", "nothing shown has it"),
            ("images", "image", "nothing shown refers to it"),
            ("buffers", "buffer", "nothing shown refers to it"),
        ] {
            let elements = self
                .doc
                .top(table)
                .and_then(Value::as_array)
                .map_or(&[][..], Vec::as_slice);
            let unused = elements.iter().enumerate().filter(|(i, _)| !used(table, *i));
            for (index, element) in unused.take(MOST_TOLD) {
                // The chunk of a GLB is part of a file that had to be read.
                if table == "buffers" && element.get("uri").is_none() {
                    continue;
                }
                let file = self.own_file(element);
                let name = match &file {
                    Some(path) => path.display().to_string(),
                    None => self.doc.name(table, index),
                };
                found.push(LeftOut {
                    kind,
                    name,
                    why: why.to_owned(),
                    bytes: self.bytes_of(element),
                    file,
                    place: self.report.origin(&format!("{table}[{index}]")),
                });
            }
        }
        self.scene.left_out = found;
    }

    /// The file of an element that has one to itself, whether it exists or not; nothing is looked up.
    fn own_file(&self, element: &Value) -> Option<PathBuf> {
        let uri = element.get("uri")?.as_str()?;
        let is_embedded = uri.get(..5).is_some_and(|p| p.eq_ignore_ascii_case("data:"));
        let decoded = percent_decode_str(uri).decode_utf8().ok()?;
        let inner = inner_path(decoded.replace('\\', "/").as_ref())?;
        (!is_embedded && !uri.contains("://")).then(|| self.folder.join(inner))
    }

    /// Bytes inside the file itself: of a data URI (four characters hold three), or of a view.
    fn bytes_of(&self, element: &Value) -> u64 {
        if let Some(uri) = element.get("uri").and_then(Value::as_str) {
            return uri.split_once(',').map_or(0, |(_, data)| data.len() as u64 / 4 * 3);
        }
        let length = || {
            let view = element.get("bufferView")?.as_u64()?;
            let views = self.doc.top("bufferViews")?.as_array()?;
            views.get(usize::try_from(view).ok()?)?.get("byteLength")?.as_u64()
        };
        length().unwrap_or(0)
    }
}
