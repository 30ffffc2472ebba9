//! The camera of the scene becomes the engine's, at the origin of camera-relative space.

use crate::diag::{Diagnostic, Diagnostics};
use crate::render::camera::{Camera as RenderCamera, Pose};
use crate::scene::{Aspect, Camera, CameraKey, Projection};
use glam::DVec3;

/// Turns a camera into the engine's for a picture of this shape. Errors: no direction, no width or height, or
/// a plane in focus that is not in front of the lens.
///
/// The origin is where it stands when the shutter opens; of a camera that moves each key must be such a camera.
pub fn compile_camera(camera: &Camera, width: u32, height: u32, diags: &mut Diagnostics) -> Option<RenderCamera> {
    let mut compiled = still_camera(camera, width, height, diags)?;
    if camera.moves() {
        for key in &camera.motion {
            let mut pose = still_camera(&at_key(camera, key), width, height, diags)?.pose;
            pose.location = key.location - camera.location;
            compiled.keys.push(pose);
        }
    }
    Some(compiled)
}

/// The camera as it is at one moment.
fn at_key(camera: &Camera, key: &CameraKey) -> Camera {
    let CameraKey {
        location,
        direction,
        right,
        up,
        lens_radius,
        focus_distance,
    } = *key;
    Camera {
        location,
        direction,
        right,
        up,
        lens_radius,
        focus_distance,
        motion: Vec::new(),
        ..camera.clone()
    }
}

fn still_camera(camera: &Camera, width: u32, height: u32, diags: &mut Diagnostics) -> Option<RenderCamera> {
    let mut right = camera.right;
    if camera.aspect == Aspect::FromImage {
        let aspect = f64::from(width) / f64::from(height);
        right = right.normalize_or(DVec3::X) * (camera.up.length() * aspect);
    }
    let mut refuse = |message: String, hint: &str| {
        diags.push(super::at_place(
            Diagnostic::error("C0201", message).hint(hint),
            &camera.place,
        ));
    };
    let area = right.cross(camera.up);
    let vectors_finite = camera.direction.is_finite() && area.is_finite() && camera.location.is_finite();
    if !vectors_finite || camera.direction.dot(area) == 0.0 {
        refuse(
            format!(
                "the camera has no picture: direction {}, right {right} and up {} do not span space",
                camera.direction, camera.up
            ),
            "`look_at` must differ from `location`, and `sky` must not point along the view",
        );
        return None;
    }
    if camera.lens_radius > 0.0 && (camera.focus_distance <= 0.0 || camera.focus_distance.is_nan()) {
        refuse(
            format!("the focus distance must be positive, found {}", camera.focus_distance),
            "it is measured along the view axis from the camera",
        );
        return None;
    }
    if !(camera.lens_radius.is_finite() && camera.lens_radius >= 0.0) {
        refuse(
            format!("the lens radius must be 0 or more, found {}", camera.lens_radius),
            "0 is a pinhole",
        );
        return None;
    }
    Some(RenderCamera {
        orthographic: camera.projection == Projection::Orthographic,
        pose: Pose {
            location: DVec3::ZERO,
            direction: camera.direction,
            right,
            up: camera.up,
            lens_radius: camera.lens_radius,
            focus_distance: camera.focus_distance,
        },
        keys: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gltf_camera_keeps_its_vertical_field_of_view() {
        let camera = Camera {
            aspect: Aspect::FromImage,
            up: DVec3::Y * 2.0,
            ..Camera::default()
        };
        let wide = compile_camera(&camera, 200, 50, &mut Diagnostics::default());
        assert_eq!(
            wide.map(|c| (c.pose.right, c.pose.up)),
            Some((DVec3::X * 8.0, DVec3::Y * 2.0))
        );
    }

    /// A focus in front of the lens, however far, is taken; at the lens, behind it or nowhere it is refused, and so is a
    /// lens of no real size. A pinhole has no focus to be wrong.
    #[test]
    fn only_a_lens_that_can_focus_is_taken() {
        let taken = |lens_radius: f64, focus_distance: f64| {
            let camera = Camera {
                lens_radius,
                focus_distance,
                ..Camera::default()
            };
            compile_camera(&camera, 4, 4, &mut Diagnostics::default()).is_some()
        };
        for focus in [1e-300, 1e-20, 1.0, 1e20, 1e300, f64::INFINITY] {
            assert!(taken(0.1, focus) && taken(0.0, focus), "a focus of {focus} is refused");
        }
        for focus in [0.0, -0.0, -1.0, f64::NEG_INFINITY, f64::NAN] {
            assert!(!taken(0.1, focus) && taken(0.0, focus), "a focus of {focus}");
        }
        for lens in [-1.0, f64::INFINITY, f64::NAN] {
            assert!(!taken(lens, 1.0), "a lens of {lens} is taken");
        }
    }

    #[test]
    fn a_camera_without_a_direction_is_refused() {
        let camera = Camera {
            direction: DVec3::ZERO,
            ..Camera::default()
        };
        let mut diags = Diagnostics::default();
        assert!(compile_camera(&camera, 4, 4, &mut diags).is_none() && diags.has_errors());
    }
}
