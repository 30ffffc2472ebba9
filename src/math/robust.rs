//! Arithmetic that does not lose what matters. Each form states its error; `u` is 2⁻²⁴.

use glam::{DVec3, Vec3};

/// Unit roundoff of f32, 2⁻²⁴.
pub const UNIT_ROUNDOFF: f32 = 1.0 / 16_777_216.0;

/// The largest f32 below 1; random numbers never exceed it.
pub const ONE_MINUS: f32 = 1.0 - UNIT_ROUNDOFF;

/// γ(n) = n·u/(1 − n·u): bounds the relative error of n f32 roundings in a row.
/// Source: Higham, Accuracy and Stability of Numerical Algorithms, lemma 3.1.
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// Square root of `x`; 0 where rounding made a mathematically non-negative value negative.
pub fn sqrt_of_nonnegative(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// Roots of a·t² + 2·b·t + c = 0 in ascending order, without cancellation; `None` without real roots.
/// a must not be 0. For b² ≫ a·c the small root keeps full relative precision.
pub fn roots_of_half_quadratic(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    let disc = b * b - a * c;
    if disc.is_nan() || disc < 0.0 {
        return None;
    }
    let q = -(b + disc.sqrt().copysign(b));
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
    Some(if t0 < t1 { (t0, t1) } else { (t1, t0) })
}

/// `v / |v|` for any finite non-zero `v`, however short or long; `None` for zero, infinite and NaN vectors.
/// Scaling by the largest component first keeps the squares from under- and overflowing.
pub fn try_normalize(v: Vec3) -> Option<Vec3> {
    let m = v.abs().max_element();
    // The maximum passes over numbers that are none; they show in the sum of squares.
    let n = (v / m).normalize();
    (m > 0.0 && m.is_finite() && n.is_finite()).then_some(n)
}

/// The f64 form of [`try_normalize`].
pub fn try_normalize_f64(v: DVec3) -> Option<DVec3> {
    let m = v.abs().max_element();
    // The maximum passes over numbers that are none; they show in the sum of squares.
    let n = (v / m).normalize();
    (m > 0.0 && m.is_finite() && n.is_finite()).then_some(n)
}

/// Moves a surface point off the surface, to the side `w` points to, by at least its own error bound.
///
/// `p` is the computed point, `p_error` bounds |p − exact| per axis, `ng` is the unit geometric normal.
/// The result lies on the side of `w` of every plane with normal `ng` through a point within the bound, the rounding of
/// the step itself included: it is at most u·(|p| + d) per axis.
/// Source: PBRT-4 §6.8.6, with the last rounding inside the bound instead of a step to the next number.
#[inline(always)]
pub fn offset_origin(p: Vec3, p_error: Vec3, ng: Vec3, w: Vec3) -> Vec3 {
    let bound = p_error + p.abs() * (2.0 * UNIT_ROUNDOFF);
    let d = ng.abs().dot(bound) * (1.0 + gamma(8)) + f32::MIN_POSITIVE;
    p + ng * d.copysign(w.dot(ng))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_long_vectors_have_unit_length() {
        for s in [1e-38f32, 1e-20, 1.0, 1e20, 1e38] {
            let n = try_normalize(Vec3::new(1.0, -2.0, 2.0) * s).map(|v| v.length());
            assert!(
                n.is_some_and(|l| (l - 1.0).abs() < 4.0 * UNIT_ROUNDOFF),
                "scale {s}: {n:?}"
            );
        }
        assert_eq!(try_normalize(Vec3::ZERO), None);
        for k in 0..3 {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut v = Vec3::ONE;
                v[k] = bad;
                assert_eq!(try_normalize(v), None, "{v}");
                assert_eq!(try_normalize_f64(v.as_dvec3()), None, "{v}");
            }
        }
    }

    /// Oracle: roots 1e-9 and 1e9 are known.
    #[test]
    fn the_small_root_is_not_lost() {
        let roots = roots_of_half_quadratic(1.0, -(1e9 + 1e-9) / 2.0, 1.0);
        let (small, large) = roots.unwrap_or((f64::NAN, f64::NAN));
        assert!((small / 1e-9 - 1.0).abs() < 1e-14 && (large / 1e9 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn an_offset_point_lies_on_the_asked_side() {
        let ng = Vec3::new(0.6, 0.0, -0.8);
        for p in [Vec3::splat(1e-6), Vec3::splat(3.0), Vec3::splat(1e6)] {
            let q = offset_origin(p, p.abs() * gamma(7), ng, -ng);
            let side = ng.as_dvec3().dot(q.as_dvec3() - p.as_dvec3());
            assert!(side < 0.0, "{p}: moved by {side}");
        }
    }
}
