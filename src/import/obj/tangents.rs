//! Tangents for normal maps: MikkTSpace, in which normal maps are baked.

use super::normals::Chains;
use crate::scene::Mesh;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::Vec4;

/// Gives a mesh tangents along its first texture coordinates. Vertices whose faces disagree, as along the seam of a
/// mirrored texture, are split. Meshes without normals or coordinates are left alone: their flat faces need none.
pub(super) fn add_tangents(mesh: &mut Mesh) {
    if mesh.normals.is_empty() || mesh.uvs.is_empty() {
        return;
    }
    let mut corners = Corners {
        tangents: vec![[Vec4::ZERO; 3]; mesh.triangles.len()],
        mesh,
    };
    if generate_tangents(&mut corners).is_err() {
        return;
    }
    let tangents = corners.tangents;
    mesh.tangents = vec![Vec4::ZERO; mesh.positions.len()];
    let mut taken = vec![false; mesh.positions.len()];
    let mut copies: Chains<[u32; 4], u32> = Chains::from_vertex(0);
    let mut triangles = std::mem::take(&mut mesh.triangles);
    for (corner, tangent) in triangles.iter_mut().flatten().zip(tangents.into_iter().flatten()) {
        let vertex = *corner as usize;
        if !taken[vertex] {
            taken[vertex] = true;
            mesh.tangents[vertex] = tangent;
        } else if mesh.tangents[vertex] != tangent {
            let key = tangent.to_array().map(f32::to_bits);
            *corner = *copies.entry(*corner, key, || copy_vertex(mesh, vertex, tangent));
        }
    }
    mesh.triangles = triangles;
}

fn copy_vertex(mesh: &mut Mesh, vertex: usize, tangent: Vec4) -> u32 {
    mesh.positions.push(mesh.positions[vertex]);
    mesh.normals.push(mesh.normals[vertex]);
    for uvs in mesh.uvs.iter_mut().filter(|uvs| !uvs.is_empty()) {
        uvs.push(uvs[vertex]);
    }
    if !mesh.colors.is_empty() {
        mesh.colors.push(mesh.colors[vertex]);
    }
    mesh.tangents.push(tangent);
    mesh.positions.len() as u32 - 1
}

/// The mesh as the generator asks for it, corner by corner. All indices come from the mesh and are in range.
struct Corners<'a> {
    mesh: &'a Mesh,
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].to_array()
    }

    /// The generator wants v upwards; the scene's grows downwards.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.mesh.uvs[0][self.vertex(face, corner)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        // Where there is none (no area in the texture) the zero vector says so.
        if let Some(space) = space {
            let tangent = Vec4::from(space.tangent_encoded());
            if tangent.is_finite() && tangent.truncate().is_normalized() {
                self.tangents[face][corner] = tangent;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec2, Vec3};

    /// Two squares side by side, the right one's texture mirrored: u runs 0 1 0 from left to right.
    #[test]
    fn tangents_follow_u_and_a_mirrored_seam_is_split() {
        let columns = [0.0, 1.0, 2.0];
        let positions: Vec<DVec3> = [0.0, 1.0]
            .iter()
            .flat_map(|&y| columns.map(|x| DVec3::new(x, y, 0.0)))
            .collect();
        let triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
        let mut mesh = Mesh::from_f64("m", &positions, &triangles).expect("in range");
        mesh.normals = vec![Vec3::Z; 6];
        mesh.uvs = vec![
            positions
                .iter()
                .map(|p| Vec2::new(1.0 - (p.x as f32 - 1.0).abs(), 1.0 - p.y as f32))
                .collect(),
        ];
        add_tangents(&mut mesh);
        assert_eq!(mesh.positions.len(), 8, "the two vertices of the seam are doubled");
        for (face, [a, b, c]) in mesh.triangles.iter().enumerate() {
            for &i in [a, b, c] {
                let tangent = mesh.tangents[i as usize];
                let expected = if face < 2 { Vec3::X } else { -Vec3::X };
                assert!(
                    (tangent.truncate() - expected).length() < 1e-6,
                    "face {face}: {tangent}"
                );
                // v points up on both sides: w·(n × t) = +y.
                let bitangent = Vec3::Z.cross(tangent.truncate()) * tangent.w;
                assert!((bitangent - Vec3::Y).length() < 1e-6, "face {face}: {bitangent}");
            }
        }
    }
}
