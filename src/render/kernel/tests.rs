//! Directions over many bounces, and how long they are.

use super::nearly_unit;
use crate::math::frame::Frame;
use crate::math::robust::{UNIT_ROUNDOFF, try_normalize};
use crate::math::stats::Pcg;
use crate::math::warp::{cosine_hemisphere, uniform_sphere};
use crate::render::shape::sphere;
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

/// Catalogue of hard cases A 5: a direction rounded to f32 is off by up to 2u in length, which a formula that takes it for
/// 1 turns into 45 radii at a distance of 1e5. Here a hit lies on the sphere in f64, whatever the length, and is found
/// as many lengths away as the direction is short.
#[test]
fn directions_need_not_be_unit_vectors() {
    let mut rng = Pcg::new(5);
    for distance in [1e3, 1e5, 1e7f64] {
        for _ in 0..10_000 {
            let d = try_normalize(uniform_sphere(rng.next_vec2()))
                .unwrap_or(Vec3::Z)
                .as_dvec3();
            let aside = d.any_orthonormal_vector() * (0.9 * rng.next_f64());
            let o = aside - d * distance;
            let hit = |d: glam::DVec3| {
                let dd = d.length_squared();
                sphere::distance(o.to_array(), d.to_array(), dd, 1.0 / dd, 1.0, false)
            };
            let t = hit(d);
            // Coordinates of 1e7 in f64: ten roundings of them, over the cosine at the hit, which is above 0.4.
            let allowed = 25.0 * distance * f64::EPSILON;
            let off = (o + d * t).length() - 1.0;
            assert!(off.abs() <= allowed, "at {distance}: {off} from the sphere");
            for scale in [1e-3, 1.0 - 1e-6, 1.0 + 1e-7, 3.0] {
                let off = hit(d * scale) * scale - t;
                assert!(
                    off.abs() <= 2.0 * allowed,
                    "at {distance}, a direction of {scale}: {off}"
                );
            }
        }
    }
}
