//! The emitting sphere of which only a cap matters, such as a lamp that looks through a ceiling.

use super::flat::FlatTarget;
use super::{Aim, HitOnLight, Receiver, SphereLight, shadow_end};
use crate::math::frame::Frame;
use crate::math::portable::sin_cos_turns;
use crate::render::ray::split_direction;
use glam::{DVec3, Vec2};

/// A sphere that emits everywhere but is sampled only on a cap, uniformly in area.
///
/// If most of a sphere is hidden in a wall, sampling the whole of it finds the wall. The cap is advice and never cuts
/// light off: directions to the rest of the sphere have density 0 here, so that hits found otherwise count fully.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereCapLight {
    /// The sphere.
    pub sphere: SphereLight,
    /// Unit vector from the centre of the sphere to the middle of the cap.
    pub axis: DVec3,
    /// 1 − cos of the half angle of the cap seen from the centre of the sphere, in (0, 2]: height over radius.
    pub one_minus_cos: f64,
}

impl SphereCapLight {
    pub(crate) fn area(&self) -> f64 {
        std::f64::consts::TAU * self.sphere.radius * self.sphere.radius * self.one_minus_cos
    }

    /// The surface at a unit normal, as the flat piece that gives the density.
    fn target(&self, normal: DVec3) -> FlatTarget {
        FlatTarget {
            normal: normal * self.area(),
            two_sided: self.sphere.two_sided,
        }
    }

    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        // Uniform in area is uniform in height (Archimedes); the sine from 1 − cos keeps flat caps exact.
        let x = f64::from(u.x) * self.one_minus_cos;
        let (sin_phi, cos_phi) = sin_cos_turns(u.y);
        let frame = Frame::from_normal(self.axis.as_vec3());
        let across = (frame.t * cos_phi + frame.b * sin_phi).as_dvec3();
        let normal = self.axis * (1.0 - x) + across * (x * (2.0 - x)).max(0.0).sqrt();
        let q = self.sphere.center + normal * self.sphere.radius;
        let (w, pdf, t) = self.target(normal).aim_at(at, q)?;
        let (wi, wi_low) = split_direction(w);
        Some(Aim {
            wi,
            wi_low,
            radiance: self.sphere.radiance,
            pdf,
            t_max: shadow_end(t as f32, at.p),
            distance: t as f32,
            slant: 1.0,
            to: self.sphere.prim,
            b: Vec2::ZERO,
            textured: self.sphere.textured,
            casts_shadow: true,
        })
    }

    /// Density of `sample` for a direction that hits the sphere; 0 where it hits outside the cap.
    pub(crate) fn pdf(&self, wi: glam::Vec3, hit: &HitOnLight) -> f32 {
        // 1 − cos of the angle from the axis, as half the square of a chord: exact for flat caps.
        let normal = (hit.p.as_dvec3() - self.sphere.center) / self.sphere.radius;
        if 0.5 * (normal - self.axis).length_squared() > self.one_minus_cos {
            return 0.0;
        }
        self.target(hit.ng.as_dvec3()).pdf(wi, hit.distance)
    }
}
