//! What a group of lights can at most do at a point: the measure by which lights are chosen.

use super::lamp::SpotProfile;
use super::{Light, Receiver};
use crate::math::color::luminance;
use crate::math::robust::{gamma, sqrt_of_nonnegative};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Bounds of the place, the directions and the strength of lights whose irradiance falls with 1/r².
///
/// Every light in it shines only within the angle θo + θe of `axis`, θo bounding the normals, θe ≤ π/2 the emission
/// about a normal. Source: Conty Estevez & Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, 2018.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightBounds {
    pub min: Vec3,
    pub max: Vec3,
    pub axis: Vec3,
    pub cos_o: f32,
    pub cos_e: f32,
    /// Luminance of the radiant intensity along the normals; 0 for no light at all.
    pub intensity: f32,
    /// Whether the cone of −`axis` counts too.
    pub two_sided: bool,
}

/// A bound on the rounding errors of the cosines below, so that a light is called invisible only if it is.
const SLACK: f32 = gamma(32);

impl LightBounds {
    /// Lights that do not shine: the neutral element of [`LightBounds::union`].
    pub const DARK: LightBounds = LightBounds {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
        axis: Vec3::Z,
        cos_o: 1.0,
        cos_e: 1.0,
        intensity: 0.0,
        two_sided: false,
    };

    /// Bounds of one light, or `None` if it is infinitely far away. For lamps the intensity is that of the colour,
    /// whatever the falloff.
    pub fn of(light: &Light) -> Option<LightBounds> {
        let surface = |points: &[Vec3], normal_area: DVec3, radiance: Vec3, two_sided: bool| LightBounds {
            min: points.iter().copied().fold(Vec3::INFINITY, Vec3::min),
            max: points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max),
            axis: crate::math::robust::try_normalize_f64(normal_area).map_or(Vec3::Z, |n| n.as_vec3()),
            cos_o: 1.0,
            cos_e: 0.0,
            intensity: positive(f64::from(luminance(radiance)) * normal_area.length()),
            two_sided,
        };
        Some(match light {
            Light::Directional(_) | Light::Environment(_) => return None,
            Light::Moving(l) => return l.bounds(),
            Light::Point(l) => LightBounds::everywhere(l.position, DVec3::ZERO, f64::from(luminance(l.color))),
            Light::Spot(l) => LightBounds::everywhere(l.position, DVec3::ZERO, f64::from(luminance(l.color)))
                .within(l.axis, &l.profile),
            Light::Area(l) => {
                let half = (l.axis1.abs() + l.axis2.abs()) * 0.5;
                let bounds = LightBounds::everywhere(l.position, half, f64::from(luminance(l.color)));
                match &l.spot {
                    Some((axis, profile)) => bounds.within(*axis, profile),
                    None => bounds,
                }
            }
            Light::Sphere(l) => {
                let disc = std::f64::consts::PI * l.radius * l.radius;
                LightBounds::everywhere(
                    l.center,
                    DVec3::splat(l.radius),
                    f64::from(luminance(l.radiance)) * disc,
                )
            }
            Light::SphereCap(l) => {
                // No point of the cap is farther from its middle than its rim, R·√(2(1 − cos)).
                let reach = l.sphere.radius * (2.0 * l.one_minus_cos).sqrt();
                let strength = f64::from(luminance(l.sphere.radiance)) * l.area();
                let middle = l.sphere.center + l.axis * l.sphere.radius;
                LightBounds {
                    axis: l.axis.as_vec3(),
                    // Rounded down by more than the axis is off.
                    cos_o: ((1.0 - l.one_minus_cos) as f32 - SLACK).max(-1.0),
                    two_sided: l.sphere.two_sided,
                    ..LightBounds::everywhere(middle, DVec3::splat(reach), strength)
                }
            }
            Light::Triangle(l) => surface(
                &[Vec3::ZERO, l.e1, l.e2].map(|e| (l.p0 + e.as_dvec3()).as_vec3()),
                l.normal_twice_area() * 0.5,
                l.radiance,
                l.two_sided,
            ),
            Light::Parallelogram(l) => surface(
                &[Vec3::ZERO, l.e1, l.e2, l.e1 + l.e2].map(|e| (l.p0 + e.as_dvec3()).as_vec3()),
                l.normal_area(),
                l.radiance,
                l.two_sided,
            ),
            Light::Disc(l) => {
                // The ellipse reaches √(a1² + a2²) along each axis of the world.
                let reach = (l.axis1 * l.axis1 + l.axis2 * l.axis2).map(f64::sqrt);
                let points = [(l.center - reach).as_vec3(), (l.center + reach).as_vec3()];
                surface(&points, l.normal_area(), l.radiance, l.two_sided)
            }
        })
    }

    /// The same place and strength, shining in every direction.
    pub fn in_every_direction(self) -> LightBounds {
        LightBounds {
            axis: Vec3::Z,
            cos_o: -1.0,
            cos_e: 0.0,
            ..self
        }
    }

    fn everywhere(center: DVec3, half: DVec3, intensity: f64) -> LightBounds {
        LightBounds {
            min: (center - half).as_vec3(),
            max: (center + half).as_vec3(),
            axis: Vec3::Z,
            cos_o: -1.0,
            cos_e: 0.0,
            intensity: positive(intensity),
            two_sided: false,
        }
    }

    /// Restricts the directions to those of a spot; θe stays within π/2 and θo takes the rest.
    fn within(mut self, axis: DVec3, profile: &SpotProfile) -> LightBounds {
        let (inner, outer) = profile.half_angles();
        let theta_e = (outer - inner).clamp(0.0, std::f64::consts::FRAC_PI_2);
        self.axis = axis.as_vec3();
        self.cos_o = crate::math::portable::cos_f64((outer - theta_e).clamp(0.0, std::f64::consts::PI)) as f32;
        self.cos_e = crate::math::portable::cos_f64(theta_e) as f32;
        self
    }

    /// The same lights with all lengths multiplied by `length` and all intensities by `intensity`.
    pub fn scaled(mut self, length: f32, intensity: f32) -> LightBounds {
        self.min *= length;
        self.max *= length;
        if self.intensity > 0.0 {
            self.intensity = (self.intensity * intensity).max(f32::MIN_POSITIVE);
        }
        self
    }

    /// Bounds of both.
    pub fn union(&self, other: &LightBounds) -> LightBounds {
        if self.intensity == 0.0 {
            return *other;
        }
        if other.intensity == 0.0 {
            return *self;
        }
        let two_sided = self.two_sided || other.two_sided;
        // Where both directions count anyway, the axes may be turned to the same side.
        let other_axis = if two_sided && self.axis.dot(other.axis) < 0.0 {
            -other.axis
        } else {
            other.axis
        };
        let (axis, cos_o) = cone_union((self.axis, self.cos_o), (other_axis, other.cos_o));
        LightBounds {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            cos_o,
            cos_e: self.cos_e.min(other.cos_e),
            intensity: self.intensity + other.intensity,
            two_sided,
        }
    }

    /// The same bounds as seen from outside, by their bounding sphere.
    pub fn cluster(&self) -> Cluster {
        Cluster {
            center: (self.min + self.max) * 0.5,
            radius: ((self.max - self.min) * 0.5).length(),
            axis: self.axis,
            cos_o: self.cos_o,
            sin_o: sine(self.cos_o),
            cos_e: self.cos_e,
            intensity: self.intensity,
            two_sided: self.two_sided,
        }
    }
}

/// [`LightBounds`] in the form that is evaluated at receivers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    center: Vec3,
    radius: f32,
    axis: Vec3,
    cos_o: f32,
    sin_o: f32,
    cos_e: f32,
    intensity: f32,
    two_sided: bool,
}

impl Cluster {
    /// An estimate of the irradiance that lights with 1/r² bring to the receiver, ≥ 0 and finite; 0 only if they
    /// bring none.
    pub fn importance(&self, at: &Receiver) -> f32 {
        match self.view(at) {
            Some(view) => {
                in_range((self.intensity * view.factor / view.d2.max(f32::MIN_POSITIVE)).max(f32::MIN_POSITIVE))
            }
            None => 0.0,
        }
    }

    /// How the receiver sees the lights; `None` only if none of them can reach it.
    pub fn view(&self, at: &Receiver) -> Option<View> {
        if self.intensity <= 0.0 {
            return None;
        }
        let to_center = self.center - at.p;
        let r2 = self.radius * self.radius;
        let d2 = to_center.length_squared();
        if d2 <= r2 * (1.0 + SLACK) || d2 == 0.0 {
            // Inside the bounding sphere nothing is known about directions.
            return Some(View { factor: 1.0, d2: r2 });
        }
        let d = d2.sqrt();
        let wi = to_center / d;
        // The angle θb under which the bounding sphere is seen.
        let sin_b = self.radius / d;
        let cos_b = sqrt_of_nonnegative(1.0 - sin_b * sin_b);
        // How far any emitter's normal is from pointing here: at least θ − θo − θb.
        let cos_w = -self.axis.dot(wi);
        let cos_w = if self.two_sided { cos_w.abs() } else { cos_w };
        let sin_w = sine(cos_w);
        let cos_x = cos_of_difference(sin_w, cos_w, self.sin_o, self.cos_o);
        let sin_x = sine_of_difference(sin_w, cos_w, self.sin_o, self.cos_o);
        let cos_l = cos_of_difference(sin_x, cos_x, sin_b, cos_b) + SLACK;
        if cos_l <= self.cos_e {
            return None;
        }
        // How far any direction to the lights is from the receiver's normal: at least θi − θb.
        let cos_i = at.cosine(wi);
        let cos_i = cos_of_difference(sine(cos_i), cos_i, sin_b, cos_b) + SLACK;
        (cos_i > 0.0).then_some(View {
            factor: cos_l * cos_i,
            d2,
        })
    }
}

/// How a group of lights is seen.
pub(crate) struct View {
    /// Product of the largest cosines at the lights and at the receiver.
    pub factor: f32,
    /// Squared distance to the centre, at least that of the bounding sphere's surface.
    pub d2: f32,
}

/// Brings a positive f64 to a positive, finite f32; NaN and negative values (colours that are none) count as no light.
fn positive(x: f64) -> f32 {
    if x > 0.0 {
        in_range((x as f32).max(f32::MIN_POSITIVE))
    } else {
        0.0
    }
}

/// Leaves room for sums of 2³¹ importances.
pub(crate) fn in_range(x: f32) -> f32 {
    x.min(f32::MAX / 1e10)
}

fn sine(cos: f32) -> f32 {
    sqrt_of_nonnegative((1.0 - cos) * (1.0 + cos))
}

/// cos(max(a − b, 0)) for angles in [0, π].
fn cos_of_difference(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b {
        1.0
    } else {
        cos_a * cos_b + sin_a * sin_b
    }
}

/// sin(max(a − b, 0)) for angles in [0, π].
fn sine_of_difference(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b {
        0.0
    } else {
        (sin_a * cos_b - cos_a * sin_b).max(0.0)
    }
}

/// The smallest cone of directions (axis, cosine of the half angle) that holds both.
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    use crate::math::portable::{acos, atan2, sin_cos_turns};
    let (theta_a, theta_b) = (acos(a.1), acos(b.1));
    let theta_d = atan2(a.0.cross(b.0).length(), a.0.dot(b.0));
    if (theta_d + theta_b).min(PI) <= theta_a {
        return a;
    }
    if (theta_d + theta_a).min(PI) <= theta_b {
        return b;
    }
    // Rounding of the angles (a few ulp of π) must not make the cone too narrow.
    let theta_o = (theta_a + theta_d + theta_b) * 0.5 + PI * gamma(16);
    let everything = (Vec3::Z, -1.0);
    if theta_o >= PI {
        return everything;
    }
    let Some(side) = crate::math::robust::try_normalize(b.0 - a.0 * a.0.dot(b.0)) else {
        return everything; // opposite axes, up to rounding
    };
    let turns = |x: f32| x.max(0.0) / std::f32::consts::TAU;
    let (sin, cos) = sin_cos_turns(turns(theta_o - theta_a));
    match crate::math::robust::try_normalize(a.0 * cos + side * sin) {
        Some(axis) => (axis, sin_cos_turns(turns(theta_o)).1),
        None => everything,
    }
}
