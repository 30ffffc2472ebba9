//! Sheen: light scattered forwards by fibres that stand on a surface, as on cloth.

use super::energy::locate;
use super::unit;
use crate::math::portable::{pow, sin_cos_turns};
use crate::math::robust::{sqrt_of_nonnegative, try_normalize};
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// The "Charlie" lobe of glTF: D = (2 + 1/α)·sin^(1/α)θh/2π, V = 1/(4·(cosθo + cosθi − cosθo·cosθi)).
/// Source: Estevez & Kulla, Production Friendly Microfacet Sheen BRDF, 2017; V after Neubelt & Pettineo 2013.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Tint; zero for none.
    pub color: Vec3,
    /// α = roughness², at least [`Sheen::ALPHA_MIN`].
    pub alpha: f32,
}

/// Cosine that stands for the limit at grazing in the table.
const GRAZING: f32 = 1e-4;

/// The roughness of the narrowest lobe.
const ROUGHNESS_MIN: f32 = 0.07;
const VIEWS: usize = 32;
const ALPHAS: usize = 32;

impl Sheen {
    /// Narrower fibres' lobes are not told apart from this one: they lie within degrees of the horizon.
    pub const ALPHA_MIN: f32 = ROUGHNESS_MIN * ROUGHNESS_MIN;

    /// No sheen.
    pub const NONE: Sheen = Sheen {
        color: Vec3::ZERO,
        alpha: 1.0,
    };

    /// From glTF's colour and perceptual roughness.
    pub fn new(color: Vec3, roughness: f32) -> Sheen {
        let alpha = unit(roughness * roughness).max(Sheen::ALPHA_MIN);
        Sheen { color, alpha }
    }

    /// f·cosθi over the colour, both directions above.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        lobe(self.alpha, wo, wi) * self.scale(wo.z)
    }

    /// A direction above, denser towards the horizon where narrow lobes lie: cosθ = u².
    pub fn sample(u: Vec2) -> Vec3 {
        let cos = u.x * u.x;
        let sin = sqrt_of_nonnegative((1.0 - cos) * (1.0 + cos));
        let (s, c) = sin_cos_turns(u.y);
        Vec3::new(sin * c, sin * s, cos)
    }

    /// Density of [`Sheen::sample`].
    pub fn pdf(cos: f32) -> f32 {
        if cos > 0.0 {
            0.5 / (std::f32::consts::TAU * cos.sqrt())
        } else {
            0.0
        }
    }

    /// Directional albedo over the colour, in [0, 1].
    pub fn albedo(&self, cos: f32) -> f32 {
        raw_albedo(self.alpha, cos).min(1.0)
    }

    /// What brings the lobe down to an albedo of 1 where V overshoots (grazing views).
    fn scale(&self, cos: f32) -> f32 {
        let e = raw_albedo(self.alpha, cos);
        if e > 1.0 { 1.0 / e } else { 1.0 }
    }
}

fn lobe(alpha: f32, wo: Vec3, wi: Vec3) -> f32 {
    let Some(m) = try_normalize(wo + wi) else {
        return 0.0;
    };
    let sin = sqrt_of_nonnegative(m.x * m.x + m.y * m.y);
    let d = (2.0 + 1.0 / alpha) * pow(sin, 1.0 / alpha) / std::f32::consts::TAU;
    d * wi.z / (4.0 * (wo.z + wi.z - wo.z * wi.z))
}

/// The lobe's albedo by interpolation; axes as in [`super::energy`].
fn raw_albedo(alpha: f32, cos: f32) -> f32 {
    const POINTS: usize = 256;
    static TABLE: LazyLock<[[f32; VIEWS]; ALPHAS]> = LazyLock::new(|| {
        std::array::from_fn(|j| {
            let r = ROUGHNESS_MIN + (1.0 - ROUGHNESS_MIN) * j as f32 / (ALPHAS - 1) as f32;
            let alpha = r * r;
            std::array::from_fn(|i| {
                let t = i as f32 / (VIEWS - 1) as f32;
                let cos = (t * t).max(GRAZING);
                let wo = Vec3::new(sqrt_of_nonnegative(1.0 - cos * cos), 0.0, cos);
                let sum: f32 = (0..POINTS)
                    .map(|k| {
                        let u = (0.5 + 0.618_033_988_749_894_9 * k as f64).fract() as f32;
                        let wi = Sheen::sample(Vec2::new((k as f32 + 0.5) / POINTS as f32, u));
                        lobe(alpha, wo, wi) / Sheen::pdf(wi.z)
                    })
                    .sum();
                sum / POINTS as f32
            })
        })
    });
    let (i, w) = locate(cos.max(0.0).sqrt(), VIEWS);
    let (j, v) = locate((alpha.sqrt() - ROUGHNESS_MIN) / (1.0 - ROUGHNESS_MIN), ALPHAS);
    let row = |j: usize| TABLE[j][i] + w * (TABLE[j][i + 1] - TABLE[j][i]);
    row(j) + v * (row(j + 1) - row(j))
}
