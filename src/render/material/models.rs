//! From inputs at a point to scattering models: the glTF set, POV-Ray's finish, and the choice of smooth or rough.

use super::super::bsdf::Bsdf;
use super::super::bsdf::film::Film;
use super::super::bsdf::finish::Finish;
use super::super::bsdf::fresnel::f0_from_eta;
use super::super::bsdf::glossy::{Coat, Glossy, SmoothCoat};
use super::super::bsdf::iridescent::{Below, Iridescent};
use super::super::bsdf::metal::Metal;
use super::super::bsdf::microfacet::{ALPHA_DELTA, Ggx};
use super::super::bsdf::principled::{Base, Clearcoat, Principled};
use super::super::bsdf::rough_glass::{RoughGlass, RoughThinGlass};
use super::super::bsdf::sheen::Sheen;
use super::super::bsdf::specular::{Glass, Specular, ThinGlass};
use super::super::technique::FresnelModel;
use super::{FinishInputs, Material, PrincipledInputs, ScalarInput, Scattering, Shading};
use glam::{Vec2, Vec3};

/// α of a perceptual roughness.
pub(super) fn roughness_to_alpha(roughness: f32) -> f32 {
    roughness * roughness
}

/// Whether an event of probability `p` happens; certain ones ask for no number.
pub(super) fn chance<F: FnMut() -> f32>(p: f32, random: &mut F) -> bool {
    p >= 1.0 || (p > 0.0 && random() < p)
}

/// A rough boundary deviates refracted light by about α·|η−1|; below the limit for mirrors it is a smooth one.
pub(super) fn is_rough_solid(eta: f32, alpha: f32) -> bool {
    alpha >= ALPHA_DELTA && alpha * (eta - 1.0).abs() >= ALPHA_DELTA
}

/// The coat of a dielectric of relative index `eta`. One thinner than what surrounds it reflects like its reciprocal,
/// short of total reflection; it is always seen from the thinner side, where both models of Schlick are one.
pub(super) fn dielectric_coat(eta: f32, fresnel: FresnelModel) -> Coat {
    match fresnel {
        FresnelModel::Exact => Coat::Dielectric {
            eta: eta.max(1.0 / eta),
        },
        FresnelModel::Schlick | FresnelModel::SchlickIncident => Coat::Schlick {
            f0: Vec3::splat(f0_from_eta(eta)),
            f90: if eta == 1.0 { 0.0 } else { 1.0 },
        },
    }
}

impl Scattering {
    /// The boundary of a dielectric solid.
    pub(super) fn solid(self, color: Vec3, eta: f32, alpha: f32) -> Base {
        let (fresnel, compensated) = (self.fresnel, self.compensated);
        match Ggx::isotropic(alpha) {
            Some(ggx) if is_rough_solid(eta, alpha) => Base::RoughGlass(RoughGlass {
                color,
                eta,
                ggx,
                fresnel,
                compensated,
            }),
            _ => Base::Glass(Glass { color, eta, fresnel }),
        }
    }

    /// A conductor.
    pub(super) fn conductor(self, f0: Vec3, ggx: Option<Ggx>) -> Base {
        let compensated = self.compensated;
        match ggx {
            Some(ggx) => Base::Metal(Metal { f0, ggx, compensated }),
            None => Base::Specular(Specular {
                color: f0,
                grazing: Vec3::ONE,
            }),
        }
    }

    /// A coat over a diffuse base.
    pub(super) fn coated(self, base: Vec3, back: Vec3, coat: Coat, ggx: Option<Ggx>) -> Base {
        match ggx {
            Some(ggx) => Base::Glossy(Glossy {
                base,
                back,
                coat,
                ggx,
                compensated: self.compensated,
            }),
            None => Base::SmoothCoat(SmoothCoat { base, back, coat }),
        }
    }
}

impl Material {
    /// The glTF set: metal, transmission or plastic by chance, then its layers.
    pub(super) fn principled<F: FnMut() -> f32>(&self, p: &PrincipledInputs, cx: &Shading<'_>, random: &mut F) -> Bsdf {
        let color = p.base_color.eval(cx.textures, cx.attrs).clamp(Vec3::ZERO, Vec3::ONE);
        let alpha = roughness_to_alpha(p.roughness.unit(cx));
        let anisotropy = p.anisotropy.unit(cx);
        let ggx = Ggx::anisotropic(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha);
        let base = self.base(p, color, alpha, ggx, cx, random);
        let strength = p.clearcoat.unit(cx);
        let coat = if strength > 0.0 {
            let alpha = roughness_to_alpha(p.clearcoat_roughness.unit(cx));
            Clearcoat::new(strength, Ggx::isotropic(alpha))
        } else {
            Clearcoat::NONE
        };
        let sheen = if p.sheen_color.is_black() {
            Sheen::NONE
        } else {
            let tint = p.sheen_color.eval(cx.textures, cx.attrs).clamp(Vec3::ZERO, Vec3::ONE);
            Sheen::new(tint, p.sheen_roughness.unit(cx))
        };
        let lean = Vec2::ZERO;
        Principled {
            base,
            coat,
            sheen,
            lean,
        }
        .into_bsdf()
    }

    /// What lies below the layers: metal, transmission or plastic by chance, under a film or not.
    fn base<F: FnMut() -> f32>(
        &self,
        p: &PrincipledInputs,
        color: Vec3,
        alpha: f32,
        ggx: Option<Ggx>,
        cx: &Shading<'_>,
        random: &mut F,
    ) -> Base {
        if chance(p.metallic.unit(cx), random) {
            return match self.film(p, cx, random) {
                None => self.scattering.conductor(color, ggx),
                Some(film) => self.iridescent(Iridescent::new(film, color, ggx, Below::Metal)),
            };
        }
        let f90 = p.specular.unit(cx);
        let f0 = p.specular_color.eval(cx.textures, cx.attrs).max(Vec3::ZERO) * f0_from_eta(p.ior / cx.outer_ior);
        let f0 = f0.min(Vec3::ONE) * f90;
        if chance(p.transmission.unit(cx), random) {
            let film = self.film(p, cx, random);
            if p.thick {
                let eta = self.relative_ior(cx);
                let Some(film) = film else {
                    return self.scattering.solid(color, eta, alpha);
                };
                let ggx = Ggx::isotropic(alpha).filter(|_| is_rough_solid(eta, alpha));
                return self.iridescent(Iridescent::new(film, f0, ggx, Below::Solid { color, eta }));
            }
            if let Some(film) = film {
                return self.iridescent(Iridescent::new(film, f0, ggx, Below::Sheet(color)));
            }
            return match ggx {
                None => Base::ThinGlass(ThinGlass { color, f0, f90 }),
                Some(ggx) => Base::RoughThinGlass(RoughThinGlass {
                    color,
                    f0,
                    f90,
                    ggx,
                    compensated: self.scattering.compensated,
                }),
            };
        }
        let share = p.diffuse_transmission.unit(cx);
        let back = p.diffuse_transmission_color.eval(cx.textures, cx.attrs);
        let back = back.clamp(Vec3::ZERO, Vec3::ONE) * share;
        let base = color * (1.0 - share);
        match self.film(p, cx, random) {
            None => self.scattering.coated(base, back, Coat::Schlick { f0, f90 }, ggx),
            Some(film) => {
                let mut surface = Iridescent::new(film, f0, ggx, Below::Diffuse { base, back });
                surface.facet = if ggx.is_some() { random() } else { 0.0 };
                self.iridescent(surface)
            }
        }
    }

    /// The thin film, by the chance of its share: scattering is linear in what facets reflect.
    fn film<F: FnMut() -> f32>(&self, p: &PrincipledInputs, cx: &Shading<'_>, random: &mut F) -> Option<Film> {
        let is_none = p.iridescence.is_nothing() || p.iridescence_thickness.is_nothing();
        if is_none || !chance(p.iridescence.unit(cx), random) {
            return None;
        }
        let thickness = p.iridescence_thickness.eval(cx.textures, cx.attrs);
        Film::new(p.iridescence_ior, thickness, cx.outer_ior)
    }

    fn iridescent(&self, mut surface: Iridescent) -> Base {
        surface.compensated = self.scattering.compensated;
        Base::Iridescent(surface)
    }

    /// [`Material::straight_transmittance`] of the glTF set.
    pub(super) fn principled_straight(&self, p: &PrincipledInputs, cx: &Shading<'_>, cos: f32) -> Vec3 {
        let share = p.transmission.unit(cx) * (1.0 - p.metallic.unit(cx));
        if share <= 0.0 {
            return Vec3::ZERO;
        }
        let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let with_film = |film: f32| {
            // The choices that lead to transmission, with certainty.
            let sure = PrincipledInputs {
                metallic: ScalarInput::constant(0.0),
                transmission: ScalarInput::constant(1.0),
                iridescence: ScalarInput::constant(film),
                ..*p
            };
            let (base, keep) = match self.principled(&sure, cx, &mut || 0.5) {
                Bsdf::Principled(b) => (b.base.bsdf(), b.keep_base(wo)),
                other => (other, 1.0),
            };
            let passes = match base {
                Bsdf::Glass(g) => g.color * (1.0 - g.fresnel.reflectance(cos, g.eta.max(1.0 / g.eta))),
                Bsdf::ThinGlass(t) => t.color * (Vec3::ONE - t.reflectance(cos)),
                Bsdf::Iridescent(b) => b.passage(cos),
                _ => Vec3::ZERO,
            };
            passes * (share * keep)
        };
        let film = match p.iridescence_thickness.is_nothing() {
            true => 0.0,
            false => p.iridescence.unit(cx),
        };
        if film > 0.0 {
            with_film(0.0) * (1.0 - film) + with_film(1.0) * film
        } else {
            with_film(0.0)
        }
    }
}

impl FinishInputs {
    /// POV-Ray's surface at a point, energy to be limited by [`Finish`] itself.
    pub(super) fn lobes(&self, fresnel: FresnelModel, eta: f32, cx: &Shading<'_>) -> Finish {
        let color = self.color.eval(cx.textures, cx.attrs).max(Vec3::ZERO);
        let opacity = (1.0 - self.filter - self.transmit).clamp(0.0, 1.0);
        // Phong's exponent counts the angle to the mirror direction, about twice that to the half vector.
        let (phong_s, blinn_s) = ((4.0 * self.phong_size).max(0.0), (1.0 / self.roughness).max(0.0));
        let phong = Finish::highlight_weight(self.phong.max(0.0), phong_s);
        let blinn = Finish::highlight_weight(self.specular.max(0.0), blinn_s);
        let amount = phong + blinn;
        let ggx = if amount > 0.0 {
            // Both at once are one lobe of the mean width, each by its weight.
            let (a, b) = (Finish::highlight_alpha(phong_s), Finish::highlight_alpha(blinn_s));
            Ggx::isotropic((phong * a + blinn * b) / amount)
        } else {
            None
        };
        let tinted = |share: f32| Vec3::ONE + (color - Vec3::ONE) * share;
        Finish {
            diffuse: color * (opacity * self.diffuse.max(0.0)),
            diffuse_back: color * (opacity * self.diffuse_back.max(0.0)),
            brilliance: self.brilliance.max(0.0),
            highlight: tinted(self.metallic) * amount,
            ggx,
            mirror_min: self.reflection_min * tinted(self.reflection_metallic),
            mirror_max: self.reflection_max * tinted(self.reflection_metallic),
            falloff: if self.reflection_fresnel {
                f32::NAN
            } else {
                self.reflection_falloff
            },
            passes: (color * self.filter + Vec3::splat(self.transmit)).max(Vec3::ZERO),
            eta: if self.ior.is_some() { eta } else { 1.0 },
            fresnel,
            conserve: self.conserve_energy,
        }
    }
}
