//! Frosted dielectrics: the boundary of a solid, and the thin sheet.

use super::diffuse::sample_cosine_beside;
use super::energy::{facets_albedo, facets_mean, solid_albedo, solid_mean, typical_reflectance};
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
        let share = |cos| {
            let r = self.fresnel.reflectance(cos, eta);
            (Vec3::splat(r), r)
        };
        self.eval_pdf_by(wo, wi, share, Vec3::ONE)
    }

    /// The same with facets of which `share` tells the reflectance under a cosine, and with which probability it is chosen;
    /// what they lose is added back times `tint`.
    #[inline(always)]
    pub(super) fn eval_pdf_by(
        &self,
        wo: Vec3,
        wi: Vec3,
        share: impl Fn(f32) -> (Vec3, f32),
        tint: Vec3,
    ) -> (Vec3, f32) {
        let eta = self.eta_towards(wo);
        let (wo, wi) = facing_up(wo, wi);
        if wo.z <= 0.0 || wi.z == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let lost = self.lost(wo.z, eta);
        let (here, beyond, crossing) = self.sides(eta);
        let cosine = wi.z.abs() * INV_PI;
        if wi.z > 0.0 {
            let (f, pdf, cos) = self.ggx.reflection(wo, wi);
            let (r, p) = share(cos);
            let multiple = if here > 0.0 {
                (1.0 - crossing) * lost * self.lost(wi.z, eta) / here
            } else {
                0.0
            };
            return (
                r * f + tint * (multiple * cosine),
                (1.0 - lost) * p * pdf + lost * (1.0 - crossing) * cosine,
            );
        }
        let (f, pdf) = self.transmission(wo, wi, eta, share);
        let multiple = if beyond > 0.0 {
            crossing * lost * self.lost(wi.z, 1.0 / eta) / beyond
        } else {
            0.0
        };
        (
            self.color * (f + tint * (multiple * cosine / (eta * eta))),
            (1.0 - lost) * pdf + lost * crossing * cosine,
        )
    }

    /// Single-scattering transmission: radiance factor f·|cosθi|, and the density given that facets scatter.
    #[inline(always)]
    fn transmission(&self, wo: Vec3, wi: Vec3, eta: f32, share: impl Fn(f32) -> (Vec3, f32)) -> (Vec3, f32) {
        let Some(m) = try_normalize(wo + wi * eta) else {
            return (Vec3::ZERO, 0.0);
        };
        let m = if m.z < 0.0 { -m } else { m };
        let (om, im) = (wo.dot(m), wi.dot(m));
        if !(om > 0.0 && im < 0.0) {
            return (Vec3::ZERO, 0.0);
        }
        let (r, p) = share(om);
        let (t, p) = (Vec3::ONE - r, 1.0 - p);
        let denominator = im + om / eta;
        let jacobian = -im / (denominator * denominator);
        let d = self.ggx.d(m);
        let f = t * d * self.ggx.g2_over_cosine(wo, wi) * om * jacobian / (eta * eta);
        (f, p * self.ggx.pdf_visible(wo, m) * jacobian)
    }

    /// A visible facet, then its reflection or refraction; or, by the share lost, a cosine lobe of either side.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let eta = self.eta_towards(wo);
        let wi = self.choose(wo, u, u_lobe, |cos| self.fresnel.reflectance(cos, eta))?;
        let mut sample = BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))?;
        if wi.z < 0.0 {
            sample.eta = eta;
        }
        Some(sample)
    }

    /// The direction that a view, mirrored to above, leads to; `probability` is that of reflection at a facet.
    #[inline(always)]
    pub(super) fn choose(&self, wo: Vec3, u: Vec2, u_lobe: f32, probability: impl Fn(f32) -> f32) -> Option<Vec3> {
        let eta = self.eta_towards(wo);
        let (up, _) = facing_up(wo, wo);
        let lost = self.lost(up.z, eta);
        Some(if u_lobe < lost {
            let beyond = u_lobe < lost * self.sides(eta).2;
            sample_cosine_beside(if beyond { -up } else { up }, u)
        } else {
            let m = self.ggx.sample_visible(up, u);
            if u_lobe - lost < (1.0 - lost) * probability(up.dot(m).max(0.0)) {
                Some(reflect(up, m)).filter(|wi| wi.z > 0.0)?
            } else {
                refract(up, m, eta).filter(|wi| wi.z < 0.0)?
            }
        })
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
    fn lost(&self, w: Vec3) -> f32 {
        if !self.compensated {
            return 0.0;
        }
        let (base, edge) = facets_albedo(self.ggx, w);
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// Probability of the reflected side for a facet of this reflectance.
    fn reflection_probability(&self, r: Vec3) -> f32 {
        let (wr, wt) = (r.max_element(), (self.color * (Vec3::ONE - r)).max_element());
        if wr + wt > 0.0 { wr / (wr + wt) } else { 1.0 }
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval_pdf_by(wo, wi, |cos| schlick(self.f0, self.f90, cos))
    }

    /// The same of facets that reflect by another curve.
    #[inline(always)]
    pub(super) fn eval_pdf_by(&self, wo: Vec3, wi: Vec3, curve: impl Fn(f32) -> Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let passes = wi.z < 0.0;
        let wi = Vec3::new(wi.x, wi.y, wi.z.abs());
        let (f, pdf, cos) = self.ggx.reflection(wo, wi);
        let (lost, lost_i) = (self.lost(wo), self.lost(wi));
        let (base, edge) = facets_mean(self.ggx);
        let mean_lost = 1.0 - base - edge;
        let cosine = wi.z * INV_PI;
        // Light of several facets leaves to both sides alike.
        let multiple = if mean_lost > 0.0 {
            0.5 * lost * lost_i / mean_lost * cosine
        } else {
            0.0
        };
        let r = curve(cos);
        let p = self.reflection_probability(r);
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
        let wi = self.choose(up, u, u_lobe, |cos| schlick(self.f0, self.f90, cos))?;
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
    }

    /// The direction that a view from above leads to.
    #[inline(always)]
    pub(super) fn choose(&self, up: Vec3, u: Vec2, u_lobe: f32, curve: impl Fn(f32) -> Vec3) -> Option<Vec3> {
        let lost = self.lost(up);
        Some(if u_lobe < lost {
            sample_cosine_beside(if u_lobe < 0.5 * lost { -up } else { up }, u)
        } else {
            let m = self.ggx.sample_visible(up, u);
            let wi = Some(reflect(up, m)).filter(|wi| wi.z > 0.0)?;
            if u_lobe - lost < (1.0 - lost) * self.reflection_probability(curve(up.dot(m))) {
                wi
            } else {
                Vec3::new(wi.x, wi.y, -wi.z)
            }
        })
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let (base, edge) = facets_albedo(self.ggx, wo);
        let lost = self.lost(wo);
        let r = self.f0 * base + Vec3::splat(self.f90 * edge);
        let hidden = (1.0 - base - edge).clamp(0.0, 1.0);
        let passes = Vec3::splat(1.0 - hidden) - r;
        r + self.color * passes + (Vec3::ONE + self.color) * (0.5 * lost)
    }
}
