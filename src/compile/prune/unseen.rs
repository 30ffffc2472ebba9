//! Objects that no ray meets, and those that light passes as if they were not there.
//!
//! Three kinds: hidden from all rays, of coverage 0 everywhere, and clear boundaries: glass of index 1 and finishes that
//! transmit everything, without tint, inside or emission. A boundary of index 1 still counts where another solid may
//! surround it, since it displaces what refracts or absorbs there; and so it does in fog and in an atmosphere.
//!
//! Rays go on in other rounding and with other random numbers where they no longer pass a surface: the expected value is
//! kept, not the bits. A clear boundary no longer counts as a bounce, and layers of depth, normal and albedo show what is
//! behind it.

use super::fold::{is_at_least, is_black, is_nothing};
use super::reach::{ObjectId, drawn};
use super::{Pass, Pruned, Reached, Saved};
use crate::compile::effects::causes::kind_of;
use crate::compile::materials::solid;
use crate::scene::{
    ColorInput, Finish, GroupId, Material, MaterialId, Object, OpacityMode, Principled, Scene, Shape, SurfaceModel,
    Visibility,
};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// Takes objects out that are nothing to all rays.
pub fn pass(pruned: &mut Pruned<'_>) {
    let reached = pruned.reached();
    let gone = unseen(&pruned.scene, &reached);
    if gone.is_empty() {
        return;
    }
    pruned.roots = None;
    let scene = pruned.scene.to_mut();
    let groups = (0u32..)
        .map(|g| Some(GroupId(g)))
        .zip(scene.groups.iter_mut().map(|g| &mut g.objects));
    let mut told = Vec::new();
    for (group, objects) in std::iter::once((None, &mut scene.objects)).chain(groups) {
        let mut index = 0;
        objects.retain(|object| {
            let why = gone.get(&ObjectId { group, index });
            index += 1;
            told.extend(why.map(|why| (object.clone(), *why)));
            why.is_none()
        });
    }
    for (object, why) in told {
        let saved = Saved {
            objects: 1,
            ..Saved::default()
        };
        let kind = kind_of(&object.shape);
        pruned.tell(Pass::Unseen, kind, &object.name, why, &object.place, saved);
    }
}

/// The objects that no ray need meet, with the reason.
fn unseen(scene: &Scene, reached: &Reached) -> BTreeMap<ObjectId, &'static str> {
    let displaces = may_displace(scene, reached);
    // Without a reason: some ray meets it somewhere.
    let mut objects: BTreeMap<ObjectId, Option<&'static str>> = BTreeMap::new();
    let nothings: BTreeMap<MaterialId, &'static str> = reached
        .materials
        .iter()
        .filter_map(|id| {
            Some((
                *id,
                scene.materials.get(id.index()).and_then(|m| nothing(m, displaces))?,
            ))
        })
        .collect();
    // Most scenes have nothing of the kind, and some very many objects.
    let mut all = scene.objects.iter().chain(scene.groups.iter().flat_map(|g| &g.objects));
    if nothings.is_empty() && all.all(|o| o.visibility == Visibility::default()) {
        return BTreeMap::new();
    }
    drawn(scene, &mut |drawing| {
        let by_material = drawing.material.and_then(|m| nothings.get(&m).copied());
        let why = if drawing.is_seen {
            by_material
        } else {
            Some("no ray sees it")
        };
        match objects.get_mut(&drawing.id) {
            Some(known) => *known = known.and(why),
            None if why.is_some() || drawing.id.group.is_some() || is_mesh(drawing.object) => {
                objects.insert(drawing.id, why);
            }
            None => {}
        }
    });
    objects.into_iter().filter_map(|(id, why)| Some((id, why?))).collect()
}

/// Whether an object may be drawn with several materials; the others are visited once if they are in no group.
fn is_mesh(object: &Object) -> bool {
    matches!(object.shape, Shape::Mesh(_))
}

/// Whether a clear solid of index 1 may take the place of something that acts on light.
fn may_displace(scene: &Scene, reached: &Reached) -> bool {
    let acts = |m: &Material| {
        let (ior, _, is_solid) = solid(m);
        is_solid && (ior != 1.0 || !m.interior.is_clear())
    };
    let mut solids = reached
        .materials
        .iter()
        .filter_map(|id| scene.materials.get(id.index()));
    !scene.atmosphere.is_clear() || !scene.fogs.is_empty() || solids.any(acts)
}

/// Why a surface is as good as not there, if it is.
fn nothing(m: &Material, displaces: bool) -> Option<&'static str> {
    if m.opacity.mode != OpacityMode::Opaque && is_nothing(&m.opacity.alpha) && !is_full_at_0(m.opacity.mode) {
        return Some("its coverage is 0 everywhere");
    }
    if let OpacityMode::Mask(cutoff) = m.opacity.mode
        && m.opacity.alpha.texture.is_none()
        && (m.opacity.alpha.factor as f32) < cutoff as f32
    {
        return Some("its coverage is below the cutoff everywhere");
    }
    if !is_black(&m.emission) || !m.interior.is_clear() || (displaces && solid(m).2) {
        return None;
    }
    match &m.surface {
        SurfaceModel::Glass { color, ior, abbe, .. } => {
            let is_clear = *ior == 1.0 && abbe.is_none() && is_white(color);
            is_clear.then_some("glass of ior 1 without tint or inside does nothing")
        }
        SurfaceModel::Principled(p) => {
            is_clear_solid(p).then_some("a solid of ior 1 that transmits everything does nothing")
        }
        SurfaceModel::Finish(f) => passes_all(f).then_some("it lets all light pass straight"),
        SurfaceModel::Black
        | SurfaceModel::Diffuse { .. }
        | SurfaceModel::Specular { .. }
        | SurfaceModel::Glossy { .. }
        | SurfaceModel::Translucent { .. }
        | SurfaceModel::Mix { .. } => None,
    }
}

/// Whether a mask leaves standing what has no coverage.
fn is_full_at_0(mode: OpacityMode) -> bool {
    matches!(mode, OpacityMode::Mask(cutoff) if cutoff <= 0.0)
}

fn is_white(color: &ColorInput) -> bool {
    color.texture.is_none() && color.factor == DVec3::ONE
}

fn is_clear_solid(p: &Principled) -> bool {
    p.ior == 1.0
        && p.thick
        && p.dispersion == 0.0
        && is_at_least(&p.transmission, 1.0)
        && is_nothing(&p.metallic)
        && is_nothing(&p.clearcoat)
        && is_nothing(&p.iridescence)
        && is_black(&p.sheen_color)
        && is_white(&p.base_color)
}

fn passes_all(f: &Finish) -> bool {
    let color = f.color.factor.as_vec3();
    f.color.texture.is_none()
        && color * f.filter as f32 + Vec3::splat(f.transmit as f32) == Vec3::ONE
        && f.reflection.is_none()
        && f.phong <= 0.0
        && f.specular <= 0.0
        && f.ior.is_none_or(|ior| ior == 1.0)
}
