//! The emitting parallelogram.

use super::triangle::FlatTarget;
use super::{Aim, HitOnLight, Receiver, shadow_end};
use crate::render::ray::PrimRef;
use glam::{DVec3, Vec2, Vec3};

/// A parallelogram that emits, on the side of `e1 × e2` or on both; sampled uniformly in area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelogramLight {
    /// First corner.
    pub p0: Vec3,
    /// Whole first edge.
    pub e1: Vec3,
    /// Whole second edge.
    pub e2: Vec3,
    /// Emitted radiance, an average if `textured`.
    pub radiance: Vec3,
    /// Whether the back emits too.
    pub two_sided: bool,
    /// Whether the emission varies over the surface.
    pub textured: bool,
    /// The primitive: a face of a box.
    pub prim: PrimRef,
}

impl ParallelogramLight {
    /// e1 × e2: towards the front, as long as the area.
    pub(crate) fn normal_area(&self) -> DVec3 {
        self.e1.as_dvec3().cross(self.e2.as_dvec3())
    }

    fn target(&self) -> FlatTarget {
        FlatTarget {
            normal: self.normal_area(),
            two_sided: self.two_sided,
        }
    }

    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let q = self.p0.as_dvec3() + self.e1.as_dvec3() * f64::from(u.x) + self.e2.as_dvec3() * f64::from(u.y);
        let (wi, pdf, t) = self.target().aim_at(at, q)?;
        Some(Aim {
            wi,
            radiance: self.radiance,
            pdf,
            t_max: shadow_end(t as f32, at.p),
            distance: t as f32,
            to: self.prim,
            b: u,
            textured: self.textured,
            casts_shadow: true,
        })
    }

    /// Density of `sample` for a direction that hits the parallelogram.
    pub(crate) fn pdf(&self, wi: Vec3, hit: &HitOnLight) -> f32 {
        self.target().pdf(wi, hit.distance)
    }
}
