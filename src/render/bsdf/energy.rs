//! How much light rough interfaces return after one scattering: tables by view cosine, roughness and index.
//!
//! What single scattering loses, light that meets several facets carries: the lobes add it back with these numbers
//! (Kulla & Conty, Revisiting Physically Based Shading at Imageworks, 2017), so that white surfaces stay white.
//! The tables are computed once, on first use, by a fixed quadrature over visible normals, the same on every machine.
//! Axes are stretched to where the functions bend: t with cosθ = t², roughness = √α, q with q² = (η−1)/(η+1).

use super::fresnel::fresnel_dielectric;
use super::microfacet::{ALPHA_DELTA, Ggx};
use super::unit;
use crate::math::robust::sqrt_of_nonnegative;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

mod brushed;
mod white;

pub use brushed::{facets_albedo, facets_mean};
pub use white::{schlick_albedo, schlick_mean};

/// Nodes along the axis of indices.
const INDICES: usize = 12;
/// Nodes along the view axis and the roughness axis of white mirror facets …
const FINE: usize = 32;
/// … and of coats and solids, of which only the difference to those is tabulated.
const COARSE: usize = 22;
/// Visible normals per entry.
const NORMALS: usize = 144;

/// Where a value lies between the `n` nodes of an axis over [0, 1]; values outside and NaN meet the ends.
pub(super) fn locate(x: f32, n: usize) -> (usize, f32) {
    let s = unit(x) * (n - 1) as f32;
    let i = (s as usize).min(n - 2);
    (i, s - i as f32)
}

/// [`locate`] on the roughness axis. Before the first node values follow α itself, not its root.
fn locate_width(alpha: f32, n: usize) -> (usize, f32) {
    let (j, v) = locate(unit(alpha).sqrt(), n);
    (j, if j == 0 { v * v } else { v })
}

fn lerp(a: f32, b: f32, w: f32) -> f32 {
    a + w * (b - a)
}

/// A function of (view cosine, α), and its cosine-weighted mean over views at each α.
struct Plane<const N: usize> {
    values: [[f32; N]; N],
    means: [f32; N],
}

impl<const N: usize> Plane<N> {
    fn new(values: [[f32; N]; N]) -> Plane<N> {
        let means = values.map(|row| mean_over_views(&row));
        Plane { values, means }
    }

    /// The plane of `f` of each value.
    fn changed(&self, f: impl Fn(Vec3, Ggx, f32) -> f32) -> Plane<N> {
        let mut values = self.values;
        for (j, row) in values.iter_mut().enumerate() {
            for (i, value) in row.iter_mut().enumerate() {
                let (wo, ggx) = entry::<N>(i, j);
                *value = f(wo, ggx, *value);
            }
        }
        Plane::new(values)
    }

    fn at(&self, cos: f32, alpha: f32) -> f32 {
        let (i, w) = locate(cos.max(0.0).sqrt(), N);
        let (j, v) = locate_width(alpha, N);
        let (low, high) = (&self.values[j], &self.values[j + 1]);
        lerp(lerp(low[i], low[i + 1], w), lerp(high[i], high[i + 1], w), v)
    }

    fn mean(&self, alpha: f32) -> f32 {
        mean_at(&self.means, alpha)
    }
}

fn mean_at<const N: usize>(means: &[f32; N], alpha: f32) -> f32 {
    let (j, v) = locate_width(alpha, N);
    lerp(means[j], means[j + 1], v)
}

/// 2·∫E(cosθ)·cosθ d cosθ of the interpolated table, exactly: cosθ = t² makes it ∫E(t)·4t³ dt, E linear between nodes.
fn mean_over_views<const N: usize>(row: &[f32; N]) -> f32 {
    let n = (N - 1) as f64;
    let mut sum = 0.0;
    for (i, pair) in row.windows(2).enumerate() {
        let (a, b) = (i as f64 / n, (i + 1) as f64 / n);
        let slope = f64::from(pair[1] - pair[0]) * n;
        let offset = f64::from(pair[0]) - slope * a;
        let (a4, b4) = (a * a * a * a, b * b * b * b);
        sum += offset * (b4 - a4) + slope * 0.8 * (b4 * b - a4 * a);
    }
    sum as f32
}

/// Cosine that stands for the limit at grazing in tables, where the formulas themselves are 0/0.
const GRAZING: f32 = 1e-6;

/// The view direction and the facets of one entry.
fn entry<const N: usize>(view: usize, alpha: usize) -> (Vec3, Ggx) {
    let t = view as f32 / (N - 1) as f32;
    let cos = (t * t).max(GRAZING);
    let r = alpha as f32 / (N - 1) as f32;
    let a = (r * r).max(ALPHA_DELTA);
    (
        Vec3::new(sqrt_of_nonnegative(1.0 - cos * cos), 0.0, cos),
        Ggx { ax: a, ay: a },
    )
}

/// Calls `f` with visible normals and their weights, which add up to 1. Even steps along the polar axis, but denser in
/// the tail (v = 1 − (1 − s)³), whose few facets lose the light; golden-ratio steps in azimuth, of which half a turn
/// suffices by symmetry.
fn for_visible_normals(wo: Vec3, ggx: Ggx, mut f: impl FnMut(Vec3, f32)) {
    for i in 0..NORMALS {
        let u = (0.5 + 0.618_033_988_749_894_9 * i as f64).fract() * 0.5;
        let rest = 1.0 - (i as f32 + 0.5) / NORMALS as f32;
        let v = 1.0 - rest * rest * rest;
        f(
            ggx.sample_visible(wo, Vec2::new(u as f32, v)),
            3.0 * rest * rest / NORMALS as f32,
        );
    }
}

/// G2/G1(wo) of a direction scattered by isotropic facets: the weight of a visible-normal sample before its reflectance.
/// Only its cosine matters; zero unless positive.
fn weight(ggx: Ggx, cos_o: f32, cos_i: f32) -> f32 {
    if cos_i <= 0.0 {
        return 0.0;
    }
    let a2 = ggx.ax * ggx.ax;
    let stretched = |c: f32| (a2 + (1.0 - a2) * c * c).sqrt();
    let (so, si) = (stretched(cos_o), stretched(cos_i));
    cos_i * (cos_o + so) / (cos_o * si + cos_i * so)
}

/// Cosine of the mirror direction of `wo` at a facet.
fn mirrored_cosine(wo: Vec3, m: Vec3) -> f32 {
    2.0 * wo.dot(m) * m.z - wo.z
}

/// An index at each node of its axis: q from 0 to 1 with q² = (η−1)/(η+1), which is 1 … ∞.
fn index_nodes() -> [f32; INDICES] {
    std::array::from_fn(|k| {
        let q = k as f32 / (INDICES - 1) as f32;
        (1.0 + q * q) / (1.0 - q * q)
    })
}

/// Planes at the nodes of the axis of indices; `f` says what a visible normal returns at each.
fn indexed<const N: usize>(f: impl Fn(Vec3, Ggx, Vec3, &[f32; INDICES]) -> [f32; INDICES]) -> Vec<Plane<N>> {
    let etas = index_nodes();
    let mut values = vec![[[0.0; N]; N]; INDICES];
    for j in 0..N {
        for i in 0..N {
            let (wo, ggx) = entry::<N>(i, j);
            let mut sums = [0.0; INDICES];
            for_visible_normals(wo, ggx, |m, share| {
                for (sum, value) in sums.iter_mut().zip(f(wo, ggx, m, &etas)) {
                    *sum += share * value;
                }
            });
            for (plane, sum) in values.iter_mut().zip(sums) {
                plane[j][i] = sum;
            }
        }
    }
    values.into_iter().map(Plane::new).collect()
}

/// (η−1)/(η+1) of an index ≥ 1.
fn index_ratio(eta: f32) -> f32 {
    if eta.is_finite() {
        ((eta - 1.0) / (eta + 1.0)).max(0.0)
    } else {
        1.0
    }
}

/// Interpolates between the planes around an index.
fn at_index<T>(planes: &[T], eta: f32, f: impl Fn(&T) -> f32) -> f32 {
    let (k, w) = locate(index_ratio(eta).sqrt(), INDICES);
    match planes.get(k..k + 2) {
        Some([a, b]) => lerp(f(a), f(b), w),
        _ => 0.0,
    }
}

/// What a coat reflects beyond [`typical_reflectance`] times white facets' albedo, and all it reflects.
struct CoatTables {
    beyond: Vec<Plane<COARSE>>,
    /// By index and α: the mean of all it reflects beyond white facets' mean times the smooth coat's mean.
    means_beyond: Vec<[f32; COARSE]>,
}

/// Reflectance at the mean cosine between view and visible facets, (cosθ + |stretched w|)/2. Times the albedo of white
/// facets it bends with the index as the coat's albedo does, so that little is left to be interpolated.
pub fn typical_reflectance(cos: f32, alpha: f32, eta: f32) -> f32 {
    fresnel_dielectric(typical_cosine(cos, alpha), eta)
}

/// Mean cosine between a view and the facets that it sees.
pub fn typical_cosine(cos: f32, alpha: f32) -> f32 {
    let stretched = (cos * cos + alpha * alpha * (1.0 - cos * cos)).max(0.0).sqrt();
    (0.5 * (cos + stretched)).min(1.0)
}

static COAT: LazyLock<CoatTables> = LazyLock::new(|| {
    let all = indexed::<COARSE>(|wo, ggx, m, etas| {
        let w = weight(ggx, wo.z, mirrored_cosine(wo, m));
        etas.map(|eta| w * fresnel_dielectric(wo.dot(m).max(0.0), eta))
    });
    let beyond = all.iter().zip(index_nodes()).map(|(plane, eta)| {
        plane.changed(|wo, ggx, value| {
            let (base, edge) = schlick_albedo(wo.z, ggx.ax);
            value - (base + edge) * typical_reflectance(wo.z, ggx.ax, eta)
        })
    });
    let beyond = beyond.collect();
    let means_beyond = all.iter().zip(index_nodes()).map(|(plane, eta)| {
        std::array::from_fn(|j| {
            let (_, ggx) = entry::<COARSE>(0, j);
            let (base, edge) = schlick_mean(ggx.ax);
            plane.means[j] - (base + edge) * fresnel_mean(eta)
        })
    });
    CoatTables {
        beyond,
        means_beyond: means_beyond.collect(),
    }
});

/// Albedo of the reflection of a rough dielectric of index `eta` ≥ 1 (relative, seen from the thinner side).
pub fn coat_albedo(cos: f32, alpha: f32, eta: f32) -> f32 {
    let (base, edge) = schlick_albedo(cos, alpha);
    (base + edge) * typical_reflectance(cos, alpha, eta) + at_index(&COAT.beyond, eta, |p| p.at(cos, alpha))
}

/// Cosine-weighted mean over views of [`coat_albedo`].
pub fn coat_mean(alpha: f32, eta: f32) -> f32 {
    let (base, edge) = schlick_mean(alpha);
    (base + edge) * fresnel_mean(eta) + at_index(&COAT.means_beyond, eta, |means| mean_at(means, alpha))
}

/// Reflection plus transmission (as flux) of rough dielectric facets beyond the albedo of white mirror facets, which
/// follows the steep loss at grazing views: entering the denser side, and leaving it.
struct SolidTables {
    entering: Vec<Plane<COARSE>>,
    leaving: Vec<Plane<COARSE>>,
}

static SOLID: LazyLock<SolidTables> = LazyLock::new(|| {
    let table = |leaving: bool| {
        let planes = indexed::<COARSE>(move |wo, ggx, m, etas| {
            let cos = wo.dot(m).max(0.0);
            let reflected = weight(ggx, wo.z, mirrored_cosine(wo, m));
            etas.map(|eta| {
                let eta = if leaving { 1.0 / eta } else { eta };
                let k = (eta - 1.0) * (eta + 1.0) + cos * cos;
                if !(k >= 0.0 && k.is_finite() && eta > 0.0) {
                    return reflected;
                }
                let r = fresnel_dielectric(cos, eta);
                let refracted = weight(ggx, wo.z, (wo.z - m.z * (cos - k.sqrt())) / eta);
                r * reflected + (1.0 - r) * refracted
            })
        });
        let beyond = planes.into_iter().map(|plane| {
            plane.changed(|wo, ggx, value| {
                let (base, edge) = schlick_albedo(wo.z, ggx.ax);
                value - base - edge
            })
        });
        beyond.collect()
    };
    SolidTables {
        entering: table(false),
        leaving: table(true),
    }
});

fn solid_planes(eta: f32) -> (&'static [Plane<COARSE>], f32) {
    if eta >= 1.0 {
        (&SOLID.entering, eta)
    } else {
        (&SOLID.leaving, 1.0 / eta)
    }
}

/// Reflected plus transmitted share of light at a rough dielectric boundary; `eta` = n_t/n_i seen from this side.
pub fn solid_albedo(cos: f32, alpha: f32, eta: f32) -> f32 {
    let (planes, index) = solid_planes(eta);
    let (base, edge) = schlick_albedo(cos, alpha);
    base + edge + at_index(planes, index, |p| p.at(cos, alpha))
}

/// Cosine-weighted mean over views of [`solid_albedo`].
pub fn solid_mean(alpha: f32, eta: f32) -> f32 {
    let (planes, index) = solid_planes(eta);
    let (base, edge) = schlick_mean(alpha);
    base + edge + at_index(planes, index, |p| p.mean(alpha))
}

/// Cosine-weighted mean reflectance of a smooth dielectric, 2·∫F(cosθ)·cosθ d cosθ, for `eta` ≥ 1.
pub fn fresnel_mean(eta: f32) -> f32 {
    const NODES: usize = 64;
    static MEANS: LazyLock<[f32; NODES]> = LazyLock::new(|| {
        std::array::from_fn(|k| {
            let z = k as f32 / (NODES - 1) as f32;
            let eta = (1.0 + z) / (1.0 - z);
            let n = 512; // midpoints in t with cosθ = t²
            let sum: f64 = (0..n)
                .map(|i| {
                    let t = (i as f32 + 0.5) / n as f32;
                    f64::from(fresnel_dielectric(t * t, eta) * 4.0 * t * t * t)
                })
                .sum();
            (sum / f64::from(n)) as f32
        })
    });
    let (k, w) = locate(index_ratio(eta), NODES);
    lerp(MEANS[k], MEANS[k + 1], w)
}
