//! χ² of sampled directions against the stated density, the integral of the density, and sample = pdf.

use super::*;
use crate::math::stats::{Pcg, chi2_test};
use crate::math::warp::uniform_sphere;

const COLUMNS: usize = 24;
const ROWS: usize = 16;
const SAMPLES: usize = 200_000;

/// Compares a set with its own density at a receiver: over cells of equal solid angle about the mean direction,
/// counts of samples with integrals of the density (midpoint rule). Returns the p-value of the χ² test and ∫ pdf dω.
fn compare(set: &LightSet, at: &Receiver, fine: usize) -> (f64, f64) {
    let mut rng = Pcg::new(5);
    let mut samples = Vec::new();
    for _ in 0..SAMPLES {
        let (pick, u) = (rng.next_f32(), rng.next_vec2());
        if let Some(s) = set.sample(at.p, at.n, at.two_sided, pick, u, 0.0) {
            let stated = set_pdf_of(set, at, &s);
            // At the rim of a cap the rounding of the point counts 1/cos times.
            let tolerance = match set.get(s.light) {
                Some(Light::SphereCap(l)) => 1e-6 / f64::from(normal_on(l, at, &s).dot(s.wi).abs()),
                _ => 1e-4,
            };
            assert!(
                (f64::from(s.pdf) - stated).abs() <= tolerance * stated,
                "sample says {}, pdf says {stated}, wi = {}",
                s.pdf,
                s.wi
            );
            samples.push(s.wi.as_dvec3());
        }
    }
    let mean: DVec3 = samples.iter().sum();
    let axis = crate::math::robust::try_normalize(mean.as_vec3()).unwrap_or(Vec3::Z);
    let [x, y, z] = frame_of(axis);
    let widest = samples.iter().map(|w| 1.0 - w.dot(z)).fold(0.0, f64::max);
    let widest = (widest * 1.05).min(2.0);
    let mut observed = vec![0.0; ROWS * COLUMNS];
    for w in &samples {
        let row = ((1.0 - w.dot(z)) / widest * ROWS as f64) as usize;
        let turn = (w.dot(y).atan2(w.dot(x)) / std::f64::consts::TAU).rem_euclid(1.0);
        let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
        observed[row.min(ROWS - 1) * COLUMNS + column] += 1.0;
    }
    let mut expected = vec![0.0; ROWS * COLUMNS];
    let cell = widest * std::f64::consts::TAU / (ROWS * COLUMNS * fine * fine) as f64;
    for (i, e) in expected.iter_mut().enumerate() {
        for j in 0..fine * fine {
            let row = (i / COLUMNS) as f64 + ((j / fine) as f64 + 0.5) / fine as f64;
            let column = (i % COLUMNS) as f64 + ((j % fine) as f64 + 0.5) / fine as f64;
            let omc = row / ROWS as f64 * widest;
            let sin = (omc * (2.0 - omc)).sqrt();
            let phi = column / COLUMNS as f64 * std::f64::consts::TAU;
            let w = x * (sin * phi.cos()) + y * (sin * phi.sin()) + z * (1.0 - omc);
            *e += stated_pdf(set, at, w) * cell;
        }
    }
    let integral = expected.iter().sum();
    for e in &mut expected {
        *e *= SAMPLES as f64;
    }
    (chi2_test(&observed, &expected), integral)
}

/// Normal of the sphere at a sample of its cap.
fn normal_on(cap: &SphereCapLight, at: &Receiver, s: &LightSample) -> Vec3 {
    let q = at.p.as_dvec3() + s.wi.as_dvec3() * f64::from(s.distance);
    ((q - cap.sphere.center) / cap.sphere.radius).as_vec3()
}

/// What `pdf` says of a sample, at the place the sample itself names.
fn set_pdf_of(set: &LightSet, at: &Receiver, s: &LightSample) -> f64 {
    f64::from(match set.get(s.light) {
        Some(Light::Environment(_)) => set.environment_pdf(at.p, at.n, at.two_sided, s.wi),
        _ => {
            let hit = HitOnLight {
                p: at.p + s.wi * s.distance,
                ng: match set.get(s.light) {
                    Some(Light::SphereCap(l)) => normal_on(l, at, s),
                    _ => -s.wi,
                },
                distance: s.distance,
                time: 0.0,
            };
            set.pdf(s.light, at.p, at.n, at.two_sided, s.wi, &hit)
        }
    })
}

/// False alarm 1e-4 a case; the seed is fixed. ∫ pdf dω = 1 to the accuracy of the midpoint rule at edges.
fn check(name: &str, lights: Vec<Light>, at: Receiver) {
    let (p, integral) = compare(&LightSet::new(lights), &at, 32);
    assert!(p > 1e-4, "{name}: p = {p}, ∫ pdf = {integral}");
    assert!((integral - 1.0).abs() < 4e-3, "{name}: ∫ pdf = {integral}");
}

fn below() -> Receiver {
    receiver(Vec3::new(0.2, -0.1, 0.3), Vec3::Z)
}

#[test]
fn flat_lights_have_the_density_they_state() {
    let (a, b, c) = (
        Vec3::new(-1.0, -0.5, 2.0),
        Vec3::new(1.5, -1.0, 1.5),
        Vec3::new(0.0, 1.5, 2.5),
    );
    check("triangle from its front", vec![triangle(a, c, b, false)], below());
    check(
        "two-sided triangle from its back",
        vec![triangle(a, b, c, true)],
        below(),
    );
    let e = (Vec3::new(0.3, 1.0, 0.2), Vec3::new(1.5, 0.0, -0.3));
    check("parallelogram", vec![parallelogram(a, e.0, e.1)], below());
    let axes = (DVec3::new(0.2, 1.0, 0.1), DVec3::new(0.8, 0.0, 0.1));
    check(
        "disc",
        vec![disc(DVec3::new(0.5, 0.0, 2.0), axes.0, axes.1, 0.0)],
        below(),
    );
    check(
        "ring",
        vec![disc(DVec3::new(0.5, 0.0, 2.0), axes.0, axes.1, 0.6)],
        below(),
    );
}

/// Small enough for sampling by area.
#[test]
fn far_flat_lights_have_the_density_they_state() {
    let (a, b, c) = (
        Vec3::new(-1.0, -0.5, 9.0),
        Vec3::new(1.0, -1.0, 8.5),
        Vec3::new(0.0, 1.0, 9.5),
    );
    check("far triangle", vec![triangle(a, c, b, false)], below());
    check("far parallelogram", vec![parallelogram(a, c - a, b - a)], below());
}

#[test]
fn large_near_flat_lights_have_the_density_they_state() {
    let p0 = Vec3::new(-3.0, -3.0, 0.8);
    let quad = parallelogram(p0, Vec3::Y * 6.0, Vec3::X * 6.0);
    check("a ceiling", vec![quad], below());
    let tri = triangle(p0, p0 + Vec3::Y * 8.0, p0 + Vec3::X * 9.5, false);
    check("a large triangle", vec![tri], below());
}

#[test]
fn spheres_have_the_density_they_state_from_far_near_and_inside() {
    let c = DVec3::new(0.0, 1.0, 3.0);
    check("sphere", vec![sphere(c, 1.0)], below());
    check(
        "sphere nearby",
        vec![sphere(c, (c - below().p.as_dvec3()).length() - 1e-3)],
        below(),
    );
    let Light::Sphere(outside) = sphere(c, 5.0) else { return };
    let both = Light::Sphere(SphereLight {
        two_sided: true,
        ..outside
    });
    check("inside, no normal", vec![both.clone()], receiver(below().p, Vec3::ZERO));
    check("inside, with a normal", vec![both], below());
    // From inside, a sphere that shines only outwards is never sampled, and says so.
    let set = LightSet::new(vec![Light::Sphere(outside)]);
    assert_eq!(set.sample(below().p, Vec3::Z, false, 0.5, Vec2::splat(0.3), 0.0), None);
}

#[test]
fn caps_have_the_density_they_state() {
    let down = DVec3::new(0.0, 0.28, -0.96);
    check(
        "flat cap",
        vec![cap(DVec3::new(0.0, 0.0, 12.0), 10.0, down, 0.01)],
        below(),
    );
    // Seen whole: points that face away would be no samples, and ∫ pdf less than 1.
    let down = DVec3::new(0.0, -0.28, -0.96);
    check(
        "round cap",
        vec![cap(DVec3::new(0.0, 1.0, 3.0), 1.0, down, 0.4)],
        below(),
    );
    // Outside the cap nothing is sampled, and the density says so.
    let set = LightSet::new(vec![cap(DVec3::Z * 3.0, 1.0, DVec3::Y, 0.5)]);
    let hit = HitOnLight {
        p: Vec3::Z * 2.0,
        ng: -Vec3::Z,
        distance: 2.0,
        time: 0.0,
    };
    assert_eq!(set.pdf(0, Vec3::ZERO, Vec3::Z, false, Vec3::Z, &hit), 0.0);
}

#[test]
fn skies_have_the_density_they_state() {
    let constant = || Light::Environment(Box::new(EnvironmentLight::Constant(Vec3::ONE)));
    check("constant sky", vec![constant()], below());
    check(
        "constant sky without a normal",
        vec![constant()],
        receiver(Vec3::ZERO, Vec3::ZERO),
    );
    let image = sky::image(8, 5, 3).map(|i| Light::Environment(Box::new(EnvironmentLight::Image(i))));
    check("sky image", image.into_iter().collect(), below());
}

#[test]
fn a_choice_of_lights_has_the_density_it_states() {
    let c = DVec3::new(0.0, 1.0, 3.0);
    let (a, b) = (Vec3::new(-2.0, -2.0, 2.0), Vec3::new(0.0, -2.0, 1.0));
    let lights = vec![
        sphere(c, 0.7),
        triangle(a, b, Vec3::new(-2.0, 0.0, 1.0), true),
        Light::Environment(Box::new(EnvironmentLight::Constant(Vec3::splat(0.3)))),
        parallelogram(Vec3::new(1.0, 0.0, 2.0), Vec3::Y, Vec3::X),
        sphere(DVec3::new(2.0, -3.0, 2.0), 1.0),
        cap(DVec3::new(-3.0, 3.0, 3.0), 1.0, DVec3::new(0.6, -0.8, 0.0), 0.4),
    ];
    let two_sided = Receiver {
        two_sided: true,
        ..below()
    };
    check("six lights", lights.clone(), below());
    check("six lights seen by both sides", lights, two_sided);
}

#[test]
fn densities_of_sample_and_pdf_agree_at_extreme_sizes() {
    let mut rng = Pcg::new(9);
    for exponent in [-18, -10, -5, 0, 5, 10, 18] {
        let size = 10f32.powi(exponent);
        for _ in 0..1000 {
            let mut point = || uniform_sphere(rng.next_vec2());
            let p = point() * 0.3 * size;
            let corner = (point() + Vec3::Z * 3.0) * size;
            let (a, b) = (corner + point() * size, corner + point() * size);
            let set = LightSet::new(vec![triangle(corner, a, b, true)]);
            let at = receiver(p, Vec3::ZERO);
            if let Some(s) = set.sample(at.p, at.n, false, 0.5, Vec2::new(0.3, 0.6), 0.0) {
                let stated = set_pdf_of(&set, &at, &s);
                let plane = (a - corner).as_dvec3().cross((b - corner).as_dvec3()).normalize();
                let cos = plane.dot(s.wi.as_dvec3()).abs(); // the rounding of wi counts 1/cos times
                assert!(
                    (f64::from(s.pdf) / stated - 1.0).abs() < 1e-6 / cos,
                    "size {size}: {} and {stated}",
                    s.pdf
                );
            }
        }
    }
}
