//! Whether two images differ by more than their noise, in square blocks of pixels.
//!
//! A pixel's own standard error comes from few independent estimates and is itself uncertain; over a block it is not.
//! The test holds for images whose pixels are independent: ours are (one pixel a sample), images made with filters
//! that spread samples over neighbours are not, and would be found different too often. Two images of the same seed
//! share their noise and are found different too rarely.
//!
//! Light comes in rare bright samples, so that an image of few samples errs in mean and in standard error together:
//! where it is too dark it also believes itself too good. Where the other image has more samples, its variance says
//! better how good so few can be; the larger of the two counts. An image with noise that is compared with an exact
//! one has no such help and is found different a little too often.

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

    /// Tests two images of the same size. `None` if neither has standard errors, none of them is known, or an image
    /// is developed: rounding and cutting are no noise.
    pub fn of(a: &Image, b: &Image, side: u32) -> Option<NoiseTest> {
        if (a.stderr.is_none() && b.stderr.is_none()) || a.is_developed || b.is_developed {
            return None;
        }
        let side = side.max(1);
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
    let side = side.max(1);
    blocks(a, &sums(a, b, side), side)
}

fn blocks(a: &Image, sums: &[Sum], side: u32) -> Vec<Block> {
    let columns = a.width.div_ceil(side).max(1);
    let place = |(i, sum): (u32, &Sum)| Block {
        x: i % columns * side,
        y: i / columns * side,
        z: sum.z(),
    };
    (0..).zip(sums).map(place).collect()
}

/// The sums of each block; `side` is at least 1.
fn sums(a: &Image, b: &Image, side: u32) -> Vec<Sum> {
    let width = a.width as usize;
    if (a.width, a.height) != (b.width, b.height) || !a.is_complete() || !b.is_complete() || width == 0 {
        return Vec::new();
    }
    let side = side as usize;
    let across = width.div_ceil(side);
    let down = (a.height as usize).div_ceil(side);
    let row = |v: usize| {
        let mut row = vec![Sum::default(); across];
        for y in v * side..((v + 1) * side).min(a.height as usize) {
            for x in 0..width {
                let i = y * width + x;
                row[x / side].pixel([a.rgb[i], b.rgb[i]], [Noise::of(a, i), Noise::of(b, i)]);
            }
        }
        row
    };
    (0..down).into_par_iter().flat_map_iter(row).collect()
}

/// What is known of the noise of one pixel in one image.
#[derive(Clone, Copy, Debug)]
struct Noise {
    /// Variance of the mean, per channel.
    variance: [f64; 3],
    /// Independent estimates behind it.
    nets: f64,
    samples: Option<u32>,
}

impl Noise {
    fn of(image: &Image, i: usize) -> Noise {
        Noise {
            variance: match &image.stderr {
                Some(stderr) => stderr[i].map(|s| f64::from(s).powi(2)),
                None => [0.0; 3],
            },
            nets: f64::from(image.nets.unwrap_or(USUAL_NETS).max(2)),
            samples: image.samples.as_ref().filter(|_| image.stderr.is_some()).map(|s| s[i]),
        }
    }

    /// What the noise would be with the samples of `self`, as `other` shows it; if that has no more, what it is.
    fn judged_by(&self, other: &Noise) -> Noise {
        match (self.samples, other.samples) {
            (Some(own), Some(more)) if 0 < own && own < more => Noise {
                variance: other.variance.map(|v| v * f64::from(more) / f64::from(own)),
                ..*other
            },
            _ => *self,
        }
    }
}

/// A variance summed over pixels, and how well it is known.
#[derive(Clone, Copy, Debug, Default)]
struct Variance {
    sum: f64,
    /// Half the variance of the sum's estimate.
    spread: f64,
}

impl Variance {
    fn add(&mut self, noise: &Noise, c: usize) {
        let v = noise.variance[c];
        self.sum += v;
        // With ν = nets − 1 degrees of freedom, v²/(ν + 2) estimates σ⁴/ν without bias.
        self.spread += v * v / (noise.nets + 1.0);
    }

    fn merge(&mut self, other: &Variance) {
        self.sum += other.sum;
        self.spread += other.spread;
    }

    fn larger(self, other: Variance) -> Variance {
        if other.sum > self.sum { other } else { self }
    }
}

/// What adds up over the pixels of a block.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    pixels: u64,
    channels: [Channel; 3],
}

#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    difference: f64,
    rounding: f64,
    /// Of each image, as it shows it itself.
    own: [Variance; 2],
    /// Of each image, as the other shows it.
    judged: [Variance; 2],
}

impl Sum {
    /// Adds a pixel of both images.
    fn pixel(&mut self, color: [[f32; 3]; 2], noise: [Noise; 2]) {
        let is_known = |v: &f64| v.is_finite() && *v >= 0.0;
        if !color.iter().flatten().all(|c| c.is_finite()) || !noise.iter().flat_map(|n| &n.variance).all(is_known) {
            return;
        }
        self.pixels += 1;
        let [na, nb] = &noise;
        let judged = [na.judged_by(nb), nb.judged_by(na)];
        for (c, channel) in self.channels.iter_mut().enumerate() {
            let [a, b] = color.map(|color| f64::from(color[c]));
            channel.difference += a - b;
            channel.rounding += ROUNDING_STEPS * f64::from(f32::EPSILON) * a.abs().max(b.abs());
            for i in 0..2 {
                channel.own[i].add(&noise[i], c);
                channel.judged[i].add(&judged[i], c);
            }
        }
    }

    fn add(&mut self, other: &Sum) {
        self.pixels += other.pixels;
        for (channel, other) in self.channels.iter_mut().zip(&other.channels) {
            channel.difference += other.difference;
            channel.rounding += other.rounding;
            for i in 0..2 {
                channel.own[i].merge(&other.own[i]);
                channel.judged[i].merge(&other.judged[i]);
            }
        }
    }

    /// Standard normal scores per channel; `None` without pixels.
    fn z(&self) -> Option<[f64; 3]> {
        (self.pixels > 0).then(|| self.channels.each_ref().map(Channel::z))
    }
}

impl Channel {
    fn z(&self) -> f64 {
        if self.difference.abs() <= self.rounding {
            return 0.0;
        }
        let [a, b] = [0, 1].map(|i| self.own[i].larger(self.judged[i]));
        let variance = a.sum + b.sum;
        if variance == 0.0 {
            return f64::INFINITY.copysign(self.difference);
        }
        let freedom = variance * variance / (a.spread + b.spread); // Welch and Satterthwaite
        normal_score(self.difference / variance.sqrt(), freedom)
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
