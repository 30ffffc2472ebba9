//! A shape somewhere else: where one that moves is at a time.

use crate::math::robust::try_normalize_f64;
use crate::render::shape::{MeshPlacement, Placed, Shape, Solid};
use glam::{DAffine3, DQuat, DVec3};

/// A shape under an affine map. Spheres may have become ellipsoids.
pub(super) enum MovedShape {
    /// As [`Shape::Plane`].
    Plane {
        /// Unit normal.
        normal: DVec3,
        /// Signed distance from the origin.
        distance: f64,
    },
    /// As [`Shape::Placed`].
    Placed(Placed),
    /// As [`Shape::Mesh`].
    Mesh {
        /// Index of the mesh.
        mesh: u32,
        /// Where it is.
        placement: MeshPlacement,
    },
}

/// The shape moved by an invertible map.
pub(super) fn moved_shape(shape: &Shape, map: &DAffine3) -> MovedShape {
    match shape {
        Shape::Sphere { center, radius } => {
            let unit = DAffine3::from_scale_rotation_translation(DVec3::splat(*radius), DQuat::IDENTITY, *center);
            MovedShape::Placed(Placed::new(Solid::Sphere, *map * unit))
        }
        Shape::Plane { normal, distance } => {
            let n = try_normalize_f64(map.matrix3.inverse().transpose() * *normal).unwrap_or(*normal);
            MovedShape::Plane {
                normal: n,
                distance: n.dot(map.transform_point3(*normal * *distance)),
            }
        }
        Shape::Placed(placed) => MovedShape::Placed(Placed::new(placed.kind.clone(), *map * placed.world_from_object)),
        Shape::Mesh { mesh, placement } => MovedShape::Mesh {
            mesh: *mesh,
            placement: MeshPlacement::new(*map * placement.world_from_mesh),
        },
    }
}
