//! Sums of samples, in an order that does not depend on how the work was cut.
//!
//! Each net of each pixel is summed in f64 in a fixed binary tree over the absolute point number j: sixteen
//! consecutive points are a leaf, two equal subtrees make the next level. A prefix of the points is then a
//! few maximal subtrees plus an unfinished leaf, which is all that is kept between passes. Whatever the
//! passes were, the same samples give the same bits.

/// Points in a leaf of the tree.
const LEAF: u32 = 16;

/// How many sums a prefix of `points` points is made of: one for each maximal subtree, one for an unfinished leaf.
fn parts(points: u32) -> usize {
    (points / LEAF).count_ones() as usize + usize::from(!points.is_multiple_of(LEAF))
}

/// Points that net `net` of `nets` has among the first `samples` samples.
pub fn net_points(samples: u32, net: u32, nets: u32) -> u32 {
    samples / nets + u32::from(net < samples % nets)
}

/// The sums of one tile: for each pixel, net and part a vector of `channels` numbers.
#[derive(Clone, Debug, Default)]
pub struct TileFilm {
    pixels: usize,
    nets: u32,
    channels: usize,
    /// Samples of each pixel so far.
    samples: u32,
    /// Parts kept per net; the largest number any net needs.
    stride: usize,
    sums: Vec<f64>,
}

impl TileFilm {
    /// Empty sums.
    pub fn new(pixels: usize, nets: u32, channels: usize) -> TileFilm {
        TileFilm {
            pixels,
            nets,
            channels,
            samples: 0,
            stride: 0,
            sums: Vec::new(),
        }
    }

    /// Samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Adds the samples up to `end` (exclusive) of every pixel. `sample(pixel, index, out)` writes the channels
    /// of one sample; it is called pixel by pixel, net by net.
    pub fn extend(&mut self, end: u32, mut sample: impl FnMut(usize, u32, &mut [f64])) {
        let begin = self.samples;
        let stride = (0..self.nets)
            .map(|r| parts(net_points(end, r, self.nets)))
            .max()
            .unwrap_or(0);
        let c = self.channels;
        let mut sums = vec![0.0; self.pixels * self.nets as usize * stride * c];
        let mut stack: Vec<f64> = Vec::with_capacity(32 * c);
        let mut leaf = vec![0.0; c];
        let mut value = vec![0.0; c];
        for pixel in 0..self.pixels {
            for net in 0..self.nets {
                let (j0, j1) = (net_points(begin, net, self.nets), net_points(end, net, self.nets));
                let row = pixel * self.nets as usize + net as usize;
                let old = &self.sums[row * self.stride * c..][..parts(j0) * c];
                let full = (j0 / LEAF).count_ones() as usize * c;
                stack.clear();
                stack.extend_from_slice(&old[..full]);
                leaf.fill(0.0);
                leaf[..old.len() - full].copy_from_slice(&old[full..]);
                for j in j0..j1 {
                    sample(pixel, j * self.nets + net, &mut value);
                    leaf.iter_mut().zip(&value).for_each(|(l, v)| *l += v);
                    if (j + 1).is_multiple_of(LEAF) {
                        carry(&mut stack, &mut leaf, (j + 1) / LEAF);
                    }
                }
                if !j1.is_multiple_of(LEAF) {
                    stack.extend_from_slice(&leaf);
                }
                sums[row * stride * c..][..stack.len()].copy_from_slice(&stack);
            }
        }
        (self.sums, self.stride, self.samples) = (sums, stride, end);
    }

    /// The sum of one net of a pixel and its number of points.
    pub fn net_sum(&self, pixel: usize, net: u32, out: &mut [f64]) -> u32 {
        let points = net_points(self.samples, net, self.nets);
        let row = pixel * self.nets as usize + net as usize;
        out.fill(0.0);
        // From the smallest part to the largest, a fixed order.
        for part in (0..parts(points)).rev() {
            let sums = &self.sums[(row * self.stride + part) * self.channels..][..self.channels];
            out.iter_mut().zip(sums).for_each(|(o, s)| *o += s);
        }
        points
    }
}

/// Puts the `count`-th finished leaf into the tree: equal subtrees are added, older one first. The leaf is cleared.
fn carry(stack: &mut Vec<f64>, leaf: &mut [f64], count: u32) {
    let c = leaf.len();
    for _ in 0..count.trailing_zeros() {
        let older = stack.len() - c;
        leaf.iter_mut().zip(&stack[older..]).for_each(|(l, o)| *l += o);
        stack.truncate(older);
    }
    stack.extend_from_slice(leaf);
    leaf.fill(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::Pcg;

    fn value(pixel: usize, index: u32) -> f64 {
        let mut rng = Pcg::new(pixel as u64 * 1_000_003 + u64::from(index));
        rng.next_f64() * 10f64.powi((rng.next_u32() % 12) as i32)
    }

    fn sums_after(passes: &[u32], nets: u32) -> Vec<u64> {
        let mut film = TileFilm::new(3, nets, 2);
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
            let whole = sums_after(&[1003], nets);
            for passes in [&[1, 2, 4, 8, 16, 1003][..], &[500, 1003], &[333, 334, 335, 900, 1003]] {
                assert_eq!(whole, sums_after(passes, nets), "{passes:?} with {nets} nets");
            }
        }
    }

    /// Oracle: integers below 2⁵³ are summed exactly in any order.
    #[test]
    fn nothing_is_lost_and_nothing_counted_twice() {
        let mut film = TileFilm::new(1, 4, 1);
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
}
