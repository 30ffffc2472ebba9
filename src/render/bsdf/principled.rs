//! Layers of the glTF set over another model: clearcoat over sheen over the base.
//!
//! Metallic, transmission and the like choose the base where the material is evaluated, so a base is one of the plain
//! models. A layer takes from what lies below by its albedo seen along `wo` alone, as glTF writes it: any base keeps
//! its energy exactly, at the price of symmetry in the directions.

use super::energy::schlick_albedo;
use super::fresnel::{reflect, schlick_weight};
use super::glossy::{Glossy, SmoothCoat};
use super::metal::Metal;
use super::microfacet::Ggx;
use super::rough_glass::{RoughGlass, RoughThinGlass};
use super::sheen::Sheen;
use super::specular::{Glass, Specular, ThinGlass, mirrored};
use super::{Bsdf, BsdfSample, facing_up, unit, with_side_of};
use glam::{Vec2, Vec3};

/// What lies below the layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// Rough plastic.
    Glossy(Glossy),
    /// Smooth plastic.
    SmoothCoat(SmoothCoat),
    /// Rough metal.
    Metal(Metal),
    /// Smooth metal.
    Specular(Specular),
    /// Smooth solid.
    Glass(Glass),
    /// Rough solid.
    RoughGlass(RoughGlass),
    /// Smooth thin sheet.
    ThinGlass(ThinGlass),
    /// Rough thin sheet.
    RoughThinGlass(RoughThinGlass),
}

impl Base {
    /// The base alone.
    pub fn bsdf(self) -> Bsdf {
        match self {
            Base::Glossy(b) => Bsdf::Glossy(b),
            Base::SmoothCoat(b) => Bsdf::SmoothCoat(b),
            Base::Metal(b) => Bsdf::Metal(b),
            Base::Specular(b) => Bsdf::Specular(b),
            Base::Glass(b) => Bsdf::Glass(b),
            Base::RoughGlass(b) => Bsdf::RoughGlass(b),
            Base::ThinGlass(b) => Bsdf::ThinGlass(b),
            Base::RoughThinGlass(b) => Bsdf::RoughThinGlass(b),
        }
    }

    fn is_solid(self) -> bool {
        matches!(self, Base::Glass(_) | Base::RoughGlass(_))
    }
}

/// A clear layer of index 1.5: colourless, and absorbing nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Strength in [0, 1]; 0 for none.
    pub strength: f32,
    /// Its facets; `None` if smooth.
    pub ggx: Option<Ggx>,
}

impl Clearcoat {
    /// Reflectance at normal incidence of an index of 1.5.
    const F0: f32 = 0.04;

    /// No coat.
    pub const NONE: Clearcoat = Clearcoat {
        strength: 0.0,
        ggx: None,
    };

    fn reflectance(&self, cos: f32) -> f32 {
        self.strength * (Self::F0 + (1.0 - Self::F0) * schlick_weight(cos))
    }

    /// Directional albedo.
    pub fn albedo(&self, cos: f32) -> f32 {
        match self.ggx {
            None => self.reflectance(cos),
            Some(ggx) if self.strength > 0.0 => {
                let (base, edge) = schlick_albedo(cos, ggx.alpha());
                self.strength * (Self::F0 * base + edge)
            }
            Some(_) => 0.0,
        }
    }
}

/// A base with its layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// The model below.
    pub base: Base,
    /// The outermost layer.
    pub coat: Clearcoat,
    /// The layer between.
    pub sheen: Sheen,
}

/// How light is shared between the layers, seen along `wo`.
struct Shares {
    /// What the base keeps.
    keep_base: f32,
    /// What the sheen keeps.
    keep_sheen: f32,
    /// Probabilities of the coat and the sheen; the base has the rest.
    coat: f32,
    sheen: f32,
}

impl Principled {
    /// The model without needless layers.
    pub fn into_bsdf(self) -> Bsdf {
        if self.coat.strength > 0.0 || self.sheen.color.max_element() > 0.0 {
            Bsdf::Principled(self)
        } else {
            self.base.bsdf()
        }
    }

    fn shares(&self, wo: Vec3) -> Shares {
        if wo.z < 0.0 && self.base.is_solid() {
            return Shares {
                keep_base: 1.0,
                keep_sheen: 0.0,
                coat: 0.0,
                sheen: 0.0,
            }; // layers lie outside
        }
        let cos = wo.z.abs();
        let coat = self.coat.albedo(cos);
        let fibres = unit(self.sheen.color.max_element()) * self.sheen.albedo(cos);
        let keep_sheen = 1.0 - coat;
        let keep_base = keep_sheen * (1.0 - fibres);
        let base = keep_base * self.base.bsdf().albedo(wo).max_element();
        let sum = coat + keep_sheen * fibres + base;
        let inverse = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Shares {
            keep_base,
            keep_sheen,
            coat: coat * inverse,
            sheen: keep_sheen * fibres * inverse,
        }
    }

    /// Share of light that the layers leave to the base, seen along `wo`.
    pub fn keep_base(&self, wo: Vec3) -> f32 {
        self.shares(wo).keep_base
    }

    /// Whether nothing but delta lobes is left.
    pub fn is_delta_only(&self) -> bool {
        let coat = self.coat.strength <= 0.0 || self.coat.ggx.is_none();
        coat && self.sheen.color.max_element() <= 0.0 && self.base.bsdf().is_delta_only()
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let shares = self.shares(wo);
        let (f, p) = self.base.bsdf().eval_pdf(wo, wi);
        let mut value = f * shares.keep_base;
        let mut pdf = p * (1.0 - shares.coat - shares.sheen).max(0.0);
        let (up, wi) = facing_up(wo, wi);
        if wi.z > 0.0 && shares.keep_sheen > 0.0 {
            if let Some(ggx) = self.coat.ggx.filter(|_| self.coat.strength > 0.0) {
                let (f, p, cos) = ggx.reflection(up, wi);
                value += Vec3::splat(self.coat.reflectance(cos) * f);
                pdf += shares.coat * p;
            }
            if shares.sheen > 0.0 {
                value += self.sheen.color.min(Vec3::ONE) * (shares.keep_sheen * self.sheen.eval(up, wi));
                pdf += shares.sheen * Sheen::pdf(wi.z);
            }
        }
        (value, pdf)
    }

    /// A direction of the coat, the sheen or the base.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let shares = self.shares(wo);
        let (up, _) = facing_up(wo, wo);
        let layers = shares.coat + shares.sheen;
        let wi = if u_lobe < shares.coat {
            match self.coat.ggx {
                None => {
                    let weight = self.coat.reflectance(up.z) / shares.coat;
                    return Some(BsdfSample::delta(mirrored(wo), Vec3::splat(weight), shares.coat));
                }
                Some(ggx) => with_side_of(wo, Some(reflect(up, ggx.sample_visible(up, u))).filter(|w| w.z > 0.0)?),
            }
        } else if u_lobe < layers {
            with_side_of(wo, Sheen::sample(u))
        } else {
            let rest = 1.0 - layers;
            let mut sample =
                self.base
                    .bsdf()
                    .sample(wo, u, ((u_lobe - layers) / rest).min(crate::math::robust::ONE_MINUS))?;
            if sample.delta {
                sample.weight *= shares.keep_base / rest;
                sample.pdf *= rest;
                return Some(sample);
            }
            let eta = sample.eta;
            let mut sample = BsdfSample::from_eval(sample.wi, |wi| self.eval_pdf(wo, wi))?;
            sample.eta = eta;
            return Some(sample);
        };
        BsdfSample::from_eval(wi, |wi| self.eval_pdf(wo, wi))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let shares = self.shares(wo);
        let cos = wo.z.abs();
        let layers = if shares.keep_sheen > 0.0 {
            Vec3::splat(self.coat.albedo(cos)) + self.sheen.color * (shares.keep_sheen * self.sheen.albedo(cos))
        } else {
            Vec3::ZERO
        };
        layers + self.base.bsdf().albedo(wo) * shares.keep_base
    }
}
