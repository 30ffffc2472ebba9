//! How objects stand in the tree: what rays meet of them, and the box around it.

use super::{SceneTree, Target};
use crate::render::accel::bounds::Bounds;
use crate::render::accel::mesh::MeshTree;
use crate::render::accel::moving::MovingTarget;
use crate::render::motion::Motion;
use crate::render::shape::Shape;
use glam::{DAffine3, DVec3};

impl SceneTree {
    /// What rays meet of an object.
    pub(super) fn target(&self, shape: &Shape, motion: Option<&Motion>) -> Target {
        let bends = |mesh: &u32| self.meshes.get(*mesh as usize).is_some_and(MeshTree::bends);
        if let (None, Shape::Mesh { mesh, .. }) = (motion, shape)
            && bends(mesh)
        {
            return self.target(shape, Some(&Motion::still())); // only what moves asks for the time
        }
        if let Some(motion) = motion {
            let still = self.still_target(shape);
            return Target::Moving(Box::new(MovingTarget::new(still, motion.clone())));
        }
        self.still_target(shape)
    }

    fn still_target(&self, shape: &Shape) -> Target {
        match shape {
            Shape::Sphere { center, radius } => Target::Sphere {
                center: *center,
                radius_squared: radius * radius,
            },
            Shape::Plane { normal, distance } => Target::Plane {
                normal: *normal,
                distance: *distance,
            },
            Shape::Placed(placed) => Target::Placed(placed.clone()),
            Shape::Mesh { mesh, placement } => {
                let unit = self.meshes.get(*mesh as usize).map_or(1.0, |m| m.unit);
                let map = placement.mesh_from_world;
                Target::Mesh {
                    mesh: *mesh,
                    tree_from_world: Box::new(DAffine3 {
                        matrix3: map.matrix3 * (1.0 / unit),
                        translation: map.translation / unit,
                    }),
                }
            }
        }
    }

    /// World box of a shape over the whole time of its motion, rounded outward; empty for planes.
    pub fn bounds_of(&self, shape: &Shape, motion: Option<&Motion>) -> Bounds {
        match motion {
            None => self.still_bounds(shape),
            // Each point moves on a straight line between two keys, so that the box around both places holds the way.
            Some(motion) => {
                let parts = motion.keys().iter().map(|key| self.bounds_under(key, shape));
                parts.fold(Bounds::EMPTY, Bounds::union)
            }
        }
    }

    fn still_bounds(&self, shape: &Shape) -> Bounds {
        match shape {
            Shape::Sphere { center, radius } => {
                let r = DVec3::splat(*radius);
                Bounds::from_f64(*center - r, *center + r, (center.abs() + r) * (4.0 * f64::EPSILON))
            }
            Shape::Plane { .. } => Bounds::EMPTY,
            Shape::Placed(p) => Bounds::transformed(&p.world_from_object, p.kind.center(), p.kind.half_extent()),
            Shape::Mesh { mesh, placement } => self.mesh_bounds(*mesh, &placement.world_from_mesh),
        }
    }

    fn mesh_bounds(&self, mesh: u32, world_from_mesh: &DAffine3) -> Bounds {
        let Some(mesh) = self.meshes.get(mesh as usize) else {
            return Bounds::EMPTY;
        };
        let parts = mesh.coarse_bounds().map(|b| {
            let (min, max) = (b.min.as_dvec3() * mesh.unit, b.max.as_dvec3() * mesh.unit);
            Bounds::transformed(world_from_mesh, (min + max) * 0.5, (max - min) * 0.5)
        });
        parts.fold(Bounds::EMPTY, Bounds::union)
    }

    /// World box of a shape moved by a map.
    fn bounds_under(&self, key: &DAffine3, shape: &Shape) -> Bounds {
        match shape {
            Shape::Sphere { center, radius } => Bounds::transformed(key, *center, DVec3::splat(*radius)),
            Shape::Plane { .. } => Bounds::EMPTY,
            Shape::Placed(p) => {
                Bounds::transformed(&(*key * p.world_from_object), p.kind.center(), p.kind.half_extent())
            }
            Shape::Mesh { mesh, placement } => self.mesh_bounds(*mesh, &(*key * placement.world_from_mesh)),
        }
    }
}
