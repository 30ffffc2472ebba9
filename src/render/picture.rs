//! From sums to pictures and error estimates, the same for a render and for parts that were brought together.

use super::estimate::{ErrorSums, Sheet, Wanted, standard_error};
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
    /// For these layers; those that are not sums of samples take no channel.
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

    /// The mean colour of every second net from `first` on; NaN without samples.
    fn half_mean(&self, first: usize) -> [f32; 3] {
        let sums = self.sums.chunks_exact(self.channels).skip(first).step_by(2);
        let n: u32 = self.points.iter().skip(first).step_by(2).sum();
        let total = |c: usize| sums.clone().fold(0.0, |t, net| t + net[c]);
        [0, 1, 2].map(|c| (total(c) / f64::from(n)) as f32)
    }

    /// The share of the light that the net with the most of it has; see [`Picture::tail`].
    fn tail(&self) -> f32 {
        let nets = self.sums.chunks_exact(self.channels).zip(&self.points);
        let lights = nets.filter(|(_, points)| **points > 0);
        let lights = lights.map(|(sum, points)| (sum[0] + sum[1] + sum[2]).abs() / f64::from(*points));
        let (count, most, all) = lights.fold((0, 0.0f64, 0.0), |(n, m, a), s| (n + 1, m.max(s), a + s));
        if count < 2 {
            f32::NAN
        } else if all == 0.0 {
            0.0
        } else {
            (most / all) as f32
        }
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
    pub fn black(width: u32, height: u32, aovs: Aovs) -> Picture {
        let n = width as usize * height as usize;
        Picture {
            width,
            height,
            rgb: vec![[0.0; 3]; n],
            stderr: vec![[f32::NAN; 3]; n],
            samples: vec![0; n],
            depth: aovs.depth.then(|| vec![f32::INFINITY; n]),
            normal: aovs.normal.then(|| vec![[0.0; 3]; n]),
            albedo: aovs.albedo.then(|| vec![[0.0; 3]; n]),
            time: aovs.time.then(|| vec![f32::NAN; n]),
            tail: aovs.tail.then(|| vec![f32::NAN; n]),
            half_a: aovs.half_a.then(|| vec![[0.0; 3]; n]),
            half_b: aovs.half_b.then(|| vec![[0.0; 3]; n]),
        }
    }

    /// Sets a pixel, all but its time.
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
        if let Some(layer) = &mut self.tail {
            layer[at] = sums.tail();
        }
        for (first, layer) in [&mut self.half_a, &mut self.half_b].into_iter().enumerate() {
            if let Some(layer) = layer.as_mut().filter(|_| samples > 0) {
                layer[at] = sums.half_mean(first);
            }
        }
    }
}

/// The error of a picture, and the share of E² of each block, summed over its pixels. `visit` shows the pixels of a
/// block row by row, `width` tells its columns.
pub fn estimate<B: Sync>(
    blocks: &[B],
    nets: u32,
    wanted: Wanted,
    confidence: f64,
    width: impl Fn(&B) -> u32 + Sync,
    visit: impl Fn(&B, &mut dyn FnMut(&mut NetSums)) + Sync,
) -> (ErrorEstimate, Vec<f64>) {
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
    let mean = total / pixels as f64;
    let errors = |block: &B| {
        let mut sheet = Sheet::new(width(block) as usize, nets as usize);
        visit(block, &mut |sums| sheet.push(sums.net_means()));
        ErrorSums::of(&sheet, mean, wanted, confidence)
    };
    let errors: Vec<ErrorSums> = blocks.par_iter().map(errors).collect();
    let shares = errors.iter().map(ErrorSums::total).collect();
    (errors.into_iter().sum::<ErrorSums>().estimate(confidence), shares)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of grey nets: points and the mean of each.
    fn sums(nets: &[(u32, f64)]) -> NetSums {
        let mut sums = NetSums::new(nets.len() as u32, 3);
        for (net, (points, mean)) in (0..).zip(nets) {
            let (sum, count) = sums.net_mut(net);
            *count = *points;
            sum.fill(mean * f64::from(*points));
        }
        sums
    }

    #[test]
    fn the_tail_is_the_share_of_the_brightest_net() {
        for (nets, expected) in [
            (&[(16, 2.0), (16, 2.0), (16, 2.0), (16, 2.0)][..], 0.25),
            (&[(16, 0.0), (16, 0.0), (16, 9.0), (16, 0.0)], 1.0),
            (&[(2, 1.0), (2, 1.0), (1, 1.0), (1, 1.0)], 0.25), // means, not sums: more samples are no larger share
            (&[(1, 3.0), (1, 1.0), (0, 0.0), (0, 0.0)], 0.75),
            (&[(4, 0.0), (4, 0.0), (4, 0.0), (4, 0.0)], 0.0),
        ] {
            assert_eq!(sums(nets).tail(), expected, "{nets:?}");
        }
        assert!(sums(&[(1, 3.0), (0, 0.0), (0, 0.0), (0, 0.0)]).tail().is_nan());
    }

    #[test]
    fn the_halves_of_a_pixel_average_to_it() {
        let aovs = Aovs {
            half_a: true,
            half_b: true,
            ..Aovs::default()
        };
        let channels = Channels::new(aovs);
        let mut picture = Picture::black(3, 1, aovs);
        picture.put(0, 0, &mut sums(&[(8, 1.0), (8, 2.0), (8, 3.0), (8, 6.0)]), &channels);
        picture.put(1, 0, &mut sums(&[(1, 5.0), (0, 0.0), (0, 0.0), (0, 0.0)]), &channels);
        let (a, b) = (picture.half_a.unwrap(), picture.half_b.unwrap());
        assert_eq!((a[0], b[0], picture.rgb[0]), ([2.0; 3], [4.0; 3], [3.0; 3]));
        assert!(a[1] == [5.0; 3] && b[1][0].is_nan());
        assert_eq!((a[2], b[2]), ([0.0; 3], [0.0; 3]));
    }
}
