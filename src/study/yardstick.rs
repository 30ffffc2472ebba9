//! A reference that knows its own noise, and the error of pictures measured with it.
//!
//! Against a reference m with noise, the squared difference of a picture x has the expectation of the true squared
//! error plus the reference's variance: E[(x − m)²] = (x − μ)² + σ_m². The standard errors of the reference estimate
//! that variance without bias, so that subtracting it leaves what the picture alone is to blame for. Its weights
//! 1/(Y² + ε) come from the same noisy reference, which is a second-order effect where it is much less noisy than
//! the pictures. Negative results are noise too and are kept: cutting them off would make means of several too large.

use super::Image;
use super::luminance;
use super::metrics::{CompareError, mean_flip};

/// Columns and rows of the blocks that the jackknife leaves out, in pixels. The noise of our pixels is independent from
/// pixel to pixel; their true errors are not, and this is about as far as that reaches in small pictures.
const BLOCK_SIDE: usize = 8;

/// Fewest blocks that tell a spread; in smaller pictures blocks are halved until there are so many.
const FEWEST_BLOCKS: usize = 16;

/// Fewest pixels whose noise must be known for the rest to be judged by them.
const KNOWN_SHARE: f64 = 0.5;

/// What pictures are measured against.
#[derive(Clone, Debug)]
pub struct Yardstick {
    image: Image,
    /// 1/(Y² + ε) of each pixel, in the unit of 1/radiance²; 0 where the pixel does not count.
    weights: Vec<f64>,
    /// Mean over channels of the reference's variance times the weight, of each pixel; 0 where it is not known.
    noise: Vec<f64>,
    knows_noise: bool,
    energy: f64,
}

/// How far a picture is from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// E², with the noise of the reference subtracted; may be negative.
    pub e2: f64,
    /// Its standard error, by jackknife over blocks of pixels.
    pub e2_se: f64,
    /// Mean FLIP, from 0 to 1, as `compare` gives it.
    pub flip: f64,
    /// Mean luminance over the reference's; 1 where both are black.
    pub energy: f64,
    /// Pixels with a component that is not finite; they are left out.
    pub non_finite: u64,
}

impl Yardstick {
    /// A reference. Its noise is taken from its standard errors; without them nothing is subtracted. Fails for an
    /// image without a finite pixel, or with buffers of the wrong length.
    pub fn new(image: Image) -> Result<Yardstick, CompareError> {
        if image.rgb.is_empty() || !image.is_complete() {
            return Err(CompareError::Incomplete([image.width, image.height]));
        }
        let counts: Vec<bool> = image.rgb.iter().map(|c| c.iter().all(|v| v.is_finite())).collect();
        let pixels = counts.iter().filter(|c| **c).count();
        if pixels == 0 {
            return Err(CompareError::NothingFinite);
        }
        let finite = || image.rgb.iter().zip(&counts).filter(|(_, counts)| **counts);
        let energy = finite().map(|(c, _)| luminance(*c)).sum::<f64>() / pixels as f64;
        let floor = 1e-2 * energy * energy;
        let weight = |(c, counts): (&[f32; 3], &bool)| {
            let square = luminance(*c).powi(2) + floor;
            // In a black reference every difference is infinitely large; it is counted in the unit of the image.
            if !counts {
                0.0
            } else {
                1.0 / if square > 0.0 { square } else { 1.0 }
            }
        };
        let weights: Vec<f64> = image.rgb.iter().zip(&counts).map(weight).collect();
        let variance = |i: usize| -> Option<f64> {
            let stderr = image.stderr.as_ref()?.get(i)?;
            let square = stderr.iter().map(|s| f64::from(*s).powi(2)).sum::<f64>() / 3.0;
            (square.is_finite() && counts[i]).then_some(square)
        };
        let known: Vec<Option<f64>> = (0..image.rgb.len()).map(variance).collect();
        let share = known.iter().flatten().count() as f64 / pixels as f64;
        let noise = known.iter().zip(&weights).map(|(v, w)| v.unwrap_or(0.0) * w);
        Ok(Yardstick {
            noise: noise.collect(),
            knows_noise: share >= KNOWN_SHARE && !image.is_developed,
            weights,
            energy,
            image,
        })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.image.width, self.image.height]
    }

    /// The error E of the reference itself, as its standard errors tell it; `None` if it has none.
    pub fn error(&self) -> Option<f64> {
        let pixels = self.weights.iter().filter(|w| **w > 0.0).count() as f64;
        let mean = self.noise.iter().sum::<f64>() / pixels;
        self.knows_noise.then(|| mean.sqrt())
    }

    /// Measures a picture of the same size, whose noise must be independent of the reference's (another seed).
    pub fn measure(&self, picture: &Image) -> Result<Measured, CompareError> {
        let flip = mean_flip(picture, &self.image)?;
        let [width, height] = self.size().map(|side| side as usize);
        let sides = std::iter::successors(Some(BLOCK_SIDE), |side| Some(side / 2)).take_while(|side| *side > 0);
        let count = |side: &usize| width.div_ceil(*side) * height.div_ceil(*side);
        let side = sides.into_iter().find(|side| count(side) >= FEWEST_BLOCKS).unwrap_or(1);
        let (across, down) = (width.div_ceil(side), height.div_ceil(side));
        let mut blocks = vec![[0.0f64; 2]; across * down];
        let (mut light, mut non_finite) = ([0.0; 2], 0);
        for (i, (x, m)) in picture.rgb.iter().zip(&self.image.rgb).enumerate() {
            if !x.iter().all(|v| v.is_finite()) {
                non_finite += 1;
                continue;
            }
            let weight = self.weights[i];
            if weight == 0.0 {
                continue;
            }
            let square: f64 = x
                .iter()
                .zip(m)
                .map(|(x, m)| (f64::from(*x) - f64::from(*m)).powi(2))
                .sum();
            let noise = if self.knows_noise { self.noise[i] } else { 0.0 };
            let block = &mut blocks[i / width / side * across + i % width / side];
            block[0] += square / 3.0 * weight - noise;
            block[1] += 1.0;
            light[0] += luminance(*x);
            light[1] += luminance(*m);
        }
        let (e2, e2_se) = jackknife(&blocks);
        Ok(Measured {
            e2,
            e2_se,
            flip,
            energy: if light[0] == light[1] { 1.0 } else { light[0] / light[1] },
            non_finite,
        })
    }

    /// Mean luminance of the reference.
    pub fn energy(&self) -> f64 {
        self.energy
    }
}

/// The ratio Σ sums / Σ counts of blocks `[sum, count]`, and its standard error by leaving out one block at a time.
/// With a single block the error is not known: infinite.
/// Source: Efron & Tibshirani, An Introduction to the Bootstrap, 1993, §11.5.
fn jackknife(blocks: &[[f64; 2]]) -> (f64, f64) {
    let blocks: Vec<&[f64; 2]> = blocks.iter().filter(|b| b[1] > 0.0).collect();
    let total = blocks.iter().fold([0.0; 2], |t, b| [t[0] + b[0], t[1] + b[1]]);
    let n = blocks.len() as f64;
    if blocks.len() < 2 {
        return (total[0] / total[1], f64::INFINITY);
    }
    let without: Vec<f64> = blocks.iter().map(|b| (total[0] - b[0]) / (total[1] - b[1])).collect();
    let mean = without.iter().sum::<f64>() / n;
    let spread: f64 = without.iter().map(|v| (v - mean).powi(2)).sum();
    (total[0] / total[1], ((n - 1.0) / n * spread).sqrt())
}

#[cfg(test)]
mod tests;
