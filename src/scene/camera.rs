//! Cameras: a pinhole or thin lens, perspective or orthographic.

use super::{CameraKey, Place};
use glam::DVec3;

/// How the picture's shape meets the camera's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Aspect {
    /// `right` and `up` are used as they are; the picture is stretched if the image has another shape (POV-Ray).
    #[default]
    AsWritten,
    /// `up` is kept (vertical field of view) and `right` is scaled to |right|/|up| = width/height (glTF).
    FromImage,
}

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Projection {
    /// All rays start at `location`: `d = direction + (x − ½)·right + (½ − y)·up`, x and y in [0, 1] from the top left.
    #[default]
    Perspective,
    /// Parallel rays along `direction` from `location + (x − ½)·right + (½ − y)·up`.
    Orthographic,
}

/// A camera in world space. The four vectors are final: `look_at`, `angle` and transforms are applied already.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name given in the model, or empty.
    pub name: String,
    /// Where it stands.
    pub location: DVec3,
    /// Towards the centre of the picture; its length is the distance of the image plane.
    pub direction: DVec3,
    /// The width of the image plane, pointing to the right of the picture.
    pub right: DVec3,
    /// The height of the image plane, pointing to the top of the picture.
    pub up: DVec3,
    /// How the picture's shape is met.
    pub aspect: Aspect,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Radius of the lens in world units; 0 is a pinhole.
    pub lens_radius: f64,
    /// Distance of the plane in focus along the view axis, world units, > 0.
    pub focus_distance: f64,
    /// Where it stands and looks at equal steps of the time that the shutter is open, the first at its opening, linear in
    /// between; empty for a camera that stands still.
    pub motion: Vec<CameraKey>,
    /// Where it was written.
    pub place: Place,
}

impl Default for Camera {
    /// POV-Ray's camera: at the origin, looking along +z, y up, right = 4/3·x.
    fn default() -> Camera {
        Camera {
            name: String::new(),
            location: DVec3::ZERO,
            direction: DVec3::Z,
            right: DVec3::X * (4.0 / 3.0),
            up: DVec3::Y,
            aspect: Aspect::AsWritten,
            projection: Projection::Perspective,
            lens_radius: 0.0,
            focus_distance: 1.0,
            motion: Vec::new(),
            place: Place::None,
        }
    }
}
