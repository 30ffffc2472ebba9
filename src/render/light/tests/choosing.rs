//! The choice among lights: probabilities that sum to 1, that are realised, and that starve no light.

use super::*;
use crate::math::stats::Pcg;
use crate::math::warp::uniform_sphere;
use crate::render::technique::{Choice, LightPick};

fn cloud(n: u32, seed: u64) -> Vec<Light> {
    let mut rng = Pcg::new(seed);
    (0..n)
        .map(|_| {
            let p = uniform_sphere(rng.next_vec2()) * 10.0 * rng.next_f32();
            let e1 = uniform_sphere(rng.next_vec2()) * 0.1;
            let e2 = uniform_sphere(rng.next_vec2()) * 0.1 * rng.next_f32();
            let brightness = 10f32.powf(4.0 * rng.next_f32());
            match triangle(p, p + e1, p + e2, rng.next_f32() < 0.3) {
                Light::Triangle(l) => Light::Triangle(TriangleLight {
                    radiance: Vec3::splat(brightness),
                    ..l
                }),
                other => other,
            }
        })
        .collect()
}

/// Every kind of light, several of each.
fn mixture() -> Vec<Light> {
    let mut lights = cloud(20, 77);
    let spot = SpotProfile::Punctual { inner: 0.5, outer: 1.9 };
    for i in 0..4 {
        let q = DVec3::new(f64::from(i), 3.0, 2.0);
        let inverse = Falloff::InverseSquare { range: None };
        lights.push(point(q, Vec3::splat(10.0), inverse));
        lights.push(point(-q, Vec3::splat(0.2), Falloff::None));
        lights.push(Light::Spot(Box::new(SpotLamp {
            position: q * 2.0,
            axis: -q.normalize(),
            color: Vec3::ONE,
            profile: spot,
            falloff: inverse,
            casts_shadows: true,
        })));
        lights.push(sphere(-q * 2.0, 0.5));
        lights.push(cap(q * 3.0, 1.0, DVec3::new(0.0, -0.6, 0.8), 0.3));
    }
    lights.push(Light::Directional(DirectionalLamp {
        direction: -Vec3::Z,
        color: Vec3::ONE,
        casts_shadows: true,
    }));
    lights.push(Light::Environment(Box::new(EnvironmentLight::Constant(Vec3::splat(
        0.1,
    )))));
    lights
}

fn receivers(n: usize, seed: u64) -> Vec<Receiver> {
    let mut rng = Pcg::new(seed);
    (0..n)
        .map(|i| Receiver {
            p: uniform_sphere(rng.next_vec2()) * 12.0 * rng.next_f32(),
            n: if i % 3 == 0 {
                Vec3::ZERO
            } else {
                uniform_sphere(rng.next_vec2())
            },
            two_sided: i % 3 == 1,
        })
        .collect()
}

fn total(set: &LightSet, at: &Receiver) -> f64 {
    (0..set.len() as u32).map(|i| f64::from(set.probability(i, at))).sum()
}

/// Branches into which nothing shines give no light; what is left sums to the chance of getting one.
#[test]
fn probabilities_sum_to_one_or_to_the_chance_of_a_light() {
    for (set, count) in [
        (LightSet::new(cloud(1000, 1)), 100),
        (LightSet::new(mixture()), 300),
        (LightSet::new(cloud(2, 5)), 300),
        (LightSet::new(cloud(100_000, 6)), 4),
    ] {
        for at in receivers(count, 3) {
            let sum = total(&set, &at);
            assert!(sum < 1.0 + 1e-5, "{sum} at {at:?}");
            let k = 1 << 14;
            let chosen = (0..k)
                .filter(|i| set.choose(&at, (f64::from(*i) + 0.5) / f64::from(k)).is_some())
                .count();
            let chance = chosen as f64 / f64::from(k);
            assert!((sum - chance).abs() < 2e-3, "{sum}, but chosen {chance} at {at:?}");
        }
    }
}

/// Oracle: even numbers from 0 to 1 are counted.
#[test]
fn stated_probabilities_are_the_realised_ones() {
    let trees = [mixture(), cloud(50, 9), mixture().split_off(20)].map(LightSet::new);
    let fixed = [LightPick::Power, LightPick::Uniform].map(|pick| LightSet::with_pick(mixture(), pick, None));
    for set in trees.into_iter().chain(fixed) {
        for at in receivers(6, 14) {
            let k = 1 << 18;
            let mut counts = vec![0u32; set.len()];
            for i in 0..k {
                if let Some((light, probability)) = set.choose(&at, (f64::from(i) + 0.5) / f64::from(k)) {
                    counts[light as usize] += 1;
                    assert_eq!(probability, set.probability(light, &at), "light {light} at {at:?}");
                }
            }
            for (i, &count) in (0u32..).zip(&counts) {
                let (found, stated) = (f64::from(count) / f64::from(k), f64::from(set.probability(i, &at)));
                assert!(
                    (found - stated).abs() < 2.0 / f64::from(k) + 1e-6,
                    "light {i}: {found}, stated {stated}"
                );
            }
        }
    }
}

/// What contributes anywhere on a light must have a probability.
#[test]
fn no_contributing_light_is_starved() {
    let sets = LightPick::ALL.iter().flat_map(|(pick, ..)| {
        let make = |lights: Vec<Light>| (LightSet::with_pick(lights.clone(), *pick, None), lights);
        [make(mixture()), make(cloud(300, 10))]
    });
    for (set, lights) in sets {
        let single: Vec<LightSet> = lights.iter().map(|l| LightSet::new(vec![l.clone()])).collect();
        let mut rng = Pcg::new(44);
        for at in receivers(60, 15) {
            for (i, alone) in (0u32..).zip(&single) {
                for _ in 0..4 {
                    let Some(s) = alone.sample(at.p, at.n, at.two_sided, 0.5, rng.next_vec2(), 0.0) else {
                        continue;
                    };
                    if at.cosine(s.wi) > 0.0 {
                        assert!(set.probability(i, &at) > 0.0, "light {i} at {at:?}");
                    }
                }
            }
        }
    }
}

/// Of two spheres the one with twice the radius and three times the radiance has twelve times the power; the sun and the
/// sky have that which reaches the box they are told of. Even choice asks only whether there is light at all.
#[test]
fn fixed_choices_are_by_power_or_even() {
    let bright = |r: f64, l: f32| match sphere(DVec3::new(r * 3.0, 1.0, 0.0), r) {
        Light::Sphere(s) => Light::Sphere(SphereLight {
            radiance: Vec3::splat(l),
            two_sided: false,
            ..s
        }),
        other => other,
    };
    let sky = |l: f32| Light::Environment(Box::new(EnvironmentLight::Constant(Vec3::splat(l))));
    let lights = vec![bright(1.0, 1.0), bright(2.0, 3.0), sky(0.5), sky(0.0)];
    // A box of diagonal 40 around everything: radius 20.
    let half = 20.0 / 3f32.sqrt();
    let bounds = Some((Vec3::splat(-half), Vec3::splat(half)));
    let at = &receivers(1, 3)[0];
    let of = |pick| {
        let set = LightSet::with_pick(lights.clone(), pick, bounds);
        [0, 1, 2, 3].map(|i| set.probability(i, at))
    };
    // Flux of a sphere: π·L·4πr²; of the sky through a sphere: π·L·4πr² as well.
    let powers = [1.0, 12.0, 0.5 * 400.0, 0.0];
    let sum: f32 = powers.iter().sum();
    for (found, power) in of(LightPick::Power).into_iter().zip(powers) {
        let even = if power > 0.0 { 1.0 / 3.0 / 1024.0 } else { 0.0 };
        let expected = power / sum * (1.0 - 1.0 / 1024.0) + even;
        assert!((found - expected).abs() < 1e-4, "{found} instead of {expected}");
    }
    let third = 1.0 / 3.0;
    for (found, expected) in of(LightPick::Uniform).into_iter().zip([third, third, third, 0.0]) {
        assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
    }
}

/// The tree is worth its price: beside even choice the variance of the irradiance falls at least fivefold.
#[test]
fn the_tree_prefers_what_matters() {
    let lights = cloud(2000, 20);
    let set = LightSet::new(lights.clone());
    let single: Vec<LightSet> = lights.iter().map(|l| LightSet::new(vec![l.clone()])).collect();
    let mut rng = Pcg::new(45);
    let (mut by_tree, mut evenly) = (0.0, 0.0);
    for at in receivers(30, 16) {
        let spread = |rng: &mut Pcg, even: bool| {
            let (n, mut sum, mut squares) = (2000, 0.0, 0.0);
            for _ in 0..n {
                let (pick, u) = (rng.next_f32(), rng.next_vec2());
                let v = if even {
                    let i = (pick * lights.len() as f32) as usize;
                    let s = single[i].sample(at.p, at.n, at.two_sided, 0.5, u, 0.0);
                    s.map_or(0.0, |s| {
                        f64::from(at.cosine(s.wi).max(0.0) * s.radiance.x / s.pdf) * lights.len() as f64
                    })
                } else {
                    let s = set.sample(at.p, at.n, at.two_sided, pick, u, 0.0);
                    s.map_or(0.0, |s| f64::from(at.cosine(s.wi).max(0.0) * s.radiance.x / s.pdf))
                };
                sum += v;
                squares += v * v;
            }
            let mean = sum / f64::from(n);
            (mean, squares / f64::from(n) - mean * mean)
        };
        // Relative to the better known of the two means.
        let (mean, variance) = spread(&mut rng, false);
        by_tree += variance / (mean * mean);
        evenly += spread(&mut rng, true).1 / (mean * mean);
    }
    assert!(by_tree * 5.0 < evenly, "tree {by_tree}, evenly {evenly}");
}

#[test]
fn coincident_lights_and_extreme_strengths_are_sound() {
    let inverse = Falloff::InverseSquare { range: None };
    let set = LightSet::new((0..1000).map(|_| point(DVec3::Z, Vec3::ONE, inverse)).collect());
    let at = receiver(Vec3::ZERO, Vec3::Z);
    assert!((total(&set, &at) - 1.0).abs() < 1e-5);
    for i in [0, 500, 999] {
        assert!(
            (set.probability(i, &at) / 1e-3 - 1.0).abs() < 0.2,
            "{}",
            set.probability(i, &at)
        );
    }
    let lamps = [1e-30f32, 1.0, 1e30].map(|c| {
        let inverse = Falloff::InverseSquare { range: None };
        point(DVec3::new(0.0, f64::from(c.log10()), 3.0), Vec3::splat(c), inverse)
    });
    let set = LightSet::new(lamps.to_vec());
    assert!((total(&set, &at) - 1.0).abs() < 1e-5);
    assert!((0..3).all(|i| set.probability(i, &at) > 1e-7));
    assert!(
        LightSet::new(Vec::new())
            .sample(at.p, at.n, false, 0.5, Vec2::ZERO, 0.0)
            .is_none()
    );
}

/// Catalogue of hard cases J 65: the same emitter twice is as bright as once, and the one that rays see is sampled.
#[test]
fn emitters_in_the_same_place_count_once() {
    let numbered = |light: &Light, object: u32| match light.clone() {
        Light::Triangle(l) => Light::Triangle(TriangleLight {
            prim: PrimRef { object, prim: 0 },
            ..l
        }),
        Light::Sphere(l) => Light::Sphere(SphereLight {
            prim: PrimRef { object, prim: 0 },
            ..l
        }),
        other => other,
    };
    let tri = triangle(Vec3::Z, Vec3::Z + Vec3::Y, Vec3::Z + Vec3::X, false);
    let ball = sphere(DVec3::new(3.0, 0.0, 3.0), 0.5);
    let once = LightSet::new(vec![tri.clone(), ball.clone()]);
    let objects = [(5, 9), (2, 3), (8, 4)];
    let thrice = objects
        .iter()
        .flat_map(|&(a, b)| [numbered(&tri, a), numbered(&ball, b)]);
    let thrice = LightSet::new(thrice.collect());
    let at = receiver(Vec3::ZERO, Vec3::Z);
    assert!((total(&thrice, &at) - 1.0).abs() < 1e-5);
    for i in 0..2 {
        assert_eq!(thrice.probability(2 + i, &at), once.probability(i, &at));
        assert_eq!((thrice.probability(i, &at), thrice.probability(4 + i, &at)), (0.0, 0.0));
    }
    // A shape that differs in one bit is another place.
    let other = triangle(Vec3::Z, Vec3::Z + Vec3::Y, Vec3::Z + Vec3::X * 1.000_000_1, false);
    let set = LightSet::new(vec![tri, other]);
    assert!(set.probability(0, &at) > 0.4 && set.probability(1, &at) > 0.4);
}

/// A scene of any size gives the same choices, bit for bit.
#[test]
fn choices_do_not_depend_on_the_unit_of_length() {
    let lights = cloud(500, 30);
    let set = LightSet::new(lights.clone());
    for exponent in [-40, -20, 20, 40] {
        let scale = 2f32.powi(exponent);
        let scaled = lights.iter().map(|l| match l {
            Light::Triangle(l) => Light::Triangle(TriangleLight {
                p0: l.p0 * f64::from(scale),
                e1: l.e1 * scale,
                e2: l.e2 * scale,
                ..*l
            }),
            other => other.clone(),
        });
        let other = LightSet::new(scaled.collect());
        for at in receivers(20, 31) {
            let there = Receiver { p: at.p * scale, ..at };
            for i in 0..20 {
                assert_eq!(
                    set.probability(i, &at),
                    other.probability(i, &there),
                    "2^{exponent}, light {i}"
                );
            }
        }
    }
}
