//! Whether two noisy images can be estimates of the same picture: a Z-test on block means with both variances,
//! corrected for the number of blocks (Šidák), and one on the whole image, which sees a small bias everywhere.

use super::estimate::Estimate;
use pts::math::stats::normal_quantile;

/// Outcome of [`compare`].
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Largest |z| of all blocks and channels.
    pub worst_z: f64,
    /// Its block's top left pixel and its channel.
    pub worst_at: ([usize; 2], usize),
    /// |z| that a block must not exceed.
    pub block_limit: f64,
    /// Largest |z| of the whole-image means over the channels.
    pub image_z: f64,
    /// |z| that the image means must not exceed.
    pub image_limit: f64,
}

impl Verdict {
    /// Whether the images agree.
    pub fn agree(&self) -> bool {
        self.worst_z <= self.block_limit && self.image_z <= self.image_limit
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([x, y], channel) = self.worst_at;
        write!(
            f,
            "worst block at ({x}, {y}) channel {channel}: |z| = {:.2}, limit {:.2}; whole image: |z| = {:.2}, limit {:.2}",
            self.worst_z, self.block_limit, self.image_z, self.image_limit
        )
    }
}

/// Compares in blocks of `size` pixels. `alpha` is the probability that equal pictures fail.
/// A block without variance must agree to 1e-4 (files may hold half floats).
pub fn compare(a: &Estimate, b: &Estimate, size: usize, alpha: f64) -> Verdict {
    assert_eq!([a.width, a.height], [b.width, b.height], "images differ in size");
    let corners: Vec<[usize; 2]> = (0..a.height)
        .step_by(size)
        .flat_map(|y| (0..a.width).step_by(size).map(move |x| [x, y]))
        .collect();
    // Half of the risk for the blocks, half for the image means.
    let limit = |tests: f64| {
        let each = 1.0 - (1.0 - alpha / 2.0).powf(1.0 / tests);
        normal_quantile(1.0 - each / 2.0)
    };
    let mut verdict = Verdict {
        worst_z: 0.0,
        worst_at: ([0, 0], 0),
        block_limit: limit(3.0 * corners.len() as f64),
        image_z: 0.0,
        image_limit: limit(3.0),
    };
    for channel in 0..3 {
        let (mut image_delta, mut image_var, mut image_level) = (0.0, 0.0, 0.0);
        for &[x0, y0] in &corners {
            let (mut delta, mut var, mut level) = (0.0, 0.0, 0.0);
            for y in y0..(y0 + size).min(a.height) {
                for x in x0..(x0 + size).min(a.width) {
                    let i = y * a.width + x;
                    delta += a.mean[i][channel] - b.mean[i][channel];
                    var += a.variance[i][channel] + b.variance[i][channel];
                    level += b.mean[i][channel].abs();
                }
            }
            let z = z_score(delta, var, level);
            if z > verdict.worst_z || z.is_nan() {
                verdict.worst_z = if z.is_nan() { f64::INFINITY } else { z };
                verdict.worst_at = ([x0, y0], channel);
            }
            image_delta += delta;
            image_var += var;
            image_level += level;
        }
        let z = z_score(image_delta, image_var, image_level);
        verdict.image_z = if z.is_nan() {
            f64::INFINITY
        } else {
            verdict.image_z.max(z)
        };
    }
    verdict
}

fn z_score(delta: f64, variance: f64, level: f64) -> f64 {
    if !(delta.is_finite() && variance.is_finite()) {
        return f64::NAN;
    }
    let excess = delta.abs() - 1e-4 * level;
    if excess <= 0.0 { 0.0 } else { excess / variance.sqrt() }
}
