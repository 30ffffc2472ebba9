//! FLIP: how different two pictures look to someone who flips between them, per pixel, from 0 (the same) to 1.
//!
//! Colours are blurred as the eye blurs them at the given distance and compared in a perceptually uniform space;
//! edges and points that only one picture has make a difference count more.
//! Sources: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020, and "Visualizing and
//! Communicating Errors in Rendered Images", Ray Tracing Gems II, 2021, ch. 19 (high dynamic range).

use super::luminance;
use glam::{DVec3, Mat3, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Pixels per degree of vision: a screen 0.7 m and 3840 pixels wide, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 3840.0 * PI / 180.0;

/// Linear Rec. 709 to XYZ, by columns, from the primaries and D65 = (0.3127, 0.3290) of IEC 61966-2-1.
const XYZ_FROM_RGB: Mat3 = Mat3::from_cols_array(&[
    0.412_390_8,
    0.212_639,
    0.019_330_82,
    0.357_584_34,
    0.715_168_7,
    0.119_194_78,
    0.180_480_8,
    0.072_192_32,
    0.950_532_15,
]);

/// Colour differences are compressed by this exponent, and those below `0.4` of the largest take 95 % of the scale.
const COLOR_EXPONENT: f32 = 0.7;
const COLOR_KNEE: f32 = 0.4;
const COLOR_KNEE_VALUE: f32 = 0.95;

/// Width of the edges that the eye sees best, in degrees, and the exponent of their differences.
const FEATURE_WIDTH: f32 = 0.082;
const FEATURE_EXPONENT: f32 = 0.5;

/// The eye's contrast sensitivity as sums of `a·√(π/b)·exp(−π²x²/b)`, x in degrees, for the channels
/// luminance, red–green and blue–yellow.
const SENSITIVITY: [&[[f32; 2]]; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];

/// FLIP of display-referred pictures: linear colours, of which only [0, 1] can be shown.
/// Both hold `width` pixels a row. Symmetric in its pictures.
pub fn ldr(a: &[Vec3], b: &[Vec3], width: usize) -> Vec<f32> {
    let (a, b) = (Seen::new(a, width), Seen::new(b, width));
    let largest = hyab(hunt_lab(Vec3::Y), hunt_lab(Vec3::Z)).powf(COLOR_EXPONENT);
    let knee = COLOR_KNEE * largest;
    (0..a.lab.len())
        .into_par_iter()
        .map(|i| {
            let distance = hyab(a.lab[i], b.lab[i]).powf(COLOR_EXPONENT);
            let color = if distance < knee {
                distance * (COLOR_KNEE_VALUE / knee)
            } else {
                COLOR_KNEE_VALUE + (distance - knee) / (largest - knee) * (1.0 - COLOR_KNEE_VALUE)
            };
            let edge = (a.edge[i] - b.edge[i]).abs();
            let point = (a.point[i] - b.point[i]).abs();
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            color.powf(1.0 - feature).clamp(0.0, 1.0) // rounding may leave [0, 1] by one step
        })
        .collect()
}

/// The exposures that HDR-FLIP looks at, in stops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exposures {
    /// Where the brightest pixel of the reference is just short of white.
    pub start: f64,
    /// Where its median pixel is.
    pub stop: f64,
    /// How many, evenly spaced; at least 2.
    pub count: u32,
}

impl Exposures {
    /// The exposures for a reference: from where its largest luminance is shown as 0.85 by the tone curve to where
    /// its median is, about one a stop. Medians below 2⁻²³ count as that, as in the authors' program.
    /// `None` if nothing shines.
    pub fn of(reference: &[Vec3]) -> Option<Exposures> {
        // Solves curve(x) = 0.85 for the positive x: a quadratic.
        let [k0, k1, k2, k3, k4] = ACES;
        let t = 0.85;
        let (a, b, c) = (k0 - t * k2, k1 - t * k3, -t * k4);
        let white = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
        let mut values: Vec<f64> = reference.iter().map(|c| luminance(c.to_array())).collect();
        let largest = values.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return None;
        }
        let middle = values.len() / 2; // of an even number the upper of the two in the middle
        let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
        let start = (white / largest).log2();
        let stop = (white / median.max(f64::from(f32::EPSILON))).log2().max(start);
        Some(Exposures {
            start,
            stop,
            count: ((stop - start).ceil() as u32).max(2),
        })
    }

    /// Each of them.
    pub fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / f64::from(self.count.max(2) - 1);
        (0..self.count).map(move |i| self.start + f64::from(i) * step)
    }
}

/// FLIP of radiance: per pixel the largest [`ldr`] over the exposures, each shown through the ACES curve.
/// Not symmetric only in that the exposures come from one of the pictures.
pub fn hdr(a: &[Vec3], b: &[Vec3], width: usize, exposures: Exposures) -> Vec<f32> {
    let mut worst = vec![0.0f32; a.len()];
    for stop in exposures.stops() {
        let gain = stop.exp2();
        let shown = |image: &[Vec3]| -> Vec<Vec3> { image.par_iter().map(|c| aces(*c, gain)).collect() };
        let map = ldr(&shown(a), &shown(b), width);
        worst.iter_mut().zip(map).for_each(|(w, e)| *w = w.max(e));
    }
    worst
}

/// The ACES curve (k0·x² + k1·x) / (k2·x² + k3·x + k4): Narkowicz's fit with its exposure of 0.6 inside.
const ACES: [f64; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

fn aces(color: Vec3, gain: f64) -> Vec3 {
    let [k0, k1, k2, k3, k4] = ACES;
    let curve = |x: f64| (x * (k0 * x + k1)) / (x * (k2 * x + k3) + k4);
    let shown = (color.as_dvec3().max(DVec3::ZERO) * gain).map(curve);
    shown.min(DVec3::ONE).as_vec3()
}

/// What of a picture is compared.
struct Seen {
    /// Hunt-adjusted L*a*b* of the blurred picture.
    lab: Vec<Vec3>,
    /// Strength of edges.
    edge: Vec<f32>,
    /// Strength of points and lines.
    point: Vec<f32>,
}

impl Seen {
    fn new(linear: &[Vec3], width: usize) -> Seen {
        let white = XYZ_FROM_RGB * Vec3::ONE;
        let opponent: Vec<Vec3> = linear
            .par_iter()
            .map(|c| {
                let n = XYZ_FROM_RGB * c.clamp(Vec3::ZERO, Vec3::ONE) / white;
                Vec3::new(116.0 * n.y - 16.0, 500.0 * (n.x - n.y), 200.0 * (n.y - n.z))
            })
            .collect();
        let planes = [0, 1, 2].map(|i| opponent.iter().map(|c| c[i]).collect::<Vec<f32>>());
        let [y, cx, cz] = [0, 1, 2].map(|i| blur(&planes[i], width, SENSITIVITY[i]));
        let rgb_from_xyz = XYZ_FROM_RGB.inverse();
        let pixels = y.par_iter().zip(&cx).zip(&cz);
        let lab = pixels.map(|((y, cx), cz)| {
            let n = (y + 16.0) / 116.0;
            let xyz = Vec3::new(n + cx / 500.0, n, n - cz / 200.0) * white;
            hunt_lab((rgb_from_xyz * xyz).clamp(Vec3::ZERO, Vec3::ONE))
        });
        let lab = lab.collect();
        let (edge, point) = features(&planes[0], width);
        Seen { lab, edge, point }
    }
}

/// L*a*b* of a linear colour, with a* and b* weakened in the dark as the eye does (the Hunt effect).
fn hunt_lab(linear: Vec3) -> Vec3 {
    const D: f32 = 6.0 / 29.0;
    let n = XYZ_FROM_RGB * linear / (XYZ_FROM_RGB * Vec3::ONE);
    let f = n.map(|t| {
        if t > D * D * D {
            t.cbrt()
        } else {
            t / (3.0 * D * D) + 4.0 / 29.0
        }
    });
    let l = 116.0 * f.y - 16.0;
    Vec3::new(l, 0.01 * l * 500.0 * (f.x - f.y), 0.01 * l * 200.0 * (f.y - f.z))
}

/// Colour difference for large distances: city-block in lightness, Euclidean in chroma.
/// Source: Abasi et al., "Distance metrics for very large color differences", 2020.
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// Blurs by a sum of Gaussians. Each is separable; their weights make the two-dimensional kernel sum to 1.
fn blur(plane: &[f32], width: usize, gaussians: &[[f32; 2]]) -> Vec<f32> {
    // All channels are cut off at three standard deviations of the widest Gaussian, b = 0.04.
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let mut parts = Vec::new();
    let mut total = 0.0;
    for [a, b] in gaussians {
        let degrees = |i: i32| i as f32 / PIXELS_PER_DEGREE;
        let mut kernel: Vec<f32> = (-radius..=radius)
            .map(|i| (-PI * PI * degrees(i).powi(2) / b).exp())
            .collect();
        let sum: f32 = kernel.iter().sum();
        kernel.iter_mut().for_each(|k| *k /= sum);
        let weight = a * (PI / b).sqrt() * sum * sum;
        total += weight;
        parts.push((kernel, weight));
    }
    let mut out = vec![0.0; plane.len()];
    for (kernel, weight) in parts {
        let blurred = columns(&rows(plane, width, &kernel), width, &kernel);
        let share = weight / total;
        out.iter_mut().zip(blurred).for_each(|(o, v)| *o += share * v);
    }
    out
}

/// Strengths of edges and of points: lengths of the gradient and of the second derivatives of the luminance.
fn features(y: &[f32], width: usize) -> (Vec<f32>, Vec<f32>) {
    let normalized: Vec<f32> = y.iter().map(|v| (v + 16.0) / 116.0).collect();
    let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * sigma).ceil() as i32;
    let kernel = |shape: &dyn Fn(f32) -> f32| -> Vec<f32> {
        let values = (-radius..=radius).map(|i| i as f32 / sigma);
        let mut k: Vec<f32> = values.map(|x| shape(x) * (-0.5 * x * x).exp()).collect();
        // Positive and negative weights are brought to a sum of 1 each, so that flat areas give exactly nothing.
        let positive: f32 = k.iter().filter(|v| **v > 0.0).sum();
        let negative: f32 = -k.iter().filter(|v| **v < 0.0).sum::<f32>();
        k.iter_mut().for_each(|v| {
            *v /= if *v > 0.0 {
                positive
            } else {
                negative.max(f32::MIN_POSITIVE)
            }
        });
        k
    };
    let smooth = kernel(&|_| 1.0);
    let first = kernel(&|x| -x);
    let second = kernel(&|x| x * x - 1.0);
    let flat = rows(&normalized, width, &smooth);
    let length = |derivative: &[f32]| -> Vec<f32> {
        let dx = columns(&rows(&normalized, width, derivative), width, &smooth);
        let dy = columns(&flat, width, derivative);
        dx.iter().zip(dy).map(|(x, y)| x.hypot(y)).collect()
    };
    (length(&first), length(&second))
}

/// Filters each row by a kernel of odd length; pixels past the border are those at the border.
fn rows(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; plane.len()];
    let radius = kernel.len() / 2;
    let rows = out.par_chunks_mut(width.max(1)).zip(plane.par_chunks(width.max(1)));
    rows.for_each(|(out, row)| {
        let [first, last] = [row.first(), row.last()].map(|v| v.copied().unwrap_or(0.0));
        let mut padded = vec![first; radius];
        padded.extend_from_slice(row);
        padded.resize(row.len() + 2 * radius, last);
        for (k, shifted) in kernel.iter().zip(padded.windows(row.len())) {
            out.iter_mut().zip(shifted).for_each(|(o, v)| *o += k * v);
        }
    });
    out
}

/// The same for each column.
fn columns(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; plane.len()];
    let radius = kernel.len() / 2;
    let sources: Vec<&[f32]> = plane.chunks(width.max(1)).collect();
    out.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, out)| {
        for (i, k) in kernel.iter().enumerate() {
            let row = (y + i).saturating_sub(radius).min(sources.len() - 1);
            out.iter_mut().zip(sources[row]).for_each(|(o, v)| *o += k * v);
        }
    });
    out
}

#[cfg(test)]
mod tests;
