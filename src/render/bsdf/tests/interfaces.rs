//! Smooth interfaces at the limits: equal indices, the critical angle, grazing incidence; oracles in f64.

use crate::math::robust::UNIT_ROUNDOFF;
use crate::render::bsdf::fresnel::{fresnel_dielectric, refract, refract_at_plane};
use crate::render::bsdf::specular::Glass;
use crate::render::technique::FresnelModel;
use glam::{DVec3, Vec3};

const U: f64 = UNIT_ROUNDOFF as f64;

/// Relative indices from a thousandth to a thousand, and the nearest to 1 that there are.
const ETAS: [f32; 17] = [
    1e-3,
    0.1,
    0.5,
    1.0 / 1.5,
    0.9999,
    1.0 - 1e-7,
    1.0 - UNIT_ROUNDOFF,
    1.0,
    1.0 + 2.0 * UNIT_ROUNDOFF,
    1.0 + 1e-7,
    1.0001,
    1.33,
    1.5,
    2.4,
    10.0,
    1e3,
    1e6,
];

/// Cosines over the hemisphere, at grazing, at normal incidence, and, into a thinner medium, around the critical angle.
fn cosines(eta: f32) -> impl Iterator<Item = f32> {
    let even = (0..=10_000).map(|i| i as f32 / 10_000.0);
    let ends = [1e-45, 1e-38, 1e-20, 1e-10, 1e-7, 1e-4, 1.0 - UNIT_ROUNDOFF];
    let critical = (1.0 - f64::from(eta).powi(2)).max(0.0).sqrt() as f32;
    let around = (-8..=8).map(move |k| critical * (1.0 + k as f32 * UNIT_ROUNDOFF));
    let near = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2].map(move |d| critical * (1.0 + d));
    even.chain(ends)
        .chain(around)
        .chain(near)
        .filter(|c| (0.0..=1.0).contains(c))
}

/// η·cosθt = √((η − 1)(η + 1) + cos²θi), 0 on total reflection, and how far it may be off in f32: the radicand has four
/// roundings of terms of its size, and |√(k + δ) − √k| ≤ min(δ/√k, √δ); its root one more.
fn eta_cos_t(cos: f64, eta: f64) -> (f64, f64) {
    let index = (eta - 1.0) * (eta + 1.0);
    let k = index + cos * cos;
    let off = 4.0 * U * (index.abs() + cos * cos);
    let t = k.max(0.0).sqrt();
    let root = if t > 0.0 { (off / t).min(off.sqrt()) } else { off.sqrt() };
    (t, root + U * t)
}

/// The textbook form, and what f32 may be off: with s = (c − t)/(c + t) and p = (η²c − t)/(η²c + t), F = (s² + p²)/2,
/// the error of t counts ∂s/∂t = −2c/(c + t)² and ∂p/∂t = −2η²c/(η²c + t)² times, at worst where t is least; the
/// quotients add four and six roundings, squares and sum three.
fn reflectance(cos: f32, eta: f32) -> (f64, f64) {
    let (c, eta) = (f64::from(cos), f64::from(eta));
    if eta == 1.0 {
        return (0.0, 0.0);
    }
    let sin2_t = (1.0 - c * c) / (eta * eta);
    let (t, dt) = eta_cos_t(c, eta);
    let exact = if sin2_t >= 1.0 {
        1.0
    } else {
        let cos_t = (1.0 - sin2_t).sqrt();
        let s = (c - eta * cos_t) / (c + eta * cos_t);
        let p = (eta * c - cos_t) / (eta * c + cos_t);
        0.5 * (s * s + p * p)
    };
    let least = (t - dt).max(0.0);
    let slope = |c: f64| {
        if c > 0.0 {
            (2.0 * c / (c + least).powi(2) * dt).min(1.0)
        } else {
            0.0
        }
    };
    let quotient = |c: f64| if c + t > 0.0 { ((c - t) / (c + t)).abs() } else { 1.0 };
    let (ds, dp) = (slope(c) + 4.0 * U, slope(eta * eta * c) + 6.0 * U);
    let off = quotient(c) * ds + 0.5 * ds * ds + quotient(eta * eta * c) * dp + 0.5 * dp * dp + 3.0 * U * exact;
    (exact, off)
}

/// Catalogue of hard cases I 51 and 52.
#[test]
fn reflectance_is_right_at_every_index_and_angle() {
    for eta in ETAS {
        let mut largest_off = 0.0f64;
        for cos in cosines(eta) {
            let found = f64::from(fresnel_dielectric(cos, eta));
            let (exact, allowed) = reflectance(cos, eta);
            let off = (found - exact).abs();
            assert!(
                off <= allowed,
                "eta {eta}, cos {cos}: {found}, exactly {exact} ± {allowed}"
            );
            assert!((0.0..=1.0).contains(&found), "eta {eta}, cos {cos}: {found}");
            largest_off = largest_off.max(off);
        }
        // At the critical angle dF/dc diverges: 4·√(2u) is left of a rounded cosine, 1/η times that of small indices.
        let most = 4.0 * (2.0 * U).sqrt() * (0.5 / f64::from(eta)).max(1.0);
        assert!(largest_off <= most, "eta {eta}: off by {largest_off}");
    }
    // The textbook's cosine in f32 says "mirror" here: equal media, seen at 89.994°.
    assert_eq!(fresnel_dielectric(1e-4, 1.0), 0.0);
    assert!(fresnel_dielectric(1.0, 1.0 + 1e-7) < 1e-13);
}

/// What is reflected and what passes are all there is, and a ray and its reverse share alike: (cos, η) and (cosθt, 1/η),
/// where the angle of the refracted ray, rounded to f32, changes F by its slope.
#[test]
fn a_ray_and_its_reverse_reflect_alike() {
    for eta in ETAS.into_iter().filter(|e| *e > 1.0 && *e < 100.0) {
        for cos in cosines(eta).filter(|c| *c >= 1e-3) {
            let (t, _) = eta_cos_t(f64::from(cos), f64::from(eta));
            let inside = (t / f64::from(eta)) as f32;
            if (f64::from(inside) - 1.0).abs() < 2.0 * U && cos < 1.0 {
                continue; // the angle inside has no digits left
            }
            let (out, back) = (fresnel_dielectric(cos, eta), fresnel_dielectric(inside, 1.0 / eta));
            let (_, off_out) = reflectance(cos, eta);
            let (_, off_back) = reflectance(inside, 1.0 / eta);
            // The cosine outside that the rounded one inside and the rounded 1/η stand for: 3u·η²/cos off.
            let (c, e) = (f64::from(cos), f64::from(eta));
            let moved = (c - 3.0 * U * e * e / c).max(0.0);
            let bend = (reflectance(moved as f32, eta).0 - reflectance(cos, eta).0).abs();
            let off = f64::from((out - back).abs());
            assert!(
                off <= off_out + off_back + 2.0 * bend,
                "eta {eta}, cos {cos}: {out} and {back}"
            );
        }
    }
}

/// Snell's direction of a unit vector that is not quite one, in f64; `None` on total reflection.
fn snell(wo: Vec3, m: Vec3, eta: f32) -> Option<DVec3> {
    let (wo, m) = (wo.as_dvec3().normalize(), m.as_dvec3().normalize());
    let along = (wo - m * wo.dot(m)) / -f64::from(eta);
    let cos2 = 1.0 - along.length_squared();
    (cos2 >= 0.0).then(|| along - m * cos2.sqrt())
}

/// How far a refracted direction may be off: `own` roundings of its own, and those of η·cosθt, which turn it by
/// sinθt/η each. A unit vector's own rounding counts 3u·|η² − 1| in the radicand, as much as all others.
fn refraction_tolerance(wo: Vec3, cos: f64, eta: f32, own: f64) -> f64 {
    let eta = f64::from(eta);
    let sin_t = (1.0 - cos * cos).max(0.0).sqrt().min(eta) / eta;
    let (_, root) = eta_cos_t(cos, eta);
    debug_assert!((wo.length() - 1.0).abs() < 1e-6);
    own * U + 2.0 * sin_t * root / eta
}

/// Catalogue of hard cases I 53.
#[test]
fn refracted_directions_are_snells() {
    let mut ordinary = 0.0f64;
    for eta in ETAS {
        for cos in cosines(eta) {
            let sin = (1.0 - f64::from(cos) * f64::from(cos)).sqrt();
            let wo = Vec3::new((0.6 * sin) as f32, (-0.8 * sin) as f32, cos);
            let allowed = refraction_tolerance(wo, f64::from(cos), eta, 4.0);
            match (refract_at_plane(wo, eta), snell(wo, Vec3::Z, eta)) {
                (Some(wi), Some(exact)) => {
                    let off = (wi.as_dvec3() - exact).length();
                    assert!(
                        off <= allowed,
                        "eta {eta}, cos {cos}: {wi}, exactly {exact}, off by {off}"
                    );
                    assert!(wi.z <= 0.0, "eta {eta}, cos {cos}: {wi} is outside");
                    if eta >= 1.0 {
                        ordinary = ordinary.max(off);
                    }
                }
                // Within rounding of the critical angle either answer is right.
                (None, Some(exact)) => assert!(exact.z.abs() <= allowed, "eta {eta}, cos {cos}: lost {exact}"),
                (Some(wi), None) => assert!(f64::from(wi.z).abs() <= allowed, "eta {eta}, cos {cos}: {wi}"),
                (None, None) => {}
            }
        }
    }
    assert!(ordinary <= 4.0 * U, "into denser media: {} u", ordinary / U);
}

/// The same at facets of any direction, whose cosine is a dot product with roundings of its own.
#[test]
fn refraction_at_facets_is_snells() {
    let mut rng = crate::math::stats::Pcg::new(53);
    for eta in [0.5, 1.0 / 1.5, 0.9999, 1.0 + 1e-7, 1.33, 1.5, 2.4, 10.0f32] {
        for _ in 0..20_000 {
            let [wo, m] = [0; 2].map(|_| crate::math::warp::uniform_sphere(rng.next_vec2()).normalize());
            let m = if wo.dot(m) < 0.0 { -m } else { m };
            let cos = wo.as_dvec3().dot(m.as_dvec3());
            // 4u of the cosine, in a sum of size 1 + |cos − √k| ≤ 2 + η, divided by η; and through the radicand.
            let e = f64::from(eta);
            let (t, _) = eta_cos_t(cos, e);
            let moved = 8.0 * U * cos.abs() / t.max(U.sqrt());
            let allowed = refraction_tolerance(wo, cos, eta, 4.0 + 8.0 * (2.0 + e) / e) + moved / e;
            match (refract(wo, m, eta), snell(wo, m, eta)) {
                (Some(wi), Some(exact)) => {
                    let off = (wi.as_dvec3() - exact).length();
                    assert!(
                        off <= allowed,
                        "eta {eta}, {wo} at {m}: off by {off}, allowed {allowed}"
                    );
                }
                (None, Some(exact)) => assert!(exact.dot(m.as_dvec3()).abs() <= 2.0 * allowed.sqrt()),
                (Some(wi), None) => assert!(f64::from(wi.dot(m)).abs() <= 2.0 * allowed.sqrt()),
                (None, None) => {}
            }
        }
    }
}

/// Between equal media nothing happens to a ray, however it comes.
#[test]
fn equal_media_have_no_boundary() {
    for cos in cosines(1.0) {
        for sign in [1.0, -1.0] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, sign * cos);
            for fresnel in [
                FresnelModel::Exact,
                FresnelModel::Schlick,
                FresnelModel::SchlickIncident,
            ] {
                let (color, eta) = (Vec3::ONE, 1.0);
                let s = Glass { color, eta, fresnel }.sample(wo, 0.0);
                assert!(
                    s.is_some_and(|s| s.wi == -wo && s.weight == Vec3::ONE && s.pdf == 1.0),
                    "{wo}: {s:?}"
                );
            }
        }
    }
}

/// Catalogue of hard cases I 50: the lecture takes the cosine of the incident ray also inside of glass. At 40° inside of
/// 1.5 the exact reflectance is 0.2453, just below the critical angle 0.891; with the cosine of the refracted ray
/// Schlick's curve gives 0.2456, with that of the incident one 0.0407 and 0.041.
#[test]
fn the_slip_of_the_incident_cosine_has_the_numbers_of_the_catalogue() {
    let near = |model: FresnelModel, degrees: f64, wanted: f64, off: f64| {
        let found = f64::from(model.reflectance(degrees.to_radians().cos() as f32, 1.0 / 1.5));
        assert!(
            (found - wanted).abs() < off,
            "{model:?} at {degrees}°: {found}, not {wanted}"
        );
    };
    near(FresnelModel::Exact, 40.0, 0.2453, 1e-4);
    near(FresnelModel::Schlick, 40.0, 0.2456, 1e-4);
    near(FresnelModel::SchlickIncident, 40.0, 0.0407, 1e-4);
    near(FresnelModel::SchlickIncident, 41.8, 0.041, 1e-3);
    near(FresnelModel::Exact, 41.8, 0.891, 5e-3);
}
