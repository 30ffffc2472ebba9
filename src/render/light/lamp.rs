//! Lamps without a shape: only light sampling finds them.

use super::{Aim, Receiver, shadow_end};
use crate::math::portable;
use crate::math::warp::disc_concentric;
use crate::render::ray::{PrimRef, split_direction};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::PI;

/// How the irradiance of a lamp falls with the distance r; E is at normal incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Falloff {
    /// E = π·color at any distance.
    None,
    /// E = π·color·2/(1 + (r/distance)^power).
    Fade {
        /// Distance at which the factor is 1, > 0.
        distance: f64,
        /// Exponent, ≥ 0.
        power: f64,
    },
    /// E = color/r² times, with a range, the window max(min(1 − (r/range)⁴, 1), 0).
    InverseSquare {
        /// Where the light ends, if it does.
        range: Option<f64>,
    },
}

impl Falloff {
    /// Irradiance at normal incidence for a colour of 1, at distance `r` > 0.
    pub fn irradiance(&self, r: f64) -> f32 {
        match *self {
            Falloff::None => PI,
            Falloff::Fade { distance, power } => {
                PI * (2.0 / (1.0 + portable::pow((r / distance) as f32, power as f32)))
            }
            Falloff::InverseSquare { range } => {
                let window = match range {
                    Some(range) => {
                        let q = (r / range) * (r / range);
                        (1.0 - q * q).clamp(0.0, 1.0)
                    }
                    None => 1.0,
                };
                (window / (r * r)) as f32
            }
        }
    }
}

/// How the light of a spot falls with the angle θ from its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpotProfile {
    /// 1 up to `radius`, 0 from `falloff` on, a smoothstep of θ between them; times max(cos θ, 0)^tightness.
    Pov {
        /// Half angle of the full-light cone, radians.
        radius: f64,
        /// Half angle where it ends, radians.
        falloff: f64,
        /// Exponent of the cosine, ≥ 0.
        tightness: f64,
    },
    /// clamp((cos θ − cos outer)/(cos inner − cos outer))².
    Punctual {
        /// Half angle of the full-light cone, radians, < outer.
        inner: f64,
        /// Half angle where it ends, radians.
        outer: f64,
    },
}

impl SpotProfile {
    /// Factor in [0, 1] for the direction `w` away from the lamp; `axis` and `w` are unit vectors.
    pub fn factor(&self, axis: DVec3, w: DVec3) -> f32 {
        // The angle from both sine and cosine keeps its digits near the axis.
        let cos = axis.dot(w) as f32;
        let theta = portable::atan2(axis.cross(w).length() as f32, cos);
        match *self {
            SpotProfile::Pov {
                radius,
                falloff,
                tightness,
            } => {
                let (radius, falloff) = (radius as f32, falloff as f32);
                let edge = if theta >= falloff {
                    return 0.0;
                } else if theta <= radius {
                    1.0
                } else {
                    let s = (falloff - theta) / (falloff - radius);
                    s * s * (3.0 - 2.0 * s)
                };
                if tightness == 0.0 {
                    edge
                } else {
                    edge * portable::pow(cos.max(0.0), tightness as f32)
                }
            }
            SpotProfile::Punctual { inner, outer } => {
                let (inner, outer) = (inner as f32, outer as f32);
                if theta >= outer {
                    return 0.0;
                }
                if theta <= inner {
                    return 1.0;
                }
                // cos a − cos b = 2·sin((a + b)/2)·sin((b − a)/2): narrow cones do not cancel.
                let above = half_sines(theta, outer);
                let all = half_sines(inner, outer);
                let s = (above / all).min(1.0);
                s * s
            }
        }
    }

    /// Half angles (of full light, of the end), as bounds for the choice of lights.
    pub(crate) fn half_angles(&self) -> (f64, f64) {
        match *self {
            SpotProfile::Pov { radius, falloff, .. } => (radius.min(falloff), falloff),
            SpotProfile::Punctual { inner, outer } => (inner.min(outer), outer),
        }
    }
}

/// sin((a + b)/2)·sin((b − a)/2), for 0 ≤ a ≤ b ≤ π.
fn half_sines(a: f32, b: f32) -> f32 {
    let turns = |x: f32| x * (0.5 / std::f32::consts::TAU);
    portable::sin_cos_turns(turns(a + b)).0 * portable::sin_cos_turns(turns(b - a)).0
}

/// Shines everywhere from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLamp {
    /// Where it is.
    pub position: DVec3,
    /// Colour; its unit depends on the falloff.
    pub color: Vec3,
    /// With the distance.
    pub falloff: Falloff,
    /// Whether objects block it.
    pub casts_shadows: bool,
}

/// Shines into a cone from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLamp {
    /// Where it is.
    pub position: DVec3,
    /// Unit direction of the axis, away from the lamp.
    pub axis: DVec3,
    /// Colour; its unit depends on the falloff.
    pub color: Vec3,
    /// With the angle.
    pub profile: SpotProfile,
    /// With the distance.
    pub falloff: Falloff,
    /// Whether objects block it.
    pub casts_shadows: bool,
}

/// Parallel light with E = π·color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLamp {
    /// Unit direction in which the light travels.
    pub direction: Vec3,
    /// Colour.
    pub color: Vec3,
    /// Whether objects block it.
    pub casts_shadows: bool,
}

/// Points spread evenly over a parallelogram or ellipse that shine in every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLamp {
    /// Centre.
    pub position: DVec3,
    /// Whole first edge.
    pub axis1: DVec3,
    /// Whole second edge.
    pub axis2: DVec3,
    /// Elliptic instead of rectangular.
    pub circular: bool,
    /// Restriction to a cone: its unit axis away from the lamp, and its profile.
    pub spot: Option<(DVec3, SpotProfile)>,
    /// Colour; its unit depends on the falloff.
    pub color: Vec3,
    /// With the distance.
    pub falloff: Falloff,
    /// Whether objects block it.
    pub casts_shadows: bool,
}

impl PointLamp {
    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver) -> Option<Aim> {
        aim(at, self.position, self.color, self.falloff, None, self.casts_shadows)
    }
}

impl SpotLamp {
    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver) -> Option<Aim> {
        let spot = Some((self.axis, self.profile));
        aim(at, self.position, self.color, self.falloff, spot, self.casts_shadows)
    }
}

impl AreaLamp {
    #[inline(always)]
    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let v = if self.circular {
            disc_concentric(u) * 0.5
        } else {
            u - Vec2::splat(0.5)
        };
        let q = self.position + self.axis1 * f64::from(v.x) + self.axis2 * f64::from(v.y);
        aim(at, q, self.color, self.falloff, self.spot, self.casts_shadows)
    }
}

impl DirectionalLamp {
    #[inline(always)]
    pub(crate) fn sample(&self) -> Aim {
        Aim {
            wi: -self.direction,
            wi_low: Vec3::ZERO,
            radiance: self.color * PI,
            pdf: 1.0,
            t_max: f32::INFINITY,
            distance: f32::INFINITY,
            slant: 1.0,
            to: PrimRef::NONE,
            b: Vec2::ZERO,
            textured: false,
            casts_shadow: self.casts_shadows,
        }
    }
}

/// Aims at a point that shines; `None` in the dark and at the point itself.
fn aim(
    at: &Receiver,
    q: DVec3,
    color: Vec3,
    falloff: Falloff,
    spot: Option<(DVec3, SpotProfile)>,
    casts_shadow: bool,
) -> Option<Aim> {
    let d = q - at.p.as_dvec3();
    let r = d.length();
    let w = d / r;
    if !w.is_finite() {
        return None;
    }
    let cone = spot.map_or(1.0, |(axis, profile)| profile.factor(axis, -w));
    if cone <= 0.0 {
        return None;
    }
    let radiance = color * (falloff.irradiance(r) * cone);
    if radiance == Vec3::ZERO || !radiance.is_finite() {
        return None;
    }
    let (wi, wi_low) = split_direction(w);
    Some(Aim {
        wi,
        wi_low,
        radiance,
        pdf: 1.0,
        t_max: shadow_end(r as f32, at.p),
        distance: r as f32,
        slant: 1.0,
        to: PrimRef::NONE,
        b: Vec2::ZERO,
        textured: false,
        casts_shadow,
    })
}
