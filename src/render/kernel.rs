//! The path tracer: one sample of one pixel.
//!
//! A loop, not a recursion. At each surface: light it emits (weighted against light sampling), one light sample,
//! one scattered direction, roulette. A pass-through (coverage, straight transmission) does not count as a
//! bounce: the path goes on as if the surface were not there, and light sampling looks through it as well.

mod contact;
mod direct;
mod fold;
mod path;
mod roulette;
mod start;
#[cfg(test)]
mod tests;
pub mod tier;
mod volume;
mod weigh;

use super::material::Shading;
use super::medium::MediumStack;
use super::ray::Ray;
use super::report::{Anomalies, Anomaly};
use super::sampler::{Group, Sampler};
use super::scene::CompiledScene;
use super::settings::Settings;
use super::surface::{Attributes, Surface};
use super::technique::{Direct, Roulette, SamplerKind};
use super::wavelength::Wavelength;
use crate::math::robust::offset_origin;
use glam::{Vec2, Vec3};
use tier::{KernelTier, Tier};

/// Scattering into a direction of at least this density, in 1/sr, is like that of a mirror where caustics are left out:
/// 50 times that of a diffuse surface at its densest; the middle of the reflection of facets of α ≤ 0.07 is above it.
pub const MIRROR_LIKE: f32 = 16.0;
/// Surfaces a ray may pass through between two scatterings before it is given up (counted as an anomaly).
const MOST_PASSES: u32 = 4096;

/// Counts kept while tracing.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathStats {
    /// Rays of all kinds.
    pub rays: u64,
    /// What should not happen.
    pub anomalies: Anomalies,
    /// Samples that were scaled down by the technique's limit.
    pub clamped: u64,
}

/// What the camera ray met first; for extra layers.
#[derive(Clone, Copy, Debug)]
pub struct FirstHit {
    /// Distance along the view axis; infinite if nothing was hit.
    pub depth: f32,
    /// Shading normal facing the camera; zero if nothing was hit.
    pub normal: Vec3,
    /// Albedo seen from the camera.
    pub albedo: Vec3,
}

/// One sample.
#[derive(Clone, Copy, Debug)]
pub struct PathSample {
    /// Radiance, linear RGB; finite.
    pub radiance: Vec3,
    /// The first surface.
    pub first: FirstHit,
}

/// The vertex a ray left, as far as weighting the light it may hit needs it.
#[derive(Clone, Copy)]
struct Departure {
    p: Vec3,
    n: Vec3,
    two_sided: bool,
    /// Density of the direction; `None` if light sampling cannot compete (camera, delta lobe).
    pdf: Option<f32>,
    /// How the path got here, as far as caustics are concerned; [`Way::Any`] where they count.
    way: Way,
}

/// What a path has met on its way from the camera, where caustics do not count.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Nothing rough, or nobody asks.
    Any,
    /// A rough surface last.
    Rough,
    /// A rough surface, and only mirror-like ones since: light from here is a caustic.
    Caustic,
}

impl Way {
    fn after(self, mirror_like: bool) -> Way {
        match (self, mirror_like) {
            (_, false) => Way::Rough,
            (Way::Any, true) => Way::Any,
            (Way::Rough | Way::Caustic, true) => Way::Caustic,
        }
    }
}

/// A scene with settings, ready to trace.
pub struct Kernel<'a> {
    scene: &'a CompiledScene,
    seed: u64,
    nets: u32,
    sampler: SamplerKind,
    max_depth: u32,
    direct: Direct,
    /// The bounce at which roulette begins.
    roulette_from: u32,
    /// The largest radiance of a sample; infinite for no limit.
    clamp: f32,
    caustics: bool,
    /// Whether surfaces take light samples at all.
    sample_lights: bool,
    /// What the camera is inside of, at the shutter's opening.
    camera_media: MediumStack,
    /// Whether that may change while the shutter is open.
    media_vary: bool,
    axis: Vec3,
    aovs: bool,
    tier: KernelTier,
}

impl<'a> Kernel<'a> {
    /// Prepares tracing.
    pub fn new(scene: &'a CompiledScene, settings: &Settings) -> Kernel<'a> {
        let lights = &scene.lights;
        let (a, technique) = (settings.aovs, &settings.technique);
        Kernel {
            scene,
            seed: settings.seed,
            nets: settings.nets,
            sampler: technique.sampler,
            max_depth: technique.max_depth,
            direct: technique.direct,
            roulette_from: match technique.roulette {
                Roulette::Throughput => roulette::FROM,
                Roulette::Late => roulette::ALWAYS_FROM,
            },
            clamp: technique.clamp.unwrap_or(f32::INFINITY),
            caustics: technique.caustics,
            sample_lights: if technique.direct == Direct::Bsdf {
                lights.has_delta()
            } else {
                !lights.is_empty()
            },
            media_vary: start::media_vary(scene),
            camera_media: if scene.traits.solids {
                start::media_around_camera(scene, 0.0)
            } else {
                MediumStack::default()
            },
            axis: scene.camera.axis(),
            aovs: a.depth || a.normal || a.albedo,
            tier: KernelTier::of(&scene.traits),
        }
    }

    /// What paths are compiled to watch for.
    pub fn tier(&self) -> KernelTier {
        self.tier
    }

    /// The numbers of a sample.
    pub fn sampler(&self, pixel: u32, sample: u32) -> Sampler {
        Sampler::of_kind(self.sampler, self.seed, pixel, u64::from(sample), self.nets)
    }

    /// Traces one path. A sample with a NaN or infinite value is counted and becomes black.
    #[inline(always)]
    pub fn trace<T: Tier>(
        &self,
        sampler: &Sampler,
        stats: &mut PathStats,
        camera_ray: impl FnOnce([f32; 4], f32) -> Ray,
    ) -> PathSample {
        let ray = camera_ray(sampler.get4(0, Group::Primary), self.time(sampler));
        let mut sample = self.path::<T>(sampler, stats, ray);
        if !sample.radiance.is_finite() {
            stats.anomalies.count(Anomaly::NonFinite, 1);
            sample.radiance = Vec3::ZERO;
        }
        let brightest = sample.radiance.max_element();
        if brightest > self.clamp {
            stats.clamped += 1;
            // The quotient of a number by itself is 1: the brightest channel becomes the limit exactly.
            sample.radiance = sample.radiance / brightest * self.clamp;
        }
        sample
    }

    /// The way of a path that is scattered on; caustics that count need no book.
    #[inline(always)]
    fn way_on(&self, way: Way, mirror_like: bool) -> Way {
        if self.caustics {
            Way::Any
        } else {
            way.after(mirror_like)
        }
    }

    fn shading<'s>(&'s self, attrs: &'s Attributes, outer_ior: f32, wavelength: Option<Wavelength>) -> Shading<'s> {
        Shading {
            materials: &self.scene.materials,
            textures: &self.scene.textures,
            attrs,
            outer_ior,
            wavelength,
        }
    }
}

/// A vector whose length is 1 but for rounding, brought nearer to 1: one Newton step for 1/√x at x ≈ 1, which squares
/// the deviation. Keeps directions from drifting over many bounces.
#[inline(always)]
fn nearly_unit(v: Vec3) -> Vec3 {
    v * (1.5 - 0.5 * v.length_squared())
}

/// The same ray behind a surface it passes through.
fn go_on(ray: &Ray, surface: &Surface) -> Ray {
    Ray {
        origin: offset_origin(surface.p, surface.p_error, surface.ng, ray.dir),
        from: surface.prim,
        ..*ray
    }
}

static NO_ATTRIBUTES: Attributes = Attributes {
    uv: [Vec2::ZERO; 4],
    color: glam::Vec4::ONE,
    tangent: Vec3::ZERO,
    bitangent: Vec3::ZERO,
};
