//! Triangles that stand alone in a scene: those that are seen and moved alike become one mesh.

use crate::math::robust::try_normalize_f64;
use crate::render::motion::Motion;
use crate::scene::Mesh;
use glam::{DAffine3, DVec3, Vec3};

/// Triangles that were written one by one, in world space, where they stand when the shutter opens.
#[derive(Default)]
pub(super) struct Loose {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    materials: Vec<u32>,
    /// How all of them move.
    pub motion: Option<Box<Motion>>,
}

impl Loose {
    /// A triangle placed by `world`, with the normals of its corners if it has any.
    pub fn add(&mut self, world: &DAffine3, vertices: &[DVec3; 3], normals: Option<&[DVec3; 3]>, material: u32) {
        let corners = vertices.map(|v| world.transform_point3(v));
        let [a, b, c] = corners;
        let flat = (b - a).cross(c - a);
        // The world normal is on the side that the shape's own normal is mapped to.
        let turned = world.matrix3.determinant() < 0.0;
        if turned {
            self.positions.extend([a, c, b]);
        } else {
            self.positions.extend([a, b, c]);
        }
        let face = if turned { -flat } else { flat };
        let map = world.matrix3.inverse().transpose();
        let mapped = |n: DVec3| try_normalize_f64(map * n).unwrap_or(face).as_vec3();
        let flat = try_normalize_f64(face).unwrap_or(DVec3::ZERO).as_vec3();
        match normals {
            Some(&[n0, n1, n2]) if turned => self.normals.extend([n0, n2, n1].map(mapped)),
            Some(n) => self.normals.extend(n.map(mapped)),
            None => self.normals.extend([flat; 3]),
        }
        self.materials.push(material);
    }

    /// The mesh and its materials by slot.
    pub fn into_mesh(self) -> (Mesh, Vec<u32>) {
        let mut mesh = Mesh::from_f64("triangles", &self.positions, &[]).unwrap_or_default();
        mesh.normals = self.normals;
        let mut slots: Vec<u32> = self.materials.clone();
        slots.sort();
        slots.dedup();
        for (i, material) in self.materials.iter().enumerate() {
            let slot = slots.binary_search(material).unwrap_or(0) as u32;
            let first = i as u32 * 3;
            mesh.push_face([first, first + 1, first + 2], Some(slot));
        }
        (mesh, slots)
    }
}
