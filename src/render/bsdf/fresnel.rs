//! Reflectance of smooth interfaces, and the directions that they reflect and refract to.

use crate::math::robust::try_normalize;
use crate::render::technique::FresnelModel;
use glam::Vec3;

/// Unpolarised Fresnel reflectance of a smooth dielectric, in [0, 1].
/// `cos_i` = n·ω on the side the ray comes from (≥ 0); `eta` = η_transmitted / η_incident > 0.
/// Total internal reflection gives exactly 1; index-matched media exactly 0, also at grazing; an infinite index 1.
/// Source: PBRT-4 §9.3, with η²cos²θt formed as (η−1)(η+1) + cos²θi, which does not cancel near η = 1.
pub fn fresnel_dielectric(cos_i: f32, eta: f32) -> f32 {
    if eta == 1.0 {
        return 0.0; // cos_i² would underflow at extreme grazing and leave 0/0
    }
    let k = (eta - 1.0) * (eta + 1.0) + cos_i * cos_i;
    if !(k >= 0.0 && k.is_finite() && eta > 0.0) {
        return 1.0;
    }
    let t = k.sqrt(); // η·cosθt
    let cos_t = t / eta;
    let s = (cos_i - t) / (cos_i + t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

impl FresnelModel {
    /// Reflectance of a smooth dielectric by this model, with the arguments of [`fresnel_dielectric`].
    ///
    /// Schlick's approximation is F0 + (1 − F0)·(1 − cos)⁵, by rights with the cosine on the optically thinner side: where
    /// the ray comes from the denser one, that of the refracted ray. All models agree at normal incidence, on total
    /// internal reflection (exactly 1), and that nothing is reflected where the indices are equal.
    /// Source: Schlick, An Inexpensive BRDF Model for Physically-based Rendering, 1994.
    #[inline]
    pub fn reflectance(self, cos_i: f32, eta: f32) -> f32 {
        if self == FresnelModel::Exact {
            return fresnel_dielectric(cos_i, eta);
        }
        if eta == 1.0 {
            return 0.0;
        }
        let k = (eta - 1.0) * (eta + 1.0) + cos_i * cos_i;
        if !(k >= 0.0 && k.is_finite() && eta > 0.0) {
            return 1.0;
        }
        let refracts_out = eta < 1.0 && self == FresnelModel::Schlick;
        let cos = if refracts_out { k.sqrt() / eta } else { cos_i };
        let f0 = f0_from_eta(eta);
        f0 + (1.0 - f0) * schlick_weight(cos)
    }
}

/// (1 − cos)⁵, Schlick's weight of the reflectance at grazing incidence.
pub fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's curve from `f0` at normal incidence to `f90` at grazing.
pub fn schlick(f0: Vec3, f90: f32, cos: f32) -> Vec3 {
    f0 + (Vec3::splat(f90) - f0) * schlick_weight(cos)
}

/// Reflectance at normal incidence of a dielectric of relative index `eta`; 1 for an infinite index.
pub fn f0_from_eta(eta: f32) -> f32 {
    if eta.is_finite() {
        let r = (eta - 1.0) / (eta + 1.0);
        r * r
    } else {
        1.0
    }
}

/// The mirror image of `w` about the unit vector `m`.
pub fn reflect(w: Vec3, m: Vec3) -> Vec3 {
    m * (2.0 * w.dot(m)) - w
}

/// The unit direction into which `wo` refracts at a facet of normal `m` on its side (wo·m ≥ 0);
/// `eta` = η_transmitted / η_incident. `None` on total internal reflection.
pub fn refract(wo: Vec3, m: Vec3, eta: f32) -> Option<Vec3> {
    let cos_i = wo.dot(m);
    let k = (eta - 1.0) * (eta + 1.0) + cos_i * cos_i;
    if !(k >= 0.0 && k.is_finite()) {
        return None;
    }
    try_normalize((m * (cos_i - k.sqrt()) - wo) / eta)
}

/// [`refract`] at the plane z = 0: keeps all digits of the tangential components.
pub fn refract_at_plane(wo: Vec3, eta: f32) -> Option<Vec3> {
    let k = (eta - 1.0) * (eta + 1.0) + wo.z * wo.z;
    if !(k >= 0.0 && k.is_finite()) {
        return None;
    }
    try_normalize(Vec3::new(-wo.x, -wo.y, -k.sqrt().copysign(wo.z)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The textbook form in f64.
    fn oracle(cos_i: f64, eta: f64) -> f64 {
        let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
        if sin2_t >= 1.0 {
            return 1.0;
        }
        let cos_t = (1.0 - sin2_t).sqrt();
        let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        0.5 * (s * s + p * p)
    }

    #[test]
    fn index_matched_media_reflect_nothing() {
        for cos in [1.0, 0.3, 1e-4, 1e-20, 0.0] {
            assert_eq!(fresnel_dielectric(cos, 1.0), 0.0);
        }
        for eta in [1.0 + 1.2e-7f32, 1.0 - 6e-8] {
            assert!(fresnel_dielectric(1.0, eta) < 1e-13, "{eta}");
            assert!(fresnel_dielectric(0.1, eta) < 1e-7, "{eta}");
        }
    }

    #[test]
    fn total_reflection_is_exactly_one() {
        for cos in [0.0, 0.1, 0.5, 0.74] {
            assert_eq!(fresnel_dielectric(cos, 1.0 / 1.5), 1.0); // critical cosine 0.745
            assert_eq!(
                refract_at_plane(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos), 1.0 / 1.5),
                None
            );
        }
        assert_eq!(fresnel_dielectric(0.3, f32::INFINITY), 1.0);
        assert_eq!(fresnel_dielectric(0.0, 1.5), 1.0);
    }

    /// Oracle: f64. An error u of η²cos²θt is one of u/(η·cosθt) of its root, where dF/dθ diverges: at the critical
    /// angle itself 4·sqrt(2u) is left.
    #[test]
    fn reflectance_matches_f64() {
        for eta in [0.5f32, 1.0 / 1.5, 0.9999, 1.0001, 1.33, 1.5, 2.4, 10.0] {
            let e = f64::from(eta);
            let check = |cos: f32| {
                let c = f64::from(cos);
                let off = (f64::from(fresnel_dielectric(cos, eta)) - oracle(c, e)).abs();
                let root = ((e - 1.0) * (e + 1.0) + c * c).max(0.0).sqrt();
                let tolerance = (1e-5 + 2e-7 / root).min(1.4e-3);
                assert!(off < tolerance, "eta {eta}, cos {cos}: off by {off}");
            };
            for i in 0..=10_000 {
                check(i as f32 / 10_000.0);
            }
            let critical = (1.0 - e * e).max(0.0).sqrt();
            for step in [0.0, 1e-7, 1e-5, 1e-3] {
                check((critical * (1.0 + step)) as f32);
            }
        }
    }

    /// Incoherent slab: T = (1−R)/(1+R) for R of either face, since the inner angle makes both equal.
    #[test]
    fn both_faces_of_a_slab_reflect_alike() {
        for cos in [1.0f32, 0.8, 0.5, 0.1] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let inside = refract_at_plane(wo, 1.5).map(|wi| fresnel_dielectric(-wi.z, 1.0 / 1.5));
            let outside = fresnel_dielectric(cos, 1.5);
            assert!(
                inside.is_some_and(|r| (r - outside).abs() < 2e-6),
                "{inside:?} and {outside}"
            );
        }
        let r = fresnel_dielectric(1.0, 1.5);
        assert!(((1.0 - r) / (1.0 + r) - 0.923_077).abs() < 1e-6); // 12/13 for 1.5
    }

    /// The textbook form in f64: both models of Schlick against it, on both sides of the boundary.
    #[test]
    fn schlick_is_the_formula_and_the_slip_shows_inside_only() {
        let (right, slip) = (FresnelModel::Schlick, FresnelModel::SchlickIncident);
        for eta in [1.1f32, 1.33, 1.5, 2.4] {
            let mut largest_slip = 0.0f32;
            for i in 0..=1000 {
                let cos = i as f32 / 1000.0;
                let f0 = ((f64::from(eta) - 1.0) / (f64::from(eta) + 1.0)).powi(2);
                let formula = |c: f64| f0 + (1.0 - f0) * (1.0 - c).powi(5);
                let near = |found: f32, wanted: f64| {
                    assert!(
                        (f64::from(found) - wanted).abs() < 2e-6,
                        "eta {eta}, cos {cos}: {found}, not {wanted}"
                    );
                };
                near(right.reflectance(cos, eta), formula(f64::from(cos)));
                assert_eq!(right.reflectance(cos, eta), slip.reflectance(cos, eta));
                if i < 10 {
                    continue; // rounding may make it total reflection
                }
                // The same ray backwards: out of the denser side under the angle that it has in there.
                let inside = (1.0 - (1.0 - f64::from(cos).powi(2)) / f64::from(eta).powi(2)).sqrt() as f32;
                let out = right.reflectance(inside, 1.0 / eta);
                // Near grazing the outer cosine is the root of a difference of two rounded squares.
                let tolerance = 3e-6 + 1e-6 / f64::from(cos.max(1e-3));
                assert!(
                    (f64::from(out) - formula(f64::from(cos))).abs() < tolerance,
                    "eta {eta}, cos {cos}: {out}"
                );
                near(slip.reflectance(inside, 1.0 / eta), formula(f64::from(inside)));
                largest_slip = largest_slip.max((out - slip.reflectance(inside, 1.0 / eta)).abs());
            }
            assert!(largest_slip > 0.1, "the slip does not show: {largest_slip}");
        }
    }

    #[test]
    fn all_models_agree_where_they_must() {
        for model in [
            FresnelModel::Exact,
            FresnelModel::Schlick,
            FresnelModel::SchlickIncident,
        ] {
            for eta in [1.5f32, 1.0 / 1.5, 2.4, 0.9] {
                let normal = fresnel_dielectric(1.0, eta);
                assert!((model.reflectance(1.0, eta) - normal).abs() < 1e-7, "{model:?} {eta}");
            }
            assert_eq!(model.reflectance(1.0, 1.5), f0_from_eta(1.5));
            for cos in [0.0, 0.1, 0.5, 0.74] {
                assert_eq!(model.reflectance(cos, 1.0 / 1.5), 1.0); // critical cosine 0.745
                assert_eq!(model.reflectance(cos, f32::INFINITY), 1.0);
                assert_eq!(model.reflectance(cos, 1.0), 0.0);
            }
        }
    }

    #[test]
    fn refraction_obeys_snell() {
        for (sin, eta) in [(0.6f32, 1.5f32), (0.6, 1.0 / 1.5), (0.999, 1.0001), (1e-6, 2.0)] {
            let wo = Vec3::new(sin, 0.0, (1.0 - sin * sin).sqrt());
            for wi in [refract_at_plane(wo, eta), refract(wo, Vec3::Z, eta)]
                .into_iter()
                .flatten()
            {
                assert!((wi.x * eta + sin).abs() < 3e-7 && wi.z < 0.0, "{sin} {eta}: {wi}");
            }
        }
    }
}
