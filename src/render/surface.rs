//! A point on a surface, as shading needs it.

use super::ray::PrimRef;
use glam::{DVec3, Vec2, Vec3, Vec4};

/// What every hit needs. Camera-relative world space.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The point, put back onto the surface.
    pub p: Vec3,
    /// Bound on |p − exact point| per axis.
    pub p_error: Vec3,
    /// What `p` lost by rounding: `p + p_low` is the point as far as it is known.
    pub p_low: Vec3,
    /// Unit geometric normal, to the outside of solids, never turned towards the ray.
    pub ng: Vec3,
    /// Unit shading normal (interpolated), on the same side as `ng`.
    pub ns: Vec3,
    /// What was hit.
    pub prim: PrimRef,
    /// Index of the material.
    pub material: u32,
    /// Index of the light this primitive is, or [`Surface::NOT_A_LIGHT`].
    pub light: u32,
}

impl Surface {
    /// Value of `light` where the primitive emits nothing.
    pub const NOT_A_LIGHT: u32 = u32::MAX;

    /// The point before it was rounded.
    pub fn exact(&self) -> DVec3 {
        self.p.as_dvec3() + self.p_low.as_dvec3()
    }
}

/// What only textured materials need; computed on demand.
#[derive(Clone, Copy, Debug)]
pub struct Attributes {
    /// Texture coordinates by set; sets the mesh lacks repeat set 0, (0, 0) without any.
    pub uv: [Vec2; 4],
    /// Linear RGBA vertex colour, white without any.
    pub color: Vec4,
    /// World direction of the tangent (towards growing u), not normalised; zero if there is none.
    pub tangent: Vec3,
    /// World direction of the bitangent (towards the top of the texture), not normalised; zero if there is none.
    pub bitangent: Vec3,
}

impl Default for Attributes {
    fn default() -> Attributes {
        Attributes {
            uv: [Vec2::ZERO; 4],
            color: Vec4::ONE,
            tangent: Vec3::ZERO,
            bitangent: Vec3::ZERO,
        }
    }
}
