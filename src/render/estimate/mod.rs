//! How far the picture is from the truth, seen from the spread between its independent nets.
//!
//! E² is the mean over pixels and channels of variance/(luminance² + ε), ε = 10⁻²·(mean luminance)². Variance and
//! weight come from different halves of the nets, once each way (cross-fitted): a firefly would otherwise raise its
//! own denominator and hide. `docs/accuracy.md` explains the recipe in words and shows how well it keeps its promise.

mod pooled;
mod tail;
mod terms;

use super::settings::DisplayCurve;
use crate::math::stats::normal_quantile;
use pooled::Percentiles;
use std::iter::Sum;
use std::ops::Add;
use tail::Sizes;
pub use terms::{NetMeans, Sheet, standard_error};

/// What is estimated besides E.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted<'a> {
    /// The 99th percentile of the pixels' errors.
    pub worst: bool,
    /// The error of the developed picture.
    pub display: Option<&'a DisplayCurve>,
}

/// A figure and its upper bound at the asked confidence.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Bounded {
    /// The estimate.
    pub value: f64,
    /// Its bound, never below it.
    pub bound: f64,
}

/// The estimated error of an image.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ErrorEstimate {
    /// E, the relative root mean square error (fraction).
    pub error: f64,
    /// Its upper bound at the asked confidence.
    pub bound: f64,
    /// How far the nets are from agreeing as the sums of many small contributions do, weighted by error: 0 where
    /// they spread like a normal distribution, 1 where one of them alone makes each pixel's spread.
    pub lonely: f64,
    /// Share of E² that a thousandth of the pixels (at least one) owns.
    pub top: f64,
    /// The 99th percentile over pixels of the relative error, pooled over each pixel's neighbours.
    pub worst: Option<Bounded>,
    /// Root mean square error of the developed picture in 8-bit steps.
    pub display: Option<Bounded>,
}

/// Above this [`ErrorEstimate::lonely`] the spread of the nets is made by single finds. On the calibration scenes
/// estimates are then 1.2 to 3 times too high; what no sample has found cannot be known at all.
const LONELY: f64 = 0.8;

impl ErrorEstimate {
    /// Whether the figures deserve little trust: the picture lives on rare finds.
    pub fn is_doubtful(&self) -> bool {
        self.lonely > LONELY
    }
}

/// Sums over pixels from which the estimate follows. Sums of tiles are added in a fixed order.
#[derive(Clone, Debug, Default)]
pub struct ErrorSums {
    relative: Moments,
    lonely: f64,
    sizes: Sizes,
    worst: Option<Percentiles>,
    display: Option<Moments>,
}

/// Sums over pixels of their terms, and of what is unknown about them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    pixels: f64,
    sum: f64,
    /// Variance of `sum` against the sum of the squared errors that these pixels really have.
    variance: f64,
}

impl Moments {
    /// A pixel with the terms of its two halves, a and b. (a − b)²/4 is an unbiased estimate of the variance of
    /// their mean; ab of the square of what both estimate, and the squared error of a pixel (three channels that
    /// move together, normal) has twice that as its variance.
    fn take(&mut self, [a, b]: [f64; 2]) {
        self.pixels += 1.0;
        self.sum += 0.5 * (a + b);
        self.variance += 0.25 * (a - b) * (a - b) + 2.0 * a * b;
    }

    /// Root of the mean, and its one-sided bound.
    fn root(&self, confidence: f64) -> Bounded {
        if self.pixels == 0.0 {
            return Bounded::default();
        }
        let mean = self.sum / self.pixels;
        let bound = mean + normal_quantile(confidence) * self.variance.sqrt() / self.pixels;
        Bounded {
            value: mean.sqrt(),
            bound: bound.max(mean).sqrt(),
        }
    }
}

impl Add for Moments {
    type Output = Moments;

    fn add(self, other: Moments) -> Moments {
        Moments {
            pixels: self.pixels + other.pixels,
            sum: self.sum + other.sum,
            variance: self.variance + other.variance,
        }
    }
}

impl ErrorSums {
    /// Of a rectangle of pixels of an image of this mean luminance.
    pub fn of(sheet: &Sheet, mean_luminance: f64, wanted: Wanted, confidence: f64) -> ErrorSums {
        let mut sums = ErrorSums::default();
        let terms = sheet.relative_terms(1e-2 * mean_luminance * mean_luminance);
        for (pixel, pair) in terms.iter().enumerate() {
            let term = 0.5 * (pair[0] + pair[1]);
            sums.relative.take(*pair);
            sums.lonely += term * tail::loneliness(sheet.pixel(pixel));
            sums.sizes.add(term);
        }
        sums.worst = wanted.worst.then(|| Percentiles::of(&terms, sheet.width(), confidence));
        sums.display = wanted.display.map(|curve| {
            let mut moments = Moments::default();
            sheet
                .display_terms(curve)
                .into_iter()
                .for_each(|pair| moments.take(pair));
            moments
        });
        sums
    }

    /// E² summed over the pixels.
    pub fn total(&self) -> f64 {
        self.relative.sum
    }

    /// The figures, bounded at this confidence (in (0, 1)).
    pub fn estimate(&self, confidence: f64) -> ErrorEstimate {
        let Bounded { value, bound } = self.relative.root(confidence);
        let share = |part: f64| {
            if self.relative.sum > 0.0 {
                part / self.relative.sum
            } else {
                0.0
            }
        };
        ErrorEstimate {
            error: value,
            bound,
            lonely: share(self.lonely),
            top: share(self.sizes.of_the_largest(1e-3)),
            worst: self.worst.as_ref().map(|p| p.at(0.99)),
            display: self.display.map(|m| m.root(confidence)),
        }
    }
}

impl Sum for ErrorSums {
    fn sum<I: Iterator<Item = ErrorSums>>(iter: I) -> ErrorSums {
        iter.reduce(|mut a, b| {
            a.relative = a.relative + b.relative;
            a.lonely += b.lonely;
            a.sizes.extend(b.sizes);
            a.worst = a.worst.zip(b.worst).map(|(a, b)| a.and(b));
            a.display = a.display.zip(b.display).map(|(a, b)| a + b);
            a
        })
        .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
