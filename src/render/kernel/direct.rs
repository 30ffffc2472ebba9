//! Light samples: what they add, and what stands in their way.

use super::contact::contact;
use super::fold::Sides;
use super::tier::Tier;
use super::{Kernel, MIRROR_LIKE, MOST_PASSES, NO_ATTRIBUTES, PathStats, Way, go_on};
use crate::math::frame::Frame;
use crate::render::bsdf::Bsdf;
use crate::render::bsdf::diffuse::Diffuse;
use crate::render::light::{LightSample, mis_weight};
use crate::render::material::Material;
use crate::render::medium::{Medium, MediumStack};
use crate::render::ray::{Hit, PrimRef, Ray};
use crate::render::report::Anomaly;
use crate::render::sampler::Group;
use crate::render::surface::Surface;
use crate::render::technique::Direct;
use crate::render::wavelength::Wavelength;
use glam::{Vec2, Vec3};

/// What [`Kernel::slope`] scatters.
pub(super) struct Slope {
    /// What a light sample adds.
    pub lit: Vec3,
    /// Where the path goes on, and the density of that direction.
    pub next: Option<(Vec3, f32)>,
}

impl Kernel<'_> {
    /// What one light sample adds to the radiance that leaves the surface.
    #[allow(clippy::too_many_arguments)] // what a path is made of
    pub(super) fn lit<T: Tier>(
        &self,
        light: &LightSample,
        sides: &Sides,
        surface: &Surface,
        media: &MediumStack,
        way: Way,
        wavelength: Option<Wavelength>,
        stats: &mut PathStats,
    ) -> Vec3 {
        let (mut f, bsdf_pdf) = sides.eval_pdf(light.wi);
        let is_caustic = way != Way::Any && way.after(bsdf_pdf >= MIRROR_LIKE) == Way::Caustic;
        if f == Vec3::ZERO || is_caustic {
            return Vec3::ZERO;
        }
        let weight = if light.delta || self.direct == Direct::Light {
            1.0
        } else {
            mis_weight(light.pdf, bsdf_pdf)
        };
        let radiance = if light.textured {
            self.textured_emission(light, surface.p)
        } else {
            light.radiance
        };
        let material = &self.scene.materials[surface.material as usize];
        let behind;
        let mut media = media;
        let crosses = (light.wi.dot(surface.ng) < 0.0) != (sides.wo.z < 0.0);
        if crosses {
            let eta = sides.bsdf.eta_across(sides.wo);
            f *= eta * eta; // radiance over n², as along the path
        }
        if crosses && material.interior {
            let mut beyond = media.clone();
            let is_known = beyond.cross(
                surface.prim.object,
                sides.wo.z >= 0.0,
                material.ior_at(wavelength),
                material.medium,
            );
            stats.anomalies.count(Anomaly::StackOverflow, u64::from(!is_known));
            behind = beyond;
            media = &behind;
        }
        let unshadowed = f * radiance * (weight / light.pdf);
        if unshadowed == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let ray = light.shadow_ray(surface);
        // Nearer than rounding can tell the light may as well be behind: what the ray meets decides.
        if ray.t_max <= 0.0 && light.to != PrimRef::NONE && !self.scene.geometry.reaches(&ray) {
            return Vec3::ZERO;
        }
        unshadowed * self.visibility::<T>(light, ray, media, wavelength, stats)
    }

    /// Reflected light that a slope has sent below the surface meets the next slope: a white, even surface about the
    /// geometric normal, at the same point.
    #[cold]
    #[inline(never)]
    #[allow(clippy::too_many_arguments)] // what a path is made of
    pub(super) fn slope<T: Tier>(
        &self,
        sides: &Sides,
        surface: &Surface,
        media: &MediumStack,
        way: Way,
        wavelength: Option<Wavelength>,
        time: f32,
        numbers: impl Fn(Group) -> [f32; 4],
        stats: &mut PathStats,
    ) -> Slope {
        let frame = Frame::from_normal(sides.ng);
        let white = Diffuse { albedo: Vec3::ONE };
        let even = Sides {
            bsdf: &Bsdf::Diffuse(white),
            frame: &frame,
            ng: sides.ng,
            wo: Vec3::new(0.0, 0.0, 1.0f32.copysign(sides.wo.z)),
        };
        let u = numbers(Group::Light);
        let place = Vec2::new(u[0], u[1]);
        let sampled = self
            .scene
            .lights
            .sample(surface.p, sides.up(), false, u[2], place, time);
        let lit = match sampled.filter(|_| self.sample_lights) {
            Some(light) if light.delta || self.direct != Direct::Bsdf => {
                self.lit::<T>(&light, &even, surface, media, way, wavelength, stats)
            }
            _ => Vec3::ZERO,
        };
        let u = numbers(Group::Primary);
        let next = white.sample(even.wo, Vec2::new(u[0], u[1]));
        let next = next.map(|s| even.fold(&s, frame.to_world(s.wi)));
        Slope { lit, next }
    }

    /// The radiance that the sampled point of a textured light emits towards `p`, as far as the light is there.
    pub(super) fn textured_emission(&self, light: &LightSample, p: Vec3) -> Vec3 {
        let geometry = &self.scene.geometry;
        let hit = Hit {
            t: light.distance,
            exact: f64::from(light.distance),
            prim: light.to,
            b: light.b,
        };
        let towards = Ray {
            time: light.time,
            ..Ray::new(p, light.wi)
        };
        let surface = geometry.surface(&towards, &hit);
        let attributes = geometry.attributes(&hit, &surface, light.time);
        let front = light.wi.dot(surface.ng) < 0.0;
        let (material, shading) = (
            &self.scene.materials[surface.material as usize],
            self.shading(&attributes, 1.0, None),
        );
        material.emission(&shading, front, light.wi.dot(surface.ns).abs()) * material.alpha(&shading)
    }

    /// The share of a light sample's radiance that arrives, per channel.
    pub(super) fn visibility<T: Tier>(
        &self,
        light: &LightSample,
        mut ray: Ray,
        media: &MediumStack,
        wavelength: Option<Wavelength>,
        stats: &mut PathStats,
    ) -> Vec3 {
        let traits = self.scene.traits;
        let through_glass = light.delta && traits.lamp_through_glass;
        if !light.casts_shadow {
            return Vec3::splat(media.basic());
        }
        // What is left after a way between surfaces. Fog does not dim lamps.
        let passed = |media: &MediumStack, ray: &Ray, way: f32| {
            if !T::MEDIA {
                return Vec3::ONE;
            }
            let left = self.medium(media).transmittance(way);
            if light.delta || self.scene.fogs.is_empty() {
                return left;
            }
            left * self.through_fogs(media, ray, way)
        };
        // What comes from infinitely far away comes from air.
        let given = |media: &MediumStack| match light.distance.is_finite() {
            true => media.basic(),
            false => 1.0,
        };
        if !traits.see_through && !through_glass {
            stats.rays += 1;
            if self.scene.geometry.occluded(&ray) {
                return Vec3::ZERO;
            }
            return passed(media, &ray, light.distance) * given(media);
        }
        let mut media = media.clone();
        let mut left = Vec3::ONE;
        let mut rest = light.distance;
        for _ in 0..MOST_PASSES {
            stats.rays += 1;
            let Some(hit) = self.scene.geometry.closest(&ray) else {
                return left * passed(&media, &ray, rest) * given(&media);
            };
            let surface = self.scene.geometry.surface(&ray, &hit);
            let material = &self.scene.materials[surface.material as usize];
            let attributes = if material.needs_attributes {
                self.scene.geometry.attributes(&hit, &surface, ray.time)
            } else {
                NO_ATTRIBUTES
            };
            let cos = ray.dir.dot(surface.ng);
            let around = media.ior_around(surface.prim.object);
            let shading = self.shading(&attributes, around, if T::MEDIA { wavelength } else { None });
            let straight = material.straight_transmittance(&shading, cos.abs(), through_glass);
            let alpha = if material.unlit { 0.0 } else { material.alpha(&shading) };
            left *= passed(&media, &ray, hit.t) * (straight * alpha + Vec3::splat(1.0 - alpha));
            if left == Vec3::ZERO {
                return left;
            }
            if material.interior && alpha > 0.0 {
                let front = cos < 0.0;
                let mut cross = |object: u32, inward: bool, m: &Material| {
                    media.cross(object, inward, m.ior_at(wavelength), m.medium)
                };
                let mut is_known = cross(surface.prim.object, front, material);
                if let Some(other) = contact(self.scene, &ray, &surface, front) {
                    is_known &= cross(other.object, !front, other.material);
                }
                stats.anomalies.count(Anomaly::StackOverflow, u64::from(!is_known));
            }
            rest -= hit.t;
            let next = go_on(&ray, &surface);
            let t_max = ray.t_max - hit.t - (next.origin - surface.p).length() * light.slant;
            if t_max <= 0.0 {
                return left * given(&media);
            }
            ray = Ray { t_max, ..next };
        }
        stats.anomalies.count(Anomaly::StackOverflow, 1);
        Vec3::ZERO
    }

    /// What fills the place of a path that is inside of these solids.
    pub(super) fn medium(&self, media: &MediumStack) -> &Medium {
        &self.scene.media[media.medium(self.scene.atmosphere) as usize]
    }
}
