//! Where paths start: the solids around the camera.

use super::contact::contact;
use super::{MOST_PASSES, go_on};
use crate::render::material::Material;
use crate::render::medium::MediumStack;
use crate::render::ray::Ray;
use crate::render::scene::CompiledScene;
use glam::Vec3;

/// The solids around the camera, by walking a ray to infinity and looking from which side each is left.
///
/// The ray goes where the camera looks: a camera that stands in the very surface of a solid is then inside of it if its
/// picture shows the inside, and outside otherwise.
pub(super) fn media_around_camera(scene: &CompiledScene) -> MediumStack {
    // A direction that no axis-aligned face contains: it leaves the view axis by 3° at most, so that the ray meets no
    // edge or corner that the picture is centred on.
    let aside = Vec3::new(0.267_261_24, 0.534_522_5, 0.801_783_7);
    let dir = (scene.camera.axis() + aside * 0.05).normalize();
    let mut ray = Ray::new(Vec3::ZERO, dir);
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
