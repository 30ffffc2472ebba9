//! Light sampling, chance hits and their combination give the same irradiance: nothing is lost, nothing counted twice.

use super::*;
use crate::math::stats::Pcg;
use crate::math::warp::{INV_PI, cosine_hemisphere};

/// Mean and variance of the mean.
pub(super) struct Mean {
    n: f64,
    sum: f64,
    squares: f64,
}

impl Mean {
    fn add(&mut self, v: f64) {
        self.n += 1.0;
        self.sum += v;
        self.squares += v * v;
    }

    pub fn mean(&self) -> f64 {
        self.sum / self.n
    }

    pub fn variance(&self) -> f64 {
        (self.squares / self.n - self.mean().powi(2)).max(0.0) / self.n // rounding, where there is no noise
    }
}

/// Irradiance at the origin facing +z, the lights being transparent: by light sampling alone if `combine` is off,
/// else with cosine distributed chance hits and the power heuristic.
pub(super) fn estimate(lights: &[Light], combine: bool, seed: u64) -> Mean {
    let set = LightSet::new(lights.to_vec());
    let (p, n) = (Vec3::ZERO, Vec3::Z);
    let mut rng = Pcg::new(seed);
    let mut result = Mean {
        n: 0.0,
        sum: 0.0,
        squares: 0.0,
    };
    for _ in 0..200_000 {
        let mut value = 0.0;
        if let Some(s) = set.sample(p, n, false, rng.next_f32(), rng.next_vec2(), 0.0) {
            let cos = s.wi.z.max(0.0);
            let weight = if combine && !s.delta {
                mis_weight(s.pdf, cos * INV_PI)
            } else {
                1.0
            };
            value += weight * cos * s.radiance.x / s.pdf;
        }
        if combine {
            let wi = cosine_hemisphere(rng.next_vec2());
            let by_chance = wi.z * INV_PI;
            for (i, light) in (0u32..).zip(lights) {
                let shape = match light {
                    Light::Environment(_) => continue,
                    Light::SphereCap(l) => Light::Sphere(l.sphere),
                    other => other.clone(),
                };
                if let Some((t, ng)) = oracle_hit(&shape, p.as_dvec3(), wi.as_dvec3()) {
                    let hit = HitOnLight {
                        p: p + wi * t as f32,
                        ng: ng.as_vec3(),
                        distance: t as f32,
                        time: 0.0,
                    };
                    let weight = mis_weight(by_chance, set.pdf(i, p, n, false, wi, &hit));
                    value += weight * std::f32::consts::PI; // radiance 1, cos/pdf = π
                }
            }
            let weight = mis_weight(by_chance, set.environment_pdf(p, n, false, wi));
            value += weight * std::f32::consts::PI * set.escaped(wi).x;
        }
        result.add(f64::from(value));
    }
    result
}

/// Five standard errors; the seed is fixed.
#[track_caller]
fn agree(name: &str, lights: Vec<Light>) {
    let (alone, both) = (estimate(&lights, false, 1), estimate(&lights, true, 2));
    let error = (alone.variance() + both.variance()).sqrt();
    let off = (alone.mean() - both.mean()).abs();
    // Rounding of 200 000 terms, for estimates without noise.
    let slack = 1e-6 * both.mean();
    assert!(
        off < 5.0 * error + slack,
        "{name}: {} and {}, error {error}",
        alone.mean(),
        both.mean()
    );
}

fn shapes() -> Vec<(&'static str, Light)> {
    let p0 = Vec3::new(-1.0, -2.0, 1.0);
    let image = sky::image(8, 6, 2).map(|i| Light::Environment(Box::new(EnvironmentLight::Image(i))));
    let mut shapes = vec![
        ("near sphere", sphere(DVec3::new(1.0, 2.0, 2.0), 2.0)),
        ("far sphere", sphere(DVec3::new(3.0, 0.0, 9.0), 0.5)),
        ("sphere on the horizon", sphere(DVec3::new(4.0, 1.0, 0.3), 1.0)),
        (
            "near triangle",
            triangle(p0, p0 + Vec3::X * 3.0, p0 + Vec3::Y * 2.0, true),
        ),
        (
            "far parallelogram",
            parallelogram(p0 * 8.0, Vec3::Y * 2.0, Vec3::X * 3.0),
        ),
        (
            "parallelogram through the horizon",
            parallelogram(p0 - Vec3::Z * 2.0, Vec3::new(0.0, 2.0, 2.0), Vec3::X),
        ),
        ("ring", disc(DVec3::new(0.5, 0.0, 2.0), DVec3::Y, DVec3::X * 2.0, 0.5)),
        (
            "constant sky",
            Light::Environment(Box::new(EnvironmentLight::Constant(Vec3::splat(0.2)))),
        ),
    ];
    shapes.extend(image.map(|i| ("sky image", i)));
    shapes
}

#[test]
fn strategies_agree_on_each_light() {
    for (name, light) in shapes() {
        agree(name, vec![light]);
    }
}

#[test]
fn strategies_agree_on_many_lights() {
    let mut lights: Vec<Light> = shapes().into_iter().map(|(_, l)| l).collect();
    agree("one of each", lights.clone());
    lights.push(point(
        DVec3::Z * 3.0,
        Vec3::splat(4.0),
        Falloff::InverseSquare { range: None },
    ));
    lights.push(point(DVec3::X + DVec3::Z, Vec3::splat(0.3), Falloff::None));
    agree("with lamps", lights);
}

/// What lies outside the cap is left to chance hits: together they see the whole sphere, E = π·R²/d²·cos θ.
#[test]
fn a_cap_cuts_no_light_off() {
    let center = DVec3::new(1.0, 0.0, 4.0);
    let exact = std::f64::consts::PI * 4.0 / center.length_squared() * center.z / center.length();
    for axis in [-DVec3::Z, DVec3::X, DVec3::Z] {
        let both = estimate(&[cap(center, 2.0, axis, 0.3)], true, 3);
        let off = (both.mean() - exact).abs();
        assert!(
            off < 5.0 * both.variance().sqrt(),
            "{axis}: {}, exactly {exact}",
            both.mean()
        );
    }
}
