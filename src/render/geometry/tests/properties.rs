//! Every analytic shape, at sizes and places from 10⁻⁸ to 10⁸: hits lie where they say, and a ray that leaves does not
//! come back. The references are double-double.

use super::super::{GeomObject, Geometry};
use super::exact::Exact3;
use super::placing::*;
use super::truth::{Truth, Value};
use crate::math::robust::{UNIT_ROUNDOFF, offset_origin};
use crate::math::stats::Pcg;
use crate::render::ray::{Hit, Ray};
use crate::render::shape::placed::abs;
use crate::render::shape::{Shape, Solid};
use glam::{DMat3, DVec3, Vec3};
use proptest::prelude::*;
use std::cell::Cell;

/// What a ray that leaves may do.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Never meet it again on either side.
    Sheet,
    /// Never meet it again to the outside, meet its far side to the inside.
    Convex,
    /// The same without base and cap.
    OpenConvex,
    /// Meet it again, but not nearer than its hollow side curves, of this radius.
    Hollow(f64),
    /// Only the hit is judged.
    Any,
}

struct Tally {
    hits: Cell<usize>,
    left: Cell<usize>,
    inside: Cell<usize>,
}

fn add(to: &Cell<usize>) {
    to.set(to.get() + 1);
}

/// Relative f64 error granted to the dozen operations by which a line gets to the shape's own space and meets it there.
const F64_ROUNDINGS: f64 = 64.0 * f64::EPSILON / 2.0;

struct Judge {
    geometry: Geometry,
    truth: Truth,
    kind: Kind,
    /// World point around which the shape stands.
    place: DVec3,
    /// Largest own coordinate.
    reach: f64,
    back: DMat3,
}

impl Judge {
    fn new(shape: Shape, kind: Kind) -> Judge {
        let truth = Truth::of(&shape);
        let axis = |v: DVec3| truth.inverse.vector(Exact3::new(v)).value();
        let back = abs(DMat3::from_cols(axis(DVec3::X), axis(DVec3::Y), axis(DVec3::Z)));
        let (place, reach) = match &shape {
            Shape::Sphere { center, .. } => (*center, 1.0),
            Shape::Plane { normal, distance } => (*normal * *distance, 0.0),
            Shape::Placed(p) => {
                let reach = (p.kind.half_extent() + p.kind.center().abs()).max_element();
                (p.world_from_object.translation, reach)
            }
            Shape::Mesh { .. } => unreachable!("meshes have their own test"),
        };
        Judge {
            geometry: Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new()),
            truth,
            kind,
            place,
            reach,
            back,
        }
    }

    /// The exact ray at the stated t is as near to the face as the rounding of t and of f64 allow.
    fn t_is_right(&self, ray: &Ray, hit: &Hit) -> Result<(), TestCaseError> {
        let (o, d, t) = (ray.origin.as_dvec3(), ray.dir.as_dvec3(), f64::from(hit.t));
        let at = Exact3::new(o) + Exact3::new(d).scaled(super::exact::Dd::new(t));
        let v = self.truth.at(hit.prim.prim, at);
        let own = (self.back * (o.abs() + self.place.abs() + d.abs() * t) + self.reach) * F64_ROUNDINGS;
        let step = t * f64::from(UNIT_ROUNDOFF) * (1.0 + f64::EPSILON);
        let first = v.local_gradient.abs().dot(own) + v.gradient.dot(d).abs() * step;
        let moved = own.length() + (self.back * d.abs()).length() * step;
        let bound = first + v.curvature * moved * moved;
        prop_assert!(
            v.g.abs() <= bound,
            "t = {t}: {} off, bound {bound}, {ray:?} {hit:?}",
            v.g
        );
        Ok(())
    }

    /// Some true point of the face lies within the stated error of the point.
    fn point_is_right(&self, p: Vec3, error: Vec3, face: u32) -> Result<Value, TestCaseError> {
        let v = self.truth.at(face, Exact3::new(p.as_dvec3()));
        let moved = (self.back * error.as_dvec3()).length();
        let bound = v.gradient.abs().dot(error.as_dvec3()) + v.curvature * moved * moved;
        prop_assert!(
            v.g.abs() <= bound,
            "{p} ± {error}: {} off, bound {bound}, face {face}",
            v.g
        );
        Ok(v)
    }

    fn judge(&self, ray: &Ray, rng: &mut Pcg, tally: &Tally) -> Result<(), TestCaseError> {
        let Some(hit) = self.geometry.closest(ray) else {
            return Ok(());
        };
        add(&tally.hits);
        self.t_is_right(ray, &hit)?;
        let s = self.geometry.surface(ray, &hit);
        let v = self.point_is_right(s.p, s.p_error, hit.prim.prim)?;
        prop_assert!((s.ng.length() - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF, "normal {}", s.ng);
        let loose = (self.back * s.p_error.as_dvec3()).length();
        for i in 0..12 {
            let w = leaving_direction(s.ng, i, rng);
            if w.dot(s.ng) == 0.0 || self.kind == Kind::Any {
                continue;
            }
            let outward = w.dot(s.ng) > 0.0;
            let mut next = Ray::new(offset_origin(s.p, s.p_error, s.ng, w), w);
            next.from = hit.prim;
            let again = self.geometry.closest(&next);
            let local = self.truth.inverse.vector(Exact3::new(w.as_dvec3())).value();
            let sine = (v.local_gradient.normalize().dot(local) / local.length()).abs();
            match self.kind {
                Kind::Sheet => {
                    add(&tally.left);
                    prop_assert!(again.is_none(), "sheet met again: {next:?} {again:?}");
                }
                Kind::Convex | Kind::OpenConvex if outward => {
                    add(&tally.left);
                    prop_assert!(again.is_none(), "met again from outside: {next:?} {again:?}");
                }
                // Where the shape is more than the error of its points there is an inside to cross.
                Kind::Convex | Kind::OpenConvex if v.curvature.max(1.0) * loose < 1e-6 && sine > 1e-3 => {
                    let Some(far) = again else {
                        prop_assert!(self.kind == Kind::OpenConvex, "no way out: {next:?}");
                        continue;
                    };
                    add(&tally.inside);
                    let q = self.geometry.surface(&next, &far);
                    let exit = self.truth.at(far.prim.prim, Exact3::new(q.p.as_dvec3())).gradient;
                    let out = if exit.dot(q.ng.as_dvec3()) < 0.0 { -exit } else { exit };
                    prop_assert!(
                        out.dot(w.as_dvec3()) >= -1e-4 * out.length(),
                        "entered from inside: {next:?} {far:?}"
                    );
                }
                // A chord of the hollow side is 2r·sin α long; a tenth is left to the offset and the other curvature.
                Kind::Hollow(radius) if outward && v.curvature.max(1.0) * loose < 1e-3 * sine => {
                    add(&tally.left);
                    let chord = again.map_or(f64::INFINITY, |h| f64::from(h.t) * local.length());
                    prop_assert!(
                        chord >= 1.8 * radius * sine,
                        "met again at {chord}, sine {sine}: {next:?}"
                    );
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Eight rays from various distances towards each of many shapes; at least so many must hit, leave and cross.
fn judge_all(seed: u64, cases: u32, least: [usize; 3], make: impl Fn(&Placing) -> (Shape, Kind)) {
    let tally = Tally {
        hits: Cell::new(0),
        left: Cell::new(0),
        inside: Cell::new(0),
    };
    for_all(seed, cases, placing(), |placing| {
        let (shape, kind) = make(&placing);
        let judge = Judge::new(shape, kind);
        let mut rng = Pcg::new(placing.seed);
        for i in 0..8 {
            judge.judge(&placing.ray(&mut rng, i), &mut rng, &tally)?;
        }
        Ok(())
    });
    let got = [tally.hits.get(), tally.left.get(), tally.inside.get()];
    assert!(
        (0..3).all(|i| got[i] >= least[i]),
        "only {got:?} hits, leavings, crossings"
    );
}

#[test]
fn spheres_of_any_size_anywhere() {
    judge_all(1, 8000, [5000, 20_000, 5000], |p| {
        let shape = Shape::Sphere {
            center: p.place,
            radius: p.size,
        };
        (shape, Kind::Convex)
    });
}

#[test]
fn planes_of_any_slope_anywhere() {
    judge_all(2, 8000, [5000, 20_000, 0], |p| {
        let normal = p.linear.x_axis.normalize();
        let distance = normal.dot(p.place);
        (Shape::Plane { normal, distance }, Kind::Sheet)
    });
}

fn solids(seed: u64, cases: u32, least: [usize; 3], kind: Kind, solid: impl Fn(&Placing) -> Solid) {
    judge_all(seed, cases, least, |p| (Shape::placed(solid(p), p.map()), kind));
}

#[test]
fn ellipsoids_under_any_map() {
    solids(3, 6000, [3000, 10_000, 3000], Kind::Convex, |_| Solid::Sphere);
}

#[test]
fn boxes_under_any_map() {
    solids(4, 6000, [3000, 10_000, 3000], Kind::Convex, |_| Solid::Box {
        min: DVec3::new(-1.0, -0.5, -0.7),
        max: DVec3::ONE,
    });
}

#[test]
fn flat_boxes_under_any_map() {
    solids(5, 6000, [2000, 10_000, 0], Kind::Sheet, |p| {
        let mut half = DVec3::ONE;
        half[(p.seed % 3) as usize] = 0.0;
        Solid::Box { min: -half, max: half }
    });
}

#[test]
fn cylinders_under_any_map() {
    solids(6, 6000, [3000, 10_000, 3000], Kind::Convex, |_| Solid::Cylinder {
        open: false,
    });
    solids(7, 4500, [2000, 5000, 500], Kind::OpenConvex, |_| Solid::Cylinder {
        open: true,
    });
}

#[test]
fn cones_under_any_map() {
    let cone = |open| {
        move |p: &Placing| {
            let top = [0.0, 0.3, 0.999, 1e-4][(p.seed % 4) as usize];
            let (r0, r1) = if p.seed & 16 == 0 { (1.0, top) } else { (top, 1.0) };
            Solid::Cone { r0, r1, open }
        }
    };
    solids(8, 7500, [3000, 10_000, 2000], Kind::Convex, cone(false));
    solids(9, 4500, [1500, 5000, 300], Kind::OpenConvex, cone(true));
}

#[test]
fn discs_and_rings_under_any_map() {
    solids(10, 6000, [2000, 10_000, 0], Kind::Sheet, |p| Solid::Disc {
        hole: [0.0, 0.5, 0.99][(p.seed % 3) as usize],
    });
}

#[test]
fn tori_under_any_map() {
    for (i, minor) in [0.25, 0.02, 0.9].into_iter().enumerate() {
        // Seen from the hole the ring curves with R − r; the tube itself only bulges.
        let kind = Kind::Hollow(1.0 - minor);
        solids(11 + i as u64, 4000, [1000, 1500, 0], kind, |_| Solid::Torus {
            major: 1.0,
            minor,
        });
    }
    solids(14, 4000, [4000, 0, 0], Kind::Any, |_| Solid::Torus {
        major: 0.5,
        minor: 0.8,
    });
}
