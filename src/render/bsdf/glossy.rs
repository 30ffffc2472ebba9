//! A dielectric coat over a diffuse base: plastic, varnish, polished stone.
//!
//! What the coat does not reflect reaches the base and leaves it again:
//! f_base = ρ/π·(1−E(wo))·(1−E(wi))/(1−Ē), with E the coat's albedo and Ē its mean over views. For a white base the
//! whole is lossless at every view, and it is symmetric in its directions. E counts what several facets reflect too: a
//! bright rough coat keeps its own colour, and the base below it stays hidden.

use super::diffuse::sample_cosine_beside;
use super::energy::{coat_albedo, coat_mean, facets_albedo, facets_mean, fresnel_mean};
use super::fresnel::{fresnel_dielectric, reflect, schlick};
use super::metal::Metal;
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
}

/// What facets reflect at once by Schlick's curve, from the albedos of its two ends, and the share of light that white ones
/// would not: it meets further facets.
fn of_ends(f0: Vec3, f90: f32, (base, edge): (f32, f32)) -> (Vec3, f32) {
    let lost = (1.0 - base - edge).clamp(0.0, 1.0);
    (f0 * base + Vec3::splat(f90 * edge), lost)
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

/// What a coat takes from the light along a direction.
struct Taken {
    /// Reflected by one facet.
    single: Vec3,
    /// Reflected by several facets.
    several: Vec3,
    /// Share that white facets would not reflect at once.
    lost: f32,
    /// Share that does not reach the base, by the brightest channel.
    all: f32,
}

impl Glossy {
    /// Colour of the light that several facets reflect, over the mean loss: once more tinted for each further facet, as in
    /// a metal. An exact dielectric has none: at an index of 1.5 its share stays below half a percent, and the base gets it.
    fn several_over_lost(&self, mean_lost: f32) -> Vec3 {
        match self.coat {
            Coat::Schlick { f0, f90 } if self.compensated => {
                Metal::multiple_over_lost(f0 + (Vec3::splat(f90) - f0) / 21.0, mean_lost)
            }
            _ => Vec3::ZERO,
        }
    }

    fn taken(&self, (single, lost): (Vec3, f32), mean_lost: f32, several: Vec3) -> Taken {
        let several = several * (lost * mean_lost);
        let nobody = if self.compensated { 0.0 } else { lost };
        Taken {
            single,
            several,
            lost,
            all: (single + several).max_element().clamp(0.0, 1.0) + nobody,
        }
    }

    /// What one facet reflects, seen along `w`, and the share that white facets would lose so.
    fn seen(&self, w: Vec3) -> (Vec3, f32) {
        match self.coat {
            Coat::Schlick { f0, f90 } => of_ends(f0, f90, facets_albedo(self.ggx, w)),
            Coat::Dielectric { eta } => {
                let single = coat_albedo(w.z.abs(), self.ggx.alpha(), eta);
                self.exact(single, || facets_albedo(self.ggx, w))
            }
        }
    }

    /// Means of [`Glossy::seen`] over views.
    fn mean(&self) -> (Vec3, f32) {
        match self.coat {
            Coat::Schlick { f0, f90 } => of_ends(f0, f90, facets_mean(self.ggx)),
            Coat::Dielectric { eta } => self.exact(coat_mean(self.ggx.alpha(), eta), || facets_mean(self.ggx)),
        }
    }

    /// An exact dielectric's albedo with what white facets lose, which counts only where nobody gets it.
    fn exact(&self, single: f32, ends: impl Fn() -> (f32, f32)) -> (Vec3, f32) {
        let lost = match self.compensated {
            true => 0.0,
            false => of_ends(Vec3::ONE, 1.0, ends()).1,
        };
        (Vec3::splat(single), lost)
    }

    /// Shares of sampling along a view: (coat, even light in front, behind), adding up to 1 unless nothing scatters.
    fn shares(&self, taken: &Taken) -> (f32, f32, f32) {
        let coat = taken.single.max_element().clamp(0.0, 1.0);
        let left = (1.0 - taken.all).max(0.0);
        let front = taken.several.max_element() + left * self.base.max_element();
        let back = left * self.back.max_element();
        let sum = coat + front + back;
        if sum > 0.0 {
            (coat / sum, front / sum, back / sum)
        } else {
            (0.0, 0.0, 0.0)
        }
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let mean = self.mean();
        let several = self.several_over_lost(mean.1);
        let [o, i, mean] = [self.seen(wo), self.seen(wi), mean].map(|seen| self.taken(seen, mean.1, several));
        let (coat, front, back) = self.shares(&o);
        let cosine = wi.z.abs() * INV_PI;
        let base = base_factor(o.all, i.all, mean.all) * cosine;
        if wi.z > 0.0 {
            let (f, pdf, cos) = self.ggx.reflection(wo, wi);
            let even = several * (o.lost * i.lost * cosine) + self.base * base;
            (self.coat.reflectance(cos) * f + even, coat * pdf + front * cosine)
        } else {
            (self.back * base, back * cosine)
        }
    }

    /// A visible facet's mirror direction, or one by the cosine on either side.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let (up, _) = facing_up(wo, wo);
        let (_, mean_lost) = self.mean();
        let taken = self.taken(self.seen(up), mean_lost, self.several_over_lost(mean_lost));
        let (coat, front, _) = self.shares(&taken);
        let wi = if u_lobe < coat {
            reflect(up, self.ggx.sample_visible(up, u))
        } else if u_lobe < coat + front {
            sample_cosine_beside(up, u)
        } else {
            sample_cosine_beside(-up, u)
        };
        if u_lobe < coat && wi.z <= 0.0 {
            return None; // the facet's light meets another facet; the even lobe carries it
        }
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let (_, mean_lost) = self.mean();
        let taken = self.taken(self.seen(wo), mean_lost, self.several_over_lost(mean_lost));
        taken.single + taken.several + (self.base + self.back) * (1.0 - taken.all).max(0.0)
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
