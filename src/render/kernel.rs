//! The path tracer: one sample of one pixel.
//!
//! A loop, not a recursion. At each surface: light it emits (weighted against light sampling), one light sample,
//! one scattered direction, roulette. A pass-through (coverage, straight transmission) does not count as a
//! bounce: the path goes on as if the surface were not there, and light sampling looks through it as well.

mod contact;
mod direct;
mod fold;
mod roulette;
mod start;
#[cfg(test)]
mod tests;
mod weigh;

use super::bsdf::Bsdf;
use super::material::{Alpha, Shading};
use super::medium::MediumStack;
use super::ray::{PrimRef, Ray, ray_mask};
use super::report::{Anomalies, Anomaly};
use super::sampler::{Group, Repeated, Sampler};
use super::scene::CompiledScene;
use super::settings::Settings;
use super::surface::{Attributes, Surface};
use super::technique::{Direct, Roulette, SamplerKind};
use crate::math::robust::offset_origin;
use contact::contact;
use fold::Sides;
use glam::{DVec3, Vec2, Vec3};

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
        }
    }

    /// The numbers of a sample.
    pub fn sampler(&self, pixel: u32, sample: u32) -> Sampler {
        Sampler::of_kind(self.sampler, self.seed, pixel, u64::from(sample), self.nets)
    }

    /// Traces one path. A sample with a NaN or infinite value is counted and becomes black.
    #[inline(always)]
    pub fn trace(
        &self,
        sampler: &Sampler,
        stats: &mut PathStats,
        camera_ray: impl FnOnce([f32; 4], f32) -> Ray,
    ) -> PathSample {
        let ray = camera_ray(sampler.get4(0, Group::Primary), self.time(sampler));
        let mut sample = self.path(sampler, stats, ray);
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

    #[inline(always)]
    fn path(&self, sampler: &Sampler, stats: &mut PathStats, mut ray: Ray) -> PathSample {
        let scene = self.scene;
        let mut out = PathSample {
            radiance: Vec3::ZERO,
            first: FirstHit {
                depth: f32::INFINITY,
                normal: Vec3::ZERO,
                albedo: Vec3::ZERO,
            },
        };
        // In a medium of index n radiance is n² times that outside. Paths carry radiance over n², which no refraction
        // changes: what comes from the environment, which stands in air as the camera does, keeps its share whatever
        // surfaces are open, cut by the camera or too thin to be told apart. Emitters in a medium give 1/n² of theirs.
        let mut throughput = Vec3::ONE;
        let mut from = Departure {
            p: ray.origin,
            n: Vec3::ZERO,
            two_sided: true,
            pdf: None,
            way: Way::Any,
        };
        let mut media = self.camera_media.clone();
        self.update_media(&mut media, &ray);
        let mut left: Option<DVec3> = None;
        let mut bounce = 1u32; // 1 is the first surface
        let mut passes = 0u32;
        loop {
            stats.rays += 1;
            // Drawn before the ray is traced: they depend on nothing and fill the time the chain of roots leaves.
            let first_scatter = sampler.get4(bounce, Group::Primary);
            let Some(hit) = scene.geometry.closest(&ray) else {
                out.radiance += throughput * self.escaped(&ray, &from, bounce);
                return out;
            };
            let surface = scene.geometry.surface(&ray, &hit);
            if !media.is_empty() {
                // From point to point: the ray itself starts a little beside the surface it left.
                let way = match &left {
                    Some(left) => (surface.exact() - *left).length() as f32,
                    None => hit.t,
                };
                throughput *= media.transmittance(way);
            }
            if scene.traits.solids {
                left = Some(surface.exact());
            }
            let material = &scene.materials[surface.material as usize];
            let computed;
            let attributes = if material.needs_attributes {
                computed = scene.geometry.attributes(&hit, &surface, ray.time);
                &computed
            } else {
                &NO_ATTRIBUTES
            };
            let wo = -ray.dir;
            let front = wo.dot(surface.ng) >= 0.0;
            let contact = match material.interior {
                true => contact(scene, &ray, &surface, front),
                false => None,
            };
            let outer_ior = match contact {
                Some(next) if !front => next.material.ior,
                _ if scene.traits.solids => media.ior_around(surface.prim.object),
                _ => 1.0,
            };
            let shading = self.shading(attributes, outer_ior);
            if material.alpha != Alpha::Opaque {
                let alpha = material.alpha(&shading);
                if alpha < 1.0 && sampler.repeated(bounce, Repeated::Coverage, passes) >= alpha {
                    if passes == MOST_PASSES {
                        stats.anomalies.count(Anomaly::StackOverflow, 1);
                        return out;
                    }
                    passes += 1;
                    ray = go_on(&ray, &surface);
                    continue;
                }
            }
            if material.emits_front {
                let emitted = material.emission(&shading, front);
                out.radiance += throughput * emitted * (self.hit_weight(&ray, &from, &surface, hit.t) * media.basic());
            }
            if bounce > self.max_depth && !self.aovs {
                return out;
            }

            let frame = material.shading_frame(&shading, surface.ng, surface.ns, wo);
            let ns = frame.n;
            let wo_local = frame.to_local(wo);
            let mut mixes = 0;
            let bsdf = material.bsdf(&shading, &mut || {
                mixes += 1;
                sampler.repeated(bounce, Repeated::Mix, passes * 64 + mixes)
            });
            if self.aovs && bounce == 1 && out.first.depth.is_infinite() {
                let facing = if ns.dot(wo) < 0.0 { -ns } else { ns };
                out.first = FirstHit {
                    depth: self.depth(&surface, ray.time),
                    normal: facing,
                    albedo: bsdf.albedo(wo_local),
                };
            }
            if bounce > self.max_depth {
                return out;
            }

            let (scatter, light) = if passes == 0 {
                (first_scatter, None)
            } else {
                (
                    sampler.repeated4(bounce, Group::Primary, passes),
                    Some(sampler.repeated4(bounce, Group::Light, passes)),
                )
            };
            let sides = Sides {
                bsdf: &bsdf,
                frame: &frame,
                ng: surface.ng,
                wo: wo_local,
            };
            let delta_only = bsdf.is_delta_only();
            let two_sided = bsdf.transmits();
            let toward = if wo_local.z < 0.0 { -ns } else { ns };
            if self.sample_lights && !delta_only {
                let u = light.unwrap_or_else(|| sampler.get4(bounce, Group::Light));
                let sampled = scene
                    .lights
                    .sample(surface.p, toward, two_sided, u[2], Vec2::new(u[0], u[1]), ray.time);
                if let Some(light) = sampled
                    && (light.delta || self.direct != Direct::Bsdf)
                {
                    let lit = self.lit(&light, &sides, &surface, &media, from.way, stats);
                    out.radiance += throughput * lit;
                }
            }

            let Some(s) = bsdf.sample(wo_local, Vec2::new(scatter[0], scatter[1]), scatter[2]) else {
                return out;
            };
            let wi = frame.to_world(s.wi);
            // A diffuse direction is new; others inherit the length of the old one, which must not drift.
            let wi = if matches!(bsdf, Bsdf::Diffuse(_)) {
                wi
            } else {
                nearly_unit(wi)
            };
            let crosses = (s.wi.z < 0.0) != (wo_local.z < 0.0);
            let (wi, pdf) = sides.fold(&s, wi);
            throughput *= s.weight * (s.eta * s.eta);
            if crosses && material.interior {
                let mut is_known = media.cross(surface.prim.object, front, material);
                if let Some(other) = contact {
                    is_known &= media.cross(other.object, !front, other.material);
                }
                if !is_known {
                    stats.anomalies.count(Anomaly::StackOverflow, 1);
                    return out;
                }
            }
            if s.straight {
                if passes == MOST_PASSES {
                    stats.anomalies.count(Anomaly::StackOverflow, 1);
                    return out;
                }
                passes += 1;
                ray = go_on(&ray, &surface);
                continue;
            }

            if bounce >= self.roulette_from {
                let survival = roulette::survival(throughput, bounce);
                if scatter[3] >= survival {
                    return out;
                }
                throughput /= survival;
            } else if throughput == Vec3::ZERO {
                return out;
            }
            from = Departure {
                p: surface.p,
                n: toward,
                two_sided,
                pdf: (!s.delta).then_some(pdf),
                way: if self.caustics {
                    Way::Any
                } else {
                    from.way.after(s.delta || pdf >= MIRROR_LIKE)
                },
            };
            ray = Ray {
                origin: offset_origin(surface.p, surface.p_error, surface.ng, wi),
                dir: wi,
                dir_low: Vec3::ZERO,
                t_max: f32::INFINITY,
                from: surface.prim,
                to: PrimRef::NONE,
                mask: ray_mask::INDIRECT,
                time: ray.time,
            };
            bounce += 1;
            passes = 0;
        }
    }

    fn shading<'s>(&'s self, attrs: &'s Attributes, outer_ior: f32) -> Shading<'s> {
        Shading {
            materials: &self.scene.materials,
            textures: &self.scene.textures,
            attrs,
            outer_ior,
            channel: None,
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
