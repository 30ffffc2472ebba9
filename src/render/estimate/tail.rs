//! Whether an error estimate can be trusted: who owns the error.

use super::terms::NetMeans;
use crate::math::color::luminance_f64;
use std::collections::BTreeMap;

/// How lonely a pixel's most different net is: 0 as for normally distributed nets on average, 1 if it alone differs;
/// negative where nets are more alike than that. 0 where all agree.
pub fn loneliness(means: &NetMeans) -> f64 {
    let n = means.len() as f64;
    let mean = means.iter().map(|m| luminance_f64(*m)).sum::<f64>() / n;
    let squares = means
        .iter()
        .map(|m| (luminance_f64(*m) - mean) * (luminance_f64(*m) - mean));
    let (most, all) = squares.fold((0.0f64, 0.0), |(m, s), d| (m.max(d), s + d));
    if all == 0.0 {
        return 0.0;
    }
    let alone = (n - 1.0) / n;
    match normal_share(means.len()) {
        Some(normal) => (most / all - normal) / (alone - normal),
        None => 0.0,
    }
}

/// Mean over normal samples of n of the share that the largest squared deviation from their mean has of all, from
/// 2·10⁶/n simulated samples (± 0.0003). Two nets say nothing.
fn normal_share(n: usize) -> Option<f64> {
    match n {
        4 => Some(0.5684),
        8 => Some(0.4223),
        16 => Some(0.2821),
        _ => None,
    }
}

/// Sums of terms by size: four bins an octave.
#[derive(Clone, Debug, Default)]
pub struct Sizes {
    bins: BTreeMap<u16, (f64, u64)>,
    pixels: u64,
}

impl Sizes {
    /// Adds the term of a pixel, ≥ 0.
    pub fn add(&mut self, term: f64) {
        self.pixels += 1;
        // The exponent and two bits of the mantissa: the order of positive floats is that of their bits.
        let bin = self.bins.entry((term.to_bits() >> 50) as u16).or_default();
        bin.0 += term;
        bin.1 += 1;
    }

    /// Adds the terms of other pixels.
    pub fn extend(&mut self, other: Sizes) {
        self.pixels += other.pixels;
        for (key, (sum, n)) in other.bins {
            let bin = self.bins.entry(key).or_default();
            bin.0 += sum;
            bin.1 += n;
        }
    }

    /// The sum of the largest terms, those of this share of the pixels, at least of one. A bin that is needed in part
    /// counts with its mean.
    pub fn of_the_largest(&self, share: f64) -> f64 {
        let mut left = (self.pixels as f64 * share).max(1.0);
        let mut total = 0.0;
        for (sum, n) in self.bins.values().rev() {
            let taken = left.min(*n as f64);
            total += sum * taken / *n as f64;
            left -= taken;
            if left <= 0.0 {
                break;
            }
        }
        total
    }
}
