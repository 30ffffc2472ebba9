//! The GGX distribution of facet normals with Smith's height-correlated masking.
//!
//! All directions are local with z ≥ 0 unless said otherwise. Forms are chosen so that nothing is divided by a cosine:
//! they hold at grazing incidence and down to the smallest α that is not treated as a mirror.

use crate::math::portable::sin_cos_turns;
use crate::math::robust::{sqrt_of_nonnegative, try_normalize};
use glam::{Vec2, Vec3};

/// Below this α a lobe is a delta lobe: it is narrower than f32 directions resolve. Decided once, where a BSDF is made.
pub const ALPHA_DELTA: f32 = 1e-4;

/// GGX facets of widths `ax` and `ay` along the local axes, both in [`ALPHA_DELTA`, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// α along x.
    pub ax: f32,
    /// α along y.
    pub ay: f32,
}

impl Ggx {
    /// Facets of the same width in all directions; `None` where α is so small that the surface is a mirror.
    /// Values above 1 count as 1; NaN is a mirror.
    pub fn isotropic(alpha: f32) -> Option<Ggx> {
        Ggx::anisotropic(alpha, alpha)
    }

    /// Facets of different widths; a mirror only if both are narrow.
    pub fn anisotropic(ax: f32, ay: f32) -> Option<Ggx> {
        if ax >= ALPHA_DELTA || ay >= ALPHA_DELTA {
            let limit = |a: f32| a.clamp(ALPHA_DELTA, 1.0);
            Some(Ggx {
                ax: limit(ax),
                ay: limit(ay),
            })
        } else {
            None
        }
    }

    /// The width that albedo tables are looked up with: the root mean square, since losses grow with the slopes' variance.
    pub fn alpha(self) -> f32 {
        if self.ax == self.ay {
            self.ax
        } else {
            (0.5 * (self.ax * self.ax + self.ay * self.ay)).sqrt()
        }
    }

    /// Density of facet normals D(m), in 1/sr of projected area; m.z ≥ 0.
    pub fn d(self, m: Vec3) -> f32 {
        let (x, y) = (m.x / self.ax, m.y / self.ay);
        let k = x * x + y * y + m.z * m.z;
        std::f32::consts::FRAC_1_PI / (self.ax * self.ay * k * k)
    }

    /// |(αx·x, αy·y, z)|, which is (1 + 2Λ)·|z|.
    pub(super) fn stretched(self, w: Vec3) -> f32 {
        let (x, y) = (self.ax * w.x, self.ay * w.y);
        (x * x + y * y + w.z * w.z).sqrt()
    }

    /// Density of [`Ggx::sample_visible`]: D(m)·G1(w)·(w·m)/cosθ.
    pub fn pdf_visible(self, w: Vec3, m: Vec3) -> f32 {
        let c = w.z.abs();
        2.0 * self.d(m) * w.dot(m).max(0.0) / (c + self.stretched(w))
    }

    /// G2(wo, wi)/|cosθo|, height-correlated; either direction may point to the other side. At most 2/α.
    /// Source: Heitz, Understanding the Masking-Shadowing Function, JCGT 2014, eq. 99.
    pub fn g2_over_cosine(self, wo: Vec3, wi: Vec3) -> f32 {
        let (co, ci) = (wo.z.abs(), wi.z.abs());
        let d = co * self.stretched(wi) + ci * self.stretched(wo);
        if d > 0.0 { 2.0 * (ci / d) } else { 0.0 }
    }

    /// A normal among those seen from `w` (w.z ≥ 0).
    /// Source: Dupuy & Benyoub, Sampling Visible GGX Normals with Spherical Caps, 2023; 1 − z² is formed as a product.
    pub fn sample_visible(self, w: Vec3, u: Vec2) -> Vec3 {
        let Some(s) = try_normalize(Vec3::new(w.x * self.ax, w.y * self.ay, w.z)) else {
            return Vec3::Z;
        };
        let below = u.y * (1.0 + s.z); // 1 − z of the cap point
        let r = sqrt_of_nonnegative(below * (2.0 - below));
        let (sin, cos) = sin_cos_turns(u.x);
        let h = Vec3::new(r * cos, r * sin, 1.0 - below) + s;
        try_normalize(Vec3::new(h.x * self.ax, h.y * self.ay, h.z.max(0.0))).unwrap_or(Vec3::Z)
    }

    /// (D·G2/(4·cosθo·cosθi)·cosθi, pdf of wi) for a mirror facet; zero below the horizon and for wi = −wo.
    pub fn reflection(self, wo: Vec3, wi: Vec3) -> (f32, f32, f32) {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return (0.0, 0.0, 0.0);
        }
        let Some(m) = try_normalize(wo + wi) else {
            return (0.0, 0.0, 0.0);
        };
        let d = self.d(m);
        let f = 0.25 * d * self.g2_over_cosine(wo, wi);
        let pdf = 0.5 * d / (wo.z + self.stretched(wo));
        (f, pdf, wo.dot(m).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::Pcg;

    /// ∫ D(m)·(n·m) dm = 1: the facets' shadows tile the plane.
    #[test]
    fn facets_cover_the_plane_once() {
        for (ax, ay) in [(1.0, 1.0), (0.3, 0.3), (0.05, 0.4)] {
            let g = Ggx { ax, ay };
            let (n, mut sum) = (400, 0.0f64);
            for i in 0..n {
                // θ = t²·π/2 puts nodes where narrow lobes are.
                let t = (f64::from(i) + 0.5) / f64::from(n);
                let theta = t * t * std::f64::consts::FRAC_PI_2;
                let jacobian = 2.0 * t * std::f64::consts::FRAC_PI_2 / f64::from(n);
                for j in 0..n {
                    let phi = (f64::from(j) + 0.5) / f64::from(n) * std::f64::consts::TAU;
                    let m = Vec3::new(
                        (theta.sin() * phi.cos()) as f32,
                        (theta.sin() * phi.sin()) as f32,
                        theta.cos() as f32,
                    );
                    sum +=
                        f64::from(g.d(m)) * theta.cos() * theta.sin() * jacobian * std::f64::consts::TAU / f64::from(n);
                }
            }
            assert!((sum - 1.0).abs() < 1e-3, "{ax}, {ay}: {sum}");
        }
    }

    #[test]
    fn every_width_and_incidence_is_finite() {
        let mut rng = Pcg::new(3);
        for alpha in [1e-20f32, 1e-5, 1e-4, 3e-4, 0.01, 0.5, 1.0, 7.0, f32::NAN] {
            let Some(g) = Ggx::isotropic(alpha) else {
                assert!(alpha.is_nan() || alpha < ALPHA_DELTA);
                continue;
            };
            for z in [1.0f32, 0.5, 1e-3, 1e-10, 1e-20, 1e-38, 0.0] {
                let wo = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
                for _ in 0..200 {
                    let m = g.sample_visible(wo, rng.next_vec2());
                    assert!((m.length() - 1.0).abs() < 1e-5, "{alpha} {z}: {m}");
                    let wi = super::super::fresnel::reflect(wo, m);
                    let (f, pdf, c) = g.reflection(wo, wi);
                    assert!(
                        f.is_finite() && pdf.is_finite() && c.is_finite(),
                        "{alpha} {z}: {f} {pdf}"
                    );
                    assert!(f <= pdf * 1.0001, "G2 exceeds G1: {f} {pdf}");
                }
                assert_eq!(g.reflection(wo, -wo), (0.0, 0.0, 0.0));
            }
        }
    }
}
