//! Tangents for normal maps whose model brings none: MikkTSpace, as the specification asks.

use super::part::Part;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{DAffine2, DVec2, Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// Triangles as the generator wants them, one corner at a time.
struct Corners<'a> {
    part: &'a Part,
    uvs: Vec<Vec2>,
    tangents: Vec<[Vec4; 3]>,
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.part.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.part.positions[self.vertex(face, corner)].as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.part.normals[self.vertex(face, corner)].to_array()
    }

    /// The generator wants v upwards: with it, its sign is that of glTF's bitangent (green up).
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.uvs[self.vertex(face, corner)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            let mut tangent = Vec4::from(space.tangent_encoded());
            // The generator takes the sign from the winding of the faces.
            if self.part.flip_winding {
                tangent.w = -tangent.w;
            }
            // Absurd coordinates overflow in the generator; the fallback stays.
            if tangent.is_finite() && tangent.truncate().is_normalized() {
                self.tangents[face][corner] = tangent;
            }
        }
    }
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.part.triangles[face][corner] as usize
    }
}

/// Gives the part tangents along the u of its coordinate set `uv_set`, as `transform` places it on the normal map.
/// Needs finite positions. Without normals the faces are flat and get vertices of their own; vertices
/// whose faces disagree about the tangent are split. Does nothing without that coordinate set.
pub(super) fn generate(part: &mut Part, uv_set: usize, transform: DAffine2) {
    if part.uvs.get(uv_set).is_none_or(Vec::is_empty) {
        return;
    }
    if part.normals.is_empty() {
        explode(part);
    }
    let mapped = |uv: &Vec2| transform.transform_point2(DVec2::from(*uv)).as_vec2();
    let fallback = |face: &[u32; 3]| face.map(|v| any_tangent(part.normals[v as usize]));
    let mut corners = Corners {
        uvs: part.uvs[uv_set].iter().map(mapped).collect(),
        tangents: part.triangles.iter().map(fallback).collect(),
        part,
    };
    let done: Result<(), _> = generate_tangents(&mut corners);
    if done.is_err() {
        return; // the error has no variants
    }
    let tangents = corners.tangents;
    split(part, &tangents);
}

/// Some unit tangent where the texture coordinates give none.
fn any_tangent(normal: Vec3) -> Vec4 {
    crate::math::frame::Frame::from_normal(normal).t.extend(1.0)
}

/// Gives every corner a vertex of its own with the normal of its face.
fn explode(part: &mut Part) {
    let order: Vec<u32> = part.triangles.iter().flatten().copied().collect();
    part.gather(&order);
    for (i, face) in part.triangles.iter_mut().enumerate() {
        let first = 3 * i as u32;
        *face = [first, first + 1, first + 2];
    }
    let sign = if part.flip_winding { -1.0 } else { 1.0 };
    let corners = part.positions.chunks_exact(3);
    let normal = |c: &[glam::DVec3]| (c[1] - c[0]).cross(c[2] - c[0]).normalize_or(glam::DVec3::Z) * sign;
    part.normals = corners.flat_map(|c| [normal(c).as_vec3(); 3]).collect();
}

/// Assigns the tangents of the corners to vertices, adding a copy of a vertex for each further tangent.
fn split(part: &mut Part, tangents: &[[Vec4; 3]]) {
    let vertices = part.positions.len();
    let mut own: Vec<Option<Vec4>> = vec![None; vertices];
    let mut copies: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let mut order: Vec<u32> = (0..vertices as u32).collect();
    let mut added: Vec<Vec4> = Vec::new();
    for (face, tangents) in part.triangles.iter_mut().zip(tangents) {
        for (corner, tangent) in face.iter_mut().zip(tangents) {
            let vertex = *corner;
            let first = own[vertex as usize].get_or_insert(*tangent);
            if *first == *tangent {
                continue;
            }
            let key = (vertex, tangent.to_array().map(f32::to_bits));
            *corner = *copies.entry(key).or_insert_with(|| {
                order.push(vertex);
                added.push(*tangent);
                order.len() as u32 - 1
            });
        }
    }
    part.gather(&order);
    let normals = &part.normals;
    let own = own
        .into_iter()
        .zip(normals)
        .map(|(t, n)| t.unwrap_or_else(|| any_tangent(*n)));
    part.tangents = own.chain(added).collect();
}
