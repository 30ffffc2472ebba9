//! What mirror facets return, and what they lose, after one scattering.

use super::super::fresnel::schlick_weight;
use super::super::microfacet::Ggx;
use super::super::unit;
use super::{FINE, GRAZING, Plane, entry, for_visible_normals, lerp, locate, mirrored_cosine, weight};
use crate::math::robust::sqrt_of_nonnegative;
use glam::Vec3;
use std::sync::LazyLock;

/// Mirror facets under Schlick's curve, E = f0·base + f90·edge.
///
/// What facets lose, 1 − base − edge, depends on the slopes they have beside that of the view, α·tanθ, and for narrow ones
/// on nothing else. So their axis is the view's cosine after stretching, cosθ/√(cos²θ + α² sin²θ): along it the loss is
/// smooth for every α, whereas by cosθ all of it lies between two nodes (3 % off for α below 0.005 at grazing views).
struct SchlickTables {
    /// base + edge by α and the root of the stretched cosine.
    white: [[f32; STRETCHED]; FINE],
    /// Share of the edge in it, by view.
    edge: Plane<FINE>,
    /// Means of (base, edge) over views, by α.
    means: [(f32, f32); WIDTHS],
}

/// Nodes along the axis of stretched cosines.
const STRETCHED: usize = 64;
/// Nodes of means along the roughness axis: more than of the tables, so that they are those of what lies between, too.
const WIDTHS: usize = 8 * (FINE - 1) + 1;

impl SchlickTables {
    fn albedo(&self, cos: f32, alpha: f32) -> (f32, f32) {
        let (c, a) = (unit(cos), unit(alpha));
        let (i, w) = locate((c / (c * c + a * a * (1.0 - c * c)).sqrt()).sqrt(), STRETCHED);
        let (j, v) = locate(a.sqrt(), FINE);
        let (low, high) = (&self.white[j], &self.white[j + 1]);
        let white = lerp(lerp(low[i], low[i + 1], w), lerp(high[i], high[i + 1], w), v);
        let edge = white * self.edge.at(cos, alpha);
        (white - edge, edge)
    }
}

/// What (all, edge-weighted) facets return towards `wo`.
fn returned(wo: Vec3, ggx: Ggx) -> (f32, f32) {
    let (mut all, mut edge) = (0.0, 0.0);
    for_visible_normals(wo, ggx, |m, share| {
        let w = share * weight(ggx, wo.z, mirrored_cosine(wo, m));
        all += w;
        edge += w * schlick_weight(wo.dot(m));
    });
    (all, edge)
}

static SCHLICK: LazyLock<SchlickTables> = LazyLock::new(|| {
    let mut edge = [[0.0; FINE]; FINE];
    let mut white = [[0.0; STRETCHED]; FINE];
    for j in 0..FINE {
        for (i, share) in edge[j].iter_mut().enumerate() {
            let (wo, ggx) = entry::<FINE>(i, j);
            let (all, part) = returned(wo, ggx);
            *share = part / all;
        }
        for (i, white) in white[j].iter_mut().enumerate() {
            let (_, ggx) = entry::<FINE>(0, j);
            // The view that is stretched to this node: tanθ = tan(stretched)/α.
            let t = i as f32 / (STRETCHED - 1) as f32;
            let s = (t * t).max(GRAZING);
            let tan = sqrt_of_nonnegative((1.0 - s) * (1.0 + s)) / (s * ggx.ax);
            let cos = 1.0 / (1.0 + tan * tan).sqrt();
            *white = returned(Vec3::new(tan * cos, 0.0, cos), ggx).0;
        }
    }
    let mut tables = SchlickTables {
        white,
        edge: Plane::new(edge),
        means: [(0.0, 0.0); WIDTHS],
    };
    tables.means = std::array::from_fn(|k| {
        let r = k as f32 / (WIDTHS - 1) as f32;
        let n = 256; // midpoints in t with cosθ = t²
        let sum = (0..n).fold((0.0, 0.0), |sum, i| {
            let t = (i as f32 + 0.5) / n as f32;
            let (base, edge) = tables.albedo(t * t, r * r);
            (sum.0 + base * 4.0 * t * t * t, sum.1 + edge * 4.0 * t * t * t)
        });
        (sum.0 / n as f32, sum.1 / n as f32)
    });
    tables
});

/// Albedo (base, edge) of rough mirror facets under Schlick's curve: E = f0·base + f90·edge. base + edge is the albedo
/// of facets that reflect all.
pub fn schlick_albedo(cos: f32, alpha: f32) -> (f32, f32) {
    SCHLICK.albedo(cos, alpha)
}

/// Cosine-weighted means over views of [`schlick_albedo`].
pub fn schlick_mean(alpha: f32) -> (f32, f32) {
    let (k, w) = locate(unit(alpha).sqrt(), WIDTHS);
    let (a, b) = (SCHLICK.means[k], SCHLICK.means[k + 1]);
    (lerp(a.0, b.0, w), lerp(a.1, b.1, w))
}
