//! Objects that move: rays meet them where they are at the ray's time.

use super::scene::Target;
use crate::render::motion::Motion;
use crate::render::ray::Ray;
use glam::DVec3;

/// An object that moves, as rays meet it.
#[derive(Clone, Debug)]
pub(super) struct MovingTarget {
    still: Target,
    motion: Motion,
}

impl MovingTarget {
    /// Moves what is compiled as `still`.
    pub fn new(still: Target, motion: Motion) -> MovingTarget {
        MovingTarget { still, motion }
    }

    /// The object where it was compiled.
    pub fn still(&self) -> &Target {
        &self.still
    }

    /// Origin and direction of the ray as the object would see it where it was compiled; `None` at a moment at which the
    /// object is flattened to nothing.
    pub fn line(&self, ray: &Ray) -> Option<(DVec3, DVec3)> {
        let back = self.motion.at(ray.time).inverse();
        let (o, d) = (
            back.transform_point3(ray.origin.as_dvec3()),
            back.transform_vector3(ray.direction()),
        );
        (o.is_finite() && d.is_finite()).then_some((o, d))
    }
}
