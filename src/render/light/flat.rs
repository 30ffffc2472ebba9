//! What flat lights share: the density of points and of directions on them.

use super::{Receiver, shadow_end, usable_pdf};
use crate::math::robust::gamma;
use glam::{DVec3, Vec2, Vec3};

/// Polygons are sampled by solid angle where their area is more than this part of the squared distance of their
/// centre. Below, the density of area sampling varies too little for the dearer method to pay.
const NEAR: f64 = 0.1;

/// Receivers nearer to its plane than this part of the distance of a polygon see it from the edge: arcs between all but
/// opposite corners leave no digits of directions uniform in solid angle, in f64 either (1e-4 off at 1e-7).
const EDGE_ON: f64 = 1.0 / 262_144.0;

/// A flat surface that emits.
pub(crate) struct FlatTarget {
    /// Normal as long as the area.
    pub normal: DVec3,
    pub two_sided: bool,
}

impl FlatTarget {
    /// Direction, density per solid angle and distance of the point `q`; `None` where q is p itself, where the
    /// surface is seen edge-on or from a dark side, and where the density is no finite number.
    #[inline(always)]
    pub fn aim_at(&self, at: &Receiver, q: DVec3) -> Option<(DVec3, f32, f64)> {
        let d = q - at.p.as_dvec3();
        let t2 = d.length_squared();
        let t = t2.sqrt();
        let w = d / t;
        Some((w, self.density(w, t2)?, t))
    }

    /// Where along `wi` blockers end to count for a point at distance `t`, and 1/cos of the angle at the light.
    ///
    /// Neighbours in the same plane must not block, though rounding sends some rays across the common edge. Across the
    /// plane, with L the size of the light and |q| ≤ |p| + t: the rounding of its corners, of wi, of the ray in the
    /// mesh's space and of the corners seen from there move the place of meeting by at most 12ut + 2u|p| + 17uL (√3 of each
    /// rounding by axis). Along the ray that is 1/cos as much. As the cosine vanishes nothing blocks, nor is there light.
    #[inline(always)]
    pub fn shadow_end(&self, at: &Receiver, wi: Vec3, t: f64, size: f64) -> (f32, f32) {
        let cos = (wi.as_dvec3().dot(self.normal) / self.normal.length()).abs();
        let across = (f64::from(at.p.abs().max_element()) + t + size) * f64::from(gamma(20));
        let t_max = f64::from(shadow_end(t as f32, at.p)) - across / cos;
        (t_max as f32, (1.0 / cos) as f32)
    }

    #[inline(always)]
    pub fn pdf(&self, wi: Vec3, distance: f32) -> f32 {
        let t = f64::from(distance);
        self.density(wi.as_dvec3(), t * t).unwrap_or(0.0)
    }

    /// Whether a polygon with the corner at `a` and the middle at `center`, both relative to the receiver, is to be
    /// sampled by solid angle. Receivers in its plane, or as good as in it, and at its corners leave that to the area.
    #[inline(always)]
    pub fn is_near(&self, a: DVec3, center: DVec3) -> bool {
        let area = self.normal.length();
        area > NEAR * center.length_squared() && a.dot(self.normal).abs() > EDGE_ON * area * a.length()
    }

    /// Completes a direction sampled with density 1/`solid_angle`: density, distance, and coordinates on the surface
    /// that begins at `corner` with edges e1 and e2; `None` like [`FlatTarget::aim_at`].
    #[inline(always)]
    pub fn aim_along(
        &self,
        at: &Receiver,
        w: DVec3,
        solid_angle: f64,
        [corner, e1, e2]: [DVec3; 3],
    ) -> Option<(DVec3, f32, f64, Vec2)> {
        let pdf = self.density_along(w.as_vec3(), solid_angle)?;
        let t = (corner - at.p.as_dvec3()).dot(self.normal) / w.dot(self.normal);
        let d = at.p.as_dvec3() + w * t - corner;
        let n = e1.cross(e2);
        let b = DVec3::new(d.cross(e2).dot(n), e1.cross(d).dot(n), 0.0) / n.length_squared();
        let b = Vec2::new(b.x as f32, b.y as f32).clamp(Vec2::ZERO, Vec2::ONE); // rounding at the edges
        (t > 0.0 && b.is_finite()).then_some((w, pdf, t, b))
    }

    #[inline(always)]
    pub fn pdf_along(&self, wi: Vec3, solid_angle: f64) -> f32 {
        self.density_along(wi, solid_angle).unwrap_or(0.0)
    }

    #[inline(always)]
    fn density_along(&self, wi: Vec3, solid_angle: f64) -> Option<f32> {
        let cos = -wi.as_dvec3().dot(self.normal);
        if cos > 0.0 || (self.two_sided && cos < 0.0) {
            usable_pdf(1.0 / solid_angle)
        } else {
            None
        }
    }

    /// t²/(A·cos).
    #[inline(always)]
    fn density(&self, wi: DVec3, t2: f64) -> Option<f32> {
        let area_cos = -wi.dot(self.normal);
        let area_cos = if self.two_sided { area_cos.abs() } else { area_cos };
        if area_cos > 0.0 {
            usable_pdf(t2 / area_cos)
        } else {
            None
        }
    }
}
