//! Rays and what they hit.

use glam::Vec3;

/// One primitive: an object of the geometry and, inside it, a triangle or face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PrimRef {
    /// Index of the object in the geometry.
    pub object: u32,
    /// Triangle of a mesh; face of an analytic shape (0 if it has only one).
    pub prim: u32,
}

impl PrimRef {
    /// No primitive.
    pub const NONE: PrimRef = PrimRef {
        object: u32::MAX,
        prim: u32::MAX,
    };
}

/// Kinds of rays, as bits of an object's visibility.
pub mod ray_mask {
    /// From the camera.
    pub const CAMERA: u8 = 1;
    /// Towards a light.
    pub const SHADOW: u8 = 2;
    /// From a surface.
    pub const INDIRECT: u8 = 4;
    /// All of them.
    pub const ALL: u8 = 7;
}

/// A half line; hits count for 0 < t < `t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, already offset from the surface it leaves.
    pub origin: Vec3,
    /// Direction; need not be unit, t counts in its length.
    pub dir: Vec3,
    /// Hits at or beyond this are not wanted; may be infinite.
    pub t_max: f32,
    /// The primitive the ray leaves: a flat one cannot be hit again, a sphere only at its other side.
    pub from: PrimRef,
    /// A primitive that does not block (the light a shadow ray goes to).
    pub to: PrimRef,
    /// What kind of ray it is, one bit of [`ray_mask`].
    pub mask: u8,
}

impl Ray {
    /// A ray from free space that sees everything.
    pub fn new(origin: Vec3, dir: Vec3) -> Ray {
        Ray {
            origin,
            dir,
            t_max: f32::INFINITY,
            from: PrimRef::NONE,
            to: PrimRef::NONE,
            mask: ray_mask::ALL,
        }
    }
}

/// The nearest intersection of a ray. Of two at equal t the lower [`PrimRef`] wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// What was hit.
    pub prim: PrimRef,
    /// Barycentric coordinates of v1 and v2 for triangles; unused elsewhere.
    pub b: glam::Vec2,
}
