//! The emitting triangle.

use super::flat::FlatTarget;
use super::solid_angle::SphericalTriangle;
use super::{Aim, HitOnLight, Receiver};
use crate::math::warp;
use crate::render::ray::{PrimRef, split_direction};
use glam::{DVec3, Vec2, Vec3};

/// A triangle that emits, on the side of `e1 × e2` or on both. Sampled uniformly in solid angle if
/// it is near, in area if it is far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleLight {
    /// First corner.
    pub p0: DVec3,
    /// From the first to the second corner.
    pub e1: Vec3,
    /// From the first to the third corner.
    pub e2: Vec3,
    /// Whether the front is the side of `e2 × e1` instead (mirrored placements keep their corners in order).
    pub flipped: bool,
    /// Emitted radiance, an average if `textured`.
    pub radiance: Vec3,
    /// Whether the back emits too.
    pub two_sided: bool,
    /// Whether the emission varies over the surface.
    pub textured: bool,
    /// The triangle.
    pub prim: PrimRef,
}

impl TriangleLight {
    /// e1 × e2: towards the front, twice as long as the area. In f64, where the products of f32 neither cancel nor
    /// under- or overflow.
    #[inline(always)]
    pub(crate) fn normal_twice_area(&self) -> DVec3 {
        let n = self.e1.as_dvec3().cross(self.e2.as_dvec3());
        if self.flipped { -n } else { n }
    }

    #[inline(always)]
    fn target(&self) -> FlatTarget {
        FlatTarget {
            normal: self.normal_twice_area() * 0.5,
            two_sided: self.two_sided,
        }
    }

    /// The triangle on the sphere of directions, if it is near enough for that to pay.
    #[inline(always)]
    fn seen_near(&self, p: Vec3) -> Option<SphericalTriangle> {
        let a = self.p0 - p.as_dvec3();
        let (e1, e2) = (self.e1.as_dvec3(), self.e2.as_dvec3());
        let center = a + (e1 + e2) * (1.0 / 3.0);
        self.target()
            .is_near(a, center)
            .then(|| SphericalTriangle::new(a + e1, a, a + e2))
    }

    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let (e1, e2) = (self.e1.as_dvec3(), self.e2.as_dvec3());
        let target = self.target();
        let (w, pdf, t, b) = match self.seen_near(at.p) {
            Some(seen) => target.aim_along(at, seen.sample(u)?, seen.solid_angle, [self.p0, e1, e2])?,
            None => {
                let b = warp::triangle(u);
                let q = self.p0 + e1 * f64::from(b.x) + e2 * f64::from(b.y);
                let (w, pdf, t) = target.aim_at(at, q)?;
                (w, pdf, t, b)
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
            b: if b.x + b.y > 1.0 { b / (b.x + b.y) } else { b },
            textured: self.textured,
            casts_shadow: true,
        })
    }

    /// Density of `sample` for a direction that hits the triangle.
    #[inline(always)]
    pub(crate) fn pdf(&self, at: &Receiver, wi: Vec3, hit: &HitOnLight) -> f32 {
        match self.seen_near(at.p) {
            Some(seen) => self.target().pdf_along(wi, seen.solid_angle),
            None => self.target().pdf(wi, hit.distance),
        }
    }
}
