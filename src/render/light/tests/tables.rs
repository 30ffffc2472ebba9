//! A million emitters: the probabilities that are stated are those that are used.

use super::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::stats::{Pcg, chi2_test};
use crate::math::warp::uniform_sphere;
use crate::render::technique::LightPick;

const COUNT: u32 = 1_000_000;

/// Triangles that shine to both sides, of sizes and strengths over four orders each.
fn million() -> Vec<Light> {
    let mut rng = Pcg::new(48);
    (0..COUNT)
        .map(|_| {
            let p = uniform_sphere(rng.next_vec2()) * 10.0 * rng.next_f32();
            let size = 1e-4 * 10f32.powf(2.0 * rng.next_f32());
            let (a, b) = (uniform_sphere(rng.next_vec2()), uniform_sphere(rng.next_vec2()));
            match triangle(p, p + a * size, p + b * size, true) {
                Light::Triangle(l) => Light::Triangle(TriangleLight {
                    radiance: Vec3::splat(10f32.powf(4.0 * rng.next_f32())),
                    ..l
                }),
                other => other,
            }
        })
        .collect()
}

/// The numbers for which `light` is chosen: [low, high), by bisection from one for which it is. Choices are made by
/// intervals, in order, so a number between two for one light is for that light too.
fn interval(set: &LightSet, at: &Receiver, light: u32, inside: f64) -> (f64, f64) {
    let chosen = |u: f64| set.choose(at, u).is_some_and(|(l, _)| l == light);
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if chosen(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        0.5 * (inside + outside)
    };
    (edge(inside, 0.0), edge(inside, 1.0))
}

/// Catalogue of hard cases H 48: sums in f32 put single probabilities off by a quarter. Here, for a choice by what
/// shines at the receiver, by power, and evenly:
/// - all probabilities sum to 1. Fixed ones are differences of f64, rounded to f32 once. In the tree a branch takes p and
///   1 − p, two roundings a level, so that the sum is off by 2u times the depth at most, here below 64;
/// - a choice states the probability that is found for that light, bit for bit;
/// - 300 lights have an interval of numbers as long as the probability they state: to 3u a level, and in steps of f64;
/// - 400 000 choices, with the numbers the renderer has, fall into a thousand bins as often as stated (χ²; one false
///   alarm in ten thousand).
#[test]
fn a_million_emitters_state_the_probability_they_have() {
    let lights = million();
    for pick in [LightPick::Tree, LightPick::Power, LightPick::Uniform] {
        let set = LightSet::with_pick(lights.clone(), pick, None);
        let at = receiver(Vec3::new(0.3, 0.2, 0.1), Vec3::ZERO);
        let depth = if pick == LightPick::Tree { 64.0 } else { 1.0 };
        let u = f64::from(UNIT_ROUNDOFF);

        let stated: Vec<f64> = (0..COUNT).map(|i| f64::from(set.probability(i, &at))).collect();
        let sum: f64 = stated.iter().sum();
        assert!(
            (sum - 1.0).abs() <= 2.0 * u * depth,
            "{pick:?}: all probabilities sum to {sum}"
        );

        let mut rng = Pcg::new(7);
        for _ in 0..300 {
            let number = rng.next_f64();
            let (light, probability) = set.choose(&at, number).expect("every light shines here");
            assert_eq!(probability, set.probability(light, &at), "{pick:?}: light {light}");
            let (low, high) = interval(&set, &at, light, number);
            let (used, stated) = (high - low, f64::from(probability));
            let allowed = 3.0 * u * depth * stated + 4.0 * depth * f64::EPSILON;
            assert!(
                (used - stated).abs() <= allowed,
                "{pick:?}: light {light} has {used} and states {stated}"
            );
        }

        let (draws, bins) = (400_000, 1000);
        let mut found = vec![0.0; bins];
        for _ in 0..draws {
            let s = set.sample(at.p, at.n, false, rng.next_f32(), rng.next_vec2(), 0.0);
            // A triangle seen edge-on gives no direction; the choice was made all the same.
            if let Some(s) = s {
                found[s.light as usize * bins / COUNT as usize] += 1.0;
            }
        }
        let got: f64 = found.iter().sum();
        assert!(got > 0.999 * f64::from(draws), "{pick:?}: {got} of {draws}");
        let expected: Vec<f64> = stated
            .chunks(COUNT as usize / bins)
            .map(|chunk| chunk.iter().sum::<f64>() * got)
            .collect();
        let p = chi2_test(&found, &expected);
        assert!(p > 1e-4, "{pick:?}: p = {p}");
    }
}

/// A sky of a million cells: the densities it states, times the solid angles of its cells, sum to 1; each is rounded to
/// f32 once, and single cells are found in steps of 2⁻³² of their row.
#[test]
fn a_sky_of_a_million_cells_states_the_density_it_has() {
    let (w, h) = (1024u32, 1024u32);
    let mut rng = Pcg::new(49);
    let texels = (0..w * h).map(|_| [10f32.powf(6.0 * rng.next_f32()); 3]).collect();
    let image = EnvironmentImage::new(w, h, texels, glam::DMat3::IDENTITY, false).expect("a valid image");
    let sky = EnvironmentLight::Image(image);
    let at = receiver(Vec3::ZERO, Vec3::ZERO);
    // Cells lie between the centres of texels; the first and the last row are caps of half height.
    let edge = |j: u32| match j {
        0 => 0.0,
        j if j == h + 1 => std::f64::consts::PI,
        j => std::f64::consts::PI * (f64::from(j) - 0.5) / f64::from(h),
    };
    let mut sum = 0.0;
    for j in 0..=h {
        let solid_angle = std::f64::consts::TAU * (edge(j).cos() - edge(j + 1).cos()) / f64::from(w);
        let (sin, cos) = (0.5 * (edge(j) + edge(j + 1))).sin_cos();
        for i in 0..w {
            let phi = std::f64::consts::TAU * f64::from(i) / f64::from(w);
            let wi = DVec3::new(sin * phi.sin(), cos, sin * phi.cos()).as_vec3();
            sum += f64::from(sky.pdf(&at, wi)) * solid_angle;
        }
    }
    let u = f64::from(UNIT_ROUNDOFF);
    assert!((sum - 1.0).abs() < u + 1e-9, "{sum}");
    for _ in 0..100_000 {
        if let Some(s) = sky.sample(&at, rng.next_vec2()) {
            assert_eq!(s.pdf, sky.pdf(&at, s.wi));
        }
    }
}
