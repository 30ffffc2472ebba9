//! The effects of a scene that can be left out, so that each can be weighed: one table, one line an effect.
//!
//! Most are edits of the description; two are choices of the technique. An edit keeps everything else as it is: without
//! textures each image is its mean colour, without the environment's light the sky is still seen.

mod flatten;

use super::uses::Uses;
use crate::files::Files;
use crate::render::technique::Technique;
use crate::scene::{ColorInput, Material, OpacityMode, Scene, SurfaceModel};
use glam::DVec3;

/// A scene and a way to render it, from which something is taken away.
pub struct Cut<'a> {
    /// The scene.
    pub scene: Scene,
    /// How it is rendered.
    pub technique: Technique,
    /// Where its images are.
    pub files: &'a dyn Files,
}

/// An effect that can be left out.
#[derive(Clone, Copy)]
pub struct Effect {
    /// What it is called, as in `caustics`.
    pub name: &'static str,
    /// Whether the scene has it; `technique` is that of the base line.
    is_used: fn(&Uses, &Technique) -> bool,
    /// Takes it away.
    leave_out: fn(&mut Cut),
}

/// All of them.
const EFFECTS: [Effect; 10] = [
    Effect {
        name: "indirect light",
        is_used: |_, technique| technique.max_depth > 1,
        leave_out: |cut| cut.technique.max_depth = 1,
    },
    Effect {
        name: "caustics",
        is_used: |uses, technique| uses.specular && technique.caustics,
        leave_out: |cut| cut.technique.caustics = false,
    },
    Effect {
        name: "environment light",
        is_used: |uses, _| uses.environment,
        leave_out: |cut| cut.scene.environment.illuminates = false,
    },
    Effect {
        name: "depth of field",
        is_used: |uses, _| uses.lens,
        leave_out: |cut| cut.scene.cameras.iter_mut().for_each(|c| c.lens_radius = 0.0),
    },
    Effect {
        name: "textures",
        is_used: |uses, _| uses.images,
        leave_out: |cut| flatten::images(&mut cut.scene, cut.files),
    },
    Effect {
        name: "normal maps",
        is_used: |uses, _| uses.normal_maps,
        leave_out: |cut| each_material(cut, no_normal_maps),
    },
    Effect {
        name: "alpha",
        is_used: |uses, _| uses.alpha,
        leave_out: |cut| each_material(cut, |m| m.opacity.mode = OpacityMode::Opaque),
    },
    Effect {
        name: "absorption",
        is_used: |uses, _| uses.absorption,
        leave_out: |cut| each_material(cut, |m| m.interior.absorption = DVec3::ZERO),
    },
    Effect {
        name: "highlights",
        is_used: |uses, _| uses.highlights,
        leave_out: |cut| each_material(cut, no_highlights),
    },
    Effect {
        name: "mirrors",
        is_used: |uses, _| uses.mirrors,
        leave_out: |cut| each_material(cut, no_mirrors),
    },
];

impl Effect {
    /// The scene and the technique without it.
    pub fn without<'a>(&self, scene: &Scene, technique: &Technique, files: &'a dyn Files) -> Cut<'a> {
        let mut cut = Cut {
            scene: scene.clone(),
            technique: *technique,
            files,
        };
        (self.leave_out)(&mut cut);
        cut
    }
}

/// The effects that a scene has, in the order of the table.
pub fn of(uses: &Uses, technique: &Technique) -> Vec<Effect> {
    EFFECTS.into_iter().filter(|e| (e.is_used)(uses, technique)).collect()
}

fn each_material(cut: &mut Cut, edit: fn(&mut Material)) {
    cut.scene.materials.iter_mut().for_each(edit);
}

fn no_normal_maps(material: &mut Material) {
    material.normal_map = None;
    if let SurfaceModel::Principled(p) = &mut material.surface {
        p.clearcoat_normal = None;
    }
}

/// Coats off, their bases stay.
fn no_highlights(material: &mut Material) {
    match &mut material.surface {
        SurfaceModel::Finish(f) => (f.phong, f.specular) = (0.0, 0.0),
        SurfaceModel::Glossy {
            color, metal: false, ..
        } => {
            material.surface = SurfaceModel::Diffuse {
                color: *color,
                sigma: 0.0.into(),
            };
        }
        _ => {}
    }
}

/// Mirrors go black, so that nothing else takes the place of what they show.
fn no_mirrors(material: &mut Material) {
    match &mut material.surface {
        SurfaceModel::Finish(f) => f.reflection = None,
        SurfaceModel::Specular { color } => *color = ColorInput::constant(DVec3::ZERO),
        _ => {}
    }
}
