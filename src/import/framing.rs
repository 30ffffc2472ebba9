//! What a bare model lacks: a camera that shows all of it, and light.

use crate::scene::Scene;

/// Whether any surface in use emits.
pub fn emits(scene: &Scene) -> bool {
    scene.materials.iter().any(|m| m.emission.factor != glam::DVec3::ZERO)
}
