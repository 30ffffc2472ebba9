//! Rough conductors.

use super::diffuse::sample_cosine_beside;
use super::energy::{facets_albedo, facets_mean};
use super::fresnel::{reflect, schlick};
use super::microfacet::Ggx;
use super::{BsdfSample, facing_up, with_side_of};
use crate::math::warp::INV_PI;
use glam::{Vec2, Vec3};

/// GGX facets of a conductor: tinted at normal incidence, rising to white by Schlick's curve.
///
/// Light that meets several facets is added as a cosine-like lobe (Kulla & Conty 2017), so a white rough metal loses
/// nothing; it takes the facets' mean colour once per further bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Reflectance at normal incidence.
    pub f0: Vec3,
    /// The facets.
    pub ggx: Ggx,
    /// Whether what single scattering loses is added back.
    pub compensated: bool,
}

impl Metal {
    /// Share of light that a single scattering loses and that is added back, seen along `w`.
    fn lost(&self, w: Vec3) -> f32 {
        if !self.compensated {
            return 0.0;
        }
        let (base, edge) = facets_albedo(self.ggx, w);
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// Mean reflectance over the hemisphere: of Schlick's curve.
    fn mean(&self) -> Vec3 {
        self.f0 + (Vec3::ONE - self.f0) / 21.0
    }

    /// Colour of the lobe of several bounces divided by the mean loss; `mean` is the facets' reflectance over the hemisphere.
    pub(super) fn multiple_over_lost(mean: Vec3, mean_lost: f32) -> Vec3 {
        if mean_lost <= 0.0 {
            return Vec3::ZERO;
        }
        mean * mean * (1.0 - mean_lost) / ((Vec3::ONE - mean * mean_lost) * mean_lost)
    }

    fn mean_lost(&self) -> f32 {
        let (base, edge) = facets_mean(self.ggx);
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval_pdf_by(wo, wi, |cos| schlick(self.f0, 1.0, cos), self.mean())
    }

    /// The same of facets that reflect by another curve, of this mean over the hemisphere.
    #[inline(always)]
    pub(super) fn eval_pdf_by(&self, wo: Vec3, wi: Vec3, curve: impl Fn(f32) -> Vec3, mean: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let (f, pdf, cos) = self.ggx.reflection(wo, wi);
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return (Vec3::ZERO, 0.0);
        }
        let lost = self.lost(wo);
        let cosine = wi.z * INV_PI;
        let multiple = Metal::multiple_over_lost(mean, self.mean_lost()) * (lost * self.lost(wi) * cosine);
        (curve(cos) * f + multiple, (1.0 - lost) * pdf + lost * cosine)
    }

    /// A visible facet's mirror direction, or, by the share of light lost, one by the cosine.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let (up, _) = facing_up(wo, wo);
        let wi = self.choose(up, u, u_lobe);
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
    }

    /// The direction that a view from above leads to.
    #[inline(always)]
    pub(super) fn choose(&self, up: Vec3, u: Vec2, u_lobe: f32) -> Vec3 {
        if u_lobe < self.lost(up) {
            sample_cosine_beside(up, u)
        } else {
            reflect(up, self.ggx.sample_visible(up, u))
        }
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let (base, edge) = facets_albedo(self.ggx, wo);
        let mean_lost = self.mean_lost();
        self.f0 * base
            + Vec3::splat(edge)
            + Metal::multiple_over_lost(self.mean(), mean_lost) * (self.lost(wo) * mean_lost)
    }
}
