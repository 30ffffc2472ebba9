//! What only textured materials need at a hit.

use super::moved::{MovedShape, moved_shape};
use super::surface::weights;
use super::{Geometry, MeshData};
use crate::math::portable;
use crate::render::ray::Hit;
use crate::render::shape::{MeshPlacement, Shape, Solid};
use crate::render::surface::{Attributes, Surface};
use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use std::f32::consts::{PI, TAU};

impl Geometry {
    /// Texture coordinates, vertex colour and tangents where a ray of this time hit.
    ///
    /// Spheres are unrolled about their y axis: u runs once around from +x towards +z, v from the top (0) to
    /// the bottom (1). Other analytic shapes have no coordinates of their own.
    pub fn attributes(&self, hit: &Hit, surface: &Surface, time: f32) -> Attributes {
        let object = &self.objects[hit.prim.object as usize];
        if let Some(motion) = &object.motion {
            return self.moving_attributes(&object.shape, &motion.at(time), hit, surface);
        }
        match &object.shape {
            Shape::Sphere { center, radius } => {
                let map =
                    DAffine3::from_scale_rotation_translation(DVec3::splat(*radius), glam::DQuat::IDENTITY, *center);
                on_sphere(&map, (surface.p.as_dvec3() - *center) / *radius)
            }
            Shape::Placed(placed) if placed.kind == Solid::Sphere => on_sphere(
                &placed.world_from_object,
                placed.object_from_world.transform_point3(surface.p.as_dvec3()),
            ),
            Shape::Mesh { mesh, placement } => on_triangle(&self.meshes[*mesh as usize], placement, hit),
            Shape::Plane { .. } | Shape::Placed(_) => Attributes::default(),
        }
    }

    /// Those of a shape that a map has moved.
    #[inline(never)]
    fn moving_attributes(&self, shape: &Shape, map: &DAffine3, hit: &Hit, surface: &Surface) -> Attributes {
        match moved_shape(shape, map) {
            MovedShape::Placed(placed) if placed.kind == Solid::Sphere => on_sphere(
                &placed.world_from_object,
                placed.object_from_world.transform_point3(surface.p.as_dvec3()),
            ),
            MovedShape::Mesh { mesh, placement } => on_triangle(&self.meshes[mesh as usize], &placement, hit),
            MovedShape::Plane { .. } | MovedShape::Placed(_) => Attributes::default(),
        }
    }
}

fn on_sphere(world_from_sphere: &DAffine3, p: DVec3) -> Attributes {
    let q = p.as_vec3();
    let turns = portable::atan2(q.z, q.x) / TAU;
    let u = if turns < 0.0 { turns + 1.0 } else { turns };
    let v = portable::acos(q.y) / PI;
    // Towards growing u, and towards the top: d/dθ of the meridian, upwards.
    let tangent = DVec3::new(-p.z, 0.0, p.x);
    let across = (p.x * p.x + p.z * p.z).sqrt();
    let up = if across > 0.0 {
        DVec3::new(-p.x / across * p.y, across, -p.z / across * p.y)
    } else {
        DVec3::ZERO
    };
    Attributes {
        uv: [Vec2::new(u, v); 4],
        tangent: world_from_sphere.transform_vector3(tangent).as_vec3(),
        bitangent: world_from_sphere.transform_vector3(up).as_vec3(),
        ..Attributes::default()
    }
}

fn on_triangle(mesh: &MeshData, placement: &MeshPlacement, hit: &Hit) -> Attributes {
    let prim = hit.prim.prim;
    let b = weights(hit.b).map(|x| x as f32);
    let mut out = Attributes::default();
    for set in (0..out.uv.len()).rev() {
        let values = mesh.uvs.get(set).and_then(|uvs| mesh.by_corner(uvs, prim));
        if let Some([p, q, r]) = values {
            out.uv[set] = p * b[0] + q * b[1] + r * b[2];
        }
    }
    // Sets the mesh lacks repeat set 0.
    for set in 1..out.uv.len() {
        if mesh.uvs.get(set).is_none_or(|uvs| uvs.is_empty()) {
            out.uv[set] = out.uv[0];
        }
    }
    if let Some([p, q, r]) = mesh.by_corner(&mesh.colors, prim) {
        out.color = p * b[0] + q * b[1] + r * b[2];
    }
    if let Some((tangent, bitangent)) = given_tangents(mesh, prim, b).or_else(|| tangents_of_uv(mesh, prim)) {
        let to_world = |v: Vec3| placement.world_from_mesh.transform_vector3(v.as_dvec3()).as_vec3();
        out.tangent = to_world(tangent);
        out.bitangent = to_world(bitangent);
    }
    out
}

/// Interpolated tangents of the mesh, of one that bends those when the shutter opens; the bitangent is w·(n × t), in the mesh's own space.
fn given_tangents(mesh: &MeshData, prim: u32, b: [f32; 3]) -> Option<(Vec3, Vec3)> {
    let t: [Vec4; 3] = mesh.by_corner(&mesh.tangents, prim)?;
    let n = mesh.by_corner(&mesh.normals, prim)?;
    let tangent = t[0] * b[0] + t[1] * b[1] + t[2] * b[2];
    let normal = n[0] * b[0] + n[1] * b[1] + n[2] * b[2];
    let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
    let tangent = tangent.truncate();
    (tangent != Vec3::ZERO).then(|| (tangent, normal.cross(tangent) * sign))
}

/// Directions in which u and −v grow over the face; `None` where the coordinates are missing or degenerate.
fn tangents_of_uv(mesh: &MeshData, prim: u32) -> Option<(Vec3, Vec3)> {
    let p = mesh.corners(prim)?.map(|p| p.as_dvec3());
    let uv = mesh.by_corner(mesh.uvs.first()?, prim)?.map(|t| t.as_dvec2());
    let (e1, e2) = (p[1] - p[0], p[2] - p[0]);
    let (d1, d2) = (uv[1] - uv[0], uv[2] - uv[0]);
    let det = d1.x * d2.y - d1.y * d2.x;
    if det == 0.0 || !det.is_finite() {
        return None;
    }
    let along_u = (e1 * d2.y - e2 * d1.y) / det;
    let along_v = (e2 * d1.x - e1 * d2.x) / det;
    Some((along_u.as_vec3(), -along_v.as_vec3()))
}
