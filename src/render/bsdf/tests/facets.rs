//! GGX facets from mirrors to the roughest, seen from everywhere, against f64.

use super::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::render::bsdf::microfacet::ALPHA_DELTA;
use glam::DVec3;

const U: f64 = UNIT_ROUNDOFF as f64;
const ALPHAS: [f32; 9] = [ALPHA_DELTA, 3e-4, 1e-3, 0.01, 0.05, 0.2, 0.5, 0.9, 1.0];
/// Cosines of views from straight above to as grazing as numbers get.
const VIEWS: [f32; 10] = [1.0, 0.9, 0.5, 0.1, 1e-2, 1e-4, 1e-7, 1e-10, 1e-20, 1e-30];

/// Unit vectors above the plane from within α/1000 of the normal to within 1e-7 of the horizon.
fn directions(alpha: f32, seed: u64) -> Vec<Vec3> {
    let mut rng = Pcg::new(seed);
    let mut all = vec![Vec3::Z];
    for i in 0..2000 {
        let (lo, hi) = (f64::from(alpha).ln() - 7.0, 1e7f64.ln());
        let tan = (lo + (hi - lo) * f64::from(i) / 2000.0).exp();
        let (sin, cos) = (tan / tan.hypot(1.0), 1.0 / tan.hypot(1.0));
        let phi = rng.next_f64() * std::f64::consts::TAU;
        all.push(Vec3::new(
            (sin * phi.cos()) as f32,
            (sin * phi.sin()) as f32,
            cos as f32,
        ));
    }
    all
}

/// α²/(π·(x² + y² + α²z²)²): another order of the same terms, for the very numbers given.
fn d_exact(m: Vec3, g: Ggx) -> f64 {
    let (m, a, b) = (m.as_dvec3(), f64::from(g.ax), f64::from(g.ay));
    let k = m.x * m.x * b / a + m.y * m.y * a / b + a * b * m.z * m.z;
    a * b / (std::f64::consts::PI * k * k)
}

/// Λ of Smith's masking by its textbook form, (√(1 + α²tan²θ) − 1)/2.
fn lambda(w: Vec3, g: Ggx) -> f64 {
    let (w, a, b) = (w.as_dvec3(), f64::from(g.ax), f64::from(g.ay));
    let tan2 = ((a * w.x).powi(2) + (b * w.y).powi(2)) / (w.z * w.z);
    // √(1 + t) − 1 without cancellation.
    0.5 * tan2 / ((1.0 + tan2).sqrt() + 1.0)
}

/// Catalogue of hard cases I 54: the textbook's (α² − 1)c² + 1 is 2.6 % off at α = 1e-3 and infinite at 1e-4. Sixteen
/// roundings: four in each square and their sum, twice that in the square of it, four in the factors.
#[test]
fn the_density_of_facets_matches_f64() {
    for alpha in ALPHAS {
        for g in [
            Ggx { ax: alpha, ay: alpha },
            Ggx { ax: alpha, ay: 1.0 },
            Ggx { ax: 0.3, ay: alpha },
        ] {
            for m in directions(alpha, 54) {
                let (found, exact) = (f64::from(g.d(m)), d_exact(m, g));
                assert!(
                    (found / exact - 1.0).abs() <= 16.0 * U,
                    "{g:?}, {m}: {found}, exactly {exact}"
                );
            }
        }
        let peak = 1.0 / (std::f64::consts::PI * f64::from(alpha).powi(2));
        assert!(
            (f64::from(ggx(alpha).d(Vec3::Z)) / peak - 1.0).abs() <= 16.0 * U,
            "peak of {alpha}"
        );
    }
}

/// Catalogue of hard cases I 55: the textbook's Λ is infinite or NaN at grazing views. Ten roundings; the product of the
/// smallest cosines and widths stays above the subnormal numbers down to 1e-30.
#[test]
fn masking_matches_f64_down_to_grazing_views() {
    for alpha in ALPHAS {
        for g in [Ggx { ax: alpha, ay: alpha }, Ggx { ax: alpha, ay: 1.0 }] {
            for cos in VIEWS {
                let wo = incidence(cos);
                for wi in directions(1e-3, 55).into_iter().chain(VIEWS.map(incidence)) {
                    let exact = 1.0 / (1.0 + lambda(wo, g) + lambda(wi, g)) / f64::from(wo.z);
                    let found = f64::from(g.g2_over_cosine(wo, wi));
                    let off = (found / exact - 1.0).abs();
                    assert!(off <= 10.0 * U, "{g:?}, {wo}, {wi}: {found}, exactly {exact}");
                }
            }
        }
    }
}

/// D·G1·(w·m)/cosθ: the roundings of D, ten more, and three of the dot product, absolute.
#[test]
fn the_density_of_visible_facets_matches_f64() {
    for alpha in ALPHAS {
        let g = ggx(alpha);
        for cos in VIEWS {
            let w = incidence(cos);
            let visible = 1.0 / (1.0 + lambda(w, g)) / f64::from(w.z);
            for m in directions(alpha, 56) {
                let per_dot = d_exact(m, g) * visible;
                let dot = w.as_dvec3().dot(m.as_dvec3()).max(0.0);
                let found = f64::from(g.pdf_visible(w, m));
                let allowed = per_dot * (26.0 * U * dot + 3.0 * U);
                assert!((found - per_dot * dot).abs() <= allowed, "{alpha}, {w}, {m}: {found}");
            }
        }
    }
}

/// Oracle: the same construction in f64 (Dupuy & Benyoub 2023). Sine and cosine of the azimuth are right to 2e-7 = 3.4u,
/// the point on the cap has nine roundings in all; stretching by α and dividing by the length makes that an angle.
/// What is no direction in f64 either (a view within the surface, and none of its facets seen) may be anything.
#[test]
fn visible_facets_are_drawn_as_in_f64() {
    let mut rng = Pcg::new(57);
    for alpha in ALPHAS {
        let g = ggx(alpha);
        let a = f64::from(g.ax);
        for cos in VIEWS.into_iter().chain([0.0]) {
            let w = incidence(cos);
            let s = (w.as_dvec3() * DVec3::new(a, a, 1.0)).normalize();
            for i in 0..2000 {
                let corner = [0.0, UNIT_ROUNDOFF, 0.5, 1.0 - UNIT_ROUNDOFF];
                let u = match i {
                    0..16 => Vec2::new(corner[i % 4], corner[i / 4]),
                    _ => rng.next_vec2(),
                };
                let m = g.sample_visible(w, u);
                assert!(
                    (m.length() - 1.0).abs() < 1e-6 && m.z >= 0.0,
                    "{alpha}, {cos}, {u}: {m}"
                );
                let below = f64::from(u.y) * (1.0 + s.z);
                let r = (below * (2.0 - below)).max(0.0).sqrt();
                let (sin, cos_phi) = (f64::from(u.x) * std::f64::consts::TAU).sin_cos();
                let h = DVec3::new(r * cos_phi, r * sin, 1.0 - below) + s;
                let facet = h * DVec3::new(a, a, 1.0);
                let allowed = 9.0 * U / facet.length();
                let off = (m.as_dvec3() - facet.normalize_or(DVec3::Z)).length();
                assert!(
                    off <= allowed,
                    "{alpha}, {cos}, {u}: {m}, off by {off}, allowed {allowed}"
                );
            }
        }
    }
}

/// Straight above, tan θ = α·√(u/(1 − u)), the inverse of the distribution itself (Walter et al. 2007, eq. 35).
#[test]
fn facets_seen_from_above_have_their_slopes() {
    for alpha in ALPHAS {
        for k in 0..4096 {
            let u = k as f32 / 4096.0;
            let m = ggx(alpha).sample_visible(Vec3::Z, Vec2::new(0.3, u)).as_dvec3();
            let (found, exact) = (
                m.x.hypot(m.y) / m.z,
                f64::from(alpha) * (f64::from(u) / (1.0 - f64::from(u))).sqrt(),
            );
            // 9u of the cap's point, whose height 2(1 − u) the slope is divided by.
            let allowed = 9.0 * U * (1.0 + 1.0 / (1.0 - f64::from(u))) * exact + 1e-12;
            assert!(
                (found - exact).abs() <= allowed,
                "{alpha}, {u}: {found}, exactly {exact}"
            );
        }
    }
}

/// Catalogue of hard cases I 56. Seen from above a facet of more than 45° mirrors below the horizon, of which there are
/// α²/(1 + α²): half of the roughest. Those are samples of value 0, and the others alone return ∫G2/G1 of them, not more.
/// Five standard errors.
#[test]
fn directions_below_the_horizon_count_as_samples_of_nothing() {
    let n = 1 << 18;
    for alpha in [0.05, 0.3, 0.7, 1.0f32] {
        let g = ggx(alpha);
        let metal = Bsdf::Metal(Metal {
            f0: Vec3::ONE,
            ggx: g,
            compensated: false,
        });
        let mut rng = Pcg::new(58);
        let (mut missed, mut sum, mut squares) = (0u32, 0.0, 0.0);
        for _ in 0..n {
            match metal.sample(Vec3::Z, rng.next_vec2(), rng.next_f32()) {
                None => missed += 1,
                Some(s) => {
                    let v = f64::from(s.weight.x);
                    (sum, squares) = (sum + v, squares + v * v);
                }
            }
        }
        let count = f64::from(n);
        let a2 = f64::from(alpha).powi(2);
        let share = a2 / (1.0 + a2);
        let off = (f64::from(missed) / count - share).abs();
        assert!(
            off <= 5.0 * (share * (1.0 - share) / count).sqrt(),
            "{alpha}: {missed} of {n} missed"
        );
        // Of the facets in order of their slope, up to 45°: G1 of the mirror direction at twice the angle.
        let steps = 100_000;
        let exact = (0..steps)
            .map(|i| (1.0 - share) * (f64::from(i) + 0.5) / f64::from(steps))
            .map(|u| {
                let theta = 2.0 * (a2 * u / (1.0 - u)).sqrt().atan();
                2.0 / (1.0 + (1.0 + a2 * theta.tan().powi(2)).sqrt())
            })
            .sum::<f64>()
            / f64::from(steps)
            * (1.0 - share);
        let mean = sum / count;
        let noise = 5.0 * ((squares / count - mean * mean) / count).sqrt();
        assert!(
            (mean - exact).abs() <= noise + 1e-6,
            "{alpha}: {mean}, exactly {exact} ± {noise}"
        );
        assert!(exact < 1.0);
    }
}

/// Catalogue of hard cases I 57: opposite directions have no half vector. Whatever is nearly opposite is finite.
#[test]
fn directions_without_a_half_vector_give_nothing() {
    let mut rng = Pcg::new(59);
    for alpha in ALPHAS {
        let g = ggx(alpha);
        // The nearest index to 1 that is not smooth at this width (see the material), and equal media all the same.
        for eta in [
            1.0,
            1.0 + ALPHA_DELTA / alpha,
            1.0 / (1.0 + ALPHA_DELTA / alpha),
            1.5,
            1.0 / 1.5,
        ] {
            let glass = RoughGlass {
                color: Vec3::ONE,
                eta,
                ggx: g,
                fresnel: EXACT,
                compensated: false,
            };
            for cos in VIEWS.into_iter().flat_map(|c| [c, -c]) {
                let wo = incidence(cos);
                assert_eq!(g.reflection(wo, -wo), (0.0, 0.0, 0.0));
                if eta == 1.0 {
                    assert_eq!(glass.eval_pdf(wo, -wo), (Vec3::ZERO, 0.0), "{alpha} {wo}");
                }
                for _ in 0..20 {
                    let nudge = (Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - 0.5) * 4.0 * UNIT_ROUNDOFF;
                    let wi = -wo + nudge;
                    let (f, pdf) = if eta == 1.0 {
                        (Vec3::ZERO, 0.0)
                    } else {
                        glass.eval_pdf(wo, wi)
                    };
                    assert!(
                        f.is_finite() && pdf.is_finite() && pdf >= 0.0,
                        "{alpha} {eta} {wo} {wi}: {f} {pdf}"
                    );
                    let (f, pdf, c) = g.reflection(wo, Vec3::new(wi.x, wi.y, -wi.z));
                    assert!(
                        f.is_finite() && pdf.is_finite() && (0.0..=1.0).contains(&c),
                        "{alpha} {wo} {wi}"
                    );
                }
            }
        }
    }
}
