//! Frosted dielectrics: the boundary of a solid, and the thin sheet.

use super::diffuse::sample_cosine_beside;
use super::energy::{schlick_albedo, schlick_mean, solid_albedo, solid_mean, typical_reflectance};
use super::fresnel::{reflect, refract, schlick};
use super::microfacet::Ggx;
use super::{BsdfSample, facing_up, with_side_of};
use crate::math::robust::try_normalize;
use crate::math::warp::INV_PI;
use crate::render::technique::FresnelModel;
use glam::{Vec2, Vec3};

/// The rough boundary of a dielectric solid.
///
/// Single scattering: Walter et al., Microfacet Models for Refraction, EGSR 2007, with visible normals; transmitted
/// radiance is divided by (n_t/n_i)², as at smooth glass. What it loses is scattered by cosine-like lobes to both sides,
/// shared so that η² reciprocity holds and nothing is lost (Kulla & Conty 2017).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughGlass {
    /// Tint of what is transmitted, once per crossing.
    pub color: Vec3,
    /// n_inside / n_outside; inside is −z. Not 1.
    pub eta: f32,
    /// The facets.
    pub ggx: Ggx,
    /// Which share facets reflect. What single scattering loses is taken from the tables of the exact equations always:
    /// it depends on the facets, and hardly on how light is shared between the sides.
    pub fresnel: FresnelModel,
    /// Whether what single scattering loses is added back.
    pub compensated: bool,
}

impl RoughGlass {
    /// n_transmitted / n_incident for light seen along `wo`.
    pub(super) fn eta_towards(&self, wo: Vec3) -> f32 {
        if wo.z >= 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// Share of light lost by single scattering that is added back, on the side whose relative index is `eta`.
    fn lost(&self, cos: f32, eta: f32) -> f32 {
        if !self.compensated {
            return 0.0;
        }
        (1.0 - solid_albedo(cos.abs(), self.ggx.alpha(), eta)).clamp(0.0, 1.0)
    }

    /// (mean loss here, mean loss beyond, share of the lost light that goes beyond).
    fn sides(&self, eta: f32) -> (f32, f32, f32) {
        let here = (1.0 - solid_mean(self.ggx.alpha(), eta)).max(0.0);
        let beyond = (1.0 - solid_mean(self.ggx.alpha(), 1.0 / eta)).max(0.0);
        let (a, b) = (here, eta * eta * beyond);
        (here, beyond, if a + b > 0.0 { b / (a + b) } else { 0.0 })
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let eta = self.eta_towards(wo);
        let (wo, wi) = facing_up(wo, wi);
        if wo.z <= 0.0 || wi.z == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let lost = self.lost(wo.z, eta);
        let (here, beyond, share) = self.sides(eta);
        let cosine = wi.z.abs() * INV_PI;
        if wi.z > 0.0 {
            let (f, pdf, cos) = self.ggx.reflection(wo, wi);
            let r = self.fresnel.reflectance(cos, eta);
            let multiple = if here > 0.0 {
                (1.0 - share) * lost * self.lost(wi.z, eta) / here
            } else {
                0.0
            };
            let value = r * f + multiple * cosine;
            return (
                Vec3::splat(value),
                (1.0 - lost) * r * pdf + lost * (1.0 - share) * cosine,
            );
        }
        let (f, pdf) = self.transmission(wo, wi, eta);
        let multiple = if beyond > 0.0 {
            share * lost * self.lost(wi.z, 1.0 / eta) / beyond
        } else {
            0.0
        };
        (
            self.color * (f + multiple * cosine / (eta * eta)),
            (1.0 - lost) * pdf + lost * share * cosine,
        )
    }

    /// Single-scattering transmission: radiance factor f·|cosθi|, and the density given that facets scatter.
    fn transmission(&self, wo: Vec3, wi: Vec3, eta: f32) -> (f32, f32) {
        let Some(m) = try_normalize(wo + wi * eta) else {
            return (0.0, 0.0);
        };
        let m = if m.z < 0.0 { -m } else { m };
        let (om, im) = (wo.dot(m), wi.dot(m));
        if !(om > 0.0 && im < 0.0) {
            return (0.0, 0.0);
        }
        let t = 1.0 - self.fresnel.reflectance(om, eta);
        let denominator = im + om / eta;
        let jacobian = -im / (denominator * denominator);
        let d = self.ggx.d(m);
        let f = t * d * self.ggx.g2_over_cosine(wo, wi) * om * jacobian / (eta * eta);
        (f, t * self.ggx.pdf_visible(wo, m) * jacobian)
    }

    /// A visible facet, then its reflection or refraction; or, by the share lost, a cosine lobe of either side.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let eta = self.eta_towards(wo);
        let (up, _) = facing_up(wo, wo);
        let lost = self.lost(up.z, eta);
        let wi = if u_lobe < lost {
            let beyond = u_lobe < lost * self.sides(eta).2;
            sample_cosine_beside(if beyond { -up } else { up }, u)
        } else {
            let m = self.ggx.sample_visible(up, u);
            if u_lobe - lost < (1.0 - lost) * self.fresnel.reflectance(up.dot(m).max(0.0), eta) {
                Some(reflect(up, m)).filter(|wi| wi.z > 0.0)?
            } else {
                refract(up, m, eta).filter(|wi| wi.z < 0.0)?
            }
        };
        let mut sample = BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))?;
        if wi.z < 0.0 {
            sample.eta = eta;
        }
        Some(sample)
    }
}

impl RoughGlass {
    /// Directional albedo as flux, with the reflectance of the mean visible facet.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let eta = self.eta_towards(wo);
        let lost = self.lost(wo.z, eta);
        let typical = typical_reflectance(wo.z.abs(), self.ggx.alpha(), eta);
        let r = (1.0 - lost) * typical + lost * (1.0 - self.sides(eta).2);
        let albedo = Vec3::splat(r) + self.color * (1.0 - r);
        if self.compensated {
            albedo
        } else {
            albedo * solid_albedo(wo.z.abs(), self.ggx.alpha(), eta).clamp(0.0, 1.0)
        }
    }
}

/// A rough thin sheet: facets reflect, and what they do not reflect leaves mirrored on the other side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughThinGlass {
    /// Tint of what passes.
    pub color: Vec3,
    /// Reflectance at normal incidence.
    pub f0: Vec3,
    /// Reflectance at grazing incidence.
    pub f90: f32,
    /// The facets.
    pub ggx: Ggx,
    /// Whether what single scattering loses is added back.
    pub compensated: bool,
}

impl RoughThinGlass {
    /// Share of light lost by single scattering that is added back.
    fn lost(&self, cos: f32) -> f32 {
        if !self.compensated {
            return 0.0;
        }
        let (base, edge) = schlick_albedo(cos, self.ggx.alpha());
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// Probability of the reflected side for a facet under this cosine.
    fn reflection_probability(&self, cos: f32) -> f32 {
        let r = schlick(self.f0, self.f90, cos);
        let (wr, wt) = (r.max_element(), (self.color * (Vec3::ONE - r)).max_element());
        if wr + wt > 0.0 { wr / (wr + wt) } else { 1.0 }
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let passes = wi.z < 0.0;
        let wi = Vec3::new(wi.x, wi.y, wi.z.abs());
        let (f, pdf, cos) = self.ggx.reflection(wo, wi);
        let (lost, lost_i) = (self.lost(wo.z), self.lost(wi.z));
        let (base, edge) = schlick_mean(self.ggx.alpha());
        let mean_lost = 1.0 - base - edge;
        let cosine = wi.z * INV_PI;
        // Light of several facets leaves to both sides alike.
        let multiple = if mean_lost > 0.0 {
            0.5 * lost * lost_i / mean_lost * cosine
        } else {
            0.0
        };
        let r = schlick(self.f0, self.f90, cos);
        let p = self.reflection_probability(cos);
        let (value, p) = if passes {
            (self.color * ((Vec3::ONE - r) * f + multiple), 1.0 - p)
        } else {
            (r * f + multiple, p)
        };
        (value, (1.0 - lost) * p * pdf + 0.5 * lost * cosine)
    }

    /// A visible facet's mirror direction on either side, or a cosine lobe by the share lost.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let (up, _) = facing_up(wo, wo);
        let lost = self.lost(up.z);
        let wi = if u_lobe < lost {
            sample_cosine_beside(if u_lobe < 0.5 * lost { -up } else { up }, u)
        } else {
            let m = self.ggx.sample_visible(up, u);
            let wi = Some(reflect(up, m)).filter(|wi| wi.z > 0.0)?;
            if u_lobe - lost < (1.0 - lost) * self.reflection_probability(up.dot(m)) {
                wi
            } else {
                Vec3::new(wi.x, wi.y, -wi.z)
            }
        };
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let (base, edge) = schlick_albedo(wo.z.abs(), self.ggx.alpha());
        let lost = self.lost(wo.z.abs());
        let r = self.f0 * base + Vec3::splat(self.f90 * edge);
        let hidden = (1.0 - base - edge).clamp(0.0, 1.0);
        let passes = Vec3::splat(1.0 - hidden) - r;
        r + self.color * passes + (Vec3::ONE + self.color) * (0.5 * lost)
    }
}
