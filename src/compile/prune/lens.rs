//! A pinhole has no plane in focus: its distance is set to that of the default camera, so that nothing depends on it.

use super::Pruned;
use crate::scene::Camera;

/// Forgets focus distances that no lens has.
pub fn pass(pruned: &mut Pruned<'_>) {
    let default = Camera::default().focus_distance;
    let is_idle = |c: &Camera| c.lens_radius == 0.0 && c.motion.is_empty() && c.focus_distance != default;
    if pruned.scene.cameras.iter().any(is_idle) {
        let cameras = &mut pruned.scene.to_mut().cameras;
        cameras
            .iter_mut()
            .filter(|c| is_idle(c))
            .for_each(|c| c.focus_distance = default);
    }
}
