//! An environment without light, and a backdrop that shows nothing else than the environment.
//!
//! Where a dark environment was one of several lights, the others are chosen with other probabilities.

use super::{Pass, Pruned, Saved};
use crate::scene::{EnvironmentKind, Place, Scene};
use glam::DVec3;

/// What the description itself tells.
pub fn pass(pruned: &mut Pruned<'_>) {
    let environment = &pruned.scene.environment;
    let dark = match &environment.kind {
        EnvironmentKind::Black => None,
        EnvironmentKind::Constant(c) => (c.max_element() <= 0.0).then_some("it is black"),
        EnvironmentKind::Image { strength, .. } => (*strength <= 0.0).then_some("its strength is 0"),
    };
    let hidden = !environment.illuminates && environment.backdrop.is_some();
    let hidden = hidden.then_some("it lights nothing, and a backdrop is seen instead");
    match dark.or(hidden) {
        Some(why) if environment.kind != EnvironmentKind::Black => darken(pruned, why),
        _ => tell_black(pruned),
    }
    let environment = &pruned.scene.environment;
    // Rays to infinity look the same in either; the backdrop is asked first.
    let is_double = match (&environment.kind, environment.backdrop) {
        (EnvironmentKind::Constant(c), Some(b)) => environment.illuminates && c.as_vec3() == b.as_vec3(),
        (EnvironmentKind::Black, Some(b)) => b == DVec3::ZERO,
        _ => false,
    };
    if is_double {
        pruned.scene.to_mut().environment.backdrop = None;
    }
}

/// A black environment that is written down is told, once, though there is nothing to take out.
fn tell_black(pruned: &mut Pruned<'_>) {
    let environment = &pruned.scene.environment;
    let is_told = pruned.what.iter().any(|r| r.pass == Pass::Sky);
    if environment.kind == EnvironmentKind::Black && environment.place != Place::None && !is_told {
        let place = environment.place.clone();
        pruned.tell(Pass::Sky, "environment", "", "it is black", &place, Saved::default());
    }
}

/// What its image tells once it is decoded: an environment whose texels have no light.
pub fn image(pruned: &mut Pruned<'_>) {
    let EnvironmentKind::Image { image, .. } = pruned.scene.environment.kind else {
        return;
    };
    if pruned.scene.environment.illuminates && pruned.images.is_black(image) == Some(true) {
        pruned
            .dropped
            .insert(image, (Pass::Sky, "all of it is black".to_owned()));
        darken(pruned, "all of its image is black");
    }
}

fn darken(pruned: &mut Pruned<'_>, why: &str) {
    let saved = Saved {
        lights: u64::from(pruned.scene.environment.illuminates),
        ..Saved::default()
    };
    let place = pruned.scene.environment.place.clone();
    if let EnvironmentKind::Image { image, .. } = pruned.scene.environment.kind {
        pruned
            .dropped
            .entry(image)
            .or_insert((Pass::Sky, format!("the environment shows it, and {why}")));
    }
    pruned.tell(Pass::Sky, "environment", "", why, &place, saved);
    let scene: &mut Scene = pruned.scene.to_mut();
    scene.environment.kind = EnvironmentKind::Black;
}
