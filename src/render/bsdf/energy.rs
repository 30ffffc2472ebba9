//! How much light rough interfaces return after one scattering: tables by view cosine, roughness and index.
//!
//! What single scattering loses, light that meets several facets carries: the lobes add it back with these numbers
//! (Kulla & Conty, Revisiting Physically Based Shading at Imageworks, 2017), so that white surfaces stay white.
//! The tables are computed once, on first use, by a fixed quadrature over visible normals, the same on every machine.
//! Axes are stretched to where the functions bend: t with cosθ = t², roughness = √α, q with q² = (η−1)/(η+1).

use super::fresnel::{fresnel_dielectric, reflect, refract, schlick_weight};
use super::microfacet::{ALPHA_DELTA, Ggx};
use crate::math::robust::sqrt_of_nonnegative;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Nodes along the axis of indices.
const INDICES: usize = 16;
/// Nodes along the view axis and the roughness axis, and visible normals per entry: for mirror facets and coats …
const FINE: usize = 32;
const FINE_NORMALS: usize = 128;
/// … and for solids, which cost more to compute.
const COARSE: usize = 20;
const COARSE_NORMALS: usize = 96;

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
struct Plane<const N: usize> {
    values: [[f32; N]; N],
    means: [f32; N],
}

impl<const N: usize> Plane<N> {
    fn new(values: [[f32; N]; N]) -> Plane<N> {
        let means = values.map(|row| mean_over_views(&row));
        Plane { values, means }
    }

    fn at(&self, cos: f32, alpha: f32) -> f32 {
        let (i, w) = locate(cos.max(0.0).sqrt(), N);
        let (j, v) = locate(alpha.max(0.0).sqrt(), N);
        let (low, high) = (&self.values[j], &self.values[j + 1]);
        lerp(lerp(low[i], low[i + 1], w), lerp(high[i], high[i + 1], w), v)
    }

    fn mean(&self, alpha: f32) -> f32 {
        let (j, v) = locate(alpha.max(0.0).sqrt(), N);
        lerp(self.means[j], self.means[j + 1], v)
    }
}

/// 2·∫E(cosθ)·cosθ d cosθ of the interpolated table, exactly: cosθ = t² makes it ∫E(t)·4t³ dt, E linear between nodes.
fn mean_over_views<const N: usize>(row: &[f32; N]) -> f32 {
    let n = (N - 1) as f64;
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
fn entry<const N: usize>(view: usize, alpha: usize) -> (Vec3, Ggx) {
    let t = view as f32 / (N - 1) as f32;
    let cos = (t * t).max(1e-6); // the limit at grazing
    let r = alpha as f32 / (N - 1) as f32;
    let a = (r * r).max(ALPHA_DELTA);
    (
        Vec3::new(sqrt_of_nonnegative(1.0 - cos * cos), 0.0, cos),
        Ggx { ax: a, ay: a },
    )
}

/// Calls `f` with each visible normal. Hammersley-like points: even along the polar axis, where horizons cut the lobe,
/// golden-ratio steps in azimuth, of which half a turn suffices by symmetry.
fn for_visible_normals(count: usize, wo: Vec3, ggx: Ggx, mut f: impl FnMut(Vec3)) {
    for i in 0..count {
        let u = (0.5 + 0.618_033_988_749_894_9 * i as f64).fract() * 0.5;
        let v = (i as f32 + 0.5) / count as f32;
        f(ggx.sample_visible(wo, Vec2::new(u as f32, v)));
    }
}

/// G2/G1(wo) of a scattered direction: the weight of a visible-normal sample before its reflectance.
fn weight(ggx: Ggx, wo: Vec3, wi: Vec3) -> f32 {
    let g1_over_cos = ggx.g1_over_cosine(wo);
    if g1_over_cos > 0.0 {
        ggx.g2_over_cosine(wo, wi) / g1_over_cos
    } else {
        0.0
    }
}

/// Split by Schlick: E = f0·base + f90·edge.
struct SchlickTables {
    base: Plane<FINE>,
    edge: Plane<FINE>,
}

static SCHLICK: LazyLock<SchlickTables> = LazyLock::new(|| {
    let mut base = [[0.0; FINE]; FINE];
    let mut edge = [[0.0; FINE]; FINE];
    for j in 0..FINE {
        for i in 0..FINE {
            let (wo, ggx) = entry::<FINE>(i, j);
            let (mut b, mut e) = (0.0, 0.0);
            for_visible_normals(FINE_NORMALS, wo, ggx, |m| {
                let wi = reflect(wo, m);
                if wi.z > 0.0 {
                    let w = weight(ggx, wo, wi);
                    let s = schlick_weight(wo.dot(m));
                    b += w * (1.0 - s);
                    e += w * s;
                }
            });
            base[j][i] = b / FINE_NORMALS as f32;
            edge[j][i] = e / FINE_NORMALS as f32;
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

/// An index at each node of its axis: q from 0 to 1 with q² = (η−1)/(η+1), which is 1 … ∞.
fn index_nodes() -> [f32; INDICES] {
    std::array::from_fn(|k| {
        let q = k as f32 / (INDICES - 1) as f32;
        (1.0 + q * q) / (1.0 - q * q)
    })
}

/// Planes at the nodes of the axis of indices; `f` adds up what its visible normals give at each.
fn indexed<const N: usize>(
    normals: usize,
    f: impl Fn(Vec3, Ggx, Vec3, &[f32; INDICES], &mut [f32; INDICES]),
) -> Vec<Plane<N>> {
    let etas = index_nodes();
    let mut values = vec![[[0.0; N]; N]; INDICES];
    for j in 0..N {
        for i in 0..N {
            let (wo, ggx) = entry::<N>(i, j);
            let mut sums = [0.0; INDICES];
            for_visible_normals(normals, wo, ggx, |m| f(wo, ggx, m, &etas, &mut sums));
            for (plane, sum) in values.iter_mut().zip(sums) {
                plane[j][i] = sum / normals as f32;
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

/// Interpolates between the planes around an index, linearly in q^`power`: what is tabulated is nearly linear in it.
fn at_index<const N: usize>(planes: &[Plane<N>], eta: f32, power: i32, f: impl Fn(&Plane<N>) -> f32) -> f32 {
    let q = index_ratio(eta).sqrt();
    let (k, w) = locate(q, INDICES);
    let w = if power == 1 {
        w
    } else {
        let node = |k: usize| (k as f32 / (INDICES - 1) as f32).powi(power);
        (q.powi(power) - node(k)) / (node(k + 1) - node(k))
    };
    match planes.get(k..k + 2) {
        Some([a, b]) => lerp(f(a), f(b), w),
        _ => 0.0,
    }
}

/// Reflection of rough dielectric facets seen from outside.
static COAT: LazyLock<Vec<Plane<FINE>>> = LazyLock::new(|| {
    indexed(FINE_NORMALS, |wo, ggx, m, etas, sums| {
        let wi = reflect(wo, m);
        if wi.z > 0.0 {
            let w = weight(ggx, wo, wi);
            for (sum, &eta) in sums.iter_mut().zip(etas) {
                *sum += w * fresnel_dielectric(wo.dot(m).max(0.0), eta);
            }
        }
    })
});

/// A coat's reflection is nearly linear in that at normal incidence, ((η−1)/(η+1))² = q⁴.
const COAT_POWER: i32 = 4;

/// Albedo of the reflection of a rough dielectric of index `eta` ≥ 1 (relative, seen from the thinner side).
pub fn coat_albedo(cos: f32, alpha: f32, eta: f32) -> f32 {
    at_index(&COAT, eta, COAT_POWER, |p| p.at(cos, alpha))
}

/// Cosine-weighted mean over views of [`coat_albedo`].
pub fn coat_mean(alpha: f32, eta: f32) -> f32 {
    at_index(&COAT, eta, COAT_POWER, |p| p.mean(alpha))
}

/// Reflection plus transmission (as flux) of rough dielectric facets: entering the denser side, and leaving it.
struct SolidTables {
    entering: Vec<Plane<COARSE>>,
    leaving: Vec<Plane<COARSE>>,
}

static SOLID: LazyLock<SolidTables> = LazyLock::new(|| {
    let table = |leaving: bool| {
        indexed(COARSE_NORMALS, move |wo, ggx, m, etas, sums| {
            let cos = wo.dot(m).max(0.0);
            let wi = reflect(wo, m);
            let reflected = if wi.z > 0.0 { weight(ggx, wo, wi) } else { 0.0 };
            for (sum, &eta) in sums.iter_mut().zip(etas) {
                let eta = if leaving { 1.0 / eta } else { eta };
                let r = fresnel_dielectric(cos, eta);
                *sum += r * reflected;
                if let Some(wi) = refract(wo, m, eta).filter(|wi| wi.z < 0.0) {
                    *sum += (1.0 - r) * weight(ggx, wo, wi);
                }
            }
        })
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
    at_index(planes, index, 1, |p| p.at(cos, alpha))
}

/// Cosine-weighted mean over views of [`solid_albedo`].
pub fn solid_mean(alpha: f32, eta: f32) -> f32 {
    let (planes, index) = solid_planes(eta);
    at_index(planes, index, 1, |p| p.mean(alpha))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn debug_time() {
        for _ in 0..2 {
            let t = std::time::Instant::now();
            schlick_albedo(0.5, 0.5);
            println!("schlick {:?}", t.elapsed());
            let t = std::time::Instant::now();
            coat_albedo(0.5, 0.5, 1.5);
            println!("coat {:?}", t.elapsed());
            let t = std::time::Instant::now();
            solid_albedo(0.5, 0.5, 1.5);
            println!("solid {:?}", t.elapsed());
        }
    }
}
