//! The emitting parallelogram.

use super::choice::remap;
use super::flat::FlatTarget;
use super::solid_angle::SphericalTriangle;
use super::{Aim, HitOnLight, Receiver};
use crate::render::ray::{PrimRef, split_direction};
use glam::{DVec3, Vec2, Vec3};

/// A parallelogram that emits, on the side of `e1 × e2` or on both. Sampled uniformly in solid
/// angle if it is near, in area if it is far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelogramLight {
    /// First corner.
    pub p0: DVec3,
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

    #[inline(always)]
    fn target(&self) -> FlatTarget {
        FlatTarget {
            normal: self.normal_area(),
            two_sided: self.two_sided,
        }
    }

    /// Its two halves on the sphere of directions, if it is near enough for that to pay. Both turn about the first
    /// corner, so that the map from random numbers to directions has no jump.
    fn seen_near(&self, p: Vec3) -> Option<[SphericalTriangle; 2]> {
        let a = self.p0 - p.as_dvec3();
        let (e1, e2) = (self.e1.as_dvec3(), self.e2.as_dvec3());
        self.target().is_near(a, a + (e1 + e2) * 0.5).then(|| {
            let opposite = a + e1 + e2;
            [
                SphericalTriangle::new(a + e1, a, opposite),
                SphericalTriangle::new(opposite, a, a + e2),
            ]
        })
    }

    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let edges = [self.p0, self.e1.as_dvec3(), self.e2.as_dvec3()];
        let (w, pdf, t, b) = match self.seen_near(at.p) {
            Some([first, second]) => {
                let solid_angle = first.solid_angle + second.solid_angle;
                let share = first.solid_angle / solid_angle;
                let x = f64::from(u.x);
                let w = if x < share {
                    first.sample(Vec2::new(remap(x, 0.0, share) as f32, u.y))?
                } else {
                    second.sample(Vec2::new(remap(x, share, 1.0) as f32, u.y))?
                };
                self.target().aim_along(at, w, solid_angle, edges)?
            }
            None => {
                let q = edges[0] + edges[1] * f64::from(u.x) + edges[2] * f64::from(u.y);
                let (w, pdf, t) = self.target().aim_at(at, q)?;
                (w, pdf, t, u)
            }
        };
        let (wi, wi_low) = split_direction(w);
        let size = f64::from(self.e1.abs().max(self.e2.abs()).max_element());
        let (t_max, slant) = self.target().shadow_end(at, wi, t, size);
        Some(Aim {
            wi,
            wi_low,
            radiance: self.radiance,
            pdf,
            t_max,
            distance: t as f32,
            slant,
            to: self.prim,
            b,
            textured: self.textured,
            casts_shadow: true,
        })
    }

    /// Density of `sample` for a direction that hits the parallelogram.
    #[inline(always)]
    pub(crate) fn pdf(&self, at: &Receiver, wi: Vec3, hit: &HitOnLight) -> f32 {
        match self.seen_near(at.p) {
            Some([first, second]) => self.target().pdf_along(wi, first.solid_angle + second.solid_angle),
            None => self.target().pdf(wi, hit.distance),
        }
    }
}
