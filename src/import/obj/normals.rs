//! Shading normals from smoothing groups, for faces that bring none.

use glam::{DVec3, Vec3};

/// Sums of face normals, weighted by the angle at the corner, for each vertex and smoothing group.
#[derive(Debug)]
pub(super) struct SmoothNormals {
    /// For each vertex its few groups with their sums, as one chain through `sums`.
    sums: Chains<u32, DVec3>,
}

impl SmoothNormals {
    /// No faces yet; all vertices will be from `base` on.
    pub fn from_vertex(base: u32) -> SmoothNormals {
        SmoothNormals {
            sums: Chains::from_vertex(base),
        }
    }

    /// Adds a face: its corners' vertex numbers and positions, in order. Angles make the result independent of how
    /// polygons were cut into triangles.
    pub fn add_face(&mut self, group: u32, corners: &[(u32, DVec3)]) {
        let Some(normal) = face_normal(corners.iter().map(|c| c.1)) else {
            return;
        };
        for i in 0..corners.len() {
            let at = |k: usize| corners.get((i + k) % corners.len()).map_or(DVec3::ZERO, |c| c.1);
            let (before, here, after) = (at(corners.len() - 1), at(0), at(1));
            let angle = (before - here).angle_between(after - here);
            let Some((vertex, _)) = corners.get(i) else { continue };
            if angle.is_finite() {
                *self.sums.entry(*vertex, group, || DVec3::ZERO) += normal * angle;
            }
        }
    }

    /// The unit normal of a vertex in a group; `None` where the faces cancel out.
    pub fn get(&self, vertex: u32, group: u32) -> Option<Vec3> {
        let sum = self.sums.get(vertex, group)?;
        sum.try_normalize().map(|n| n.as_vec3())
    }
}

/// Newell's unit normal of a polygon; `None` without area.
pub(super) fn face_normal(corners: impl Iterator<Item = DVec3> + Clone) -> Option<DVec3> {
    let origin = corners.clone().next()?;
    let next = corners.clone().cycle().skip(1);
    let sum = corners
        .zip(next)
        .fold(DVec3::ZERO, |sum, (a, b)| sum + (a - origin).cross(b - origin));
    sum.try_normalize()
}

/// A map from (vertex number, key) for the case that a vertex has few keys: a list per vertex in one array.
/// On models of a million faces this takes a fifth of the time of a hash map.
#[derive(Debug)]
pub(super) struct Chains<K, V> {
    /// The lowest vertex number that occurs: an object of many uses a narrow range of the model's vertices.
    base: u32,
    /// By vertex from `base` on: one more than the position of its first link, 0 for none.
    first: Vec<u32>,
    links: Vec<(K, V, u32)>,
}

impl<K, V> Chains<K, V> {
    /// An empty map for vertices from `base` on.
    pub fn from_vertex(base: u32) -> Self {
        Chains {
            base,
            first: Vec::new(),
            links: Vec::new(),
        }
    }
}

impl<K: PartialEq + Copy, V> Chains<K, V> {
    fn find(&self, vertex: u32, key: K) -> Option<usize> {
        let index = vertex.checked_sub(self.base)?;
        let mut at = self.first.get(index as usize).copied().unwrap_or(0);
        while let Some((known, _, next)) = self.links.get((at as usize).wrapping_sub(1)) {
            if *known == key {
                return Some(at as usize - 1);
            }
            at = *next;
        }
        None
    }

    /// The value of a vertex under a key.
    pub fn get(&self, vertex: u32, key: K) -> Option<&V> {
        self.find(vertex, key)
            .and_then(|at| self.links.get(at))
            .map(|link| &link.1)
    }

    /// The value of a vertex under a key, first made by `new` where there is none.
    pub fn entry(&mut self, vertex: u32, key: K, new: impl FnOnce() -> V) -> &mut V {
        let at = self.find(vertex, key).unwrap_or_else(|| {
            let vertex = vertex.saturating_sub(self.base) as usize;
            if self.first.len() <= vertex {
                self.first.resize(vertex + 1, 0);
            }
            self.links.push((key, new(), self.first[vertex]));
            self.first[vertex] = self.links.len() as u32;
            self.links.len() - 1
        });
        &mut self.links[at].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a cube's corner three faces meet with equal angles, whichever way their quads are cut.
    #[test]
    fn a_cube_corner_points_along_its_diagonal() {
        let (o, x, y, z) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
        let mut normals = SmoothNormals::from_vertex(0);
        normals.add_face(1, &[(0, o), (2, y), (3, x + y), (1, x)]);
        normals.add_face(1, &[(0, o), (4, z), (6, y + z)]);
        normals.add_face(1, &[(0, o), (6, y + z), (2, y)]);
        normals.add_face(1, &[(0, o), (1, x), (5, x + z), (4, z)]);
        let expected = Vec3::splat(-1.0).normalize();
        let found = normals.get(0, 1).expect("three faces");
        assert!((found - expected).length() < 1e-6, "{found}");
        assert_eq!(normals.get(0, 2), None);
    }
}
