//! Looks to materials of the IR: POV-Ray's layers and the language's own surfaces. Equal looks give one material.

use crate::diag::{Diagnostic, Span};
use crate::lang::desc::{FinishDesc, InteriorDesc, Layer, Look, NormalDesc};
use crate::lang::eval::Interp;
use crate::scene::{BumpMap, Encoding, Finish, Material, MaterialId, Place, Scene, SurfaceModel};
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::rc::Rc;

/// An `ambient` from here on is a glowing surface; below, it stood for indirect light, which we compute.
const GLOWING_AMBIENT: f64 = 0.5;

/// `fade_power` from here on is Beer's law.
const EXPONENTIAL_FADE: f64 = 1000.0;

/// Materials made already.
#[derive(Default)]
pub struct Materials {
    /// By the look's parts (layers, surface, interior) and whether it is hollow.
    by_look: HashMap<([*const (); 3], bool), Option<MaterialId>>,
    /// By everything but the place.
    by_value: HashMap<String, MaterialId>,
}

impl Interp<'_> {
    /// The material of a look.
    pub(super) fn emit_look(&mut self, look: &Look, out: &mut Scene, done: &mut Materials) -> Option<MaterialId> {
        let parts = [
            look.layers
                .as_ref()
                .map_or(std::ptr::null(), |l| Rc::as_ptr(l).cast::<()>()),
            look.surface.as_ref().map_or(std::ptr::null(), |s| Rc::as_ptr(s).cast()),
            look.interior
                .as_ref()
                .map_or(std::ptr::null(), |i| Rc::as_ptr(i).cast()),
        ];
        let key = (parts, look.hollow);
        if let Some(&known) = done.by_look.get(&key) {
            return known;
        }
        let id = self.new_material(look, out, done);
        done.by_look.insert(key, id);
        id
    }

    fn new_material(&mut self, look: &Look, out: &mut Scene, done: &mut Materials) -> Option<MaterialId> {
        let default = [self.default_layer()];
        let mut material = match (&look.surface, &look.layers) {
            (Some(surface), _) => self.surface_material(surface, out, done)?,
            (None, Some(layers)) => self.layered(layers, look.interior.as_deref(), out, done),
            (None, None) => self.layered(&default, look.interior.as_deref(), out, done),
        };
        if let Some(interior) = &look.interior {
            material.interior.absorption += self.absorption_of(interior);
            // The language's own materials know where their inside is; POV-Ray fills no solid that is not hollow.
            if look.hollow || look.surface.is_some() {
                let media = self.medium_of(&interior.media);
                material.interior = material.interior.and(&media);
            } else if let Some(media) = interior.media.iter().find(|m| !m.is_clear())
                && self.told_first("media of a solid that is not hollow")
            {
                let message = "`media` inside of an object that is not hollow is not drawn, as in POV-Ray";
                let d = Diagnostic::warning("P0413", message).at(media.span, "");
                self.report(d.hint("add `hollow` to the object"));
            }
        }
        Some(add(material, out, done))
    }

    /// Layers from the bottom up: each covers what is below by its opacity and tints what shines through.
    fn layered(
        &mut self,
        layers: &[Rc<Layer>],
        interior: Option<&InteriorDesc>,
        out: &mut Scene,
        done: &mut Materials,
    ) -> Material {
        let is_opaque = |l: &Rc<Layer>| l.pigment.color[3] + l.pigment.color[4] <= 0.0;
        let bottom = layers.iter().rposition(is_opaque).unwrap_or(0);
        let mut rest = layers.iter().skip(bottom);
        let mut tint = DVec3::ONE;
        let mut above: Vec<(&Rc<Layer>, f64, DVec3)> = Vec::new();
        // From the top down: how much of each layer is seen, and through which tint.
        let first = rest.next();
        for layer in rest.rev() {
            let [_, _, _, filter, transmit] = layer.pigment.color;
            let through = (filter + transmit).clamp(0.0, 1.0);
            above.push((layer, 1.0 - through, tint));
            if through > 0.0 {
                let rgb = self.pigment_color(&layer.pigment);
                tint *= (rgb * filter + DVec3::splat(transmit)) / through;
            }
        }
        let Some(first) = first else {
            return Material::new(SurfaceModel::Black);
        };
        let mut material = self.layer_material(first, interior, (tint, false), out);
        for (layer, opacity, tint) in above.into_iter().rev() {
            let mut over = self.layer_material(layer, interior, (tint, true), out);
            let place = over.place.clone();
            let emission = material.emission.factor * (1.0 - opacity) + over.emission.factor * opacity;
            // A mixture has one normal: the upper layer's, where it has one.
            let bump_map = over.bump_map.take().or(material.bump_map.take());
            let (a, b) = (add(material, out, done), add(over, out, done));
            material = Material::new(SurfaceModel::Mix {
                a,
                b,
                weight: opacity.into(),
            });
            material.emission = emission.into();
            material.bump_map = bump_map;
            material.place = place;
        }
        material
    }

    /// One layer, seen through `tint`; `solid` when its transparency is the mix's business.
    fn layer_material(
        &mut self,
        layer: &Layer,
        interior: Option<&InteriorDesc>,
        (tint, solid): (DVec3, bool),
        out: &mut Scene,
    ) -> Material {
        let bump_map = layer.normal.as_ref().and_then(|n| self.relief(n, out));
        let mut input = self.pigment_input(&layer.pigment, out);
        let rgb = input.factor * tint;
        if rgb.min_element() < 0.0 {
            let at = layer.span.unwrap_or(self.here());
            self.moved(at, "a negative colour is read as 0 where it is negative");
        }
        let rgb = rgb.max(DVec3::ZERO);
        let f = &layer.finish;
        let [_, _, _, filter, transmit] = layer.pigment.color;
        let (filter, transmit) = if solid {
            (0.0, 0.0)
        } else {
            (filter.clamp(0.0, 1.0), transmit.clamp(0.0, 1.0))
        };
        let opacity = (1.0 - filter - transmit).clamp(0.0, 1.0);
        let mut finish = finish_of(f);
        input.factor = rgb;
        finish.color = input;
        finish.filter = filter;
        finish.transmit = transmit.min(1.0 - filter);
        finish.ior = interior
            .and_then(|i| i.ior)
            .filter(|_| filter + transmit > 0.0 || needs_ior(f));
        if let (Some(ior), Some((ratio, at))) = (finish.ior, interior.and_then(|i| i.dispersion))
            && filter + transmit > 0.0
        {
            finish.dispersion = self.dispersion(ior, ratio, at);
        }
        let mut material = Material::new(SurfaceModel::Finish(Box::new(finish)));
        let emission = (self.glow(f) + f.emission) * rgb * opacity;
        material.emission = emission.max(DVec3::ZERO).into();
        if material.emission.factor != DVec3::ZERO {
            material.emission.texture = input.texture;
        }
        material.bump_map = bump_map;
        material.place = layer.span.map_or(Place::None, Place::Text);
        material
    }

    /// A height map on the surface's own coordinates; what else a normal may say is told and left out.
    pub(super) fn relief(&mut self, n: &NormalDesc, out: &mut Scene) -> Option<BumpMap> {
        let what = match (&n.bump, n.uv) {
            (Some(image), true) => {
                return self
                    .image_texture(image, &DAffine3::IDENTITY, Encoding::Linear, out)
                    .map(|texture| BumpMap { texture, scale: n.size });
            }
            (Some(_), false) => "`bump_map` without `uv_mapping`",
            (None, _) => "`normal`",
        };
        let message = format!("{what} is not supported yet: the surface is drawn smooth");
        self.warn_once("P0409", n.span, message);
        None
    }

    /// 20/Abbe of an interior of this index whose indices of violet and red have this ratio.
    ///
    /// POV-Ray's index is n·ratio^((555 nm − λ)/350 nm), from 380 to 730 nm (its `spectral.h`); Abbe's number is
    /// (n − 1)/(n_F − n_C), at 486.13 and 656.27 nm.
    fn dispersion(&mut self, ior: f64, ratio: f64, at: Span) -> f64 {
        if ratio == 1.0 {
            if self.told_first(&format!("dispersion 1 at {at:?}")) {
                self.note_idle("dispersion", "its ratio is 1: all colours are bent alike", at);
            }
            return 0.0;
        }
        let index = |nm: f64| ior * ratio.powf((555.0 - nm) / 350.0);
        let over_abbe = 20.0 * (index(486.13) - index(656.27)) / (ior - 1.0);
        if !(over_abbe > 0.0 && over_abbe.is_finite()) {
            let message =
                format!("`dispersion {ratio}` of `ior {ior}` spreads no colours as a material does, left out");
            self.warn_once("P0409", at, message);
            return 0.0;
        }
        over_abbe
    }

    /// The part of `ambient` that means a glowing surface.
    fn glow(&self, f: &FinishDesc) -> DVec3 {
        let glows =
            f.ambient.max_element() >= GLOWING_AMBIENT || (f.diffuse[0] == 0.0 && f.ambient.max_element() > 0.1);
        if glows {
            f.ambient * self.scene.ambient_light.unwrap_or(DVec3::ONE)
        } else {
            DVec3::ZERO
        }
    }

    /// Absorption per unit length of an interior. A fade other than Beer's law is matched at its own distance.
    fn absorption_of(&mut self, i: &InteriorDesc) -> DVec3 {
        let mut sigma = i.absorption;
        let (Some(distance), Some(power)) = (i.fade_distance, i.fade_power) else {
            return sigma;
        };
        if !(distance > 0.0 && power > 0.0) {
            return sigma;
        }
        let color = self.linear(i.fade_color).clamp(DVec3::ZERO, DVec3::ONE);
        sigma += if power >= EXPONENTIAL_FADE {
            (DVec3::ONE - color) / distance
        } else {
            DVec3::from_array(color.to_array().map(|c| -(0.5 + 0.5 * c).ln())) / distance
        };
        sigma
    }
}

/// Whether a reflection asks for the index of refraction of an opaque thing.
fn needs_ior(f: &FinishDesc) -> bool {
    f.reflection.is_some_and(|r| r.fresnel)
}

fn finish_of(f: &FinishDesc) -> Finish {
    Finish {
        diffuse: f.diffuse[0].max(0.0),
        diffuse_back: f.diffuse[1].max(0.0),
        brilliance: f.brilliance.max(0.0),
        phong: f.phong.max(0.0),
        phong_size: f.phong_size.max(0.0),
        specular: f.specular.max(0.0),
        roughness: f.roughness,
        metallic: f.metallic,
        reflection: f.reflection,
        conserve_energy: f.conserve_energy,
        ..Finish::default()
    }
}

/// Adds a material unless an equal one was added before.
fn add(material: Material, out: &mut Scene, done: &mut Materials) -> MaterialId {
    let place = material.place.clone();
    let plain = Material {
        place: Place::None,
        ..material
    };
    let key = format!("{plain:?}");
    if let Some(&known) = done.by_value.get(&key) {
        return known;
    }
    let id = out.add_material(Material { place, ..plain });
    done.by_value.insert(key, id);
    id
}
