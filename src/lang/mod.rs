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
use std::sync::atomic::AtomicBool;

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
    /// What of it.
    pub options: ModelOptions,
    /// Where the scene names it.
    pub span: Span,
}

/// What a scene wants of a model's file. The same file with equal wishes is the same model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelOptions {
    /// `scene "name"`: which scene of the file.
    pub scene: Option<String>,
    /// `variant "name"`: which material variant.
    pub variant: Option<String>,
    /// `node "name"`: only this node and what hangs on it.
    pub node: Option<String>,
    /// `node "name" local`: the node's own space is the model's.
    pub node_is_origin: bool,
    /// `animation "name"`: the only one that is played.
    pub animation: Option<String>,
    /// `clock T`: seconds at which its animations are shown; at rest without.
    pub clock: Option<f64>,
}

impl ModelOptions {
    /// Different wishes have different texts.
    pub fn key(&self) -> String {
        format!("{self:?}")
    }
}

/// Loads a model in its own coordinates; reports why if it cannot.
pub type ModelLoader<'a> = dyn Fn(&ModelRequest, &mut Diagnostics) -> Option<Scene> + Sync + 'a;

/// Where in an animation a scene is read, as it may ask: `frame_number`, `initial_clock`, ….
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Its number.
    pub number: u32,
    /// The clock when its shutter opens.
    pub clock: f64,
    /// Numbers of the first and last frame.
    pub frames: [u32; 2],
    /// The clocks of these.
    pub clocks: [f64; 2],
    /// From the clock of one frame to that of the next.
    pub delta: f64,
}

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
    /// The clock at which the shutter opens; `None` is `clock` itself.
    pub opening: Option<f64>,
    /// Where in an animation the scene is read, if it is in one.
    pub frame: Option<Frame>,
    /// Set when the scene reads `clock`: without that no moment differs from another.
    pub clock_read: AtomicBool,
    /// Loads glTF and OBJ models.
    pub models: &'a ModelLoader<'a>,
}

impl<'a> LoadOptions<'a> {
    /// Nothing but a loader of models.
    pub fn new(models: &'a ModelLoader<'a>) -> LoadOptions<'a> {
        LoadOptions {
            include_dirs: Vec::new(),
            defines: Vec::new(),
            width: None,
            height: None,
            clock: 0.0,
            opening: None,
            frame: None,
            clock_read: AtomicBool::new(false),
            models,
        }
    }
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
    let bytes = match files.read(path) {
        Ok(bytes) => bytes,
        Err(e) => {
            let d = Diagnostic::error("P0503", format!("cannot read {}: {e}", path.display()));
            diags.push(d.in_place(path.display().to_string()));
            return None;
        }
    };
    load_bytes(path, &bytes, files, options, sources, diags)
}

/// Reads a scene whose text is at hand (from standard input, say). `path` names it in messages, gives the directory of
/// its includes, and its extension the defaults, as for [`load`].
pub fn load_bytes(
    path: &Path,
    bytes: &[u8],
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
        let worker = builder.spawn_scoped(scope, || {
            let scene = Interp::new(files, options, sources, diags).run(path, bytes);
            (diags.count(Severity::Error) == before).then_some(scene)
        });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;

    fn read(path: &str, text: &str) -> (Option<Scene>, Diagnostics) {
        let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
        let none = |_: &ModelRequest, _: &mut Diagnostics| None;
        let options = LoadOptions::new(&none);
        let files = MemoryFiles::default();
        let scene = load_bytes(
            Path::new(path),
            text.as_bytes(),
            &files,
            &options,
            &mut sources,
            &mut diags,
        );
        (scene, diags)
    }

    #[test]
    fn the_extension_decides_what_an_old_scene_means() {
        let text = "sphere { 0, 1 pigment { rgb .5 } }";
        let linear = |path| read(path, text).0.map(|s| s.display_is_linear);
        assert_eq!(
            [linear("a.pov"), linear("a.pts"), linear("-")],
            [Some(true), Some(false), Some(false)]
        );
    }

    #[test]
    fn what_is_only_declared_is_not_in_the_scene() {
        let (scene, _) = read("a.pts", "#declare A = union { sphere { 0, 1 pigment { rgb 1 } } };");
        let scene = scene.unwrap_or_default();
        assert!(scene.objects.is_empty() && scene.groups.is_empty() && scene.materials.is_empty());
    }

    /// Two placed copies share one group however large it is.
    #[test]
    fn a_declared_object_costs_its_size_once() {
        let text = "#declare U = union { #for (I, 1, 1000) sphere { x * I, 1 } #end }\n\
                    #for (I, 1, 1000) object { U translate y * I } #end";
        let scene = read("a.pts", text).0.unwrap_or_default();
        assert_eq!((scene.objects.len(), scene.groups.len()), (1000, 1));
        assert_eq!(scene.groups.iter().map(|g| g.objects.len()).sum::<usize>(), 1000);
    }

    #[test]
    fn equal_materials_are_one() {
        let text = "#for (I, 1, 50) sphere { x * I, 1 pigment { rgb .5 } } #end";
        let scene = read("a.pts", text).0.unwrap_or_default();
        assert_eq!((scene.objects.len(), scene.materials.len()), (50, 1));
    }

    #[test]
    fn a_missing_file_is_an_error_with_its_name() {
        let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
        let none = |_: &ModelRequest, _: &mut Diagnostics| None;
        let path = Path::new("none.pts");
        let files = MemoryFiles::default();
        let scene = load(path, &files, &LoadOptions::new(&none), &mut sources, &mut diags);
        assert!(scene.is_none() && diags.iter().any(|d| d.place.as_deref() == Some("none.pts")));
    }
}
