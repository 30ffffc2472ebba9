//! The power of lights, as far as the scene can catch it: a measure that is the same everywhere.

use super::Light;
use super::bounds::LightBounds;
use super::lamp::{Falloff, SpotProfile};
use crate::math::color::luminance;
use crate::math::portable::cos_f64;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Largest power that is told apart, so that sums stay finite.
const MOST: f64 = 1e300;

/// Luminance of the flux of a light into a scene of radius `reach` > 0; finite, ≥ 0, and 0 only for a light without
/// any. Of lights from infinitely far it is what a sphere of that radius catches; of lamps that do not follow 1/r²,
/// what arrives at that distance.
pub(crate) fn of(light: &Light, reach: f64) -> f64 {
    let disc = PI * reach * reach;
    let sides = |two_sided: bool| if two_sided { 2.0 } else { 1.0 };
    let (color, factor) = match light {
        Light::Point(l) => (l.color, lamp(&l.falloff, reach)),
        Light::Spot(l) => (l.color, lamp(&l.falloff, reach) * cone_share(&l.profile)),
        Light::Area(l) => {
            let share = l.spot.as_ref().map_or(1.0, |(_, profile)| cone_share(profile));
            (l.color, lamp(&l.falloff, reach) * share)
        }
        Light::Directional(l) => (l.color, PI * disc), // E = π·colour at normal incidence
        Light::Environment(l) => return told_apart(l.mean_luminance(), 4.0 * PI * disc),
        Light::Moving(l) => return l.keys().iter().map(|key| of(key, reach)).fold(0.0, f64::max),
        Light::Sphere(l) => (l.radiance, sides(l.two_sided) * PI * 4.0 * PI * l.radius * l.radius),
        Light::SphereCap(l) => (l.sphere.radiance, sides(l.sphere.two_sided) * PI * l.area()),
        Light::Triangle(l) => (
            l.radiance,
            sides(l.two_sided) * PI * 0.5 * l.normal_twice_area().length(),
        ),
        Light::Parallelogram(l) => (l.radiance, sides(l.two_sided) * PI * l.normal_area().length()),
        Light::Disc(l) => (l.radiance, sides(l.two_sided) * PI * l.normal_area().length()),
    };
    told_apart(f64::from(luminance(color)), factor)
}

/// The product of both; positive where the first is, also where the product underflows.
fn told_apart(brightness: f64, factor: f64) -> f64 {
    if brightness > 0.0 {
        (brightness * factor).clamp(f64::MIN_POSITIVE, MOST)
    } else {
        0.0
    }
}

/// E·4πr² at the scene's radius for a colour of 1; with 1/r² that is 4π at any distance, the range left aside.
fn lamp(falloff: &Falloff, reach: f64) -> f64 {
    match falloff {
        Falloff::InverseSquare { .. } => 4.0 * PI,
        Falloff::None | Falloff::Fade { .. } => 4.0 * PI * reach * reach * f64::from(falloff.irradiance(reach)),
    }
}

/// The part of the sphere of directions that a spot lights: its cone up to half way between full light and none.
fn cone_share(profile: &SpotProfile) -> f64 {
    let (inner, outer) = profile.half_angles();
    0.5 * (1.0 - cos_f64((0.5 * (inner + outer)).clamp(0.0, PI)))
}

/// The radius of a scene: half the diagonal of the box around the camera (the origin), what stands in it, and lamps.
/// 1 where all of that is one point.
pub(crate) fn reach(lights: &[Light], bounds: Option<(Vec3, Vec3)>) -> f64 {
    let lamps = lights.iter().filter_map(LightBounds::of).map(|b| (b.min, b.max));
    let start = (DVec3::ZERO, DVec3::ZERO);
    let (min, max) = lamps.chain(bounds).fold(start, |(min, max), (low, high)| {
        (min.min(low.as_dvec3()), max.max(high.as_dvec3()))
    });
    let radius = 0.5 * (max - min).length();
    if radius > 0.0 && radius.is_finite() {
        radius
    } else {
        1.0
    }
}
