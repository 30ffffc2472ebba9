//! Which solids a path is inside of: needed for nested dielectrics and for absorption.

use glam::Vec3;

/// One solid the path is inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Inside {
    object: u32,
    ior: f32,
    absorption: Vec3,
}

/// The solids a path is inside of, the innermost last. Solids are told apart by their object.
#[derive(Clone, Copy, Debug, Default)]
pub struct MediumStack {
    len: u8,
    solids: [Option<Inside>; MediumStack::CAPACITY],
}

impl MediumStack {
    /// How deep solids may be nested.
    pub const CAPACITY: usize = 16;

    /// Whether the path is in free space.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Goes into a solid. False if the stack is full; the path must then end.
    pub fn enter(&mut self, object: u32, ior: f32, absorption: Vec3) -> bool {
        if self.len as usize == Self::CAPACITY {
            return false;
        }
        self.solids[self.len as usize] = Some(Inside {
            object,
            ior,
            absorption,
        });
        self.len += 1;
        true
    }

    /// Leaves a solid, also if it is not the innermost one (overlapping solids). Leaving a solid that was never
    /// entered (an open surface seen from behind) changes nothing.
    pub fn leave(&mut self, object: u32) {
        let len = self.len as usize;
        let of = |s: &Option<Inside>| s.is_some_and(|s| s.object == object);
        if let Some(i) = self.solids[..len].iter().rposition(of) {
            self.solids.copy_within(i + 1..len, i);
            self.len -= 1;
        }
    }

    /// The index of refraction around a surface of `object`: that of the innermost other solid, 1 in free space.
    pub fn ior_around(&self, object: u32) -> f32 {
        let others = self.solids[..self.len as usize].iter().rev().flatten();
        others.clone().find(|s| s.object != object).map_or(1.0, |s| s.ior)
    }

    /// The share of light that is left after `distance` in the innermost solid, per channel, in [0, 1]. No absorption
    /// gives exactly 1, whatever the distance, and so does no distance (a shadow ray to a light that is as good as
    /// touched may have a length below 0) however strong the absorption; full absorption gives 0, never NaN.
    pub fn transmittance(&self, distance: f32) -> Vec3 {
        let Some(Some(inside)) = self.len.checked_sub(1).map(|i| self.solids[i as usize]) else {
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

    #[test]
    fn a_full_stack_says_so() {
        let mut m = MediumStack::default();
        for i in 0..MediumStack::CAPACITY as u32 {
            assert!(m.enter(i, 1.5, Vec3::ZERO));
        }
        assert!(!m.enter(99, 1.5, Vec3::ZERO));
    }
}
