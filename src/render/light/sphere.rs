//! The emitting sphere, sampled by the cone in which it is seen.

use super::{Aim, Receiver, shadow_end, usable_pdf};
use crate::math::frame::Frame;
use crate::math::portable::sin_cos_turns;
use crate::math::warp::{INV_PI, cosine_hemisphere, uniform_sphere};
use crate::render::ray::PrimRef;
use glam::{DVec3, Vec2, Vec3};

const INV_TAU: f64 = 1.0 / std::f64::consts::TAU;

/// A sphere that emits. Seen from outside, directions are uniform over its cone. From inside every direction meets
/// it: if its inside emits (`two_sided`), directions are uniform over the sphere of directions, or cosine distributed
/// about the normal of a receiver that has one; otherwise it is not sampled and has density 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// Centre.
    pub center: DVec3,
    /// Radius, > 0.
    pub radius: f64,
    /// Emitted radiance, an average if `textured`.
    pub radiance: Vec3,
    /// Whether the inside emits too.
    pub two_sided: bool,
    /// Whether the emission varies over the surface.
    pub textured: bool,
    /// The sphere's primitive.
    pub prim: PrimRef,
}

impl SphereLight {
    /// (vector to the centre, d², d² − R²) from `p`; in f64 the difference keeps its digits for any f32 point that is
    /// not on the sphere up to its own rounding. Inside, the last is negative.
    fn seen_from(&self, p: Vec3) -> (DVec3, f64, f64) {
        let to_center = self.center - p.as_dvec3();
        let d2 = to_center.length_squared();
        (to_center, d2, d2 - self.radius * self.radius)
    }

    /// Solid angle of the cone over 2π, which is 1 − cos of its half angle, inverted: with s = R/d and c² = 1 − s²,
    /// 1/(1 − c) = (1 + c)/s² has all its digits for tiny far spheres, whose cosine has none left, and
    /// c² = (d² − R²)/d² has them for huge near ones.
    fn inverse_one_minus_cos(&self, d2: f64, power: f64) -> f64 {
        (d2 + (d2 * power).sqrt()) / (self.radius * self.radius)
    }

    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let (to_center, d2, power) = self.seen_from(at.p);
        if power < 0.0 || d2 == 0.0 {
            return self.sample_from_inside(at, u);
        }
        let inverse = self.inverse_one_minus_cos(d2, power);
        let pdf = usable_pdf(inverse * INV_TAU)?;
        let d = d2.sqrt();
        let axis = (to_center / d).as_vec3();
        // A direction uniform over the cone; the sine comes from 1 − cos, never from the cosine.
        let x = (1.0 / inverse) as f32;
        let ux = u.x * x;
        let (cos, sin) = (1.0 - ux, (ux * (2.0 - ux)).sqrt());
        let (sin_phi, cos_phi) = sin_cos_turns(u.y);
        let frame = Frame::from_normal(axis);
        let wi = axis * cos + (frame.t * cos_phi + frame.b * sin_phi) * sin;
        // The nearer root is (d² − R²)/(d·cos + √(R² − d²·sin²)), and with R² = d²·x(2 − x) the radicand is a product
        // without cancellation.
        let half_chord = (x * (1.0 - u.x) * (2.0 - x * (1.0 + u.x))).sqrt();
        let t = (power / d) as f32 / (cos + half_chord);
        Some(self.aim(at, wi, pdf, t))
    }

    fn sample_from_inside(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        if !self.two_sided {
            return None;
        }
        let wi = match at.one_sided_normal() {
            Some(n) => Frame::from_normal(n).to_world(cosine_hemisphere(u)),
            None => uniform_sphere(u),
        };
        let pdf = inside_pdf(at, wi);
        if pdf <= 0.0 {
            return None;
        }
        // The only root ahead: b + √(b² + (R² − d²)), without cancellation when b < 0.
        let (to_center, _, power) = self.seen_from(at.p);
        let b = to_center.dot(wi.as_dvec3());
        let root = (b * b - power).sqrt();
        let t = if b >= 0.0 { b + root } else { -power / (root - b) };
        Some(self.aim(at, wi, pdf, t as f32))
    }

    fn aim(&self, at: &Receiver, wi: Vec3, pdf: f32, t: f32) -> Aim {
        Aim {
            wi,
            wi_low: Vec3::ZERO,
            radiance: self.radiance,
            pdf,
            t_max: shadow_end(t, at.p),
            distance: t,
            slant: 1.0,
            to: self.prim,
            b: Vec2::ZERO,
            textured: self.textured,
            casts_shadow: true,
        }
    }

    /// Density of `sample` for a direction that hits the sphere.
    #[inline(always)]
    pub(crate) fn pdf(&self, at: &Receiver, wi: Vec3) -> f32 {
        let (_, d2, power) = self.seen_from(at.p);
        if power < 0.0 || d2 == 0.0 {
            return if self.two_sided { inside_pdf(at, wi) } else { 0.0 };
        }
        usable_pdf(self.inverse_one_minus_cos(d2, power) * INV_TAU).unwrap_or(0.0)
    }
}

fn inside_pdf(at: &Receiver, wi: Vec3) -> f32 {
    match at.one_sided_normal() {
        Some(n) => n.dot(wi).max(0.0) * INV_PI,
        None => 0.25 * INV_PI,
    }
}
