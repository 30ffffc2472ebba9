//! Whether two images differ by more than their noise, in square blocks of pixels.
//!
//! A pixel's own standard error comes from few independent estimates and is itself uncertain; over a block it is not.
//! The test holds for images whose pixels are independent: ours are (one pixel a sample), images made with filters
//! that spread samples over neighbours are not, and would be found different too often. Two images of the same seed
//! share their noise and are found different too rarely.

use super::Image;
use crate::math::stats::normal_quantile;
use rayon::prelude::*;

/// Independent estimates behind a standard error where the file does not say: the default of our renders.
const USUAL_NETS: u32 = 4;

/// The chance that a pair of images which differ by noise alone shows any differing block.
pub const FALSE_ALARM: f64 = 0.01;

/// Differences of this many units in the last place of an f32 are rounding, not light: two ways to the same sum.
const ROUNDING_STEPS: f64 = 4.0;

/// One block: its place, and how far apart the images are in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Per channel, the difference of the block's means over its standard error, as a standard normal score; positive
    /// where the first image is brighter. Infinite where images without noise differ. `None` if no pixel can be tested.
    pub z: Option<[f64; 3]>,
}

impl Block {
    /// The score that is farthest from 0.
    pub fn extreme(&self) -> Option<f64> {
        self.z.map(extreme)
    }
}

/// The component that is farthest from 0.
fn extreme(z: [f64; 3]) -> f64 {
    z.into_iter()
        .fold(0.0, |m, z| if z.abs() > f64::abs(m) { z } else { m })
}

/// What the test of all blocks finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseTest {
    /// Columns and rows of a block; those at the right and bottom border may have fewer.
    pub side: u32,
    /// Blocks that could be tested.
    pub blocks: u64,
    /// Blocks in which a channel's score is beyond the threshold.
    pub differing: u64,
    /// The threshold of |z|. With m = 3·blocks scores and Šidák's 1 − (1 − α)^(1/m) for each, no score passes it with
    /// probability 1 − α, α = [`FALSE_ALARM`], if the images differ by noise alone.
    pub threshold: f64,
    /// The block farthest from 0.
    pub worst: Block,
    /// Per channel, the score of the difference of the whole images: their relative bias.
    pub bias_z: [f64; 3],
    /// Pixels that could not be tested: not finite, or of unknown standard error.
    pub untested: u64,
    /// Which of the images has standard errors; one that has none is taken as exact.
    pub has_noise: [bool; 2],
}

impl NoiseTest {
    /// The share of differing blocks, in [0, 1].
    pub fn share(&self) -> f64 {
        self.differing as f64 / self.blocks as f64
    }

    /// The score of [`NoiseTest::bias_z`] that is farthest from 0.
    pub fn bias(&self) -> f64 {
        extreme(self.bias_z)
    }

    /// Tests two images of the same size. `None` if neither has standard errors, or none of them is known.
    pub fn of(a: &Image, b: &Image, side: u32) -> Option<NoiseTest> {
        if a.stderr.is_none() && b.stderr.is_none() {
            return None;
        }
        let sums = sums(a, b, side);
        let tested: Vec<Block> = blocks(a, &sums, side).into_iter().filter(|b| b.z.is_some()).collect();
        let distance = |b: &Block| b.extreme().unwrap_or(0.0).abs();
        let mut worst = *tested.first()?;
        for block in &tested {
            if distance(block) > distance(&worst) {
                worst = *block;
            }
        }
        let blocks = tested.len() as u64;
        let threshold = threshold(3 * blocks);
        let mut all = Sum::default();
        sums.iter().for_each(|s| all.add(s));
        Some(NoiseTest {
            side,
            blocks,
            differing: tested.iter().filter(|b| distance(b) > threshold).count() as u64,
            threshold,
            worst,
            bias_z: all.z()?,
            untested: a.rgb.len() as u64 - all.pixels,
            has_noise: [a.stderr.is_some(), b.stderr.is_some()],
        })
    }
}

/// The |z| that none of `scores` independent standard normal numbers passes with probability 1 − [`FALSE_ALARM`].
/// Source: Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", 1967;
/// it errs on the safe side where scores depend on each other, as channels do.
pub fn threshold(scores: u64) -> f64 {
    let each = -((-FALSE_ALARM).ln_1p() / scores.max(1) as f64).exp_m1();
    -normal_quantile(0.5 * each)
}

/// The scores of all blocks, row by row from the top left. Empty if the images differ in size.
pub fn scores(a: &Image, b: &Image, side: u32) -> Vec<Block> {
    blocks(a, &sums(a, b, side), side)
}

fn blocks(a: &Image, sums: &[Sum], side: u32) -> Vec<Block> {
    let columns = a.width.div_ceil(side.max(1)).max(1);
    let place = |(i, sum): (u32, &Sum)| Block {
        x: i % columns * side,
        y: i / columns * side,
        z: sum.z(),
    };
    (0..).zip(sums).map(place).collect()
}

/// The sums of each block.
fn sums(a: &Image, b: &Image, side: u32) -> Vec<Sum> {
    let (width, side) = (a.width as usize, side.max(1) as usize);
    if (a.width, a.height) != (b.width, b.height) || !a.is_complete() || !b.is_complete() || width == 0 {
        return Vec::new();
    }
    let [nets_a, nets_b] = [a, b].map(|i| f64::from(i.nets.unwrap_or(USUAL_NETS).max(2)));
    let variance = |image: &Image, i: usize| match &image.stderr {
        Some(stderr) => stderr[i].map(|s| f64::from(s).powi(2)),
        None => [0.0; 3],
    };
    let across = width.div_ceil(side);
    let down = (a.height as usize).div_ceil(side);
    let row = |v: usize| {
        let mut row = vec![Sum::default(); across];
        for y in v * side..((v + 1) * side).min(a.height as usize) {
            for x in 0..width {
                let i = y * width + x;
                row[x / side].pixel(
                    [a.rgb[i], b.rgb[i]],
                    [(variance(a, i), nets_a), (variance(b, i), nets_b)],
                );
            }
        }
        row
    };
    (0..down).into_par_iter().flat_map_iter(row).collect()
}

/// What adds up over the pixels of a block.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    pixels: u64,
    difference: [f64; 3],
    /// Variance of the difference.
    variance: [f64; 3],
    /// Variance of that variance's estimate, halved.
    spread: [f64; 3],
    rounding: [f64; 3],
}

impl Sum {
    /// Adds a pixel of both images: colours, and variances of the mean with the number of nets behind them.
    fn pixel(&mut self, color: [[f32; 3]; 2], noise: [([f64; 3], f64); 2]) {
        let known = color.iter().flatten().all(|c| c.is_finite())
            && noise.iter().flat_map(|(v, _)| v).all(|v| v.is_finite() && *v >= 0.0);
        if !known {
            return;
        }
        self.pixels += 1;
        for c in 0..3 {
            let [a, b] = color.map(|color| f64::from(color[c]));
            self.difference[c] += a - b;
            self.rounding[c] += ROUNDING_STEPS * f64::from(f32::EPSILON) * a.abs().max(b.abs());
            // Both images at once, so that swapping them changes no rounding.
            let [va, vb] = noise.map(|(variance, _)| variance[c]);
            self.variance[c] += va + vb;
            // With ν = nets − 1 degrees of freedom, v²/(ν + 2) estimates σ⁴/ν without bias.
            let [na, nb] = noise.map(|(_, nets)| nets);
            self.spread[c] += va * va / (na + 1.0) + vb * vb / (nb + 1.0);
        }
    }

    fn add(&mut self, other: &Sum) {
        self.pixels += other.pixels;
        for c in 0..3 {
            self.difference[c] += other.difference[c];
            self.variance[c] += other.variance[c];
            self.spread[c] += other.spread[c];
            self.rounding[c] += other.rounding[c];
        }
    }

    /// Standard normal scores per channel; `None` without pixels.
    fn z(&self) -> Option<[f64; 3]> {
        let score = |c: usize| {
            let difference = self.difference[c];
            if difference.abs() <= self.rounding[c] {
                return 0.0;
            }
            if self.variance[c] == 0.0 {
                return f64::INFINITY.copysign(difference);
            }
            let freedom = self.variance[c].powi(2) / self.spread[c]; // Welch and Satterthwaite
            normal_score(difference / self.variance[c].sqrt(), freedom)
        };
        (self.pixels > 0).then(|| [0, 1, 2].map(score))
    }
}

/// The standard normal score with the tail probability of Student's t with `freedom` degrees of freedom.
/// Source: Wallace, "Bounds on Normal Approximations to Student's and the Chi-Square Distributions", 1959.
fn normal_score(t: f64, freedom: f64) -> f64 {
    if freedom.is_infinite() {
        return t;
    }
    let z = (freedom * (t * t / freedom).ln_1p()).sqrt() * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    z.copysign(t)
}

#[cfg(test)]
mod tests;
