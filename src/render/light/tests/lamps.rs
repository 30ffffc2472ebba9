//! Lamps against their formulas, in f64.

use super::*;
use crate::math::stats::Pcg;
use std::f64::consts::PI as PI64;

fn at_distance(falloff: Falloff, r: f64) -> f64 {
    let set = LightSet::new(vec![point(DVec3::Z * r, Vec3::ONE, falloff)]);
    set.sample(Vec3::ZERO, Vec3::Z, false, 0.5, Vec2::ZERO, 0.0)
        .map_or(0.0, |s| f64::from(s.radiance.x) / f64::from(s.pdf))
}

#[test]
fn irradiance_falls_as_documented() {
    let close = |found: f64, exact: f64| assert!((found - exact).abs() <= 2e-6 * exact, "{found}, exactly {exact}");
    for r in [0.01, 1.0, 3.0, 1e4] {
        close(at_distance(Falloff::None, r), PI64);
        for power in [0.0, 1.0, 2.0, 3.5] {
            let fade = Falloff::Fade { distance: 2.0, power };
            close(at_distance(fade, r), PI64 * 2.0 / (1.0 + (r / 2.0).powf(power)));
        }
        close(at_distance(Falloff::InverseSquare { range: None }, r), 1.0 / (r * r));
        let window = (1.0 - (r / 4.0f64).powi(4)).clamp(0.0, 1.0);
        close(
            at_distance(Falloff::InverseSquare { range: Some(4.0) }, r),
            window / (r * r),
        );
    }
    assert_eq!(at_distance(Falloff::InverseSquare { range: None }, 0.0), 0.0);
}

fn factor(profile: SpotProfile, theta: f64) -> f64 {
    f64::from(profile.factor(DVec3::Z, DVec3::new(theta.sin(), 0.0, theta.cos())))
}

#[test]
fn spots_fall_with_the_angle_as_documented() {
    let (radius, falloff) = (0.3, 0.5);
    for tightness in [0.0, 10.0] {
        let pov = SpotProfile::Pov {
            radius,
            falloff,
            tightness,
        };
        for (theta, smooth) in [
            (0.0, 1.0),
            (0.2, 1.0),
            (0.4, 0.5),
            (0.45, 0.156_25),
            (0.51, 0.0),
            (3.0, 0.0),
        ] {
            let exact = smooth * f64::cos(theta).max(0.0).powf(tightness);
            let found = factor(pov, theta);
            assert!((found - exact).abs() < 3e-6, "{theta}: {found}, exactly {exact}");
        }
    }
    // Narrow cones keep their edge: cosines in f32 could not tell these angles apart.
    for size in [1.0, 1e-2, 1e-4] {
        let (inner, outer) = (0.3 * size, 0.5 * size);
        for theta in [0.0, 0.31 * size, 0.4 * size, 0.49 * size, 0.51 * size] {
            // cos a − cos b = 2·sin((a + b)/2)·sin((b − a)/2)
            let differ = |a: f64, b: f64| ((a + b) / 2.0).sin() * ((b - a) / 2.0).sin();
            let s: f64 = (differ(theta, outer) / differ(inner, outer)).clamp(0.0, 1.0);
            let found = factor(SpotProfile::Punctual { inner, outer }, theta);
            assert!((found - s * s).abs() < 1e-5, "{theta}: {found}, exactly {}", s * s);
        }
    }
}

#[test]
fn a_spot_shines_along_its_axis_only() {
    let spot = SpotLamp {
        position: DVec3::Z * 2.0,
        axis: -DVec3::Z,
        color: Vec3::ONE,
        profile: SpotProfile::Punctual { inner: 0.1, outer: 0.2 },
        falloff: Falloff::InverseSquare { range: None },
        casts_shadows: false,
    };
    let set = LightSet::new(vec![Light::Spot(Box::new(spot))]);
    let lit = set.sample(Vec3::ZERO, Vec3::Z, false, 0.5, Vec2::ZERO, 0.0);
    assert!(lit.is_some_and(|s| s.delta && !s.casts_shadow && s.radiance.x == 0.25 && s.wi == Vec3::Z));
    assert_eq!(set.sample(Vec3::X, Vec3::Z, false, 0.5, Vec2::ZERO, 0.0), None);
}

#[test]
fn the_sun_shines_from_where_it_comes() {
    let sun = DirectionalLamp {
        direction: -Vec3::Z,
        color: Vec3::new(1.0, 2.0, 3.0),
        casts_shadows: true,
    };
    let set = LightSet::new(vec![Light::Directional(sun)]);
    let s = set
        .sample(Vec3::ONE, Vec3::Z, false, 0.5, Vec2::ZERO, 0.0)
        .expect("lit");
    assert_eq!((s.wi, s.pdf, s.t_max), (Vec3::Z, 1.0, f32::INFINITY));
    assert!((s.radiance - Vec3::new(1.0, 2.0, 3.0) * std::f32::consts::PI).length() < 1e-6);
}

/// The mean over an area lamp of the positions that it shines from is its centre, their spread that of its shape.
#[test]
fn area_lamps_are_spread_evenly() {
    for (circular, spread) in [(false, 1.0 / 12.0), (true, 1.0 / 16.0)] {
        let lamp = AreaLamp {
            position: DVec3::new(1.0, 2.0, 10.0),
            axis1: DVec3::X * 4.0,
            axis2: DVec3::Y * 2.0,
            circular,
            spot: None,
            color: Vec3::ONE,
            falloff: Falloff::None,
            casts_shadows: true,
        };
        let set = LightSet::new(vec![Light::Area(Box::new(lamp))]);
        let mut rng = Pcg::new(17);
        let (n, mut sum, mut squares) = (100_000, DVec3::ZERO, DVec3::ZERO);
        for _ in 0..n {
            let s = set
                .sample(Vec3::ZERO, Vec3::Z, false, 0.5, rng.next_vec2(), 0.0)
                .expect("lit");
            assert!(s.delta && s.pdf == 1.0 && (s.radiance.x - std::f32::consts::PI).abs() < 1e-6);
            let q = s.wi.as_dvec3() * f64::from(s.distance) - lamp.position;
            sum += q;
            squares += q * q;
        }
        let (mean, variance) = (sum / f64::from(n), squares / f64::from(n));
        let sigma = (16.0 * spread / f64::from(n)).sqrt();
        assert!(mean.length() < 5.0 * sigma * 1.5, "{mean}");
        assert!((variance.x / (16.0 * spread) - 1.0).abs() < 0.02, "{variance}"); // 5 SE
        assert!((variance.y / (4.0 * spread) - 1.0).abs() < 0.02, "{variance}");
    }
}
