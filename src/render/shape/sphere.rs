//! Spheres, wholly in f64: in f32 a wall sphere of radius 1e5 stands 0.06 units off, a far small one is lost.

use super::Line;
use super::candidates::Candidates;
use glam::DVec3;

/// Distance along `d` to a sphere of squared radius `r2` around the origin, from `o`; infinite for a miss.
///
/// The discriminant is taken from the foot of the perpendicular, r² − |o − (o·d/d·d) d|², which does not cancel for far
/// small spheres, and always divided by d·d: rounded directions are never quite unit. Of the two roots the one
/// in front is formed without cancellation. `starts_here` says that the ray leaves this very sphere: seen from
/// outside it cannot meet it again, from inside only the far side counts, so no epsilon is needed.
/// No branches on the way, so that the loop over several spheres becomes vector code.
/// Source: Haines et al., Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems ch. 7.
#[inline(always)]
pub fn distance(o: [f64; 3], d: [f64; 3], dd: f64, inv_dd: f64, r2: f64, starts_here: bool) -> f64 {
    let b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
    let k = b * inv_dd;
    let (x, y, z) = (o[0] - k * d[0], o[1] - k * d[1], o[2] - k * d[2]);
    let disc = r2 - (x * x + y * y + z * z);
    let c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - r2;
    let positive = if disc > 0.0 { disc } else { 0.0 };
    let s = (dd * positive).sqrt();
    let inside = c <= 0.0;
    let leaving = inside & (b <= 0.0);
    let numerator = if leaving { s - b } else { c.abs() };
    let denominator = if leaving { dd } else { s + b.abs() };
    let met = (disc >= 0.0) & (inside | ((b < 0.0) & !starts_here));
    if met { numerator / denominator } else { f64::INFINITY }
}

/// The unit sphere around the origin.
pub fn intersect_unit(line: Line, shift: f64, found: &mut Candidates) {
    let dd = line.d.length_squared();
    let t = distance(line.o.to_array(), line.d.to_array(), dd, 1.0 / dd, 1.0, found.from == 0);
    found.offer(shift + t, 0);
}

/// The point of the unit sphere under `p`, and its normal.
pub fn project_unit(p: DVec3) -> (DVec3, DVec3) {
    let n = p.try_normalize().unwrap_or(DVec3::Y);
    (n, n)
}
