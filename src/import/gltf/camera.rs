//! Cameras: they look along their node's −z with +y up.

use super::Loader;
use crate::scene::{Aspect, Camera, CameraKey, Projection};
use glam::{DAffine3, DVec3};
use serde_json::Value;

/// The shape of a picture whose camera does not give one.
const DEFAULT_ASPECT: f64 = 4.0 / 3.0;

impl Loader<'_> {
    /// Adds camera `index` at a node's place. The node's scale does not matter; a mirrored node mirrors the picture.
    pub(super) fn load_camera(&mut self, index: usize, world: DAffine3, node: String, at: &str) {
        let Some(raw) = self.doc.raw("cameras", index, at, &mut self.report) else {
            return;
        };
        let at = format!("cameras[{index}]");
        // Clipping planes have no meaning for rays: they are not read, and files without them are as good.
        let kind = raw.get("type").and_then(Value::as_str).unwrap_or("");
        let member = |key: &str| raw.get(kind).and_then(|object| object.get(key)?.as_f64());
        let (height, aspect, projection) = match kind {
            "perspective" => {
                let yfov = member("yfov").unwrap_or(f64::NAN);
                if !(yfov > 0.0 && yfov < std::f64::consts::PI) {
                    let message = match member("yfov") {
                        Some(_) => format!("is {yfov} rad, expected more than 0 and less than π"),
                        None => "is missing or no number, expected an angle in rad".to_owned(),
                    };
                    self.report.error("G0811", &format!("{at}.perspective.yfov"), message);
                    return;
                }
                let aspect = member("aspectRatio").unwrap_or(DEFAULT_ASPECT);
                (2.0 * (yfov / 2.0).tan(), aspect, Projection::Perspective)
            }
            "orthographic" => {
                let magnification = |key: &str| member(key).unwrap_or(f64::NAN).abs();
                let (x, y) = (magnification("xmag"), magnification("ymag"));
                (2.0 * y, x / y, Projection::Orthographic)
            }
            _ => {
                let message = "has no known `type` with the object of that name, expected perspective or orthographic";
                self.report.error("G0812", &at, message);
                return;
            }
        };
        if !(height > 0.0 && height.is_finite() && aspect > 0.0 && aspect.is_finite()) {
            let message = format!("its height {height} or aspect ratio {aspect} is not positive and finite");
            self.report.error("G0812", &at, message);
            return;
        }
        let [direction, right, up] = axes(&world);
        let own = raw.get("name").and_then(|n| n.as_str()).filter(|n| !n.is_empty());
        self.scene.cameras.push(Camera {
            name: own.map_or(node, str::to_owned),
            location: world.translation,
            direction,
            right: right * (height * aspect),
            up: up * height,
            aspect: Aspect::FromImage,
            projection,
            lens_radius: 0.0,
            focus_distance: 1.0,
            motion: Vec::new(),
            place: self.report.origin(&at),
        });
    }
}

/// Where a camera at a node's place looks, what is to its right and above: unit vectors.
fn axes(world: &DAffine3) -> [DVec3; 3] {
    let axes = world.matrix3;
    let direction = (-axes.z_axis).normalize_or(DVec3::NEG_Z);
    let up = axes.y_axis - direction * axes.y_axis.dot(direction);
    let up = up.normalize_or(direction.any_orthonormal_vector());
    let mirror = if axes.determinant() < 0.0 { -1.0 } else { 1.0 };
    [direction, direction.cross(up) * mirror, up]
}

/// A camera as it is where its node is at another time.
pub(super) fn at_place(camera: &Camera, world: &DAffine3) -> CameraKey {
    let [direction, right, up] = axes(world);
    CameraKey {
        location: world.translation,
        direction,
        right: right * camera.right.length(),
        up: up * camera.up.length(),
        ..camera.key()
    }
}
