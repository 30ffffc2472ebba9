//! Objects that move: rays meet them where they are at the ray's time.

use super::scene::Target;
use crate::render::motion::Motion;
use crate::render::ray::Ray;
use glam::{DMat3, DVec3};

/// An object that moves, as rays meet it.
#[derive(Clone, Debug)]
pub(super) struct MovingTarget {
    still: Target,
    motion: Motion,
    /// Whether it is neither turned nor stretched on its way: no map has to be inverted then.
    shifts: bool,
}

impl MovingTarget {
    /// Moves what is compiled as `still`.
    pub fn new(still: Target, motion: Motion) -> MovingTarget {
        let shifts = motion.keys().iter().all(|key| key.matrix3 == DMat3::IDENTITY);
        MovingTarget { still, motion, shifts }
    }

    /// The object where it was compiled.
    pub fn still(&self) -> &Target {
        &self.still
    }

    /// Origin and direction of the ray as the object would see it where it was compiled; `None` at a moment at which the
    /// object is flattened to nothing.
    pub fn line(&self, ray: &Ray) -> Option<(DVec3, DVec3)> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction());
        if self.shifts {
            return Some((o - self.motion.shift_at(ray.time), d));
        }
        let back = self.motion.at(ray.time).inverse();
        let (o, d) = (back.transform_point3(o), back.transform_vector3(d));
        (o.is_finite() && d.is_finite()).then_some((o, d))
    }
}
