//! Directions over many bounces.

use super::nearly_unit;
use crate::math::frame::Frame;
use crate::math::robust::{UNIT_ROUNDOFF, try_normalize};
use crate::math::stats::Pcg;
use crate::math::warp::{cosine_hemisphere, uniform_sphere};
use glam::Vec3;

fn off_unit(v: Vec3) -> f64 {
    (v.as_dvec3().length() - 1.0).abs()
}

/// Catalogue of hard cases A 6: each bounce squares what is off before it adds its own roundings, so that the length
/// after a thousand is as good as after one. Left alone it drifts, which the second half shows.
#[test]
fn directions_do_not_drift_over_a_thousand_mirrors() {
    let mut rng = Pcg::new(6);
    let (mut largest, mut drift) = (0.0f64, 0.0f64);
    for _ in 0..500 {
        let mut kept = uniform_sphere(rng.next_vec2());
        kept = try_normalize(kept).unwrap_or(Vec3::Z);
        let mut left_alone = kept;
        for _ in 0..1000 {
            let n = try_normalize(uniform_sphere(rng.next_vec2())).unwrap_or(Vec3::Z);
            let frame = Frame::from_normal(n);
            let bounce = |d: Vec3| {
                let wo = frame.to_local(-d);
                frame.to_world(Vec3::new(-wo.x, -wo.y, wo.z))
            };
            (kept, left_alone) = (nearly_unit(bounce(kept)), bounce(left_alone));
            largest = largest.max(off_unit(kept));
        }
        drift = drift.max(off_unit(left_alone));
    }
    let u = f64::from(UNIT_ROUNDOFF);
    assert!(largest <= 4.0 * u, "off by {} u", largest / u);
    assert!(drift > 40.0 * u, "nothing drifts: {} u", drift / u);
}

/// A diffuse direction is not corrected, since it is new: what the map from the square leaves (the sine and the cosine
/// are right to 2e-7) and what the frame adds.
#[test]
fn new_directions_are_nearly_unit_vectors() {
    let mut rng = Pcg::new(7);
    let mut largest = 0.0f64;
    for _ in 0..1_000_000 {
        let n = try_normalize(uniform_sphere(rng.next_vec2())).unwrap_or(Vec3::Z);
        let wi = Frame::from_normal(n).to_world(cosine_hemisphere(rng.next_vec2()));
        largest = largest.max(off_unit(wi));
    }
    let u = f64::from(UNIT_ROUNDOFF);
    assert!(largest <= 8.0 * u, "off by {} u", largest / u);
}
