//! Lights and how they are sampled: everything that can be aimed at from a shading point.
//!
//! A [`LightSet`] is built once from a list of [`Light`]s. The kernel asks it for one direction towards one light
//! ([`LightSet::sample`]), and, when a ray sampled from a surface happens to hit a light, for the density with which
//! the set would have chosen that direction ([`LightSet::pdf`]); [`mis_weight`] combines the two.
//! All positions are relative to the origin of the compiled scene. Emission itself, its textures and the camera's
//! backdrop belong to the kernel.

mod bounds;
mod cap;
mod choice;
mod coincident;
mod disc;
mod distant;
mod environment;
mod flat;
mod lamp;
mod mis;
mod moving;
mod parallelogram;
mod power;
mod set;
mod solid_angle;
mod sphere;
mod split;
mod tree;
mod triangle;

#[cfg(test)]
mod tests;

pub use cap::SphereCapLight;
pub use disc::DiscLight;
pub use environment::{EnvironmentImage, EnvironmentLight};
pub use lamp::{AreaLamp, DirectionalLamp, Falloff, PointLamp, SpotLamp, SpotProfile};
pub use mis::mis_weight;
pub use moving::MovingLight;
pub use parallelogram::ParallelogramLight;
pub use set::LightSet;
pub use sphere::SphereLight;
pub use triangle::TriangleLight;

use super::ray::{PrimRef, Ray, ray_mask};
use super::surface::Surface;
use crate::math::robust::{gamma, offset_origin};
use glam::{Vec2, Vec3};

/// Something that shines. Emitting surfaces that have no variant here (cones, tori, ellipsoids) are found by hits only.
#[derive(Clone, Debug)]
pub enum Light {
    /// Shines from a point in every direction.
    Point(Box<PointLamp>),
    /// Shines from a point into a cone.
    Spot(Box<SpotLamp>),
    /// Parallel light.
    Directional(DirectionalLamp),
    /// Points spread over a parallelogram or ellipse, each shining in every direction; invisible.
    Area(Box<AreaLamp>),
    /// An emitting sphere.
    Sphere(SphereLight),
    /// An emitting sphere of which only a cap is worth sampling.
    SphereCap(Box<SphereCapLight>),
    /// An emitting triangle.
    Triangle(TriangleLight),
    /// An emitting parallelogram, for instance a face of a box.
    Parallelogram(ParallelogramLight),
    /// An emitting disc, ellipse or ring.
    Disc(Box<DiscLight>),
    /// Light from infinitely far away.
    Environment(Box<EnvironmentLight>),
    /// Any of the others but the environment and caps, moving.
    Moving(Box<MovingLight>),
}

impl Light {
    /// Whether only light sampling can find it: its density is not one of directions, and no ray hits it.
    pub fn is_delta(&self) -> bool {
        match self {
            Light::Point(_) | Light::Spot(_) | Light::Directional(_) | Light::Area(_) => true,
            Light::Sphere(_)
            | Light::SphereCap(_)
            | Light::Triangle(_)
            | Light::Parallelogram(_)
            | Light::Disc(_)
            | Light::Environment(_) => false,
            Light::Moving(l) => l.opening().is_delta(),
        }
    }
}

/// The point from which light is sought. The same values must go into `sample` and `pdf`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    /// The shading point.
    pub p: Vec3,
    /// Unit normal whose positive side receives light; zero if there is none.
    pub n: Vec3,
    /// Whether both sides receive light.
    pub two_sided: bool,
}

impl Receiver {
    /// Cosine of the unit direction `wi` with the side that receives light; 1 without a normal.
    pub fn cosine(&self, wi: Vec3) -> f32 {
        if self.n == Vec3::ZERO {
            1.0
        } else if self.two_sided {
            self.n.dot(wi).abs()
        } else {
            self.n.dot(wi)
        }
    }

    /// The normal, if only its positive side receives light.
    pub fn one_sided_normal(&self) -> Option<Vec3> {
        (!self.two_sided && self.n != Vec3::ZERO).then_some(self.n)
    }
}

/// One direction towards a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction to the light.
    pub wi: Vec3,
    /// What it lost by rounding, where that is known.
    pub wi_low: Vec3,
    /// Radiance that arrives if nothing blocks it. For delta lights irradiance at normal incidence, so that the
    /// contribution is f·cos·`radiance`/`pdf` for every light. Only an average if `textured`.
    pub radiance: Vec3,
    /// Density per solid angle times the probability with which the light was chosen; for delta lights that
    /// probability alone. Positive and finite.
    pub pdf: f32,
    /// Whether only light sampling finds this light (its weight is then 1, without MIS).
    pub delta: bool,
    /// Where along `wi` blockers end to count: in front of the light by more than rounding; infinite for
    /// light from far away. May be 0 or negative if the point is as good as on the light: then nothing blocks.
    pub t_max: f32,
    /// Distance to the sampled point, infinite for light from far away.
    pub distance: f32,
    /// What moves the start of the shadow ray aside moves its end along it by up to this factor: 1/cos of the angle at a
    /// flat light, 1 elsewhere.
    pub slant: f32,
    /// The primitive the sample lies on, which must not block; [`PrimRef::NONE`] for lights without one.
    pub to: PrimRef,
    /// Where on `to` the sample lies, for textures: barycentric coordinates of v1 and v2 on a triangle,
    /// coordinates along the two edges on a parallelogram; zero elsewhere (use `wi` and `distance`).
    pub b: Vec2,
    /// Whether the emission must be looked up at the sampled point.
    pub textured: bool,
    /// Index of the light.
    pub light: u32,
    /// Whether blockers count at all.
    pub casts_shadow: bool,
    /// When the light was there: the time of the path.
    pub time: f32,
}

impl LightSample {
    /// The ray from a point in free space to the light: what it meets before its end blocks.
    pub fn shadow_ray_from(&self, p: Vec3) -> Ray {
        Ray {
            dir_low: self.wi_low,
            t_max: self.t_max,
            to: self.to,
            mask: ray_mask::SHADOW,
            time: self.time,
            ..Ray::new(p, self.wi)
        }
    }

    /// The ray from a surface to the light: what it meets before its end blocks.
    #[inline(always)]
    pub fn shadow_ray(&self, surface: &Surface) -> Ray {
        let origin = offset_origin(surface.p, surface.p_error, surface.ng, self.wi);
        Ray {
            origin,
            dir: self.wi,
            dir_low: self.wi_low,
            t_max: self.t_max - (origin - surface.p).length() * self.slant,
            from: surface.prim,
            to: self.to,
            mask: ray_mask::SHADOW,
            time: self.time,
        }
    }
}

/// A place where a ray hit a light.
#[derive(Clone, Copy, Debug)]
pub struct HitOnLight {
    /// The point.
    pub p: Vec3,
    /// Unit geometric normal there.
    pub ng: Vec3,
    /// Its distance from the shading point.
    pub distance: f32,
    /// When it was hit: the time of the path.
    pub time: f32,
}

/// A direction towards one light, as the light itself sees it: without index and probability of the choice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    pub wi: Vec3,
    pub wi_low: Vec3,
    pub radiance: Vec3,
    /// Per solid angle, 1 for delta lights.
    pub pdf: f32,
    pub t_max: f32,
    pub distance: f32,
    pub slant: f32,
    pub to: PrimRef,
    pub b: Vec2,
    pub textured: bool,
    pub casts_shadow: bool,
}

/// The end of a shadow ray from `p` to a point at distance `t`: shorter by a bound on the rounding of t itself (γ(8))
/// and of the coordinates at both ends (γ(4) of the larger, which is at most |p| + t), so that what lies behind the
/// light never blocks.
pub(crate) fn shadow_end(t: f32, p: Vec3) -> f32 {
    t * (1.0 - gamma(12)) - gamma(4) * p.abs().max_element()
}

/// Converts a density in f64 to f32: `None` unless it is positive and finite there.
pub(crate) fn usable_pdf(pdf: f64) -> Option<f32> {
    let pdf = pdf as f32;
    (pdf > 0.0 && pdf.is_finite()).then_some(pdf)
}
