//! The error of the worst pixels, where a pixel's error is that of its neighbourhood: four nets say too little about
//! a single pixel.

use super::Bounded;
use crate::math::stats::normal_quantile;
use std::collections::BTreeMap;

/// Pixels to each side of the window: 7×7, cut off at the rectangle's edge.
const REACH: usize = 3;

/// How many pixels have which error and which bound: 64 bins an octave of the square.
#[derive(Clone, Debug, Default)]
pub struct Percentiles {
    values: BTreeMap<u32, u64>,
    bounds: BTreeMap<u32, u64>,
    pixels: u64,
}

impl Percentiles {
    /// Of the pixels of a rectangle; `terms` are the two cross-fitted squares of each.
    pub fn of(terms: &[[f64; 2]], width: usize, confidence: f64) -> Percentiles {
        let z = normal_quantile(confidence);
        let height = terms.len() / width;
        let mut found = Percentiles::default();
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut variance, mut n) = (0.0, 0.0, 0.0);
                for row in y.saturating_sub(REACH)..=(y + REACH).min(height - 1) {
                    let from = x.saturating_sub(REACH);
                    for [a, b] in &terms[row * width + from..=row * width + (x + REACH).min(width - 1)] {
                        sum += 0.5 * (a + b);
                        variance += 0.25 * (a - b) * (a - b);
                        n += 1.0;
                    }
                }
                *found.values.entry(bin(sum / n)).or_default() += 1;
                *found.bounds.entry(bin((sum + z * variance.sqrt()) / n)).or_default() += 1;
                found.pixels += 1;
            }
        }
        found
    }

    /// With the pixels of another rectangle.
    pub fn and(mut self, other: Percentiles) -> Percentiles {
        for (own, more) in [(&mut self.values, other.values), (&mut self.bounds, other.bounds)] {
            more.into_iter().for_each(|(bin, n)| *own.entry(bin).or_default() += n);
        }
        self.pixels += other.pixels;
        self
    }

    /// The error that this share of the pixels stays below, as the upper edge of its bin (at most 0.6 % too much).
    pub fn at(&self, share: f64) -> Bounded {
        let needed = (self.pixels as f64 * share).ceil() as u64;
        let find = |bins: &BTreeMap<u32, u64>| {
            let mut seen = 0;
            let found = bins.iter().find(|(_, n)| {
                seen += **n;
                seen >= needed
            });
            found.map_or(0.0, |(bin, _)| upper_edge(*bin).sqrt())
        };
        let value = find(&self.values);
        Bounded {
            value,
            bound: find(&self.bounds).max(value),
        }
    }
}

/// Exponent and six bits of the mantissa; bin 0 holds 0 alone.
fn bin(square: f64) -> u32 {
    if square == 0.0 {
        0
    } else {
        (square.to_bits() >> 46) as u32 + 1
    }
}

fn upper_edge(bin: u32) -> f64 {
    f64::from_bits(u64::from(bin) << 46)
}
