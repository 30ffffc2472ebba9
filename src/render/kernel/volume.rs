//! What happens between surfaces: media take light, shine and scatter; fog hides.

use super::tier::Tier;
use super::{FirstHit, Kernel, MIRROR_LIKE, PathStats, Way};
use crate::render::light::mis_weight;
use crate::render::medium::fog::Fog;
use crate::render::medium::phase::Phase;
use crate::render::medium::{MediumStack, Passage, passage};
use crate::render::ray::Ray;
use crate::render::technique::Direct;
use crate::render::wavelength::Wavelength;
use glam::{DVec3, Vec2, Vec3};

/// A point at which a medium scatters.
pub(super) struct Vertex<'a> {
    /// Where it is.
    pub p: Vec3,
    /// Unit direction of the path before it.
    pub dir: Vec3,
    /// Where light goes from it.
    pub phase: Phase,
    /// When the path is there, in [0, 1) of the shutter.
    time: f32,
    media: &'a MediumStack,
}

impl Kernel<'_> {
    /// Takes a path over a way of this length (infinite if it meets nothing). Gives the distance at which it is scattered
    /// on it, if it is. `numbers` are those of the group `Medium`, asked for only where something scatters.
    #[inline]
    pub(super) fn travel(
        &self,
        ray: &Ray,
        way: f32,
        media: &MediumStack,
        throughput: &mut Vec3,
        radiance: &mut Vec3,
        numbers: impl Fn() -> [f32; 4],
    ) -> Option<f32> {
        let medium = self.medium(media);
        if medium.emission != Vec3::ZERO {
            *radiance += *throughput * medium.emitted(way) * media.basic();
        }
        let [u, channel, ..] = if medium.scatters() { numbers() } else { [0.0; 4] };
        let before = *throughput;
        let scattered = match passage(medium, way, before, u, channel) {
            Passage::Through(factor) => {
                *throughput *= factor;
                None
            }
            Passage::Scattered(t, factor) => {
                *throughput *= factor;
                Some(t)
            }
        };
        if media.is_empty() {
            let mut before = before;
            for fog in &self.scene.fogs {
                let left = fog.transmittance(ray.origin, ray.dir, scattered.unwrap_or(way));
                *radiance += before * fog.color * (1.0 - left);
                before *= left;
                *throughput *= left;
            }
        }
        scattered
    }

    /// The share that fogs leave of light that is not a lamp's.
    pub(super) fn through_fogs(&self, media: &MediumStack, ray: &Ray, way: f32) -> f32 {
        if !media.is_empty() {
            return 1.0;
        }
        let left = |fog: &Fog| fog.transmittance(ray.origin, ray.dir, way);
        self.scene.fogs.iter().map(left).product()
    }

    pub(super) fn vertex<'m>(&self, p: DVec3, ray: &Ray, media: &'m MediumStack) -> Vertex<'m> {
        let medium = self.medium(media);
        Vertex {
            p: p.as_vec3(),
            dir: ray.dir,
            time: ray.time,
            phase: medium.phase,
            media,
        }
    }

    /// What the first layers show of a path that is scattered before it meets a surface: haze, white, facing the camera.
    pub(super) fn first_in_medium(&self, ray: &Ray, t: f32) -> FirstHit {
        FirstHit {
            depth: ray.at(f64::from(t)).as_vec3().dot(self.axis),
            normal: -ray.dir,
            albedo: Vec3::ONE,
        }
    }

    /// What one light sample adds to the radiance that goes on from a point in a medium. `u` are the numbers of the group
    /// `Light`.
    pub(super) fn lit_in_medium<T: Tier>(
        &self,
        vertex: &Vertex,
        u: [f32; 4],
        way: Way,
        wavelength: Option<Wavelength>,
        stats: &mut PathStats,
    ) -> Vec3 {
        let lights = &self.scene.lights;
        let Some(light) = lights.sample(vertex.p, Vec3::ZERO, true, u[2], Vec2::new(u[0], u[1]), vertex.time) else {
            return Vec3::ZERO;
        };
        if !light.delta && self.direct == Direct::Bsdf {
            return Vec3::ZERO;
        }
        let f = vertex.phase.density(light.wi.dot(vertex.dir).clamp(-1.0, 1.0));
        if way != Way::Any && way.after(f >= MIRROR_LIKE) == Way::Caustic {
            return Vec3::ZERO;
        }
        let weight = if light.delta || self.direct == Direct::Light {
            1.0
        } else {
            mis_weight(light.pdf, f)
        };
        let radiance = if light.textured {
            self.textured_emission(&light, vertex.p)
        } else {
            light.radiance
        };
        let unshadowed = radiance * (f * weight / light.pdf);
        if unshadowed == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let ray = light.shadow_ray_from(vertex.p);
        unshadowed * self.visibility::<T>(&light, ray, vertex.media, wavelength, stats)
    }
}
