//! Running a whole scene: the file, the command line's identifiers, then what it reaches.

use super::scope::Place;
use super::stream::FrameKind;
use super::{Interp, Num, Value};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::Interner;
use crate::scene::Scene;
use std::path::Path;

/// The version whose defaults POV-Ray's files have as long as no `#version` was read.
const OLD_VERSION: f64 = 3.62;
/// What `version` reads as until then. A standard include saves and restores it, which is a `#version` like any
/// other: old scenes that include `colors.inc` are gamma-corrected, those that include nothing are not.
const OLD_VERSION_READS: f64 = 3.7;
/// Version that our own files have without `#version`.
const OWN_VERSION: f64 = 3.8;

impl Interp<'_> {
    /// Reads the scene and converts it. Errors are reported.
    pub fn run(&mut self, path: &Path, bytes: &[u8]) -> Scene {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let is_pov = matches!(extension.as_deref(), Some("pov" | "inc"));
        (self.version, self.scene_version) = if is_pov {
            (OLD_VERSION_READS, OLD_VERSION)
        } else {
            (OWN_VERSION, OWN_VERSION)
        };
        self.includes_set_version = is_pov;
        self.scene_dir = path.parent().map(Path::to_owned).unwrap_or_default();
        self.define_from_options();
        let Some(file) = self.tokens_from(&path.display().to_string(), bytes, self.scene_dir.clone()) else {
            let d = Diagnostic::error("P0503", format!("{} is larger than 4 GiB", path.display()));
            self.report(d.in_place(path.display().to_string()));
            return Scene::default();
        };
        let end = file.tokens.len() as u32;
        if end == 0 {
            let span = Span {
                file: file.file,
                start: 0,
                end: 0,
            };
            let d = Diagnostic::error("P0105", "the scene is empty").at(span, "");
            self.report(d.hint("a scene needs objects, a `camera { … }` and light"));
            return Scene::default();
        }
        if self.push_frame(file, (0, end), FrameKind::Include, None).is_err() {
            return Scene::default();
        }
        self.scene_items();
        self.finish_main_frame();
        if self.is_halted() && self.has_errors() {
            return Scene::default();
        }
        self.emit()
    }

    fn finish_main_frame(&mut self) {
        let open = self.frame().is_some_and(|f| !f.controls.is_empty());
        if open && !self.is_halted() {
            let span = self.here();
            self.error("P0102", span, "a directive is not closed by `#end` in this file");
        }
    }

    fn has_errors(&self) -> bool {
        self.errors > 0
    }

    fn define_from_options(&mut self) {
        for (name, text) in &self.options.defines {
            let symbol = self.names.intern(name);
            let reserved = Interner::word(symbol).is_some_and(|w| !w.is_contextual());
            let valid = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
                && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
            if reserved || !valid {
                let d = Diagnostic::error("P0403", format!("`{name}` cannot be declared")).in_place("command line");
                self.diags.push(d);
                continue;
            }
            let value = match text.parse::<f64>() {
                Ok(v) => Value::Num(Num::float(v)),
                Err(_) => Value::Text(text.as_str().into()),
            };
            self.scopes.set(Place { scope: 0, name: symbol }, value);
        }
    }
}
