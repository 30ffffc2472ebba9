//! The emitting sphere, sampled by the cone in which it is seen.

use super::{Aim, Receiver, shadow_end};
use crate::math::frame::Frame;
use crate::math::portable::sin_cos_turns;
use crate::math::warp::{INV_PI, cosine_hemisphere, uniform_sphere};
use crate::render::ray::PrimRef;
use glam::{DVec3, Vec2, Vec3};

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

/// How the sphere is seen from a point outside of it.
struct Cone {
    /// Unit vector to the centre.
    axis: DVec3,
    /// Distance d to the centre.
    distance: f64,
    /// (d − R)(d + R) = d² − R² ≥ 0.
    power: f64,
    /// 1 − cos of the half angle, in (0, 1].
    one_minus_cos: f64,
}

impl SphereLight {
    /// The cone from `p`, with 1 − cos from the sine: 1 − c = s²/(1 + c) has all its digits for tiny far spheres, and
    /// 1 − s² = (d − R)(d + R)/d² has them for huge near ones. `None` inside the sphere.
    fn cone(&self, p: Vec3) -> Option<Cone> {
        let to_center = self.center - p.as_dvec3();
        let d2 = to_center.length_squared();
        let d = d2.sqrt();
        if d < self.radius || d == 0.0 {
            return None;
        }
        let power = (d - self.radius) * (d + self.radius);
        let s2 = self.radius * self.radius / d2;
        Some(Cone {
            axis: to_center / d,
            distance: d,
            power,
            one_minus_cos: s2 / (1.0 + (power / d2).sqrt()),
        })
    }

    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let Some(cone) = self.cone(at.p) else {
            return self.sample_from_inside(at, u);
        };
        // A direction uniform over the cone; the sine comes from 1 − cos, never from the cosine.
        let x = cone.one_minus_cos;
        let v = f64::from(u.x);
        let ux = v * x;
        let (cos, sin) = (1.0 - ux, (ux * (2.0 - ux)).sqrt());
        let (sin_phi, cos_phi) = sin_cos_turns(u.y);
        let frame = Frame::from_normal(cone.axis.as_vec3());
        let across = (frame.t * cos_phi + frame.b * sin_phi).as_dvec3();
        let wi = cone.axis * cos + across * sin;
        // The nearer root is (d² − R²)/(d·cos + √(R² − d²·sin²)), and with R² = d²·x(2 − x) the radicand is a product.
        let half_chord = (x * (1.0 - v) * (2.0 - x * (1.0 + v))).sqrt();
        let t = cone.power / (cone.distance * (cos + half_chord));
        let pdf = super::usable_pdf(1.0 / (std::f64::consts::TAU * x))?;
        Some(self.aim(at, wi.as_vec3(), pdf, t))
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
        let to_center = self.center - at.p.as_dvec3();
        let b = to_center.dot(wi.as_dvec3());
        let d = to_center.length();
        let c = (self.radius - d) * (self.radius + d);
        let root = (b * b + c).sqrt();
        let t = if b >= 0.0 { b + root } else { c / (root - b) };
        Some(self.aim(at, wi, pdf, t))
    }

    fn aim(&self, at: &Receiver, wi: Vec3, pdf: f32, t: f64) -> Aim {
        Aim {
            wi,
            radiance: self.radiance,
            pdf,
            t_max: shadow_end(t, at.p, at.p.as_dvec3() + wi.as_dvec3() * t),
            distance: t as f32,
            to: self.prim,
            b: Vec2::ZERO,
            textured: self.textured,
            casts_shadow: true,
        }
    }

    /// Density of `sample` for a direction that hits the sphere.
    pub(crate) fn pdf(&self, at: &Receiver, wi: Vec3) -> f32 {
        match self.cone(at.p) {
            Some(cone) => super::usable_pdf(1.0 / (std::f64::consts::TAU * cone.one_minus_cos)).unwrap_or(0.0),
            None if self.two_sided => inside_pdf(at, wi),
            None => 0.0,
        }
    }
}

fn inside_pdf(at: &Receiver, wi: Vec3) -> f32 {
    match at.one_sided_normal() {
        Some(n) => n.dot(wi).max(0.0) * INV_PI,
        None => 0.25 * INV_PI,
    }
}
