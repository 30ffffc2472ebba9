//! Smooth surfaces, whose lobes are single directions: the mirror, the smooth dielectric and the smooth thin sheet.

use super::BsdfSample;
use super::fresnel::{refract_at_plane, schlick, schlick_weight};
use crate::render::technique::FresnelModel;
use glam::Vec3;

/// A perfect mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Reflectance at normal incidence.
    pub color: Vec3,
    /// Reflectance at grazing incidence; the same for an ideal mirror, white for a smooth metal.
    pub grazing: Vec3,
}

impl Specular {
    /// Reflectance under this cosine, by Schlick's curve.
    pub fn reflectance(&self, cos: f32) -> Vec3 {
        self.color + (self.grazing - self.color) * schlick_weight(cos)
    }

    /// The mirror direction.
    pub fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        let weight = self.reflectance(wo.z.abs());
        Some(BsdfSample::delta(mirrored(wo), weight, 1.0))
    }
}

/// The mirror direction of `wo`.
pub(super) fn mirrored(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// The smooth boundary of a dielectric solid: reflects white by Fresnel, refracts the rest tinted.
///
/// Radiance changes with the square of the index: what is refracted is divided by (n_t/n_i)², which cancels when the
/// path leaves again, and is right for cameras and lights inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Tint of what is transmitted, once per crossing.
    pub color: Vec3,
    /// n_inside / n_outside; inside is −z.
    pub eta: f32,
    /// Which share is reflected.
    pub fresnel: FresnelModel,
}

impl Glass {
    /// n_transmitted / n_incident for light seen along `wo`.
    pub fn eta_towards(&self, wo: Vec3) -> f32 {
        if wo.z >= 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// Reflection with the probability of the reflectance, else refraction.
    pub fn sample(&self, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
        let eta = self.eta_towards(wo);
        let r = self.fresnel.reflectance(wo.z.abs(), eta);
        if u_lobe < r {
            return Some(BsdfSample::delta(mirrored(wo), Vec3::ONE, r));
        }
        if eta == 1.0 {
            return Some(BsdfSample::delta(-wo, self.color, 1.0));
        }
        let wi = refract_at_plane(wo, eta)?;
        let mut sample = BsdfSample::delta(wi, self.color / (eta * eta), 1.0 - r);
        sample.eta = eta;
        Some(sample)
    }
}

/// A smooth thin sheet: one interface's reflectance, the rest passes straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinGlass {
    /// Tint of what passes.
    pub color: Vec3,
    /// Reflectance at normal incidence.
    pub f0: Vec3,
    /// Reflectance at grazing incidence.
    pub f90: f32,
}

impl ThinGlass {
    /// Reflectance under this cosine.
    pub fn reflectance(&self, cos: f32) -> Vec3 {
        schlick(self.f0, self.f90, cos)
    }

    /// Reflection or straight passage, chosen by the brighter channel.
    pub fn sample(&self, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
        let r = self.reflectance(wo.z.abs());
        let t = self.color * (Vec3::ONE - r);
        let (wr, wt) = (r.max_element(), t.max_element());
        if wr + wt <= 0.0 {
            return None;
        }
        let p = wr / (wr + wt);
        Some(if u_lobe < p {
            BsdfSample::delta(mirrored(wo), r / p, p)
        } else {
            let mut sample = BsdfSample::delta(-wo, t / (1.0 - p), 1.0 - p);
            sample.straight = true;
            sample
        })
    }
}
