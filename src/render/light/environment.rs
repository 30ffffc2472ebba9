//! Light from infinitely far away: the same from everywhere, or an equirectangular image.

use super::choice::{extend, remap};
use super::{Aim, Receiver};
use crate::math::color::luminance;
use crate::math::frame::Frame;
use crate::math::portable::{self, sin_cos_turns};
use crate::math::warp::{INV_PI, cosine_hemisphere, uniform_sphere};
use crate::render::ray::PrimRef;
use glam::{DMat3, Mat3, Vec2, Vec3};

/// Light from infinitely far away.
#[derive(Clone, Debug)]
pub enum EnvironmentLight {
    /// The same radiance from everywhere; sampled by the cosine about the receiver's normal, or uniformly without one.
    Constant(Vec3),
    /// Radiance by direction, sampled by its luminance.
    Image(EnvironmentImage),
}

impl EnvironmentLight {
    /// Radiance that arrives along the unit direction `wi` (pointing away from the scene).
    pub fn radiance(&self, wi: Vec3) -> Vec3 {
        match self {
            EnvironmentLight::Constant(radiance) => *radiance,
            EnvironmentLight::Image(image) => image.radiance_at(image.place(wi)),
        }
    }

    /// Mean luminance over the sphere of directions.
    pub(crate) fn mean_luminance(&self) -> f64 {
        match self {
            EnvironmentLight::Constant(radiance) => f64::from(luminance(*radiance)),
            EnvironmentLight::Image(image) => image.total / (4.0 * std::f64::consts::PI),
        }
    }

    pub(crate) fn sample(&self, at: &Receiver, u: Vec2) -> Option<Aim> {
        let (wi, radiance, pdf) = match self {
            EnvironmentLight::Constant(radiance) => {
                let wi = match at.one_sided_normal() {
                    Some(n) => Frame::from_normal(n).to_world(cosine_hemisphere(u)),
                    None => uniform_sphere(u),
                };
                (wi, *radiance, self.pdf(at, wi))
            }
            EnvironmentLight::Image(image) => {
                let wi = image.sample(u)?;
                // Density and radiance of the direction as it was rounded: they agree with `pdf` and `radiance`
                // also at the borders of cells.
                let place = image.place(wi);
                (wi, image.radiance_at(place), image.pdf_at(place))
            }
        };
        (pdf > 0.0 && pdf.is_finite()).then_some(Aim {
            wi,
            wi_low: Vec3::ZERO,
            radiance,
            pdf,
            t_max: f32::INFINITY,
            distance: f32::INFINITY,
            slant: 1.0,
            to: PrimRef::NONE,
            b: Vec2::ZERO,
            textured: false,
            casts_shadow: true,
        })
    }

    pub(crate) fn pdf(&self, at: &Receiver, wi: Vec3) -> f32 {
        match self {
            EnvironmentLight::Constant(_) => match at.one_sided_normal() {
                Some(n) => n.dot(wi).max(0.0) * INV_PI,
                None => 0.25 * INV_PI,
            },
            EnvironmentLight::Image(image) => image.pdf_at(image.place(wi)),
        }
    }
}

/// An equirectangular image around the scene, interpolated bilinearly (columns wrap, rows end at the poles).
///
/// Importance is kept for the cells *between* texel centres: inside one the interpolation involves exactly its four
/// corners, so a cell is dark only if its light is. Directions are uniform in solid angle within a cell, so the density
/// is constant there and has no pole. The rows above the first and below the last centres are caps of half height.
#[derive(Clone, Debug)]
pub struct EnvironmentImage {
    width: u32,
    height: u32,
    /// Radiance, rows from the top.
    texels: Vec<[f32; 3]>,
    image_from_world: Mat3,
    /// +1 if the centre column is towards +z, −1 if it is towards −z.
    forward: f32,
    /// cos of the polar angles that bound the `height + 1` rows of cells, from 1 to −1.
    row_cos: Vec<f64>,
    /// Cumulative probability of the rows, ending in 1.
    rows: Vec<f64>,
    /// Cumulative counts of the cells of each row: the probability of a cell in its row is its count over the last.
    columns: Vec<u32>,
    /// ∫ luminance dω.
    total: f64,
}

impl EnvironmentImage {
    /// An image of `width` × `height` radiances, row by row from the top left, turned into the world by the rotation
    /// `world_from_image`. The image's top is +y; its centre column is towards +z, or −z if `right_handed`, and seen
    /// from inside columns grow to the right. Values that are negative or not finite count as 0.
    /// `None` if the size is 0, does not fit the data, or exceeds 2³⁰ in either direction.
    pub fn new(
        width: u32,
        height: u32,
        mut texels: Vec<[f32; 3]>,
        world_from_image: DMat3,
        right_handed: bool,
    ) -> Option<EnvironmentImage> {
        let count = (width as usize).checked_mul(height as usize)?;
        if count == 0 || count != texels.len() || width.max(height) > 1 << 30 {
            return None;
        }
        for v in texels.iter_mut().flatten() {
            if !(*v >= 0.0 && v.is_finite()) {
                *v = 0.0;
            }
        }
        let mut image = EnvironmentImage {
            width,
            height,
            texels,
            image_from_world: world_from_image.transpose().as_mat3(),
            forward: if right_handed { -1.0 } else { 1.0 },
            row_cos: Vec::new(),
            rows: Vec::new(),
            columns: Vec::new(),
            total: 0.0,
        };
        image.tabulate();
        Some(image)
    }

    fn tabulate(&mut self) {
        let (w, h) = (self.width as usize, self.height as usize);
        self.row_cos = (0..=h + 1)
            .map(|j| match j {
                0 => 1.0,
                j if j == h + 1 => -1.0,
                j => portable::cos_f64(std::f64::consts::PI * (j as f64 - 0.5) / h as f64),
            })
            .collect();
        self.columns = Vec::with_capacity(w * (h + 1));
        let mut row_sums = Vec::with_capacity(h + 1);
        let mut weights = vec![0.0; w];
        for j in 0..=h {
            let (above, below) = (j.saturating_sub(1), j.min(h - 1));
            let mean = |i: usize| {
                let l = |x: usize, y: usize| f64::from(luminance(Vec3::from(self.texels[y * w + x])));
                let next = if i + 1 == w { 0 } else { i + 1 };
                0.25 * (l(i, above) + l(next, above) + l(i, below) + l(next, below))
            };
            for (i, weight) in weights.iter_mut().enumerate() {
                *weight = mean(i);
            }
            append_counts(&weights, &mut self.columns);
            let solid_angle = std::f64::consts::TAU * (self.row_cos[j] - self.row_cos[j + 1]) / w as f64;
            row_sums.push(weights.iter().sum::<f64>() * solid_angle);
        }
        self.total = row_sums.iter().sum();
        let mut sum = 0.0;
        self.rows = row_sums
            .iter()
            .map(|s| {
                sum += s;
                if self.total > 0.0 {
                    (sum / self.total).min(1.0)
                } else {
                    0.0
                }
            })
            .collect();
        // The last row with light ends at 1 exactly, and those below it stay empty.
        if let Some(last) = row_sums.iter().rposition(|&s| s > 0.0) {
            self.rows[last..].fill(1.0);
        }
    }

    /// Column (in texels from the centre of the first, in [0, width)) and row (from the top, in [0, height]) of a
    /// world direction.
    fn place(&self, wi: Vec3) -> (f32, f32) {
        let d = self.image_from_world * wi;
        let across = (d.x * d.x + d.z * d.z).sqrt();
        let azimuth = portable::atan2(d.x, d.z * self.forward) * (0.5 * INV_PI);
        let w = self.width as f32;
        let mut s = (azimuth + 0.5) * w - 0.5;
        if s < 0.0 {
            s += w;
        }
        if s >= w {
            s -= w;
        }
        (s.max(0.0), portable::atan2(across, d.y) * INV_PI * self.height as f32)
    }

    /// The cell at a place.
    fn cell(&self, (s, t): (f32, f32)) -> (usize, usize) {
        let i = (s as usize).min(self.width as usize - 1);
        let j = ((t + 0.5) as usize).min(self.height as usize);
        (i, j)
    }

    fn radiance_at(&self, place: (f32, f32)) -> Vec3 {
        let (i, j) = self.cell(place);
        let (w, h) = (self.width as usize, self.height as usize);
        let next = if i + 1 == w { 0 } else { i + 1 };
        let (above, below) = (j.saturating_sub(1), j.min(h - 1));
        let texel = |x: usize, y: usize| Vec3::from(self.texels[y * w + x]);
        let x = place.0 - i as f32;
        let y = place.1 + 0.5 - j as f32;
        texel(i, above)
            .lerp(texel(next, above), x)
            .lerp(texel(i, below).lerp(texel(next, below), x), y)
    }

    /// A direction by importance; `None` if all is dark.
    fn sample(&self, u: Vec2) -> Option<Vec3> {
        if self.total <= 0.0 {
            return None;
        }
        // 24 random bits are few for the many cells of a row: each coordinate borrows its low bits from the other.
        let (ux, uy) = (extend(u.x, u.y.to_bits()), extend(u.y, u.x.to_bits() ^ 0x5bd1_e995));
        let j = self.rows.partition_point(|&c| c <= uy).min(self.height as usize);
        let before = if j == 0 { 0.0 } else { self.rows[j - 1] };
        let v = remap(uy, before, self.rows[j]);
        let counts = self.row_counts(j);
        let all = f64::from(*counts.last()?);
        let target = ux * all;
        let i = counts
            .partition_point(|&c| f64::from(c) <= target)
            .min(counts.len() - 1);
        let before = if i == 0 { 0.0 } else { f64::from(counts[i - 1]) };
        let x = remap(target, before, f64::from(counts[i]));
        // Uniform in solid angle within the cell.
        let cos = self.row_cos[j] + (self.row_cos[j + 1] - self.row_cos[j]) * v;
        let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt() as f32;
        let turns = ((i as f64 + x + 0.5) / f64::from(self.width)).fract();
        // The azimuth counts from the centre column: half a turn off.
        let (s, c) = sin_cos_turns(turns as f32);
        let d = Vec3::new(-s * sin, cos as f32, -c * sin * self.forward);
        Some(self.image_from_world.transpose() * d)
    }

    fn row_counts(&self, j: usize) -> &[u32] {
        let w = self.width as usize;
        &self.columns[j * w..(j + 1) * w]
    }

    fn pdf_at(&self, place: (f32, f32)) -> f32 {
        let (i, j) = self.cell(place);
        let counts = self.row_counts(j);
        let all = counts.last().copied().unwrap_or(0);
        if all == 0 {
            return 0.0;
        }
        let before = if i == 0 { 0 } else { counts[i - 1] };
        let in_row = f64::from(counts[i] - before) / f64::from(all);
        let row = self.rows[j] - if j == 0 { 0.0 } else { self.rows[j - 1] };
        let solid_angle = std::f64::consts::TAU * (self.row_cos[j] - self.row_cos[j + 1]) / f64::from(self.width);
        (row * in_row / solid_angle) as f32
    }

    /// From the image's axes to the world.
    pub fn world_from_image(&self) -> Mat3 {
        self.image_from_world.transpose()
    }
}

/// Appends cumulative counts proportional to `weights`, such that the probabilities that are used are exactly those
/// that are stated: at least 1 where a weight is positive, 0 where it is 0.
fn append_counts(weights: &[f64], out: &mut Vec<u32>) {
    let total: f64 = weights.iter().sum();
    let room = f64::from(u32::MAX) - weights.len() as f64;
    let (mut sum, mut lit, mut last) = (0.0, 0u32, 0u32);
    for &weight in weights {
        if weight > 0.0 {
            sum += weight;
            lit += 1;
            last = (sum / total * room).min(room) as u32 + lit;
        }
        out.push(last);
    }
}
