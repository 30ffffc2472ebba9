//! Coverage that is 1 everywhere: the surface is opaque, and no ray need ask.
//!
//! Kept to the bit: where coverage is 1 no random number is compared with it.

use super::fold::{Facts, is_at_least};
use super::{Notes, Pass, Pruned};
use crate::scene::{Material, OpacityMode};

/// Makes materials opaque that are so everywhere, and forgets alpha that is ignored.
pub fn pass(pruned: &mut Pruned<'_>) {
    pruned.each_material(Pass::Coverage, simplify);
}

fn simplify(_: &Facts<'_>, material: &mut Material, notes: &mut Notes) {
    let opacity = &mut material.opacity;
    let is_full = match opacity.mode {
        OpacityMode::Opaque => {
            opacity.alpha = 1.0.into();
            return;
        }
        // As the engine compares, in f32.
        OpacityMode::Mask(cutoff) => opacity.alpha.texture.is_none() && opacity.alpha.factor as f32 >= cutoff as f32,
        OpacityMode::Blend => is_at_least(&opacity.alpha, 1.0),
    };
    if is_full {
        opacity.mode = OpacityMode::Opaque;
        opacity.alpha = 1.0.into();
        notes.told.push("its coverage is full everywhere".to_owned());
    }
}
