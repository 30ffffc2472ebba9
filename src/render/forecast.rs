//! What more time would bring, from the errors that were seen so far.
//!
//! E falls like n⁻ᵃ. Plain Monte Carlo has a = ½; nets do better where the picture is smooth, and an estimate that
//! still weighs rare finds too much falls faster too. The exponent is fitted to the looks of the last two octaves,
//! drawn towards ½ by what is known beforehand, and half of what it differs from ½ is believed to last: on the
//! calibration scenes fast falls slow down.

use super::estimate::ErrorEstimate;
use crate::math::portable::{exp_f64 as exp, ln_f64 as ln};

/// The exponent that is expected, its standard deviation over scenes, and the range that is believed.
const EXPONENT: f64 = 0.5;
const EXPONENT_SD: f64 = 0.2;
const EXPONENTS: [f64; 2] = [0.35, 1.2];
/// The share of an exponent's deviation from ½ that lasts, and how far that is off.
const LASTING: f64 = 0.5;
const LASTING_SD: f64 = 0.03;
/// Two-sided confidence 90 %.
const Z: f64 = 1.645;
/// No forecast is closer than this factor: looks are discrete, and machines have other things to do.
const LEAST_FACTOR: f64 = 1.1;
/// Looks further back than this share of the samples say little about what comes.
const OCTAVES_BACK: f64 = 0.25;

/// The error at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Samples per pixel.
    pub spp: f64,
    /// The error then.
    pub error: f64,
    /// Its bound.
    pub bound: f64,
}

/// What more time would bring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Seconds of rendering from the look until the first error goal is reached, from and to, with 90 % confidence;
    /// `None` without a goal, 0 once it is reached.
    pub to_goal: Option<[f64; 2]>,
    /// Seconds more for half the error.
    pub halving: f64,
    /// E after ten times the rendering time.
    pub tenfold: f64,
    /// The exponent a that is behind these.
    pub exponent: f64,
}

impl Forecast {
    /// From all looks so far (the last is now), the seconds a sample per pixel takes, and the least ratio of a bound
    /// to its goal. `None` before two looks and without noise.
    pub fn from_looks(looks: &[Look], seconds_per_sample: f64, to_goal: Option<f64>) -> Option<Forecast> {
        let (now, _) = looks
            .split_last()
            .filter(|(now, before)| now.error > 0.0 && !before.is_empty())?;
        let uncertainty = (now.bound / now.error - 1.0) / 1.28;
        let (exponent, spread) = exponent(looks, uncertainty);
        let more = |factor: f64| seconds_per_sample * now.spp * (factor - 1.0).max(0.0);
        let range = |ratio: f64| {
            if ratio <= 1.0 {
                return [0.0; 2];
            }
            let log = ln(ratio) / exponent;
            let sd = f64::hypot(log * spread / exponent, uncertainty / exponent);
            let factor = exp(Z * sd).max(LEAST_FACTOR);
            [more(exp(log) / factor), more(exp(log) * factor)]
        };
        Some(Forecast {
            to_goal: to_goal.map(range),
            halving: more(exp(core::f64::consts::LN_2 / exponent)),
            tenfold: now.error * exp(-exponent * core::f64::consts::LN_10),
            exponent,
        })
    }
}

/// The exponent and its standard deviation: least squares on the logarithms of the bounds, weighed against what is
/// expected. Looks share samples: the variance of the slope is about that of two looks with a correlation of ¼.
fn exponent(looks: &[Look], uncertainty: f64) -> (f64, f64) {
    let Some(now) = looks.last() else {
        return (EXPONENT, EXPONENT_SD);
    };
    let recent = || {
        looks
            .iter()
            .filter(|l| l.spp >= OCTAVES_BACK * now.spp && l.bound > 0.0)
    };
    let points = || recent().map(|l| (ln(l.spp), ln(l.bound)));
    let n = points().count() as f64;
    let mean = points().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
    let (xx, xy) = points().fold((0.0, 0.0), |s, p| {
        let (dx, dy) = (p.0 - mean.0, p.1 - mean.1);
        (s.0 + dx * dx, s.1 + dx * dy)
    });
    let prior = 1.0 / (EXPONENT_SD * EXPONENT_SD);
    if xx == 0.0 {
        return (EXPONENT, EXPONENT_SD);
    }
    let span = recent().next().map_or(0.0, |first| ln(now.spp / first.spp));
    let precision = span * span / (1.5 * uncertainty * uncertainty);
    let fitted = if precision.is_finite() {
        (precision * (-xy / xx) + prior * EXPONENT) / (precision + prior)
    } else {
        -xy / xx
    };
    let spread = (1.0 / (precision + prior)).sqrt();
    let lasting = EXPONENT + LASTING * (fitted.clamp(EXPONENTS[0], EXPONENTS[1]) - EXPONENT);
    (lasting, f64::hypot(LASTING * spread, LASTING_SD))
}

impl Look {
    /// Of an estimate.
    pub fn new(spp: f64, error: &ErrorEstimate) -> Look {
        Look {
            spp,
            error: error.error,
            bound: error.bound,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks at 64·2^(k/4), E = c·n^-a, 2 % uncertain.
    fn looks(a: f64, count: u32) -> Vec<Look> {
        (0..count)
            .map(|k| {
                let spp = 64.0 * 2f64.powf(f64::from(k) / 4.0);
                let error = 3.0 * spp.powf(-a);
                Look {
                    spp,
                    error,
                    bound: error * (1.0 + 1.28 * 0.02),
                }
            })
            .collect()
    }

    /// Oracle: the law the looks follow, half of whose deviation from ½ lasts: (a + ½)/2. From n on, a goal of half the
    /// bound needs n·2^(1/a) samples.
    #[test]
    fn the_law_behind_the_looks_is_found() {
        for fall in [0.45, 0.5, 0.75, 1.0] {
            let looks = looks(fall, 13);
            let a = 0.5 * (fall + 0.5);
            let now = looks[12];
            let found = Forecast::from_looks(&looks, 0.01, Some(2.0)).unwrap();
            assert!((found.exponent / a - 1.0).abs() < 0.03, "{} for {a}", found.exponent);
            let truth = 0.01 * now.spp * (2f64.powf(1.0 / a) - 1.0);
            let [from, to] = found.to_goal.unwrap();
            assert!(
                from < truth && truth < to && to < 2.5 * from,
                "{from}..{to} for {truth}"
            );
            assert!(
                (found.halving / truth - 1.0).abs() < 0.06,
                "{} for {truth}",
                found.halving
            );
            let tenfold = now.error * 10f64.powf(-a);
            assert!((found.tenfold / tenfold - 1.0).abs() < 0.06);
        }
    }

    /// Oracle: two estimates of one number with their variances. The slope 1 between two looks a quarter of an octave
    /// apart has the variance 1.5·0.02²/ln²(2^¼), what is expected 0.2² around ½.
    #[test]
    fn two_looks_close_together_are_weighed_against_what_is_expected() {
        let found = Forecast::from_looks(&looks(1.0, 2), 0.01, None).unwrap();
        let span = core::f64::consts::LN_2 / 4.0;
        let (slope, prior) = (span * span / (1.5 * 0.02 * 0.02), 25.0);
        let want = 0.25 + 0.5 * (slope * 1.0 + prior * 0.5) / (slope + prior);
        assert!(
            (found.exponent / want - 1.0).abs() < 1e-9,
            "{} instead of {want}",
            found.exponent
        );
        assert_eq!(found.to_goal, None);
    }

    #[test]
    fn a_goal_that_is_reached_takes_no_time_and_one_look_says_nothing() {
        assert_eq!(Forecast::from_looks(&looks(0.5, 1), 0.01, Some(2.0)), None);
        let found = Forecast::from_looks(&looks(0.5, 5), 0.01, Some(0.9)).unwrap();
        assert_eq!(found.to_goal, Some([0.0; 2]));
    }
}
