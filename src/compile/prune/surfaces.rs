//! Parts of surfaces that have no share: a mix that is one of its parts alone, layers and lobes of strength 0.
//!
//! Kept to the bit: what is certain asks for no random number, and what is taken out would have been multiplied by 0 or
//! never been asked for.

use super::fold::{Facts, is_at_least, is_black, is_nothing};
use super::{Notes, Pass, Pruned};
use crate::compile::materials::solid;
use crate::scene::{Finish, Material, Medium, Principled, Scene, SurfaceModel};
use glam::DVec3;

/// Mixtures nested deeper than this contain themselves; `compile` refuses them.
const DEEPEST: u32 = 64;

/// Simplifies the surfaces of all materials.
pub fn pass(pruned: &mut Pruned<'_>) {
    pruned.each_material(Pass::Surfaces, simplify);
}

fn simplify(facts: &Facts<'_>, material: &mut Material, notes: &mut Notes) {
    for _ in 0..DEEPEST {
        let Some((part, why)) = sole_part(facts.scene, material) else {
            break;
        };
        material.interior = interior_with(facts.scene, material, part);
        material.surface = part.surface.clone();
        notes.told.push(why);
    }
    match &mut material.surface {
        SurfaceModel::Principled(p) => principled(p),
        SurfaceModel::Finish(f) => finish(f, notes),
        // Lamps, most of all: what reflects nothing needs no light.
        SurfaceModel::Diffuse { color, .. } | SurfaceModel::Translucent { color, .. } if is_black(color) => {
            material.surface = SurfaceModel::Black;
        }
        SurfaceModel::Black
        | SurfaceModel::Diffuse { .. }
        | SurfaceModel::Specular { .. }
        | SurfaceModel::Glass { .. }
        | SurfaceModel::Glossy { .. }
        | SurfaceModel::Translucent { .. }
        | SurfaceModel::Mix { .. } => {}
    }
}

/// The part of a mix that is all of it.
fn sole_part<'a>(scene: &'a Scene, material: &Material) -> Option<(&'a Material, String)> {
    let SurfaceModel::Mix { a, b, weight } = &material.surface else {
        return None;
    };
    let (id, which) = if is_nothing(weight) {
        (*a, "first")
    } else if is_at_least(weight, 1.0) {
        (*b, "second")
    } else {
        return None;
    };
    let part = scene.materials.get(id.index())?;
    // A mix has neither a direction of anisotropy nor a coat of its own, which dims what it emits and has another normal.
    let is_turned = matches!(&part.surface, SurfaceModel::Principled(p)
        if !is_nothing(&p.anisotropy) || !is_nothing(&p.clearcoat));
    let why = format!("a mix by {} is its {which} part alone", weight.most());
    (!is_turned && part.surface != material.surface).then_some((part, why))
}

/// What fills a solid of a mix that is this part alone: the mix's own filling, else the part's, which alone decides
/// whether there is a solid at all.
fn interior_with(scene: &Scene, mix: &Material, part: &Material) -> Medium {
    if is_solid(scene, part) && !mix.interior.is_clear() {
        mix.interior
    } else {
        part.interior
    }
}

/// Whether light crosses a surface into a solid, or may: of a mix, into one of the parts that it has.
pub fn is_solid(scene: &Scene, material: &Material) -> bool {
    is_solid_within(scene, material, DEEPEST)
}

fn is_solid_within(scene: &Scene, material: &Material, depth: u32) -> bool {
    let SurfaceModel::Mix { a, b, weight } = &material.surface else {
        return solid(material).2;
    };
    let parts = [(a, is_at_least(weight, 1.0)), (b, is_nothing(weight))];
    let mut parts = parts.into_iter().filter(|(_, is_absent)| !is_absent);
    depth > 0
        && parts.any(|(id, _)| {
            let part = scene.materials.get(id.index());
            part.is_some_and(|part| is_solid_within(scene, part, depth - 1))
        })
}

fn principled(p: &mut Principled) {
    let metal = is_at_least(&p.metallic, 1.0);
    if metal {
        // The choice of metal is certain: nothing below it is asked for.
        p.transmission = 0.0.into();
        p.diffuse_transmission = 0.0.into();
        p.specular.texture = None;
        p.specular_color.texture = None;
    }
    if is_at_least(&p.transmission, 1.0) {
        p.diffuse_transmission = 0.0.into();
    }
    if is_nothing(&p.transmission) {
        p.thick &= !is_nothing(&p.diffuse_transmission);
        p.dispersion = 0.0;
    }
    if is_nothing(&p.specular) {
        p.specular_color.texture = None;
    }
    if is_nothing(&p.diffuse_transmission) {
        p.diffuse_transmission_color = DVec3::ONE.into();
    }
    if is_nothing(&p.clearcoat) {
        p.clearcoat_normal = None;
        p.clearcoat_roughness = 0.0.into();
    }
    if is_black(&p.sheen_color) {
        p.sheen_roughness = 0.0.into();
    }
    if is_nothing(&p.anisotropy) {
        p.anisotropy_direction = None;
    }
    if is_nothing(&p.iridescence) || is_nothing(&p.iridescence_thickness) {
        p.iridescence = 0.0.into();
        p.iridescence_thickness = 0.0.into();
    }
}

fn finish(f: &mut Finish, notes: &mut Notes) {
    if f.reflection
        .is_some_and(|r| r.min == DVec3::ZERO && r.max == DVec3::ZERO)
    {
        f.reflection = None;
        notes.told.push("a reflection of 0 mirrors nothing".to_owned());
    }
    // The index bends what passes and decides what a mirror by Fresnel reflects; nothing else reads it.
    let passes = f.filter > 0.0 || f.transmit > 0.0;
    if !passes && !f.reflection.is_some_and(|r| r.fresnel) {
        f.ior = None;
    }
}
