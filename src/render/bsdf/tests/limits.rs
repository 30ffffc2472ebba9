//! Energy and finiteness where roughness, indices, views and normals come to their ends.

use super::furnace::{assert_returns, furnace};
use super::*;
use crate::math::frame::Frame;
use crate::math::robust::try_normalize;
use crate::math::warp::uniform_sphere;
use crate::render::bsdf::energy::schlick_albedo;

/// Rough models as narrow as facets get, which are not worth a χ² test of their own.
fn narrow(compensated: bool) -> Vec<(String, Bsdf)> {
    let (w, fresnel) = (Vec3::ONE, EXACT);
    let mut all = Vec::new();
    for alpha in [1e-4, 3e-4, 1e-3, 1e-2] {
        let ggx = ggx(alpha);
        let coat = Coat::Dielectric { eta: 1.5 };
        let models = [
            Bsdf::Metal(Metal {
                f0: w,
                ggx,
                compensated,
            }),
            Bsdf::Glossy(Glossy {
                base: w,
                back: Vec3::ZERO,
                coat,
                ggx,
                compensated,
            }),
            Bsdf::RoughGlass(RoughGlass {
                color: w,
                eta: 1.5,
                ggx,
                fresnel,
                compensated,
            }),
            Bsdf::RoughGlass(RoughGlass {
                color: w,
                eta: 1.0 / 1.5,
                ggx,
                fresnel,
                compensated,
            }),
            Bsdf::RoughThinGlass(RoughThinGlass {
                color: w,
                f0: w * 0.04,
                f90: 1.0,
                ggx,
                compensated,
            }),
        ];
        all.extend(models.into_iter().map(|b| (format!("{b:?}"), b)));
    }
    all
}

/// Catalogue of hard cases I 67 for lobes so narrow that a direction's rounding turns it by a good part of them: what a
/// sample states is what evaluation finds for the same direction, bit for bit.
#[test]
fn narrow_lobes_state_the_density_they_have() {
    let mut rng = Pcg::new(67);
    for (name, bsdf) in narrow(true) {
        for cos in [1.0f32, 0.7, 0.1, 1e-3, 1e-7, -0.5] {
            let wo = incidence(cos);
            for _ in 0..500 {
                if let Some(s) = bsdf.sample(wo, rng.next_vec2(), rng.next_f32()) {
                    let (f, pdf) = bsdf.eval_pdf(wo, s.wi);
                    assert_eq!((f / pdf, pdf), (s.weight, s.pdf), "{name} at {cos}");
                }
            }
        }
    }
}

/// At views within a thousandth of the surface and in it, as everywhere. Narrow facets without what several bounces add:
/// that comes from so few directions that no sum of samples could tell.
#[test]
fn no_surface_returns_more_light_than_it_gets_at_grazing() {
    for (name, bsdf) in coloured().into_iter().chain(narrow(false)) {
        for cos in [1e-3, 1e-4, 1e-7, 1e-20, 1e-38] {
            assert_returns(&name, &bsdf, cos, 0.0, 1.01);
            assert_returns(&name, &bsdf, -cos, 0.0, 1.01);
        }
    }
}

/// Rough boundaries between nearly equal media: down to where they count as smooth, α·|η − 1| = 1e-4.
#[test]
fn rough_boundaries_between_nearly_equal_media_lose_nothing() {
    for alpha in [0.25, 0.5, 1.0f32] {
        for eta in [1.0 + 1.1e-4 / alpha, 1.0 - 1.1e-4 / alpha, 1.001, 0.999, 1.01, 0.99] {
            let b = Bsdf::RoughGlass(RoughGlass {
                color: Vec3::ONE,
                eta,
                ggx: ggx(alpha),
                fresnel: EXACT,
                compensated: true,
            });
            for cos in [1.0, 0.45, 0.1] {
                assert_returns(&format!("rough glass {alpha} {eta}"), &b, cos, 0.98, 1.02);
            }
        }
    }
}

/// Catalogue of hard cases D 26: shading normals up to 60° off the surface's own. Directions that cross one plane and not
/// the other carry nothing, as the path tracer rules, so that what is left is no more than the furnace of the model.
#[test]
fn shading_normals_below_the_horizon_make_no_light() {
    let mut rng = Pcg::new(26);
    let normals: Vec<(Vec3, Vec3, Vec3)> = (0..12)
        .map(|i| {
            let ng = uniform_sphere(rng.next_vec2());
            let tilt = Frame::from_normal(ng).t * (i as f32 / 12.0 * 60f32.to_radians()).tan();
            let ns = try_normalize(ng + tilt).unwrap_or(ng);
            let wo = uniform_sphere(rng.next_vec2());
            // Seen from the same side by both normals: that is what `visible_normal` sees to.
            let wo = if wo.dot(ng) < 0.0 { -wo } else { wo };
            (ng, ns, if wo.dot(ns) < 0.0 { ng } else { wo })
        })
        .collect();
    for (name, bsdf) in coloured() {
        for &(ng, ns, wo) in &normals {
            let frame = Frame::from_normal(ns);
            let wo_local = frame.to_local(wo);
            let (n, mut sum, mut rejected) = (4000, Vec3::ZERO, 0);
            for _ in 0..n {
                let Some(s) = bsdf.sample(wo_local, rng.next_vec2(), rng.next_f32()) else {
                    continue;
                };
                let crosses = s.wi.z * wo_local.z < 0.0;
                if crosses == (frame.to_world(s.wi).dot(ng) * wo.dot(ng) < 0.0) {
                    sum += s.weight * (s.eta * s.eta);
                } else {
                    rejected += 1;
                }
            }
            let whole = furnace(&bsdf, wo_local, n).max_element();
            // Five standard errors of weights whose second moment is at most 3.
            let noise = 5.0 * (3.0 / n as f32).sqrt();
            let kept = sum.max_element() / n as f32;
            assert!(
                kept <= whole.max(1.0) + noise,
                "{name}: {kept} of {whole}, {rejected} rejected"
            );
        }
    }
}

/// Single scattering by white facets returns what the table says, from facets that are all but a mirror to the roughest,
/// and from straight views to grazing ones: to 0.3 %, of which 0.2 are its quadrature over 144 facets. By the view's own
/// cosine as the axis it was 10 % off at a grazing view of the narrowest, and what is lost is given back: too much of it.
#[test]
fn the_table_of_lost_light_is_right_at_every_width_and_view() {
    let (f0, compensated) = (Vec3::ONE, false);
    for alpha in [1e-4f32, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.03, 0.1, 0.3, 0.6, 1.0] {
        let metal = Bsdf::Metal(Metal {
            f0,
            ggx: ggx(alpha),
            compensated,
        });
        for cos in [
            1.0, 0.5, 0.1f32, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-20,
        ] {
            let found = furnace(&metal, incidence(cos), 40_000).x;
            let (base, edge) = schlick_albedo(cos, alpha);
            let off = found - base - edge;
            assert!(
                off.abs() < 0.003,
                "{alpha} at {cos}: {found}, the table is off by {off}"
            );
            assert!(
                (0.0..=1.0).contains(&base) && (0.0..=1.0).contains(&edge),
                "{alpha} at {cos}"
            );
        }
    }
}
