//! Materials as the engine evaluates them: recipes that turn a surface point into a [`Bsdf`].
//!
//! `compile` fills these from the description. A recipe with textures is evaluated at every hit; mixtures and the
//! glTF set choose among models by random numbers, which is unbiased because scattering is linear in them.

mod frame;
mod input;
mod models;
mod normal;
mod recipe;
#[cfg(test)]
mod tests;

pub use input::{ColorInput, ScalarInput};
pub use recipe::{Alpha, BumpMap, FinishInputs, NormalMap, PrincipledInputs, SurfaceModel};

use super::bsdf::Bsdf;
use super::bsdf::diffuse::{Diffuse, OrenNayar, Translucent};
use super::bsdf::microfacet::Ggx;
use super::bsdf::principled::Clearcoat;
use super::bsdf::specular::Specular;
use super::surface::Attributes;
use super::technique::{FresnelModel, Technique};
use super::texture::Textures;
use super::wavelength::Wavelength;
use glam::Vec3;
use models::{chance, dielectric_coat, is_rough_solid, roughness_to_alpha};

/// Mixtures nested deeper than this are black; it only bounds the loop.
const MIX_DEPTH: u32 = 16;

/// Which approximations scattering uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scattering {
    /// Which share dielectrics reflect. Models that say Schlick's curve themselves, as glTF does, keep to it.
    pub fresnel: FresnelModel,
    /// Whether rough surfaces give back the light that bounces between their facets.
    pub compensated: bool,
}

impl From<&Technique> for Scattering {
    fn from(t: &Technique) -> Scattering {
        Scattering {
            fresnel: t.fresnel,
            compensated: t.multiple_scattering,
        }
    }
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What scatters.
    pub surface: SurfaceModel,
    /// How exactly.
    pub scattering: Scattering,
    /// Emitted radiance.
    pub emission: ColorInput,
    /// Whether the side of the geometric normal emits.
    pub emits_front: bool,
    /// Whether the other side emits.
    pub emits_back: bool,
    /// Seen by the camera and in mirrors only: all other light passes it by.
    pub unlit: bool,
    /// Coverage.
    pub alpha: Alpha,
    /// Perturbs the shading normal.
    pub normal_map: Option<NormalMap>,
    /// Perturbs the shading normal, after the normal map.
    pub bump_map: Option<BumpMap>,
    /// What fills a solid of it: index into the scene's media.
    pub medium: u32,
    /// Index of refraction inside (glass), or of the coat (glossy).
    pub ior: f32,
    /// 20 / Abbe number; 0 for no dispersion.
    pub dispersion: f32,
    /// Whether it bounds a solid that refracts or absorbs: crossing it enters or leaves a medium.
    pub interior: bool,
    /// Whether evaluating it reads [`Attributes`].
    pub needs_attributes: bool,
}

/// What evaluating a material needs besides itself.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// All materials, for mixtures.
    pub materials: &'a [Material],
    /// All textures.
    pub textures: &'a Textures,
    /// The surface point.
    pub attrs: &'a Attributes,
    /// Index of refraction of what encloses the object.
    pub outer_ior: f32,
    /// The wavelength that a path follows after its first dispersive hit.
    pub wavelength: Option<Wavelength>,
}

impl Material {
    /// A material that only scatters, outside of any medium, as exactly as is known.
    pub fn new(surface: SurfaceModel) -> Material {
        Material {
            surface,
            scattering: Scattering::from(&Technique::default()),
            emission: ColorInput::BLACK,
            emits_front: true,
            emits_back: true,
            unlit: false,
            alpha: Alpha::Opaque,
            normal_map: None,
            bump_map: None,
            medium: super::medium::CLEAR,
            ior: 1.5,
            dispersion: 0.0,
            interior: false,
            needs_attributes: false,
        }
    }

    /// Whether it emits at all.
    pub fn is_emissive(&self) -> bool {
        !self.emission.is_black() && (self.emits_front || self.emits_back)
    }

    /// Whether other surfaces get light from it.
    pub fn is_light(&self) -> bool {
        self.emits_front && !self.unlit
    }

    /// Whether its emission differs from point to point or by direction.
    pub fn emission_varies(&self) -> bool {
        let is_coated = matches!(&self.surface, SurfaceModel::Principled(p) if !p.clearcoat.is_nothing());
        self.emission.texture.is_some() || is_coated
    }

    /// Whether [`Material::straight_transmittance`] can be anything but zero; false spares shadow rays the look-up.
    pub fn may_pass_straight(&self, materials: &[Material]) -> bool {
        self.may_pass_within(materials, MIX_DEPTH)
    }

    fn may_pass_within(&self, materials: &[Material], depth: u32) -> bool {
        match &self.surface {
            SurfaceModel::Glass { .. } => true,
            SurfaceModel::Finish(f) => f.filter != 0.0 || f.transmit != 0.0,
            SurfaceModel::Principled(p) => !p.transmission.is_nothing(),
            SurfaceModel::Mix { .. } if depth == 0 => false,
            SurfaceModel::Mix { a, b, .. } => [*a, *b].into_iter().any(|id| {
                let part = materials.get(id as usize);
                part.is_some_and(|m| m.may_pass_within(materials, depth - 1))
            }),
            SurfaceModel::Black
            | SurfaceModel::Diffuse { .. }
            | SurfaceModel::Specular { .. }
            | SurfaceModel::Glossy { .. }
            | SurfaceModel::Translucent { .. } => false,
        }
    }

    /// The index of refraction inside, of a wavelength if the path follows one and the glass disperses.
    #[inline(always)]
    pub fn ior_at(&self, wavelength: Option<Wavelength>) -> f32 {
        match wavelength {
            Some(w) if self.dispersion > 0.0 => w.ior(self.ior, self.dispersion),
            _ => self.ior,
        }
    }

    /// The scattering at a point. `random` gives numbers in [0, 1) for the choices of mixtures; it is called only then.
    pub fn bsdf<F: FnMut() -> f32>(&self, cx: &Shading<'_>, random: &mut F) -> Bsdf {
        let part = match &self.surface {
            SurfaceModel::Mix { .. } => self.resolve(cx, random),
            _ => self,
        };
        part.bsdf_unmixed(cx, random)
    }

    fn bsdf_unmixed<F: FnMut() -> f32>(&self, cx: &Shading<'_>, random: &mut F) -> Bsdf {
        match &self.surface {
            SurfaceModel::Black => Bsdf::Black,
            SurfaceModel::Diffuse { color, sigma } => {
                let albedo = color.eval(cx.textures, cx.attrs);
                let sigma = sigma.eval(cx.textures, cx.attrs);
                if sigma > 0.0 {
                    Bsdf::OrenNayar(OrenNayar::from_sigma(albedo, sigma))
                } else {
                    Bsdf::Diffuse(Diffuse { albedo })
                }
            }
            SurfaceModel::Specular { color } => {
                let color = color.eval(cx.textures, cx.attrs);
                Bsdf::Specular(Specular { color, grazing: color })
            }
            SurfaceModel::Glass { color, roughness } => {
                let color = color.eval(cx.textures, cx.attrs);
                let alpha = roughness_to_alpha(roughness.unit(cx));
                self.scattering.solid(color, self.relative_ior(cx), alpha).bsdf()
            }
            SurfaceModel::Glossy {
                color,
                roughness,
                metal,
            } => {
                let color = color.eval(cx.textures, cx.attrs);
                let alpha = roughness_to_alpha(roughness.unit(cx));
                if *metal {
                    self.scattering.conductor(color, Ggx::isotropic(alpha)).bsdf()
                } else {
                    let coat = dielectric_coat(self.relative_ior(cx), self.scattering.fresnel);
                    let base = self.scattering.coated(color, Vec3::ZERO, coat, Ggx::isotropic(alpha));
                    base.bsdf()
                }
            }
            SurfaceModel::Translucent { color, transmit } => {
                let color = color.eval(cx.textures, cx.attrs);
                let t = transmit.unit(cx);
                Bsdf::Translucent(Translucent {
                    front: color * (1.0 - t),
                    back: color * t,
                })
            }
            SurfaceModel::Principled(p) => self.principled(p, cx, random),
            SurfaceModel::Finish(f) => Bsdf::Finish(f.lobes(self.scattering.fresnel, self.relative_ior(cx), cx)),
            SurfaceModel::Mix { .. } => Bsdf::Black, // resolved above unless nested without end
        }
    }

    /// The part of a mixture chosen by chance; the material itself if it is none.
    fn resolve<'a, F: FnMut() -> f32>(&'a self, cx: &Shading<'a>, random: &mut F) -> &'a Material {
        let mut part = self;
        for _ in 0..MIX_DEPTH {
            let SurfaceModel::Mix { a, b, weight } = &part.surface else {
                break;
            };
            let id = if chance(weight.unit(cx), random) { *b } else { *a };
            match cx.materials.get(id as usize) {
                Some(next) => part = next,
                None => break,
            }
        }
        part
    }

    /// n_inside / n_outside.
    fn relative_ior(&self, cx: &Shading<'_>) -> f32 {
        self.ior_at(cx.wavelength) / cx.outer_ior
    }

    /// Emitted radiance at a point, seen from the front or the back under this cosine to the normal. A coat lets through what
    /// it does not reflect.
    pub fn emission(&self, cx: &Shading<'_>, front: bool, cos: f32) -> Vec3 {
        if if front { self.emits_front } else { self.emits_back } {
            let below = self.emission.eval(cx.textures, cx.attrs);
            match &self.surface {
                SurfaceModel::Principled(p) if !p.clearcoat.is_nothing() => {
                    let strength = p.clearcoat.unit(cx);
                    below * (1.0 - Clearcoat::new(strength, None).reflectance(cos))
                }
                _ => below,
            }
        } else {
            Vec3::ZERO
        }
    }

    /// Coverage at a point, in [0, 1].
    pub fn alpha(&self, cx: &Shading<'_>) -> f32 {
        match &self.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Mask(value, cutoff) => {
                if value.eval(cx.textures, cx.attrs) >= *cutoff {
                    1.0
                } else {
                    0.0
                }
            }
            Alpha::Blend(value) => value.unit(cx),
        }
    }

    /// Share of light per channel that a shadow ray keeps when it passes through unbent; zero for what is opaque, or
    /// rough (its scattering reaches lamps by itself). `cos` = |cosθ| at the surface. Coverage is not included.
    ///
    /// What really passes unbent ([`super::bsdf::BsdfSample::straight`]) counts always. With `bent_too`, for lamps that no
    /// scattered ray can find, smooth refracting solids pass light as if they did not bend it, in POV-Ray's manner.
    /// A solid's reflectance is that of entering, on both crossings: the real, bent ray has the same on its way out.
    pub fn straight_transmittance(&self, cx: &Shading<'_>, cos: f32, bent_too: bool) -> Vec3 {
        self.straight_within(cx, cos, bent_too, MIX_DEPTH)
    }

    fn straight_within(&self, cx: &Shading<'_>, cos: f32, bent_too: bool, depth: u32) -> Vec3 {
        match &self.surface {
            SurfaceModel::Glass { .. } if !bent_too => Vec3::ZERO,
            SurfaceModel::Glass { color, roughness } => {
                let eta = self.relative_ior(cx);
                if is_rough_solid(eta, roughness_to_alpha(roughness.unit(cx))) {
                    return Vec3::ZERO;
                }
                let r = self.scattering.fresnel.reflectance(cos, eta.max(1.0 / eta));
                color.eval(cx.textures, cx.attrs) * (1.0 - r)
            }
            SurfaceModel::Finish(f) => {
                let mut lobes = f.lobes(self.scattering.fresnel, self.relative_ior(cx), cx);
                if lobes.eta != 1.0 && !bent_too {
                    return Vec3::ZERO;
                }
                lobes.eta = lobes.eta.max(1.0 / lobes.eta);
                lobes.passage(Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos))
            }
            SurfaceModel::Principled(p) if p.thick && !bent_too => Vec3::ZERO,
            SurfaceModel::Principled(p) => self.principled_straight(p, cx, cos),
            SurfaceModel::Mix { .. } if depth == 0 => Vec3::ZERO,
            SurfaceModel::Mix { a, b, weight } => {
                let w = weight.unit(cx);
                let part = |id: u32| {
                    cx.materials
                        .get(id as usize)
                        .map_or(Vec3::ZERO, |m| m.straight_within(cx, cos, bent_too, depth - 1))
                };
                part(*a) * (1.0 - w) + part(*b) * w
            }
            SurfaceModel::Black
            | SurfaceModel::Diffuse { .. }
            | SurfaceModel::Specular { .. }
            | SurfaceModel::Glossy { .. }
            | SurfaceModel::Translucent { .. } => Vec3::ZERO,
        }
    }
}
