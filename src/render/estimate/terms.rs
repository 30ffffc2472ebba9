//! The error of single pixels: variances from one half of the nets, weights from the other.

use crate::math::color::luminance;
use crate::render::settings::DisplayCurve;
use glam::Vec3;

/// Net means of one pixel: `means[r]` of net r, per channel.
pub type NetMeans = [[f64; 3]];

/// Standard error of the mean of the nets, per channel; NaN for one net.
pub fn standard_error(means: &NetMeans) -> [f32; 3] {
    let n = means.len() as f64;
    variance(means).map(|v| (v / n).sqrt() as f32)
}

/// Variance between nets, per channel; NaN for one net.
fn variance(means: &NetMeans) -> [f64; 3] {
    let n = means.len() as f64;
    let average = mean(means);
    [0, 1, 2].map(|c| {
        let squares = means.iter().map(|m| (m[c] - average[c]) * (m[c] - average[c]));
        squares.sum::<f64>() / (n - 1.0)
    })
}

fn mean(means: &NetMeans) -> [f64; 3] {
    let n = means.len() as f64;
    [0, 1, 2].map(|c| means.iter().map(|m| m[c]).sum::<f64>() / n)
}

fn luminance_of(rgb: [f64; 3]) -> f64 {
    f64::from(luminance(Vec3::from_array(rgb.map(|v| v as f32))))
}

/// Net means of a rectangle of pixels, row by row.
#[derive(Clone, Debug)]
pub struct Sheet {
    width: usize,
    nets: usize,
    means: Vec<[f64; 3]>,
}

/// One half of a pixel's nets.
#[derive(Clone, Copy, Default)]
struct Half {
    /// Variance between its nets, per channel.
    variance: [f64; 3],
    /// Variance of its mean luminance.
    uncertainty: f64,
    /// Its mean luminance.
    luminance: f64,
}

impl Sheet {
    /// Of no pixels yet; at least two nets.
    pub fn new(width: usize, nets: usize) -> Sheet {
        Sheet {
            width,
            nets,
            means: Vec::new(),
        }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Adds the next pixel.
    pub fn push(&mut self, means: &NetMeans) {
        self.means.extend_from_slice(means);
    }

    /// The nets of a pixel.
    pub fn pixel(&self, i: usize) -> &NetMeans {
        &self.means[i * self.nets..][..self.nets]
    }

    fn pixels(&self) -> impl Iterator<Item = &NetMeans> {
        self.means.chunks_exact(self.nets)
    }

    fn halves(&self) -> Vec<[Half; 2]> {
        self.pixels()
            .map(|means| {
                let (a, b) = means.split_at(self.nets / 2);
                [half(a, b), half(b, a)]
            })
            .collect()
    }

    /// Variance/(luminance² + ε) of the pixels' means, twice: variance from the first half of the nets and luminance
    /// from the second, and the other way round.
    pub fn relative_terms(&self, epsilon: f64) -> Vec<[f64; 2]> {
        let halves = self.halves();
        let columns = [0, 1].map(|h| halves.iter().map(|pair| pair[h].luminance).collect::<Vec<f64>>());
        let term = |i: usize, own: usize| {
            let (own, other) = (&halves[i][own], 1 - own);
            let variance = own.variance.iter().sum::<f64>() / (3.0 * self.nets as f64);
            if variance == 0.0 {
                return 0.0;
            }
            let both = 0.5 * (halves[i][0].luminance + halves[i][1].luminance);
            let y = self.brightness(i, &columns[other], both, own.uncertainty);
            variance / (y * y + epsilon)
        };
        (0..halves.len()).map(|i| [term(i, 0), term(i, 1)]).collect()
    }

    /// The luminance of a pixel for its weight: that of the half which the variance does not come from. Where the
    /// variance says that this half may have found nothing of what is there, and the pixel's neighbours in the same
    /// half are brighter, it is raised towards them, at most to the mean of all nets: without this, pixels of a
    /// caustic weigh too much long after it is seen. (A firefly has no bright neighbours, and keeps its weight.)
    fn brightness(&self, i: usize, half: &[f64], both: f64, uncertainty: f64) -> f64 {
        let y = half[i];
        if both <= y {
            return y;
        }
        let doubt = uncertainty / (uncertainty + 0.5 * y * y);
        let raised = self.median_around(i, half).min(both).max(y);
        y + doubt * (raised - y)
    }

    /// The median of the up to eight neighbours of a pixel inside the rectangle; 0 without neighbours.
    fn median_around(&self, i: usize, values: &[f64]) -> f64 {
        let (x, y) = (i % self.width, i / self.width);
        let (mut around, mut n) = ([0.0; 8], 0);
        for row in y.saturating_sub(1)..=(y + 1).min(values.len() / self.width - 1) {
            for column in x.saturating_sub(1)..=(x + 1).min(self.width - 1) {
                let at = row * self.width + column;
                if at != i {
                    around[n] = values[at];
                    n += 1;
                }
            }
        }
        let around = &mut around[..n];
        around.sort_unstable_by(f64::total_cmp);
        match n {
            0 => 0.0,
            n if n % 2 == 1 => around[n / 2],
            n => 0.5 * (around[n / 2 - 1] + around[n / 2]),
        }
    }

    /// Squared errors of the developed pixels in 8-bit steps, mean over channels: the standard error from one half of
    /// the nets, carried through the curve at the mean of the other half; both ways.
    pub fn display_terms(&self, curve: &DisplayCurve) -> Vec<[f64; 2]> {
        let term = |spread: &NetMeans, place: &NetMeans| {
            let error = half(spread, place).variance.map(|v| (v / self.nets as f64).sqrt());
            let at = mean(place);
            let shown = [-1.0, 1.0].map(|sign| {
                let rgb = [0, 1, 2].map(|c| (at[c] + sign * error[c]).max(0.0) as f32);
                curve.develop(rgb)
            });
            let squares = [0, 1, 2].map(|c| {
                let d = 0.5 * f64::from(shown[1][c] - shown[0][c]);
                d * d
            });
            255.0 * 255.0 * squares.iter().sum::<f64>() / 3.0
        };
        let pair = |means: &NetMeans| {
            let (a, b) = means.split_at(self.nets / 2);
            [term(a, b), term(b, a)]
        };
        self.pixels().map(pair).collect()
    }
}

/// What a half of the nets says. With one net in it the other half is needed to see a spread.
fn half(own: &NetMeans, other: &NetMeans) -> Half {
    let at = mean(own);
    let variance = if own.len() > 1 {
        variance(own)
    } else {
        let other = mean(other);
        [0, 1, 2].map(|c| 0.5 * (at[c] - other[c]) * (at[c] - other[c]))
    };
    let y = luminance_of(at);
    let lights = own.iter().map(|m| luminance_of(*m) - y);
    let lights: f64 = lights.map(|d| d * d).sum();
    let n = own.len() as f64;
    Half {
        variance,
        uncertainty: if own.len() > 1 { lights / (n - 1.0) / n } else { 0.0 },
        luminance: y,
    }
}
