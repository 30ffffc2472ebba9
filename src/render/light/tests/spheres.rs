//! Spheres at the limits of f32: tiny and far, huge and near, touched and entered.

use super::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::stats::Pcg;

const U: f64 = UNIT_ROUNDOFF as f64;

/// 1 − cos of the half angle of the cone in which a sphere of radius s is seen from a distance of 1: 2·sin²(θ/2) with
/// sin θ = s. In f64, and by another way than the light's own.
fn one_minus_cos(s: f64) -> f64 {
    2.0 * (0.5 * s.asin()).sin().powi(2)
}

/// From all but touched to as far as f32 densities go.
const RATIOS: [f64; 15] = [
    0.999_999_9,
    0.9999,
    0.9,
    0.5,
    0.1,
    1e-2,
    1e-3,
    1e-4,
    1e-5,
    1e-6,
    1e-7,
    1e-8,
    1e-10,
    1e-14,
    1e-18,
];

/// Catalogue of hard cases H 43 and J 61: the density keeps its digits down to R/d = 1e-18, and so does E. The textbook's
/// 1 − cos is 7 % off at 1e-3 and 0 from 1e-4 on.
#[test]
fn tiny_far_spheres_keep_their_light() {
    for ratio in RATIOS {
        let center = DVec3::new(6e3, -3e3, 2e3); // exactly 7000 away
        let d = center.length();
        let light = sphere(center, ratio * d);
        let set = LightSet::new(vec![light.clone()]);
        let n = (center / d).as_vec3();
        let s = set
            .sample(Vec3::ZERO, n, false, 0.5, Vec2::new(0.7, 0.2), 0.0)
            .expect("visible");
        let exact = 1.0 / (std::f64::consts::TAU * one_minus_cos(ratio));
        assert!(
            (f64::from(s.pdf) / exact - 1.0).abs() < 4.0 * U,
            "R/d = {ratio}: {}, exactly {exact}",
            s.pdf
        );
        let e = irradiance(&light, Vec3::ZERO, n, 64) / (std::f64::consts::PI * ratio * ratio);
        // 64 × 64 midpoints of a function that has kinks at most.
        assert!((e - 1.0).abs() < 1e-3, "R/d = {ratio}: E is {e} of the exact one");
    }
}

/// Uniform over a cone about +z, where the components of a direction are its sine and nothing is rounded to the size of
/// the cosine: no sine exceeds that of the half angle by more than 4u, and they have their mean, which is 2/3 of it in
/// narrow cones, (θ − sin θ·cos θ)/(2·(1 − cos θ)) in all. With the sine from the cosine it is 2.7 % off at 1e-3.
#[test]
fn directions_fill_cones_evenly() {
    for ratio in RATIOS {
        let set = LightSet::new(vec![sphere(DVec3::Z * 1024.0, 1024.0 * ratio)]);
        let mut rng = Pcg::new(21);
        let (n, mut sum, mut squares) = (100_000, 0.0, 0.0);
        let sine = |u: Vec2| {
            let s = set.sample(Vec3::ZERO, Vec3::ZERO, false, 0.5, u, 0.0).expect("visible");
            let (x, y) = (f64::from(s.wi.x), f64::from(s.wi.y));
            let sine = x.hypot(y) / ratio;
            assert!(sine <= 1.0 + 4.0 * U, "R/d = {ratio}, {u}: {sine}");
            sine
        };
        for _ in 0..n {
            let s = sine(rng.next_vec2());
            (sum, squares) = (sum + s, squares + s * s);
        }
        // The rim.
        for i in 0..4096 {
            let s = sine(Vec2::new(1.0 - UNIT_ROUNDOFF, i as f32 / 4096.0));
            assert!(
                s >= 1.0 - 8.0 * U - 2.0 * U / (1.0 - ratio),
                "R/d = {ratio}: the rim is at {s}"
            );
        }
        let mean = sum / f64::from(n);
        let theta = ratio.asin();
        let exact = match ratio {
            0.0..1e-3 => 2.0 / 3.0,
            _ => 0.5 * (theta - ratio * theta.cos()) / one_minus_cos(ratio) / ratio,
        };
        let standard_error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
        assert!(
            (mean - exact).abs() < 5.0 * standard_error,
            "R/d = {ratio}: mean {mean}, exactly {exact}"
        );
    }
}

/// About any other axis a direction is rounded to u per component: the cone is that much wider, and no more.
#[test]
fn directions_stay_in_cones_about_any_axis() {
    let mut rng = Pcg::new(22);
    for ratio in RATIOS {
        for _ in 0..200 {
            let axis = crate::math::warp::uniform_sphere(rng.next_vec2())
                .as_dvec3()
                .normalize();
            let set = LightSet::new(vec![sphere(axis * 1e3, 1e3 * ratio)]);
            for _ in 0..50 {
                let s = set
                    .sample(Vec3::ZERO, Vec3::ZERO, false, 0.5, rng.next_vec2(), 0.0)
                    .expect("visible");
                let sine = s.wi.as_dvec3().cross(axis).length();
                // The axis, the frame, the sum of three vectors.
                assert!(sine <= ratio * (1.0 + 8.0 * U) + 8.0 * U, "R/d = {ratio}: {sine}");
            }
        }
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
                .sample(Vec3::ZERO, Vec3::ZERO, false, 0.5, rng.next_vec2(), 0.0)
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
                let Some(s) = set.sample(p, Vec3::ZERO, false, 0.5, u, 0.0) else {
                    assert!(!two_sided && x < 1.0, "no sample at {x}");
                    continue;
                };
                assert!(s.wi.is_finite() && s.pdf > 0.0 && s.distance >= 0.0, "at {x}: {s:?}");
                let hit = HitOnLight {
                    p: p + s.wi * s.distance,
                    ng: s.wi,
                    distance: s.distance,
                    time: 0.0,
                };
                assert_eq!(s.pdf, set.pdf(0, p, Vec3::ZERO, false, s.wi, &hit), "at {x}");
            }
        }
    }
}
