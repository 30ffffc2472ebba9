//! Insides that light never enters, fog without density, dispersion without refraction.
//!
//! Kept to the bit: an index of 1 is the same for all colours, and what is never entered is never asked.

use super::fold::Facts;
use super::surfaces::is_solid;
use super::{Notes, Pass, Pruned, Saved};
use crate::scene::{Fog, Material, Medium, Place, SurfaceModel};

/// Takes out media that do nothing.
pub fn pass(pruned: &mut Pruned<'_>) {
    pruned.each_material(Pass::Media, simplify);
    atmosphere(pruned);
    fogs(pruned);
}

fn simplify(facts: &Facts<'_>, material: &mut Material, notes: &mut Notes) {
    let bends = |ior: f64| ior != 1.0;
    let (disperses, ior) = match &mut material.surface {
        SurfaceModel::Glass { ior, abbe, .. } if !bends(*ior) => (abbe.take().is_some(), *ior),
        SurfaceModel::Principled(p) if !bends(p.ior) => (std::mem::take(&mut p.dispersion) > 0.0, p.ior),
        SurfaceModel::Finish(f) if !f.ior.is_some_and(bends) => {
            (std::mem::take(&mut f.dispersion) > 0.0, f.ior.unwrap_or(1.0))
        }
        _ => (false, 1.0),
    };
    if disperses {
        notes.told.push(format!("it disperses nothing with an index of {ior}"));
    }
    if !material.interior.is_clear() && !is_solid(facts.scene, material) {
        notes.told.push("its inside is never entered by light".to_owned());
    }
    if material.interior != Medium::default() && (material.interior.is_clear() || !is_solid(facts.scene, material)) {
        material.interior = Medium::default();
    }
}

/// An atmosphere that is written down and does nothing is told once.
fn atmosphere(pruned: &mut Pruned<'_>) {
    if pruned.scene.atmosphere.is_clear() && pruned.scene.atmosphere_place != Place::None {
        let scene = pruned.scene.to_mut();
        scene.atmosphere = Medium::default();
        let place = std::mem::take(&mut scene.atmosphere_place);
        let why = "it neither absorbs nor scatters nor shines";
        pruned.tell(Pass::Media, "atmosphere", "", why, &place, Saved::default());
    }
}

fn fogs(pruned: &mut Pruned<'_>) {
    let is_thin = |fog: &Fog| !(fog.distance > 0.0 && fog.distance.is_finite());
    let thin: Vec<Fog> = pruned.scene.fogs.iter().filter(|f| is_thin(f)).cloned().collect();
    if thin.is_empty() {
        return;
    }
    pruned.scene.to_mut().fogs.retain(|f| !is_thin(f));
    for fog in thin {
        pruned.tell(
            Pass::Media,
            "fog",
            "",
            "it has no density",
            &fog.place,
            Saved::default(),
        );
    }
}
