//! Effects that take several things to come about: caustics, indirect light, the choice among lights.

use super::Effect::*;
use super::causes::{Cause, Effects, filled};
use super::leave_out::{has_coat, passes};
use crate::render::technique::{LightPick, Technique};
use crate::scene::{Material, Medium, Object, Place, Scene, SurfaceModel};

/// What takes two or three to come about.
#[derive(Default)]
pub struct Receivers {
    /// Surfaces that scatter light widely.
    rough: Vec<Cause>,
    /// Surfaces that throw light in one direction.
    casters: Vec<Cause>,
    /// Lights that are seen under a small angle, or vary.
    pub lights: Vec<Cause>,
    /// An environment of one colour: a light, but none that throws caustics.
    pub even_sky: Option<Cause>,
    /// Media that shine: they light the scene, but nobody samples them.
    glows: bool,
}

impl Receivers {
    /// An object of a material with these parts.
    pub fn look_at(&mut self, m: &Material, parts: &[&Material], what: &str, object: &Object) {
        let cause = |why: &str| Cause {
            what: what.to_owned(),
            why: why.to_owned(),
            place: object.place.clone(),
            times: 1,
        };
        // A mixture shines as a whole.
        if m.emission.factor.max_element() > 0.0 && object.visibility.indirect && !m.unlit {
            self.lights.push(cause("emits"));
        }
        for part in parts {
            let (rough, casts) = scatters(&part.surface);
            self.rough.extend(rough.then(|| cause("scatters")));
            self.casters.extend(casts.then(|| cause("mirrors or bends light")));
        }
        for medium in filled(m, parts) {
            self.look_into(medium, what, &object.place);
        }
    }

    /// A medium that scatters is a receiver as rough surfaces are.
    pub fn look_into(&mut self, m: &Medium, what: &str, place: &Place) {
        self.glows |= m.emission.max_element() > 0.0;
        if m.scattering.max_element() > 0.0 {
            self.rough.push(Cause {
                what: what.to_owned(),
                why: "scatters inside".to_owned(),
                place: place.clone(),
                times: 1,
            });
        }
    }

    /// Adds what comes about, and who takes part in it.
    pub fn conclude(mut self, scene: &Scene, technique: &Technique, effects: &mut Effects) {
        for light in scene.lights.iter().filter(|l| l.color.max_element() > 0.0) {
            let what = if light.name.is_empty() {
                "lamp".to_owned()
            } else {
                format!("lamp \"{}\"", light.name)
            };
            self.lights.push(Cause {
                what,
                why: "shines".to_owned(),
                place: light.place.clone(),
                times: 1,
            });
        }
        let is_lit = !self.lights.is_empty() || self.glows || effects.has(Environment);
        if technique.max_depth > 1 && is_lit {
            let scatter = self.rough.iter().chain(&self.casters);
            scatter.cloned().for_each(|cause| effects.add(Indirect, cause));
        }
        let chain = [&self.casters, &self.lights, &self.rough];
        if technique.caustics && technique.max_depth > 1 && chain.iter().all(|c| !c.is_empty()) {
            self.casters
                .iter()
                .cloned()
                .for_each(|cause| effects.add(Caustics, cause));
        }
        self.lights.extend(self.even_sky);
        if self.lights.len() > 1 && technique.lights == LightPick::Tree {
            self.lights.into_iter().for_each(|cause| effects.add(LightTree, cause));
        }
    }
}

/// Whether a surface scatters widely, and whether it throws light in one direction.
fn scatters(surface: &SurfaceModel) -> (bool, bool) {
    match surface {
        SurfaceModel::Black | SurfaceModel::Mix { .. } => (false, false),
        SurfaceModel::Diffuse { color, .. } | SurfaceModel::Translucent { color, .. } => {
            (color.factor.max_element() > 0.0, false)
        }
        SurfaceModel::Specular { .. } => (false, true),
        // By itself an index of 1 bends nothing; in another solid that one does.
        SurfaceModel::Glass { ior, .. } => (false, *ior != 1.0),
        SurfaceModel::Glossy { metal, .. } => (!metal, true),
        SurfaceModel::Principled(p) => {
            let casts = has_coat(p) || p.metallic.most() > 0.0 || p.transmission.most() > 0.0;
            (p.metallic.least() < 1.0 && p.transmission.least() < 1.0, casts)
        }
        SurfaceModel::Finish(f) => {
            let casts = f.reflection.is_some() || (f.ior.is_some() && passes(f)) || f.phong > 0.0 || f.specular > 0.0;
            (f.diffuse > 0.0 || f.diffuse_back > 0.0, casts)
        }
    }
}
