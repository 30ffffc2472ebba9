//! Diffuse surfaces: Lambert, and the rough one of Oren and Nayar.

use super::{BsdfSample, on_same_side};
use crate::math::portable::acos;
use crate::math::robust::sqrt_of_nonnegative;
use crate::math::warp::{INV_PI, cosine_hemisphere};
use glam::{Vec2, Vec3};

/// A direction on the side of `wo` with density |cos|/π.
pub(super) fn sample_cosine_beside(wo: Vec3, u: Vec2) -> Vec3 {
    let wi = cosine_hemisphere(u);
    Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z))
}

/// Lambert's surface: the same radiance in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// Share of light reflected, [0, 1] per channel.
    pub albedo: Vec3,
}

impl Diffuse {
    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        if !on_same_side(wo, wi) {
            return (Vec3::ZERO, 0.0);
        }
        let pdf = wi.z.abs() * INV_PI;
        (self.albedo * pdf, pdf)
    }

    /// A direction by the cosine; its weight is the albedo itself.
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        let wi = sample_cosine_beside(wo, u);
        let pdf = wi.z.abs() * INV_PI;
        (pdf > 0.0).then(|| BsdfSample::smooth(wi, self.albedo, pdf))
    }
}

/// A diffuse surface of rough facets: flatter than Lambert's, brighter back towards the light.
///
/// The energy-preserving Oren–Nayar model: f = ρ/π·A·(1 + r·s/t) plus a term for light that left after several facets,
/// so that white stays white. Source: Portsmouth, Kutz & Hill, EON, JCGT 2025 (the single-scattering part is Fujii's).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    /// Colour of a facet, [0, 1] per channel.
    pub albedo: Vec3,
    /// Slope of the directional part, [0, 1]; 0 is Lambert.
    pub r: f32,
}

impl OrenNayar {
    /// From Oren and Nayar's σ in radians. Our `r` is the ratio B/A of their "qualitative" model at this σ.
    pub fn from_sigma(albedo: Vec3, sigma: f32) -> OrenNayar {
        let s2 = sigma * sigma;
        if s2.is_nan() || s2.is_infinite() {
            return OrenNayar {
                albedo,
                r: if s2.is_nan() { 0.0 } else { 0.9 },
            }; // the limit for σ → ∞
        }
        let a = 1.0 - 0.5 * s2 / (s2 + 0.33);
        let b = 0.45 * s2 / (s2 + 0.09);
        OrenNayar { albedo, r: b / a }
    }

    /// A of the model: what keeps the single-scattering albedo at 1 for a grazing view.
    fn scale(&self) -> f32 {
        const C1: f32 = 0.5 - 2.0 / (3.0 * std::f32::consts::PI);
        1.0 / (1.0 + C1 * self.r)
    }

    /// Albedo of white facets, single scattering, seen under this cosine.
    fn albedo_single(&self, cos: f32) -> f32 {
        let sin = sqrt_of_nonnegative((1.0 - cos) * (1.0 + cos));
        // tanθ·(1 − sin³θ), without the pole at grazing
        let tan_term = sin * cos * (1.0 + sin + sin * sin) / (1.0 + sin);
        let g = sin * (acos(cos) - sin * cos - 2.0 / 3.0) + 2.0 / 3.0 * tan_term;
        self.scale() * (1.0 + self.r * INV_PI * g)
    }

    /// Mean of [`OrenNayar::albedo_single`] over views.
    fn mean_single(&self) -> f32 {
        const C2: f32 = 2.0 / 3.0 - 28.0 / (15.0 * std::f32::consts::PI);
        self.scale() * (1.0 + C2 * self.r)
    }

    /// Colour of light that left after several facets.
    fn multiple_tint(&self) -> Vec3 {
        let mean = self.mean_single();
        self.albedo * self.albedo * mean / (Vec3::ONE - self.albedo * (1.0 - mean))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let single = self.albedo_single(wo.z.abs());
        self.albedo * single + self.multiple_tint() * (1.0 - single).max(0.0)
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        if !on_same_side(wo, wi) {
            return (Vec3::ZERO, 0.0);
        }
        let (co, ci) = (wo.z.abs(), wi.z.abs());
        let pdf = ci * INV_PI;
        let s = wo.x * wi.x + wo.y * wi.y;
        let s_over_t = if s > 0.0 { s / co.max(ci) } else { s };
        let single = self.scale() * (1.0 + self.r * s_over_t);
        let lost = 1.0 - self.mean_single();
        let multiple = if lost > 0.0 {
            (1.0 - self.albedo_single(co)).max(0.0) * (1.0 - self.albedo_single(ci)).max(0.0) / lost
        } else {
            0.0
        };
        ((self.albedo * single + self.multiple_tint() * multiple) * pdf, pdf)
    }

    /// A direction by the cosine.
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        BsdfSample::from_eval(sample_cosine_beside(wo, u), |wi| self.eval_pdf(wo, wi))
    }
}

/// A thin sheet: part of the light leaves on the side it came from, part on the other, both evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translucent {
    /// Albedo of the lit side.
    pub front: Vec3,
    /// Albedo of the far side; `front + back` ≤ 1.
    pub back: Vec3,
}

impl Translucent {
    /// Probability that the far side is sampled.
    fn back_probability(&self) -> f32 {
        let (f, b) = (self.front.max_element(), self.back.max_element());
        if f + b > 0.0 { b / (f + b) } else { 0.0 }
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let c = wi.z.abs() * INV_PI;
        let p = self.back_probability();
        if on_same_side(wo, wi) {
            (self.front * c, (1.0 - p) * c)
        } else {
            (self.back * c, p * c)
        }
    }

    /// A direction by the cosine, on a side chosen by its albedo.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let towards = if u_lobe < self.back_probability() { -wo } else { wo };
        BsdfSample::from_eval(sample_cosine_beside(towards, u), |wi| self.eval_pdf(wo, wi))
    }
}
