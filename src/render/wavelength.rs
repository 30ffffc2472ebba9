//! Wavelengths, for glass that disperses: a path that meets it follows one of them from there on.
//!
//! Everything else is rendered in three channels. The light of a channel is taken to be spread over the wavelengths
//! that its response says: where the matrix from the standard observer to linear Rec. 709 gives more than nothing. These
//! responses are not negative and integrate to 1, so that light which no dispersion bends keeps its colour exactly, and
//! no colour of a spectrum is brighter than white light holds of it.

use crate::math::portable::exp_f64;
use glam::Vec3;
use std::sync::LazyLock;

/// The wavelengths of visible light that count, nm.
pub const VISIBLE: [f64; 2] = [380.0, 730.0];
/// Fraunhofer's lines d, F and C, nm: those of Abbe's number.
const D: f64 = 587.56;
const F: f64 = 486.13;
const C: f64 = 656.27;
/// Steps in which the responses are constant.
const STEPS: usize = 350;

/// A wavelength, and what white light has of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelength {
    /// nm.
    pub nm: f32,
    /// Response of the three channels over the density with which the wavelength was chosen: 1 in the mean, 3 together.
    pub weight: Vec3,
}

impl Wavelength {
    /// The wavelength of a number in [0, 1), by the mean of the three responses.
    pub fn sample(u: f32) -> Wavelength {
        let table = &*RESPONSES;
        let u = f64::from(u);
        let i = table.partition_point(|step| step.below <= u).clamp(1, STEPS) - 1;
        let step = &table[i];
        let inside = ((u - step.below) / step.share).clamp(0.0, 1.0);
        let width = (VISIBLE[1] - VISIBLE[0]) / STEPS as f64;
        Wavelength {
            nm: (VISIBLE[0] + (i as f64 + inside) * width) as f32,
            weight: step.weight,
        }
    }

    /// The index of refraction of glass that has `ior` for yellow light (the line d) and a dispersion of 20/Abbe number.
    /// By Cauchy's n = A + B/λ² through the three lines of Abbe's number, (n_d − 1)/(n_F − n_C). Above 0 for every
    /// `ior` > 0: far beyond any glass it ends at a hundredth.
    pub fn ior(&self, ior: f32, dispersion: f32) -> f32 {
        let per_square = |nm: f64| 1.0 / (nm * nm);
        let between = per_square(F) - per_square(C);
        let b = (f64::from(ior) - 1.0) * f64::from(dispersion) / 20.0 / between;
        let n = f64::from(ior) + b * (per_square(f64::from(self.nm)) - per_square(D));
        n.max(0.01) as f32
    }
}

/// One step of the responses.
struct Step {
    /// Probability of all steps before it.
    below: f64,
    /// Its own, > 0.
    share: f64,
    weight: Vec3,
}

static RESPONSES: LazyLock<Vec<Step>> = LazyLock::new(|| {
    let at = |i: usize| VISIBLE[0] + (i as f64 + 0.5) / STEPS as f64 * (VISIBLE[1] - VISIBLE[0]);
    let mut rgb: Vec<[f64; 3]> = (0..STEPS).map(|i| response(at(i))).collect();
    for channel in 0..3 {
        let sum: f64 = rgb.iter().map(|c| c[channel]).sum();
        rgb.iter_mut().for_each(|c| c[channel] /= sum);
    }
    let mut below = 0.0;
    let steps = rgb.iter().map(|c| {
        let share = (c[0] + c[1] + c[2]) / 3.0;
        let step = Step {
            below,
            share,
            weight: Vec3::from_array(c.map(|c| (c / share) as f32)),
        };
        below += share;
        step
    });
    steps.collect()
});

/// Linear Rec. 709 of light of one wavelength, without what is negative; up to a factor.
/// Sources: the standard observer of 1931 after Wyman, Sloan & Shirley, Simple Analytic Approximations to the CIE XYZ
/// Color Matching Functions, JCGT 2013; the matrix of Rec. 709's primaries and white.
fn response(nm: f64) -> [f64; 3] {
    let lobe = |mean: f64, below: f64, above: f64| {
        let t = (nm - mean) * if nm < mean { below } else { above };
        exp_f64(-0.5 * t * t)
    };
    let x =
        0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323) - 0.065 * lobe(501.1, 0.0490, 0.0382);
    let y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322);
    let z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725);
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
    .map(|c| c.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(n: u32) -> impl Iterator<Item = Wavelength> {
        (0..n).map(move |i| Wavelength::sample((i as f32 + 0.5) / n as f32))
    }

    /// White light is white: weights are 1 in the mean. Of 2¹⁶ even numbers at most one falls on the wrong side of each
    /// border of a step, which moves the mean by 3/2¹⁶ of the differences of neighbouring weights, together below 20.
    #[test]
    fn white_light_stays_white() {
        let n = 1 << 16;
        let mean = all(n).map(|w| w.weight.as_dvec3()).sum::<glam::DVec3>() / f64::from(n);
        assert!((mean - 1.0).abs().max_element() < 60.0 / f64::from(n), "{mean}");
        for w in all(1000) {
            assert!((w.weight.element_sum() - 3.0).abs() < 1e-5 && w.weight.min_element() >= 0.0);
            assert!((VISIBLE[0] as f32..=VISIBLE[1] as f32).contains(&w.nm));
        }
        assert!(all(1000).is_sorted_by(|a, b| a.nm < b.nm));
    }

    /// Blue, green and red stand where the eye sees them.
    #[test]
    fn channels_are_where_their_colours_are() {
        let mean_nm = |c: usize| {
            let (sum, all) = all(10_000).fold((0.0, 0.0), |(s, a), w| (s + w.nm * w.weight[c], a + w.weight[c]));
            sum / all
        };
        let [r, g, b] = [0, 1, 2].map(mean_nm);
        assert!(
            (590.0..630.0).contains(&r) && (525.0..560.0).contains(&g) && (440.0..470.0).contains(&b),
            "{r} {g} {b}"
        );
    }

    /// Abbe's number by its definition; no dispersion changes nothing.
    #[test]
    fn the_index_has_the_abbe_number_it_was_given() {
        let at = |nm: f64| Wavelength {
            nm: nm as f32,
            weight: Vec3::ONE,
        };
        for (ior, abbe) in [(1.5f32, 59.0f32), (1.76, 25.0), (2.42, 55.0), (0.8, 30.0)] {
            let n = |nm: f64| f64::from(at(nm).ior(ior, 20.0 / abbe));
            let found = (n(D) - 1.0) / (n(F) - n(C));
            // Differences of indices of some 0.01, each rounded to 6e-8.
            assert!(
                (found / f64::from(abbe) - 1.0).abs() < 1e-4,
                "{found} instead of {abbe}"
            );
            assert_eq!(at(400.0).ior(ior, 0.0), ior);
        }
    }
}
