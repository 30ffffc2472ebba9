//! How a surface scatters light at one point: a closed set of models with one contract.
//!
//! Directions are unit vectors in the local frame whose +z axis is the shading normal on the outside; `wo` (to the
//! viewer) and `wi` (to the light) both point away from the surface. `wo.z < 0` is a view from the inside or the back:
//! reflecting models treat both sides alike, dielectric solids have their inside at −z.
//!
//! - [`Bsdf::eval`] is f(wo, wi)·|cosθi|, zero for delta lobes; [`Bsdf::pdf`] agrees with [`Bsdf::sample`], misses
//!   (`None`) included, which count as samples of value zero.
//! - Smooth and rough are different variants, decided once by [`microfacet::ALPHA_DELTA`].
//! - Radiance is transported: refraction into an index η times higher divides by η².
//! - Rough lobes lose nothing to masking: see [`energy`].

pub mod diffuse;
pub mod energy;
pub mod film;
pub mod finish;
pub mod fresnel;
pub mod glossy;
pub mod iridescent;
pub mod metal;
pub mod microfacet;
pub mod principled;
pub mod rough_glass;
pub mod sheen;
pub mod specular;
#[cfg(test)]
mod tests;

use diffuse::{Diffuse, OrenNayar, Translucent};
use finish::Finish;
use glam::{Vec2, Vec3};
use glossy::{Glossy, SmoothCoat};
use iridescent::Iridescent;
use metal::Metal;
use principled::Principled;
use rough_glass::{RoughGlass, RoughThinGlass};
use specular::{Glass, Specular, ThinGlass};

/// Scattering at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Scatters nothing.
    Black,
    /// Lambert.
    Diffuse(Diffuse),
    /// Rough diffuse.
    OrenNayar(OrenNayar),
    /// Mirror.
    Specular(Specular),
    /// Smooth dielectric solid.
    Glass(Glass),
    /// Smooth thin sheet.
    ThinGlass(ThinGlass),
    /// Rough dielectric solid.
    RoughGlass(RoughGlass),
    /// Rough thin sheet.
    RoughThinGlass(RoughThinGlass),
    /// Rough coat over a diffuse base.
    Glossy(Glossy),
    /// Smooth coat over a diffuse base.
    SmoothCoat(SmoothCoat),
    /// Rough conductor.
    Metal(Metal),
    /// Thin diffuse sheet.
    Translucent(Translucent),
    /// A thin film over one of the others.
    Iridescent(Iridescent),
    /// Clearcoat and sheen over another model.
    Principled(Principled),
    /// POV-Ray's finish.
    Finish(Finish),
}

/// A direction that a BSDF chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Towards the light.
    pub wi: Vec3,
    /// f·|cosθi|/pdf.
    pub weight: Vec3,
    /// Density of `wi` over all lobes, in 1/sr; for a delta lobe the probability that it was chosen.
    pub pdf: f32,
    /// Whether the lobe is a single direction.
    pub delta: bool,
    /// n_t/n_i whose square `weight` was divided by; 1 unless refracted. Russian roulette multiplies it back.
    pub eta: f32,
    /// Whether the path goes on unbent through a thin surface, as if through a hole.
    pub straight: bool,
}

impl BsdfSample {
    fn smooth(wi: Vec3, weight: Vec3, pdf: f32) -> BsdfSample {
        BsdfSample {
            wi,
            weight,
            pdf,
            delta: false,
            eta: 1.0,
            straight: false,
        }
    }

    fn delta(wi: Vec3, weight: Vec3, pdf: f32) -> BsdfSample {
        BsdfSample {
            wi,
            weight,
            pdf,
            delta: true,
            eta: 1.0,
            straight: false,
        }
    }

    /// A sample of a smooth lobe with the weight that `eval_pdf` gives; `None` where it has no density.
    fn from_eval(wi: Vec3, eval_pdf: impl FnOnce(Vec3) -> (Vec3, f32)) -> Option<BsdfSample> {
        let (f, pdf) = eval_pdf(wi);
        (pdf > 0.0 && pdf.is_finite()).then(|| BsdfSample::smooth(wi, f / pdf, pdf))
    }
}

/// `x` brought into [0, 1]; NaN is 0.
pub(super) fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// Whether both directions are on one side of the surface, neither in it. Compares signs: a product would underflow.
fn on_same_side(wo: Vec3, wi: Vec3) -> bool {
    (wo.z > 0.0 && wi.z > 0.0) || (wo.z < 0.0 && wi.z < 0.0)
}

/// Both directions mirrored such that `wo` is above.
fn facing_up(wo: Vec3, wi: Vec3) -> (Vec3, Vec3) {
    if wo.z < 0.0 {
        (Vec3::new(wo.x, wo.y, -wo.z), Vec3::new(wi.x, wi.y, -wi.z))
    } else {
        (wo, wi)
    }
}

/// `wi` mirrored back to where it belongs if [`facing_up`] mirrored `wo`.
fn with_side_of(wo: Vec3, wi: Vec3) -> Vec3 {
    if wo.z < 0.0 { Vec3::new(wi.x, wi.y, -wi.z) } else { wi }
}

impl Bsdf {
    /// f(wo, wi)·|cosθi| per channel, in 1/sr; zero for delta lobes: only [`Bsdf::sample`] can find those.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        self.eval_pdf(wo, wi).0
    }

    /// Density with which [`Bsdf::sample`] chooses `wi` among non-delta lobes, in 1/sr.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_pdf(wo, wi).1
    }

    /// Whether [`Bsdf::eval`] may be positive for directions on opposite sides of the surface.
    pub fn transmits(&self) -> bool {
        match self {
            Bsdf::Translucent(_) | Bsdf::RoughGlass(_) | Bsdf::RoughThinGlass(_) => true,
            Bsdf::Glossy(b) => b.back != Vec3::ZERO,
            Bsdf::SmoothCoat(b) => b.back != Vec3::ZERO,
            Bsdf::Finish(b) => b.diffuse_back != Vec3::ZERO,
            Bsdf::Iridescent(b) => b.transmits(),
            Bsdf::Principled(b) => b.base.bsdf().transmits(),
            Bsdf::Black
            | Bsdf::Diffuse(_)
            | Bsdf::OrenNayar(_)
            | Bsdf::Specular(_)
            | Bsdf::Glass(_)
            | Bsdf::ThinGlass(_)
            | Bsdf::Metal(_) => false,
        }
    }

    /// n_transmitted / n_incident of what [`Bsdf::eval`] lets across, seen along `wo`; 1 where nothing is refracted.
    pub fn eta_across(&self, wo: Vec3) -> f32 {
        match self {
            Bsdf::RoughGlass(b) => b.eta_towards(wo),
            Bsdf::Iridescent(b) => b.eta_towards(wo),
            Bsdf::Principled(b) => b.base.bsdf().eta_across(wo),
            _ => 1.0,
        }
    }

    /// [`Bsdf::eval`] and [`Bsdf::pdf`] at once.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self {
            Bsdf::Black | Bsdf::Specular(_) | Bsdf::Glass(_) | Bsdf::ThinGlass(_) => (Vec3::ZERO, 0.0),
            Bsdf::Diffuse(b) => b.eval_pdf(wo, wi),
            Bsdf::OrenNayar(b) => b.eval_pdf(wo, wi),
            Bsdf::RoughGlass(b) => b.eval_pdf(wo, wi),
            Bsdf::RoughThinGlass(b) => b.eval_pdf(wo, wi),
            Bsdf::Glossy(b) => b.eval_pdf(wo, wi),
            Bsdf::SmoothCoat(b) => b.eval_pdf(wo, wi),
            Bsdf::Metal(b) => b.eval_pdf(wo, wi),
            Bsdf::Translucent(b) => b.eval_pdf(wo, wi),
            Bsdf::Iridescent(b) => b.eval_pdf(wo, wi),
            Bsdf::Principled(b) => b.eval_pdf(wo, wi),
            Bsdf::Finish(b) => b.eval_pdf(wo, wi),
        }
    }

    /// Chooses a direction; `None` is a sample that carries nothing and still counts. `u` and `u_lobe` are in [0, 1).
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        match self {
            Bsdf::Black => None,
            Bsdf::Diffuse(b) => b.sample(wo, u),
            Bsdf::OrenNayar(b) => b.sample(wo, u),
            Bsdf::Specular(b) => b.sample(wo),
            Bsdf::Glass(b) => b.sample(wo, u_lobe),
            Bsdf::ThinGlass(b) => b.sample(wo, u_lobe),
            Bsdf::RoughGlass(b) => b.sample(wo, u, u_lobe),
            Bsdf::RoughThinGlass(b) => b.sample(wo, u, u_lobe),
            Bsdf::Glossy(b) => b.sample(wo, u, u_lobe),
            Bsdf::SmoothCoat(b) => b.sample(wo, u, u_lobe),
            Bsdf::Metal(b) => b.sample(wo, u, u_lobe),
            Bsdf::Translucent(b) => b.sample(wo, u, u_lobe),
            Bsdf::Iridescent(b) => b.sample(wo, u, u_lobe),
            Bsdf::Principled(b) => b.sample(wo, u, u_lobe),
            Bsdf::Finish(b) => b.sample(wo, u, u_lobe),
        }
    }

    /// Whether light sampling is useless here: nothing but delta lobes, or nothing at all.
    pub fn is_delta_only(&self) -> bool {
        match self {
            Bsdf::Black | Bsdf::Specular(_) | Bsdf::Glass(_) | Bsdf::ThinGlass(_) => true,
            Bsdf::Finish(b) => b.is_delta_only(),
            Bsdf::Iridescent(b) => b.is_delta_only(),
            Bsdf::Principled(b) => b.is_delta_only(),
            Bsdf::Diffuse(_)
            | Bsdf::OrenNayar(_)
            | Bsdf::RoughGlass(_)
            | Bsdf::RoughThinGlass(_)
            | Bsdf::Glossy(_)
            | Bsdf::SmoothCoat(_)
            | Bsdf::Metal(_)
            | Bsdf::Translucent(_) => false,
        }
    }

    /// Share of light scattered towards `wo` under uniform light, for the albedo layer: exact for the smooth and the
    /// diffuse models, a close estimate for the others. For dielectrics it is that of the flux.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        match self {
            Bsdf::Black => Vec3::ZERO,
            Bsdf::Diffuse(b) => b.albedo,
            Bsdf::OrenNayar(b) => b.albedo(wo),
            Bsdf::Specular(b) => b.reflectance(wo.z.abs()),
            Bsdf::Glass(b) => {
                let r = b.fresnel.reflectance(wo.z.abs(), b.eta_towards(wo));
                Vec3::splat(r) + b.color * (1.0 - r)
            }
            Bsdf::ThinGlass(b) => {
                let r = b.reflectance(wo.z.abs());
                r + b.color * (Vec3::ONE - r)
            }
            Bsdf::RoughGlass(b) => b.albedo(wo),
            Bsdf::RoughThinGlass(b) => b.albedo(wo),
            Bsdf::Glossy(b) => b.albedo(wo),
            Bsdf::SmoothCoat(b) => b.albedo(wo),
            Bsdf::Metal(b) => b.albedo(wo),
            Bsdf::Translucent(b) => b.front + b.back,
            Bsdf::Iridescent(b) => b.albedo(wo),
            Bsdf::Principled(b) => b.albedo(wo),
            Bsdf::Finish(b) => b.albedo(wo),
        }
    }
}
