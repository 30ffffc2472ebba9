//! Surfaces under a thin film: every model of the glTF set, with the film's reflectance in place of its own.
//!
//! Facets reflect exactly what the film does at their angle. What it does not reflect goes on through the same facet where
//! there is a solid or a sheet, and is lost in a conductor. A diffuse base gets the rest that the facets leave, by the
//! brightest channel. No table can hold that rest for all films: it is estimated at one visible facet, by a random number
//! that stays with the surface point, so that it is right in the mean.

use super::diffuse::sample_cosine_beside;
use super::energy::{schlick_albedo, solid_albedo, typical_cosine, typical_reflectance};
use super::film::Film;
use super::fresnel::{reflect, refract_at_plane};
use super::metal::Metal;
use super::microfacet::Ggx;
use super::rough_glass::{RoughGlass, RoughThinGlass};
use super::specular::mirrored;
use super::{BsdfSample, facing_up, with_side_of};
use crate::math::warp::INV_PI;
use crate::render::technique::FresnelModel;
use glam::{Vec2, Vec3};

/// What is below the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Below {
    /// A conductor.
    Metal,
    /// A diffuse base under a coat.
    Diffuse {
        /// Albedo, reflected.
        base: Vec3,
        /// Albedo, leaving on the far side of a thin sheet.
        back: Vec3,
    },
    /// A thin sheet that tints what passes.
    Sheet(Vec3),
    /// A dielectric solid.
    Solid {
        /// Tint of what is transmitted, once per crossing.
        color: Vec3,
        /// n_inside / n_outside; inside is −z.
        eta: f32,
    },
}

/// A surface under a thin film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescent {
    /// The film.
    pub film: Film,
    /// Reflectance at normal incidence without it; not used by solids.
    pub f0: Vec3,
    /// α along x and y; both 0 if smooth.
    alpha: [f32; 2],
    /// What is below.
    pub below: Below,
    /// Where among the visible facets a diffuse base looks for what they reflect, in [0, 1).
    pub facet: f32,
    /// Whether what single scattering loses is added back.
    pub compensated: bool,
}

impl Iridescent {
    /// A film over a surface of these facets, `None` if smooth; compensated, and looking at the first of the facets.
    pub fn new(film: Film, f0: Vec3, ggx: Option<Ggx>, below: Below) -> Iridescent {
        Iridescent {
            film,
            f0,
            alpha: ggx.map_or([0.0; 2], |ggx| [ggx.ax, ggx.ay]),
            below,
            facet: 0.0,
            compensated: true,
        }
    }

    fn ggx(&self) -> Option<Ggx> {
        let [ax, ay] = self.alpha;
        (ax > 0.0).then_some(Ggx { ax, ay })
    }

    /// Reflectance of a facet under this cosine, from the side where n_transmitted / n_incident is `eta`.
    fn reflectance(&self, cos: f32, eta: f32) -> Vec3 {
        let Below::Solid { eta: inward, .. } = self.below else {
            return self.film.over(self.f0, cos);
        };
        if eta == inward {
            return self.film.over_index(inward, cos);
        }
        // From inside it is that of the refracted ray outside: a stack without losses reflects both ways alike.
        let k = (eta - 1.0) * (eta + 1.0) + cos * cos;
        if k < 0.0 {
            return Vec3::ONE;
        }
        self.film.over_index(inward, (k.sqrt() / eta).min(1.0))
    }

    /// n_transmitted / n_incident seen along `wo`; 1 where nothing is refracted.
    pub fn eta_towards(&self, wo: Vec3) -> f32 {
        match self.below {
            Below::Solid { eta, .. } if wo.z >= 0.0 => eta,
            Below::Solid { eta, .. } => 1.0 / eta,
            _ => 1.0,
        }
    }

    /// Whether light may leave on the other side otherwise than in a single direction.
    pub fn transmits(&self) -> bool {
        match self.below {
            Below::Metal => false,
            Below::Diffuse { back, .. } => back != Vec3::ZERO,
            Below::Sheet(_) | Below::Solid { .. } => self.ggx().is_some(),
        }
    }

    /// Whether nothing but delta lobes is left.
    pub fn is_delta_only(&self) -> bool {
        self.ggx().is_none() && !matches!(self.below, Below::Diffuse { .. })
    }

    fn metal(&self, ggx: Ggx) -> Metal {
        let (f0, compensated) = (self.f0, self.compensated);
        Metal { f0, ggx, compensated }
    }

    fn sheet(&self, ggx: Ggx, color: Vec3) -> RoughThinGlass {
        RoughThinGlass {
            color,
            f0: self.f0,
            f90: 1.0,
            ggx,
            compensated: self.compensated,
        }
    }

    /// Mean reflectance over the hemisphere.
    fn mean_reflectance(&self) -> Vec3 {
        let [a, b] = mean_over_views().map(|(cos, weight)| self.reflectance(cos, 1.0) * weight);
        a + b
    }

    /// Reflectance at the typical facet of this view.
    fn typical(&self, wo: Vec3) -> Vec3 {
        let cos = wo.z.abs();
        let cos = self.ggx().map_or(cos, |ggx| typical_cosine(cos, ggx.alpha()));
        self.reflectance(cos, self.eta_towards(wo))
    }

    /// What the diffuse base gets of the light seen along `up` (above), and the probabilities of coat, front and back.
    fn diffuse_shares(&self, up: Vec3, base: Vec3, back: Vec3) -> (f32, [f32; 3]) {
        let typical = self.typical(up).max_element();
        let left = match self.ggx() {
            None => 1.0 - typical,
            Some(ggx) => {
                // Twelve bits of the number for either coordinate.
                let (row, column) = ((self.facet * 4096.0).floor(), (self.facet * 4096.0).fract());
                let m = ggx.sample_visible(up, Vec2::new((row + 0.5) / 4096.0, column));
                let (f, pdf, cos) = ggx.reflection(up, reflect(up, m));
                let seen = if pdf > 0.0 { f / pdf } else { 0.0 };
                let reflected = seen * self.reflectance(cos, 1.0).max_element();
                let all = if self.compensated { 1.0 } else { seen };
                (all - reflected).max(0.0)
            }
        };
        let (front, behind) = (
            (1.0 - typical) * base.max_element(),
            (1.0 - typical) * back.max_element(),
        );
        let sum = typical + front + behind;
        let inverse = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        (left, [typical * inverse, front * inverse, behind * inverse])
    }

    /// f·|cosθi| and the density of `wi`.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match (self.below, self.ggx()) {
            (Below::Diffuse { base, back }, _) => self.eval_pdf_diffuse(wo, wi, base, back),
            (_, None) => (Vec3::ZERO, 0.0),
            (Below::Metal, Some(ggx)) => {
                let mean = self.mean_reflectance();
                self.metal(ggx)
                    .eval_pdf_by(wo, wi, |cos| self.reflectance(cos, 1.0), mean)
            }
            (Below::Sheet(color), Some(ggx)) => self
                .sheet(ggx, color)
                .eval_pdf_by(wo, wi, |cos| self.reflectance(cos, 1.0)),
            (Below::Solid { .. }, Some(ggx)) => {
                let eta = self.eta_towards(wo);
                let share = |cos| {
                    let r = self.reflectance(cos, eta);
                    (r, mean_of(r))
                };
                self.solid(ggx).eval_pdf_by(wo, wi, share, self.balance(ggx))
            }
        }
    }

    /// What the facets of a solid lose with the film, over what the tables say they lose without it: reflected light is
    /// hidden more often than refracted light. By the ratio of the means over views from the thinner side, so that it is one
    /// number for both directions of light.
    fn balance(&self, ggx: Ggx) -> Vec3 {
        let Below::Solid { eta, .. } = self.below else {
            return Vec3::ONE;
        };
        let (alpha, eta) = (ggx.alpha(), eta.max(1.0 / eta));
        let (mut more, mut lost) = (Vec3::ZERO, 0.0);
        for (cos, weight) in mean_over_views() {
            let (base, edge) = schlick_albedo(cos, alpha);
            let (all, bare) = (solid_albedo(cos, alpha, eta), typical_reflectance(cos, alpha, eta));
            let refracted = (all - bare * (base + edge)) / (1.0 - bare);
            let film = self.reflectance(typical_cosine(cos, alpha), eta);
            more += (film - Vec3::splat(bare)) * (weight * (refracted - base - edge));
            lost += weight * (1.0 - all);
        }
        if lost > 0.0 {
            (Vec3::ONE + more / lost).clamp(Vec3::ZERO, Vec3::splat(2.0))
        } else {
            Vec3::ONE
        }
    }

    fn solid(&self, ggx: Ggx) -> RoughGlass {
        let (color, eta) = match self.below {
            Below::Solid { color, eta } => (color, eta),
            _ => (Vec3::ZERO, 1.0),
        };
        RoughGlass {
            color,
            eta,
            ggx,
            fresnel: FresnelModel::Exact,
            compensated: self.compensated,
        }
    }

    fn eval_pdf_diffuse(&self, wo: Vec3, wi: Vec3, base: Vec3, back: Vec3) -> (Vec3, f32) {
        let (wo, wi) = facing_up(wo, wi);
        let (left, [coat, front, behind]) = self.diffuse_shares(wo, base, back);
        let cosine = wi.z.abs() * INV_PI;
        if wi.z <= 0.0 {
            return (back * (left * cosine), behind * cosine);
        }
        let (mut value, mut pdf) = (base * (left * cosine), front * cosine);
        if let Some(ggx) = self.ggx() {
            let (f, p, cos) = ggx.reflection(wo, wi);
            value += self.reflectance(cos, 1.0) * f;
            pdf += coat * p;
        }
        (value, pdf)
    }

    /// A direction of the film's mirror or facets, or of what is below.
    pub fn sample(&self, wo: Vec3, u: Vec2, u_lobe: f32) -> Option<BsdfSample> {
        let (up, _) = facing_up(wo, wo);
        match (self.below, self.ggx()) {
            (Below::Diffuse { base, back }, ggx) => {
                let (_, [coat, front, _]) = self.diffuse_shares(up, base, back);
                let wi = match ggx {
                    None if u_lobe < coat => {
                        let weight = self.reflectance(up.z, 1.0) / coat;
                        return Some(BsdfSample::delta(mirrored(wo), weight, coat));
                    }
                    Some(ggx) if u_lobe < coat => {
                        Some(reflect(up, ggx.sample_visible(up, u))).filter(|wi| wi.z > 0.0)?
                    }
                    _ if u_lobe < coat + front => sample_cosine_beside(up, u),
                    _ => sample_cosine_beside(-up, u),
                };
                BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
            }
            (Below::Metal, None) => Some(BsdfSample::delta(mirrored(wo), self.reflectance(up.z, 1.0), 1.0)),
            (Below::Sheet(color), None) => self.sample_smooth(wo, u_lobe, color, 1.0),
            (Below::Solid { color, .. }, None) => self.sample_smooth(wo, u_lobe, color, self.eta_towards(wo)),
            (Below::Metal, Some(ggx)) => {
                let wi = self.metal(ggx).choose(up, u, u_lobe);
                BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
            }
            (Below::Sheet(color), Some(ggx)) => {
                let sheet = self.sheet(ggx, color);
                let wi = sheet.choose(up, u, u_lobe, |cos| self.reflectance(cos, 1.0))?;
                BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))
            }
            (Below::Solid { .. }, Some(ggx)) => {
                let eta = self.eta_towards(wo);
                let wi = self
                    .solid(ggx)
                    .choose(wo, u, u_lobe, |cos| mean_of(self.reflectance(cos, eta)))?;
                let mut sample = BsdfSample::from_eval(with_side_of(wo, wi), |wi| self.eval_pdf(wo, wi))?;
                if wi.z < 0.0 {
                    sample.eta = eta;
                }
                Some(sample)
            }
        }
    }

    /// The mirror direction, or the way on: straight through a sheet, bent into a solid.
    fn sample_smooth(&self, wo: Vec3, u_lobe: f32, color: Vec3, eta: f32) -> Option<BsdfSample> {
        let r = self.reflectance(wo.z.abs(), eta);
        let t = color * (Vec3::ONE - r);
        let (wr, wt) = (r.max_element(), t.max_element());
        if wr + wt <= 0.0 {
            return None;
        }
        let p = wr / (wr + wt);
        if u_lobe < p {
            return Some(BsdfSample::delta(mirrored(wo), r / p, p));
        }
        if matches!(self.below, Below::Sheet(_)) {
            let mut sample = BsdfSample::delta(-wo, t / (1.0 - p), 1.0 - p);
            sample.straight = true;
            return Some(sample);
        }
        let wi = if eta == 1.0 { -wo } else { refract_at_plane(wo, eta)? };
        let mut sample = BsdfSample::delta(wi, t / ((1.0 - p) * eta * eta), 1.0 - p);
        sample.eta = eta;
        Some(sample)
    }

    /// What a smooth sheet or solid lets pass under this cosine from outside; zero for everything else.
    pub fn passage(&self, cos: f32) -> Vec3 {
        match self.below {
            Below::Sheet(color) | Below::Solid { color, .. } if self.ggx().is_none() => {
                color * (Vec3::ONE - self.reflectance(cos, self.eta_towards(Vec3::Z)))
            }
            _ => Vec3::ZERO,
        }
    }

    /// Directional albedo, with the reflectance of the typical facet.
    pub fn albedo(&self, wo: Vec3) -> Vec3 {
        let r = self.typical(wo);
        let rest = Vec3::ONE - r;
        match self.below {
            Below::Metal => r,
            Below::Diffuse { base, back } => r + (base + back) * (1.0 - r.max_element()),
            Below::Sheet(color) | Below::Solid { color, .. } => r + color * rest,
        }
    }
}

/// Two cosines and their weights: the mean 2·∫f(cos)·cos dcos, exact for cubic polynomials.
fn mean_over_views() -> [(f32, f32); 2] {
    let root = 6.0f32.sqrt();
    let weight = 0.5 - root / 36.0;
    [((6.0 - root) * 0.1, weight), ((6.0 + root) * 0.1, 1.0 - weight)]
}

/// Probability of reflection for a reflectance that differs by channel.
fn mean_of(r: Vec3) -> f32 {
    (r.x + r.y + r.z) * (1.0 / 3.0)
}
