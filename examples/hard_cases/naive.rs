//! The formulas of the lecture and of many a first renderer, in f32 as they are written there. Nothing here belongs to
//! the renderer: it is what the renderer is compared with.

use glam::{Mat4, Vec3};

/// The fixed distance by which rays are kept off the surface they leave.
pub const EPS: f32 = 1e-4;

/// The lecture's sphere: roots of t² − 2bt + c with |d| taken for 1.
pub fn sphere(o: Vec3, d: Vec3, center: Vec3, radius: f32, eps: f32) -> Option<f32> {
    let op = center - o;
    let b = op.dot(d);
    let det = b * b - op.dot(op) + radius * radius;
    roots(b, det, eps)
}

/// The same as misprinted on the slide: b² − (op² + r²).
pub fn sphere_as_printed(o: Vec3, d: Vec3, center: Vec3, radius: f32, eps: f32) -> Option<f32> {
    let op = center - o;
    let b = op.dot(d);
    roots(b, b * b - (op.dot(op) + radius * radius), eps)
}

fn roots(b: f32, det: f32, eps: f32) -> Option<f32> {
    if det < 0.0 {
        return None;
    }
    let root = det.sqrt();
    [b - root, b + root].into_iter().find(|t| *t > eps)
}

/// Möller and Trumbore's triangle, which each triangle decides for itself.
pub fn triangle(o: Vec3, d: Vec3, [a, b, c]: [Vec3; 3], det_eps: f32) -> Option<f32> {
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    if det.abs() <= det_eps {
        return None;
    }
    let inv = 1.0 / det;
    let s = o - a;
    let u = s.dot(p) * inv;
    let q = s.cross(e1);
    let v = d.dot(q) * inv;
    let t = e2.dot(q) * inv;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// A plane, refused where it is nearly parallel to the ray.
pub fn plane(o: Vec3, d: Vec3, n: Vec3, distance: f32) -> Option<f32> {
    let slope = n.dot(d);
    (slope.abs() >= 1e-6)
        .then(|| (distance - n.dot(o)) / slope)
        .filter(|t| *t > EPS)
}

/// The slab test of a box.
pub fn is_box_hit(o: Vec3, d: Vec3, min: Vec3, max: Vec3) -> bool {
    let (a, b) = ((min - o) / d, (max - o) / d);
    let (near, far) = (a.min(b), a.max(b));
    near.max_element().max(0.0) <= far.min_element()
}

/// 1 − cos of the half angle under which a sphere is seen, by way of the cosine.
pub fn one_minus_cos(radius: f32, distance: f32) -> f32 {
    let s = radius / distance;
    1.0 - (1.0 - s * s).sqrt()
}

/// The sine of a direction in a cone, from its cosine.
pub fn sine_in_cone(u: f32, one_minus_cos_max: f32) -> f32 {
    let cos = 1.0 - u * one_minus_cos_max;
    (1.0 - cos * cos).sqrt()
}

/// GGX's density of facets at an angle of cosine `cos`.
pub fn ggx(cos: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let k = (a2 - 1.0) * cos * cos + 1.0;
    a2 / (std::f32::consts::PI * k * k)
}

/// Fresnel's reflectance with the transmitted cosine from √(1 − (1 − c²)/η²).
pub fn fresnel(cos: f32, eta: f32) -> f32 {
    let k = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if k <= 0.0 {
        return 1.0;
    }
    let t = k.sqrt();
    let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
    0.5 * (s * s + p * p)
}

/// Schlick's curve with the cosine of the incident ray on either side.
pub fn schlick(cos: f32, eta: f32) -> f32 {
    let f0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
    f0 + (1.0 - f0) * (1.0 - cos).powi(5)
}

/// The power heuristic with the squares as they stand.
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    a * a / (a * a + b * b)
}

/// Frisvad's basis without its special case.
pub fn basis(n: Vec3) -> [Vec3; 2] {
    let a = 1.0 / (1.0 + n.z);
    let b = -n.x * n.y * a;
    [
        Vec3::new(1.0 - n.x * n.x * a, b, -n.x),
        Vec3::new(b, 1.0 - n.y * n.y * a, -n.y),
    ]
}

/// The direction from a point of the lens to the point in focus.
pub fn lens(dir: Vec3, on_lens: Vec3, focus: f32) -> Vec3 {
    (dir * focus - on_lens).normalize()
}

/// A ray to the space of an instance, by the inverse of an f32 matrix.
pub fn to_instance(world_from_object: Mat4, p: Vec3) -> Vec3 {
    world_from_object.inverse().transform_point3(p)
}
