//! Normal maps that leave every normal as it is: of scale 0, or flat in all texels.
//!
//! Kept to the bit: the engine gives back the very normal where a map leans it to no side.

use super::fold::Facts;
use super::{Notes, Pass, Pruned};
use crate::scene::{Material, NormalMap, Texture};

/// Takes flat normal maps off all materials.
pub fn pass(pruned: &mut Pruned<'_>) {
    pruned.each_material(Pass::Relief, flatten);
}

fn flatten(facts: &Facts<'_>, material: &mut Material, notes: &mut Notes) {
    let Some(map) = material.normal_map else { return };
    let why = if map.scale == 0.0 {
        "its normal map has scale 0"
    } else if is_flat(facts, &map) {
        "its normal map is flat"
    } else {
        return;
    };
    material.normal_map = None;
    notes.told.push(why.to_owned());
    for image in facts.images_of(map.texture) {
        notes
            .images
            .insert(image, why.replace("its normal map", "a normal map that"));
    }
}

fn is_flat(facts: &Facts<'_>, map: &NormalMap) -> bool {
    match facts.scene.textures.get(map.texture.index()) {
        Some(Texture::Image(t)) => facts.images.is_flat(t.image),
        _ => facts.known(map.texture)[..2] == [Some(0.5); 2],
    }
}
