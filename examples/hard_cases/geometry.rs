//! Cases of rays and surfaces.

use crate::case::{Case, share, worst};
use crate::naive;
use glam::{DAffine3, DVec3, Mat4, Vec3};
use pts::math::frame::Frame;
use pts::math::robust::{UNIT_ROUNDOFF, offset_origin};
use pts::math::stats::Pcg;
use pts::math::warp::{cosine_hemisphere, uniform_sphere};
use pts::render::geometry::{GeomObject, Geometry, MeshData};
use pts::render::ray::Ray;
use pts::render::shape::{Shape, Solid};
use pts::scene::Mesh;

const RAYS: usize = 20_000;
const U: f64 = UNIT_ROUNDOFF as f64;

/// One object without light or material.
pub fn only(shape: Shape) -> Geometry {
    Geometry::build(vec![GeomObject::new(shape, 0)], Vec::new())
}

fn ball(center: DVec3, radius: f64) -> Geometry {
    only(Shape::Sphere { center, radius })
}

/// All cases.
pub fn cases() -> Vec<Case> {
    let mut cases = far_sphere();
    cases.push(printed_sphere());
    cases.extend([1e5, 1e7].map(wall));
    cases.push(left_sphere());
    cases.push(small_ball());
    cases.push(horizon());
    cases.push(left_plane());
    cases.extend(edges());
    cases.push(flat_box());
    cases.push(tiny_triangle());
    cases.push(tiny_instance());
    cases.push(far_from_origin());
    cases
}

/// Rays from the origin at a sphere of radius 1 in a distance of 1e4, and where they meet it, in f64 on the same input.
fn far_rays() -> (DVec3, Vec<(Vec3, f64)>) {
    let center = DVec3::new(0.6, 0.0, 0.8) * 1e4;
    let mut rng = Pcg::new(1);
    let mut rays = Vec::new();
    while rays.len() < RAYS {
        let d = (center + uniform_sphere(rng.next_vec2()).as_dvec3() * 0.999)
            .as_vec3()
            .normalize();
        let dd = d.as_dvec3();
        let a = dd.length_squared();
        let k = dd.dot(center) / a;
        let disc = 1.0 - (center - dd * k).length_squared();
        if disc > 0.0 {
            rays.push((d, k - (disc / a).sqrt()));
        }
    }
    (center, rays)
}

fn far_sphere() -> Vec<Case> {
    let (center, rays) = far_rays();
    let geometry = ball(center, 1.0);
    let by_lecture = |d: Vec3| naive::sphere(Vec3::ZERO, d, center.as_vec3(), 1.0, naive::EPS);
    let by_pts = |d: Vec3| geometry.closest(&Ray::new(Vec3::ZERO, d)).map(|h| h.t);
    let off = |t: Option<f32>, exact: f64| t.map_or(0.0, |t| (f64::from(t) - exact).abs());
    vec![
        Case {
            item: "8",
            what: "share of rays that miss a sphere they meet, R = 1 at a distance of 1e4".into(),
            naive: share(rays.iter().map(|(d, _)| by_lecture(*d).is_none())),
            pts: share(rays.iter().map(|(d, _)| by_pts(*d).is_none())),
            exact: 0.0,
            tolerance: 0.0,
            because: "none may",
        },
        Case {
            item: "8",
            what: "largest error of the distance to it".into(),
            naive: worst(rays.iter().map(|(d, t)| off(by_lecture(*d), *t))),
            pts: worst(rays.iter().map(|(d, t)| off(by_pts(*d), *t))),
            exact: 0.0,
            tolerance: U * 1e4 + 1e-9,
            because: "u·t: the distance is rounded to f32 once",
        },
    ]
}

fn printed_sphere() -> Case {
    let mut rng = Pcg::new(2);
    let center = Vec3::new(0.0, 0.0, 5.0);
    let geometry = ball(center.as_dvec3(), 1.0);
    let aimed: Vec<Vec3> = (0..RAYS)
        .map(|_| (center + uniform_sphere(rng.next_vec2()) * 0.9).normalize())
        .collect();
    let printed = |d: &Vec3| naive::sphere_as_printed(Vec3::ZERO, *d, center, 1.0, naive::EPS).is_some();
    Case {
        item: "L, 12",
        what: "share of rays at a sphere that hit it, by the slide's misprint b² − (op² + r²)".into(),
        naive: share(aimed.iter().map(printed)),
        pts: share(
            aimed
                .iter()
                .map(|d| geometry.closest(&Ray::new(Vec3::ZERO, *d)).is_some()),
        ),
        exact: 1.0,
        tolerance: 0.0,
        because: "all must",
    }
}

/// The room's wall as a ball of radius R whose surface is 2 away, seen from inside the room.
fn wall(radius: f64) -> Case {
    let center = DVec3::new(radius + 2.0, 0.3, -0.2);
    let geometry = ball(center, radius);
    let mut rng = Pcg::new(3);
    let (mut by_lecture, mut by_pts) = (Vec::new(), Vec::new());
    for _ in 0..RAYS {
        let d = (uniform_sphere(rng.next_vec2()) + Vec3::X * 1.5).normalize();
        let off = |p: Vec3| ((p.as_dvec3() - center).length() - radius).abs();
        by_lecture.push(
            naive::sphere(Vec3::ZERO, d, center.as_vec3(), radius as f32, naive::EPS).map_or(0.0, |t| off(d * t)),
        );
        let ray = Ray::new(Vec3::ZERO, d);
        by_pts.push(
            geometry
                .closest(&ray)
                .map_or(f64::NAN, |hit| off(geometry.surface(&ray, &hit).p)),
        );
    }
    Case {
        item: if radius < 1e6 { "9" } else { "9, 32" },
        what: format!("distance of hit points from a wall that is a ball of R = {radius:.0e}"),
        naive: worst(by_lecture),
        pts: worst(by_pts),
        exact: 0.0,
        // The farthest points met are some 60 away from the camera.
        tolerance: U * 100.0 + 4.0 * f64::EPSILON * radius,
        because: "u times 100, the farthest point met: it is rounded once",
    }
}

fn left_sphere() -> Case {
    let radius = 1e3;
    let geometry = ball(DVec3::ZERO, radius);
    let mut rng = Pcg::new(4);
    let (mut by_lecture, mut by_pts) = (Vec::new(), Vec::new());
    for _ in 0..RAYS {
        let target = uniform_sphere(rng.next_vec2()) * (0.9 * radius as f32);
        let start = uniform_sphere(rng.next_vec2()) * (3.0 * radius as f32);
        let d = (target - start).normalize();
        let leaving = |n: Vec3| Frame::from_normal(n).to_world(cosine_hemisphere(glam::Vec2::new(0.3, 0.9)));
        if let Some(t) = naive::sphere(start, d, Vec3::ZERO, radius as f32, naive::EPS) {
            let p = start + d * t;
            let wi = leaving(p.normalize());
            by_lecture.push(naive::sphere(p, wi, Vec3::ZERO, radius as f32, naive::EPS).is_some());
        }
        let ray = Ray::new(start, d);
        if let Some(hit) = geometry.closest(&ray) {
            let s = geometry.surface(&ray, &hit);
            let wi = leaving(s.ng);
            let mut next = Ray::new(offset_origin(s.p, s.p_error, s.ng, wi), wi);
            next.from = s.prim;
            by_pts.push(geometry.closest(&next).is_some());
        }
    }
    Case {
        item: "11, 32",
        what: "share of rays that leave a sphere of R = 1e3 outwards and hit it again".into(),
        naive: share(by_lecture),
        pts: share(by_pts),
        exact: 0.0,
        tolerance: 0.0,
        because: "none may",
    }
}

fn small_ball() -> Case {
    let radius = 1e-5f32;
    let geometry = ball(DVec3::ZERO, f64::from(radius));
    let mut rng = Pcg::new(5);
    let (mut by_lecture, mut by_pts) = (Vec::new(), Vec::new());
    for _ in 0..RAYS {
        let d = uniform_sphere(rng.next_vec2());
        let wi = Frame::from_normal(-d).to_world(cosine_hemisphere(rng.next_vec2()));
        by_lecture.push(naive::sphere(d * radius, wi, Vec3::ZERO, radius, naive::EPS).is_none());
        let ray = Ray::new(Vec3::ZERO, d);
        if let Some(hit) = geometry.closest(&ray) {
            let s = geometry.surface(&ray, &hit);
            let mut next = Ray::new(offset_origin(s.p, s.p_error, s.ng, wi), wi);
            next.from = s.prim;
            by_pts.push(geometry.closest(&next).is_none());
        }
    }
    Case {
        item: "15, 32",
        what: "share of rays inside a ball of R = 1e-5 that never come out".into(),
        naive: share(by_lecture),
        pts: share(by_pts),
        exact: 0.0,
        tolerance: 0.0,
        because: "none may",
    }
}

fn horizon() -> Case {
    let d = Vec3::new(1.0, -5e-7, 0.0);
    let geometry = only(Shape::Plane {
        normal: DVec3::Y,
        distance: -1.7,
    });
    let exact = 1.7 / f64::from(5e-7f32);
    Case {
        item: "16",
        what: "distance to the ground along a ray 5e-7 below the horizon, eyes 1.7 above it".into(),
        naive: naive::plane(Vec3::ZERO, d, Vec3::Y, -1.7).map_or(f64::INFINITY, f64::from),
        pts: geometry
            .closest(&Ray::new(Vec3::ZERO, d))
            .map_or(f64::INFINITY, |h| f64::from(h.t)),
        exact,
        tolerance: 2.0 * U * exact,
        because: "2u relative",
    }
}

fn left_plane() -> Case {
    let normal = DVec3::new(0.36, 0.48, 0.8);
    let distance = 1e4;
    let geometry = only(Shape::Plane { normal, distance });
    let n = normal.as_vec3();
    let mut rng = Pcg::new(6);
    let (mut by_lecture, mut by_pts) = (Vec::new(), Vec::new());
    let below = |p: Vec3| normal.dot(p.as_dvec3()) - distance >= 0.0;
    for _ in 0..RAYS {
        let d = (uniform_sphere(rng.next_vec2()) + n * 1.2).normalize();
        if let Some(t) = naive::plane(Vec3::ZERO, d, n, distance as f32) {
            by_lecture.push(below(d * t - n * naive::EPS));
        }
        let ray = Ray::new(Vec3::ZERO, d);
        if let Some(hit) = geometry.closest(&ray) {
            let s = geometry.surface(&ray, &hit);
            by_pts.push(below(offset_origin(s.p, s.p_error, s.ng, -n)));
        }
    }
    Case {
        item: "17, 33",
        what: "share of rays that start on the wrong side of a plane 1e4 away".into(),
        naive: share(by_lecture),
        pts: share(by_pts),
        exact: 0.0,
        tolerance: 0.0,
        because: "none may",
    }
}

/// A ball of 2·32² triangles.
fn mesh(radius: f32) -> MeshData {
    let n = 32u32;
    let point = |i: u32, j: u32| {
        let (theta, phi) = (
            std::f64::consts::PI * f64::from(j) / f64::from(n),
            std::f64::consts::TAU * f64::from(i % n) / f64::from(n),
        );
        // The poles are one point, whatever their meridian.
        let sin = if j == 0 || j == n { 0.0 } else { theta.sin() };
        (DVec3::new(sin * phi.cos(), theta.cos(), sin * phi.sin()) * f64::from(radius)).as_vec3()
    };
    let quads = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let mut data = MeshData::default();
    for (i, j) in quads {
        let first = data.positions.len() as u32;
        data.positions
            .extend([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
        if j > 0 {
            data.triangles.push([first, first + 1, first + 2]);
        }
        if j + 1 < n {
            data.triangles.push([first, first + 2, first + 3]);
        }
    }
    data
}

fn edges() -> Vec<Case> {
    let leaks = |radius: f32, det_eps: f32| {
        let data = mesh(radius);
        let triangles: Vec<[Vec3; 3]> = (0..data.triangles.len() as u32)
            .filter_map(|t| data.corners(t))
            .collect();
        let objects = vec![GeomObject::new(Shape::mesh(0, DAffine3::IDENTITY), 0)];
        let geometry = Geometry::build(objects, vec![data]);
        let mut rng = Pcg::new(7);
        let (mut by_lecture, mut by_pts) = (Vec::new(), Vec::new());
        for _ in 0..RAYS / 4 {
            let [a, b, _] = triangles[rng.next_u32() as usize % triangles.len()];
            let start = uniform_sphere(rng.next_vec2()) * (0.2 * radius);
            let d = (a.lerp(b, rng.next_f32()) - start).normalize();
            by_lecture.push(
                !triangles
                    .iter()
                    .any(|t| naive::triangle(start, d, *t, det_eps).is_some()),
            );
            by_pts.push(geometry.closest(&Ray::new(start, d)).is_none());
        }
        (share(by_lecture), share(by_pts))
    };
    let case = |item, what: &str, (naive, pts)| Case {
        item,
        what: what.into(),
        naive,
        pts,
        exact: 0.0,
        tolerance: 0.0,
        because: "none may",
    };
    vec![
        case(
            "20",
            "share of rays at shared edges that leave a closed mesh",
            leaks(1.0, 0.0),
        ),
        case(
            "21",
            "the same for a mesh of radius 1e-4, determinants below 1e-8 refused",
            leaks(1e-4, 1e-8),
        ),
    ]
}

fn flat_box() -> Case {
    let (min, max) = (Vec3::new(-1.0, -1.0, 0.3), Vec3::new(1.0, 1.0, 0.3));
    let geometry = only(Shape::placed(
        Solid::Box {
            min: min.as_dvec3(),
            max: max.as_dvec3(),
        },
        DAffine3::IDENTITY,
    ));
    let mut rng = Pcg::new(8);
    let (mut by_slabs, mut by_pts) = (Vec::new(), Vec::new());
    while by_pts.len() < RAYS {
        let o = uniform_sphere(rng.next_vec2()) * 3.0;
        let d = (Vec3::new(1.0, 2.0 * rng.next_f32() - 1.0, 0.3) - o).normalize();
        // Oracle: the plane z = 0.3 in f64, and whether the point lies within the square.
        let (o64, d64) = (o.as_dvec3(), d.as_dvec3());
        let p = o64 + d64 * ((f64::from(max.z) - o64.z) / d64.z);
        if p.x.abs() <= 1.0 && p.y.abs() <= 1.0 {
            by_slabs.push(!naive::is_box_hit(o, d, min, max));
            by_pts.push(geometry.closest(&Ray::new(o, d)).is_none());
        }
    }
    Case {
        item: "28",
        what: "share of hits at the edge of a box without thickness that are missed".into(),
        naive: share(by_slabs),
        pts: share(by_pts),
        exact: 0.0,
        tolerance: 0.0,
        because: "none may",
    }
}

fn tiny_triangle() -> Case {
    let s = 1e-11f32;
    let corners = [Vec3::ZERO, Vec3::new(s, 0.3 * s, 0.0), Vec3::new(0.2 * s, s, 0.1 * s)];
    let data = MeshData {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    let geometry = Geometry::build(vec![GeomObject::new(Shape::mesh(0, DAffine3::IDENTITY), 0)], vec![data]);
    let middle = (corners[1] + corners[2]) / 3.0;
    let ray = Ray::new(middle + Vec3::Z * s, -Vec3::Z);
    let length = |n: Vec3| n.as_dvec3().length();
    Case {
        item: "22",
        what: "length of the unit normal of a triangle with edges of 1e-11".into(),
        naive: length((corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize()),
        pts: geometry
            .closest(&ray)
            .map_or(f64::NAN, |hit| length(geometry.surface(&ray, &hit).ng)),
        exact: 1.0,
        tolerance: 4.0 * U,
        because: "4u",
    }
}

fn tiny_instance() -> Case {
    let scale = 1e-13f64;
    let map = DAffine3::from_scale(DVec3::splat(scale)) * DAffine3::from_rotation_y(0.5);
    let geometry = only(Shape::placed(
        Solid::Box {
            min: -DVec3::ONE,
            max: DVec3::ONE,
        },
        map,
    ));
    let o = Vec3::Y * 1e-12;
    let by_matrix = {
        let m = Mat4::from_scale(Vec3::splat(scale as f32)) * Mat4::from_rotation_y(0.5);
        // The ray meets the top, y = 1 of the box's own space, where t runs in the world's unit.
        let (local, ahead) = (naive::to_instance(m, o), naive::to_instance(m, o - Vec3::Y));
        f64::from((1.0 - local.y) / (ahead.y - local.y))
    };
    Case {
        item: "37",
        what: "distance to a box that its instance scales by 1e-13".into(),
        naive: by_matrix,
        pts: geometry
            .closest(&Ray::new(o, -Vec3::Y))
            .map_or(f64::NAN, |h| f64::from(h.t)),
        exact: f64::from(o.y) - scale,
        tolerance: 4.0 * U * 1e-12,
        because: "4u relative",
    }
}

fn far_from_origin() -> Case {
    let (far, corner) = (DVec3::splat(1e6), DVec3::new(0.013, 0.027, 0.041));
    let mesh = Mesh::from_f64("", &[far, far + corner, far + DVec3::X], &[[0, 1, 2]]);
    // Seen from a camera at `far`, as the engine sees it.
    let by_pts = mesh.map_or(f64::NAN, |m| {
        (m.center - far + m.positions[1].as_dvec3()).distance(corner)
    });
    Case {
        item: "41",
        what: "how far a corner moves when its mesh stands 1e6 away from the origin".into(),
        naive: ((far + corner).as_vec3() - far.as_vec3()).as_dvec3().distance(corner),
        pts: by_pts,
        exact: 0.0,
        tolerance: U + 1e6 * f64::EPSILON,
        because: "u·size + f64's own rounding of the input",
    }
}
