//! The best intersection so far, and the rules by which another one replaces it.

use crate::render::ray::{Hit, PrimRef, Ray};
use glam::Vec2;

/// Rejects what the ray must not hit and keeps the nearest of the rest; at equal t the lower primitive.
/// The order in which candidates are offered does not matter.
#[derive(Clone, Copy, Debug)]
pub struct Candidates {
    /// Largest t that is still wanted: the best hit's, or the number below the ray's `t_max`.
    pub t: f32,
    /// What was hit, [`PrimRef::NONE`] so far.
    pub prim: PrimRef,
    /// Barycentric coordinates of the hit.
    pub b: Vec2,
    /// Object whose faces are being offered.
    pub object: u32,
    /// Face of that object the ray starts on, or `u32::MAX`.
    pub from: u32,
    /// Face of that object that does not block, or `u32::MAX`.
    pub to: u32,
}

impl Candidates {
    /// Nothing found yet. A `t_max` that is zero, negative or NaN leaves nothing to find.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Candidates {
        Candidates {
            t: ray.t_max.next_down(),
            prim: PrimRef::NONE,
            b: Vec2::ZERO,
            object: u32::MAX,
            from: u32::MAX,
            to: u32::MAX,
        }
    }

    /// Names the object whose intersections come next.
    #[inline(always)]
    pub fn enter(&mut self, object: u32, ray: &Ray) {
        self.object = object;
        self.from = if ray.from.object == object {
            ray.from.prim
        } else {
            u32::MAX
        };
        self.to = if ray.to.object == object { ray.to.prim } else { u32::MAX };
    }

    /// Whether anything was hit.
    #[inline(always)]
    pub fn found(&self) -> bool {
        self.prim != PrimRef::NONE
    }

    /// Offers an intersection of the current object in f64; anything but 0 < t < t_max is refused after rounding.
    #[inline(always)]
    pub fn offer(&mut self, t: f64, face: u32) {
        self.offer_rounded(t as f32, face, Vec2::ZERO);
    }

    /// Offers an intersection whose t has the ray's own precision.
    #[inline(always)]
    pub fn offer_rounded(&mut self, t: f32, face: u32, b: Vec2) {
        let prim = PrimRef {
            object: self.object,
            prim: face,
        };
        if t > 0.0 && face != self.to && (t < self.t || (t == self.t && prim < self.prim)) {
            self.t = t;
            self.prim = prim;
            self.b = b;
        }
    }

    /// The answer.
    #[inline(always)]
    pub fn hit(&self) -> Option<Hit> {
        self.found().then_some(Hit {
            t: self.t,
            prim: self.prim,
            b: self.b,
        })
    }
}
