//! Shading frames: the normal that relief leaves, that of a coat over it, and the direction of anisotropy.

use super::normal::{bumped_normal, mapped_normal, visible_normal};
use super::{BumpMap, Material, PrincipledInputs, Shading, SurfaceModel};
use crate::math::frame::Frame;
use crate::math::portable::sin_cos_turns;
use glam::{Vec2, Vec3};

impl Material {
    /// The shading frame at a point: its z axis is the shading normal on the side of `ng`, its x axis the direction of
    /// anisotropy if there is one.
    ///
    /// `ng` and `ns` are the surface's geometric and interpolated normals, on one side; `wo` points to the viewer, on
    /// either side. The normal is bent such that `wo` and its mirror direction lie on the viewer's side of the surface.
    ///
    /// Of a coated surface it is the coat's frame, see [`Material::lean_of_base`].
    pub fn shading_frame(&self, cx: &Shading<'_>, ng: Vec3, ns: Vec3, wo: Vec3) -> Frame {
        let n = match self.coat_apart(cx) {
            Some(p) => {
                let map = p.clearcoat_normal.as_ref();
                kept_visible(ng, map.and_then(|map| mapped_normal(map, cx, ns)).unwrap_or(ns), wo)
            }
            None => self.normal(cx, ng, ns, wo),
        };
        match &self.surface {
            SurfaceModel::Principled(p) if !p.anisotropy.is_nothing() && p.anisotropy.unit(cx) > 0.0 => {
                anisotropic_frame(p, cx, n)
            }
            _ => Frame::from_normal(n),
        }
    }

    /// x and y, in the frame of [`Material::shading_frame`], of the normal of what lies below a coat that has another one;
    /// zero where the two are one.
    pub fn lean_of_base(&self, cx: &Shading<'_>, frame: &Frame, ng: Vec3, ns: Vec3, wo: Vec3) -> Vec2 {
        if self.coat_apart(cx).is_none() {
            return Vec2::ZERO;
        }
        let n = self.normal(cx, ng, ns, wo);
        let local = frame.to_local(n);
        if n == frame.n || local.z <= 0.0 {
            return Vec2::ZERO;
        }
        local.truncate()
    }

    /// The inputs of a surface whose coat has, at this point, a normal of its own.
    fn coat_apart(&self, cx: &Shading<'_>) -> Option<&PrincipledInputs> {
        match &self.surface {
            SurfaceModel::Principled(p) if p.coat_apart && p.clearcoat.unit(cx) > 0.0 => Some(p),
            _ => None,
        }
    }

    /// The shading normal of all but the coat.
    fn normal(&self, cx: &Shading<'_>, ng: Vec3, ns: Vec3, wo: Vec3) -> Vec3 {
        let mut n = ns;
        if let Some(map) = &self.normal_map {
            n = mapped_normal(map, cx, ns).unwrap_or(ns);
        }
        if let Some(map) = &self.bump_map {
            // Which side of a sheet is its front is often chance, so it is raised towards the viewer, as in POV-Ray;
            // a solid has one shape, from inside too.
            let is_behind = ng.dot(wo) < 0.0 && !self.interior;
            let scale = if is_behind { -map.scale } else { map.scale };
            n = bumped_normal(&BumpMap { scale, ..*map }, cx, n).unwrap_or(n);
        }
        kept_visible(ng, n, wo)
    }
}

/// The normal bent such that `wo` and its mirror direction lie on one side of the surface; `ng` itself as it is.
fn kept_visible(ng: Vec3, n: Vec3, wo: Vec3) -> Vec3 {
    if n == ng {
        n
    } else if ng.dot(wo) < 0.0 {
        -visible_normal(-ng, -n, wo)
    } else {
        visible_normal(ng, n, wo)
    }
}

/// The frame about `n` whose x axis is the direction of more roughness: the texture's, in terms of tangent and bitangent,
/// turned by the rotation.
fn anisotropic_frame(p: &PrincipledInputs, cx: &Shading<'_>, n: Vec3) -> Frame {
    let frame = Frame::from_normal_and_tangent(n, cx.attrs.tangent);
    let turns = p.anisotropy_rotation / std::f32::consts::TAU;
    let (s, c) = sin_cos_turns(turns - turns.floor());
    let bitangent = if frame.b.dot(cx.attrs.bitangent) < 0.0 {
        -frame.b
    } else {
        frame.b
    };
    let mut along = Vec2::new(c, s);
    if let Some(texture) = p.anisotropy_direction {
        let t = cx.textures.eval(texture, cx.attrs).truncate().truncate() * 2.0 - Vec2::ONE;
        if t != Vec2::ZERO {
            along = along.rotate(t);
        }
    }
    Frame::from_normal_and_tangent(n, frame.t * along.x + bitangent * along.y)
}
