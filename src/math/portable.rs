//! Elementary functions with the same bits on every machine. `render` uses these, never the platform's.
//! Square roots and the four operations are exact by IEEE 754 and need no wrapper.

/// e^x.
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm; −∞ at 0, NaN below.
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// x^y for x ≥ 0; 0^0 is 1.
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Angle of (x, y) in (−π, π].
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Arc cosine of `x`, which is first clamped to [−1, 1]: rounding may carry a dot product of unit vectors outside.
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// eˣ in double precision.
pub fn exp_f64(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm in double precision.
pub fn ln_f64(x: f64) -> f64 {
    libm::log(x)
}

/// Cosine in f64, for tables made before rendering.
pub fn cos_f64(x: f64) -> f64 {
    libm::cos(x)
}

/// (sin x, cos x) for |x| ≤ π/4, absolute error below 1e-7: Taylor polynomials.
#[inline(always)]
pub fn sin_cos_octant(x: f32) -> (f32, f32) {
    let x2 = x * x;
    let s = x + x * x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0))));
    let c = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0))));
    (s, c)
}

/// (sin 2πu, cos 2πu) for u in [0, 1], absolute error below 2e-7, and exactly on the axes at quarter turns.
/// Reduction by quarter turns is exact, then Taylor polynomials on [−π/4, π/4].
pub fn sin_cos_turns(u: f32) -> (f32, f32) {
    let quarter = (u * 4.0 + 0.5) as i32; // nearest quarter turn, u ≥ 0
    let x = (u - quarter as f32 * 0.25) * std::f32::consts::TAU; // exact subtraction (Sterbenz)
    let (s, c) = sin_cos_octant(x);
    match quarter & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: f64 sine and cosine.
    #[test]
    fn sine_and_cosine_of_turns_match_f64() {
        for i in 0..=100_000u32 {
            let u = i as f32 / 100_000.0;
            let (s, c) = sin_cos_turns(u);
            let exact = f64::from(u) * std::f64::consts::TAU;
            let off = (f64::from(s) - exact.sin())
                .abs()
                .max((f64::from(c) - exact.cos()).abs());
            assert!(off < 2e-7, "u = {u}: off by {off}");
        }
        assert_eq!(sin_cos_turns(0.25), (1.0, 0.0));
        assert_eq!(sin_cos_turns(0.5).1, -1.0);
    }

    /// Catalogue of hard cases H 49: rounding may carry a cosine beyond 1, and a small angle has no digits in its cosine,
    /// but all in its tangent.
    #[test]
    fn angles_survive_rounding() {
        let u = super::super::robust::UNIT_ROUNDOFF;
        for beyond in [1.0, 1.0 + 2.0 * u, 1.000_001, 7.0, f32::INFINITY] {
            assert_eq!(acos(beyond), 0.0);
            assert!((acos(-beyond) - std::f32::consts::PI).abs() <= 4.0 * u);
        }
        for angle in [1e-30f64, 3e-4, 0.1, 1.0, 3.0] {
            let found = atan2(angle.sin() as f32, angle.cos() as f32);
            assert!(
                (f64::from(found) / angle - 1.0).abs() <= 4.0 * f64::from(u),
                "{angle}: {found}"
            );
        }
        let by_cosine = f64::from(acos(1e-4f64.cos() as f32));
        assert_eq!(by_cosine, 0.0, "a cosine has kept an angle of 1e-4");
    }
}
