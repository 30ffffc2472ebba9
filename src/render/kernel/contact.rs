//! Solids that touch: where one ends and another begins in the same place.
//!
//! A ray goes on a little beside the surface it left, and what lies there too is never met: of two blocks of glass in
//! contact the second would never be entered or the first never left. So the other surface is looked up where
//! the first is met, and both are one interface, from the one solid to the other.

use super::{Kernel, go_on};
use crate::math::robust::offset_origin;
use crate::render::material::Material;
use crate::render::ray::{PrimRef, Ray};
use crate::render::surface::Surface;

/// A second surface in the same place, entered where the first is left or the other way round.
#[derive(Clone, Copy)]
pub(super) struct Contact<'a> {
    /// The other solid.
    pub object: u32,
    /// What it is made of.
    pub material: &'a Material,
}

/// Surfaces in one place that are looked at.
const MOST: u32 = 16;

impl Kernel<'_> {
    /// The solid that is entered where the ray leaves that of `surface` (`front` false), or left where it enters; `None` if
    /// there is none in contact.
    pub(super) fn contact(&self, ray: &Ray, surface: &Surface, front: bool) -> Option<Contact<'_>> {
        let geometry = &self.scene.geometry;
        let origin = offset_origin(surface.p, surface.p_error, surface.ng, -ray.dir);
        let reach = (origin - surface.p).length();
        let cos = ray.dir.dot(surface.ng).abs();
        let mut probe = Ray {
            origin,
            t_max: 2.0 * reach / cos,
            from: surface.prim,
            to: PrimRef::NONE,
            ..*ray
        };
        for _ in 0..MOST {
            let hit = geometry.closest(&probe)?;
            let other = geometry.surface(&probe, &hit);
            let material = &self.scene.materials[other.material as usize];
            let is_front = ray.dir.dot(other.ng) < 0.0;
            let away = (other.exact() - surface.exact()).dot(surface.ng.as_dvec3()).abs();
            let in_place = away <= f64::from(reach);
            if material.interior && in_place && other.prim.object != surface.prim.object && is_front != front {
                return Some(Contact {
                    object: other.prim.object,
                    material,
                });
            }
            let t_max = probe.t_max - hit.t;
            probe = Ray {
                t_max,
                ..go_on(&probe, &other)
            };
        }
        None
    }
}
