//! How far the picture is from the truth, seen from the spread between its independent nets.
//!
//! E² is the mean over pixels and channels of variance/(luminance² + ε), ε = 10⁻²·(mean luminance)². Variance
//! and weights come from different halves of the nets (cross-fitted): a firefly would otherwise raise its own
//! denominator and hide. The bound adds the spread of the estimate over blocks of pixels and the
//! uncertainty of variances that were taken from few nets.

use super::report::ErrorEstimate;
use crate::math::color::luminance;
use crate::math::stats::normal_quantile;
use glam::Vec3;

/// Net means of one pixel: `means[r]` of net r, per channel.
pub type NetMeans = [[f64; 3]];

/// Standard error of the mean of the nets, per channel; NaN for one net.
pub fn standard_error(means: &NetMeans) -> [f32; 3] {
    let n = means.len() as f64;
    std::array::from_fn(|c| {
        let mean = means.iter().map(|m| m[c]).sum::<f64>() / n;
        let squares = means.iter().map(|m| (m[c] - mean) * (m[c] - mean)).sum::<f64>();
        (squares / (n * (n - 1.0))).sqrt() as f32
    })
}

/// Accumulates the error estimate over the pixels of an image. Each pixel belongs to one block.
#[derive(Clone, Debug)]
pub struct ErrorSums {
    epsilon: f64,
    blocks: Vec<(f64, f64)>,
    /// Sum of squares of the pixels' terms, for the uncertainty of their variances.
    squares: f64,
}

impl ErrorSums {
    /// For an image of this mean luminance, cut into `blocks` blocks.
    pub fn new(mean_luminance: f64, blocks: usize) -> ErrorSums {
        ErrorSums {
            epsilon: 1e-2 * mean_luminance * mean_luminance,
            blocks: vec![(0.0, 0.0); blocks],
            squares: 0.0,
        }
    }

    /// Adds a pixel with at least two nets.
    pub fn add(&mut self, block: usize, means: &NetMeans) {
        let half = means.len() / 2;
        let (a, b) = means.split_at(half);
        let term = 0.5 * (self.term(a, b, means.len()) + self.term(b, a, means.len()));
        self.blocks[block].0 += term;
        self.blocks[block].1 += 1.0;
        self.squares += term * term;
    }

    /// Variance of the image's pixel from `variance_of`, weighted by the luminance of `weight_of`, mean over channels.
    fn term(&self, variance_of: &NetMeans, weight_of: &NetMeans, nets: usize) -> f64 {
        let average = |m: &NetMeans, c: usize| m.iter().map(|m| m[c]).sum::<f64>() / m.len() as f64;
        let n = variance_of.len() as f64;
        // With a single net on this side (two in all) the two sides' difference is all there is.
        let spread = (0..3).map(|c| {
            if variance_of.len() < 2 {
                let d = average(variance_of, c) - average(weight_of, c);
                return d * d / 2.0;
            }
            let mean = average(variance_of, c);
            variance_of.iter().map(|m| (m[c] - mean) * (m[c] - mean)).sum::<f64>() / (n - 1.0)
        });
        let variance = spread.sum::<f64>() / (3.0 * nets as f64);
        let rgb = Vec3::from_array(std::array::from_fn(|c| average(weight_of, c) as f32));
        let lum = f64::from(luminance(rgb));
        let denominator = lum * lum + self.epsilon;
        if variance == 0.0 { 0.0 } else { variance / denominator }
    }

    /// E and its upper bound at this confidence (in (0, 1)).
    pub fn estimate(&self, confidence: f64) -> ErrorEstimate {
        let pixels: f64 = self.blocks.iter().map(|b| b.1).sum();
        if pixels == 0.0 {
            return ErrorEstimate { error: 0.0, bound: 0.0 };
        }
        let e2 = self.blocks.iter().map(|b| b.0).sum::<f64>() / pixels;
        let used = self.blocks.iter().filter(|b| b.1 > 0.0);
        let n = used.clone().count() as f64;
        // Delete-one-block jackknife of the mean.
        let all = self.blocks.iter().map(|b| b.0).sum::<f64>();
        let spread = used.map(|b| {
            let without = if pixels > b.1 { (all - b.0) / (pixels - b.1) } else { e2 };
            (without - e2) * (without - e2)
        });
        let jackknife = spread.sum::<f64>() * (n - 1.0) / n;
        let fluctuation = 2.0 * self.squares / (pixels * pixels);
        let bound = e2 + normal_quantile(confidence) * (jackknife + fluctuation).sqrt();
        ErrorEstimate {
            error: e2.sqrt(),
            bound: bound.max(e2).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::Pcg;

    fn noise(rng: &mut Pcg) -> f64 {
        (0..12).map(|_| rng.next_f64()).sum::<f64>() - 6.0
    }

    /// Oracle: pixels of mean 2 with net noise σ have E² = σ²/R / (4 + 0.04).
    #[test]
    fn the_estimate_is_right_for_known_noise() {
        let mut rng = Pcg::new(5);
        let (sigma, nets) = (0.4, 4);
        let mut sums = ErrorSums::new(2.0, 64);
        for pixel in 0..64 * 64 {
            let means: Vec<[f64; 3]> = (0..nets)
                .map(|_| std::array::from_fn(|_| 2.0 + sigma * noise(&mut rng)))
                .collect();
            sums.add(pixel % 64, &means);
        }
        let found = sums.estimate(0.9);
        let want = (sigma * sigma / nets as f64 / 4.04).sqrt();
        assert!(
            (found.error / want - 1.0).abs() < 0.03,
            "{} instead of {want}",
            found.error
        );
        assert!(
            found.bound > found.error && found.bound < want * 1.06,
            "bound {}",
            found.bound
        );
    }

    #[test]
    fn a_black_image_has_no_error() {
        let mut sums = ErrorSums::new(0.0, 1);
        sums.add(0, &[[0.0; 3]; 4]);
        assert_eq!(sums.estimate(0.9), ErrorEstimate { error: 0.0, bound: 0.0 });
    }

    #[test]
    fn the_standard_error_of_one_net_is_unknown() {
        assert!(standard_error(&[[1.0; 3]])[0].is_nan());
        assert_eq!(standard_error(&[[1.0; 3], [3.0; 3]]), [1.0; 3]);
    }
}
