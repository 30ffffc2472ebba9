//! Which solids a path is inside of: needed for nested dielectrics and for what fills them.

/// One solid the path is inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Inside {
    object: u32,
    ior: f32,
    medium: u32,
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

    /// Goes through the surface of a solid of this index of refraction, filled with this medium, into it or out of it.
    /// False if the stack is full; the path must then end.
    pub fn cross(&mut self, object: u32, inward: bool, ior: f32, medium: u32) -> bool {
        if inward {
            return self.enter(object, ior, medium);
        }
        self.leave(object);
        true
    }

    /// Goes into a solid. False if the stack is full; the path must then end.
    pub fn enter(&mut self, object: u32, ior: f32, medium: u32) -> bool {
        let len = self.len as usize;
        if len == Self::CAPACITY {
            return false;
        }
        let solid = Inside { object, ior, medium };
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

    /// The medium of the innermost solid; `outside` in free space.
    #[inline(always)]
    pub fn medium(&self, outside: u32) -> u32 {
        if self.is_empty() {
            return outside;
        }
        self.innermost().map_or(outside, |s| s.medium)
    }
}

#[cfg(test)]
mod tests {
    use super::super::CLEAR;
    use super::*;

    #[test]
    fn the_innermost_solid_decides_and_overlaps_unwind() {
        let mut m = MediumStack::default();
        assert_eq!(m.ior_around(1), 1.0);
        assert!(m.enter(1, 1.5, CLEAR) && m.enter(2, 1.33, 4));
        assert_eq!((m.ior_around(2), m.ior_around(1), m.ior_around(7)), (1.5, 1.33, 1.33));
        assert_eq!(m.medium(7), 4);
        m.leave(1);
        assert_eq!(m.ior_around(2), 1.0);
        m.leave(9);
        m.leave(2);
        assert!(m.is_empty());
        assert_eq!(m.medium(7), 7);
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
                assert!(m.enter(object, ior(object), CLEAR));
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
            assert!(m.enter(i, 1.5, CLEAR));
        }
        assert!(!m.enter(99, 1.5, CLEAR));
    }
}
