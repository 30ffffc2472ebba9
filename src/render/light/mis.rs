//! The weight of one sampling strategy beside another.

/// Power heuristic (exponent 2) for a sample drawn with density `pdf_a` that another strategy draws with `pdf_b`.
///
/// In [0, 1]; an infinite density is a delta and takes all, two of them share; 0 if the strategy cannot draw the sample.
/// The quotient of the densities is formed first, so nothing overflows; w(a, b) + w(b, a) = 1 within 4u.
/// Source: Veach, Robust Monte Carlo Methods for Light Transport Simulation, §9.2.4.
pub fn mis_weight(pdf_a: f32, pdf_b: f32) -> f32 {
    if pdf_a == 0.0 {
        return 0.0;
    }
    if pdf_a == pdf_b {
        return 0.5; // also for two infinite densities
    }
    if pdf_a > pdf_b {
        let r = pdf_b / pdf_a;
        1.0 / (1.0 + r * r)
    } else {
        let r = pdf_a / pdf_b;
        let r2 = r * r;
        r2 / (1.0 + r2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::robust::{UNIT_ROUNDOFF, gamma};
    use crate::math::stats::Pcg;

    /// Oracle: the same formula in f64, whose range the squares of all f32 fit.
    #[test]
    fn weights_match_f64_and_sum_to_one_over_the_whole_range() {
        let mut rng = Pcg::new(11);
        for _ in 0..1_000_000 {
            // From the smallest subnormal number, 1.4e-45, to the largest of all, 3.4e38.
            let mut draw = || 10f64.powf(83.38 * rng.next_f64() - 44.85) as f32;
            let (a, b) = (draw(), draw());
            let (wa, wb) = (mis_weight(a, b), mis_weight(b, a));
            assert!((wa + wb - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF, "{a} {b}: {wa} + {wb}");
            let exact = f64::from(a).powi(2) / (f64::from(a).powi(2) + f64::from(b).powi(2));
            // Six roundings; the quotient of the densities may be subnormal, its square may vanish.
            let off = (f64::from(wa) - exact).abs();
            assert!(
                off <= f64::from(gamma(6)) * exact + 1e-37,
                "{a} {b}: {wa}, exactly {exact}"
            );
        }
    }

    #[test]
    fn a_delta_takes_all_and_the_impossible_nothing() {
        for pdf in [f32::from_bits(1), 1e-38, 3.0, 1e38, f32::MAX] {
            assert_eq!(
                (mis_weight(f32::INFINITY, pdf), mis_weight(pdf, f32::INFINITY)),
                (1.0, 0.0)
            );
            assert_eq!((mis_weight(pdf, 0.0), mis_weight(0.0, pdf)), (1.0, 0.0));
            assert_eq!(mis_weight(pdf, pdf), 0.5);
        }
        assert_eq!(
            (mis_weight(0.0, 0.0), mis_weight(f32::INFINITY, f32::INFINITY)),
            (0.0, 0.5)
        );
        assert_eq!(
            (mis_weight(f32::INFINITY, 0.0), mis_weight(0.0, f32::INFINITY)),
            (1.0, 0.0)
        );
        assert!((mis_weight(3e19, 1e19) - 0.9).abs() < 4.0 * UNIT_ROUNDOFF); // the squares would overflow
    }
}
