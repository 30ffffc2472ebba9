//! Light that meets glass aslant.

use crate::support::estimate::WHOLE;
use crate::support::scenes::ready;

const SIZE: [u32; 2] = [8, 8];
const ETA: f64 = 1.5;

/// Reflectance for unpolarised light from outside, and the tangent of the refracted angle. Source: Fresnel, Snell.
fn fresnel(theta: f64) -> (f64, f64) {
    let (sin, cos) = theta.sin_cos();
    let sin_t = sin / ETA;
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let s = (cos - ETA * cos_t) / (cos + ETA * cos_t);
    let p = (ETA * cos - cos_t) / (ETA * cos + cos_t);
    (0.5 * (s * s + p * p), sin_t / cos_t)
}

fn mean(defines: &[(&str, &str)]) -> crate::support::estimate::RegionMean {
    ready("tests/hard/glass/slab.pts", defines, SIZE)
        .estimate(1 << 12, 1)
        .region(WHOLE)
}

/// All orders of reflection inside together pass (1 − R)/(1 + R), R between unpolarised light and either face.
#[test]
fn a_slab_passes_its_share_at_any_angle() {
    for tilt in [30.0, 60.0, 80.0f64] {
        let (r, _) = fresnel(tilt.to_radians());
        let exact = (1.0 - r) / (1.0 + r);
        mean(&[("Tilt", &tilt.to_string())]).assert_near([exact; 3], 0.01, 5.0, &format!("slab at {tilt}°"));
    }
}

/// Straight through a slab of thickness 1 and one more unit to the wall, light lands at x = tan θt + tan θ; each pair of
/// reflections inside shifts it by 2·tan θt. A wall that ends just short of the first place is not seen at all, one that
/// ends halfway to the second shows (1 − R)².
#[test]
fn a_slab_shifts_what_is_seen_through_it() {
    for tilt in [30.0, 60.0, 80.0f64] {
        let (r, tan_t) = fresnel(tilt.to_radians());
        let first = tan_t + tilt.to_radians().tan();
        // The field is 0.1° wide: at the wall ±0.9e-3·(path length)/cos θ, less than 2 % of the shift.
        let seen = |edge: f64| mean(&[("Tilt", &tilt.to_string()), ("Edge", &edge.to_string())]);
        assert_eq!(
            seen(first - 0.3 * tan_t).mean,
            [0.0; 3],
            "before the first place at {tilt}°"
        );
        let once = (1.0 - r) * (1.0 - r);
        seen(first + tan_t).assert_near([once; 3], 0.01, 5.0, &format!("the first beam at {tilt}°"));
    }
}
