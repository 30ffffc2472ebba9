//! Planes to the horizon.

use super::super::{GeomObject, Geometry};
use super::exact::{Dd, Exact3};
use super::support::*;
use crate::math::robust::{UNIT_ROUNDOFF, offset_origin};
use crate::math::stats::Pcg;
use crate::render::ray::Ray;
use crate::render::shape::Shape;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

const U: f64 = UNIT_ROUNDOFF as f64;

fn plane(normal: DVec3, distance: f64) -> Geometry {
    Geometry::build(vec![GeomObject::new(Shape::Plane { normal, distance }, 0)], Vec::new())
}

/// Every ray that is not parallel to a plane meets it, however flat: to 10³⁰ times the height of the eye. The point lies on
/// the plane within its bound, and t is within two roundings of double-double.
#[test]
fn a_plane_reaches_to_the_horizon() {
    let mut rng = Pcg::new(1);
    for height in [1.7f32, 1e-6, 1e6] {
        let floor = plane(DVec3::Y, 0.0);
        for exponent in 0..=30 {
            for _ in 0..20 {
                let eye = Vec3::new(rng.next_f32(), 1.0, rng.next_f32()) * height;
                let flat = direction(&mut rng);
                let dir = Vec3::new(flat.x, -(10f32.powi(-exponent)) * (0.5 + rng.next_f32()), flat.z);
                let ray = Ray::new(eye, dir);
                let hit = floor.closest(&ray).expect("it goes down");
                let exact = (Dd::new(-eye.y) / Dd::new(dir.y)).value();
                assert!(
                    (f64::from(hit.t) - exact).abs() <= 2.0 * U * exact,
                    "{} instead of {exact}",
                    hit.t
                );
                let s = floor.surface(&ray, &hit);
                assert!(s.p.y.abs() <= s.p_error.y, "{s:?}");
                // Up, and exactly level, there is nothing.
                for dy in [0.0, -0.0, -dir.y] {
                    assert!(floor.closest(&Ray::new(eye, dir.with_y(dy))).is_none());
                }
            }
        }
    }
}

/// A million points on planes up to 10⁸ away from the origin, each left to both sides: the start lies on the side it
/// should, exactly judged, and is no farther away than ten units in the last place.
#[test]
fn rays_leave_a_plane_on_the_right_side() {
    let wrong: usize = (0..1000u64)
        .into_par_iter()
        .map(|block| {
            let mut rng = Pcg::new(100 + block);
            let distance = [1e-6, 1e-2, 1.0, 1e2, 1e4, 1e6, 1e8][block as usize % 7] * signed(&mut rng);
            let normal = direction(&mut rng).as_dvec3().normalize();
            let normal = if block % 3 == 0 {
                DVec3::AXES[block as usize % 9 / 3]
            } else {
                normal
            };
            let geometry = plane(normal, distance);
            let n = Exact3::new(normal);
            let mut wrong = 0;
            for i in 0..500 {
                let reach = distance.abs().max(1.0) * 10f64.powi(i % 5 - 2);
                let start = (normal * distance + in_cube(&mut rng) * reach).as_vec3();
                let mut dir = direction(&mut rng);
                let side = n.dot(Exact3::new(start.as_dvec3())) - Dd::new(distance);
                if dir.as_dvec3().dot(normal) * side.value() > 0.0 {
                    dir = -dir;
                }
                let ray = Ray::new(start, dir);
                // Rounded onto the plane or parallel to it there is nothing to hit.
                let Some(hit) = geometry.closest(&ray) else { continue };
                let s = geometry.surface(&ray, &hit);
                for w in [s.ng, -s.ng] {
                    let q = offset_origin(s.p, s.p_error, s.ng, w);
                    let height = (n.dot(Exact3::new(q.as_dvec3())) - Dd::new(distance)).value();
                    let most = 10.0 * U * f64::from(q.abs().max_element()) * 3f64.sqrt() + 1e-13 * distance.abs();
                    let right = height * f64::from(w.dot(s.ng)) > 0.0 && height.abs() <= most + 1e-37;
                    wrong += usize::from(!right);
                }
            }
            wrong
        })
        .sum();
    assert_eq!(wrong, 0);
}
