//! How things move while the shutter is open.

use glam::{DAffine3, DVec3};

/// Placements at equal steps of the time that the shutter is open, linear in between.
///
/// A key maps the space in which something was compiled (camera-relative world space, where it stands at no time in
/// particular) to where it is at the key's time. Matrices are interpolated entry by entry, so that each point moves on a
/// straight line between two keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: Box<[DAffine3]>,
}

impl Motion {
    /// A motion through these placements, the first at time 0, the last at time 1. `None` if that is no motion: fewer
    /// than two keys, or all the same.
    pub fn new(keys: Vec<DAffine3>) -> Option<Motion> {
        let moves = keys.windows(2).any(|pair| pair[0] != pair[1]);
        moves.then(|| Motion { keys: keys.into() })
    }

    /// Standing still, for what moves otherwise than as a whole.
    pub fn still() -> Motion {
        Motion {
            keys: [DAffine3::IDENTITY; 2].into(),
        }
    }

    /// The placements, two or more.
    pub fn keys(&self) -> &[DAffine3] {
        &self.keys
    }

    /// By how much the origin is moved at a time in [0, 1].
    pub fn shift_at(&self, time: f32) -> DVec3 {
        let (i, w) = step(self.keys.len(), time);
        self.keys[i].translation * (1.0 - w) + self.keys[i + 1].translation * w
    }

    /// The placement at a time in [0, 1].
    pub fn at(&self, time: f32) -> DAffine3 {
        let (i, w) = step(self.keys.len(), time);
        let (a, b) = (&self.keys[i], &self.keys[i + 1]);
        DAffine3 {
            matrix3: a.matrix3 * (1.0 - w) + b.matrix3 * w,
            translation: self.shift_at(time),
        }
    }
}

/// The key before a time in [0, 1], of `keys` ≥ 2 at equal steps, and how much of the way to the next has passed: in
/// [0, 1]. Times outside count as the nearer end, and what is no number as 0.
pub fn step(keys: usize, time: f32) -> (usize, f64) {
    let steps = keys - 1;
    let at = f64::from(time).clamp(0.0, 1.0) * steps as f64;
    let i = (at as usize).min(steps - 1);
    let w = at - i as f64;
    (i, if w > 0.0 { w } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    #[test]
    fn keys_are_met_and_ways_between_them_are_straight() {
        let keys: Vec<DAffine3> = [0.0, 1.0, 3.0, 2.0, 10.0]
            .iter()
            .map(|&x| DAffine3::from_mat3_translation(DMat3::from_rotation_y(x), DVec3::X * x))
            .collect();
        let motion = Motion::new(keys.clone()).expect("it moves");
        for (k, key) in keys.iter().enumerate() {
            assert_eq!(motion.at(k as f32 / 4.0), *key);
        }
        for i in 0..=400 {
            let time = i as f32 / 400.0;
            let (k, w) = step(5, time);
            let p = DVec3::new(0.3, -2.0, 5.0);
            let ends = [keys[k], keys[k + 1]].map(|m| m.transform_point3(p));
            let off = motion.at(time).transform_point3(p) - ends[0].lerp(ends[1], w);
            assert!(off.length() < 1e-14, "{time}: {off}");
        }
    }

    #[test]
    fn times_outside_and_none_at_all_are_the_ends() {
        for (time, at) in [
            (-1.0, (0, 0.0)),
            (0.0, (0, 0.0)),
            (1.0, (2, 1.0)),
            (7.0, (2, 1.0)),
            (f32::INFINITY, (2, 1.0)),
            (f32::NEG_INFINITY, (0, 0.0)),
            (f32::NAN, (0, 0.0)),
        ] {
            assert_eq!(step(4, time), at, "{time}");
        }
    }

    #[test]
    fn what_stays_is_no_motion() {
        let (a, b) = (DAffine3::from_translation(DVec3::X), DAffine3::IDENTITY);
        assert_eq!(Motion::new(vec![]), None);
        assert_eq!(Motion::new(vec![a]), None);
        assert_eq!(Motion::new(vec![a; 9]), None);
        assert!(Motion::new(vec![a, a, b]).is_some());
    }
}
