//! Lights that touch the floor or cross it, pixel by pixel against f64; and shadow rays that nothing may block.

use crate::lamps::expected;
use crate::support::scenes::ready;
use crate::support::ztest;
use glam::{DVec3, Vec2};
use pts::math::stats::Pcg;
use std::f64::consts::{FRAC_PI_2, PI};

/// Radiance of the floor over its irradiance: albedo 0.5, light of 10.
const PER_IRRADIANCE: f64 = 0.5 / PI * 10.0;

/// Blocks of 2×2 pixels against the closed form, one false alarm in a thousand; noise below 3 % of the light.
#[track_caller]
fn assert_floor(defines: &[(&str, &str)], irradiance: impl Fn(DVec3) -> f64) {
    let found = ready("tests/hard/lamps/contact.pts", defines, [24, 24]).estimate(1024, 1);
    let wanted = expected(|p| PER_IRRADIANCE * irradiance(p));
    let verdict = ztest::compare(&found, &wanted, 2, 1e-3);
    assert!(verdict.agree(), "{defines:?}: {verdict}");
    let level: f64 = found.mean.iter().map(|m| m[1]).sum();
    let noise: f64 = found.variance.iter().map(|v| v[1].sqrt()).sum();
    assert!(
        level > 0.0 && noise < 0.03 * level,
        "{defines:?}: noise {noise} in {level}"
    );
}

/// Irradiance on a floor from the part of a ball of radius 1 above it; `to` is the way to its centre. Over the azimuth φ
/// about the zenith, ∫cosθ·sinθ dθ = sin²θ/2 between the ball's edges and above the horizon. The ball, which is beside the
/// point, is seen for |sin φ| < 1/|to across|; midpoints in ψ with φ = φmax·sin ψ, for which its edges are no roots.
fn above_the_floor(to: DVec3) -> f64 {
    const STEPS: u32 = 100;
    let d = to.length();
    let (cos_axis, sin_axis) = (to.y / d, (to.x * to.x + to.z * to.z).sqrt() / d);
    let cos_ball = (1.0 - 1.0 / (d * d)).sqrt();
    let slice = |phi: f64| {
        let (a, b) = (sin_axis * phi.cos(), cos_axis);
        let reach = a.hypot(b);
        if reach <= cos_ball {
            return 0.0;
        }
        let (middle, half) = (a.atan2(b), (cos_ball / reach).acos());
        let (low, high) = ((middle - half).max(0.0), (middle + half).min(FRAC_PI_2));
        if high > low {
            0.5 * (high.sin().powi(2) - low.sin().powi(2))
        } else {
            0.0
        }
    };
    let widest = (1.0 / to.x.hypot(to.z)).asin();
    let step = PI / f64::from(STEPS);
    (0..STEPS)
        .map(|i| (f64::from(i) + 0.5) * step - FRAC_PI_2)
        .map(|psi| slice(widest * psi.sin()) * widest * psi.cos() * step)
        .sum()
}

/// Catalogue of hard cases J 60: E = π·R³/(R² + x²)^(3/2) where a ball rests on the floor, x from the place of contact.
/// At any size. The same closed form holds the quadrature that judges the others.
#[test]
fn a_ball_that_touches_the_floor_lights_it() {
    let center = DVec3::new(-2.05, 1.0, 0.0);
    let resting = |p: DVec3| {
        let x2 = (p.x - center.x).powi(2) + p.z * p.z;
        PI / (1.0 + x2).powf(1.5)
    };
    for p in [DVec3::ZERO, DVec3::new(-1.0, 0.0, 0.3), DVec3::new(0.9, 0.0, -1.0)] {
        assert!(
            (above_the_floor(center - p) / resting(p) - 1.0).abs() < 1e-4,
            "the quadrature is off at {p}"
        );
    }
    for size in ["1", "1e-4", "1e4"] {
        assert_floor(&[("S", size)], resting);
    }
}

/// A ball that the floor cuts, or all but touches, from a small cap above it to nearly all of it.
#[test]
fn a_ball_that_the_floor_cuts_lights_it() {
    for height in ["-0.8", "0", "0.5", "0.999999", "1.000001"] {
        let center = DVec3::new(-2.05, height.parse().expect("a number"), 0.0);
        assert_floor(&[("H", height)], |p| above_the_floor(center - p));
    }
}

/// The upper half of an upright rectangle that the floor cuts, by Lambert's formula for polygons.
#[test]
fn a_rectangle_that_the_floor_cuts_lights_it() {
    let corners = [(0.0, -0.5), (0.0, 0.5), (1.0, 0.5), (1.0, -0.5)].map(|(y, z)| DVec3::new(-1.05, y, z));
    assert_floor(&[("Which", "1")], |p| {
        let edges = corners.iter().zip(corners.iter().cycle().skip(1));
        let edge = |(a, b): (&DVec3, &DVec3)| {
            let across = (a - p).cross(b - p);
            let angle = across.length().atan2((a - p).dot(b - p));
            angle * across.y / across.length()
        };
        0.5 * edges.map(edge).sum::<f64>().abs()
    });
}

/// Catalogue of hard cases J 63: of rays aimed at a ball of R/d = 1e-7 the nearest hit is not the ball for a third, even
/// with a direction that is right to the last bit. Here none is lost, of any light, from the floor or from the wall just
/// behind: what ends in front of the light cannot be blocked by it, nor by what is behind.
#[test]
fn no_shadow_ray_to_an_extreme_light_is_lost() {
    let mut rng = Pcg::new(63);
    for which in ["0", "1", "2", "3", "4", "5", "6", "7"] {
        let scene = ready("tests/hard/lamps/shadows.pts", &[("Which", which)], [8, 8]).compiled;
        let (mut aimed, mut lost) = (0, 0);
        for _ in 0..100_000 {
            let camera_ray = scene
                .camera
                .ray(rng.next_f64() - 0.5, rng.next_f64() - 0.5, Vec2::ZERO, 0.0);
            let hit = scene.geometry.closest(&camera_ray).expect("the floor");
            let surface = scene.geometry.surface(&camera_ray, &hit);
            let light = scene
                .lights
                .sample(surface.p, surface.ng, false, rng.next_f32(), rng.next_vec2(), 0.0);
            let Some(light) = light.filter(|l| l.wi.dot(surface.ng) > 0.0) else {
                continue;
            };
            aimed += 1;
            lost += u32::from(scene.geometry.occluded(&light.shadow_ray(&surface)));
        }
        assert!(
            aimed > 10_000 && lost == 0,
            "light {which}: {lost} of {aimed} shadow rays are lost"
        );
    }
}
