//! Thin films: layers so thin that light reflected by their two faces interferes, as on soap bubbles and oil.
//!
//! The form of glTF's `KHR_materials_iridescence`, after Belcour & Barla, A Practical Extension to Microfacet Theory for the
//! Modeling of Varying Iridescence, 2017: both faces reflect by Schlick's curve, the base has the real index that its
//! reflectance at normal incidence asks for, and the series of Airy is summed for the three channels by sensitivities that
//! are Gaussian in the wave number. In two things this is nearer to the spectrum than the text's sample code: responses are
//! scaled such that white light stays white (its red would gain a fifth), and a third order is summed.

use super::fresnel::{f0_from_eta, schlick, schlick_weight};
use crate::math::portable::{exp, sin_cos_turns};
use glam::Vec3;
use std::sync::LazyLock;

/// A thin film over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// n_film / n_outside, > 0.
    pub eta: f32,
    /// Optical way to and fro across it at normal incidence, 2·n_film·thickness, in nm.
    pub way: f32,
    /// Share of the film's reflectance; the rest is the base's. Below 1 only for the thinnest films.
    share: f32,
}

/// Orders of interference that are summed.
const ORDERS: u32 = 3;

/// Films below this thickness, in nm, fade into the base alone: there Schlick's two curves, which do not know of one another,
/// would keep reflecting more than one.
const FADES_BELOW: f32 = 30.0;

impl Film {
    /// A film of this thickness in nm and index; `None` where there is none.
    pub fn new(ior: f32, thickness: f32, outer_ior: f32) -> Option<Film> {
        if !(thickness > 0.0 && thickness.is_finite() && ior > 0.0 && ior.is_finite()) {
            return None;
        }
        let t = (thickness / FADES_BELOW).min(1.0);
        Some(Film {
            eta: ior / outer_ior,
            way: 2.0 * ior * thickness,
            share: t * t * (3.0 - 2.0 * t),
        })
    }

    /// Reflectance over a base that alone reflects `f0` at normal incidence; in [0, 1] per channel, as a function of the
    /// cosine outside.
    pub fn over(&self, f0: Vec3, cos: f32) -> Vec3 {
        self.reflectance(f0.clamp(Vec3::ZERO, Vec3::ONE).map(f32::sqrt), cos)
    }

    /// Reflectance over a base of this index relative to the outside.
    pub fn over_index(&self, eta: f32, cos: f32) -> Vec3 {
        self.reflectance(Vec3::splat((eta - 1.0) / (eta + 1.0)), cos)
    }

    /// Reflectance of film and base; `root` = (n_base − n_outside)/(n_base + n_outside).
    fn reflectance(&self, root: Vec3, cos: f32) -> Vec3 {
        let film = self.interference(root, cos);
        if self.share >= 1.0 {
            return film;
        }
        let bare = schlick(root * root, 1.0, cos);
        bare + (film - bare) * self.share
    }

    /// Reflectance of both faces together.
    fn interference(&self, root: Vec3, cos: f32) -> Vec3 {
        let sin2 = (1.0 - cos * cos).max(0.0) / (self.eta * self.eta);
        if sin2 >= 1.0 {
            return Vec3::ONE; // never gets into the film
        }
        let inner = (1.0 - sin2).sqrt();
        let f0 = f0_from_eta(self.eta);
        let upper = f0 + (1.0 - f0) * schlick_weight(cos);
        let through = 1.0 - upper;
        if through <= 0.0 {
            return Vec3::ONE;
        }
        // (n_base − n_film)/(n_base + n_film), also for an infinite index.
        let (more, less) = (Vec3::ONE + root, (Vec3::ONE - root) * self.eta);
        let lower_root = (more - less) / (more + less);
        let lower_f0 = lower_root * lower_root;
        let lower = lower_f0 + (Vec3::ONE - lower_f0) * schlick_weight(inner);
        // A reflection at what is denser turns the phase by half a wave: of the way to and fro, one at each face.
        let turn = if self.eta < 1.0 { 1.0 } else { -1.0 };
        let sign = lower_root.map(|r| if r < 0.0 { -turn } else { turn });
        let both = lower * upper;
        let step = both.map(f32::sqrt) * sign;
        let entered = lower * (through * through) / (Vec3::ONE - both);
        let mut sum = entered + Vec3::splat(upper);
        let mut amplitude = (entered - Vec3::splat(through)) * 2.0;
        for order in 1..=ORDERS {
            amplitude *= step;
            sum += amplitude * coherence(order as f32 * self.way * inner);
        }
        sum.clamp(Vec3::ZERO, Vec3::ONE)
    }
}

/// A Gaussian response by the wave number, in 1/m: height (of any scale), centre and half the variance.
type Response = [f64; 3];

/// The standard observer's X (two of them), Y and Z. Source: Belcour & Barla 2017, as printed in the extension's text.
const RESPONSES: [Response; 4] = [
    [5.4856, 1.6810e6, 4.3278e9],
    [0.97470, 2.2399e6, 4.5282e9],
    [4.4201, 1.7953e6, 9.3046e9],
    [5.2481, 2.2084e6, 6.6121e9],
];

/// From X, Y and Z to linear Rec. 709, by columns; the first two responses are both of X.
const REC709: [[f64; 3]; 4] = [
    [3.240_454_2, -0.969_266_0, 0.055_643_4],
    [3.240_454_2, -0.969_266_0, 0.055_643_4],
    [-1.537_138_5, 1.876_010_8, -0.204_025_9],
    [-0.498_531_4, 0.041_556_0, 1.057_225_2],
];

/// How much each response gives to the channels, white being 1.
static CHANNELS: LazyLock<[Vec3; 4]> = LazyLock::new(|| {
    let weights: [[f64; 3]; 4] = std::array::from_fn(|i| {
        let [height, _, variance] = RESPONSES[i];
        REC709[i].map(|c| c * height * variance.sqrt())
    });
    let white: [f64; 3] = std::array::from_fn(|c| weights.iter().map(|w| w[c]).sum());
    weights.map(|w| Vec3::from_array(std::array::from_fn(|c| (w[c] / white[c]) as f32)))
});

/// How far light that has gone `way` nm farther keeps step with itself, per channel: the mean of the cosine of its phase
/// over the channel's responses. 1 for no way, 0 for a long one.
fn coherence(way: f32) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (weight, [_, centre, variance]) in CHANNELS.iter().zip(RESPONSES) {
        let turns = way * (centre * NANOMETRE) as f32;
        let angle = way * (std::f64::consts::TAU * NANOMETRE) as f32;
        let blur = angle * angle * variance as f32;
        if blur < BLUR_ALL {
            sum += *weight * (exp(-blur) * sin_cos_turns(turns - turns.floor()).1);
        }
    }
    sum
}

/// In metres.
const NANOMETRE: f64 = 1e-9;

/// An exponent whose share no f32 of order 1 resolves.
const BLUR_ALL: f32 = 17.0;
#[cfg(test)]
mod tests {
    use super::*;

    const TAU: f64 = std::f64::consts::TAU;

    /// One film over one base, in f64, as the model has it: Schlick's curve at both faces, phases of 0 and half a turn.
    struct Stack {
        eta: f64,
        way: f64,
        upper: f64,
        lower: f64,
        sign: f64,
    }

    impl Stack {
        fn new(film: &Film, f0: f64, cos: f64) -> Stack {
            let schlick = |f0: f64, c: f64| f0 + (1.0 - f0) * (1.0 - c).powi(5);
            let eta = f64::from(film.eta);
            let inner = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
            let base = (1.0 + f0.sqrt()) / (1.0 - f0.sqrt());
            let lower = (base - eta) / (base + eta);
            Stack {
                eta,
                way: f64::from(film.way) * inner,
                upper: schlick(((eta - 1.0) / (eta + 1.0)).powi(2), cos),
                lower: schlick(lower * lower, inner),
                sign: if (eta < 1.0) == (lower < 0.0) { -1.0 } else { 1.0 },
            }
        }

        /// Airy's sum for one wavelength (nm), from complex amplitudes.
        fn reflectance(&self, nm: f64) -> f64 {
            let outer = if self.eta < 1.0 { 1.0 } else { -1.0 } * self.upper.sqrt();
            let inner = self.lower.sqrt() * outer.signum() * -self.sign;
            let phase = TAU * self.way / nm;
            // |a + b·e^{iφ}|² / |1 + a·b·e^{iφ}|²
            let (a, b, c) = (outer, inner, phase.cos());
            (a * a + b * b + 2.0 * a * b * c) / (1.0 + a * a * b * b + 2.0 * a * b * c)
        }

        /// The mean over a response, both as functions of the wavelength; clamped as the model is.
        fn mean(&self, response: &[(f64, f64)]) -> f64 {
            let all: f64 = response.iter().map(|(_, w)| w).sum();
            let sum: f64 = response.iter().map(|(nm, w)| w * self.reflectance(*nm)).sum();
            (sum / all).clamp(0.0, 1.0)
        }

        /// Amplitude of the orders from `first` on, each at most 2·|C|·rᵐ.
        fn orders_from(&self, first: i32) -> f64 {
            let both = self.upper * self.lower;
            let through = 1.0 - self.upper;
            let first_amplitude = 2.0 * (through * through * self.lower / (1.0 - both) - through).abs();
            first_amplitude * both.sqrt().powi(first) / (1.0 - both.sqrt())
        }
    }

    /// Channels' responses by wavelength from those of X, Y and Z.
    fn channels(xyz: impl Fn(f64) -> [f64; 3]) -> [Vec<(f64, f64)>; 3] {
        std::array::from_fn(|c| {
            let at = |nm: f64| {
                let [x, y, z] = xyz(nm);
                REC709[0][c] * x + REC709[2][c] * y + REC709[3][c] * z
            };
            (0..4800)
                .map(|i| 340.0 + 0.1 * f64::from(i))
                .map(|nm| (nm, at(nm)))
                .collect()
        })
    }

    /// The model's own Gaussians, per nm.
    fn gaussians() -> [Vec<(f64, f64)>; 3] {
        channels(|nm| {
            let per_m = 1e9 / nm;
            let lobe = |[height, centre, half]: Response| {
                let t = per_m - centre;
                // dk = k²·dλ; a Gaussian of this transform has the height over √(2π)·2√half … its factor is common to all.
                height * (-t * t / (4.0 * half)).exp() * per_m * per_m
            };
            [
                lobe(RESPONSES[0]) + lobe(RESPONSES[1]),
                lobe(RESPONSES[2]),
                lobe(RESPONSES[3]),
            ]
        })
    }

    /// The standard observer of 1931 after Wyman, Sloan & Shirley, JCGT 2013.
    fn observer() -> [Vec<(f64, f64)>; 3] {
        channels(|nm| {
            let lobe = |mean: f64, below: f64, above: f64| {
                let t = (nm - mean) * if nm < mean { below } else { above };
                (-0.5 * t * t).exp()
            };
            [
                0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323)
                    - 0.065 * lobe(501.1, 0.0490, 0.0382),
                0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
                1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725),
            ]
        })
    }

    fn films() -> impl Iterator<Item = (Film, f64, f64)> {
        let thicknesses = [30.0f32, 100.0, 250.0, 400.0, 800.0, 3000.0];
        let all = thicknesses
            .into_iter()
            .flat_map(|d| [0.8f32, 1.3, 1.8, 2.4].map(|n| (d, n)));
        let all = all.flat_map(|(d, n)| [0.02, 0.04, 0.3, 0.9].map(|f0| (d, n, f0)));
        all.flat_map(|(d, n, f0)| [1.0, 0.75, 0.62].map(|cos| (Film::new(n, d, 1.0).unwrap(), f0, cos)))
    }

    /// How far the two responses' coherences can differ: their transforms compared at every way that counts.
    fn largest_misfit(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
        let coherence = |r: &[(f64, f64)], way: f64| {
            let all: f64 = r.iter().map(|(_, w)| w).sum();
            r.iter().map(|(nm, w)| w * (TAU * way / nm).cos()).sum::<f64>() / all
        };
        let ways = (0..200).map(|i| 40.0 * f64::from(i));
        ways.map(|way| (coherence(a, way) - coherence(b, way)).abs())
            .fold(0.0, f64::max)
    }

    /// Oracle: Airy's sum at 4800 wavelengths, weighted by the model's own responses. All that differs is what follows the
    /// third order; the responses' absolute values integrate to less than 2 in each channel. f32 adds 10⁻⁴ for ways of
    /// thousands of nm (24 bits of a phase of 100 radians).
    #[test]
    fn colours_are_those_of_airys_sum() {
        let responses = gaussians();
        for (film, f0, cos) in films() {
            let stack = Stack::new(&film, f0, cos);
            let found = film.over(Vec3::splat(f0 as f32), cos as f32).to_array();
            for (channel, response) in responses.iter().enumerate() {
                let wanted = stack.mean(response);
                let tolerance = 2.0 * stack.orders_from(4) + 1e-4;
                let off = (f64::from(found[channel]) - wanted).abs();
                assert!(
                    off < tolerance,
                    "{film:?} over {f0} at {cos}, {channel}: {found:?}, not {wanted} ± {tolerance}"
                );
            }
        }
    }

    /// The same against the standard observer: each order may be off by the misfit of the Gaussians to its responses.
    #[test]
    fn colours_are_those_that_the_standard_observer_sees() {
        let (own, true_ones) = (gaussians(), observer());
        for (channel, response) in true_ones.iter().enumerate() {
            let misfit = largest_misfit(&own[channel], response);
            assert!(misfit < 0.2, "channel {channel}: {misfit}");
            for (film, f0, cos) in films() {
                let stack = Stack::new(&film, f0, cos);
                let found = film.over(Vec3::splat(f0 as f32), cos as f32).to_array()[channel];
                let wanted = stack.mean(response);
                let tolerance = misfit * stack.orders_from(1) + 2.0 * stack.orders_from(4) + 1e-4;
                let off = (f64::from(found) - wanted).abs();
                assert!(
                    off < tolerance,
                    "{film:?} over {f0} at {cos}, {channel}: {found}, not {wanted} ± {tolerance}"
                );
            }
        }
    }

    /// A film of no thickness is none; one thinner than an atom does not show.
    #[test]
    fn a_film_of_no_thickness_is_no_film() {
        assert_eq!(Film::new(1.3, 0.0, 1.0), None);
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(Film::new(1.3, bad, 1.0), None);
        }
        assert_eq!(Film::new(f32::INFINITY, 100.0, 1.0), None);
        let thin = Film::new(1.3, 0.01, 1.0).unwrap();
        for cos in [1.0, 0.5, 0.1] {
            let f0 = Vec3::new(0.04, 0.5, 1.0);
            let off = thin.over(f0, cos) - crate::render::bsdf::fresnel::schlick(f0, 1.0, cos);
            // The fading lets 3·(0.01/30)² of it through.
            assert!(off.abs().max_element() < 4e-7, "{cos}: {off}");
        }
    }

    #[test]
    fn any_film_reflects_a_share() {
        for thickness in [1e-30f32, 0.02, 1.0, 300.0, 1e6, 1e30, f32::MAX] {
            for ior in [1e-3f32, 0.7, 1.0, 1.3, 3.0, 1e30] {
                for outer in [1.0, 1.5] {
                    let Some(film) = Film::new(ior, thickness, outer) else {
                        continue;
                    };
                    for cos in [0.0f32, 1e-20, 1e-3, 0.3, 1.0] {
                        let over = film.over(Vec3::new(0.0, 0.04, 1.0), cos);
                        let solid = film.over_index(1.5, cos).min(film.over_index(0.7, cos));
                        for r in [over, solid] {
                            let is_share = r.min_element() >= 0.0 && r.max_element() <= 1.0;
                            assert!(is_share, "{thickness} {ior} {outer} {cos}: {r}");
                        }
                    }
                }
            }
        }
    }

    /// All light that a film lets through to a base that reflects all comes back.
    #[test]
    fn a_white_base_stays_white_under_a_film() {
        for thickness in [50.0, 300.0, 900.0] {
            let film = Film::new(1.5, thickness, 1.0).unwrap();
            for cos in [1.0, 0.6, 0.2, 0.01] {
                let r = film.over(Vec3::ONE, cos);
                assert!((r - Vec3::ONE).abs().max_element() < 1e-6, "{thickness} {cos}: {r}");
            }
        }
    }
}
