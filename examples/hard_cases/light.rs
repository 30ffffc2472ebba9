//! Cases of lamps and of the directions to them.

use crate::case::{Case, share};
use crate::geometry::only;
use crate::naive;
use glam::{DVec3, Vec2, Vec3};
use pts::math::frame::Frame;
use pts::math::robust::UNIT_ROUNDOFF;
use pts::math::stats::Pcg;
use pts::math::warp::{uniform_cone, uniform_sphere};
use pts::render::light::{Light, LightSet, SphereLight, mis_weight};
use pts::render::ray::{PrimRef, Ray, ray_mask};
use pts::render::shape::Shape;
use std::f64::consts::{PI, TAU};

const U: f64 = UNIT_ROUNDOFF as f64;
const SAMPLES: u32 = 20_000;

/// A glowing ball straight above the origin.
fn lamp(radius: f64, distance: f64, radiance: f32) -> LightSet {
    LightSet::new(vec![Light::Sphere(SphereLight {
        center: DVec3::Y * distance,
        radius,
        radiance: Vec3::splat(radiance),
        two_sided: false,
        textured: false,
        prim: PrimRef { object: 0, prim: 0 },
    })])
}

/// Points of the unit square, evenly spread.
fn even() -> impl Iterator<Item = Vec2> {
    // The golden ratio's lattice: each column once, rows far apart.
    const STEP: f64 = 0.618_033_988_749_894_9;
    (0..SAMPLES).map(|i| {
        let i = f64::from(i);
        Vec2::new(((i + 0.5) / f64::from(SAMPLES)) as f32, (i * STEP).fract() as f32)
    })
}

/// All cases.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![solid_angle(1e-3), solid_angle(1e-4), rim(), tiny_far(), huge_near()];
    cases.push(lost());
    cases.push(inside());
    cases.push(heuristic());
    cases
}

fn solid_angle(s: f64) -> Case {
    let set = lamp(s, 1.0, 1.0);
    let sample = set.sample(Vec3::ZERO, Vec3::Y, false, 0.5, Vec2::splat(0.5), 0.0);
    // 1 − √(1 − s²) without cancellation.
    let exact = TAU * s * s / (1.0 + (1.0 - s * s).sqrt());
    Case {
        item: "43",
        what: format!("solid angle of a ball with R/d = {s:e}"),
        naive: TAU * f64::from(naive::one_minus_cos(s as f32, 1.0)),
        pts: sample.map_or(f64::NAN, |s| 1.0 / f64::from(s.pdf)),
        exact,
        tolerance: 4.0 * U * exact,
        because: "4u relative",
    }
}

fn rim() -> Case {
    let s = 1e-3f64;
    let set = lamp(s, 1.0, 1.0);
    let sine = |wi: Vec3| f64::from(wi.x).hypot(f64::from(wi.z));
    let ours = even().filter_map(|u| set.sample(Vec3::ZERO, Vec3::Y, false, 0.5, u, 0.0));
    let mean = |sum: f64| sum / f64::from(SAMPLES) / s;
    let one_minus_cos = naive::one_minus_cos(s as f32, 1.0);
    Case {
        item: "44",
        what: "mean sine of directions to it over R/d, R/d = 1e-3".into(),
        naive: mean(even().map(|u| f64::from(naive::sine_in_cone(u.x, one_minus_cos))).sum()),
        pts: mean(ours.map(|sample| sine(sample.wi)).sum()),
        exact: 2.0 / 3.0,
        tolerance: 2.0 * U / s,
        because: "directions are rounded by u, 1e-3 of which is R/d",
    }
}

/// Irradiance over π and radiance, by light samples.
fn irradiance(set: &LightSet) -> f64 {
    let sum: f64 = even()
        .filter_map(|u| set.sample(Vec3::ZERO, Vec3::Y, false, 0.5, u, 0.0))
        .map(|s| f64::from(s.radiance.x) * f64::from(s.wi.y) / f64::from(s.pdf))
        .sum();
    sum / f64::from(SAMPLES) / PI
}

fn tiny_far() -> Case {
    let (radius, distance, radiance) = (1e-3f32, 1e4f32, 1e14f32);
    Case {
        item: "61",
        what: "irradiance/π under a ball of R = 1e-3 and radiance 1e14, 1e4 away".into(),
        naive: 2.0 * f64::from(radiance * naive::one_minus_cos(radius, distance)),
        pts: irradiance(&lamp(f64::from(radius), f64::from(distance), radiance)),
        exact: f64::from(radiance) * (f64::from(radius) / f64::from(distance)).powi(2),
        tolerance: 8.0 * U,
        because: "8u relative",
    }
}

fn huge_near() -> Case {
    let (radius, gap) = (1e4f64, 0.5);
    let exact = TAU * (1.0 - (gap * (2.0 * radius + gap)).sqrt() / (radius + gap));
    let by_cosine = naive::one_minus_cos(radius as f32, (radius + gap) as f32);
    let set = lamp(radius, radius + gap, 1.0);
    let sample = set.sample(Vec3::ZERO, Vec3::Y, false, 0.5, Vec2::splat(0.5), 0.0);
    Case {
        item: "62",
        what: "solid angle of a ball of R = 1e4 that is 0.5 away".into(),
        naive: TAU * f64::from(by_cosine),
        pts: sample.map_or(f64::NAN, |s| 1.0 / f64::from(s.pdf)),
        exact,
        tolerance: 4.0 * U * exact,
        because: "4u relative",
    }
}

/// Over lamps in many directions: how f32 rounds depends on it.
fn lost() -> Case {
    const LAMPS: usize = 64;
    let (radius, distance) = (1e-3f64, 1e4);
    let s = radius / distance;
    let x = (s * s / (1.0 + (1.0 - s * s).sqrt())) as f32;
    let mut rng = Pcg::new(9);
    let (mut by_hits, mut by_pts) = (Vec::new(), Vec::new());
    for _ in 0..LAMPS {
        let center = uniform_sphere(rng.next_vec2()).as_dvec3() * distance;
        let geometry = only(Shape::Sphere { center, radius });
        let prim = PrimRef { object: 0, prim: 0 };
        let light = SphereLight {
            center,
            radius,
            radiance: Vec3::ONE,
            two_sided: false,
            textured: false,
            prim,
        };
        let set = LightSet::new(vec![Light::Sphere(light)]);
        let axis = center.as_vec3().normalize();
        for u in even().step_by(LAMPS) {
            let wi = Frame::from_normal(axis).to_world(uniform_cone(u, x)).normalize();
            by_hits.push(naive::sphere(Vec3::ZERO, wi, center.as_vec3(), radius as f32, naive::EPS).is_none());
            let blocked = set.sample(Vec3::ZERO, axis, false, 0.5, u, 0.0).is_none_or(|sample| {
                let mut ray = Ray::new(Vec3::ZERO, sample.wi);
                (ray.t_max, ray.to, ray.mask) = (sample.t_max, sample.to, ray_mask::SHADOW);
                geometry.occluded(&ray)
            });
            by_pts.push(blocked);
        }
    }
    Case {
        item: "63",
        what: "share of rays to a lamp of R/d = 1e-7 that do not find it".into(),
        naive: share(by_hits),
        pts: share(by_pts),
        exact: 0.0,
        tolerance: 0.0,
        because: "none may",
    }
}

fn inside() -> Case {
    // A receiver that rounding has put inside the lamp that it touches.
    let (radius, distance) = (1.0f32, 0.999_999_9f32);
    let set = lamp(f64::from(radius), f64::from(distance), 1.0);
    let found = set.sample(Vec3::ZERO, Vec3::Y, false, 0.5, Vec2::splat(0.5), 0.0);
    Case {
        item: "60",
        what: "light sampled from a point 1e-7 R inside of a lamp that shines outwards".into(),
        naive: f64::from(naive::one_minus_cos(radius, distance)),
        pts: found.map_or(0.0, |s| f64::from(s.radiance.x / s.pdf)),
        exact: 0.0,
        tolerance: 0.0,
        because: "nothing shines there",
    }
}

fn heuristic() -> Case {
    Case {
        item: "66",
        what: "weight of a density of 3e19 against 1e19".into(),
        naive: f64::from(naive::power_heuristic(3e19, 1e19)),
        pts: f64::from(mis_weight(3e19, 1e19)),
        exact: 0.9,
        tolerance: 4.0 * U,
        because: "4u",
    }
}
