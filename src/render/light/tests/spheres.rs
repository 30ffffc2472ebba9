//! Spheres at the limits of f32: tiny and far, huge and near, touched and entered.

use super::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::stats::Pcg;

const U: f64 = UNIT_ROUNDOFF as f64;

/// The solid angle 2π(1 − √(1 − s²)) of a cone, from the series where s is small (s⁴ and beyond in f64).
fn solid_angle(s2: f64) -> f64 {
    let one_minus_cos = if s2 < 1e-4 {
        s2 / 2.0 + s2 * s2 / 8.0 + s2 * s2 * s2 / 16.0
    } else {
        1.0 - (1.0 - s2).sqrt()
    };
    std::f64::consts::TAU * one_minus_cos
}

/// Catalogue of hard cases H 43 and J 61: the density keeps its digits down to R/d = 1e-7, and so does E.
#[test]
fn tiny_far_spheres_keep_their_light() {
    for exponent in 0..=7 {
        let ratio = 0.5 * 10f64.powi(-exponent);
        let center = DVec3::new(6e3, -3e3, 2e3);
        let d = center.length();
        let light = sphere(center, ratio * d);
        let set = LightSet::new(vec![light.clone()]);
        let n = (center / d).as_vec3();
        let s = set
            .sample(Vec3::ZERO, n, false, 0.5, Vec2::new(0.7, 0.2))
            .expect("visible");
        let exact = 1.0 / solid_angle(ratio * ratio);
        assert!(
            (f64::from(s.pdf) / exact - 1.0).abs() < 4.0 * U,
            "R/d = {ratio}: {}, exactly {exact}",
            s.pdf
        );
        let e = irradiance(&light, Vec3::ZERO, n, 64) / (std::f64::consts::PI * ratio * ratio);
        assert!((e - 1.0).abs() < 1e-4, "R/d = {ratio}: E is {e} of the exact one");
    }
}

/// Uniform over a narrow cone: the mean of sin θ is 2/3 of the sine of its half angle, and none exceeds that.
#[test]
fn directions_fill_narrow_cones_evenly() {
    for ratio in [1e-2, 1e-3, 1e-4] {
        let axis = DVec3::new(0.48, -0.6, 0.64);
        let set = LightSet::new(vec![sphere(axis * 1e3, 1e3 * ratio)]);
        let mut rng = Pcg::new(21);
        let (n, mut sum, mut largest) = (100_000, 0.0, 0.0f64);
        for _ in 0..n {
            let s = set
                .sample(Vec3::ZERO, Vec3::ZERO, false, 0.5, rng.next_vec2())
                .expect("visible");
            let sin = s.wi.as_dvec3().cross(axis).length();
            sum += sin / ratio;
            largest = largest.max(sin);
        }
        let mean = sum / f64::from(n);
        let standard_error = (1.0f64 / 18.0 / f64::from(n)).sqrt(); // variance of sin/s is 1/2 − 4/9
        assert!(
            (mean - 2.0 / 3.0).abs() < 5.0 * standard_error + U / ratio,
            "R/d = {ratio}: mean {mean}"
        );
        assert!(largest < ratio + 2.0 * U, "R/d = {ratio}: {largest}");
    }
}

/// J 62: a huge sphere close by, R = 1e4 at a gap of 0.5, and the lecture's lamp: R = 600 seen from 681.33.
#[test]
fn huge_near_spheres_give_their_irradiance() {
    for (radius, d) in [(1e4, 1e4 + 0.5), (600.0, 681.33), (1e5, 1e5 + 1e-3)] {
        let light = sphere(DVec3::Z * d, radius);
        let exact = std::f64::consts::PI * (radius / d) * (radius / d);
        let found = irradiance(&light, Vec3::ZERO, Vec3::Z, 256);
        assert!(
            (found / exact - 1.0).abs() < 1e-4,
            "R = {radius}, d = {d}: {found}, exactly {exact}"
        );
    }
}

#[test]
fn sampled_points_lie_on_the_sphere() {
    let mut rng = Pcg::new(3);
    for (radius, d) in [
        (1.0, 3.0),
        (1e-3, 1e4),
        (600.0, 681.33),
        (1e4, 1e4 + 0.5),
        (1.0, 1.0 + 1e-9),
        (5.0, 0.3),
    ] {
        let Light::Sphere(l) = sphere(DVec3::new(0.0, 0.6, 0.8) * d, radius) else {
            continue;
        };
        let light = Light::Sphere(SphereLight { two_sided: true, ..l });
        let set = LightSet::new(vec![light.clone()]);
        for _ in 0..1000 {
            let s = set
                .sample(Vec3::ZERO, Vec3::ZERO, false, 0.5, rng.next_vec2())
                .expect("visible");
            let q = s.wi.as_dvec3() * f64::from(s.distance);
            let off = ((q - l.center).length() - radius).abs();
            assert!(off < 8.0 * U * (d + radius), "R = {radius}, d = {d}: off by {off}");
            assert!(
                s.t_max < s.distance && s.t_max >= s.distance * (1.0 - 40.0 * UNIT_ROUNDOFF),
                "{}",
                s.t_max
            );
            if radius > 1e-2 && d > radius * 1.01 {
                // Nearest, not farthest.
                let nearest = oracle_hit(&light, DVec3::ZERO, s.wi.as_dvec3()).map_or(f64::from(s.distance), |h| h.0);
                let off = (nearest - f64::from(s.distance)).abs();
                assert!(off < 1e-3 * d, "R = {radius}, d = {d}: {nearest} and {}", s.distance);
            }
        }
    }
}

/// J 60: at the surface the cone is a hemisphere; nothing is NaN from there to the centre.
#[test]
fn points_on_and_in_the_sphere_are_sound() {
    let Light::Sphere(l) = sphere(DVec3::ZERO, 1.0) else {
        return;
    };
    for two_sided in [false, true] {
        let set = LightSet::new(vec![Light::Sphere(SphereLight { two_sided, ..l })]);
        for x in [0.0f32, 0.5, 1.0 - UNIT_ROUNDOFF, 1.0, 1.0 + 2.0 * UNIT_ROUNDOFF, 1.001] {
            let p = Vec3::X * x;
            for u in [Vec2::ZERO, Vec2::splat(0.5), Vec2::new(0.999_999_9, 0.0)] {
                let Some(s) = set.sample(p, Vec3::ZERO, false, 0.5, u) else {
                    assert!(!two_sided && x < 1.0, "no sample at {x}");
                    continue;
                };
                assert!(s.wi.is_finite() && s.pdf > 0.0 && s.distance >= 0.0, "at {x}: {s:?}");
                let hit = HitOnLight {
                    p: p + s.wi * s.distance,
                    ng: s.wi,
                    distance: s.distance,
                };
                assert_eq!(s.pdf, set.pdf(0, p, Vec3::ZERO, false, s.wi, &hit), "at {x}");
            }
        }
    }
}
