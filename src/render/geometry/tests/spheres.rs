//! Spheres too large, too small or too far for f32.

use super::super::{GeomObject, Geometry};
use super::support::*;
use crate::math::stats::Pcg;
use crate::render::accel::scene::Instructions;
use crate::render::ray::{Hit, Ray};
use crate::render::shape::Shape;
use glam::{DVec3, Vec3};

fn sphere(center: DVec3, radius: f64) -> Geometry {
    Geometry::build(vec![GeomObject::new(Shape::Sphere { center, radius }, 0)], Vec::new())
}

/// Oracle: bisection on the distance to the centre, f64.
#[test]
fn huge_wall_spheres_stand_where_they_should() {
    let mut rng = Pcg::new(1);
    for radius in [1e3, 1e5, 1e7] {
        let center = DVec3::new(radius + 3.0, 1.0, -2.0); // the wall x = 3, seen from outside
        for (center, inside) in [(center, false), (DVec3::new(3.0 - radius, 1.0, -2.0), true)] {
            let geometry = sphere(center, radius);
            for _ in 0..2000 {
                let o = (in_cube(&mut rng) * 2.0).as_vec3();
                let mut d = direction(&mut rng);
                d.x = d.x.abs() + 0.1;
                let ray = Ray::new(o, d);
                let gap = |t: f64| (o.as_dvec3() + d.as_dvec3() * t - center).length() - radius;
                let (mut low, mut high) = (0.0, 100.0);
                for _ in 0..80 {
                    let t = 0.5 * (low + high);
                    if (gap(t) < 0.0) == inside { low = t } else { high = t }
                }
                let hit = geometry.closest(&ray).expect("the wall is in front");
                // f32 rounding of t, and the oracle's own rounding of distances of the radius's size.
                let tolerance = 1.2e-7 * low + 4e-16 * radius * 10.0;
                assert!(
                    (f64::from(hit.t) - low).abs() <= tolerance,
                    "R = {radius}: {} instead of {low}",
                    hit.t
                );
                let p = geometry.surface(&ray, &hit);
                let off = (p.p.as_dvec3() - center).length() - radius;
                let bound = p.p_error.as_dvec3().dot(p.ng.as_dvec3().abs()) + 4e-16 * radius;
                assert!(off.abs() <= bound, "R = {radius}: point is {off} off, bound {bound}");
            }
        }
    }
}

#[test]
fn tiny_far_spheres_are_found_and_missed_exactly() {
    let mut rng = Pcg::new(2);
    for (radius, distance) in [(1.0, 1e4), (1e-3, 1e2), (1e-3, 1e5), (1e-5, 1e4)] {
        for i in 0..2000 {
            // The direction is rounded before the sphere is put on its way, so that the aim is exact.
            let d = direction(&mut rng);
            let along = d.as_dvec3() * distance;
            let aside = along.any_orthonormal_vector_of_unit(&mut rng);
            let share = if i % 2 == 0 { 0.99 } else { 1.01 };
            let geometry = sphere(along + aside * (radius * share), radius);
            let hit = geometry.closest(&Ray::new(Vec3::ZERO, d));
            assert_eq!(
                hit.is_some(),
                i % 2 == 0,
                "R = {radius}, D = {distance}, {share} R aside"
            );
        }
    }
}

trait Aside {
    fn any_orthonormal_vector_of_unit(self, rng: &mut Pcg) -> DVec3;
}

impl Aside for DVec3 {
    /// A unit vector at right angles, otherwise random.
    fn any_orthonormal_vector_of_unit(self, rng: &mut Pcg) -> DVec3 {
        let other = direction(rng).as_dvec3();
        self.normalize().cross(other).normalize()
    }
}

/// The list for few spheres and the tree for many give the same answers.
#[test]
fn few_and_many_spheres_agree() {
    let mut rng = Pcg::new(3);
    let spheres: Vec<_> = (0..13)
        .map(|_| Shape::Sphere {
            center: in_cube(&mut rng) * 3.0,
            radius: 0.05 + rng.next_f64(),
        })
        .collect();
    let object = |s: &Shape| GeomObject::new(s.clone(), 0);
    let few = Geometry::build(spheres.iter().map(object).collect(), Vec::new());
    // The same and some that stand far away.
    let far = (0..20).map(|i| Shape::Sphere {
        center: DVec3::splat(1e6 + f64::from(i)),
        radius: 0.1,
    });
    let all: Vec<_> = spheres.iter().cloned().chain(far).collect();
    let many = Geometry::build(all.iter().map(object).collect(), Vec::new());
    for _ in 0..20_000 {
        let mut ray = random_ray(&mut rng, 2.0);
        ray.mask = 7;
        if let Some(hit) = few.closest(&ray) {
            ray.from = hit.prim;
        }
        assert_eq!(few.closest(&ray), many.closest(&ray), "{ray:?}");
    }
}

/// Scenes of spheres alone take a way of their own through the vector code: all instruction sets, bit for bit.
#[test]
fn all_instruction_sets_find_the_same_spheres() {
    let mut rng = Pcg::new(4);
    let mut hits = 0;
    for count in [1, 3, 4, 5, 16] {
        let spheres = (0..count).map(|_| Shape::Sphere {
            center: in_cube(&mut rng) * 3.0,
            radius: 10f64.powf(signed(&mut rng) * 3.0),
        });
        let fastest = Geometry::build(spheres.map(|s| GeomObject::new(s, 0)).collect(), Vec::new());
        let mut baseline = fastest.clone();
        baseline.use_instructions(Instructions::Baseline);
        for i in 0..10_000 {
            let mut ray = random_ray(&mut rng, 2.0);
            if i % 3 == 0 {
                ray.dir[i / 3 % 3] = 0.0;
            }
            let hit = fastest.closest(&ray);
            let bits = |h: Option<Hit>| h.map(|h| (h.t.to_bits(), h.prim));
            assert_eq!(bits(baseline.closest(&ray)), bits(hit), "{ray:?}");
            assert_eq!(fastest.occluded(&ray), hit.is_some());
            hits += usize::from(hit.is_some());
        }
    }
    assert!(hits > 10_000, "{hits}");
}
