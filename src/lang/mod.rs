//! Text scenes: POV-Ray's scene description language, grown.
//!
//! [`syntax`] makes tokens, `eval` runs them (directives, macros, expressions), `lower` turns words into the IR.
//! [`load`] is the whole of it.

pub mod builtin;
mod desc;
mod eval;
mod lower;
pub mod syntax;
mod transform;

use crate::diag::{Diagnostic, Diagnostics, Severity, SourceMap, Span};
use crate::files::Files;
use crate::scene::Scene;
use eval::Interp;
use std::path::{Path, PathBuf};

/// Which importer a model needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelKind {
    /// `gltf { … }`.
    Gltf,
    /// `obj { … }`.
    Obj,
}

/// A model that a scene places.
#[derive(Clone, Debug)]
pub struct ModelRequest {
    /// Its format.
    pub kind: ModelKind,
    /// The file as found.
    pub path: PathBuf,
    /// `scene "name"`: which scene of the file.
    pub scene: Option<String>,
    /// `variant "name"`: which material variant.
    pub variant: Option<String>,
    /// Where the scene names it.
    pub span: Span,
}

/// Loads a model in its own coordinates; reports why if it cannot.
pub type ModelLoader<'a> = dyn Fn(&ModelRequest, &mut Diagnostics) -> Option<Scene> + Sync + 'a;

/// What the caller of [`load`] asks for.
pub struct LoadOptions<'a> {
    /// Directories where includes, images and models are looked up after the scene's own.
    pub include_dirs: Vec<PathBuf>,
    /// Identifiers declared before the scene: numbers if they read as such, else strings.
    pub defines: Vec<(String, String)>,
    /// Width of the image if the command line gives it.
    pub width: Option<u32>,
    /// Height of the image if the command line gives it.
    pub height: Option<u32>,
    /// The animation clock.
    pub clock: f64,
    /// Loads glTF and OBJ models.
    pub models: &'a ModelLoader<'a>,
}

/// Reads a scene. `None` exactly if there were errors, which are in `diags` with their places.
///
/// Files named `.pov` or `.inc` start with POV-Ray's old defaults (no gamma correction without `#version 3.7` or
/// `assumed_gamma`, black where nothing is painted, a 4:3 camera). All others start as `#version 3.8` does: colours are
/// linear, what is not painted is white, the camera has the image's shape.
pub fn load(
    path: &Path,
    files: &dyn Files,
    options: &LoadOptions,
    sources: &mut SourceMap,
    diags: &mut Diagnostics,
) -> Option<Scene> {
    let before = diags.count(Severity::Error);
    // Nested blocks and macros recurse; a stack of our own makes the depth limit independent of the caller's.
    let scene = std::thread::scope(|scope| {
        let builder = std::thread::Builder::new()
            .name("scene reader".to_owned())
            .stack_size(eval::STACK_BYTES);
        let worker = builder.spawn_scoped(scope, || load_here(path, files, options, sources, diags));
        match worker {
            Ok(handle) => match handle.join() {
                Ok(scene) => scene,
                Err(panic) => std::panic::resume_unwind(panic),
            },
            Err(_) => None,
        }
    });
    if scene.is_none() && diags.count(Severity::Error) == before {
        diags.push(Diagnostic::error(
            "P0607",
            "cannot start reading the scene: no memory for its stack",
        ));
    }
    scene
}

fn load_here(
    path: &Path,
    files: &dyn Files,
    options: &LoadOptions,
    sources: &mut SourceMap,
    diags: &mut Diagnostics,
) -> Option<Scene> {
    let before = diags.count(Severity::Error);
    let bytes = match files.read(path) {
        Ok(bytes) => bytes,
        Err(e) => {
            let d = Diagnostic::error("P0503", format!("cannot read {}: {e}", path.display()));
            diags.push(d.in_place(path.display().to_string()));
            return None;
        }
    };
    let mut interp = Interp::new(files, options, sources, diags);
    let scene = interp.run(path, &bytes);
    (diags.count(Severity::Error) == before).then_some(scene)
}
