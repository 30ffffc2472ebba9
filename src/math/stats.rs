//! Statistics: χ² tests for samplers, quantiles, a small generator for tests and shuffles.

use glam::Vec2;

/// A small counter-free generator for tests and set-up work (never for pixels): PCG-XSH-RR 64/32.
/// Source: O'Neill, PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms, 2014.
#[derive(Clone, Debug)]
pub struct Pcg {
    state: u64,
}

impl Pcg {
    /// A generator whose stream depends on `seed` alone.
    pub fn new(seed: u64) -> Pcg {
        let mut rng = Pcg {
            state: seed.wrapping_add(0x9E37_79B9_7F4A_7C15),
        };
        rng.next_u32();
        rng
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let x = (((old >> 18) ^ old) >> 27) as u32;
        x.rotate_right((old >> 59) as u32)
    }

    /// Uniform in [0, 1), never 1.
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 / 16_777_216.0
    }

    /// Uniform in [0, 1) with 52 bits.
    pub fn next_f64(&mut self) -> f64 {
        let hi = u64::from(self.next_u32()) << 20;
        let lo = u64::from(self.next_u32()) >> 12;
        (hi | lo) as f64 / (1u64 << 52) as f64
    }

    /// Two uniform numbers in [0, 1).
    pub fn next_vec2(&mut self) -> Vec2 {
        Vec2::new(self.next_f32(), self.next_f32())
    }
}

/// ln Γ(x) for x > 0, relative error below 1e-13.
/// Source: Lanczos approximation, g = 7, 9 coefficients (Numerical Recipes §6.1).
pub fn ln_gamma(x: f64) -> f64 {
    const C: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let sum = C
        .iter()
        .enumerate()
        .skip(1)
        .fold(C[0], |s, (i, c)| s + c / (x + i as f64));
    0.5 * std::f64::consts::TAU.ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// P(χ²_k > x): the upper tail of the χ² distribution with `k` degrees of freedom.
/// Source: regularised incomplete gamma function, series and continued fraction (Numerical Recipes §6.2).
pub fn chi2_upper_tail(x: f64, k: f64) -> f64 {
    let (a, x) = (k / 2.0, x / 2.0);
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term.abs() > sum.abs() * 1e-15 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    let tiny = f64::MIN_POSITIVE / f64::EPSILON;
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / tiny;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..10_000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        let safe = |v: f64| if v.abs() < tiny { tiny } else { v };
        d = 1.0 / safe(an * d + b);
        c = safe(b + an / c);
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h
}

/// p-value of the χ² test of observed counts against expected ones. Cells expecting fewer than 5 are pooled
/// (Cochran's rule). 1 if fewer than two cells are left.
pub fn chi2_test(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut stat, mut cells) = (0.0, 0usize);
    let (mut pool_o, mut pool_e) = (0.0, 0.0);
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            pool_o += o;
            pool_e += e;
        } else {
            stat += (o - e) * (o - e) / e;
            cells += 1;
        }
    }
    if pool_e >= 5.0 {
        stat += (pool_o - pool_e) * (pool_o - pool_e) / pool_e;
        cells += 1;
    } else if pool_e == 0.0 && pool_o > 0.0 {
        return 0.0; // samples where the density is zero
    }
    if cells < 2 {
        1.0
    } else {
        chi2_upper_tail(stat, (cells - 1) as f64)
    }
}

/// p-value that `f` of `n` uniform points of the square is uniform on the square, by a χ² test on `k`×`k` cells.
/// Points outside the square count as observed in no cell and fail the test.
pub fn chi2_uniform_grid(seed: u64, n: usize, k: usize, f: &dyn Fn(Vec2) -> Vec2) -> f64 {
    let mut rng = Pcg::new(seed);
    let mut counts = vec![0.0; k * k];
    let mut outside = 0usize;
    for _ in 0..n {
        let p = f(rng.next_vec2());
        let slack = 1.0 + 1e-5; // rounding at the border of the back-mapped square
        if !(p.min_element() >= 1.0 - slack && p.max_element() <= slack) {
            outside += 1;
            continue;
        }
        let cell = (p * k as f32).clamp(Vec2::ZERO, Vec2::splat(k as f32 - 1.0)).as_uvec2();
        counts[cell.y as usize * k + cell.x as usize] += 1.0;
    }
    if outside > 0 {
        return 0.0;
    }
    chi2_test(&counts, &vec![n as f64 / (k * k) as f64; k * k])
}

/// Quantile of the standard normal distribution, |error| < 4.5e-4 … refined to 1e-9 by one Halley step.
/// Source: Acklam's rational approximation.
pub fn normal_quantile(p: f64) -> f64 {
    let p = p.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0);
    let tail = |q: f64| {
        let num =
            ((((-7.784894002430293e-3 * q - 0.3223964580411365) * q - 2.400758277161838) * q - 2.549732539343734) * q
                + 4.374664141464968)
                * q
                + 2.938163982698783;
        let den = (((7.784695709041462e-3 * q + 0.3224671290700398) * q + 2.445134137142996) * q + 3.754408661907416)
            * q
            + 1.0;
        num / den
    };
    let x = if p < 0.02425 {
        tail((-2.0 * p.ln()).sqrt())
    } else if p > 1.0 - 0.02425 {
        -tail((-2.0 * (1.0 - p).ln()).sqrt())
    } else {
        let q = p - 0.5;
        let r = q * q;
        let num = (((((-39.69683028665376 * r + 220.9460984245205) * r - 275.9285104469687) * r + 138.357751867269)
            * r
            - 30.66479806614716)
            * r
            + 2.506628277459239)
            * q;
        let den = ((((-54.47609879822406 * r + 161.5858368580409) * r - 155.6989798598866) * r + 66.80131188771972)
            * r
            - 13.28068155288572)
            * r
            + 1.0;
        num / den
    };
    let e = 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2) - p;
    let u = e * std::f64::consts::TAU.sqrt() * (x * x / 2.0).exp();
    x - u / (1.0 + x * u / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table values: χ² 0.05 quantiles (NIST/SEMATECH e-Handbook 1.3.6.7.4).
    #[test]
    fn chi2_tail_matches_tables() {
        for (x, k) in [(3.841, 1.0), (18.307, 10.0), (124.342, 100.0)] {
            assert!(
                (chi2_upper_tail(x, k) - 0.05).abs() < 2e-5,
                "{k}: {}",
                chi2_upper_tail(x, k)
            );
        }
    }

    #[test]
    fn normal_quantile_matches_tables() {
        for (p, z) in [
            (0.5, 0.0),
            (0.9, 1.281_551_565_5),
            (0.995, 2.575_829_303_5),
            (1e-6, -4.753_424_308_8),
        ] {
            assert!((normal_quantile(p) - z).abs() < 1e-8, "{p}: {}", normal_quantile(p));
        }
    }

    #[test]
    fn a_skewed_map_is_found_out() {
        assert!(chi2_uniform_grid(1, 100_000, 16, &|u| u) > 1e-4);
        assert!(chi2_uniform_grid(1, 100_000, 16, &|u| Vec2::new(u.x * u.x, u.y)) < 1e-9);
    }
}
