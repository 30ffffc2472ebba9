//! Shading normals from smoothing groups, for faces that bring none.

use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Sums of face normals, weighted by the angle at the corner, for each vertex and smoothing group.
#[derive(Debug, Default)]
pub(super) struct SmoothNormals {
    sums: HashMap<(u32, u32), DVec3>,
}

impl SmoothNormals {
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
                *self.sums.entry((*vertex, group)).or_default() += normal * angle;
            }
        }
    }

    /// The unit normal of a vertex in a group; `None` where the faces cancel out.
    pub fn get(&self, vertex: u32, group: u32) -> Option<Vec3> {
        let sum = self.sums.get(&(vertex, group))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// At a cube's corner three faces meet with equal angles, whichever way their quads are cut.
    #[test]
    fn a_cube_corner_points_along_its_diagonal() {
        let (o, x, y, z) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
        let mut normals = SmoothNormals::default();
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
