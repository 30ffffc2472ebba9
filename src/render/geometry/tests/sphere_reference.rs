//! Spheres of every size at every distance against double-double on the same inputs.

use super::super::{GeomObject, Geometry};
use super::exact::{Dd, Exact3};
use super::support::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::stats::Pcg;
use crate::render::ray::Ray;
use crate::render::shape::Shape;
use glam::{DVec3, Vec3};

const U: f64 = UNIT_ROUNDOFF as f64;
/// 2⁻⁵³.
const U64: f64 = f64::EPSILON / 2.0;

fn sphere(center: DVec3, radius: f64) -> Geometry {
    Geometry::build(vec![GeomObject::new(Shape::Sphere { center, radius }, 0)], Vec::new())
}

/// The line against the sphere, exactly.
struct Reference {
    /// (R² − l²)/R², l the distance of the line from the centre; negative for a miss.
    depth: f64,
    /// Both t, if any.
    roots: Option<[f64; 2]>,
}

fn reference(ray: &Ray, center: DVec3, radius: f64) -> Reference {
    let d = Exact3::new(ray.dir.as_dvec3());
    let f = Exact3::new(ray.origin.as_dvec3()) - Exact3::new(center);
    let (a, b) = (d.dot(d), f.dot(d));
    let r2 = Dd::new(radius) * Dd::new(radius);
    let foot = f - d.scaled(b / a);
    let disc = r2 - foot.dot(foot);
    let depth = (disc / r2).value();
    let half = (a * disc).sqrt();
    // The larger root by sum, the other by Vieta: 106 bits each.
    let q = if b.value() > 0.0 { -(b + half) } else { half - b };
    let c = f.dot(f) - r2;
    let (t0, t1) = ((q / a).value(), (c / q).value());
    Reference {
        depth,
        roots: (depth >= 0.0).then_some([t0.min(t1), t0.max(t1)]),
    }
}

/// Checks one ray and says whether it hit. `strict` is the plain bound, 2u·max(|t|, |p|); in general the f64 inputs have a
/// condition: an error of 8·2⁻⁵³ of the largest length across a surface met at a flat angle.
fn check(geometry: &Geometry, center: DVec3, radius: f64, ray: &Ray, strict: bool) -> bool {
    let exact = reference(ray, center, radius);
    let length = ray.dir.as_dvec3().length();
    let from_center = (ray.origin.as_dvec3() - center).length();
    let got = geometry.closest(ray);
    if let Some(hit) = got {
        let s = geometry.surface(ray, &hit);
        assert!(hit.t.is_finite() && hit.t > 0.0);
        assert!((s.ng.length() - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF, "{s:?}");
    }
    // Inside the band in which l cannot be told from R in f64, either answer is right.
    let band = 32.0 * U64 * (1.0 + from_center / radius);
    if exact.depth.abs() <= band {
        return false;
    }
    let want = exact.roots.and_then(|roots| roots.into_iter().find(|t| *t > 0.0));
    let ahead = |t: f64| t as f32 > 0.0;
    // A start on the surface to the last digit of f64 may count as either side.
    let gap = (from_center - radius).abs();
    if gap <= 8.0 * U64 * radius {
        return false;
    }
    assert_eq!(
        got.is_some(),
        want.is_some_and(ahead),
        "{ray:?}, {center}, {radius}: {want:?}, {got:?}"
    );
    let (Some(hit), Some(want)) = (got, want) else {
        return false;
    };
    let p = ray.origin.as_dvec3() + ray.dir.as_dvec3() * want;
    let cos = exact.depth.sqrt();
    let plain = 2.0 * U * want.max(p.abs().max_element() / length);
    let condition = if strict {
        0.0
    } else {
        8.0 * U64 * (radius + from_center) / (cos * length)
    };
    let off = (f64::from(hit.t) - want).abs();
    assert!(
        off <= plain + condition,
        "{off} off {want}, bound {plain} + {condition}: {ray:?}, {center}, {radius}"
    );
    true
}

#[test]
fn spheres_of_every_size_and_distance_match_double_double() {
    let mut rng = Pcg::new(1);
    let mut hits = 0;
    let mut cases = 0;
    for radius in [1e-20, 1e-12, 1e-5, 1e-3, 1.0, 1e3, 1e5, 1e7, 1e12, 1e20] {
        for gap in [-1.0, -0.5, -1e-3, -1e-6, 1e-6, 1e-3, 1.0, 1e2, 1e4, 1e6, 1e8] {
            for i in 0..200 {
                // The start first, rounded to f32; then the sphere around it in f64.
                let start = (in_cube(&mut rng) * radius * [0.0, 1.0, 1e3][i % 3]).as_vec3();
                let away = direction(&mut rng).as_dvec3();
                let center = start.as_dvec3() - away * (radius * (1.0 + gap));
                let aside = direction(&mut rng).as_dvec3() * radius * rng.next_f64();
                let scale = [1.0, 1e-3, 1e3][i / 3 % 3];
                let dir = ((center + aside - start.as_dvec3()).normalize() * scale).as_vec3();
                // From inside also away from the centre.
                let dir = if gap < 0.0 && i % 2 == 0 { -dir } else { dir };
                let geometry = sphere(center, radius);
                cases += 1;
                hits += usize::from(check(&geometry, center, radius, &Ray::new(start, dir), false));
            }
        }
    }
    assert!(hits > cases / 2, "{hits} of {cases}");
}

/// Walls of 10⁵ and 10⁷ as rooms have them: seen from within 100 units at more than 6°, the plain bound of two f32
/// roundings holds without any condition.
#[test]
fn walls_that_are_huge_spheres_stand_to_two_roundings() {
    let mut rng = Pcg::new(2);
    let mut hits = 0;
    for radius in [1e5, 1e7] {
        for i in 0..20_000 {
            let inward = direction(&mut rng).as_dvec3();
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            // The wall is 3 units away, its centre on this or the other side.
            let center = inward * (3.0 + side * radius);
            let start = (in_cube(&mut rng) * 2.0).as_vec3();
            let dir = direction(&mut rng);
            if dir.as_dvec3().dot(inward) < 0.1 {
                continue;
            }
            hits += usize::from(check(
                &sphere(center, radius),
                center,
                radius,
                &Ray::new(start, dir),
                true,
            ));
        }
    }
    assert!(hits > 10_000, "{hits}");
}

/// Rays that touch: l/R within 10⁻⁷ and 10⁻¹⁵ of 1. Whatever the answer, it is finite and its normal a unit vector; outside
/// the band of f64 the answer is that of double-double.
#[test]
fn touching_rays_are_finite_and_right_outside_the_last_digits() {
    let mut rng = Pcg::new(3);
    for radius in [1e-20, 1e-3, 1.0, 1e7, 1e20] {
        for i in 0..3000 {
            let d = direction(&mut rng);
            let aside = d.as_dvec3().cross(direction(&mut rng).as_dvec3()).normalize();
            let miss = signed(&mut rng) * [1e-15, 1e-11, 1e-7][i % 3];
            let distance = radius * [1.0, 10.0, 1e3][i / 3 % 3];
            let center = d.as_dvec3() * distance + aside * (radius * (1.0 + miss));
            check(&sphere(center, radius), center, radius, &Ray::new(Vec3::ZERO, d), false);
        }
    }
}

/// Starts a hair above the surface: the small root keeps its digits, 16u relative, as long as the gap itself has them in f64.
#[test]
fn the_near_root_keeps_its_digits() {
    let mut rng = Pcg::new(4);
    for radius in [1e-3, 1.0, 1e3] {
        for gap in [1e-2, 1e-4, 1e-6, 1e-8] {
            for _ in 0..500 {
                let start = (in_cube(&mut rng) * radius).as_vec3();
                let away = direction(&mut rng).as_dvec3().normalize();
                let center = start.as_dvec3() - away * (radius * (1.0 + gap));
                let mut dir = direction(&mut rng);
                if dir.as_dvec3().dot(away) > -0.2 {
                    dir = (dir.as_dvec3() - away * (dir.as_dvec3().dot(away) + 0.6)).as_vec3();
                }
                let ray = Ray::new(start, dir);
                let Some([want, _]) = reference(&ray, center, radius).roots else {
                    continue;
                };
                let hit = sphere(center, radius).closest(&ray).expect("in front of it");
                let off = (f64::from(hit.t) - want).abs();
                assert!(off <= 16.0 * U * want, "gap {gap}: {} instead of {want}", hit.t);
            }
        }
    }
}
