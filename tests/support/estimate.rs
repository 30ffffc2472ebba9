//! An image as statistics see it: a mean and the variance of that mean, per pixel and channel, in f64.

/// Means and variances of the means of an image, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Mean radiance.
    pub mean: Vec<[f64; 3]>,
    /// Variance of the mean (squared standard error).
    pub variance: Vec<[f64; 3]>,
}

/// A rectangle in fractions of the image, from the top left; right and bottom excluded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// What it shows.
    pub name: &'static str,
    /// Left, top, right, bottom, in [0, 1].
    pub bounds: [f64; 4],
}

/// The whole image.
pub const WHOLE: Region = Region {
    name: "whole image",
    bounds: [0.0, 0.0, 1.0, 1.0],
};

/// The mean over a region with its standard error, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionMean {
    /// Mean radiance.
    pub mean: [f64; 3],
    /// Standard error of the mean.
    pub stderr: [f64; 3],
}

impl Estimate {
    /// The pixels of a region as (x, y), at least none.
    pub fn pixels(&self, region: Region) -> impl Iterator<Item = usize> + '_ {
        let [x0, y0, x1, y1] = region.bounds;
        let column = move |f: f64| (f * self.width as f64).round() as usize;
        let row = move |f: f64| (f * self.height as f64).round() as usize;
        (row(y0)..row(y1)).flat_map(move |y| (column(x0)..column(x1)).map(move |x| y * self.width + x))
    }

    /// Mean and standard error of a region; pixels are taken as independent.
    pub fn region(&self, region: Region) -> RegionMean {
        let (mut sum, mut var, mut n) = ([0.0; 3], [0.0; 3], 0.0);
        for i in self.pixels(region) {
            for c in 0..3 {
                sum[c] += self.mean[i][c];
                var[c] += self.variance[i][c];
            }
            n += 1.0;
        }
        RegionMean {
            mean: sum.map(|s| s / n),
            stderr: var.map(|v: f64| v.sqrt() / n),
        }
    }

    /// Mean over all pixels and channels, with its standard error (channels taken as fully correlated).
    pub fn level(&self) -> (f64, f64) {
        let whole = self.region(WHOLE);
        (
            whole.mean.iter().sum::<f64>() / 3.0,
            whole.stderr.iter().sum::<f64>() / 3.0,
        )
    }
}

impl RegionMean {
    /// Fails unless the mean agrees with an exact value within `relative` and within `sigmas` of its own noise.
    /// Noise larger than `relative` fails too: such a test could not see what it looks for.
    pub fn assert_near(&self, exact: [f64; 3], relative: f64, sigmas: f64, what: &str) {
        for (c, &e) in exact.iter().enumerate() {
            let (m, s) = (self.mean[c], self.stderr[c]);
            let noise = sigmas * s;
            assert!(
                noise <= relative * e.abs() || e == 0.0,
                "{what}: channel {c}: {sigmas} standard errors ({noise:.3e}) exceed the tolerance {relative} of {e}"
            );
            let allowed = relative * e.abs() + noise;
            assert!(
                (m - e).abs() <= allowed,
                "{what}: channel {c}: {m:.6} ± {s:.1e}, expected {e:.6} ± {allowed:.1e} ({:+.3} %)",
                100.0 * (m / e - 1.0)
            );
        }
    }

    /// Fails unless two independent means agree within `relative` of the second plus `sigmas` of their joint noise.
    pub fn assert_agrees(&self, other: &RegionMean, relative: f64, sigmas: f64, what: &str) {
        for c in 0..3 {
            let noise = sigmas * self.stderr[c].hypot(other.stderr[c]);
            let (a, b) = (self.mean[c], other.mean[c]);
            assert!(
                (a - b).abs() <= relative * b.abs() + noise,
                "{what}: channel {c}: {a:.6} against {b:.6} ({:+.3} %), {sigmas} joint standard errors are {noise:.1e}",
                100.0 * (a / b - 1.0)
            );
        }
    }
}
