//! From a hit to a point on a surface, with the bound that keeps the next ray from hitting it again.

use super::moved::{MovedShape, moved_shape};
use super::{GeomObject, Geometry, MeshData};
use crate::math::robust::{UNIT_ROUNDOFF, gamma, try_normalize_f64};
use crate::render::motion::Motion;
use crate::render::ray::{Hit, Ray};
use crate::render::shape::placed::{abs, error_after_rounding, unit_normal};
use crate::render::shape::{MeshPlacement, Placed, Shape};
use crate::render::surface::Surface;
use glam::{DVec3, Vec2, Vec3};

impl Geometry {
    /// The surface where a ray hit. `hit` must come from this geometry and this ray.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let object = &self.objects[hit.prim.object as usize];
        if let Some(motion) = &object.motion {
            return self.moving_surface(object, motion, ray, hit);
        }
        let along = || ray.at(hit.exact);
        match &object.shape {
            Shape::Sphere { center, radius } => {
                let n = sphere_normal(along() - *center, *radius);
                let p = *center + n * *radius;
                smooth(object, hit, p, (center.abs() + *radius) * F64_MARGIN, n)
            }
            Shape::Plane { normal, distance } => {
                let p = along();
                let p = p - *normal * (normal.dot(p) - distance);
                smooth(object, hit, p, (p.abs() + distance.abs()) * F64_MARGIN, *normal)
            }
            Shape::Placed(placed) => {
                let (p, p_error, n) = placed.surface(hit.prim.prim, along());
                let ng = n.as_vec3();
                of_object(object, hit, hit.prim.prim, Point { p, p_error, ng, ns: ng })
            }
            Shape::Mesh { mesh, placement } => {
                let mesh = &self.meshes[*mesh as usize];
                let corners = mesh.corners(hit.prim.prim);
                let normals = mesh.by_corner(&mesh.normals, hit.prim.prim);
                let face = Face::of(mesh, corners, normals);
                let point = face.and_then(|face| on_triangle(&face, placement, ray, hit));
                let point = point.unwrap_or_else(|| Point::unknown(along(), ray));
                let slot = mesh.face_materials.get(hit.prim.prim as usize).copied().unwrap_or(0);
                of_object(object, hit, slot, point)
            }
        }
    }

    /// The surface of a shape where it is at the ray's time.
    #[inline(never)]
    fn moving_surface(&self, object: &GeomObject, motion: &Motion, ray: &Ray, hit: &Hit) -> Surface {
        let moved = motion.at(ray.time);
        let along = ray.at(hit.exact);
        let solid = |placed: &Placed| {
            let (p, p_error, n) = placed.surface(hit.prim.prim, along);
            let ng = n.as_vec3();
            (hit.prim.prim, Point { p, p_error, ng, ns: ng })
        };
        let (slot, mut point) = match moved_shape(&object.shape, &moved) {
            MovedShape::Plane { normal, distance } => {
                let p = along - normal * (normal.dot(along) - distance);
                let p_error = error_after_rounding(p.as_vec3(), (p.abs() + distance.abs()) * F64_MARGIN);
                let ng = normal.as_vec3();
                (0, Point { p, p_error, ng, ns: ng })
            }
            MovedShape::Placed(placed) => solid(&placed),
            MovedShape::Mesh { mesh, placement } => {
                let mesh = &self.meshes[mesh as usize];
                let corners = mesh.corners_at(hit.prim.prim, ray.time);
                let face = Face::of(mesh, corners, mesh.normals_at(hit.prim.prim, ray.time));
                let point = face.and_then(|face| on_triangle(&face, &placement, ray, hit));
                let point = point.unwrap_or_else(|| Point::unknown(along, ray));
                let slot = mesh.face_materials.get(hit.prim.prim as usize).copied().unwrap_or(0);
                (slot, point)
            }
        };
        // The rounding of the way to where the shape was compiled, and back.
        let back = moved.inverse();
        let there = abs(back.matrix3) * point.p.abs() + back.translation.abs();
        let rounding = (abs(moved.matrix3) * there + moved.translation.abs()) * F64_MARGIN;
        point.p_error += rounding.as_vec3() * 2.0;
        of_object(object, hit, slot, point)
    }
}

/// Relative error of a few dozen f64 operations; far below the rounding of a point to f32, except for points near the
/// camera on shapes that are huge or far: there it is what counts.
const F64_MARGIN: f64 = 32.0 * f64::EPSILON;

/// The direction of `v`, whose length should be `radius`. If it nearly is, a short series for 1/√ replaces root and
/// division: with |v|² = r²·(1 + e), the error is below e³ ≤ 1e-12. Otherwise the largest component scales first.
#[inline(always)]
fn sphere_normal(v: DVec3, radius: f64) -> DVec3 {
    const NEAR: f64 = 1e-4;
    let w = v * (1.0 / radius);
    let e = w.length_squared() - 1.0;
    if e.abs() < NEAR {
        w * (1.0 - e * (0.5 - 0.375 * e))
    } else {
        try_normalize_f64(v).unwrap_or(DVec3::Y)
    }
}

struct Point {
    p: DVec3,
    /// Of the point rounded to f32.
    p_error: Vec3,
    ng: Vec3,
    ns: Vec3,
}

impl Point {
    /// For a triangle that does not exist, which no ray hits.
    fn unknown(p: DVec3, ray: &Ray) -> Point {
        let n = (-ray.dir).try_normalize().unwrap_or(Vec3::Y);
        Point {
            p,
            p_error: Vec3::ZERO,
            ng: n,
            ns: n,
        }
    }
}

#[inline(always)]
fn of_object(object: &GeomObject, hit: &Hit, slot: u32, point: Point) -> Surface {
    let p = point.p.as_vec3();
    Surface {
        p,
        p_error: point.p_error,
        p_low: (point.p - p.as_dvec3()).as_vec3(),
        ng: point.ng,
        ns: point.ns,
        prim: hit.prim,
        material: object.material(slot),
        light: object.lights.light(hit.prim.prim),
    }
}

#[inline(always)]
fn smooth(object: &GeomObject, hit: &Hit, p: DVec3, error: DVec3, n: DVec3) -> Surface {
    let rounded = p.as_vec3();
    let ng = n.as_vec3();
    // Rounded up: twice a bound that is itself tiny beside the rounding of the point.
    let p_error = rounded.abs() * (UNIT_ROUNDOFF * (1.0 + gamma(4))) + error.as_vec3() * 2.0;
    of_object(object, hit, 0, Point { p, p_error, ng, ns: ng })
}

/// Barycentric weights of the three corners.
pub(super) fn weights(b: Vec2) -> [f64; 3] {
    let (b1, b2) = (f64::from(b.x), f64::from(b.y));
    [1.0 - b1 - b2, b1, b2]
}

/// A triangle of a mesh as a ray meets it.
struct Face {
    corners: [Vec3; 3],
    /// Shading normals, if it has any.
    normals: Option<[Vec3; 3]>,
    flipped: bool,
}

impl Face {
    #[inline(always)]
    fn of(mesh: &MeshData, corners: Option<[Vec3; 3]>, normals: Option<[Vec3; 3]>) -> Option<Face> {
        Some(Face {
            corners: corners?,
            normals,
            flipped: mesh.flip_winding,
        })
    }
}

/// Where the ray meets the plane of the triangle, moved into the triangle where rounding led the ray beside it, and both
/// normals. Formed from the corners, so that it lies in the plane to the rounding of f64 however far the ray came.
#[inline(always)]
fn on_triangle(face: &Face, placement: &MeshPlacement, ray: &Ray, hit: &Hit) -> Option<Point> {
    let [v0, v1, v2] = face.corners.map(|v| v.as_dvec3());
    let cross = (v1 - v0).cross(v2 - v0);
    let b = inside(
        [v0, v1, v2],
        cross,
        placement.mesh_from_world.transform_point3(ray.at(hit.exact)),
    );
    let b = b.unwrap_or_else(|| weights(hit.b));
    let local = v0 * b[0] + v1 * b[1] + v2 * b[2];
    let world = placement.world_from_mesh.transform_point3(local);
    let forward = abs(placement.world_from_mesh.matrix3);
    // The corners of this triangle and of its neighbours are rounded to f32: what was flat may be folded by that.
    let corners = v0.abs() * b[0] + v1.abs() * b[1] + v2.abs() * b[2];
    let largest = v0.abs().max(v1.abs()).max(v2.abs());
    let local_error = corners * f64::from(gamma(2)) + largest * F64_MARGIN;
    let rounding = forward * local_error + placement.world_from_mesh.translation.abs() * F64_MARGIN;
    let p_error = error_after_rounding(world.as_vec3(), rounding);
    let p = world;

    let to_world = |n: DVec3| unit_normal(&placement.mesh_from_world, n);
    let ng = to_world(if face.flipped { -cross } else { cross }).as_vec3();
    let ns = face.normals.and_then(|n| {
        let mean = n[0].as_dvec3() * b[0] + n[1].as_dvec3() * b[1] + n[2].as_dvec3() * b[2];
        try_normalize_f64(placement.mesh_from_world.matrix3.transpose() * mean)
    });
    // Opposite or missing normals cancel or do not exist: the face itself decides.
    let ns = ns.map_or(ng, |n| n.as_vec3());
    let ns = if ns.dot(ng) < 0.0 { -ns } else { ns };
    Some(Point { p, p_error, ng, ns })
}

/// Barycentric weights of the point of the triangle next to `p`, which lies beside it at most by rounding; `cross` is
/// twice its area along the normal. `None` if that is too small to tell.
#[inline(always)]
fn inside([v0, v1, v2]: [DVec3; 3], cross: DVec3, p: DVec3) -> Option<[f64; 3]> {
    let (e1, e2, d) = (v1 - v0, v2 - v0, p - v0);
    let b1 = d.cross(e2).dot(cross).max(0.0);
    let b2 = e1.cross(d).dot(cross).max(0.0);
    let b0 = (cross.length_squared() - b1 - b2).max(0.0);
    let inverse = 1.0 / (b0 + b1 + b2);
    let b = [b0 * inverse, b1 * inverse, b2 * inverse];
    b.iter().all(|x| x.is_finite()).then_some(b)
}
