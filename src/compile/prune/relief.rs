//! Normal maps and reliefs that leave every normal as it is: of scale 0, or flat in all texels.
//!
//! Kept to the bit: the engine gives back the very normal where a map leans it to no side.

use super::fold::Facts;
use super::{Notes, Pass, Pruned};
use crate::scene::{Material, NormalMap, SurfaceModel, Texture, TextureId};

/// Takes flat maps off all materials.
pub fn pass(pruned: &mut Pruned<'_>) {
    pruned.each_material(Pass::Relief, flatten);
}

fn flatten(facts: &Facts<'_>, material: &mut Material, notes: &mut Notes) {
    if let Some(map) = material.normal_map
        && let Some(why) = idle(map.scale, || is_flat(facts, &map))
    {
        material.normal_map = None;
        tell(facts, map.texture, "normal map", why, notes);
    }
    if let SurfaceModel::Principled(p) = &mut material.surface
        && let Some(map) = p.clearcoat_normal
        && let Some(why) = idle(map.scale, || is_flat(facts, &map))
    {
        p.clearcoat_normal = None;
        tell(facts, map.texture, "normal map of the coat", why, notes);
    }
    if let Some(map) = material.bump_map
        && let Some(why) = idle(map.scale, || facts.known(map.texture)[..3].iter().all(Option::is_some))
    {
        material.bump_map = None;
        tell(facts, map.texture, "height map", why, notes);
    }
}

fn idle(scale: f64, is_flat: impl FnOnce() -> bool) -> Option<&'static str> {
    if scale == 0.0 {
        Some("has scale 0")
    } else {
        is_flat().then_some("is flat")
    }
}

fn tell(facts: &Facts<'_>, texture: TextureId, what: &str, why: &str, notes: &mut Notes) {
    notes.told.push(format!("its {what} {why}"));
    for image in facts.images_of(texture) {
        notes.images.insert(image, format!("as a {what} it {why}"));
    }
}

fn is_flat(facts: &Facts<'_>, map: &NormalMap) -> bool {
    match facts.scene.textures.get(map.texture.index()) {
        Some(Texture::Image(t)) => facts.images.is_flat(t.image),
        _ => facts.known(map.texture)[..2] == [Some(0.5); 2],
    }
}
