//! How much light rough interfaces return after one scattering: tables by view cosine, roughness and index.
//!
//! What single scattering loses, light that meets several facets carries: the lobes add it back with these numbers
//! (Kulla & Conty, Revisiting Physically Based Shading at Imageworks, 2017), so that white surfaces stay white.
//! The tables are computed once, on first use, by a fixed quadrature over visible normals, the same on every machine.
//! Axes are stretched to where the functions bend: t with cosθ = t², roughness = √α, z = (η−1)/(η+1) of the index.

use super::fresnel::{fresnel_dielectric, reflect, refract, schlick_weight};
use super::microfacet::{ALPHA_DELTA, Ggx};
use crate::math::robust::{ONE_MINUS, sqrt_of_nonnegative};
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Nodes along the view axis and along the roughness axis.
const VIEWS: usize = 24;
const ALPHAS: usize = 16;
/// Nodes along the axis of indices of the coat's and of the solid's table.
const INDICES: usize = 12;
/// Visible normals per entry.
const NORMALS: usize = 128;

/// Where a value lies between the `n` nodes of an axis over [0, 1]; values outside and NaN meet the ends.
fn locate(x: f32, n: usize) -> (usize, f32) {
    let s = x.max(0.0).min(1.0) * (n - 1) as f32;
    let i = (s as usize).min(n - 2);
    (i, s - i as f32)
}

fn lerp(a: f32, b: f32, w: f32) -> f32 {
    a + w * (b - a)
}

/// A function of (view cosine, α), and its cosine-weighted mean over views at each α.
struct Plane {
    values: [[f32; VIEWS]; ALPHAS],
    means: [f32; ALPHAS],
}

impl Plane {
    fn new(values: [[f32; VIEWS]; ALPHAS]) -> Plane {
        let means = values.map(|row| mean_over_views(&row));
        Plane { values, means }
    }

    fn at(&self, cos: f32, alpha: f32) -> f32 {
        let (i, w) = locate(cos.max(0.0).sqrt(), VIEWS);
        let (j, v) = locate(alpha.max(0.0).sqrt(), ALPHAS);
        let (low, high) = (&self.values[j], &self.values[j + 1]);
        lerp(lerp(low[i], low[i + 1], w), lerp(high[i], high[i + 1], w), v)
    }

    fn mean(&self, alpha: f32) -> f32 {
        let (j, v) = locate(alpha.max(0.0).sqrt(), ALPHAS);
        lerp(self.means[j], self.means[j + 1], v)
    }
}

/// 2·∫E(cosθ)·cosθ d cosθ of the interpolated table, exactly: cosθ = t² makes it ∫E(t)·4t³ dt, E linear between nodes.
fn mean_over_views(row: &[f32; VIEWS]) -> f32 {
    let n = (VIEWS - 1) as f64;
    let mut sum = 0.0;
    for (i, pair) in row.windows(2).enumerate() {
        let (a, b) = (i as f64 / n, (i + 1) as f64 / n);
        let slope = f64::from(pair[1] - pair[0]) * n;
        let offset = f64::from(pair[0]) - slope * a;
        sum += offset * (b.powi(4) - a.powi(4)) + slope * 0.8 * (b.powi(5) - a.powi(5));
    }
    sum as f32
}

/// The view direction and the facets of one entry.
fn entry(view: usize, alpha: usize) -> (Vec3, Ggx) {
    let t = view as f32 / (VIEWS - 1) as f32;
    let cos = (t * t).max(1e-6); // the limit at grazing
    let r = alpha as f32 / (ALPHAS - 1) as f32;
    let a = (r * r).max(ALPHA_DELTA);
    (
        Vec3::new(sqrt_of_nonnegative(1.0 - cos * cos), 0.0, cos),
        Ggx { ax: a, ay: a },
    )
}

/// Calls `f` with each visible normal; half a turn suffices by symmetry. Source of the points: Roberts' R2 sequence.
fn for_visible_normals(wo: Vec3, ggx: Ggx, mut f: impl FnMut(Vec3)) {
    for i in 0..NORMALS {
        let i = i as f64;
        let u = (0.5 + 0.754_877_666_246_692_8 * i).fract() * 0.5;
        let v = (0.5 + 0.569_840_290_998_053_2 * i).fract();
        f(ggx.sample_visible(wo, Vec2::new(u as f32, (v as f32).min(ONE_MINUS))));
    }
}

/// G2/G1(wo) of a scattered direction: the weight of a visible-normal sample before its reflectance.
fn weight(ggx: Ggx, wo: Vec3, wi: Vec3) -> f32 {
    let g1_over_cos = ggx.g1_over_cosine(wo);
    if g1_over_cos > 0.0 {
        ggx.g2_over_cosines(wo, wi) * wi.z.abs() / g1_over_cos
    } else {
        0.0
    }
}

/// Split by Schlick: E = f0·base + f90·edge.
struct SchlickTables {
    base: Plane,
    edge: Plane,
}

static SCHLICK: LazyLock<SchlickTables> = LazyLock::new(|| {
    let mut base = [[0.0; VIEWS]; ALPHAS];
    let mut edge = [[0.0; VIEWS]; ALPHAS];
    for j in 0..ALPHAS {
        for i in 0..VIEWS {
            let (wo, ggx) = entry(i, j);
            let (mut b, mut e) = (0.0, 0.0);
            for_visible_normals(wo, ggx, |m| {
                let wi = reflect(wo, m);
                if wi.z > 0.0 {
                    let w = weight(ggx, wo, wi);
                    let s = schlick_weight(wo.dot(m));
                    b += w * (1.0 - s);
                    e += w * s;
                }
            });
            base[j][i] = b / NORMALS as f32;
            edge[j][i] = e / NORMALS as f32;
        }
    }
    SchlickTables {
        base: Plane::new(base),
        edge: Plane::new(edge),
    }
});

/// Albedo (base, edge) of rough mirror facets under Schlick's curve: E = f0·base + f90·edge. base + edge is the albedo
/// of facets that reflect all.
pub fn schlick_albedo(cos: f32, alpha: f32) -> (f32, f32) {
    let t = &*SCHLICK;
    (t.base.at(cos, alpha), t.edge.at(cos, alpha))
}

/// Cosine-weighted means over views of [`schlick_albedo`].
pub fn schlick_mean(alpha: f32) -> (f32, f32) {
    let t = &*SCHLICK;
    (t.base.mean(alpha), t.edge.mean(alpha))
}

/// Planes along the axis of indices, z = (η−1)/(η+1) from 0 to 1.
fn indexed(f: impl Fn(Vec3, Ggx, &[f32; INDICES], &mut [f32; INDICES])) -> Vec<Plane> {
    let mut etas = [1.0; INDICES];
    for (k, eta) in etas.iter_mut().enumerate() {
        let z = k as f32 / (INDICES - 1) as f32;
        *eta = (1.0 + z) / (1.0 - z); // 1 … ∞
    }
    let mut values = vec![[[0.0; VIEWS]; ALPHAS]; INDICES];
    for j in 0..ALPHAS {
        for i in 0..VIEWS {
            let (wo, ggx) = entry(i, j);
            let mut sums = [0.0; INDICES];
            f(wo, ggx, &etas, &mut sums);
            for (plane, sum) in values.iter_mut().zip(sums) {
                plane[j][i] = sum / NORMALS as f32;
            }
        }
    }
    values.into_iter().map(Plane::new).collect()
}

/// z of an index ≥ 1.
fn index_axis(eta: f32) -> f32 {
    if eta.is_finite() {
        (eta - 1.0) / (eta + 1.0)
    } else {
        1.0
    }
}

fn at_index(planes: &[Plane], eta: f32, f: impl Fn(&Plane) -> f32) -> f32 {
    let (k, w) = locate(index_axis(eta), INDICES);
    match planes.get(k..k + 2) {
        Some([a, b]) => lerp(f(a), f(b), w),
        _ => 0.0,
    }
}

/// Reflection of rough dielectric facets seen from outside.
static COAT: LazyLock<Vec<Plane>> = LazyLock::new(|| {
    indexed(|wo, ggx, etas, sums| {
        for_visible_normals(wo, ggx, |m| {
            let wi = reflect(wo, m);
            if wi.z > 0.0 {
                let w = weight(ggx, wo, wi);
                for (sum, &eta) in sums.iter_mut().zip(etas) {
                    *sum += w * fresnel_dielectric(wo.dot(m).max(0.0), eta);
                }
            }
        });
    })
});

/// Albedo of the reflection of a rough dielectric of index `eta` ≥ 1 (relative, seen from the thinner side).
pub fn coat_albedo(cos: f32, alpha: f32, eta: f32) -> f32 {
    at_index(&COAT, eta, |p| p.at(cos, alpha))
}

/// Cosine-weighted mean over views of [`coat_albedo`].
pub fn coat_mean(alpha: f32, eta: f32) -> f32 {
    at_index(&COAT, eta, |p| p.mean(alpha))
}

/// Reflection plus transmission (as flux) of rough dielectric facets: entering the denser side, and leaving it.
struct SolidTables {
    entering: Vec<Plane>,
    leaving: Vec<Plane>,
}

fn solid_albedo_sum(wo: Vec3, ggx: Ggx, eta: f32, m: Vec3) -> f32 {
    let r = fresnel_dielectric(wo.dot(m).max(0.0), eta);
    let wi = reflect(wo, m);
    let mut sum = if wi.z > 0.0 { r * weight(ggx, wo, wi) } else { 0.0 };
    if let Some(wi) = refract(wo, m, eta).filter(|wi| wi.z < 0.0) {
        sum += (1.0 - r) * weight(ggx, wo, wi);
    }
    sum
}

static SOLID: LazyLock<SolidTables> = LazyLock::new(|| {
    let table = |leaving: bool| {
        indexed(|wo, ggx, etas, sums| {
            for_visible_normals(wo, ggx, |m| {
                for (sum, &eta) in sums.iter_mut().zip(etas) {
                    *sum += solid_albedo_sum(wo, ggx, if leaving { 1.0 / eta } else { eta }, m);
                }
            });
        })
    };
    SolidTables {
        entering: table(false),
        leaving: table(true),
    }
});

fn solid_planes(eta: f32) -> (&'static [Plane], f32) {
    if eta >= 1.0 {
        (&SOLID.entering, eta)
    } else {
        (&SOLID.leaving, 1.0 / eta)
    }
}

/// Reflected plus transmitted share of light at a rough dielectric boundary; `eta` = n_t/n_i seen from this side.
pub fn solid_albedo(cos: f32, alpha: f32, eta: f32) -> f32 {
    let (planes, index) = solid_planes(eta);
    at_index(planes, index, |p| p.at(cos, alpha))
}

/// Cosine-weighted mean over views of [`solid_albedo`].
pub fn solid_mean(alpha: f32, eta: f32) -> f32 {
    let (planes, index) = solid_planes(eta);
    at_index(planes, index, |p| p.mean(alpha))
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
    let (k, w) = locate(index_axis(eta), NODES);
    lerp(MEANS[k], MEANS[k + 1], w)
}
