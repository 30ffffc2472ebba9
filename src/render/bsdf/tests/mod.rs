//! Tests of the contract that every model keeps: weights, symmetry and finiteness here, densities and energy beside.

mod density;
mod facets;
mod furnace;
mod interfaces;
mod limits;

use super::film::Film;
use super::glossy::Coat;
use super::iridescent::Below;
use super::microfacet::Ggx;
use super::principled::{Base, Clearcoat};
use super::sheen::Sheen;
use super::*;
use crate::math::stats::Pcg;
use crate::render::technique::FresnelModel;

const EXACT: FresnelModel = FresnelModel::Exact;

fn ggx(alpha: f32) -> Ggx {
    Ggx::isotropic(alpha).unwrap_or(Ggx { ax: 1.0, ay: 1.0 })
}

fn finish() -> Finish {
    Finish {
        fresnel: EXACT,
        diffuse: Vec3::new(0.5, 0.3, 0.1),
        diffuse_back: Vec3::splat(0.1),
        brilliance: 1.5,
        highlight: Vec3::new(0.1, 0.08, 0.05),
        ggx: Some(ggx(0.2)),
        mirror_min: Vec3::splat(0.05),
        mirror_max: Vec3::splat(0.6),
        falloff: 4.0,
        passes: Vec3::new(0.1, 0.2, 0.15),
        eta: 1.0,
        conserve: false,
    }
}

/// Models with approximations, which keep the contract all the same.
fn approximate(color: Vec3) -> [(String, Bsdf); 6] {
    let ggx = ggx(0.4);
    let (fresnel, compensated, eta) = (FresnelModel::Schlick, false, 1.5);
    let models = [
        ("schlick's glass", Bsdf::Glass(Glass { color, eta, fresnel })),
        (
            "rough glass by schlick",
            Bsdf::RoughGlass(RoughGlass {
                color,
                eta,
                ggx,
                fresnel,
                compensated: true,
            }),
        ),
        (
            "rough glass scattering once",
            Bsdf::RoughGlass(RoughGlass {
                color,
                eta: 1.0 / 1.5,
                ggx,
                fresnel,
                compensated,
            }),
        ),
        (
            "rough sheet scattering once",
            Bsdf::RoughThinGlass(RoughThinGlass {
                color,
                f0: Vec3::splat(0.04),
                f90: 1.0,
                ggx,
                compensated,
            }),
        ),
        (
            "glossy scattering once",
            Bsdf::Glossy(Glossy {
                base: color,
                back: Vec3::ZERO,
                coat: Coat::Dielectric { eta },
                ggx,
                compensated,
            }),
        ),
        (
            "metal scattering once",
            Bsdf::Metal(Metal {
                f0: color,
                ggx,
                compensated,
            }),
        ),
    ];
    models.map(|(name, bsdf)| (name.to_owned(), bsdf))
}

/// Every kind of surface under a thin film, smooth and rough.
fn under_films(c: Vec3) -> Vec<(String, Bsdf)> {
    let mut all = Vec::new();
    for (thickness, alpha) in [(300.0, 0.0), (150.0, 0.1), (500.0, 0.6)] {
        let Some(film) = Film::new(1.4, thickness, 1.0) else {
            continue;
        };
        let f0 = Vec3::splat(0.04);
        let (base, back, eta) = (c * 0.7, c * 0.3, 1.5);
        let kinds = [
            (c, Below::Metal),
            (f0, Below::Diffuse { base, back }),
            (f0, Below::Sheet(c)),
            (f0, Below::Solid { color: c, eta }),
        ];
        for (f0, below) in kinds {
            let mut surface = Iridescent::new(film, f0, Ggx::isotropic(alpha), below);
            surface.facet = 0.37;
            all.push((
                format!("film {thickness} {alpha} over {below:?}"),
                Bsdf::Iridescent(surface),
            ));
        }
    }
    all
}

/// Every model, coloured, at several roughnesses.
fn coloured() -> Vec<(String, Bsdf)> {
    let c = Vec3::new(0.9, 0.5, 0.2);
    let mut all = vec![
        ("diffuse".to_string(), Bsdf::Diffuse(Diffuse { albedo: c })),
        (
            "specular".to_string(),
            Bsdf::Specular(Specular { color: c, grazing: c }),
        ),
        (
            "glass".to_string(),
            Bsdf::Glass(Glass {
                color: c,
                eta: 1.5,
                fresnel: EXACT,
            }),
        ),
        (
            "bubble".to_string(),
            Bsdf::Glass(Glass {
                fresnel: EXACT,
                color: c,
                eta: 1.0 / 1.33,
            }),
        ),
        (
            "translucent".to_string(),
            Bsdf::Translucent(Translucent {
                front: c * 0.3,
                back: c * 0.6,
            }),
        ),
        (
            "thin glass".to_string(),
            Bsdf::ThinGlass(ThinGlass {
                color: c,
                f0: Vec3::splat(0.04),
                f90: 1.0,
            }),
        ),
        ("finish".to_string(), Bsdf::Finish(finish())),
        (
            "finish glass".to_string(),
            Bsdf::Finish(Finish {
                eta: 1.5,
                falloff: f32::NAN,
                ..finish()
            }),
        ),
        (
            "smooth coat".to_string(),
            Bsdf::SmoothCoat(SmoothCoat {
                base: c,
                back: c * 0.1,
                coat: Coat::Dielectric { eta: 1.5 },
            }),
        ),
    ];
    for sigma in [0.1, 0.5, 1.5] {
        all.push((
            format!("oren-nayar {sigma}"),
            Bsdf::OrenNayar(OrenNayar::from_sigma(c, sigma)),
        ));
    }
    let schlick = Coat::Schlick {
        f0: Vec3::new(0.1, 0.05, 0.02),
        f90: 0.9,
    };
    for alpha in [0.03, 0.1, 0.4, 1.0] {
        let g = ggx(alpha);
        all.push((
            format!("metal {alpha}"),
            Bsdf::Metal(Metal {
                f0: c,
                ggx: g,
                compensated: true,
            }),
        ));
        let coat = Coat::Dielectric { eta: 1.5 };
        all.push((
            format!("glossy {alpha}"),
            Bsdf::Glossy(Glossy {
                compensated: true,
                base: c,
                back: Vec3::ZERO,
                coat,
                ggx: g,
            }),
        ));
        let thin = Glossy {
            compensated: true,
            base: c * 0.6,
            back: c * 0.4,
            coat: schlick,
            ggx: g,
        };
        for eta in [1.5, 1.0 / 1.33, 2.4] {
            all.push((
                format!("rough glass {alpha} {eta}"),
                Bsdf::RoughGlass(RoughGlass {
                    color: c,
                    eta,
                    ggx: g,
                    fresnel: EXACT,
                    compensated: true,
                }),
            ));
        }
        if alpha != 0.1 && alpha != 1.0 {
            continue; // the others' parts are tested above
        }
        all.push((format!("glossy sheet {alpha}"), Bsdf::Glossy(thin)));
        let sheet = RoughThinGlass {
            compensated: true,
            color: c,
            f0: Vec3::splat(0.04),
            f90: 1.0,
            ggx: g,
        };
        all.push((format!("rough sheet {alpha}"), Bsdf::RoughThinGlass(sheet)));
        let sheen = Sheen::new(Vec3::new(0.3, 0.2, 0.8), 0.5);
        for base in [
            Base::Glossy(thin),
            Base::RoughGlass(RoughGlass {
                fresnel: EXACT,
                compensated: true,
                color: c,
                eta: 1.5,
                ggx: ggx(0.2),
            }),
        ] {
            let coat = Clearcoat::new(0.7, Some(g));
            for (lean, what) in [(Vec2::ZERO, "coated"), (Vec2::new(0.3, -0.2), "coated, leaning")] {
                let layers = Principled {
                    base,
                    coat,
                    sheen,
                    lean,
                };
                all.push((format!("{what} {alpha}"), Bsdf::Principled(layers)));
            }
        }
    }
    all.extend(approximate(c));
    all.extend(under_films(c));
    let brushed = Metal {
        compensated: true,
        f0: c,
        ggx: Ggx { ax: 0.6, ay: 0.1 },
    };
    all.push(("brushed metal".to_string(), Bsdf::Metal(brushed)));
    let coat = Clearcoat::new(1.0, None);
    let base = Base::Glass(Glass {
        color: c,
        eta: 1.5,
        fresnel: EXACT,
    });
    all.push((
        "coated glass".to_string(),
        Bsdf::Principled(Principled {
            base,
            coat,
            sheen: Sheen::NONE,
            lean: Vec2::ZERO,
        }),
    ));
    all
}

fn incidence(cos: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(sin * 0.8, sin * 0.6, cos)
}

const COSINES: [f32; 7] = [1.0, 0.7, 0.2, 0.02, -0.02, -0.5, -0.95];

#[test]
fn samples_agree_with_eval_and_pdf() {
    let mut rng = Pcg::new(5);
    for (name, bsdf) in coloured() {
        for cos in COSINES {
            let wo = incidence(cos);
            for _ in 0..300 {
                let Some(s) = bsdf.sample(wo, rng.next_vec2(), rng.next_f32()) else {
                    continue;
                };
                assert!((s.wi.length() - 1.0).abs() < 1e-5, "{name} {cos}: {}", s.wi);
                assert!(
                    s.pdf > 0.0 && s.weight.is_finite() && s.weight.min_element() >= 0.0,
                    "{name} {cos}: {s:?}"
                );
                if s.delta {
                    assert!(
                        s.pdf <= 1.0 && bsdf.is_delta_only() || bsdf.pdf(wo, s.wi) < 1e3,
                        "{name}"
                    );
                    continue;
                }
                let (f, pdf) = bsdf.eval_pdf(wo, s.wi);
                assert!(
                    (pdf / s.pdf - 1.0).abs() < 1e-4,
                    "{name} {cos}: pdf {pdf}, sampled {}",
                    s.pdf
                );
                let off = (f - s.weight * s.pdf).abs().max_element();
                assert!(
                    off <= 1e-4 * f.max_element(),
                    "{name} {cos}: f {f}, weight·pdf {}",
                    s.weight * s.pdf
                );
            }
        }
    }
}

/// Helmholtz: f(wo, wi) = f(wi, wo); through an interface f(wo, wi)·η² with η = n_wi/n_wo takes its place.
#[test]
fn scattering_is_symmetric() {
    let mut rng = Pcg::new(9);
    for (name, bsdf) in coloured() {
        let is_layered = matches!(bsdf, Bsdf::Principled(_) | Bsdf::Finish(_))
            || matches!(bsdf, Bsdf::Iridescent(b) if matches!(b.below, Below::Diffuse { .. }));
        if is_layered {
            continue; // by the view direction, see there
        }
        for _ in 0..2000 {
            let wo = crate::math::warp::uniform_sphere(rng.next_vec2());
            let wi = crate::math::warp::uniform_sphere(rng.next_vec2());
            let (ab, ba) = (bsdf.eval(wo, wi) / wi.z.abs(), bsdf.eval(wi, wo) / wo.z.abs());
            let eta2 = match &bsdf {
                Bsdf::RoughGlass(g) if wo.z * wi.z < 0.0 => {
                    if wo.z > 0.0 {
                        g.eta * g.eta
                    } else {
                        1.0 / (g.eta * g.eta)
                    }
                }
                Bsdf::Iridescent(g) if wo.z * wi.z < 0.0 => g.eta_towards(wo).powi(2),
                _ => 1.0,
            };
            let off = (ab * eta2 - ba).abs().max_element();
            assert!(
                off <= 2e-3 * ba.max_element() + 1e-6,
                "{name} {wo} {wi}: {} and {ba}",
                ab * eta2
            );
        }
    }
}

#[test]
fn everything_stays_finite_at_the_limits() {
    let mut rng = Pcg::new(13);
    for (name, bsdf) in coloured() {
        for z in [1.0f32, 1e-3, 1e-10, 1e-20, 1e-38, 0.0, -1e-38, -1e-20, -1e-3, -1.0] {
            let wo = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
            for wi in [
                wo,
                -wo,
                Vec3::Z,
                -Vec3::Z,
                Vec3::X,
                -Vec3::X,
                Vec3::Y,
                specular::mirrored(wo),
            ] {
                let (f, pdf) = bsdf.eval_pdf(wo, wi);
                assert!(
                    f.is_finite() && pdf.is_finite() && pdf >= 0.0,
                    "{name} {wo} {wi}: {f} {pdf}"
                );
            }
            for _ in 0..100 {
                if let Some(s) = bsdf.sample(wo, rng.next_vec2(), rng.next_f32()) {
                    assert!(
                        s.weight.is_finite() && s.pdf.is_finite() && s.wi.is_finite(),
                        "{name} {z}: {s:?}"
                    );
                    assert!(s.weight.max_element() < 100.0, "{name} {z}: weight {}", s.weight);
                }
            }
        }
    }
}

/// The highlight's peak under a lamp is POV-Ray's: amount · lamp colour (the lamp's irradiance is π·colour·cosθ).
#[test]
fn highlights_are_as_bright_as_in_pov_ray() {
    for (amount, s) in [(0.5, 160.0), (0.3, 20.0), (1.0, 1000.0)] {
        let weight = Finish::highlight_weight(amount, s);
        let b = Bsdf::Finish(Finish {
            highlight: Vec3::splat(weight),
            ggx: Ggx::isotropic(Finish::highlight_alpha(s)),
            ..Finish::BLACK
        });
        let peak = b.eval(Vec3::Z, Vec3::Z).x * std::f32::consts::PI;
        assert!((peak / amount - 1.0).abs() < 1e-3, "{amount} {s}: {peak}");
    }
}

#[test]
fn a_bsdf_is_small() {
    assert!(size_of::<Bsdf>() <= 128, "{} bytes", size_of::<Bsdf>());
}
