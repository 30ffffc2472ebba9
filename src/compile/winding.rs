//! Which side of a solid's mesh is its outside.
//!
//! Whether a path is inside of glass is counted by the sides of the faces that it passes, so those must agree. Models
//! often have closed meshes whose faces look inward, or here out and there in: drawn from both sides nobody sees it.
//! They are turned here; everything else about a face (its attributes, its place in the file) stays.

use crate::render::geometry::MeshData;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Faces that are connected by edges between just two of them.
struct Part {
    /// Each face with whether it is wound against the first.
    faces: Vec<(u32, bool)>,
    /// Whether walking around always returns to the same side.
    is_orientable: bool,
    /// Edges of its faces that do not lie between just two.
    open_edges: usize,
    low: Vec3,
    high: Vec3,
}

/// What was found of a mesh's solids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Solids {
    /// Faces that were turned.
    pub turned: usize,
    /// Edges of surfaces that enclose nothing; 0 if all are closed.
    pub open_edges: usize,
}

/// Turns the faces of a mesh for which `is_solid` holds (given their slots), where they close a solid, so that they
/// look outward.
///
/// Faces that are connected look the same way as the greater part of their area. If that is inward by the enclosed
/// volume's sign, all are turned, unless they lie in the box of another such part: then they are the wall of a
/// cavity. Up to one in a hundred edges may be open, since models have small flaws.
pub fn turn_outward(mesh: &mut MeshData, is_solid: impl Fn(u32) -> bool) -> Solids {
    let slot = |face: usize| mesh.face_materials.get(face).copied().unwrap_or(0);
    let faces: Vec<u32> = (0..mesh.triangles.len() as u32)
        .filter(|f| is_solid(slot(*f as usize)))
        .collect();
    let mut parts = parts(mesh, &faces, Weld::Exact);
    let open = |parts: &[Part]| parts.iter().map(|p| p.open_edges).sum::<usize>();
    if open(&parts) > 0 {
        // Seams that were computed twice, as the two ends of a turned shape, differ by roundings.
        let rounded = self::parts(mesh, &faces, Weld::Rounded);
        if open(&rounded) < open(&parts) {
            parts = rounded;
        }
    }
    let (closed, others): (Vec<&Part>, Vec<&Part>) = parts
        .iter()
        .partition(|p| p.is_orientable && p.open_edges * 200 <= p.faces.len() * 3);
    let mut turned = Vec::new();
    for (i, part) in closed.iter().enumerate() {
        let (mut kept, mut against, mut volume) = (0.0, 0.0, 0.0);
        for &(face, is_against) in &part.faces {
            let [a, b, c] = corners(mesh, face);
            let area = (b - a).cross(c - a);
            let sign = if is_against { -1.0 } else { 1.0 };
            *(if is_against { &mut against } else { &mut kept }) += area.length();
            let middle = (part.low + part.high).as_dvec3() * 0.5;
            volume += sign * (a - middle).dot(area);
        }
        // Those of the smaller area turn first.
        let mut turns = against > kept;
        let looks_outward = (volume >= 0.0) != (turns != mesh.flip_winding);
        let holds = |other: &Part| other.low.cmplt(part.low).all() && other.high.cmpgt(part.high).all();
        let is_cavity = closed.iter().enumerate().any(|(j, other)| j != i && holds(other));
        if !looks_outward && !is_cavity {
            turns = !turns;
        }
        turned.extend(part.faces.iter().filter(|f| f.1 != turns).map(|f| f.0));
    }
    for face in &turned {
        mesh.triangles[*face as usize].swap(1, 2);
    }
    Solids {
        turned: turned.len(),
        open_edges: others.iter().map(|p| p.open_edges).sum(),
    }
}

fn corners(mesh: &MeshData, face: u32) -> [DVec3; 3] {
    mesh.triangles[face as usize].map(|v| mesh.positions[v as usize].as_dvec3())
}

/// Which vertices are the same. They are split where normals or coordinates differ: only the place counts.
#[derive(Clone, Copy, PartialEq)]
enum Weld {
    /// Those at the same place to the bit.
    Exact,
    /// Those that are the same in a grid of 2²⁰ steps along the box of the mesh.
    Rounded,
}

/// The connected parts of some faces.
fn parts(mesh: &MeshData, faces: &[u32], how: Weld) -> Vec<Part> {
    let (low, high) = mesh
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
            (low.min(*p), high.max(*p))
        });
    let step = (high.as_dvec3() - low.as_dvec3()).max_element() / f64::from(1 << 20);
    let key = |p: Vec3| match how {
        Weld::Exact => (p + 0.0).to_array().map(f32::to_bits),
        Weld::Rounded => (p.as_dvec3() / step).to_array().map(|v| v.round() as i64 as u32),
    };
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut weld = |p: Vec3| {
        let next = known.len() as u32;
        *known.entry(key(p)).or_insert(next)
    };
    let welded: Vec<[u32; 3]> = faces
        .iter()
        .map(|f| mesh.triangles[*f as usize].map(|v| weld(mesh.positions[v as usize])))
        .collect();
    // Each edge with a place in `faces`, and whether it runs from the higher vertex there.
    let mut edges: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(faces.len() * 3);
    for (i, [a, b, c]) in welded.into_iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.push(([from.min(to), from.max(to)], i as u32, from > to));
        }
    }
    drop(known);
    edges.sort_unstable();
    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; faces.len()];
    for run in edges.chunk_by(|a, b| a.0 == b.0) {
        let [one, two] = run else { continue };
        let agree = one.2 != two.2;
        for (face, other) in [(one.1, two.1), (two.1, one.1)] {
            if let Some(free) = neighbours[face as usize].iter_mut().find(|n| n.is_none()) {
                *free = Some((other, agree));
            }
        }
    }
    drop(edges);
    let mut side: Vec<Option<bool>> = vec![None; faces.len()];
    let mut parts = Vec::new();
    for first in 0..faces.len() {
        if side[first].is_some() {
            continue;
        }
        let mut part = Part {
            faces: Vec::new(),
            is_orientable: true,
            open_edges: 0,
            low: Vec3::INFINITY,
            high: Vec3::NEG_INFINITY,
        };
        side[first] = Some(false);
        let mut work = vec![(first as u32, false)];
        while let Some((at, against)) = work.pop() {
            let face = faces[at as usize];
            part.faces.push((face, against));
            for v in mesh.triangles[face as usize] {
                let p = mesh.positions[v as usize];
                (part.low, part.high) = (part.low.min(p), part.high.max(p));
            }
            for neighbour in neighbours[at as usize] {
                let Some((next, agree)) = neighbour else {
                    part.open_edges += 1;
                    continue;
                };
                let wanted = against == agree;
                match side[next as usize] {
                    Some(known) => part.is_orientable &= known == wanted,
                    None => {
                        side[next as usize] = Some(wanted);
                        work.push((next, wanted));
                    }
                }
            }
        }
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The twelve faces of a cube around a centre, outward.
    fn cube(center: Vec3, half: f32, mesh: &mut MeshData) {
        let first = mesh.positions.len() as u32;
        for i in 0..8 {
            let corner = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
            mesh.positions.push(center + (corner * 2.0 - 1.0) * half);
        }
        for [a, b, c, d] in [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ] {
            mesh.triangles
                .extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|v| v + first)));
        }
    }

    fn turn(mesh: &mut MeshData, faces: std::ops::Range<usize>) {
        mesh.triangles[faces].iter_mut().for_each(|t| t.swap(0, 1));
    }

    /// Six times the enclosed volume.
    fn volume(mesh: &MeshData, faces: std::ops::Range<usize>) -> f64 {
        let of = |f: usize| {
            let [a, b, c] = corners(mesh, f as u32);
            a.dot(b.cross(c))
        };
        faces.map(of).sum::<f64>() * if mesh.flip_winding { -1.0 } else { 1.0 }
    }

    #[test]
    fn inward_and_mixed_solids_are_turned_and_outward_ones_keep_every_bit() {
        let mut outward = MeshData::default();
        cube(Vec3::ONE, 1.0, &mut outward);
        let before = outward.triangles.clone();
        assert_eq!(turn_outward(&mut outward, |_| true), Solids::default());
        assert_eq!(outward.triangles, before);
        for (range, count) in [(0..12, 12), (0..4, 4), (3..12, 9)] {
            let mut mesh = outward.clone();
            turn(&mut mesh, range.clone());
            assert_eq!(turn_outward(&mut mesh, |_| true).turned, count, "{range:?}");
            assert_eq!(volume(&mesh, 0..12), 48.0);
        }
        let mut flipped = outward.clone();
        flipped.flip_winding = true;
        assert_eq!(turn_outward(&mut flipped, |_| true).turned, 12);
        assert_eq!(volume(&flipped, 0..12), 48.0);
    }

    /// The two ends of a turned shape: sin 2π is not 0, and the ring of each pole has as many places as columns.
    #[test]
    fn a_seam_that_misses_by_a_rounding_is_closed() {
        let (columns, rows) = (24u32, 12u32);
        let mut mesh = MeshData::default();
        for j in 0..=rows {
            for i in 0..=columns {
                let turns = |k: u32, n: u32| f64::from(k) / f64::from(n) * std::f64::consts::TAU;
                let ((s, c), (t, d)) = (turns(i, columns).sin_cos(), (turns(j, rows) * 0.5).sin_cos());
                mesh.positions.push(DVec3::new(t * s, d, t * c).as_vec3());
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = j * (columns + 1) + i;
                let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
                mesh.triangles.extend((j > 0).then_some([a, c, b]));
                mesh.triangles.extend((j + 1 < rows).then_some([b, c, d]));
            }
        }
        let all = 0..mesh.triangles.len();
        assert_eq!(turn_outward(&mut mesh, |_| true).turned, 0);
        turn(&mut mesh, all.clone());
        assert_eq!(turn_outward(&mut mesh, |_| true).turned, all.len());
        assert!(volume(&mesh, all) > 0.0);
    }

    #[test]
    fn the_wall_of_a_cavity_looks_into_it() {
        let mut mesh = MeshData::default();
        cube(Vec3::ZERO, 2.0, &mut mesh);
        cube(Vec3::ZERO, 1.0, &mut mesh);
        cube(Vec3::X * 9.0, 1.0, &mut mesh);
        turn(&mut mesh, 12..36);
        assert_eq!(
            turn_outward(&mut mesh, |_| true).turned,
            12,
            "only the one that stands apart"
        );
        assert_eq!([volume(&mesh, 0..12), volume(&mesh, 12..24)], [384.0, -48.0]);
        assert!(volume(&mesh, 24..36) > 0.0);
    }

    #[test]
    fn open_and_one_sided_surfaces_and_other_materials_are_left_alone() {
        let mut mesh = MeshData::default();
        cube(Vec3::ONE, 1.0, &mut mesh);
        turn(&mut mesh, 0..12);
        assert_eq!(turn_outward(&mut mesh.clone(), |_| false).turned, 0);
        mesh.face_materials = vec![0; 12];
        mesh.face_materials[0] = 1;
        assert_eq!(
            turn_outward(&mut mesh.clone(), |slot| slot == 0).turned,
            0,
            "one face is missing"
        );
        mesh.triangles.pop();
        let open = Solids {
            turned: 0,
            open_edges: 3,
        };
        assert_eq!(turn_outward(&mut mesh, |_| true), open);
        // A band of six triangles with a half turn.
        let mut band = MeshData::default();
        let at = |i: u32| {
            let (turn, half) = (
                (i / 2) as f32 * std::f32::consts::TAU / 3.0,
                (i / 2) as f32 * std::f32::consts::PI / 3.0,
            );
            let side = if i % 2 == 0 { -0.3 } else { 0.3 };
            let r = 1.0 + side * half.cos();
            Vec3::new(r * turn.cos(), side * half.sin(), r * turn.sin())
        };
        band.positions = (0..6).map(at).collect();
        band.triangles = vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 5, 1], [5, 0, 1]];
        assert_eq!(turn_outward(&mut band, |_| true).turned, 0);
    }
}
