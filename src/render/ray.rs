//! Rays and what they hit.

use glam::{DVec3, Vec3};

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
    /// What the direction lost by rounding: aimed at something far away, `dir` alone misses it by u times the distance.
    pub dir_low: Vec3,
    /// Hits at or beyond this are not wanted; may be infinite.
    pub t_max: f32,
    /// The primitive the ray leaves: a flat one cannot be hit again, a sphere only at its other side.
    pub from: PrimRef,
    /// A primitive that does not block (the light a shadow ray goes to).
    pub to: PrimRef,
    /// What kind of ray it is, one bit of [`ray_mask`].
    pub mask: u8,
    /// When it is sent, in [0, 1) of the time that the shutter is open; 0 where nothing moves. All rays of a path have
    /// the same.
    pub time: f32,
}

impl Ray {
    /// A ray from free space that sees everything.
    pub fn new(origin: Vec3, dir: Vec3) -> Ray {
        Ray {
            origin,
            dir,
            dir_low: Vec3::ZERO,
            t_max: f32::INFINITY,
            from: PrimRef::NONE,
            to: PrimRef::NONE,
            mask: ray_mask::ALL,
            time: 0.0,
        }
    }

    /// The direction with all that is known of it.
    #[inline(always)]
    pub fn direction(&self) -> DVec3 {
        self.dir.as_dvec3() + self.dir_low.as_dvec3()
    }

    /// The point at t.
    #[inline(always)]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin.as_dvec3() + self.direction() * t
    }
}

/// A direction as it is stored: rounded to f32, and what that lost.
#[inline(always)]
pub fn split_direction(w: DVec3) -> (Vec3, Vec3) {
    let dir = w.as_vec3();
    (dir, (w - dir.as_dvec3()).as_vec3())
}

/// The nearest intersection of a ray. Of two at equal t (to 40 bits) the lower [`PrimRef`] wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// The same before it was rounded to f32.
    pub exact: f64,
    /// What was hit.
    pub prim: PrimRef,
    /// Barycentric coordinates of v1 and v2 for triangles; unused elsewhere.
    pub b: glam::Vec2,
}
