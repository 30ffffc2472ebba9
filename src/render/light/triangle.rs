//! The emitting triangle.

use super::{Aim, HitOnLight, Receiver, shadow_end, usable_pdf};
use crate::math::warp;
use crate::render::ray::PrimRef;
use glam::{DVec3, Vec2, Vec3};

/// A triangle that emits, on the side of `e1 × e2` or on both; sampled uniformly in area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleLight {
    /// First corner.
    pub p0: Vec3,
    /// From the first to the second corner.
    pub e1: Vec3,
    /// From the first to the third corner.
    pub e2: Vec3,
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
    pub(crate) fn normal_twice_area(&self) -> DVec3 {
        self.e1.as_dvec3().cross(self.e2.as_dvec3())
    }

    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let b = warp::triangle(u);
        let q = self.p0.as_dvec3() + self.e1.as_dvec3() * f64::from(b.x) + self.e2.as_dvec3() * f64::from(b.y);
        let target = FlatTarget {
            normal: self.normal_twice_area() * 0.5,
            two_sided: self.two_sided,
        };
        let (wi, pdf, t) = target.aim_at(at, q)?;
        Some(Aim {
            wi,
            radiance: self.radiance,
            pdf,
            t_max: shadow_end(t as f32, at.p),
            distance: t as f32,
            to: self.prim,
            b,
            textured: self.textured,
            casts_shadow: true,
        })
    }

    /// Density of `sample` for a direction that hits the triangle.
    pub(crate) fn pdf(&self, wi: Vec3, hit: &HitOnLight) -> f32 {
        FlatTarget {
            normal: self.normal_twice_area() * 0.5,
            two_sided: self.two_sided,
        }
        .pdf(wi, hit.distance)
    }
}

/// A flat surface sampled uniformly in area.
pub(crate) struct FlatTarget {
    /// Normal as long as the area.
    pub normal: DVec3,
    pub two_sided: bool,
}

impl FlatTarget {
    /// Direction, density per solid angle and distance of the point `q`; `None` where q is p itself, where the
    /// surface is seen edge-on or from a dark side, and where the density is no finite number.
    pub fn aim_at(&self, at: &Receiver, q: DVec3) -> Option<(Vec3, f32, f64)> {
        let d = q - at.p.as_dvec3();
        let t2 = d.length_squared();
        let t = t2.sqrt();
        let wi = (d / t).as_vec3();
        let pdf = self.density(d / t, t2)?;
        Some((wi, pdf, t))
    }

    pub fn pdf(&self, wi: Vec3, distance: f32) -> f32 {
        let t = f64::from(distance);
        self.density(wi.as_dvec3(), t * t).unwrap_or(0.0)
    }

    /// t²/(A·cos).
    fn density(&self, wi: DVec3, t2: f64) -> Option<f32> {
        let area_cos = -wi.dot(self.normal);
        let area_cos = if self.two_sided { area_cos.abs() } else { area_cos };
        if area_cos > 0.0 {
            usable_pdf(t2 / area_cos)
        } else {
            None
        }
    }
}
