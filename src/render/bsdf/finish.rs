//! POV-Ray's pigment and finish, mapped onto lobes that conserve energy.
//!
//! - `diffuse` is Lambert (cosᵇ with `brilliance b`), `diffuse_back` the same on the far side.
//! - `phong`/`specular` of exponent s is a GGX lobe of α² = 2/(s+2). Its weight is amount·4α² = amount·8/(s+2): under a
//!   lamp, whose irradiance is π times its colour, the highlight's peak is then as bright as in POV-Ray.
//! - `reflection` is a mirror between `min` and `max`; `filter`/`transmit` pass straight, or bent with an ior.
//!
//! POV-Ray adds all of these up; here mirror, highlight and passage come first (cut to 1 in that order) and the diffuse
//! part gets what is left, seen along `wo`. Passage with an ior is not divided by η²: it cancels for closed objects, and
//! scenes with an open water plane look as in POV-Ray.

use super::energy::schlick_albedo;
use super::fresnel::{reflect, refract_at_plane, schlick_weight};
use super::microfacet::Ggx;
use super::specular::mirrored;
use super::{BsdfSample, facing_up, with_side_of};
use crate::math::portable::{pow, sin_cos_turns};
use crate::math::robust::sqrt_of_nonnegative;
use crate::render::technique::FresnelModel;
use glam::{Vec2, Vec3};

/// POV-Ray's surface, with the pigment multiplied in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// Pigment · opacity · `diffuse`.
    pub diffuse: Vec3,
    /// Pigment · opacity · the amount that leaves on the other side.
    pub diffuse_back: Vec3,
    /// Exponent of the cosine of the diffuse part; 1 for Lambert.
    pub brilliance: f32,
    /// Weight of the highlight, see [`Finish::highlight_weight`], with its tint.
    pub highlight: Vec3,
    /// Its facets; `None` without a highlight.
    pub ggx: Option<Ggx>,
    /// Mirror reflectance at normal incidence.
    pub mirror_min: Vec3,
    /// Mirror reflectance at grazing incidence.
    pub mirror_max: Vec3,
    /// Exponent of (1 − cos) between the two; NaN means by Fresnel with [`Finish::eta`].
    pub falloff: f32,
    /// What passes: transmit + filter·pigment.
    pub passes: Vec3,
    /// n_inside / n_outside; 1 where light passes straight.
    pub eta: f32,
    /// How the mirror by Fresnel is computed.
    pub fresnel: FresnelModel,
    /// Whether what passes is reduced by the mirror (`conserve_energy`).
    pub conserve: bool,
}

/// The lobes' weights seen along one `wo`, and their probabilities.
struct Lobes {
    mirror: Vec3,
    passes: Vec3,
    /// Factor of the highlight.
    highlight: f32,
    front: Vec3,
    back: Vec3,
    /// Cumulative probabilities of mirror, passage, highlight, front; the back has the rest.
    cumulative: [f32; 4],
}

impl Finish {
    /// Nothing but black.
    pub const BLACK: Finish = Finish {
        diffuse: Vec3::ZERO,
        diffuse_back: Vec3::ZERO,
        brilliance: 1.0,
        highlight: Vec3::ZERO,
        ggx: None,
        mirror_min: Vec3::ZERO,
        mirror_max: Vec3::ZERO,
        falloff: 0.0,
        passes: Vec3::ZERO,
        eta: 1.0,
        fresnel: FresnelModel::Exact,
        conserve: false,
    };

    /// Weight of the GGX lobe whose peak under a lamp is `amount` for a highlight of exponent `s` ≥ 0.
    pub fn highlight_weight(amount: f32, s: f32) -> f32 {
        amount * 8.0 / (s + 2.0)
    }

    /// α of a highlight cos^s of the angle between normal and half vector.
    pub fn highlight_alpha(s: f32) -> f32 {
        (2.0 / (s + 2.0)).sqrt()
    }

    /// n_t/n_i seen along `wo`.
    fn eta_towards(&self, wo: Vec3) -> f32 {
        if wo.z >= 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// Mirror reflectance along `wo`, at most 1.
    pub fn mirror(&self, wo: Vec3) -> Vec3 {
        let cos = wo.z.abs();
        let w = if self.falloff.is_nan() {
            self.fresnel.reflectance(cos, self.eta_towards(wo))
        } else if self.mirror_min == self.mirror_max {
            0.0
        } else {
            pow((1.0 - cos).max(0.0), self.falloff)
        };
        (self.mirror_min + (self.mirror_max - self.mirror_min) * w).clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// What passes along `wo`, at most what the mirror leaves.
    pub fn passage(&self, wo: Vec3) -> Vec3 {
        let left = Vec3::ONE - self.mirror(wo);
        if self.conserve {
            self.passes.min(Vec3::ONE) * left
        } else {
            self.passes.min(left)
        }
    }

    fn lobes(&self, wo: Vec3) -> Lobes {
        let mirror = self.mirror(wo);
        let passes = self.passage(wo);
        let left = Vec3::ONE - mirror - passes;
        let mut highlight = 0.0;
        let mut h = Vec3::ZERO;
        if let Some(ggx) = self.ggx {
            // `left` may be 0 in one channel only: one factor keeps the highlight's tint.
            let (base, edge) = schlick_albedo(wo.z.abs(), ggx.alpha());
            let full = self.highlight * base + Vec3::splat(edge * self.highlight.max_element());
            let ratio = (left / full.max(Vec3::splat(f32::MIN_POSITIVE))).min_element();
            highlight = ratio.clamp(0.0, 1.0);
            h = full * highlight;
        }
        let left = (left - h).max(Vec3::ZERO);
        let cosine_gain = 2.0 / (self.brilliance + 1.0); // albedo of cosᵇ per unit of amount
        let (front, back) = (self.diffuse * cosine_gain, self.diffuse_back * cosine_gain);
        let scale = (left / (front + back).max(Vec3::splat(f32::MIN_POSITIVE))).min(Vec3::ONE);
        let (front, back) = (front * scale, back * scale);
        let weights = [mirror, passes, h, front].map(|w| w.max_element().max(0.0));
        let sum = weights.iter().sum::<f32>() + back.max_element();
        let mut cumulative = [0.0; 4];
        let mut running = 0.0;
        for (c, w) in cumulative.iter_mut().zip(weights) {
            running += if sum > 0.0 { w / sum } else { 0.0 };
            *c = running;
        }
        Lobes {
            mirror,
            passes,
            highlight,
            front,
            back,
            cumulative,
        }
    }

    /// Whether it has no lobe that light sampling can find.
    pub fn is_delta_only(&self) -> bool {
        self.ggx.is_none() && (self.diffuse + self.diffuse_back).max_element() <= 0.0
    }

    /// cosᵇ normalised to a density over the hemisphere.
    fn cosine_density(&self, cos: f32) -> f32 {
        let b = self.brilliance;
        let power = if b == 1.0 { cos } else { pow(cos, b) };
        power * (b + 1.0) / std::f32::consts::TAU
    }

    fn sample_cosine_power(&self, u: Vec2) -> Vec3 {
        if self.brilliance == 1.0 {
            return crate::math::warp::cosine_hemisphere(u);
        }
        let cos = pow(1.0 - u.x, 1.0 / (self.brilliance + 1.0));
        let sin = sqrt_of_nonnegative((1.0 - cos) * (1.0 + cos));
        let (s, c) = sin_cos_turns(u.y);
        Vec3::new(sin * c, sin * s, cos)
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval_pdf_of(&self.lobes(wo), wo, wi)
    }

    fn eval_pdf_of(&self, lobes: &Lobes, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let [_, passes, highlight, front] = lobes.cumulative;
        let density = self.cosine_density(wi.z.abs());
        if wi.z <= 0.0 {
            return if lobes.back == Vec3::ZERO {
                (Vec3::ZERO, 0.0)
            } else {
                (lobes.back * density, (1.0 - front).max(0.0) * density)
            };
        }
        let mut value = lobes.front * density;
        let mut pdf = (front - highlight) * density;
        if let Some(ggx) = self.ggx {
            let (f, p, cos) = ggx.reflection(wo, wi);
            let white = Vec3::splat(self.highlight.max_element());
            let tint = self.highlight + (white - self.highlight) * schlick_weight(cos);
            value += tint * (lobes.highlight * f);
            pdf += (highlight - passes) * p;
        }
        (value, pdf)
    }

    /// A direction of one of the lobes.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let lobes = self.lobes(wo);
        let [mirror, passes, highlight, front] = lobes.cumulative;
        let (up, _) = facing_up(wo, wo);
        let wi = if u_lobe < mirror {
            return Some(BsdfSample::delta(mirrored(wo), lobes.mirror / mirror, mirror));
        } else if u_lobe < passes {
            return self.sample_passage(wo, lobes.passes, passes - mirror);
        } else if u_lobe < highlight {
            Some(reflect(up, self.ggx?.sample_visible(up, u))).filter(|wi| wi.z > 0.0)?
        } else if u_lobe < front {
            self.sample_cosine_power(u)
        } else {
            -self.sample_cosine_power(u)
        };
        BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf_of(&lobes, wo, wi))
    }

    /// What passes: straight, or bent; where it is totally reflected it stays inside with the same weight.
    fn sample_passage(&self, wo: Vec3, weight: Vec3, p: f32) -> Option<BsdfSample> {
        if self.eta == 1.0 {
            let mut sample = BsdfSample::delta(-wo, weight / p, p);
            sample.straight = true;
            return Some(sample);
        }
        let wi = refract_at_plane(wo, self.eta_towards(wo)).unwrap_or_else(|| mirrored(wo));
        Some(BsdfSample::delta(wi, weight / p, p))
    }

    /// Directional albedo.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let lobes = self.lobes(wo);
        let shine = self.ggx.map_or(Vec3::ZERO, |ggx| {
            let (base, edge) = schlick_albedo(wo.z.abs(), ggx.alpha());
            (self.highlight * base + Vec3::splat(edge * self.highlight.max_element())) * lobes.highlight
        });
        lobes.mirror + lobes.passes + shine + lobes.front + lobes.back
    }
}
