//! stub
use crate::diag::{Diagnostic, Diagnostics};
use crate::files::Files;
use crate::scene::{Handedness, Scene};
use std::path::Path;
fn stub(path: &Path, files: &dyn Files, diags: &mut Diagnostics) -> Option<Scene> {
    if let Err(e) = files.read(path) {
        diags.push(Diagnostic::error(
            "G0001",
            format!("cannot read `{}`: {e}", path.display()),
        ));
        return None;
    }
    Some(Scene {
        handedness: Handedness::Right,
        is_bare_model: true,
        ..Scene::default()
    })
}
/// stub
pub mod gltf {
    use super::*;
    /// stub
    #[derive(Default)]
    pub struct GltfOptions {
        /// stub
        pub scene: Option<String>,
        /// stub
        pub variant: Option<String>,
        /// stub
        pub allow_outside: bool,
    }
    /// stub
    pub fn load(path: &Path, files: &dyn Files, _: &GltfOptions, diags: &mut Diagnostics) -> Option<Scene> {
        stub(path, files, diags)
    }
}
/// stub
pub mod obj {
    use super::*;
    /// stub
    #[derive(Default)]
    pub struct ObjOptions {}
    /// stub
    pub fn load(path: &Path, files: &dyn Files, _: &ObjOptions, diags: &mut Diagnostics) -> Option<Scene> {
        stub(path, files, diags)
    }
}
/// stub
pub mod framing {
    use super::*;
    /// stub
    pub fn frame(scene: &mut Scene, _aspect: f64) -> Option<Diagnostic> {
        if scene.cameras.is_empty() {
            scene.cameras.push(Default::default());
            scene.active_camera = Some(0);
            return Some(Diagnostic::note("F0001", "the model brings no camera; it is framed"));
        }
        None
    }
}
