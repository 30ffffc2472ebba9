//! Tangents for normal maps whose model brings none: MikkTSpace, as the specification asks.
//!
//! The generator takes some microseconds a triangle, so large meshes are cut into chunks that run in parallel. A
//! vertex's tangent depends on the faces around it alone; each chunk therefore also sees the faces that touch it, and
//! the cut changes nothing.

use super::part::Part;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{DAffine2, DVec2, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Faces of a chunk: fixed, so that the result does not depend on the machine.
const CHUNK: usize = 1 << 15;

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
    let uvs: Vec<Vec2> = part.uvs[uv_set].iter().map(mapped).collect();
    let tangents = corner_tangents(part, &uvs, CHUNK);
    split(part, &tangents);
}

/// The tangents of all corners of all faces.
fn corner_tangents(part: &Part, uvs: &[Vec2], chunk: usize) -> Vec<[Vec4; 3]> {
    let faces = part.triangles.len();
    if faces <= chunk {
        return run(part, uvs, 0..faces, &[]);
    }
    let surroundings = Surroundings::new(part, uvs);
    let ranges: Vec<Range<usize>> = (0..faces).step_by(chunk).map(|f| f..(f + chunk).min(faces)).collect();
    let halos: Vec<Vec<u32>> = ranges.par_iter().map(|r| surroundings.halo(part, r)).collect();
    // Where nearly all faces touch each other (a huge fan) cutting would only multiply the work.
    if halos.iter().map(Vec::len).sum::<usize>() > 2 * faces {
        return run(part, uvs, 0..faces, &[]);
    }
    let jobs = ranges.into_par_iter().zip(halos);
    jobs.flat_map_iter(|(range, halo)| run(part, uvs, range, &halo))
        .collect()
}

/// Runs the generator on a range of faces and the sorted further faces around it; the tangents of the range.
fn run(part: &Part, uvs: &[Vec2], range: Range<usize>, halo: &[u32]) -> Vec<[Vec4; 3]> {
    let before = halo.partition_point(|f| (*f as usize) < range.start);
    let own = range.start as u32..range.end as u32;
    let faces: Vec<u32> = halo[..before]
        .iter()
        .copied()
        .chain(own)
        .chain(halo[before..].iter().copied())
        .collect();
    let fallback = |f: &u32| part.triangles[*f as usize].map(|v| any_tangent(part.normals[v as usize]));
    let mut corners = Corners {
        part,
        uvs,
        tangents: faces.iter().map(fallback).collect(),
        faces,
    };
    // The error has no variants; should it ever get one, the fallback stays.
    let _: Result<(), _> = generate_tangents(&mut corners);
    corners.tangents.drain(before..before + range.len()).collect()
}

/// Faces as the generator wants them, one corner at a time.
struct Corners<'a> {
    part: &'a Part,
    uvs: &'a [Vec2],
    faces: Vec<u32>,
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.part.triangles[self.faces[face] as usize][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.faces.len()
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

/// Which faces meet at each vertex, vertices of equal position, normal and texture coordinate being one.
struct Surroundings {
    welded: Vec<u32>,
    /// Faces of welded vertex i are `faces[first[i]..first[i + 1]]`.
    first: Vec<usize>,
    faces: Vec<u32>,
}

impl Surroundings {
    fn new(part: &Part, uvs: &[Vec2]) -> Surroundings {
        let welded = weld(part, uvs);
        let mut first = vec![0usize; welded.len() + 1];
        let corners = || part.triangles.iter().flatten().map(|v| welded[*v as usize] as usize);
        corners().for_each(|w| first[w + 1] += 1);
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let mut faces = vec![0; part.triangles.len() * 3];
        for (corner, w) in corners().enumerate() {
            faces[next[w]] = (corner / 3) as u32;
            next[w] += 1;
        }
        Surroundings { welded, first, faces }
    }

    /// The faces outside a range that share a vertex with it, sorted.
    fn halo(&self, part: &Part, range: &Range<usize>) -> Vec<u32> {
        let mut vertices: Vec<u32> = part.triangles[range.clone()].iter().flatten().copied().collect();
        vertices.iter_mut().for_each(|v| *v = self.welded[*v as usize]);
        vertices.sort_unstable();
        vertices.dedup();
        let around = |v: &u32| &self.faces[self.first[*v as usize]..self.first[*v as usize + 1]];
        let mut halo: Vec<u32> = vertices.iter().flat_map(around).copied().collect();
        halo.retain(|f| !range.contains(&(*f as usize)));
        halo.sort_unstable();
        halo.dedup();
        halo
    }
}

/// For each vertex the lowest one of equal position, normal and texture coordinate.
fn weld(part: &Part, uvs: &[Vec2]) -> Vec<u32> {
    let key = |i: u32| {
        let i = i as usize;
        let (p, n, uv) = (part.positions[i].as_vec3(), part.normals[i], uvs[i]);
        // The generator compares by value: −0 is 0.
        [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(|v| (v + 0.0).to_bits())
    };
    let hash = |key: [u32; 8]| {
        let mix = |h: u64, v: u32| (h ^ u64::from(v)).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
        key.into_iter().fold(0, mix)
    };
    let count = part.positions.len() as u32;
    let mut order: Vec<(u64, u32)> = (0..count).into_par_iter().map(|i| (hash(key(i)), i)).collect();
    order.par_sort_unstable();
    let mut welded: Vec<u32> = (0..count).collect();
    for run in order.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        run.sort_unstable_by_key(|(_, i)| (key(*i), *i));
        for same in run.chunk_by(|a, b| key(a.1) == key(b.1)) {
            same.iter().for_each(|(_, i)| welded[*i as usize] = same[0].1);
        }
    }
    welded
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
    if !added.is_empty() {
        part.gather(&order);
    }
    let own = own
        .into_iter()
        .zip(&part.normals)
        .map(|(t, n)| t.unwrap_or_else(|| any_tangent(*n)));
    part.tangents = own.chain(added).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A bumpy sheet of n × n squares with a seam: beyond the middle u runs backwards.
    fn sheet(n: u32) -> Part {
        let mut part = Part {
            uvs: vec![Vec::new()],
            ..Part::default()
        };
        for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            part.positions
                .push(DVec3::new(x, (7.0 * x).sin() * (5.0 * y).cos() * 0.2, y));
            part.normals.push(Vec3::new(x as f32 - 0.5, 2.0, 0.3).normalize());
            part.uvs[0].push(Vec2::new((x - 0.5).abs() as f32 + 0.1 * y as f32, y as f32));
        }
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let a = i * (n + 1) + j;
            part.triangles.push([a, a + 1, a + n + 1]);
            part.triangles.push([a + 1, a + n + 2, a + n + 1]);
        }
        part
    }

    #[test]
    fn cutting_a_mesh_into_chunks_changes_no_bit() {
        let part = sheet(24);
        let uvs = part.uvs[0].clone();
        let whole = corner_tangents(&part, &uvs, usize::MAX);
        assert!(whole.iter().flatten().any(|t| t.w < 0.0) && whole.iter().flatten().any(|t| t.w > 0.0));
        for chunk in [100, 333, 1151] {
            assert_eq!(corner_tangents(&part, &uvs, chunk), whole, "{chunk}");
        }
    }

    #[test]
    fn tangents_follow_the_direction_in_which_u_grows() {
        let mut part = sheet(8);
        let before = part.positions.len();
        generate(&mut part, 0, DAffine2::IDENTITY);
        assert!(part.positions.len() > before, "the seam is split");
        for (i, face) in part.triangles.iter().enumerate() {
            let along = if i < part.triangles.len() / 2 { -1.0 } else { 1.0 };
            let t = part.tangents[face[0] as usize];
            assert!(t.x * along > 0.5, "{i}: {t}");
            assert!(t.truncate().dot(part.normals[face[0] as usize]).abs() < 1e-5);
        }
    }
}
