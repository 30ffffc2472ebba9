//! Solids that touch: where one ends and another begins in the same place.
//!
//! A ray goes on a little beside the surface it left, and what lies there too is never met: of two blocks of glass in
//! contact the second would never be entered or the first never left. So the other surface is looked up where
//! the first is met, and both are one interface, from the one solid to the other.

use crate::math::robust::offset_origin;
use crate::render::material::Material;
use crate::render::ray::Ray;
use crate::render::scene::CompiledScene;
use crate::render::surface::Surface;

/// A second surface in the same place, entered where the first is left or the other way round.
#[derive(Clone, Copy)]
pub(super) struct Contact<'a> {
    /// The other solid.
    pub object: u32,
    /// What it is made of.
    pub material: &'a Material,
}

/// The solid that is entered where the ray leaves that of `surface` (`front` false), or left where it enters; `None` if
/// there is none in contact, and where no solids touch.
pub(super) fn contact<'a>(scene: &'a CompiledScene, ray: &Ray, surface: &Surface, front: bool) -> Option<Contact<'a>> {
    let geometry = &scene.geometry;
    if !scene.traits.solids_touch {
        return None;
    }
    let origin = offset_origin(surface.p, surface.p_error, surface.ng, -ray.dir);
    let reach = (origin - surface.p).length();
    let cos = ray.dir.dot(surface.ng).abs();
    let probe = Ray {
        origin,
        t_max: 2.0 * reach / cos,
        from: surface.prim,
        to: surface.prim,
        ..*ray
    };
    let hit = geometry.closest_other(&probe)?;
    let other = geometry.surface(&probe, &hit);
    let material = &scene.materials[other.material as usize];
    let is_front = ray.dir.dot(other.ng) < 0.0;
    let away = (other.exact() - surface.exact()).dot(surface.ng.as_dvec3()).abs();
    let is_here = away <= f64::from(reach) && other.prim.object != surface.prim.object;
    (material.interior && is_here && is_front != front).then_some(Contact {
        object: other.prim.object,
        material,
    })
}
