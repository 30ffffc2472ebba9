//! Names that flags and scenes choose by: cameras, lamps, materials, and what else a glTF file holds.

use super::text::row;
use crate::files::Files;
use crate::import::gltf;
use crate::load::{self, Kind};
use crate::scene::Scene;
use serde_json::{Value, json};
use std::path::Path;

/// Names of a kind that are told as text; the others are counted.
const NAMES_TOLD: usize = 20;

/// What can be chosen by name.
pub(super) struct Names {
    cameras: Vec<String>,
    lights: Vec<String>,
    materials: Vec<String>,
    file: gltf::Contents,
}

impl Names {
    /// Those of a scene as it was read from a file.
    pub fn of(scene: &Scene, path: &Path, files: &dyn Files) -> Names {
        let is_gltf = load::kind_of(path, files, &mut Default::default()) == Some(Kind::Gltf);
        let file = is_gltf.then(|| gltf::contents(path, files)).flatten();
        let named = |names: &mut dyn Iterator<Item = &String>| {
            let mut out: Vec<String> = Vec::new();
            for name in names.filter(|n| !n.is_empty()) {
                if !out.contains(name) {
                    out.push(name.clone());
                }
            }
            out
        };
        Names {
            cameras: named(&mut scene.cameras.iter().map(|c| &c.name)),
            lights: named(&mut scene.lights.iter().map(|l| &l.name)),
            materials: named(&mut scene.materials.iter().map(|m| &m.name)),
            file: file.unwrap_or_default(),
        }
    }

    /// A row for each kind that there is; nothing without any name.
    pub fn rows(&self) -> Vec<String> {
        let animations: Vec<String> = self.file.animations.iter().map(animation).collect();
        let kinds = [
            ("cameras", &self.cameras),
            ("lights", &self.lights),
            ("materials", &self.materials),
            ("scenes", &self.file.scenes),
            ("variants", &self.file.variants),
            ("animations", &animations),
            ("nodes", &self.file.nodes),
        ];
        let there = kinds.into_iter().filter(|(_, names)| !names.is_empty());
        let mut rows: Vec<String> = there.map(|(kind, names)| row(kind, &list(names))).collect();
        if !rows.is_empty() {
            rows.insert(0, "names".to_owned());
        }
        rows
    }

    /// The same for programs, all of them.
    pub fn json(&self) -> Value {
        let animations = self.file.animations.iter();
        let animations: Vec<Value> = animations
            .map(|(name, seconds)| json!({"name": name, "seconds": seconds}))
            .collect();
        json!({
            "cameras": self.cameras,
            "lights": self.lights,
            "materials": self.materials,
            "scenes": self.file.scenes,
            "variants": self.file.variants,
            "animations": animations,
            "nodes": self.file.nodes,
        })
    }
}

fn animation((name, seconds): &(String, f64)) -> String {
    format!("{name} ({} s)", (seconds * 1e3).round() / 1e3)
}

fn list(names: &[String]) -> String {
    let told = names.iter().take(NAMES_TOLD).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(NAMES_TOLD) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}
