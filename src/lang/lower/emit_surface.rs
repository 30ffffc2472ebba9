//! The language's own surfaces to materials of the IR.

use super::emit_material::Materials;
use super::parameters::{COLORS, NUMBERS};
use crate::diag::{Diagnostic, Span};
use crate::lang::desc::{BesideDesc, ModelSurface, PrincipledDesc, SurfaceDesc};
use crate::lang::eval::Interp;
use crate::scene::{
    Channel, ColorInput, Encoding, Material, MaterialId, Medium, Opacity, OpacityMode, Place, Principled, ScalarInput,
    Scene, SurfaceModel,
};
use glam::{DAffine3, DVec3};

impl Interp<'_> {
    /// One of the language's own surfaces with what is said beside it.
    pub(super) fn surface_material(
        &mut self,
        s: &SurfaceDesc,
        out: &mut Scene,
        done: &mut Materials,
    ) -> Option<Material> {
        let (model, inside) = self.surface_model_input(&s.model, out, done)?;
        let mut material = Material::new(model);
        if let SurfaceModel::Mix { a, b, weight } = material.surface {
            self.inherit(&mut material, [a, b], weight, s, out);
        }
        self.add_beside(&mut material, &s.beside, out);
        material.interior = inside;
        material.place = Place::Text(s.span);
        Some(material)
    }

    /// How it scatters, and what fills it.
    fn surface_model_input(
        &mut self,
        model: &ModelSurface,
        out: &mut Scene,
        done: &mut Materials,
    ) -> Option<(SurfaceModel, Medium)> {
        let mut filled = Medium::default();
        let surface = match model {
            ModelSurface::Diffuse { color, sigma } => SurfaceModel::Diffuse {
                color: self.pigment_input(color, out),
                sigma: self.number_input(sigma, out),
            },
            ModelSurface::Specular { color } => SurfaceModel::Specular {
                color: self.pigment_input(color, out),
            },
            ModelSurface::Glass {
                color,
                ior,
                roughness,
                abbe,
                inside,
            } => {
                filled = *inside;
                SurfaceModel::Glass {
                    color: self.pigment_input(color, out),
                    ior: *ior,
                    roughness: self.number_input(roughness, out),
                    abbe: *abbe,
                }
            }
            ModelSurface::Glossy {
                color,
                roughness,
                ior,
                metal,
            } => SurfaceModel::Glossy {
                color: self.pigment_input(color, out),
                roughness: self.number_input(roughness, out),
                ior: *ior,
                metal: *metal,
            },
            ModelSurface::Translucent { color, transmit } => SurfaceModel::Translucent {
                color: self.pigment_input(color, out),
                transmit: self.number_input(transmit, out),
            },
            ModelSurface::Principled(p) => {
                filled = p.inside;
                SurfaceModel::Principled(Box::new(self.principled(p, out)))
            }
            ModelSurface::Mix { a, b, weight } => {
                let a = self.emit_look(a, out, done)?;
                let b = self.emit_look(b, out, done)?;
                SurfaceModel::Mix {
                    a,
                    b,
                    weight: self.number_input(weight, out),
                }
            }
            ModelSurface::Black => SurfaceModel::Black,
        };
        Some((surface, filled))
    }

    fn principled(&mut self, p: &PrincipledDesc, out: &mut Scene) -> Principled {
        let mut made = p.plain.clone();
        for (i, color) in &p.colors {
            let input = self.pigment_input(color, out);
            if let Some(parameter) = COLORS.get(*i) {
                *(parameter.slot)(&mut made) = input;
            }
        }
        for (i, number) in &p.numbers {
            let input = self.number_input(number, out);
            if let Some(parameter) = NUMBERS.get(*i) {
                *(parameter.slot)(&mut made) = input;
            }
        }
        made.clearcoat_normal = p.clearcoat_normal.as_ref().and_then(|n| self.normal_map_input(n, out));
        made.anisotropy_direction = p
            .anisotropy_direction
            .as_ref()
            .and_then(|image| self.image_texture(image, &DAffine3::IDENTITY, Encoding::Linear, out));
        made
    }

    /// What a mix takes from its parts beside their surfaces: light in the same shares, and one normal, the first part's
    /// if it has one.
    fn inherit(
        &mut self,
        mix: &mut Material,
        parts: [MaterialId; 2],
        weight: ScalarInput,
        s: &SurfaceDesc,
        out: &mut Scene,
    ) {
        let [Some(a), Some(b)] = parts.map(|id| out.materials.get(id.index()).cloned()) else {
            return;
        };
        mix.bump_map = a.bump_map.or(b.bump_map);
        mix.normal_map = a.normal_map.or(b.normal_map);
        if [&a, &b].iter().any(|part| part.opacity != Opacity::default()) {
            let message = "coverage of the parts of a mix is left out";
            let d = Diagnostic::warning("P0415", message).at(s.span, "");
            self.report(d.hint("write `opacity` and `alpha_mode` beside the mix"));
        }
        let shares = [1.0 - weight.factor, weight.factor];
        let glows = |part: &Material, share: f64| part.emission.factor != DVec3::ZERO && share > 0.0;
        let varies = [&a, &b].iter().any(|part| part.emission.texture.is_some());
        mix.emission = match (glows(&a, shares[0]), glows(&b, shares[1])) {
            (false, false) => return,
            _ if weight.texture.is_some() => {
                self.cannot_mix_light(s.span);
                return;
            }
            (true, false) => scaled(a.emission, shares[0]),
            (false, true) => scaled(b.emission, shares[1]),
            (true, true) if varies => {
                self.cannot_mix_light(s.span);
                return;
            }
            (true, true) => (a.emission.factor * shares[0] + b.emission.factor * shares[1]).into(),
        };
    }

    fn cannot_mix_light(&mut self, at: Span) {
        let message = "light of several surfaces cannot be mixed by images";
        let d = Diagnostic::error("P0416", message).at(at, "");
        self.report(d.hint("write one `emission` beside the mix, and none in its parts"));
    }

    fn add_beside(&mut self, material: &mut Material, beside: &BesideDesc, out: &mut Scene) {
        if let Some((emission, at)) = &beside.emission {
            let own = self.pigment_input(emission, out);
            if own.factor.min_element() < 0.0 {
                self.error("P0311", *at, "emission must not be negative");
            }
            let of_parts = material.emission;
            material.emission = if of_parts.factor == DVec3::ZERO {
                own
            } else if own.texture.or(of_parts.texture).is_none() {
                (of_parts.factor + own.factor).into()
            } else {
                self.cannot_mix_light(*at);
                own
            };
        }
        if let Some(normal) = &beside.normal {
            material.bump_map = self.relief(normal, out);
        }
        if let Some(map) = &beside.normal_map {
            material.normal_map = self.normal_map_input(map, out);
        }
        let mode = beside.alpha_mode.map(|m| m.0);
        let Some(mode) = mode.or(beside.opacity.as_ref().map(|_| OpacityMode::Blend)) else {
            return;
        };
        let alpha = match &beside.opacity {
            Some((opacity, _)) => self.number_input(opacity, out),
            // As in glTF, that of the colour's image.
            None => {
                let texture = own_color(&material.surface).and_then(|c| c.texture);
                ScalarInput::scaled(1.0, texture.map(|t| (t, Channel::A)))
            }
        };
        if mode != OpacityMode::Opaque {
            material.opacity = Opacity { mode, alpha };
        }
    }
}

fn scaled(emission: ColorInput, share: f64) -> ColorInput {
    ColorInput {
        factor: emission.factor * share,
        ..emission
    }
}

/// The main colour of a surface.
fn own_color(surface: &SurfaceModel) -> Option<ColorInput> {
    match surface {
        SurfaceModel::Diffuse { color, .. }
        | SurfaceModel::Specular { color }
        | SurfaceModel::Glass { color, .. }
        | SurfaceModel::Glossy { color, .. }
        | SurfaceModel::Translucent { color, .. } => Some(*color),
        SurfaceModel::Principled(p) => Some(p.base_color),
        SurfaceModel::Finish(f) => Some(f.color),
        SurfaceModel::Mix { .. } | SurfaceModel::Black => None,
    }
}
