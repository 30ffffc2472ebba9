//! From sums to pictures and error estimates, the same for a render and for parts that were brought together.

use super::estimate::{ErrorSums, standard_error};
use super::report::{ErrorEstimate, Picture};
use super::settings::Aovs;
use crate::math::color::luminance;
use crate::math::robust::try_normalize;
use glam::Vec3;
use rayon::prelude::*;

/// Fewer samples than this give no standard error.
const LEAST_SAMPLES: u32 = 16;

/// Offsets of the extra layers among the channels of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channels {
    /// Sum of depths, then the number of samples that hit something.
    pub depth: Option<usize>,
    /// Three numbers.
    pub normal: Option<usize>,
    /// Three numbers.
    pub albedo: Option<usize>,
    /// All channels; the colour comes first.
    pub count: usize,
}

impl Channels {
    /// For these layers.
    pub fn new(aovs: Aovs) -> Channels {
        let mut count = 3;
        let mut take = |wanted: bool, n: usize| {
            let at = wanted.then_some(count);
            count += if wanted { n } else { 0 };
            at
        };
        let (depth, normal, albedo) = (take(aovs.depth, 2), take(aovs.normal, 3), take(aovs.albedo, 3));
        Channels {
            depth,
            normal,
            albedo,
            count,
        }
    }
}

/// The sums of one pixel's nets.
#[derive(Clone, Debug)]
pub struct NetSums {
    channels: usize,
    sums: Vec<f64>,
    points: Vec<u32>,
    means: Vec<[f64; 3]>,
}

impl NetSums {
    /// Of no samples.
    pub fn new(nets: u32, channels: usize) -> NetSums {
        NetSums {
            channels,
            sums: vec![0.0; nets as usize * channels],
            points: vec![0; nets as usize],
            means: vec![[0.0; 3]; nets as usize],
        }
    }

    /// How many nets there are.
    pub fn nets(&self) -> u32 {
        self.points.len() as u32
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.sums.fill(0.0);
        self.points.fill(0);
    }

    /// The sum of a net and its number of points.
    pub fn net_mut(&mut self, net: u32) -> (&mut [f64], &mut u32) {
        let sum = &mut self.sums[net as usize * self.channels..][..self.channels];
        (sum, &mut self.points[net as usize])
    }

    /// Samples of all nets.
    pub fn samples(&self) -> u32 {
        self.points.iter().sum()
    }

    /// The sum of a channel over all nets.
    fn total(&self, channel: usize) -> f64 {
        self.sums
            .chunks_exact(self.channels)
            .fold(0.0, |t, net| t + net[channel])
    }

    /// The mean of three channels from `at` on; black without samples.
    fn mean(&self, at: usize) -> [f32; 3] {
        let n = f64::from(self.samples());
        std::array::from_fn(|c| if n > 0.0 { (self.total(at + c) / n) as f32 } else { 0.0 })
    }

    /// Colour means of each net.
    fn net_means(&mut self) -> &[[f64; 3]] {
        let sums = self.sums.chunks_exact(self.channels).zip(&self.points);
        for (mean, (sum, points)) in self.means.iter_mut().zip(sums) {
            *mean = std::array::from_fn(|c| sum[c] / f64::from(*points));
        }
        &self.means
    }
}

impl Picture {
    /// A black picture without samples.
    pub fn black(width: u32, height: u32, channels: &Channels) -> Picture {
        let n = width as usize * height as usize;
        Picture {
            width,
            height,
            rgb: vec![[0.0; 3]; n],
            stderr: vec![[f32::NAN; 3]; n],
            samples: vec![0; n],
            depth: channels.depth.map(|_| vec![f32::INFINITY; n]),
            normal: channels.normal.map(|_| vec![[0.0; 3]; n]),
            albedo: channels.albedo.map(|_| vec![[0.0; 3]; n]),
        }
    }

    /// Sets a pixel.
    pub fn put(&mut self, x: u32, y: u32, sums: &mut NetSums, channels: &Channels) {
        let at = y as usize * self.width as usize + x as usize;
        let samples = sums.samples();
        self.rgb[at] = sums.mean(0);
        self.samples[at] = samples;
        if samples >= LEAST_SAMPLES {
            self.stderr[at] = standard_error(sums.net_means());
        }
        if let (Some(layer), Some(c)) = (&mut self.depth, channels.depth) {
            let [sum, hits] = [sums.total(c) as f32, sums.total(c + 1) as f32];
            layer[at] = if hits > 0.0 { sum / hits } else { f32::INFINITY };
        }
        if let (Some(layer), Some(c)) = (&mut self.normal, channels.normal) {
            let n = Vec3::from_array(sums.mean(c));
            layer[at] = try_normalize(n).unwrap_or(Vec3::ZERO).to_array();
        }
        if let (Some(layer), Some(c)) = (&mut self.albedo, channels.albedo) {
            layer[at] = sums.mean(c);
        }
    }
}

/// The error of a picture whose pixels all have as many samples. `visit` shows the pixels of a block, one by one.
pub fn estimate<B: Sync>(
    blocks: &[B],
    confidence: f64,
    visit: impl Fn(&B, &mut dyn FnMut(&mut NetSums)) + Sync,
) -> ErrorEstimate {
    let brightness = |block: &B| {
        let (mut sum, mut pixels) = (0.0, 0u64);
        visit(block, &mut |sums| {
            sum += f64::from(luminance(Vec3::from_array(sums.mean(0))));
            pixels += 1;
        });
        (sum, pixels)
    };
    let of_blocks: Vec<(f64, u64)> = blocks.par_iter().map(brightness).collect();
    let total: f64 = of_blocks.iter().map(|b| b.0).sum();
    let pixels: u64 = of_blocks.iter().map(|b| b.1).sum();
    let mut errors = ErrorSums::new(total / pixels as f64, blocks.len());
    for (i, block) in blocks.iter().enumerate() {
        visit(block, &mut |sums| errors.add(i, sums.net_means()));
    }
    errors.estimate(confidence)
}
