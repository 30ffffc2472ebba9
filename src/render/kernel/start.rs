//! Where paths start: the solids around the camera.

use super::contact::contact;
use super::{Kernel, MOST_PASSES, go_on};
use crate::render::material::Material;
use crate::render::medium::MediumStack;
use crate::render::ray::Ray;
use crate::render::sampler::{Group, Sampler};
use crate::render::scene::CompiledScene;
use crate::render::surface::Surface;
use glam::Vec3;

/// The solids around the camera at a time, by walking a ray to infinity and looking from which side each is left.
///
/// The ray goes where the camera looks: a camera that stands in the very surface of a solid is then inside of it if its
/// picture shows the inside, and outside otherwise.
pub(super) fn media_around_camera(scene: &CompiledScene, time: f32) -> MediumStack {
    // A direction that no axis-aligned face contains: it leaves the view axis by 3° at most, so that the ray meets no
    // edge or corner that the picture is centred on.
    let aside = Vec3::new(0.267_261_24, 0.534_522_5, 0.801_783_7);
    let dir = (scene.camera.axis_at(time) + aside * 0.05).normalize();
    let mut ray = Ray {
        time,
        ..Ray::new(scene.camera.location_at(time).as_vec3(), dir)
    };
    let mut left_from_inside = Vec::new();
    let mut open: Vec<u32> = Vec::new();
    for _ in 0..MOST_PASSES {
        let Some(hit) = scene.geometry.closest(&ray) else { break };
        let surface = scene.geometry.surface(&ray, &hit);
        let material = &scene.materials[surface.material as usize];
        if material.interior {
            let mut pass = |object: u32, front: bool, material: &Material| {
                if front {
                    open.push(object);
                } else if let Some(i) = open.iter().rposition(|&o| o == object) {
                    open.remove(i);
                } else {
                    left_from_inside.push((object, material.ior, material.medium));
                }
            };
            let front = dir.dot(surface.ng) < 0.0;
            pass(surface.prim.object, front, material);
            if let Some(other) = contact(scene, &ray, &surface, front) {
                pass(other.object, !front, other.material);
            }
        }
        ray = go_on(&ray, &surface);
    }
    // The first one left is the innermost.
    let mut media = MediumStack::default();
    for (object, ior, medium) in left_from_inside.into_iter().rev() {
        media.enter(object, ior, medium);
    }
    media
}

/// Whether the camera may be inside of different solids at different times: it moves, or a solid does, and they come near
/// each other.
pub(super) fn media_vary(scene: &CompiledScene) -> bool {
    if !scene.traits.moves || !scene.traits.solids {
        return false;
    }
    let (min, max) = scene.camera.reach();
    let is_solid = |m: &u32| scene.materials.get(*m as usize).is_some_and(|m| m.interior);
    let objects = (0u32..).zip(scene.geometry.objects());
    objects
        .filter(|(_, o)| (o.motion.is_some() || scene.camera.moves()) && o.materials.iter().any(is_solid))
        .any(|(i, _)| match scene.geometry.bounds_of(i) {
            Some((low, high)) => low.cmple(max).all() && high.cmpge(min).all(),
            None => true, // a plane has no bounds
        })
}

impl Kernel<'_> {
    /// The time of a path, in [0, 1) of the time that the shutter is open; 0 where nothing moves.
    #[inline(always)]
    pub(super) fn time(&self, sampler: &Sampler) -> f32 {
        if self.scene.traits.moves {
            sampler.get4(0, Group::Light)[0]
        } else {
            0.0
        }
    }

    /// Makes `media`, what the camera is inside of when the shutter opens, what it is inside of when it sends a ray.
    #[inline(always)]
    pub(super) fn update_media(&self, media: &mut MediumStack, ray: &Ray) {
        if self.media_vary {
            *media = media_around_camera(self.scene, ray.time);
        }
    }

    /// Distance of a point along the view axis, from where the camera is at a time.
    pub(super) fn depth(&self, surface: &Surface, time: f32) -> f32 {
        if self.scene.camera.moves() {
            let away = surface.exact() - self.scene.camera.location_at(time);
            return away.as_vec3().dot(self.scene.camera.axis_at(time));
        }
        surface.p.dot(self.axis)
    }
}
