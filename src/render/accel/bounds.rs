//! Axis-aligned boxes in f32, always rounded outward.

use glam::{DAffine3, DVec3, Vec3};

/// A box; empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Bounds {
    /// Contains nothing.
    pub const EMPTY: Bounds = Bounds {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box around points that are exact in f32.
    pub fn around(points: &[Vec3]) -> Bounds {
        points.iter().fold(Bounds::EMPTY, |b, &p| Bounds {
            min: b.min.min(p),
            max: b.max.max(p),
        })
    }

    /// A box around an f64 box whose corners may each be off by `error`, rounded outward.
    /// What exceeds the range of f32 ends at its largest number.
    pub fn from_f64(min: DVec3, max: DVec3, error: DVec3) -> Bounds {
        let down = |x: f64| (x as f32).next_down().clamp(-f32::MAX, f32::MAX);
        let up = |x: f64| (x as f32).next_up().clamp(-f32::MAX, f32::MAX);
        let (lo, hi) = (min - error, max + error);
        Bounds {
            min: Vec3::new(down(lo.x), down(lo.y), down(lo.z)),
            max: Vec3::new(up(hi.x), up(hi.y), up(hi.z)),
        }
    }

    /// A box around the image of a box (centre and half extent) under an affine map, with the map's rounding.
    pub fn transformed(map: &DAffine3, center: DVec3, half: DVec3) -> Bounds {
        let m = crate::render::shape::placed::abs(map.matrix3);
        let c = map.transform_point3(center);
        let h = m * half;
        let error = (m * (center.abs() + half) + map.translation.abs()) * (8.0 * f64::EPSILON);
        Bounds::from_f64(c - h, c + h, error)
    }

    /// The smallest box around both.
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The box widened on all sides by a share of its farthest coordinate.
    pub fn padded(self, share: f32) -> Bounds {
        let e = self.largest() * share;
        Bounds {
            min: (self.min - e).max(Vec3::splat(-f32::MAX)),
            max: (self.max + e).min(Vec3::splat(f32::MAX)),
        }
    }

    /// The largest coordinate by absolute value; 0 if empty.
    pub fn largest(self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        self.min.abs().max(self.max.abs()).max_element()
    }

    /// Whether nothing is inside; so too if a coordinate is not a number.
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }
}
