//! One path, from the camera until it ends.

use super::contact::contact;
use super::fold::Sides;
use super::tier::Tier;
use super::{Departure, FirstHit, Kernel, MIRROR_LIKE, MOST_PASSES, NO_ATTRIBUTES, PathSample, PathStats, Way};
use super::{go_on, nearly_unit};
use crate::math::robust::offset_origin;
use crate::render::bsdf::Bsdf;
use crate::render::material::Alpha;
use crate::render::ray::{PrimRef, Ray, ray_mask};
use crate::render::report::Anomaly;
use crate::render::sampler::{Group, Repeated, Sampler};
use crate::render::surface::Surface;
use crate::render::technique::Direct;
use crate::render::wavelength::Wavelength;
use glam::{DVec3, Vec2, Vec3};

impl Kernel<'_> {
    #[inline(always)]
    pub(super) fn path<T: Tier>(&self, sampler: &Sampler, stats: &mut PathStats, mut ray: Ray) -> PathSample {
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
        let mut wavelength: Option<Wavelength> = None;
        let mut bounce = 1u32; // 1 is the first surface
        let mut passes = 0u32;
        loop {
            stats.rays += 1;
            // Drawn before the ray is traced: they depend on nothing and fill the time the chain of roots leaves.
            let first_scatter = sampler.get4(bounce, Group::Primary);
            let hit = scene.geometry.closest(&ray);
            let found = hit.map(|hit| (hit, scene.geometry.surface(&ray, &hit)));
            if T::MEDIA {
                // From point to point: the ray itself starts a little beside the surface it left.
                let way = match (&found, &left) {
                    (Some((_, surface)), Some(left)) => (surface.exact() - *left).length() as f32,
                    (Some((hit, _)), None) => hit.t,
                    (None, _) => f32::INFINITY,
                };
                let numbers = || match passes {
                    0 => sampler.get4(bounce, Group::Medium),
                    _ => sampler.repeated4(bounce, Group::Medium, passes),
                };
                if let Some(t) = self.travel(&ray, way, &media, &mut throughput, &mut out.radiance, numbers) {
                    if self.aovs && bounce == 1 && out.first.depth.is_infinite() {
                        out.first = self.first_in_medium(&ray, t);
                    }
                    if bounce > self.max_depth {
                        return out;
                    }
                    let p = left.map_or_else(|| ray.at(f64::from(t)), |left| left + ray.direction() * f64::from(t));
                    let (scatter, light) = match passes {
                        0 => (first_scatter, sampler.get4(bounce, Group::Light)),
                        _ => (
                            sampler.repeated4(bounce, Group::Primary, passes),
                            sampler.repeated4(bounce, Group::Light, passes),
                        ),
                    };
                    let vertex = self.vertex(p, &ray, &media);
                    if self.sample_lights {
                        out.radiance +=
                            throughput * self.lit_in_medium::<T>(&vertex, light, from.way, wavelength, stats);
                    }
                    let (wi, pdf) = vertex
                        .phase
                        .sample(ray.dir, Vec2::new(scatter[0], scatter[1]), scatter[2]);
                    if !self.survives(&mut throughput, bounce, scatter[3]) {
                        return out;
                    }
                    from = Departure {
                        p: vertex.p,
                        n: Vec3::ZERO,
                        two_sided: true,
                        pdf: Some(pdf),
                        way: self.way_on(from.way, pdf >= MIRROR_LIKE),
                    };
                    left = Some(p);
                    ray = Ray {
                        mask: ray_mask::INDIRECT,
                        time: ray.time,
                        ..Ray::new(vertex.p, wi)
                    };
                    bounce += 1;
                    passes = 0;
                    continue;
                }
            }
            let Some((hit, surface)) = found else {
                out.radiance += throughput * self.escaped(&ray, &from, bounce);
                return out;
            };
            if T::MEDIA {
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
                Some(next) if !front => next.material.ior_at(wavelength),
                _ => media.ior_around(surface.prim.object),
            };
            if T::MEDIA && material.dispersion > 0.0 && wavelength.is_none() {
                // Only now: a path that meets no such glass is that of three channels, bit for bit.
                let chosen = Wavelength::sample(sampler.get4(0, Group::Light)[1]);
                throughput *= chosen.weight;
                wavelength = Some(chosen);
            }
            let shading = self.shading(attributes, outer_ior, if T::MEDIA { wavelength } else { None });
            let is_passed_by = material.unlit && from.pdf.is_some();
            if is_passed_by || material.alpha != Alpha::Opaque {
                let alpha = if is_passed_by { 0.0 } else { material.alpha(&shading) };
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
                let emitted = material.emission(&shading, front, wo.dot(surface.ns).abs());
                out.radiance += throughput * emitted * (self.hit_weight(&ray, &from, &surface, hit.t) * media.basic());
            }
            if bounce > self.max_depth && !self.aovs {
                return out;
            }

            let frame = material.shading_frame(&shading, surface.ng, surface.ns, wo);
            let ns = frame.n;
            let wo_local = frame.to_local(wo);
            let mut mixes = 0;
            let mut bsdf = material.bsdf(&shading, &mut || {
                mixes += 1;
                sampler.repeated(bounce, Repeated::Mix, passes * 64 + mixes)
            });
            if let Bsdf::Principled(layers) = &mut bsdf {
                layers.lean = material.lean_of_base(&shading, &frame, surface.ng, surface.ns, wo);
            }
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
                    let lit = self.lit::<T>(&light, &sides, &surface, &media, from.way, wavelength, stats);
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
            throughput *= s.weight * (s.eta * s.eta);
            if sides.meets_slope(&s, wi) {
                throughput *= bsdf.albedo(wo_local).clamp(Vec3::ZERO, Vec3::ONE);
                let numbers = |group| sampler.repeated4(bounce, group, MOST_PASSES + 1 + passes);
                let slope = self.slope::<T>(&sides, &surface, &media, from.way, wavelength, ray.time, numbers, stats);
                out.radiance += throughput * slope.lit;
                let Some((wi, pdf)) = slope.next else {
                    return out;
                };
                if !self.survives(&mut throughput, bounce, scatter[3]) {
                    return out;
                }
                from = Departure {
                    p: surface.p,
                    n: sides.up(),
                    two_sided: false,
                    pdf: Some(pdf),
                    way: self.way_on(from.way, false),
                };
                ray = leaving(&surface, wi, ray.time);
                bounce += 1;
                passes = 0;
                continue;
            }
            let (wi, pdf) = sides.fold(&s, wi);
            if crosses && material.interior {
                let ior = material.ior_at(wavelength);
                let mut is_known = media.cross(surface.prim.object, front, ior, material.medium);
                if let Some(other) = contact {
                    let ior = other.material.ior_at(wavelength);
                    is_known &= media.cross(other.object, !front, ior, other.material.medium);
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

            if !self.survives(&mut throughput, bounce, scatter[3]) {
                return out;
            }
            from = Departure {
                p: surface.p,
                n: toward,
                two_sided,
                pdf: (!s.delta).then_some(pdf),
                way: self.way_on(from.way, s.delta || pdf >= MIRROR_LIKE),
            };
            ray = leaving(&surface, wi, ray.time);
            bounce += 1;
            passes = 0;
        }
    }
}

/// The ray of a scattered path.
#[inline(always)]
fn leaving(surface: &Surface, wi: Vec3, time: f32) -> Ray {
    Ray {
        origin: offset_origin(surface.p, surface.p_error, surface.ng, wi),
        dir: wi,
        dir_low: Vec3::ZERO,
        t_max: f32::INFINITY,
        from: surface.prim,
        to: PrimRef::NONE,
        mask: ray_mask::INDIRECT,
        time,
    }
}
