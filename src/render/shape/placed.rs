//! Affine placement of solids and meshes, and the error it adds to a point.

use super::candidates::Candidates;
use super::{Line, Solid};
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// 2⁻⁵³, the unit roundoff of f64.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// A solid under an affine map.
#[derive(Clone, Debug)]
pub struct Placed {
    /// From the solid's space to the world's.
    pub world_from_object: DAffine3,
    /// Its inverse.
    pub object_from_world: DAffine3,
    /// What is placed.
    pub kind: Solid,
}

impl Placed {
    /// Places a solid; the map must be invertible.
    pub fn new(kind: Solid, world_from_object: DAffine3) -> Placed {
        Placed {
            world_from_object,
            object_from_world: world_from_object.inverse(),
            kind,
        }
    }

    /// Offers the intersections with a world-space line.
    pub fn intersect(&self, o: DVec3, d: DVec3, found: &mut Candidates) {
        let mut line = Line {
            o: self.object_from_world.transform_point3(o),
            d: self.object_from_world.transform_vector3(d),
        };
        if matches!(self.kind, Solid::Sphere | Solid::Box { .. }) {
            return self.kind.intersect(line, 0.0, found); // their own forms do not mind the distance
        }
        // Far away the squares of the distance would swallow the solid: start at the foot of the perpendicular.
        let center = self.kind.center();
        let reach = self.kind.half_extent().length();
        let to_center = line.o - center;
        let mut shift = 0.0;
        if to_center.length_squared() > 4.0 * reach * reach {
            shift = -to_center.dot(line.d) / line.d.length_squared();
            line.o += line.d * shift;
            // The margin is far above rounding; lines that pass outside of it are not worth a closer look.
            if shift < 0.0 || (line.o - center).length() > reach * 1.000_001 {
                return;
            }
        }
        self.kind.intersect(line, shift, found);
    }

    /// The surface point of a face near `p`, the error per axis of the point rounded to f32, and the outward unit normal.
    pub fn surface(&self, face: u32, p: DVec3) -> (DVec3, Vec3, DVec3) {
        let local = self.object_from_world.transform_point3(p);
        let (local, n) = self.kind.project(face, local);
        let world = self.world_from_object.transform_point3(local);
        let forward = abs(self.world_from_object.matrix3);
        let back = abs(self.object_from_world.matrix3);
        // The rounding of the map to the solid's space and back, and of the solid's own arithmetic.
        let reach = self.kind.half_extent() + self.kind.center().abs();
        let own = back * world.abs() + self.object_from_world.translation.abs() + DVec3::splat(reach.max_element());
        let error = (forward * own + self.world_from_object.translation.abs()) * (64.0 * ROUNDOFF);
        let n = unit_normal(&self.object_from_world, n);
        (world, error_after_rounding(world.as_vec3(), error), n)
    }
}

/// Where a mesh stands.
#[derive(Clone, Debug)]
pub struct MeshPlacement {
    /// From the mesh's space to the world's.
    pub world_from_mesh: DAffine3,
    /// Its inverse.
    pub mesh_from_world: DAffine3,
}

impl MeshPlacement {
    /// Places a mesh; the map must be invertible.
    pub fn new(world_from_mesh: DAffine3) -> MeshPlacement {
        MeshPlacement {
            world_from_mesh,
            mesh_from_world: world_from_mesh.inverse(),
        }
    }
}

/// Component-wise absolute value.
pub fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// A normal carried to the world by the inverse transpose, of unit length. It stays on the outside under mirrors too:
/// a normal is a covector, n·(p − q) keeps its sign.
pub fn unit_normal(object_from_world: &DAffine3, n: DVec3) -> DVec3 {
    let world = object_from_world.matrix3.transpose() * n;
    crate::math::robust::try_normalize_f64(world).unwrap_or(DVec3::Y)
}

/// Adds to an f64 error the rounding of the point itself to f32, and rounds up.
#[inline(always)]
pub fn error_after_rounding(p: Vec3, error: DVec3) -> Vec3 {
    let u = f64::from(crate::math::robust::UNIT_ROUNDOFF);
    let total = p.as_dvec3().abs() * u + error;
    // A relative step of two units in the last place and the smallest number: upwards without a branch.
    let up = |x: f64| (x as f32) * (1.0 + 2.0 * f32::EPSILON) + f32::MIN_POSITIVE;
    Vec3::new(up(total.x), up(total.y), up(total.z))
}
