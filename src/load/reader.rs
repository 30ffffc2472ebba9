//! Reading a text scene once for each moment that counts.

use super::{LoadOptions, load_model, motion};
use crate::diag::{Diagnostic, Diagnostics, Severity, SourceMap};
use crate::files::Files;
use crate::lang;
use crate::scene::{Mesh, Scene};
use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

/// What it takes to read a text scene at several moments.
pub(super) struct Reader<'a> {
    /// The text.
    pub path: &'a Path,
    /// Where everything is read.
    pub files: &'a dyn Files,
    /// The same, each read once: for the text and what it includes.
    pub texts: &'a Remembered<'a>,
    /// What the caller asks for.
    pub options: &'a LoadOptions,
}

impl Reader<'_> {
    /// What the language is told to read the scene at a moment.
    pub fn options_at<'m>(&self, clock: f64, models: &'m lang::ModelLoader<'m>) -> lang::LoadOptions<'m> {
        lang::LoadOptions {
            include_dirs: self.options.include_dirs.clone(),
            defines: self.options.defines.clone(),
            width: self.options.width,
            height: self.options.height,
            clock,
            opening: Some(self.options.clock.unwrap_or(0.0)),
            frame: self.options.frame,
            clock_read: AtomicBool::new(false),
            models,
        }
    }

    /// Gives the scene, read when the shutter opens, its motion while it is open.
    pub fn follow(&self, scene: &mut Scene, reads_clock: bool, diags: &mut Diagnostics) {
        let shutter = self.options.shutter.or(scene.defaults.shutter).unwrap_or(0.0);
        if shutter == 0.0 {
            return;
        }
        if !reads_clock {
            return; // all moments are the same
        }
        let opening = self.options.clock.unwrap_or(0.0);
        let known = Mutex::new(HashMap::new());
        let mut read = |share: f64| {
            let clock = opening + shutter * share;
            let (mut sources, mut told) = (SourceMap::default(), Diagnostics::default());
            // Those that play are others at each moment; their vertices are looked at where forms are kept.
            let played = Mutex::new(HashMap::new());
            let keeps_forms = motion::has_form(share);
            let models = |request: &lang::ModelRequest, diags: &mut Diagnostics| {
                let plays = request.options.clock.is_some();
                let known = if plays { &played } else { &known };
                let key = (request.path.clone(), request.options.key());
                let mut known = known.lock().unwrap_or_else(|e| e.into_inner());
                let load = || {
                    let model = load_model(request, self.files, self.options, diags)?;
                    Some(if plays && keeps_forms {
                        model
                    } else {
                        without_vertices(model)
                    })
                };
                known.entry(key).or_insert_with(load).clone()
            };
            let options = self.options_at(clock, &models);
            let scene = lang::load(self.path, self.texts, &options, &mut sources, &mut told);
            scene.ok_or_else(|| {
                let message =
                    format!("the scene cannot be read at clock {clock}, while the shutter is open: nothing moves");
                let first = told.iter().find(|d| d.severity == Severity::Error);
                let why = first.map_or(String::new(), |d| d.message.clone());
                let warning = Diagnostic::warning("L0008", message).hint(why);
                match first.and_then(Diagnostic::primary_span) {
                    Some(span) => warning.at(span, ""),
                    None => warning,
                }
            })
        };
        motion::follow(scene, &mut read, diags);
    }
}

/// Files that are read once, however often they are asked for.
pub(super) struct Remembered<'a> {
    inner: &'a dyn Files,
    known: Mutex<HashMap<PathBuf, Arc<[u8]>>>,
}

impl<'a> Remembered<'a> {
    /// Nothing was read yet.
    pub fn new(inner: &'a dyn Files) -> Remembered<'a> {
        Remembered {
            inner,
            known: Mutex::default(),
        }
    }
}

impl Files for Remembered<'_> {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        let mut known = self.known.lock().unwrap_or_else(|e| e.into_inner());
        if let Some(data) = known.get(path) {
            return Ok(data.clone());
        }
        let data = self.inner.read(path)?;
        known.insert(path.to_owned(), data.clone());
        Ok(data)
    }

    fn exists(&self, path: &Path) -> bool {
        self.inner.exists(path)
    }

    fn size(&self, path: &Path) -> Option<u64> {
        self.inner.size(path)
    }

    fn list(&self, dir: &Path) -> Vec<String> {
        self.inner.list(dir)
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.inner.opened()
    }
}

/// A model that stands for itself where only places are compared.
fn without_vertices(mut model: Scene) -> Scene {
    for mesh in std::sync::Arc::make_mut(&mut model.meshes) {
        *mesh = Mesh {
            name: std::mem::take(&mut mesh.name),
            materials: std::mem::take(&mut mesh.materials),
            ..Mesh::default()
        };
    }
    model
}
