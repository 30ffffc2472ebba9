//! stub
use crate::diag::Diagnostics;
use crate::files::Files;
use crate::render::scene::CompiledScene;
use crate::scene::Scene;
/// stub
pub fn compile(_: &Scene, _: &dyn Files, _: u32, _: u32, _: &mut Diagnostics) -> Option<CompiledScene> {
    Some(CompiledScene {})
}
