//! Which solids a path is inside of: needed for nested dielectrics and for absorption.

use super::material::Material;
use glam::Vec3;

/// One solid the path is inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Inside {
    object: u32,
    ior: f32,
    absorption: Vec3,
}

/// The solids a path is inside of, the innermost last. Solids are told apart by their object.
#[derive(Clone, Debug, Default)]
pub struct MediumStack {
    len: u32,
    /// The outer ones.
    first: [Option<Inside>; MediumStack::AT_HAND],
    /// Those further in, where solids are nested that deep.
    further: Vec<Inside>,
}

impl MediumStack {
    /// How deep solids may be nested.
    pub const CAPACITY: usize = 1024;
    /// How deep before the heap is used.
    const AT_HAND: usize = 6;

    /// Whether the path is in free space.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// From the innermost to the outermost.
    fn inward_out(&self) -> impl Iterator<Item = &Inside> {
        let at_hand = &self.first[..(self.len as usize).min(Self::AT_HAND)];
        self.further.iter().rev().chain(at_hand.iter().rev().flatten())
    }

    #[inline(always)]
    fn innermost(&self) -> Option<&Inside> {
        match self.further.last() {
            None => self.first.get((self.len as usize).checked_sub(1)?)?.as_ref(),
            last => last,
        }
    }

    /// Goes through the surface of a solid, into it or out of it. False if the stack is full; the path must then end.
    pub fn cross(&mut self, object: u32, inward: bool, material: &Material) -> bool {
        if inward {
            return self.enter(object, material.ior, material.absorption);
        }
        self.leave(object);
        true
    }

    /// Goes into a solid. False if the stack is full; the path must then end.
    pub fn enter(&mut self, object: u32, ior: f32, absorption: Vec3) -> bool {
        let len = self.len as usize;
        if len == Self::CAPACITY {
            return false;
        }
        let solid = Inside {
            object,
            ior,
            absorption,
        };
        match self.first.get_mut(len) {
            Some(place) => *place = Some(solid),
            None => self.further.push(solid),
        }
        self.len += 1;
        true
    }

    /// Leaves a solid, also if it is not the innermost one (overlapping solids). Leaving a solid that was never
    /// entered (an open surface seen from behind) changes nothing.
    pub fn leave(&mut self, object: u32) {
        if let Some(i) = self.further.iter().rposition(|s| s.object == object) {
            self.further.remove(i);
            self.len -= 1;
            return;
        }
        let of = |s: &Option<Inside>| s.is_some_and(|s| s.object == object);
        if let Some(i) = self.first.iter().rposition(of) {
            self.first.copy_within(i + 1.., i);
            let next = (!self.further.is_empty()).then(|| self.further.remove(0));
            self.first[Self::AT_HAND - 1] = next;
            self.len -= 1;
        }
    }

    /// The index of refraction around a surface of `object`: that of the innermost other solid, 1 in free space.
    pub fn ior_around(&self, object: u32) -> f32 {
        match self.innermost() {
            None => 1.0,
            Some(s) if s.object != object => s.ior,
            Some(_) => self.inward_out().find(|s| s.object != object).map_or(1.0, |s| s.ior),
        }
    }

    /// 1/n² of the innermost solid: what radiance in it counts as in free space. 1 there.
    #[inline(always)]
    pub fn basic(&self) -> f32 {
        if self.is_empty() {
            return 1.0;
        }
        self.innermost().map_or(1.0, |s| 1.0 / (s.ior * s.ior))
    }

    /// The share of light that is left after `distance` in the innermost solid, per channel, in [0, 1]. No absorption
    /// gives exactly 1, whatever the distance, and so does no distance (a shadow ray to a light that is as good as
    /// touched may have a length below 0) however strong the absorption; full absorption gives 0, never NaN.
    pub fn transmittance(&self, distance: f32) -> Vec3 {
        let Some(inside) = self.innermost() else {
            return Vec3::ONE;
        };
        let channel = |sigma: f32| {
            if sigma > 0.0 && distance > 0.0 {
                crate::math::portable::exp(-sigma * distance)
            } else {
                1.0
            }
        };
        let s = inside.absorption;
        Vec3::new(channel(s.x), channel(s.y), channel(s.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_innermost_solid_decides_and_overlaps_unwind() {
        let mut m = MediumStack::default();
        assert_eq!(m.ior_around(1), 1.0);
        assert!(m.enter(1, 1.5, Vec3::ZERO) && m.enter(2, 1.33, Vec3::X));
        assert_eq!((m.ior_around(2), m.ior_around(1), m.ior_around(7)), (1.5, 1.33, 1.33));
        m.leave(1);
        assert_eq!(m.ior_around(2), 1.0);
        m.leave(9);
        m.leave(2);
        assert!(m.is_empty());
    }

    fn through(sigma: f32, distance: f32) -> f32 {
        let mut m = MediumStack::default();
        assert!(m.enter(0, 1.5, Vec3::splat(sigma)));
        m.transmittance(distance).x
    }

    /// Beer–Lambert at its ends: nothing absorbs over any way, anything over no way; the rest ends at 0.
    #[test]
    fn absorption_is_exact_at_its_ends() {
        let mut m = MediumStack::default();
        assert!(m.enter(0, 1.5, Vec3::new(0.0, 1e33, 0.5)));
        assert_eq!(m.transmittance(f32::INFINITY), Vec3::new(1.0, 0.0, 0.0));
        for distance in [-1.0, -1e-30, 0.0, 1e-30, 1.0, 1e6, 1e38, f32::INFINITY] {
            assert_eq!(through(0.0, distance), 1.0, "nothing absorbs over {distance}");
        }
        for sigma in [1e-45, 1.0, 1e6, 1e33, f32::INFINITY] {
            for distance in [-1e30, -1e-6, 0.0] {
                assert_eq!(through(sigma, distance), 1.0, "{sigma} over {distance}");
            }
            assert_eq!(through(sigma, f32::INFINITY), 0.0, "{sigma} over an infinite way");
        }
    }

    /// Oracle: f64. The optical depth has one rounding, which changes the result by u times that depth; the
    /// exponential is right to one unit in the last place, 2u; below the normal numbers steps of 2⁻¹⁴⁹ are left.
    #[test]
    fn absorption_matches_f64_over_all_depths() {
        let u = f64::from(crate::math::robust::UNIT_ROUNDOFF);
        for sigma in [1e-33, 1e-9, 1e-3, 0.1, 0.7, 1.0, 30.0, 1e6, 1e33f32] {
            let mut last = 1.0;
            for i in 0..=1400 {
                let distance = 10f64.powf(f64::from(i) / 20.0 - 35.0) as f32;
                let depth = f64::from(sigma) * f64::from(distance);
                let (found, exact) = (f64::from(through(sigma, distance)), (-depth).exp());
                let allowed = exact * u * (depth + 2.0) + 2f64.powi(-149);
                assert!(
                    (found - exact).abs() <= allowed,
                    "{sigma} over {distance}: {found}, exactly {exact}"
                );
                assert!(
                    (0.0..=last).contains(&found),
                    "{sigma} over {distance}: {found} after {last}"
                );
                last = found;
            }
        }
    }

    /// Against a plain list, with solids entered and left in any order, deeper than what is at hand.
    #[test]
    fn any_order_of_surfaces_unwinds() {
        let mut rng = crate::math::stats::Pcg::new(3);
        let (mut m, mut list) = (MediumStack::default(), Vec::<u32>::new());
        let ior = |object: u32| 1.0 + object as f32;
        for _ in 0..20_000 {
            let object = rng.next_u32() % 20;
            if rng.next_u32().is_multiple_of(2) && list.len() < 30 {
                assert!(m.enter(object, ior(object), Vec3::ZERO));
                list.push(object);
            } else {
                m.leave(object);
                if let Some(i) = list.iter().rposition(|&o| o == object) {
                    list.remove(i);
                }
            }
            for around in [object, 7] {
                let want = list.iter().rev().find(|&&o| o != around).map_or(1.0, |&o| ior(o));
                assert_eq!(m.ior_around(around), want, "{list:?}");
            }
            let inside = list.last().map_or(1.0, |&o| 1.0 / (ior(o) * ior(o)));
            assert_eq!((m.is_empty(), m.basic()), (list.is_empty(), inside));
        }
    }

    #[test]
    fn a_full_stack_says_so() {
        let mut m = MediumStack::default();
        for i in 0..MediumStack::CAPACITY as u32 {
            assert!(m.enter(i, 1.5, Vec3::ZERO));
        }
        assert!(!m.enter(99, 1.5, Vec3::ZERO));
    }
}
