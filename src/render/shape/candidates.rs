//! The best intersection so far, and the rules by which another one replaces it.

use crate::render::ray::{Hit, PrimRef, Ray};
use glam::Vec2;

/// Rejects what the ray must not hit and keeps the nearest of the rest; at equal t the lower primitive.
/// The order in which candidates are offered does not matter.
#[derive(Clone, Copy, Debug)]
pub struct Candidates {
    /// Largest t that is still wanted, for boxes: that of the best hit or the number below the ray's `t_max`, rounded to
    /// f32 and counted from `shift`.
    pub t: f32,
    /// The same for primitives, counted from the ray's start.
    pub exact: f64,
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
    /// Where the boxes that are being walked take the ray to start.
    shift: f64,
    /// What stands at the end of the ray, where that is known: nothing is found as long as it is the nearest.
    end: PrimRef,
    /// From here on what belongs to the same object as the end is its neighbour in the same surface and does not count.
    spared_from: f64,
}

/// t as candidates compare it: rounded to 40 bits. What lies in one place has one t then, whatever formula it comes
/// from, and the lower primitive wins; what is apart by more than 2⁻³⁹·t stays apart.
#[inline(always)]
pub fn comparable(t: f64) -> f64 {
    const BITS: u32 = 13;
    f64::from_bits((t.to_bits() + (1 << (BITS - 1))) & !((1 << BITS) - 1))
}

impl Candidates {
    /// Nothing found yet. A `t_max` that is zero, negative or NaN leaves nothing to find.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Candidates {
        let t = ray.t_max.next_down();
        Candidates {
            t,
            exact: f64::from(t),
            prim: PrimRef::NONE,
            b: Vec2::ZERO,
            object: u32::MAX,
            from: u32::MAX,
            to: u32::MAX,
            shift: 0.0,
            end: PrimRef::NONE,
            spared_from: f64::INFINITY,
        }
    }

    /// Takes what was found as the end of the ray: from now on only what hides it is found. Of the object it belongs to
    /// only what is nearer by more than `room`.
    pub fn end_here(&mut self, room: f64) {
        self.end = self.prim;
        self.spared_from = self.exact - room;
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

    /// Lets boxes count t from `shift` on.
    #[inline(always)]
    pub fn start_boxes_at(&mut self, shift: f64) {
        self.shift = shift;
        self.t = (self.exact - shift) as f32;
    }

    /// Whether anything was hit, before the end if that is known.
    #[inline(always)]
    pub fn found(&self) -> bool {
        self.prim != self.end
    }

    /// Offers an intersection of the current object; anything but 0 < t < t_max is refused.
    #[inline(always)]
    pub fn offer(&mut self, t: f64, face: u32) {
        self.offer_at(t, face, Vec2::ZERO);
    }

    /// The same with the place on a triangle.
    #[inline(always)]
    pub fn offer_at(&mut self, t: f64, face: u32, b: Vec2) {
        let prim = PrimRef {
            object: self.object,
            prim: face,
        };
        let exact = comparable(t);
        if t > 0.0 && face != self.to && (exact < self.exact || (exact == self.exact && prim < self.prim)) {
            if self.object == self.end.object && exact >= self.spared_from {
                return;
            }
            self.exact = exact;
            self.t = (exact - self.shift) as f32;
            self.prim = prim;
            self.b = b;
        }
    }

    /// The answer.
    #[inline(always)]
    pub fn hit(&self) -> Option<Hit> {
        self.found().then_some(Hit {
            t: self.exact as f32,
            exact: self.exact,
            prim: self.prim,
            b: self.b,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Neighbours among the 40-bit numbers are 2⁻⁴⁰ to 2⁻³⁹ apart, relative to t.
    #[test]
    fn what_is_apart_stays_apart_and_rounding_does_not_count() {
        let mut t = 1e-30;
        while t < 1e30 {
            assert_eq!(comparable(t * (1.0 + 2e-16)), comparable(t), "{t}");
            assert!(comparable(t * (1.0 + 4e-12)) > comparable(t), "{t}");
            assert!((comparable(t) / t - 1.0).abs() <= 2f64.powi(-40), "{t}");
            t *= 7.3890560989;
        }
        assert_eq!(comparable(f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn only_what_hides_the_end_of_the_ray_is_found() {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let mut end = Candidates::new(&ray);
        end.enter(5, &ray);
        end.offer(2.0, 0);
        end.end_here(0.01);
        let cases = [
            (7, 2.0, false),
            (3, 2.0, true),
            (7, 1.999, true),
            (3, 2.001, false),
            (5, 1.999, false),
            (5, 1.98, true),
        ];
        for (object, t, hides) in cases {
            let mut found = end;
            found.enter(object, &ray);
            found.offer(t, 1);
            assert_eq!(found.found(), hides, "{object} at {t}");
        }
    }

    #[test]
    fn faces_of_the_lamp_itself_block_only_well_before_its_end() {
        let mut ray = Ray::new(Vec3::ZERO, Vec3::Z);
        ray.to = PrimRef { object: 5, prim: 0 };
        ray.t_max = 1.9;
        let mut end = Candidates::new(&Ray::new(Vec3::ZERO, Vec3::Z));
        end.enter(5, &Ray::new(Vec3::ZERO, Vec3::Z));
        end.offer(2.0, 0);
        end.end_here(0.1); // as much as the rounding of its corners may be
        for (object, face, t, hides) in [
            (5, 1, 1.8, true),
            (5, 1, 1.95, false),
            (5, 0, 1.0, false),
            (6, 1, 1.95, true),
        ] {
            let mut found = end;
            found.enter(object, &ray);
            found.offer(t, face);
            assert_eq!(found.found(), hides, "{object}, {face} at {t}");
        }
    }
}
