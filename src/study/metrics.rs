//! All numbers that say how far an image is from a reference.

use super::blocks::NoiseTest;
use super::flip::{self, Exposures};
use super::{Image, luminance};
use crate::math::color::linear_from_srgb;
use crate::pictures::{Quantized, Transfer, quantize};
use glam::Vec3;

/// Columns and rows of the blocks of the noise test.
const BLOCK_SIDE: u32 = 8;

/// What can be chosen about a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Exposure in stops at which pictures are developed for PSNR and FLIP; nothing else depends on it.
    pub exposure_ev: f64,
    /// Columns and rows of the blocks of the noise test, at least 1.
    pub block_side: u32,
}

impl Default for Options {
    /// Exposure 0, blocks of 8×8.
    fn default() -> Options {
        Options {
            exposure_ev: 0.0,
            block_side: BLOCK_SIDE,
        }
    }
}

/// How far image A (x below) is from the reference B (m below). Means are over all pixels that are finite in both.
#[derive(Clone, Debug, PartialEq)]
pub struct Metrics {
    /// Pixels that are compared.
    pub pixels: u64,
    /// Pixels of A and of B with a component that is not finite; they are left out.
    pub non_finite: [u64; 2],
    /// E = sqrt(mean over pixels and channels of (x − m)² / (Y² + ε)), Y the luminance of the reference's pixel,
    /// ε = 10⁻²·(mean Y)². Does not depend on exposure. 0 where both are black, infinite where only the reference is.
    pub rel_rmse: f64,
    /// sqrt(mean of (x − m)²), in the unit of the image.
    pub rmse: f64,
    /// 10·log10(255² / mean of squared differences) of the developed pictures, in dB; infinite if they are equal.
    pub psnr_db: f64,
    /// Mean of [`flip::ldr`] of the developed pictures, in [0, 1].
    pub flip: f64,
    /// Mean of [`flip::hdr`], in [0, 1].
    pub hdr_flip: f64,
    /// The exposures behind `hdr_flip`; `None` if both images are black.
    pub exposures: Option<Exposures>,
    /// The largest difference of a channel.
    pub largest: Difference,
    /// Mean colours of A and of B.
    pub mean_rgb: [[f64; 3]; 2],
    /// Mean luminances of A and of B: their energies.
    pub energy: [f64; 2],
    /// Whether noise explains the difference, if an image brings its standard errors.
    pub noise: Option<NoiseTest>,
}

impl Metrics {
    /// relMSE = E².
    pub fn rel_mse(&self) -> f64 {
        self.rel_rmse * self.rel_rmse
    }

    /// Energy of A over energy of B; 1 if both are 0.
    pub fn energy_ratio(&self) -> f64 {
        let [a, b] = self.energy;
        if a == b { 1.0 } else { a / b }
    }
}

/// One pixel in both images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// The largest |x − m| of its channels.
    pub value: f64,
    /// The pixel in A and in B.
    pub colors: [[f32; 3]; 2],
}

/// Why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// They differ in size.
    #[error("the images differ in size: {}x{} and {}x{} pixels", .a[0], .a[1], .b[0], .b[1])]
    Size {
        /// Columns and rows of A.
        a: [u32; 2],
        /// Columns and rows of B.
        b: [u32; 2],
    },
    /// A buffer does not hold one value for each pixel, or there are no pixels.
    #[error("an image of {}x{} pixels does not hold that many values", .0[0], .0[1])]
    Incomplete([u32; 2]),
    /// Nothing is left to compare.
    #[error("no pixel is finite in both images")]
    NothingFinite,
}

/// Compares image `a` with the reference `b`, with the usual [`Options`].
pub fn compare(a: &Image, b: &Image) -> Result<Metrics, CompareError> {
    compare_with(a, b, &Options::default())
}

/// Compares image `a` with the reference `b`. RMSE, PSNR, FLIP, the largest difference and the noise test are the same
/// (but for signs) with the images swapped; E and HDR-FLIP take their scale from the reference.
pub fn compare_with(a: &Image, b: &Image, options: &Options) -> Result<Metrics, CompareError> {
    let pair = Pair::new(a, b)?;
    let n = pair.pixels() as f64;
    let mean = |image: &[Vec3]| {
        let sum = pair
            .finite_of(image)
            .fold([0.0; 3], |s, c| [0, 1, 2].map(|i| s[i] + f64::from(c[i])));
        sum.map(|s| s / n)
    };
    let floor = pair.floor();
    let (mut squares, mut relative, mut largest) = (0.0, 0.0, Difference::default());
    for (i, (x, m)) in pair.a.iter().zip(&pair.b).enumerate().filter(|(i, _)| pair.finite[*i]) {
        let d = [0, 1, 2].map(|c| f64::from(x[c]) - f64::from(m[c]));
        let square: f64 = d.iter().map(|d| d * d).sum();
        squares += square;
        relative += relative_square(square, *m, floor);
        let value = d.iter().fold(0.0, |v: f64, d| v.max(d.abs()));
        // The first pixel also stands for images without difference.
        if value > largest.value || i == 0 {
            largest = Difference {
                x: i as u32 % a.width,
                y: i as u32 / a.width,
                value,
                colors: [x.to_array(), m.to_array()],
            };
        }
    }
    let developed = [&pair.a, &pair.b].map(|image| pair.develop(image, options.exposure_ev));
    let [shown_a, shown_b] = developed.each_ref().map(linear);
    let exposures = pair.exposures();
    let mean_of = |map: &[f32]| {
        let finite = map.iter().zip(&pair.finite).filter(|(_, finite)| **finite);
        finite.map(|(e, _)| f64::from(*e)).sum::<f64>() / n
    };
    Ok(Metrics {
        pixels: pair.pixels(),
        non_finite: [a, b].map(|i| i.rgb.iter().filter(|c| !is_finite(c)).count() as u64),
        rel_rmse: (relative / (3.0 * n)).sqrt(),
        rmse: (squares / (3.0 * n)).sqrt(),
        psnr_db: psnr(&developed, &pair.finite),
        flip: mean_of(&flip::ldr(&shown_a, &shown_b, a.width as usize)),
        hdr_flip: exposures.map_or(0.0, |e| mean_of(&flip::hdr(&pair.a, &pair.b, a.width as usize, e))),
        exposures,
        largest,
        mean_rgb: [mean(&pair.a), mean(&pair.b)],
        energy: [&pair.a, &pair.b].map(|image| pair.mean_luminance(image)),
        noise: NoiseTest::of(a, b, options.block_side),
    })
}

/// [`Metrics::flip`] alone, at exposure 0.
pub fn mean_flip(a: &Image, b: &Image) -> Result<f64, CompareError> {
    let pair = Pair::new(a, b)?;
    let [shown_a, shown_b] = [&pair.a, &pair.b].map(|image| linear(&pair.develop(image, 0.0)));
    let map = flip::ldr(&shown_a, &shown_b, a.width as usize);
    let finite = map.iter().zip(&pair.finite).filter(|(_, finite)| **finite);
    Ok(finite.map(|(e, _)| f64::from(*e)).sum::<f64>() / pair.pixels() as f64)
}

/// Σ over channels of (x − m)² / (Y² + ε), of which `square` is the numerator; 0/0, black in a black image, is 0.
pub(super) fn relative_square(square: f64, m: Vec3, floor: f64) -> f64 {
    if square == 0.0 {
        return 0.0;
    }
    square / (luminance(m.to_array()).powi(2) + floor)
}

fn is_finite(color: &[f32; 3]) -> bool {
    color.iter().all(|c| c.is_finite())
}

/// Two images of the same size, black wherever one of them is not finite, so that filters see no difference there.
pub(super) struct Pair {
    pub(super) a: Vec<Vec3>,
    pub(super) b: Vec<Vec3>,
    /// Whether the pixel is finite in both.
    pub(super) finite: Vec<bool>,
    size: [u32; 2],
}

impl Pair {
    pub(super) fn new(a: &Image, b: &Image) -> Result<Pair, CompareError> {
        let [size, other] = [a, b].map(|i| [i.width, i.height]);
        if size != other {
            return Err(CompareError::Size { a: size, b: other });
        }
        if !a.is_complete() || !b.is_complete() {
            return Err(CompareError::Incomplete(size));
        }
        let finite: Vec<bool> = a
            .rgb
            .iter()
            .zip(&b.rgb)
            .map(|(a, b)| is_finite(a) && is_finite(b))
            .collect();
        if !finite.contains(&true) {
            return Err(CompareError::NothingFinite);
        }
        let clean = |image: &Image| -> Vec<Vec3> {
            let pixels = image.rgb.iter().zip(&finite);
            pixels
                .map(|(c, finite)| if *finite { Vec3::from_array(*c) } else { Vec3::ZERO })
                .collect()
        };
        Ok(Pair {
            a: clean(a),
            b: clean(b),
            finite,
            size,
        })
    }

    fn pixels(&self) -> u64 {
        self.finite.iter().filter(|f| **f).count() as u64
    }

    fn finite_of<'a>(&'a self, image: &'a [Vec3]) -> impl Iterator<Item = &'a Vec3> {
        image.iter().zip(&self.finite).filter(|(_, f)| **f).map(|(c, _)| c)
    }

    fn mean_luminance(&self, image: &[Vec3]) -> f64 {
        self.finite_of(image).map(|c| luminance(c.to_array())).sum::<f64>() / self.pixels() as f64
    }

    /// ε of E.
    pub(super) fn floor(&self) -> f64 {
        1e-2 * self.mean_luminance(&self.b).powi(2)
    }

    /// The exposures of the reference, or of the other image if the reference is black.
    pub(super) fn exposures(&self) -> Option<Exposures> {
        let finite = |image| self.finite_of(image).copied().collect::<Vec<_>>();
        Exposures::of(&finite(&self.b)).or_else(|| Exposures::of(&finite(&self.a)))
    }

    /// The picture as 8-bit files hold it: cut to [0, 1], sRGB, without a tone curve, not dithered.
    pub(super) fn develop(&self, image: &[Vec3], exposure_ev: f64) -> Quantized {
        let gain = exposure_ev.exp2() as f32;
        let shown: Vec<[f32; 3]> = image.iter().map(|c| (*c * gain).to_array()).collect();
        quantize(self.size, &shown, None, Transfer::Srgb, false)
    }
}

/// The light that a developed picture sends out.
pub(super) fn linear(developed: &Quantized) -> Vec<Vec3> {
    let table: Vec<f32> = (0..=255)
        .map(|code| linear_from_srgb(f64::from(code) / 255.0) as f32)
        .collect();
    let light = |p: &[u8; 3]| Vec3::from_array(p.map(|code| table[usize::from(code)]));
    developed.bytes.as_chunks().0.iter().map(light).collect()
}

fn psnr(developed: &[Quantized; 2], finite: &[bool]) -> f64 {
    let [a, b] = developed.each_ref().map(|q| q.bytes.chunks_exact(3));
    let (mut squares, mut values) = (0.0, 0.0);
    for ((a, b), _) in a.zip(b).zip(finite).filter(|(_, finite)| **finite) {
        let square = |(a, b): (&u8, &u8)| f64::from(a.abs_diff(*b)).powi(2);
        squares += a.iter().zip(b).map(square).sum::<f64>();
        values += 3.0;
    }
    10.0 * (255.0 * 255.0 * values / squares).log10() // no difference: log10(∞)
}

#[cfg(test)]
mod tests;
