//! Lamps that give no light.
//!
//! The others are then chosen with other probabilities: the expected value is kept, not the bits.

use super::{Pass, Pruned, Saved};
use crate::scene::{Light, LightKind, SpotProfile};

/// Takes out lamps whose colour is nowhere above 0, and those that shine into a cone without opening.
pub fn pass(pruned: &mut Pruned<'_>) {
    let dark: Vec<(Light, &str)> = pruned
        .scene
        .lights
        .iter()
        .filter_map(|l| Some((l.clone(), darkness(l)?)))
        .collect();
    if dark.is_empty() {
        return;
    }
    pruned.scene.to_mut().lights.retain(|l| darkness(l).is_none());
    for (lamp, why) in dark {
        let saved = Saved {
            lights: 1,
            ..Saved::default()
        };
        pruned.tell(Pass::Lights, "lamp", &lamp.name, why, &lamp.place, saved);
    }
}

/// Why a lamp gives no light, if it gives none. Numbers that are not finite are `compile`'s to complain about.
fn darkness(lamp: &Light) -> Option<&'static str> {
    if lamp.color.max_element() <= 0.0 {
        return Some("it is dark");
    }
    let profile = match &lamp.kind {
        LightKind::Spot { profile, .. } => Some(profile),
        LightKind::Area { spot, .. } => spot.as_ref().map(|(_, profile)| profile),
        LightKind::Point { .. } | LightKind::Directional { .. } => None,
    };
    let outer = match profile? {
        SpotProfile::Pov { falloff, .. } => *falloff,
        SpotProfile::Punctual { outer, .. } => *outer,
    };
    (outer <= 0.0).then_some("its cone has no opening")
}
