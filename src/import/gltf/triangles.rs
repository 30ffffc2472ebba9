//! From corners to triangles: lists, strips and fans, and leaving out vertices that nothing uses.

use gltf::json::mesh::Mode;
use std::collections::HashMap;

/// Triangles of a sequence of corners, and how many corners at the end made none. Strips alternate their winding so
/// that every face looks the same way (specification 3.7.2.1).
pub(super) fn assemble(mode: Mode, corners: Vec<u32>) -> (Vec<[u32; 3]>, usize) {
    let n = corners.len();
    match mode {
        Mode::TriangleStrip if n >= 3 => {
            let face = |(i, w): (usize, &[u32])| {
                let odd = i % 2;
                [w[0], w[1 + odd], w[2 - odd]]
            };
            (corners.windows(3).enumerate().map(face).collect(), 0)
        }
        Mode::TriangleFan if n >= 3 => {
            let fan = corners[1..].windows(2).map(|w| [w[0], w[1], corners[0]]);
            (fan.collect(), 0)
        }
        Mode::TriangleStrip | Mode::TriangleFan => (Vec::new(), n),
        _ => (triples(corners), n % 3),
    }
}

/// Three corners each, in the same memory where that is possible.
fn triples(mut corners: Vec<u32>) -> Vec<[u32; 3]> {
    corners.truncate(corners.len() / 3 * 3);
    let cast = bytemuck::allocation::try_cast_vec(corners);
    cast.unwrap_or_else(|(_, corners)| corners.as_chunks::<3>().0.to_vec())
}

/// Renumbers the corners so that only used vertices remain, in their old order, and returns those vertices. A vertex
/// buffer that many primitives share is thus not copied into each.
pub(super) fn compact(triangles: &mut [[u32; 3]], vertices: usize) -> Vec<u32> {
    let corners = triangles.len().saturating_mul(3);
    let mut used: Vec<u32>;
    if corners < vertices / 16 {
        used = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
    } else {
        let mut seen = vec![false; vertices];
        for corner in triangles.iter().flatten() {
            seen[*corner as usize] = true;
        }
        used = (0..vertices as u32).filter(|v| seen[*v as usize]).collect();
    }
    if used.len() == vertices {
        return used;
    }
    let renumbered: HashMap<u32, u32>;
    let dense: Vec<u32>;
    let new: &dyn Fn(u32) -> u32 = if corners < vertices / 16 {
        renumbered = used.iter().enumerate().map(|(new, old)| (*old, new as u32)).collect();
        &|old| renumbered[&old]
    } else {
        let mut table = vec![0; vertices];
        for (new, old) in used.iter().enumerate() {
            table[*old as usize] = new as u32;
        }
        dense = table;
        &|old| dense[old as usize]
    };
    for corner in triangles.iter_mut().flatten() {
        *corner = new(*corner);
    }
    used
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_alternate_and_fans_turn_about_the_first_corner() {
        let strip = assemble(Mode::TriangleStrip, vec![0, 1, 2, 3, 4]);
        assert_eq!(strip, (vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], 0));
        let fan = assemble(Mode::TriangleFan, vec![0, 1, 2, 3]);
        assert_eq!(fan, (vec![[1, 2, 0], [2, 3, 0]], 0));
        let list = assemble(Mode::Triangles, vec![0, 1, 2, 3]);
        assert_eq!(list, (vec![[0, 1, 2]], 1));
    }

    #[test]
    fn compacting_keeps_each_corner_on_its_vertex() {
        for vertices in [9, 1000] {
            let before = [[8u32, 3, 5], [3, 8, 1]];
            let mut after = before;
            let used = compact(&mut after, vertices);
            assert_eq!(used, [1, 3, 5, 8]);
            assert_eq!(after.map(|t| t.map(|c| used[c as usize])), before);
        }
    }
}
