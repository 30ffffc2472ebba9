//! Rough conductors.

use super::diffuse::sample_cosine_beside;
use super::energy::{schlick_albedo, schlick_mean};
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
    /// Share of light that a single scattering loses and that is added back, seen under this cosine.
    fn lost(&self, cos: f32) -> f32 {
        if !self.compensated {
            return 0.0;
        }
        let (base, edge) = schlick_albedo(cos, self.ggx.alpha());
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// Colour of the lobe of several bounces divided by the mean loss.
    fn multiple_over_lost(&self, mean_lost: f32) -> Vec3 {
        if mean_lost <= 0.0 {
            return Vec3::ZERO;
        }
        let mean = self.f0 + (Vec3::ONE - self.f0) / 21.0; // of Schlick's curve over the hemisphere
        mean * mean * (1.0 - mean_lost) / ((Vec3::ONE - mean * mean_lost) * mean_lost)
    }

    fn mean_lost(&self) -> f32 {
        let (base, edge) = schlick_mean(self.ggx.alpha());
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let (f, pdf, cos) = self.ggx.reflection(wo, wi);
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return (Vec3::ZERO, 0.0);
        }
        let lost = self.lost(wo.z);
        let cosine = wi.z * INV_PI;
        let multiple = self.multiple_over_lost(self.mean_lost()) * (lost * self.lost(wi.z) * cosine);
        (
            schlick(self.f0, 1.0, cos) * f + multiple,
            (1.0 - lost) * pdf + lost * cosine,
        )
    }

    /// A visible facet's mirror direction, or, by the share of light lost, one by the cosine.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let (up, _) = facing_up(wo, wo);
        let wi = if u_lobe < self.lost(up.z) {
            sample_cosine_beside(up, u)
        } else {
            reflect(up, self.ggx.sample_visible(up, u))
        };
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let (base, edge) = schlick_albedo(wo.z.abs(), self.ggx.alpha());
        let mean_lost = self.mean_lost();
        self.f0 * base + Vec3::splat(edge) + self.multiple_over_lost(mean_lost) * (self.lost(wo.z.abs()) * mean_lost)
    }
}
