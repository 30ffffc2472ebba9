//! Shading normals: normal maps, and keeping normals visible.

use super::{BumpMap, NormalMap, Shading};
use crate::math::robust::try_normalize;
use glam::{Vec2, Vec3};

#[cfg(test)]
mod tests;

/// The normal map's normal in world space, on the side of `ns`; `None` without a tangent frame, and where the map leans it
/// to no side.
pub(super) fn mapped_normal(map: &NormalMap, cx: &Shading<'_>, ns: Vec3) -> Option<Vec3> {
    let t = cx.textures.eval(map.texture, cx.attrs).truncate() * 2.0 - Vec3::ONE;
    let lean = Vec2::new(t.x, t.y) * map.scale;
    if lean == Vec2::ZERO {
        return None; // the very normal, to the bit
    }
    let tangent = try_normalize(cx.attrs.tangent - ns * ns.dot(cx.attrs.tangent))?;
    let bitangent = ns.cross(tangent);
    let bitangent = if bitangent.dot(cx.attrs.bitangent) < 0.0 {
        -bitangent
    } else {
        bitangent
    };
    let n = try_normalize(tangent * lean.x + bitangent * lean.y + ns * t.z)?;
    (n.dot(ns) > 0.0).then_some(n)
}

/// The normal of the surface raised by the map's heights along `ns`; `None` without slopes or a tangent frame. Where the
/// map is flat it is `ns` to the bit.
///
/// It is n − ∇h, normalised: ∇h is the tangent vector whose products with the directions of the image's rows and columns
/// are the slopes along them, whatever angle these make. Source: Mikkelsen, Bump Mapping Unparametrized Surfaces on the
/// GPU, 2010, eq. 5.
pub(super) fn bumped_normal(map: &BumpMap, cx: &Shading<'_>, ns: Vec3) -> Option<Vec3> {
    let slope = cx.textures.slope(map.texture, cx.attrs)?;
    let (right, up) = (slope.right * map.scale, slope.up * map.scale);
    if right == 0.0 && up == 0.0 {
        return Some(ns);
    }
    let along = |v: Vec3| try_normalize(v - ns * ns.dot(v));
    let (u, v) = (along(slope.to_right)?, along(slope.to_top)?);
    let gradient = (v.cross(ns) * right + ns.cross(u) * up) / ns.dot(u.cross(v));
    let n = try_normalize(ns - gradient)?;
    (n.dot(ns) > 0.0).then_some(n)
}

/// The unit normal nearest to `n` in the plane of `ng` and the mirror direction such that `wo` (ng·wo ≥ 0) is mirrored
/// to the upper side of the surface. Black rims come from normals that mirror the view into the surface.
///
/// The mirror direction is lifted to a small height above the tangent plane, lower for grazing views, and the half vector
/// between it and `wo` is the new normal. Source: Keller et al., The Iray Light Transport Simulation, 2017, §A.3.
pub(super) fn visible_normal(ng: Vec3, n: Vec3, wo: Vec3) -> Vec3 {
    let cos_g = ng.dot(wo);
    let height = (0.9 * cos_g).min(0.01);
    let cos = n.dot(wo);
    let mirror = n * (2.0 * cos) - wo;
    let mirror_height = mirror.dot(ng);
    if cos > 0.0 && mirror_height >= height {
        return n;
    }
    // A normal that faces away has no mirror direction of its own: the limit as it turns away is −wo.
    let along = if cos > 0.0 { mirror } else { -wo };
    match try_normalize(along - ng * along.dot(ng)) {
        Some(side) => {
            let lifted = side * (1.0 - height * height).max(0.0).sqrt() + ng * height;
            // Opposite directions at extreme grazing leave a half vector without digits: `ng` serves as well there.
            let half = try_normalize(lifted + wo).unwrap_or(ng);
            let cos = half.dot(wo);
            let is_visible = cos > 0.0 && half.dot(ng) > 0.0 && (half * (2.0 * cos) - wo).dot(ng) >= 0.0;
            if is_visible { half } else { ng }
        }
        None => ng,
    }
}
