//! Irradiance of each shape against closed forms, without noise: `sample` is integrated over its own random numbers.

use super::*;

const PI64: f64 = std::f64::consts::PI;

fn close(name: &str, found: f64, exact: f64, relative: f64) {
    assert!(
        (found / exact - 1.0).abs() < relative,
        "{name}: {found}, exactly {exact}"
    );
}

/// E = π·L·R²/d²·cos θ for a sphere wholly above the horizon (Lambert).
#[test]
fn a_sphere_gives_its_irradiance() {
    let n = Vec3::new(0.0, 0.6, 0.8);
    for (center, radius) in [
        (DVec3::new(0.0, 0.0, 5.0), 1.0),
        (DVec3::new(1.0, 4.0, 3.0), 0.01),
        (DVec3::new(0.0, 0.6, 0.8) * 3.0, 2.9),
    ] {
        let d2 = center.length_squared();
        let exact = PI64 * radius * radius / d2 * (center / d2.sqrt()).dot(n.as_dvec3());
        close(
            "sphere",
            irradiance(&sphere(center, radius), Vec3::ZERO, n, 256),
            exact,
            1e-4,
        );
    }
}

/// E = π·L·R²/(R² + h²) on the axis.
#[test]
fn a_disc_gives_its_irradiance_on_the_axis() {
    for (r, h) in [(1.0, 1.0), (5.0, 0.5), (0.001, 2.0)] {
        // The axes make a front that faces down.
        let light = disc(DVec3::Z * h, DVec3::Y * r, DVec3::X * r, 0.0);
        let exact = PI64 * r * r / (r * r + h * h);
        close("disc", irradiance(&light, Vec3::ZERO, Vec3::Z, 512), exact, 2e-3);
        let ring = disc(DVec3::Z * h, DVec3::Y * r, DVec3::X * r, 0.5);
        let hole = PI64 * r * r / (r * r + 4.0 * h * h);
        close("ring", irradiance(&ring, Vec3::ZERO, Vec3::Z, 512), exact - hole, 2e-3);
    }
}

/// A cap that is seen whole covers the same directions as the disc within its rim: E = π·L·ρ²/(ρ² + h²) on the axis.
/// The second is the lecture's lamp: R = 600, 0.27 below the ceiling, seen from the floor.
#[test]
fn a_cap_gives_the_irradiance_of_its_rim() {
    for (radius, x, middle) in [(10.0, 0.01, 2.0), (600.0, 0.27 / 600.0, 81.33), (1e7, 1e-12, 50.0)] {
        let light = cap(DVec3::Z * (middle + radius), radius, -DVec3::Z, x);
        let (rim2, h) = (radius * radius * x * (2.0 - x), middle + radius * x);
        let exact = PI64 * rim2 / (rim2 + h * h);
        close("cap", irradiance(&light, Vec3::ZERO, Vec3::Z, 256), exact, 1e-4);
    }
}

/// Lambert's formula for a polygon wholly above the horizon: E = L/2·Σ θi·(Γi·n), θi the angle between neighbouring
/// corners, Γi the unit normal of their plane.
fn lambert(corners: &[DVec3], n: DVec3) -> f64 {
    let mut sum = 0.0;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let c = a.cross(b);
        sum += c.length().atan2(a.dot(b)) * c.normalize().dot(n);
    }
    (sum * 0.5).abs()
}

#[test]
fn polygons_give_lamberts_irradiance() {
    let n = Vec3::new(0.0, 0.28, 0.96);
    // Near ones are sampled by solid angle, far ones by area.
    for (scale, height) in [
        (1.0f32, 0.0),
        (1e-9, 0.0),
        (1e9, 0.0),
        (1.0, 8.0),
        (1e-9, 8.0),
        (1e9, 8.0),
    ] {
        let (a, b, c) = (
            Vec3::new(-1.0, -0.5, height + 2.0) * scale,
            Vec3::new(1.5, -1.0, height + 1.5) * scale,
            Vec3::new(0.0, 1.5, height + 2.5) * scale,
        );
        let exact = lambert(&[a, b, c].map(|v| v.as_dvec3()), n.as_dvec3());
        close(
            "triangle",
            irradiance(&triangle(a, b, c, true), Vec3::ZERO, n, 256),
            exact,
            1e-4,
        );
        let corners = [a, a + (c - a), c + (b - a), b].map(|v| v.as_dvec3());
        let exact = lambert(&corners, n.as_dvec3());
        let quad = parallelogram(a, c - a, b - a);
        close("parallelogram", irradiance(&quad, Vec3::ZERO, n, 256), exact, 1e-4);
    }
}

/// A ceiling close by: most of the light comes at steep angles.
#[test]
fn a_large_near_parallelogram_gives_lamberts_irradiance() {
    let (p0, e1, e2) = (Vec3::new(-5.0, -4.0, 1.0), Vec3::Y * 9.0, Vec3::X * 10.0);
    let corners = [p0, p0 + e1, p0 + e1 + e2, p0 + e2].map(|v| v.as_dvec3());
    let exact = lambert(&corners, DVec3::Z);
    close(
        "ceiling",
        irradiance(&parallelogram(p0, e1, e2), Vec3::ZERO, Vec3::Z, 512),
        exact,
        1e-3,
    );
}

/// Coordinates, direction and distance of a sample name the same point, near and far.
#[test]
fn samples_say_where_on_the_polygon_they_lie() {
    for height in [0.5f32, 2.0, 20.0] {
        let (p0, e1, e2) = (
            Vec3::new(-1.0, -2.0, height),
            Vec3::new(0.5, 3.0, 0.1),
            Vec3::new(2.0, 0.3, -0.2),
        );
        for light in [triangle(p0, p0 + e1, p0 + e2, true), parallelogram(p0, e1, e2)] {
            let set = LightSet::new(vec![light]);
            for i in 0..400 {
                let u = Vec2::new((i % 20) as f32 + 0.5, (i / 20) as f32 + 0.5) / 20.0;
                let Some(s) = set.sample(Vec3::ZERO, Vec3::Z, false, 0.5, u, 0.0) else {
                    panic!("nothing seen from {height} below at {u}");
                };
                let off = (p0 + e1 * s.b.x + e2 * s.b.y - s.wi * s.distance).length();
                assert!(off < 4e-7 * (s.distance + 4.0) * 4.0, "{height} below: off by {off}");
                assert!(s.b.min_element() >= 0.0 && s.b.max_element() <= 1.0, "{}", s.b);
            }
        }
    }
}

#[test]
fn a_constant_sky_gives_pi() {
    let sky = Light::Environment(Box::new(EnvironmentLight::Constant(Vec3::ONE)));
    close("sky", irradiance(&sky, Vec3::ZERO, Vec3::X, 64), PI64, 1e-6);
}

#[test]
fn dark_sides_and_points_on_the_light_give_no_sample() {
    let quad = parallelogram(Vec3::ZERO, Vec3::X, Vec3::Y); // shines towards +z
    let set = LightSet::new(vec![quad]);
    let u = Vec2::splat(0.5);
    assert!(
        set.sample(Vec3::new(0.5, 0.5, 1.0), Vec3::ZERO, false, 0.0, u, 0.0)
            .is_some()
    );
    assert!(
        set.sample(Vec3::new(0.5, 0.5, -1.0), Vec3::ZERO, false, 0.0, u, 0.0)
            .is_none()
    );
    assert!(
        set.sample(Vec3::new(0.5, 0.5, 0.0), Vec3::ZERO, false, 0.0, u, 0.0)
            .is_none()
    );
    assert!(
        set.sample(Vec3::new(9.0, 0.5, 0.0), Vec3::ZERO, false, 0.0, u, 0.0)
            .is_none()
    );
    let flat = triangle(Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z + Vec3::X * 2.0, true);
    assert!(
        LightSet::new(vec![flat])
            .sample(Vec3::ZERO, Vec3::Z, false, 0.0, u, 0.0)
            .is_none()
    );
}
