//! What hits of light count, against light sampling.

use super::{Departure, Kernel, Way};
use crate::render::light::{HitOnLight, mis_weight};
use crate::render::ray::Ray;
use crate::render::surface::Surface;
use crate::render::technique::Direct;
use glam::Vec3;

impl Kernel<'_> {
    /// Radiance from infinity, weighted against light sampling.
    pub(super) fn escaped(&self, ray: &Ray, from: &Departure, bounce: u32) -> Vec3 {
        if bounce == 1
            && let Some(backdrop) = self.scene.backdrop
        {
            return backdrop;
        }
        let lights = &self.scene.lights;
        let radiance = lights.escaped(ray.dir);
        if radiance == Vec3::ZERO || from.way == Way::Caustic {
            return Vec3::ZERO;
        }
        let weight = self.weight(from, || lights.environment_pdf(from.p, from.n, from.two_sided, ray.dir));
        radiance * weight
    }

    /// The weight of emission that a scattered ray hit.
    pub(super) fn hit_weight(&self, ray: &Ray, from: &Departure, surface: &Surface, t: f32) -> f32 {
        if from.way == Way::Caustic {
            return 0.0;
        }
        if surface.light == Surface::NOT_A_LIGHT {
            return 1.0;
        }
        self.weight(from, || {
            let hit = HitOnLight {
                p: surface.p,
                ng: surface.ng,
                distance: t,
                time: ray.time,
            };
            self.scene
                .lights
                .pdf(surface.light, from.p, from.n, from.two_sided, ray.dir, &hit)
        })
    }

    /// Weight of a scattered direction against a light sample of density `light_pdf`.
    fn weight(&self, from: &Departure, light_pdf: impl FnOnce() -> f32) -> f32 {
        match (from.pdf, self.direct) {
            (None, _) | (_, Direct::Bsdf) => 1.0,
            (Some(pdf), Direct::Mis) => mis_weight(pdf, light_pdf()),
            (Some(_), Direct::Light) => f32::from(u8::from(light_pdf() == 0.0)),
        }
    }
}
