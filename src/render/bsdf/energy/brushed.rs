//! What mirror facets of two widths return after one scattering.

use super::super::microfacet::{ALPHA_DELTA, Ggx};
use super::{GRAZING, NORMALS, lerp, locate, schlick_albedo, schlick_mean};
use crate::math::portable::{atan2, sin_cos_turns};
use crate::math::robust::sqrt_of_nonnegative;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Nodes along the root of the stretched cosine (see [`super::white`]), …
const VIEWS: usize = 24;
/// … along a quarter turn of the stretched view's azimuth, …
const TURNS: usize = 7;
/// … and along the root of either width.
const WIDTHS: usize = 12;
/// Nodes of the means along the root of either width: more, so that they are those of what lies between, too.
const MEANS: usize = 3 * (WIDTHS - 1) + 1;

/// Albedo of white facets by widths, azimuth and view; the second width is the narrower one.
struct Brushed {
    albedo: Vec<[[f32; VIEWS]; TURNS]>,
    means: Vec<f32>,
}

impl Brushed {
    /// Directions are those of the wider facets along x.
    fn at(&self, ggx: Ggx, w: Vec3) -> f32 {
        let (x, y) = (ggx.ax * w.x.abs(), ggx.ay * w.y.abs());
        let stretched = (x * x + y * y + w.z * w.z).sqrt();
        let cos = if stretched > 0.0 { w.z.abs() / stretched } else { 0.0 };
        let (i, wi) = locate(cos.sqrt(), VIEWS);
        let (j, wj) = locate(atan2(y, x) * std::f32::consts::FRAC_2_PI, TURNS);
        let of_widths = |k: usize, l: usize| {
            let table = &self.albedo[pair(k, l, WIDTHS)];
            let row = |j: usize| lerp(table[j][i], table[j][i + 1], wi);
            lerp(row(j), row(j + 1), wj)
        };
        by_widths(ggx, WIDTHS, of_widths)
    }

    fn mean(&self, ggx: Ggx) -> f32 {
        by_widths(ggx, MEANS, |k, l| self.means[pair(k, l, MEANS)])
    }
}

/// Place of a pair of widths in a square table.
fn pair(wide: usize, narrow: usize, n: usize) -> usize {
    wide * n + narrow
}

/// Interpolates between the four pairs of widths around these.
fn by_widths(ggx: Ggx, n: usize, at: impl Fn(usize, usize) -> f32) -> f32 {
    let ((k, wk), (l, wl)) = (locate(ggx.ax.sqrt(), n), locate(ggx.ay.sqrt(), n));
    let row = |k: usize| lerp(at(k, l), at(k, l + 1), wl);
    lerp(row(k), row(k + 1), wk)
}

/// The facets at nodes of the widths' axes.
fn facets(k: usize, l: usize, n: usize) -> Ggx {
    let width = |k: usize| {
        let r = k as f32 / (n - 1) as f32;
        (r * r).max(ALPHA_DELTA)
    };
    Ggx {
        ax: width(k),
        ay: width(l),
    }
}

/// What white facets return towards `wo`: visible normals in the steps of the other tables, over the whole turn.
fn returned(wo: Vec3, ggx: Ggx) -> f32 {
    let stretched = ggx.stretched(wo);
    let mut sum = 0.0;
    for i in 0..NORMALS {
        let u = (0.5 + 0.618_033_988_749_894_9 * i as f64).fract() as f32;
        let rest = 1.0 - (i as f32 + 0.5) / NORMALS as f32;
        let m = ggx.sample_visible(wo, Vec2::new(u, 1.0 - rest * rest * rest));
        let wi = super::super::fresnel::reflect(wo, m);
        if wi.z > 0.0 {
            sum += rest * rest * ggx.g2_over_cosine(wo, wi) * (wo.z + stretched);
        }
    }
    1.5 * sum / NORMALS as f32
}

static BRUSHED: LazyLock<Brushed> = LazyLock::new(|| {
    let mut albedo = vec![[[0.0; VIEWS]; TURNS]; WIDTHS * WIDTHS];
    for (k, l) in (0..WIDTHS).flat_map(|k| (0..WIDTHS).map(move |l| (k, l))) {
        let ggx = facets(k, l, WIDTHS);
        for (j, row) in albedo[pair(k, l, WIDTHS)].iter_mut().enumerate() {
            let (sin, cos) = sin_cos_turns(j as f32 / (TURNS - 1) as f32 * 0.25);
            for (i, value) in row.iter_mut().enumerate() {
                let t = i as f32 / (VIEWS - 1) as f32;
                let s = (t * t).max(GRAZING);
                let tan = sqrt_of_nonnegative((1.0 - s) * (1.0 + s)) / s;
                let w = Vec3::new(tan * cos / ggx.ax, tan * sin / ggx.ay, 1.0);
                *value = returned(w / w.length(), ggx);
            }
        }
    }
    let mut tables = Brushed { albedo, means: vec![] };
    let means = (0..MEANS * MEANS).map(|p| {
        let ggx = facets(p / MEANS, p % MEANS, MEANS);
        let (views, turns) = (48, 8); // midpoints in t with cosθ = t², and over a quarter turn
        let mut sum = 0.0;
        for i in 0..views * turns {
            let t = ((i / turns) as f32 + 0.5) / views as f32;
            let (sin, cos) = sin_cos_turns(((i % turns) as f32 + 0.5) / turns as f32 * 0.25);
            let across = sqrt_of_nonnegative(1.0 - t * t * t * t);
            let w = Vec3::new(across * cos, across * sin, t * t);
            sum += tables.at(ggx, w) * 4.0 * t * t * t;
        }
        sum / (views * turns) as f32
    });
    tables.means = means.collect();
    tables
});

/// [`schlick_albedo`] of facets of any widths, seen along `w`; the share of the edge is that of facets of the mean width.
pub fn facets_albedo(ggx: Ggx, w: Vec3) -> (f32, f32) {
    let (base, edge) = schlick_albedo(w.z.abs(), ggx.alpha());
    if ggx.ax == ggx.ay {
        return (base, edge);
    }
    of_white(BRUSHED.at(ggx, w), base, edge)
}

/// Cosine-weighted means over views of [`facets_albedo`].
pub fn facets_mean(ggx: Ggx) -> (f32, f32) {
    let (base, edge) = schlick_mean(ggx.alpha());
    if ggx.ax == ggx.ay {
        return (base, edge);
    }
    of_white(BRUSHED.mean(ggx), base, edge)
}

fn of_white(white: f32, base: f32, edge: f32) -> (f32, f32) {
    let scale = white / (base + edge);
    (base * scale, edge * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the same integral with many more normals, between the nodes. Its own error is below 0.001 (it agrees with the
    /// isotropic tables' test); the rest is linear interpolation.
    #[test]
    fn facets_of_two_widths_return_what_the_table_says() {
        let mut rng = crate::math::stats::Pcg::new(6);
        for _ in 0..300 {
            let mut width = || rng.next_f32().powi(2).max(ALPHA_DELTA);
            let ggx = Ggx {
                ax: width(),
                ay: width(),
            };
            let cos = rng.next_f32();
            let (sin, turn) = ((1.0 - cos * cos).sqrt(), rng.next_f32() * std::f32::consts::TAU);
            let w = Vec3::new(sin * turn.cos(), sin * turn.sin(), cos);
            let n = 20_000;
            let mut sum = 0.0f64;
            for i in 0..n {
                let u = Vec2::new((0.618_034 * f64::from(i)).fract() as f32, (i as f32 + 0.5) / n as f32);
                let wi = super::super::super::fresnel::reflect(w, ggx.sample_visible(w, u));
                let (f, pdf, _) = ggx.reflection(w, wi);
                sum += if pdf > 0.0 { f64::from(f / pdf) } else { 0.0 };
            }
            let (base, edge) = facets_albedo(ggx, w);
            let off = f64::from(base + edge) - sum / f64::from(n);
            assert!(off.abs() < 0.013, "{ggx:?} {w}: off by {off}");
        }
    }
}
