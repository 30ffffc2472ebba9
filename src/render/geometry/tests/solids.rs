//! Analytic solids against marching along the ray in f64.

use super::super::{GeomObject, Geometry};
use super::support::*;
use crate::math::stats::Pcg;
use crate::render::ray::Ray;
use crate::render::shape::{Shape, Solid};
use glam::DVec3;

/// Negative inside (any function whose sign is right), and for open shapes the side of the sheet.
fn implicit(solid: &Solid, p: DVec3) -> f64 {
    let across = (p.x * p.x + p.z * p.z).sqrt();
    match *solid {
        Solid::Sphere => p.length() - 1.0,
        Solid::Box { min, max } => (p - max).max(min - p).max_element(),
        Solid::Cylinder { .. } => (across - 1.0).max((p.y - 0.5).abs() - 0.5),
        Solid::Cone { r0, r1, .. } => (across - (r0 + (r1 - r0) * p.y)).max((p.y - 0.5).abs() - 0.5),
        Solid::Disc { .. } => p.y,
        Solid::Torus { major, minor } => {
            let tube = |center: f64| (across - center).hypot(p.y) - minor;
            tube(major) * tube(-major).signum().max(0.0) + tube(major).abs() * f64::from(tube(-major) < 0.0)
        }
    }
}

/// Whether a sign change at `p` is a point of the shape (open shapes and discs lack parts of what `implicit` bounds).
fn is_part(solid: &Solid, p: DVec3) -> bool {
    let across = (p.x * p.x + p.z * p.z).sqrt();
    match *solid {
        Solid::Cylinder { open: true } => p.y > 1e-9 && p.y < 1.0 - 1e-9,
        Solid::Cone { open: true, .. } => p.y > 1e-9 && p.y < 1.0 - 1e-9,
        Solid::Disc { hole } => across <= 1.0 && across >= hole,
        _ => true,
    }
}

#[test]
fn solids_are_hit_where_marching_meets_them() {
    let mut rng = Pcg::new(11);
    for kind in 0..11 {
        let solid = solid(kind);
        if matches!(solid, Solid::Box { min, max } if min.y == max.y) {
            continue; // marching cannot see a sheet; the next test does
        }
        let mut compared = 0;
        for case in 0..60 {
            let size = 10f64.powf(signed(&mut rng) * 3.0);
            let map = random_map(&mut rng, size, 1.0);
            let geometry = Geometry::build(vec![GeomObject::new(Shape::placed(solid.clone(), map), 0)], Vec::new());
            let object_from_world = map.inverse();
            for _ in 0..20 {
                let target = map.transform_point3(solid.center() + in_cube(&mut rng) * solid.half_extent());
                let away = if case % 2 == 0 { 0.3 } else { 4.0 };
                let start = map.transform_point3(solid.center() + in_cube(&mut rng) * away);
                let ray = Ray::new(start.as_vec3(), (target - start).as_vec3());
                let o = object_from_world.transform_point3(ray.origin.as_dvec3());
                let d = object_from_world.transform_vector3(ray.dir.as_dvec3());
                let t_end = 8.0 / d.length();
                let f = |t: f64| implicit(&solid, o + d * t);
                let steps = 4000;
                let mut want = None;
                for i in 0..steps {
                    let (mut low, mut high) = (t_end * f64::from(i) / 4000.0, t_end * f64::from(i + 1) / 4000.0);
                    let inside = f(low) < 0.0;
                    if inside != (f(high) < 0.0) {
                        for _ in 0..60 {
                            let m = 0.5 * (low + high);
                            if (f(m) < 0.0) == inside { low = m } else { high = m }
                        }
                        if is_part(&solid, o + d * low) {
                            want = Some(low);
                            break;
                        }
                    }
                }
                let got = geometry.closest(&ray).map(|h| f64::from(h.t));
                match (want, got) {
                    (Some(want), Some(got)) => {
                        compared += 1;
                        // The march may step over a thin part that the ray grazes: then the nearer answer must be real.
                        let real = f(got).abs() * 1.0 < 1e-5 && got < want;
                        let close = (want - got).abs() <= 2e-7 * want + 1e-9 * t_end;
                        assert!(close || real, "{solid:?}: {got} instead of {want}");
                    }
                    (Some(want), None) => {
                        assert!(want <= 0.0 || want > t_end, "{solid:?}: missed at {want}, {o} {d}");
                    }
                    (None, Some(got)) if got <= t_end => {
                        assert!(f(got).abs() < 1e-5, "{solid:?}: invented a hit at {got}");
                    }
                    _ => {}
                }
            }
        }
        assert!(compared > 100, "{solid:?}: only {compared} compared");
    }
}

/// Normals point outward: a small step along the normal leaves the solid, also under mirrors.
#[test]
fn normals_point_outward_also_in_mirrored_solids() {
    let mut rng = Pcg::new(12);
    for kind in [0, 1, 3, 5, 9, 10] {
        let solid = solid(kind);
        for _ in 0..40 {
            let map = random_map(&mut rng, 1.0, 2.0);
            let geometry = Geometry::build(vec![GeomObject::new(Shape::placed(solid.clone(), map), 0)], Vec::new());
            let back = map.inverse();
            for _ in 0..20 {
                let start = map.transform_point3(in_cube(&mut rng) * 3.0);
                let target = map.transform_point3(solid.center() + in_cube(&mut rng) * 0.7);
                let ray = Ray::new(start.as_vec3(), (target - start).as_vec3());
                let Some(hit) = geometry.closest(&ray) else { continue };
                let s = geometry.surface(&ray, &hit);
                let (p, n) = (s.p.as_dvec3(), s.ng.as_dvec3());
                let out = implicit(&solid, back.transform_point3(p + n * 1e-4));
                let inn = implicit(&solid, back.transform_point3(p - n * 1e-4));
                assert!(
                    out > 0.0 && inn < 0.0,
                    "{solid:?}: {out} outside, {inn} inside at {p}, normal {n}"
                );
            }
        }
    }
}

#[test]
fn a_flat_box_is_hit_from_both_sides_and_reports_its_lower_face() {
    let mut rng = Pcg::new(13);
    for axis in 0..3 {
        let mut half = DVec3::new(1.0, 0.8, 1.3);
        half[axis] = 0.0;
        let shape = Shape::placed(Solid::Box { min: -half, max: half }, glam::DAffine3::IDENTITY);
        let geometry = Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new());
        for i in 0..2000 {
            let mut start = in_cube(&mut rng) * 3.0;
            start[axis] = if i % 2 == 0 { 1.0 } else { -1.0 };
            let target = in_cube(&mut rng) * half;
            let ray = Ray::new(start.as_vec3(), (target - start).as_vec3());
            let hit = geometry.closest(&ray).expect("aimed at its inside");
            assert_eq!(hit.prim.prim, 2 * axis as u32);
            assert!((hit.t - 1.0).abs() < 1e-5);
        }
        // Edge on there is nothing to hit but the sheet itself, at an edge of it.
        let mut start = DVec3::splat(0.1);
        start[axis] = 0.0;
        start[(axis + 1) % 3] = 5.0;
        let mut dir = DVec3::ZERO;
        dir[(axis + 1) % 3] = -1.0;
        let hit = geometry.closest(&Ray::new(start.as_vec3(), dir.as_vec3()));
        assert!(
            hit.is_some_and(|h| h.prim.prim == 2 * ((axis as u32 + 1) % 3) + 1),
            "{hit:?}"
        );
    }
}

/// A point of each solid's inside, or of the sheet if it is one.
fn inner_point(solid: &Solid, rng: &mut Pcg) -> DVec3 {
    match *solid {
        Solid::Sphere => direction(rng).as_dvec3() * 0.99,
        Solid::Box { min, max } => (min + max) * 0.5 + in_cube(rng) * (max - min) * 0.499,
        Solid::Cylinder { .. } => DVec3::new(signed(rng) * 0.7, 0.01 + 0.98 * rng.next_f64(), signed(rng) * 0.7),
        Solid::Cone { r0, r1, .. } => {
            let y = 0.01 + 0.98 * rng.next_f64();
            let r = (r0 + (r1 - r0) * y) * 0.7;
            DVec3::new(signed(rng) * r, y, signed(rng) * r)
        }
        Solid::Disc { hole } => {
            let a = DVec3::new(signed(rng), 0.0, signed(rng)).normalize();
            a * (hole + (1.0 - hole) * (0.01 + 0.98 * rng.next_f64()))
        }
        Solid::Torus { major, minor } => {
            let c = DVec3::new(signed(rng), 0.0, signed(rng)).normalize();
            c * major + direction(rng).as_dvec3() * (minor * 0.95)
        }
    }
}

/// The solid is put where an exactly representable ray passes through a point of its inside.
#[test]
fn far_and_thin_solids_are_not_lost() {
    let mut rng = Pcg::new(14);
    let mut kinds: Vec<Solid> = (0..11).filter(|k| ![4, 6].contains(k)).map(solid).collect();
    kinds.extend([1e-2, 1e-4, 1e-6].map(|minor| Solid::Torus { major: 1.0, minor }));
    for solid in kinds {
        for distance in [0.0, 10.0, 1e3, 1e5, 1e7] {
            for _ in 0..300 {
                let d = direction(&mut rng);
                let mut map = random_map(&mut rng, 1.0, 0.0);
                let inner = inner_point(&solid, &mut rng);
                let t = distance + 8.0;
                map.translation = d.as_dvec3() * t - map.transform_vector3(inner);
                let geometry = Geometry::build(vec![GeomObject::new(Shape::placed(solid.clone(), map), 0)], Vec::new());
                let ray = Ray::new(glam::Vec3::ZERO, d);
                let hit = geometry.closest(&ray);
                assert!(
                    hit.is_some_and(|h| (f64::from(h.t) - t).abs() < 20.0 + 1e-7 * t),
                    "{solid:?} at {t}: {hit:?}"
                );
            }
        }
    }
}
