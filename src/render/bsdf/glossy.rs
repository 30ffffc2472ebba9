//! A dielectric coat over a diffuse base: plastic, varnish, polished stone.
//!
//! What the coat does not reflect reaches the base and leaves it again:
//! f_base = ρ/π·(1−E(wo))·(1−E(wi))/(1−Ē), with E the coat's albedo and Ē its mean over views. For a white base the
//! whole is lossless at every view, and it is symmetric in its directions.

use super::diffuse::sample_cosine_beside;
use super::energy::{coat_albedo, coat_mean, facets_albedo, facets_mean, fresnel_mean};
use super::fresnel::{fresnel_dielectric, reflect, schlick};
use super::microfacet::Ggx;
use super::specular::mirrored;
use super::{BsdfSample, facing_up, with_side_of};
use crate::math::warp::INV_PI;
use glam::{Vec2, Vec3};

/// How the coat's facets reflect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coat {
    /// Exact Fresnel for this relative index, ≥ 1.
    Dielectric {
        /// n_coat / n_outside; an infinite one reflects all.
        eta: f32,
    },
    /// Schlick's curve, as glTF writes it.
    Schlick {
        /// Reflectance at normal incidence.
        f0: Vec3,
        /// Reflectance at grazing incidence.
        f90: f32,
    },
}

impl Coat {
    /// Reflectance of a facet under this cosine.
    pub fn reflectance(&self, cos: f32) -> Vec3 {
        match *self {
            Coat::Dielectric { eta } => Vec3::splat(fresnel_dielectric(cos, eta)),
            Coat::Schlick { f0, f90 } => schlick(f0, f90, cos),
        }
    }

    /// Directional albedo of rough facets, seen along `w`.
    fn albedo(&self, w: Vec3, ggx: Ggx) -> Vec3 {
        match *self {
            Coat::Dielectric { eta } => Vec3::splat(coat_albedo(w.z.abs(), ggx.alpha(), eta)),
            Coat::Schlick { f0, f90 } => {
                let (base, edge) = facets_albedo(ggx, w);
                f0 * base + Vec3::splat(f90 * edge)
            }
        }
    }

    /// Mean of [`Coat::albedo`] over views.
    fn mean(&self, ggx: Ggx) -> Vec3 {
        match *self {
            Coat::Dielectric { eta } => Vec3::splat(coat_mean(ggx.alpha(), eta)),
            Coat::Schlick { f0, f90 } => {
                let (base, edge) = facets_mean(ggx);
                f0 * base + Vec3::splat(f90 * edge)
            }
        }
    }
}

/// The base under a coat that reflects `eo`, `ei` and `mean` (by their brightest channels): (front, back) of f·cosθi
/// over the cosine density.
fn base_factor(eo: f32, ei: f32, mean: f32) -> f32 {
    if mean < 1.0 {
        (1.0 - eo).max(0.0) * (1.0 - ei).max(0.0) / (1.0 - mean)
    } else {
        0.0
    }
}

/// Shares of sampling: (coat, base in front, base behind), adding up to 1 unless nothing scatters.
fn shares(coat: f32, base: Vec3, back: Vec3) -> (f32, f32, f32) {
    let (f, b) = ((1.0 - coat) * base.max_element(), (1.0 - coat) * back.max_element());
    let sum = coat + f + b;
    if sum > 0.0 {
        (coat / sum, f / sum, b / sum)
    } else {
        (0.0, 0.0, 0.0)
    }
}

/// A rough coat over a diffuse base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glossy {
    /// Albedo of the base, reflected.
    pub base: Vec3,
    /// Albedo of the base, leaving on the far side of a thin sheet; usually zero.
    pub back: Vec3,
    /// The coat's reflectance.
    pub coat: Coat,
    /// The coat's facets.
    pub ggx: Ggx,
    /// Whether the base gets what the facets hide from one another. Without it the base gets what the coat does not
    /// reflect of that which white facets would scatter at once.
    pub compensated: bool,
}

impl Glossy {
    /// Share of light that facets hide from one another and nobody gets, seen along `w`.
    fn lost(&self, w: Vec3) -> f32 {
        if self.compensated {
            return 0.0;
        }
        let (base, edge) = facets_albedo(self.ggx, w);
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    /// Mean of [`Glossy::lost`] over views.
    fn mean_lost(&self) -> f32 {
        if self.compensated {
            return 0.0;
        }
        let (base, edge) = facets_mean(self.ggx);
        (1.0 - base - edge).clamp(0.0, 1.0)
    }

    fn coat_albedo(&self, w: Vec3) -> f32 {
        self.coat.albedo(w, self.ggx).max_element().clamp(0.0, 1.0)
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let eo = self.coat_albedo(wo);
        let (coat, front, back) = shares(eo, self.base, self.back);
        let cosine = wi.z.abs() * INV_PI;
        let mut mean = self.coat.mean(self.ggx).max_element();
        let (mut eo, mut ei) = (eo, self.coat_albedo(wi));
        if !self.compensated {
            mean += self.mean_lost();
            eo += self.lost(wo);
            ei += self.lost(wi);
        }
        let base = base_factor(eo, ei, mean) * cosine;
        if wi.z > 0.0 {
            let (f, pdf, cos) = self.ggx.reflection(wo, wi);
            let value = self.coat.reflectance(cos) * f + self.base * base;
            (value, coat * pdf + front * cosine)
        } else {
            (self.back * base, back * cosine)
        }
    }

    /// A visible facet's mirror direction, or one by the cosine on either side.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let (up, _) = facing_up(wo, wo);
        let (coat, front, _) = shares(self.coat_albedo(up), self.base, self.back);
        let wi = if u_lobe < coat {
            reflect(up, self.ggx.sample_visible(up, u))
        } else if u_lobe < coat + front {
            sample_cosine_beside(up, u)
        } else {
            sample_cosine_beside(-up, u)
        };
        if u_lobe < coat && wi.z <= 0.0 {
            return None; // the facet's light meets another facet; the base lobe carries it
        }
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let e = self.coat.albedo(wo, self.ggx);
        e + (self.base + self.back) * (1.0 - e.max_element() - self.lost(wo)).max(0.0)
    }
}

/// A smooth coat over a diffuse base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothCoat {
    /// Albedo of the base, reflected.
    pub base: Vec3,
    /// Albedo of the base, leaving on the far side of a thin sheet; usually zero.
    pub back: Vec3,
    /// The coat's reflectance.
    pub coat: Coat,
}

impl SmoothCoat {
    fn mean(&self) -> f32 {
        match self.coat {
            Coat::Dielectric { eta } => fresnel_mean(eta),
            Coat::Schlick { f0, f90 } => (f0 + (Vec3::splat(f90) - f0) / 21.0).max_element(),
        }
    }

    fn reflectance(&self, cos: f32) -> f32 {
        self.coat.reflectance(cos).max_element().clamp(0.0, 1.0)
    }

    /// f·|cosθi| and the density of `wi`, of the base.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let eo = self.reflectance(wo.z);
        let (_, front, back) = shares(eo, self.base, self.back);
        let cosine = wi.z.abs() * INV_PI;
        let base = base_factor(eo, self.reflectance(wi.z.abs()), self.mean()) * cosine;
        if wi.z > 0.0 {
            (self.base * base, front * cosine)
        } else {
            (self.back * base, back * cosine)
        }
    }

    /// The mirror direction, or one by the cosine on either side.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let r = self.coat.reflectance(wo.z.abs());
        let (coat, front, _) = shares(r.max_element().clamp(0.0, 1.0), self.base, self.back);
        if u_lobe < coat {
            return Some(BsdfSample::delta(mirrored(wo), r / coat, coat));
        }
        let towards = if u_lobe < coat + front { wo } else { -wo };
        BsdfSample::from_eval(sample_cosine_beside(towards, u), |wi| self.eval_pdf(wo, wi))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let r = self.coat.reflectance(wo.z.abs());
        r + (self.base + self.back) * (1.0 - r.max_element()).max(0.0)
    }
}
