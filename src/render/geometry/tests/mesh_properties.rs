//! Triangles of any shape, and instances of a closed mesh under any map: the same properties as of analytic shapes.

use super::super::{Geometry, MeshData};
use super::exact::{Dd, Exact3, Inverse};
use super::placing::*;
use super::support::*;
use crate::math::robust::{UNIT_ROUNDOFF, offset_origin};
use crate::math::stats::Pcg;
use crate::render::ray::{Hit, PrimRef, Ray};
use crate::render::surface::Surface;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use proptest::prelude::*;
use std::cell::Cell;

const U: f64 = UNIT_ROUNDOFF as f64;

/// A face as it truly stands: its corners are exact in f32, the map in f64.
struct Face {
    inverse: Inverse,
    corners: [Vec3; 3],
}

impl Face {
    fn of(geometry: &Geometry, map: &DAffine3, prim: PrimRef) -> Face {
        Face {
            inverse: Inverse::of(map),
            corners: geometry.meshes()[0].corners(prim.prim).expect("it was hit"),
        }
    }

    fn corner(&self, i: usize) -> Exact3 {
        Exact3::new(self.corners[i].as_dvec3())
    }

    /// (v1 − v0) × (v2 − v0), in the mesh's own space.
    fn cross(&self) -> Exact3 {
        let v0 = self.corner(0);
        (self.corner(1) - v0).cross(self.corner(2) - v0)
    }

    /// Distance of a world point from the face's plane in the mesh's own space, and its gradient in the world.
    fn distance(&self, p: Exact3) -> (f64, DVec3) {
        let n = self.cross();
        let length = n.dot(n).sqrt();
        let local = self.inverse.point(p) - self.corner(0);
        let g = n.dot(local) / length;
        (g.value(), self.inverse.gradient(n.value() / length.value()))
    }

    /// Longest edge, and twice the area.
    fn size(&self) -> (f64, f64) {
        let [a, b, c] = self.corners.map(|v| v.as_dvec3());
        let longest = (a - b).length().max((b - c).length()).max((c - a).length());
        let n = self.cross();
        (longest, n.dot(n).sqrt().value())
    }

    /// The bound on how far from the plane the exact ray is at the stated t: some 64 roundings of f64, of the ray on its way
    /// to the mesh's space and, longer by the aspect, of the normal; and t itself is rounded to 40 bits. A ray that meets
    /// the face edge-on, within the rounding of the f32 test that says it is met, is told the depth of the corners:
    /// with D the largest distance and coordinate the ray moves by 2uD in that test and the corners by 4uD.
    fn bound(&self, map: &DAffine3, ray: &Ray, t: f64, slope: f64) -> f64 {
        let axis = |v: DVec3| self.inverse.vector(Exact3::new(v)).value().abs();
        let back = DMat3::from_cols(axis(DVec3::X), axis(DVec3::Y), axis(DVec3::Z));
        let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let way = (back * (o.abs() + map.translation.abs() + d.abs() * t)).length();
        let o = self.inverse.point(Exact3::new(o)).value();
        let d = self.inverse.vector(Exact3::new(d)).value();
        let corners = self.corners.map(|v| v.as_dvec3() - o);
        let far = corners.iter().map(|v| v.length()).fold(0.0, f64::max);
        let largest = far + o.length() + t * d.length();
        let (longest, area) = self.size();
        let rounding = 32.0 * f64::EPSILON * (way + largest * (1.0 + longest * longest / area));
        let main = d.abs().max_position();
        let depth = corners.map(|v| v[main] / d[main]);
        let room = depth.iter().fold(f64::MIN, |a, b| a.max(*b)) - depth.iter().fold(f64::MAX, |a, b| a.min(*b));
        let edge_on = 6.0 * U * largest;
        let edge_on = if slope * room <= 2.0 * edge_on { edge_on } else { 0.0 };
        rounding + edge_on + t * slope * 2f64.powi(-39)
    }
}

fn hit_is_right(geometry: &Geometry, map: &DAffine3, ray: &Ray, hit: &Hit) -> Result<Surface, TestCaseError> {
    let face = Face::of(geometry, map, hit.prim);
    let s = geometry.surface(ray, hit);
    let (g, gradient) = face.distance(Exact3::new(s.p.as_dvec3()));
    let bound = gradient.abs().dot(s.p_error.as_dvec3());
    prop_assert!(g.abs() <= bound, "{s:?} is {g} off, bound {bound}");
    prop_assert!((f64::from(hit.t) - hit.exact).abs() <= U * hit.exact);
    let (o, d, t) = (ray.origin.as_dvec3(), ray.dir.as_dvec3(), hit.exact);
    let at = Exact3::new(o) + Exact3::new(d).scaled(Dd::new(t));
    let (g, gradient) = face.distance(at);
    let bound = face.bound(map, ray, t, gradient.dot(d).abs());
    prop_assert!(g.abs() <= bound, "t = {t} is {g} off, bound {bound}: {ray:?} {hit:?}");
    let exact = gradient.normalize();
    prop_assert!(
        (s.ng.as_dvec3() - exact)
            .abs()
            .max_element()
            .min((s.ng.as_dvec3() + exact).abs().max_element())
            < 4.0 * U
    );
    Ok(s)
}

fn leave(s: &Surface, w: Vec3) -> Ray {
    Ray {
        from: s.prim,
        ..Ray::new(offset_origin(s.p, s.p_error, s.ng, w), w)
    }
}

/// Corners between 10⁻⁴ and 1 of the size from the middle, so that needles and caps are common.
#[test]
fn triangles_of_any_shape_anywhere() {
    let (hits, left) = (Cell::new(0), Cell::new(0));
    for_all(21, 20_000, placing(), |p| {
        let mut rng = Pcg::new(p.seed);
        let corners = [0; 3].map(|_| (in_cube(&mut rng) * p.size * 10f64.powf(2.0 * signed(&mut rng) - 2.0)).as_vec3());
        let mesh = MeshData {
            positions: corners.to_vec(),
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        };
        let map = DAffine3::from_mat3_translation(p.linear, p.place);
        let geometry = single(mesh, map);
        let b = [rng.next_f64(), rng.next_f64(), rng.next_f64()];
        let inner: DVec3 = (0..3).map(|i| corners[i].as_dvec3() * b[i]).sum::<DVec3>() / b.iter().sum::<f64>();
        let away = p.size * [3.0, 0.1, 30.0, 1e3][(p.seed % 4) as usize];
        let start = map
            .transform_point3(inner + direction(&mut rng).as_dvec3() * away)
            .as_vec3();
        let ray = Ray::new(start, (map.transform_point3(inner) - start.as_dvec3()).as_vec3());
        let Some(hit) = geometry.closest(&ray) else {
            return Ok(());
        };
        hits.set(hits.get() + 1);
        let s = hit_is_right(&geometry, &map, &ray, &hit)?;
        for i in 0..8 {
            let w = leaving_direction(s.ng, i, &mut rng);
            left.set(left.get() + 1);
            prop_assert!(geometry.closest(&leave(&s, w)).is_none());
        }
        Ok(())
    });
    assert!(
        hits.get() > 6000 && left.get() > 50_000,
        "{} {}",
        hits.get(),
        left.get()
    );
}

#[test]
fn instances_of_a_closed_mesh_under_any_map() {
    let meshes: Vec<MeshData> = (0..3).map(icosphere).collect();
    let (hits, left, crossed) = (Cell::new(0), Cell::new(0), Cell::new(0));
    for_all(22, 4000, placing(), |p| {
        let mut rng = Pcg::new(p.seed);
        let map = p.map();
        let geometry = single(meshes[(p.seed % 3) as usize].clone(), map);
        let inverse = Inverse::of(&map);
        for i in 0..6 {
            let ray = p.ray(&mut rng, i);
            let Some(hit) = geometry.closest(&ray) else { continue };
            hits.set(hits.get() + 1);
            let s = hit_is_right(&geometry, &map, &ray, &hit)?;
            let error = s.p_error.as_dvec3();
            let loose = [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|a| inverse.vector(Exact3::new(a * error.dot(a))).value().length())
                .into_iter()
                .sum::<f64>();
            for k in 0..8 {
                let w = leaving_direction(s.ng, k, &mut rng);
                if w.dot(s.ng) == 0.0 {
                    continue;
                }
                let again = geometry.closest(&leave(&s, w));
                if w.dot(s.ng) > 0.0 {
                    left.set(left.get() + 1);
                    prop_assert!(again.is_none(), "met again: {s:?} towards {w}: {again:?}");
                } else if loose < 1e-4 && w.dot(s.ng) < -1e-2 {
                    let Some(far) = again else {
                        prop_assert!(false, "no way out from {s:?} towards {w}");
                        continue;
                    };
                    crossed.set(crossed.get() + 1);
                    let q = geometry.surface(&leave(&s, w), &far);
                    prop_assert!(q.ng.dot(w) > -1e-4, "entered from inside: {s:?} towards {w}: {q:?}");
                }
            }
        }
        Ok(())
    });
    let got = [hits.get(), left.get(), crossed.get()];
    assert!(got[0] > 8000 && got[1] > 20_000 && got[2] > 3000, "{got:?}");
}

/// Instances stretched by 10⁶ and 10¹² and mirrored: normals are the cofactors' (2 roundings to f32 remain).
#[test]
fn normals_under_extreme_stretch_are_exact() {
    let mut rng = Pcg::new(23);
    let mut compared = 0;
    for i in 0..4000 {
        let ratio = [1e6, 1e-6, 1e12, 1e-12][i % 4];
        let turn = random_map(&mut rng, 1.0, 0.0);
        let turn = glam::DQuat::from_mat3(&DMat3::from_cols(
            turn.matrix3.x_axis.normalize(),
            turn.matrix3.y_axis.normalize(),
            turn.matrix3.x_axis.normalize().cross(turn.matrix3.y_axis.normalize()),
        ));
        let sign = if i % 8 < 4 { 1.0 } else { -1.0 };
        let map = DAffine3::from_mat3_translation(
            DMat3::from_quat(turn) * DMat3::from_diagonal(DVec3::new(sign, ratio, 1.0)),
            in_cube(&mut rng),
        );
        let mesh = icosphere(1);
        let geometry = single(mesh, map);
        let target = map.transform_point3(in_cube(&mut rng) * 0.4);
        let start = map.transform_point3(direction(&mut rng).as_dvec3() * 3.0).as_vec3();
        let ray = Ray::new(start, (target - start.as_dvec3()).as_vec3());
        let Some(hit) = geometry.closest(&ray) else { continue };
        let face = Face::of(&geometry, &map, hit.prim);
        let s = geometry.surface(&ray, &hit);
        let exact = face.distance(Exact3::new(s.p.as_dvec3())).1.normalize();
        // The icosphere's faces wind outward, so the gradient points outward, under mirrors too.
        let off = (s.ng.as_dvec3() - exact).abs().max_element();
        assert!(off <= 4.0 * U, "{ratio}, {sign}: {} instead of {exact}", s.ng);
        compared += 1;
    }
    assert!(compared > 2000, "{compared}");
}
