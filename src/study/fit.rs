//! Laws fitted to a ladder of sample counts: how error falls and time grows, and where a bias stops the fall.
//!
//! Error: E² = b² + (c·n^−a)², n samples per pixel. b is the level that a biased variant tends to; a is ½ for
//! independent samples and larger where well spread samples pay. Time: t = t₀ + k·n.

use super::experiment::{Row, Study};
use super::points::{median, usable};

/// Exponent of independent samples, the prior of the fit.
const EXPONENT: f64 = 0.5;
/// How far exponents of scenes lie from it, as a standard deviation.
const EXPONENT_SD: f64 = 0.1;
/// Least and greatest exponent that is believed for extrapolation.
const EXPONENT_LIMITS: [f64; 2] = [0.4, 1.0];
/// Relative departure of E from a power law that is granted to each rung besides its noise.
const MODEL_ERROR: f64 = 0.02;
/// Standard errors that b² must lie above 0 for a floor to be believed: one false alarm in a hundred.
const FLOOR_Z: f64 = 2.326;
/// Standard errors of an interval of 90 % confidence.
const Z90: f64 = 1.645;
/// Relative uncertainty of seconds per sample from one run to another, at least.
const LEAST_TIME_SPREAD: f64 = 0.05;

/// A lower, a middle and an upper value; lower and upper enclose 90 %.
pub type Band = [f64; 3];

/// One sample count: mean E² over the seeds and its standard error.
#[derive(Clone, Copy, Debug)]
struct Rung {
    n: f64,
    e2: f64,
    se: f64,
}

/// What is known of one variant at one number of threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Least and greatest samples per pixel measured.
    pub measured: [f64; 2],
    /// The level E tends to, of a biased variant where it is distinguishable from 0.
    pub floor: Option<f64>,
    /// Upper end of the floor's interval of 95 % (one-sided); 0 for an unbiased variant.
    pub floor_bound: f64,
    /// The exponent a.
    pub exponent: f64,
    /// Its standard error.
    pub exponent_se: f64,
    /// Seconds before the first sample, the median.
    pub setup: f64,
    /// Seconds for one sample of each pixel: lower, median, upper.
    pub per_sample: Band,
    // The line ln E' = at_y − a·(ln n − at_x), its variance at at_x, and the scatter of a single run around it,
    // E' being E without the floor.
    at_x: f64,
    at_y: f64,
    at_var: f64,
    scatter: f64,
}

impl Law {
    /// Fits the rows of a variant, at the threads that most of them used; `None` without a rung whose mean E² is
    /// above 0.
    pub fn of(study: &Study, variant: usize) -> Option<Self> {
        let rows = rows_at_common_threads(study, variant);
        let rungs = rungs(&rows);
        let (floor2, bound2) = match study.is_biased(variant) {
            true => floor_squared(&rungs),
            false => (None, 0.0),
        };
        let line = Line::of(&rungs, floor2.unwrap_or(0.0), floor2.is_some())?;
        let setup = median(rows.iter().map(|r| r.seconds.total() - r.seconds.render).collect());
        let first = rungs.first()?.n;
        let last = rungs.last()?.n;
        let rates: Vec<f64> = rows
            .iter()
            .filter(|row| 4.0 * f64::from(row.spp) >= last)
            .map(|row| row.seconds.render / f64::from(row.spp))
            .collect();
        let rate = median(rates.clone());
        let low = rates.iter().copied().fold(f64::INFINITY, f64::min);
        let high = rates.iter().copied().fold(0.0, f64::max);
        Some(Self {
            measured: [first, last],
            floor: floor2.map(f64::sqrt),
            floor_bound: bound2.sqrt(),
            exponent: line.a,
            exponent_se: line.a_var.sqrt(),
            setup,
            per_sample: [
                low.min(rate * (1.0 - LEAST_TIME_SPREAD)),
                rate,
                high.max(rate * (1.0 + LEAST_TIME_SPREAD)),
            ],
            at_x: line.x,
            at_y: line.y,
            at_var: line.y_var,
            scatter: scatter(&rows),
        })
    }

    /// E of one run with `n` samples per pixel.
    pub fn error(&self, n: f64) -> Band {
        let dx = n.ln() - self.at_x;
        let middle = self.at_y - self.exponent * dx;
        let sd = (self.at_var + (dx * self.exponent_se).powi(2) + self.scatter.powi(2)).sqrt();
        let floor2 = self.floor.map_or(0.0, |b| b * b);
        [-Z90, 0.0, Z90].map(|z| (floor2 + (2.0 * (middle + z * sd)).exp()).sqrt())
    }

    /// Samples per pixel after which E is expected to be `error`; `None` if the floor forbids it. May be below 1.
    pub fn samples_for_error(&self, error: f64) -> Option<f64> {
        let rest = error * error - self.floor.map_or(0.0, |b| b * b);
        let n = (self.at_x + (self.at_y - 0.5 * rest.ln()) / self.exponent).exp();
        (rest > 0.0 && n.is_finite()).then_some(n)
    }

    /// Seconds of one run with `n` samples per pixel, set-up included.
    pub fn seconds(&self, n: f64) -> Band {
        self.per_sample.map(|k| self.setup + k * n)
    }

    /// Samples per pixel that fit into `seconds`; `None` if the set-up alone takes longer.
    pub fn samples_for_seconds(&self, seconds: f64) -> Option<f64> {
        let n = (seconds - self.setup) / self.per_sample[1];
        (n.is_finite() && n > 0.0).then_some(n)
    }
}

fn rows_at_common_threads(study: &Study, variant: usize) -> Vec<&Row> {
    let rows: Vec<&Row> = usable(study).filter(|row| row.variant == variant).collect();
    let uses = |threads: usize| rows.iter().filter(|row| row.threads == threads).count();
    let Some(threads) = rows.iter().map(|row| row.threads).max_by_key(|&t| (uses(t), t)) else {
        return rows;
    };
    rows.into_iter().filter(|row| row.threads == threads).collect()
}

fn rungs(rows: &[&Row]) -> Vec<Rung> {
    let mut counts: Vec<u32> = rows.iter().map(|row| row.spp).collect();
    counts.sort_unstable();
    counts.dedup();
    let rung = |spp: &u32| {
        let rows: Vec<&&Row> = rows.iter().filter(|row| row.spp == *spp).collect();
        let size = rows.len() as f64;
        let e2 = rows.iter().map(|row| row.e2).sum::<f64>() / size;
        let own = |row: &&&Row| if row.e2_se.is_finite() { row.e2_se.powi(2) } else { 0.0 };
        let within = rows.iter().map(own).sum::<f64>() / size;
        let between = match rows.len() {
            1 => 0.0,
            _ => rows.iter().map(|row| (row.e2 - e2).powi(2)).sum::<f64>() / (size - 1.0),
        };
        Rung {
            n: f64::from(*spp),
            e2,
            se: (within.max(between) / size).sqrt(),
        }
    };
    counts.iter().map(rung).collect()
}

/// Weighted least squares of E² = b² + c/n: b² where it is above noise, and the upper end of its interval.
fn floor_squared(rungs: &[Rung]) -> (Option<f64>, f64) {
    // A rung's own standard error, and never less than the model's.
    let weight = |r: &Rung| 1.0 / (r.se.powi(2) + (2.0 * MODEL_ERROR * r.e2).powi(2));
    let used: Vec<(f64, f64, f64)> = rungs
        .iter()
        .map(|r| (weight(r), 1.0 / r.n, r.e2))
        .filter(|(w, ..)| w.is_finite())
        .collect();
    let sum = |f: &dyn Fn(&(f64, f64, f64)) -> f64| used.iter().map(f).sum::<f64>();
    let all = sum(&|p| p.0);
    let (x, y) = (sum(&|p| p.0 * p.1) / all, sum(&|p| p.0 * p.2) / all);
    let sxx = sum(&|p| p.0 * (p.1 - x).powi(2));
    if used.len() < 2 || sxx.is_nan() || sxx <= 0.0 {
        // One rung: the floor may be anything up to what was seen.
        let highest = rungs.iter().map(|r| r.e2 + Z90 * r.se).fold(0.0, f64::max);
        return (None, highest);
    }
    let slope = sum(&|p| p.0 * (p.1 - x) * (p.2 - y)) / sxx;
    let level = y - slope * x;
    // Residuals beyond the weights widen the interval.
    let chi2 = sum(&|p| p.0 * (p.2 - level - slope * p.1).powi(2));
    let excess = match used.len() {
        2 => 1.0,
        n => (chi2 / (n - 2) as f64).max(1.0),
    };
    let se = (excess * (1.0 / all + x * x / sxx)).sqrt();
    let found = (level > FLOOR_Z * se && slope > -se).then_some(level);
    (found, (level + Z90 * se).max(0.0))
}

/// The line through ln E against ln n.
struct Line {
    x: f64,
    y: f64,
    y_var: f64,
    a: f64,
    a_var: f64,
}

impl Line {
    fn of(rungs: &[Rung], floor2: f64, fixed: bool) -> Option<Self> {
        let entry = |r: &Rung| {
            let rest = r.e2 - floor2;
            let sd = 0.5 * r.se / rest;
            (1.0 / (sd * sd + MODEL_ERROR.powi(2)), r.n.ln(), 0.5 * rest.ln())
        };
        let used: Vec<_> = rungs.iter().filter(|r| r.e2 > floor2).map(entry).collect();
        if used.is_empty() {
            return None;
        }
        let sum = |f: &dyn Fn(&(f64, f64, f64)) -> f64| used.iter().map(f).sum::<f64>();
        let all = sum(&|p| p.0);
        let (x, y) = (sum(&|p| p.0 * p.1) / all, sum(&|p| p.0 * p.2) / all);
        let sxx = sum(&|p| p.0 * (p.1 - x).powi(2));
        let prior = EXPONENT_SD.powi(-2);
        let (mut a, mut a_var) = match fixed {
            true => (EXPONENT, 0.0),
            false => {
                let sxy = sum(&|p| p.0 * (p.1 - x) * (p.2 - y));
                ((prior * EXPONENT - sxy) / (sxx + prior), 1.0 / (sxx + prior))
            }
        };
        a = a.clamp(EXPONENT_LIMITS[0], EXPONENT_LIMITS[1]);
        let chi2 = sum(&|p| p.0 * (p.2 - y + a * (p.1 - x)).powi(2));
        let excess = (chi2 / (used.len() as f64 - 1.0).max(1.0)).max(1.0);
        a_var *= excess;
        Some(Self {
            x,
            y,
            y_var: excess / all,
            a,
            a_var,
        })
    }
}

/// Standard deviation of ln E between runs with equal samples; 0 where no two runs can be compared.
fn scatter(rows: &[&Row]) -> f64 {
    let (mut squares, mut freedom) = (0.0, 0.0);
    let mut counts: Vec<u32> = rows.iter().map(|row| row.spp).collect();
    counts.sort_unstable();
    counts.dedup();
    for spp in counts {
        let logs: Vec<f64> = rows
            .iter()
            .filter(|row| row.spp == spp && row.e2 > 0.0)
            .map(|row| 0.5 * row.e2.ln())
            .collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        squares += logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>();
        freedom += (logs.len() as f64 - 1.0).max(0.0);
    }
    if freedom > 0.0 { (squares / freedom).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests;
