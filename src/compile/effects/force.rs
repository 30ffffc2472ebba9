//! Making a scene carry effects along that it does not call for: to measure what that costs, and to prove that it changes
//! nothing.

use super::Effect;
use crate::render::scene::CompiledScene;
use crate::render::technique::{LightPick, Technique};

impl Effect {
    /// Makes paths watch for the effect whether or not the scene has it. For an effect of the scene the picture stays the
    /// same, bit for bit.
    ///
    /// Mirrors, highlights, sheets that shine through, a lens and an environment are asked for by value, once a material,
    /// once a path or once a ray that leaves the scene, in every render: there is nothing to add for them.
    pub fn force(self, compiled: &mut CompiledScene) {
        let traits = &mut compiled.traits;
        match self {
            Effect::Textures | Effect::Bump => {
                compiled.materials.iter_mut().for_each(|m| m.needs_attributes = true);
            }
            Effect::Alpha => traits.see_through = true,
            Effect::Media => traits.media = true,
            Effect::Dispersion => traits.dispersion = true,
            Effect::Motion => traits.moves = true,
            Effect::Lens
            | Effect::Environment
            | Effect::Specular
            | Effect::Glass
            | Effect::Glossy
            | Effect::Translucent
            | Effect::Indirect
            | Effect::Caustics
            | Effect::LightTree => {}
        }
    }

    /// Turns a strategy on, whatever the technique says of it; the picture then agrees in expectation. Nothing for
    /// effects of the scene.
    pub fn force_technique(self, technique: &mut Technique) {
        match self {
            Effect::Indirect => technique.max_depth = u32::MAX,
            Effect::Caustics => technique.caustics = true,
            Effect::LightTree => technique.lights = LightPick::Tree,
            _ => {}
        }
    }
}
