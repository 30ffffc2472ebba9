//! Taking effects away, each alone: an edit keeps everything else as it is.

use super::{Effect, flatten};
use crate::files::Files;
use crate::render::technique::{LightPick, Technique};
use crate::scene::{Camera, ColorInput, Finish, Material, Medium, OpacityMode, Principled, Scene, SurfaceModel};
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

impl Effect {
    /// A copy of the scene and of the technique without it.
    pub fn left_out<'a>(self, scene: &Scene, technique: &Technique, files: &'a dyn Files) -> Cut<'a> {
        let mut cut = Cut {
            scene: scene.clone(),
            technique: *technique,
            files,
        };
        self.leave_out(&mut cut.scene, &mut cut.technique, files);
        cut
    }

    /// Takes it away.
    pub fn leave_out(self, scene: &mut Scene, technique: &mut Technique, files: &dyn Files) {
        match self {
            Effect::Textures => flatten::images(scene, files),
            Effect::Bump => each_material(scene, no_normal_maps),
            Effect::Alpha => each_material(scene, no_holes),
            Effect::Media => {
                each_material(scene, |m| m.interior = Medium::default());
                scene.atmosphere = Medium::default();
                scene.fogs.clear();
            }
            Effect::Dispersion => each_material(scene, no_dispersion),
            Effect::Lens => scene.cameras.iter_mut().for_each(no_lens),
            Effect::Motion => scene.hold_still(),
            Effect::Environment => scene.environment.illuminates = false,
            Effect::Specular => each_material(scene, no_mirrors),
            Effect::Glass => each_material(scene, no_refraction),
            Effect::Glossy => each_material(scene, no_highlights),
            Effect::Translucent => each_material(scene, no_far_side),
            Effect::Indirect => technique.max_depth = technique.max_depth.min(1),
            Effect::Caustics => technique.caustics = false,
            Effect::LightTree => technique.lights = LightPick::Power,
        }
    }
}

fn each_material(scene: &mut Scene, edit: fn(&mut Material)) {
    scene.materials.iter_mut().for_each(edit);
}

fn no_lens(camera: &mut Camera) {
    camera.lens_radius = 0.0;
    camera.motion.iter_mut().for_each(|key| key.lens_radius = 0.0);
}

fn no_normal_maps(material: &mut Material) {
    material.normal_map = None;
    material.bump_map = None;
    if let SurfaceModel::Principled(p) = &mut material.surface {
        p.clearcoat_normal = None;
    }
}

fn no_holes(material: &mut Material) {
    material.opacity.mode = OpacityMode::Opaque;
    if let SurfaceModel::Finish(f) = &mut material.surface
        && f.ior.is_none()
    {
        (f.filter, f.transmit) = (0.0, 0.0);
    }
}

fn no_dispersion(material: &mut Material) {
    match &mut material.surface {
        SurfaceModel::Glass { abbe, .. } => *abbe = None,
        SurfaceModel::Principled(p) => p.dispersion = 0.0,
        SurfaceModel::Finish(f) => f.dispersion = 0.0,
        _ => {}
    }
}

/// Mirrors go black, so that nothing else takes the place of what they show.
fn no_mirrors(material: &mut Material) {
    match &mut material.surface {
        SurfaceModel::Finish(f) => f.reflection = None,
        SurfaceModel::Specular { .. } => material.surface = SurfaceModel::Black,
        SurfaceModel::Principled(p) if p.metallic.most() > 0.0 && p.roughness.most() == 0.0 => {
            p.metallic = 0.0.into();
            p.base_color = ColorInput::constant(DVec3::ZERO);
            p.specular = 0.0.into();
            p.iridescence = 0.0.into();
        }
        _ => {}
    }
}

/// Light goes on unbent, tinted as before.
fn no_refraction(material: &mut Material) {
    no_dispersion(material);
    match &mut material.surface {
        SurfaceModel::Glass { ior, roughness, .. } => (*ior, *roughness) = (1.0, 0.0.into()),
        SurfaceModel::Principled(p) if p.transmission.most() > 0.0 => {
            (p.ior, p.roughness, p.iridescence) = (1.0, 0.0.into(), 0.0.into());
        }
        SurfaceModel::Finish(f) => f.ior = None,
        _ => {}
    }
}

/// Coats off, their bases stay; a rough metal is a mirror of its colour.
fn no_highlights(material: &mut Material) {
    match &mut material.surface {
        SurfaceModel::Finish(f) => (f.phong, f.specular) = (0.0, 0.0),
        SurfaceModel::Glossy { color, metal, .. } => {
            material.surface = if *metal {
                SurfaceModel::Specular { color: *color }
            } else {
                SurfaceModel::Diffuse {
                    color: *color,
                    sigma: 0.0.into(),
                }
            };
        }
        SurfaceModel::Principled(p) => {
            p.clearcoat = 0.0.into();
            p.sheen_color = DVec3::ZERO.into();
            if has_coat(p) {
                p.specular = 0.0.into();
                p.iridescence = 0.0.into();
            }
            if p.metallic.most() > 0.0 {
                p.roughness = 0.0.into();
            }
        }
        _ => {}
    }
}

/// All that a sheet scatters stays on the lit side.
fn no_far_side(material: &mut Material) {
    match &mut material.surface {
        SurfaceModel::Translucent { transmit, .. } => *transmit = 0.0.into(),
        SurfaceModel::Principled(p) => p.diffuse_transmission = 0.0.into(),
        SurfaceModel::Finish(f) => f.diffuse_back = 0.0,
        _ => {}
    }
}

/// Whether a finish lets light pass at all.
pub(super) fn passes(f: &Finish) -> bool {
    f.filter > 0.0 || f.transmit > 0.0
}

/// Whether a principled surface is a dielectric with a coat over a base.
pub(super) fn has_coat(p: &Principled) -> bool {
    let reflects = (p.specular.most() > 0.0 && p.ior != 1.0) || p.iridescence.most() > 0.0;
    reflects && p.transmission.least() < 1.0 && p.metallic.least() < 1.0
}
