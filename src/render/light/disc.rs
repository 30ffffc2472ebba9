//! The emitting disc, ellipse or ring.

use super::flat::FlatTarget;
use super::{Aim, HitOnLight, Receiver};
use crate::math::warp::disc_concentric;
use crate::render::ray::{PrimRef, split_direction};
use glam::{DVec3, Vec2, Vec3};

/// An ellipse that emits, with or without a hole, on the side of `axis1 × axis2` or on both; sampled uniformly in area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscLight {
    /// Centre.
    pub center: DVec3,
    /// First half axis: from the centre to the rim.
    pub axis1: DVec3,
    /// Second half axis; for an ellipse any conjugate half diameter will do.
    pub axis2: DVec3,
    /// Radius of the hole as a fraction of the whole, in [0, 1).
    pub hole: f64,
    /// Emitted radiance, an average if `textured`.
    pub radiance: Vec3,
    /// Whether the back emits too.
    pub two_sided: bool,
    /// Whether the emission varies over the surface.
    pub textured: bool,
    /// The disc's primitive.
    pub prim: PrimRef,
}

impl DiscLight {
    /// Normal to the front, as long as the area.
    pub(crate) fn normal_area(&self) -> DVec3 {
        let whole = 1.0 - self.hole * self.hole;
        self.axis1.cross(self.axis2) * (std::f64::consts::PI * whole)
    }

    #[inline(always)]
    fn target(&self) -> FlatTarget {
        FlatTarget {
            normal: self.normal_area(),
            two_sided: self.two_sided,
        }
    }

    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let q = self.center + {
            let d = self.ring(disc_concentric(u).as_dvec2());
            self.axis1 * d.x + self.axis2 * d.y
        };
        let (w, pdf, t) = self.target().aim_at(at, q)?;
        let (wi, wi_low) = split_direction(w);
        let size = self.axis1.abs().max(self.axis2.abs()).max_element();
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
            b: Vec2::ZERO,
            textured: self.textured,
            casts_shadow: true,
        })
    }

    /// Maps the disc to the ring, uniform area to uniform area: r² → h² + r²(1 − h²).
    fn ring(&self, d: glam::DVec2) -> glam::DVec2 {
        let h2 = self.hole * self.hole;
        if h2 == 0.0 {
            return d;
        }
        let r2 = d.length_squared();
        if r2 == 0.0 {
            return glam::DVec2::new(self.hole, 0.0);
        }
        d * ((h2 + r2 * (1.0 - h2)) / r2).sqrt()
    }

    /// Density of `sample` for a direction that hits the disc.
    #[inline(always)]
    pub(crate) fn pdf(&self, wi: Vec3, hit: &HitOnLight) -> f32 {
        self.target().pdf(wi, hit.distance)
    }
}
