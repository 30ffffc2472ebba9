//! Layers of the glTF set over another model: clearcoat over sheen over the base.
//!
//! Metallic, transmission and the like choose the base where the material is evaluated, so a base is one of the plain
//! models. A layer takes from what lies below by its albedo seen along `wo` alone, as glTF writes it: any base keeps
//! its energy exactly, at the price of symmetry in the directions.
//!
//! The frame is the coat's. A base under relief may lean in it: varnish is smooth over the flakes of a paint.

use super::energy::schlick_albedo;
use super::fresnel::{reflect, schlick_weight};
use super::glossy::{Glossy, SmoothCoat};
use super::iridescent::{Below, Iridescent};
use super::metal::Metal;
use super::microfacet::Ggx;
use super::rough_glass::{RoughGlass, RoughThinGlass};
use super::sheen::Sheen;
use super::specular::{Glass, Specular, ThinGlass, mirrored};
use super::{Bsdf, BsdfSample, facing_up, unit, with_side_of};
use crate::math::frame::Frame;
use crate::math::robust::{ONE_MINUS, sqrt_of_nonnegative};
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
    /// Any of them under a thin film.
    Iridescent(Iridescent),
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
            Base::Iridescent(b) => Bsdf::Iridescent(b),
        }
    }

    fn is_solid(self) -> bool {
        match self {
            Base::Glass(_) | Base::RoughGlass(_) => true,
            Base::Iridescent(b) => matches!(b.below, Below::Solid { .. }),
            _ => false,
        }
    }
}

/// A clear layer of index 1.5: colourless, and absorbing nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Strength in [0, 1]; 0 for none.
    pub strength: f32,
    /// α of its facets; 0 if smooth.
    alpha: f32,
}

impl Clearcoat {
    /// Reflectance at normal incidence of an index of 1.5.
    const F0: f32 = 0.04;

    /// No coat.
    pub const NONE: Clearcoat = Clearcoat {
        strength: 0.0,
        alpha: 0.0,
    };

    /// A coat of this strength in [0, 1] and of these facets, `None` if smooth.
    pub fn new(strength: f32, ggx: Option<Ggx>) -> Clearcoat {
        Clearcoat {
            strength,
            alpha: ggx.map_or(0.0, Ggx::alpha),
        }
    }

    fn ggx(&self) -> Option<Ggx> {
        let (ax, ay) = (self.alpha, self.alpha);
        (self.alpha > 0.0).then_some(Ggx { ax, ay })
    }

    /// Reflectance of a facet under this cosine.
    pub fn reflectance(&self, cos: f32) -> f32 {
        self.strength * (Self::F0 + (1.0 - Self::F0) * schlick_weight(cos))
    }

    /// Directional albedo.
    pub fn albedo(&self, cos: f32) -> f32 {
        match self.ggx() {
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
    /// x and y of the normal of sheen and base in the coat's frame; zero where all have one normal.
    pub lean: Vec2,
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
        let coat = self.coat.albedo(wo.z.abs());
        let below = self.below(wo);
        let fibres = unit(self.sheen.color.max_element()) * self.sheen.albedo(below.z.abs());
        let keep_sheen = 1.0 - coat;
        let keep_base = keep_sheen * (1.0 - fibres);
        let base = keep_base * self.base.bsdf().albedo(below).max_element();
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
        let coat = self.coat.strength <= 0.0 || self.coat.ggx().is_none();
        coat && self.sheen.color.max_element() <= 0.0 && self.base.bsdf().is_delta_only()
    }

    /// The frame of sheen and base where it is not the coat's. `wo` is on one side by both normals.
    fn frame_below(&self, wo: Vec3) -> Option<Frame> {
        if self.lean == Vec2::ZERO {
            return None;
        }
        let z = sqrt_of_nonnegative(1.0 - self.lean.length_squared());
        let frame = Frame::from_normal_and_tangent(self.lean.extend(z), Vec3::X);
        (frame.n.dot(wo) * wo.z > 0.0).then_some(frame)
    }

    /// `wo` as sheen and base see it.
    fn below(&self, wo: Vec3) -> Vec3 {
        self.frame_below(wo).map_or(wo, |frame| frame.to_local(wo))
    }

    /// What a lobe of the layers below adds. Directions whose sides by the two normals differ are mirrored in the plane of
    /// the coat, as the kernel does it for surfaces: what a leaning base sends there comes out of the coat again.
    fn folded(frame: Option<Frame>, wo: Vec3, wi: Vec3, lobe: impl Fn(Vec3, Vec3) -> (Vec3, f32)) -> (Vec3, f32) {
        let Some(frame) = frame else {
            return lobe(wo, wi);
        };
        let wo = frame.to_local(wo);
        let at = |wi: Vec3| {
            let local = frame.to_local(wi);
            if (local.z < 0.0) == (wi.z < 0.0) {
                lobe(wo, local)
            } else {
                (Vec3::ZERO, 0.0)
            }
        };
        let (own, image) = (at(wi), Vec3::new(wi.x, wi.y, -wi.z));
        // The image only where the lobe itself would end on this side of the coat.
        let local = frame.to_local(image);
        if (local.z < 0.0) == (image.z < 0.0) {
            return own;
        }
        let (f, pdf) = lobe(wo, local);
        (own.0 + f, own.1 + pdf)
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let shares = self.shares(wo);
        let frame = self.frame_below(wo);
        let (f, p) = Self::folded(frame, wo, wi, |wo, wi| self.base.bsdf().eval_pdf(wo, wi));
        let mut value = f * shares.keep_base;
        let mut pdf = p * (1.0 - shares.coat - shares.sheen).max(0.0);
        if shares.keep_sheen <= 0.0 {
            return (value, pdf);
        }
        let (up, above) = facing_up(wo, wi);
        if above.z > 0.0
            && let Some(ggx) = self.coat.ggx().filter(|_| self.coat.strength > 0.0)
        {
            let (f, p, cos) = ggx.reflection(up, above);
            value += Vec3::splat(self.coat.reflectance(cos) * f);
            pdf += shares.coat * p;
        }
        if shares.sheen > 0.0 {
            let (f, p) = Self::folded(frame, wo, wi, |wo, wi| {
                let (up, wi) = facing_up(wo, wi);
                if wi.z > 0.0 {
                    (Vec3::splat(self.sheen.eval(up, wi)), Sheen::pdf(wi.z))
                } else {
                    (Vec3::ZERO, 0.0)
                }
            });
            value += self.sheen.color.min(Vec3::ONE) * (f * shares.keep_sheen);
            pdf += shares.sheen * p;
        }
        (value, pdf)
    }

    /// A direction of the coat, the sheen or the base.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let shares = self.shares(wo);
        let (up, _) = facing_up(wo, wo);
        let layers = shares.coat + shares.sheen;
        if u_lobe < shares.coat {
            let Some(ggx) = self.coat.ggx() else {
                let weight = self.coat.reflectance(up.z) / shares.coat;
                return Some(BsdfSample::delta(mirrored(wo), Vec3::splat(weight), shares.coat));
            };
            let wi = Some(reflect(up, ggx.sample_visible(up, u))).filter(|w| w.z > 0.0)?;
            return BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi));
        }
        let frame = self.frame_below(wo);
        let below = frame.map_or(wo, |frame| frame.to_local(wo));
        // A direction of a layer below as the coat sees it, see [`Principled::folded`].
        let risen = |wi: Vec3| match frame {
            None => wi,
            Some(frame) => {
                let out = frame.to_world(wi);
                let is_kept = (out.z < 0.0) == (wi.z < 0.0);
                if is_kept { out } else { Vec3::new(out.x, out.y, -out.z) }
            }
        };
        if u_lobe < layers {
            let wi = risen(with_side_of(below, Sheen::sample(u)));
            return BsdfSample::from_eval(wi, |wi| self.eval_pdf(wo, wi));
        }
        let rest = 1.0 - layers;
        let u_base = ((u_lobe - layers) / rest).min(ONE_MINUS);
        let mut sample = self.base.bsdf().sample(below, u, u_base)?;
        sample.wi = risen(sample.wi);
        if sample.delta {
            sample.weight *= shares.keep_base / rest;
            sample.pdf *= rest;
            return Some(sample);
        }
        let eta = sample.eta;
        let mut sample = BsdfSample::from_eval(sample.wi, |wi| self.eval_pdf(wo, wi))?;
        sample.eta = eta;
        Some(sample)
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let shares = self.shares(wo);
        let below = self.below(wo);
        let layers = if shares.keep_sheen > 0.0 {
            let sheen = self.sheen.color * (shares.keep_sheen * self.sheen.albedo(below.z.abs()));
            Vec3::splat(self.coat.albedo(wo.z.abs())) + sheen
        } else {
            Vec3::ZERO
        };
        layers + self.base.bsdf().albedo(below) * shares.keep_base
    }
}
