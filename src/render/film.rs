//! Sums of samples, in an order that does not depend on how the work was cut.
//!
//! Each net of each pixel is summed in f64 in a fixed binary tree over the absolute point number j: sixteen
//! consecutive points are a leaf, two equal subtrees make the next level. A prefix of the points is then a
//! few maximal subtrees plus an unfinished leaf, which is all that is kept between passes. Whatever the
//! passes were, the same samples give the same bits. [`range`] says how that holds for ranges that do not begin at 0.

pub mod range;

use range::{Accumulator, Layout, add_total, net_range};
use std::ops::Range;

/// The sums of one tile over a range of samples: for each pixel, net and part a vector of `channels` numbers.
#[derive(Clone, Debug, Default)]
pub struct TileFilm {
    pixels: usize,
    nets: u32,
    channels: usize,
    /// Samples of each pixel so far.
    range: Range<u32>,
    /// Vectors kept per net; the largest number any net needs.
    stride: usize,
    sums: Vec<f64>,
}

impl TileFilm {
    /// Empty sums of samples from `first` on.
    pub fn new(pixels: usize, nets: u32, channels: usize, first: u32) -> TileFilm {
        TileFilm {
            pixels,
            nets,
            channels,
            range: first..first,
            stride: 0,
            sums: Vec::new(),
        }
    }

    /// Sums that were kept: those of each pixel as [`TileFilm::pixel_sums`] gives them.
    pub fn restore<'a>(
        nets: u32,
        channels: usize,
        range: Range<u32>,
        pixels: impl ExactSizeIterator<Item = &'a [f64]>,
    ) -> TileFilm {
        let stride = stride(&range, nets);
        let mut film = TileFilm {
            pixels: pixels.len(),
            nets,
            channels,
            stride,
            sums: vec![0.0; pixels.len() * nets as usize * stride * channels],
            range,
        };
        for (pixel, mut sums) in pixels.enumerate() {
            for net in 0..nets {
                let n = Layout::of(&net_range(&film.range, net, nets)).len() * channels;
                let (own, rest) = sums.split_at(n);
                film.sums[(pixel * nets as usize + net as usize) * stride * channels..][..n].copy_from_slice(own);
                sums = rest;
            }
        }
        film
    }

    /// The samples of each pixel so far.
    pub fn range(&self) -> &Range<u32> {
        &self.range
    }

    /// Samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.range.end - self.range.start
    }

    /// Adds the samples up to `end` (exclusive, counted from sample 0) of every pixel. `sample(pixel, index, out)`
    /// writes the channels of one sample; it is called pixel by pixel, net by net.
    pub fn extend(&mut self, end: u32, mut sample: impl FnMut(usize, u32, &mut [f64])) {
        let (old, new) = (self.range.clone(), self.range.start..end);
        let stride = stride(&new, self.nets);
        let c = self.channels;
        let mut sums = vec![0.0; self.pixels * self.nets as usize * stride * c];
        let mut net_sums = Accumulator::new(c);
        let mut value = vec![0.0; c];
        for pixel in 0..self.pixels {
            for net in 0..self.nets {
                let (before, after) = (net_range(&old, net, self.nets), net_range(&new, net, self.nets));
                net_sums.load(&before, self.net_vectors(pixel, net));
                for j in before.end..after.end {
                    sample(pixel, j * self.nets + net, &mut value);
                    net_sums.push(j, &value);
                }
                let row = pixel * self.nets as usize + net as usize;
                let vectors = net_sums.finish(after.start, after.end);
                sums[row * stride * c..][..vectors.len()].copy_from_slice(vectors);
            }
        }
        (self.sums, self.stride, self.range) = (sums, stride, new);
    }

    /// The sum of one net of a pixel and its number of points.
    pub fn net_sum(&self, pixel: usize, net: u32, out: &mut [f64]) -> u32 {
        out.fill(0.0);
        add_total(self.net_vectors(pixel, net), out);
        net_range(&self.range, net, self.nets).len() as u32
    }

    /// Appends all that is kept of a pixel, net by net.
    pub fn pixel_sums(&self, pixel: usize, out: &mut Vec<f64>) {
        for net in 0..self.nets {
            out.extend_from_slice(self.net_vectors(pixel, net));
        }
    }

    /// The vectors of a net of a pixel, by [`Layout`].
    fn net_vectors(&self, pixel: usize, net: u32) -> &[f64] {
        let row = pixel * self.nets as usize + net as usize;
        let layout = Layout::of(&net_range(&self.range, net, self.nets));
        &self.sums[row * self.stride * self.channels..][..layout.len() * self.channels]
    }
}

/// Vectors that the net with the most of them has.
fn stride(samples: &Range<u32>, nets: u32) -> usize {
    let vectors = (0..nets).map(|net| Layout::of(&net_range(samples, net, nets)).len());
    vectors.max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::Pcg;

    fn value(pixel: usize, index: u32) -> f64 {
        let mut rng = Pcg::new(pixel as u64 * 1_000_003 + u64::from(index));
        rng.next_f64() * 10f64.powi((rng.next_u32() % 12) as i32)
    }

    fn sums_after(first: u32, passes: &[u32], nets: u32) -> Vec<u64> {
        let mut film = TileFilm::new(3, nets, 2, first);
        for &end in passes {
            film.extend(end, |p, i, out| out.copy_from_slice(&[value(p, i), -value(p, i)]));
        }
        let mut bits = Vec::new();
        for pixel in 0..3 {
            for net in 0..nets {
                let mut sum = [0.0; 2];
                film.net_sum(pixel, net, &mut sum);
                bits.extend(sum.map(f64::to_bits));
            }
        }
        bits
    }

    #[test]
    fn the_same_samples_give_the_same_bits_however_they_were_cut() {
        for nets in [1, 4, 8] {
            for first in [0, 1, 64, 77] {
                let whole = sums_after(first, &[1003], nets);
                for passes in [&[78, 79, 80, 128, 1003][..], &[500, 1003], &[333, 334, 335, 900, 1003]] {
                    assert_eq!(
                        whole,
                        sums_after(first, passes, nets),
                        "{first} then {passes:?} with {nets} nets"
                    );
                }
            }
        }
    }

    /// Oracle: integers below 2⁵³ are summed exactly in any order.
    #[test]
    fn nothing_is_lost_and_nothing_counted_twice() {
        let mut film = TileFilm::new(1, 4, 1, 0);
        for end in [1, 7, 64, 100, 777] {
            film.extend(end, |_, i, out| out[0] = f64::from(i));
            let (mut total, mut points) = (0.0, 0);
            for net in 0..4 {
                let mut sum = [0.0];
                points += film.net_sum(0, net, &mut sum);
                total += sum[0];
            }
            assert_eq!((total, points), (f64::from(end) * f64::from(end - 1) / 2.0, end));
        }
    }

    #[test]
    fn sums_that_were_kept_go_on_as_if_nothing_had_happened() {
        let sample = |p: usize, i: u32, out: &mut [f64]| out.copy_from_slice(&[value(p, i), 1.0]);
        let mut whole = TileFilm::new(2, 4, 2, 5);
        whole.extend(1234, sample);
        for cut in [5, 6, 70, 1000, 1234] {
            let mut first = TileFilm::new(2, 4, 2, 5);
            first.extend(cut, sample);
            let kept = [0, 1].map(|pixel| {
                let mut sums = Vec::new();
                first.pixel_sums(pixel, &mut sums);
                sums
            });
            let mut second = TileFilm::restore(4, 2, 5..cut, kept.iter().map(Vec::as_slice));
            second.extend(1234, sample);
            assert_eq!(second.sums, whole.sums, "cut at {cut}");
        }
    }

    /// The mean of all samples of the one pixel.
    fn mean_of(samples: u32, value: impl Fn(u32) -> f64) -> f64 {
        let mut film = TileFilm::new(1, 16, 1, 0);
        film.extend(samples, |_, i, out| out[0] = value(i));
        let mut sum = [0.0];
        let nets = (0..16).map(|net| {
            film.net_sum(0, net, &mut sum);
            sum[0]
        });
        nets.sum::<f64>() / f64::from(samples)
    }

    /// Relative error of a mean of positive numbers: a leaf has 15 roundings, a tree of n/16 leaves log₂(n/16), its
    /// at most 28 subtrees and a leaf are added one by one, so are the 16 nets, and the division rounds once.
    fn rounding(samples: u32) -> f64 {
        (15.0 + f64::from(samples.ilog2()) + 28.0 + 16.0 + 1.0) * 2f64.powi(-53)
    }

    /// Ten million times 0.1; f32 sums are 8.8 % off. Oracle: the number itself.
    #[test]
    fn ten_million_samples_have_their_mean() {
        let n = 10_000_000;
        let tenth = f64::from(0.1f32);
        let mean = mean_of(n, |_| tenth);
        assert!((mean / tenth - 1.0).abs() <= rounding(n), "{mean}");
    }

    /// Faint samples among fireflies of 1e7, in f32 5 % too dark; oracle: integers, which f64 sums exactly.
    /// And numbers from 1e-9 to 1e30 at once; oracle: a sum that carries its own rounding errors along (Neumaier 1974).
    #[test]
    fn bright_samples_do_not_swallow_faint_ones() {
        let n = 1_000_000;
        let firefly = |i: u32| {
            if i.is_multiple_of(1_000_003) || i % 99_991 == 7 {
                1e7
            } else {
                f64::from(i % 17)
            }
        };
        let exact = (0..n).map(|i| firefly(i) as u64).sum::<u64>() as f64 / f64::from(n);
        assert_eq!(mean_of(n, firefly), exact);

        let wide = |i: u32| {
            let mut rng = Pcg::new(u64::from(i));
            f64::from(10f64.powf(39.0 * rng.next_f64() - 9.0) as f32)
        };
        let (mut sum, mut left) = (0.0f64, 0.0f64);
        for x in (0..n).map(wide) {
            let next = sum + x;
            left += if sum >= x { (sum - next) + x } else { (x - next) + sum };
            sum = next;
        }
        let off = mean_of(n, wide) / ((sum + left) / f64::from(n)) - 1.0;
        assert!(off.abs() <= rounding(n), "off by {off}");
    }

    /// The spread of the nets does not depend on what they spread around: mean squares minus squared means would have
    /// no digit left of a variance of 1 at 1e8. Means of n samples around m are rounded by `rounding(n)`·m each.
    #[test]
    fn the_variance_of_bright_pixels_keeps_its_digits() {
        let n = 160_000;
        let noise = |i: u32| crate::math::stats::normal_quantile(Pcg::new(u64::from(i)).next_f64());
        let error_around = |level: f64| {
            let mut film = TileFilm::new(1, 16, 1, 0);
            film.extend(n, |_, i, out| out[0] = level + noise(i));
            let mut sum = [0.0];
            let means: Vec<[f64; 3]> = (0..16)
                .map(|net| [f64::from(film.net_sum(0, net, &mut sum)); 3].map(|points| sum[0] / points))
                .collect();
            f64::from(crate::render::estimate::standard_error(&means)[0])
        };
        let around_nothing = error_around(0.0);
        // The variance of a mean of n standard normal numbers is 1/n; 15 degrees of freedom leave 5·√(2/15)/2 of its root.
        let expected = f64::from(n).sqrt().recip();
        assert!(
            (around_nothing / expected - 1.0).abs() < 0.92,
            "{around_nothing}, expected {expected}"
        );
        for level in [1.0, 1e4, 1e8] {
            let found = error_around(level);
            let allowed = 2.0 * rounding(n) * level + around_nothing * 2f64.powi(-23);
            assert!(
                (found - around_nothing).abs() <= allowed,
                "{found} around {level}, {around_nothing} around 0"
            );
        }
    }
}
