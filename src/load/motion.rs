//! What moves while the shutter is open, in text scenes: the text is read for several moments, and what it makes each time
//! is compared with what it makes when the shutter opens.

use super::follow::{self, Change, Pose, Step};
use crate::diag::{Diagnostic, Diagnostics};
use crate::scene::motion::{MOST_KEYS, camera_frame, lamp_frame, wants_more_keys};
use crate::scene::{CameraKey, LightKind, MeshForm, MeshId, Object, Place, Scene};
use glam::DAffine3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Moments at which a scene is read at first, both ends included. Turns that these do not follow are read more finely.
const FEWEST_KEYS: usize = 9;
/// Keys that all objects together may have before turns are followed no more finely: 100 bytes each.
const MOST_IN_ALL: usize = 1 << 22;
/// Changes that are told one by one.
const MOST_TOLD: usize = 8;

/// Gives a scene, read at the moment when the shutter opens, its motion. `read` reads it at a later moment: a share of
/// the shutter's time in (0, 1]; if it cannot be read then nothing moves, and the reason is told.
pub fn follow(scene: &mut Scene, read: &mut dyn FnMut(f64) -> Result<Scene, Diagnostic>, diags: &mut Diagnostics) {
    // By the step of the finest time, so that moments are read once.
    let mut poses: BTreeMap<usize, Pose> = BTreeMap::new();
    let (mut changes, mut known): (Vec<Change>, BTreeSet<String>) = Default::default();
    let mut keys = FEWEST_KEYS;
    loop {
        let step = (MOST_KEYS - 1) / (keys - 1);
        for k in (step..MOST_KEYS).step_by(step) {
            if poses.contains_key(&k) {
                continue;
            }
            match read(k as f64 / (MOST_KEYS - 1) as f64) {
                Ok(other) => {
                    let (pose, new) = follow::pose(scene, &other);
                    poses.insert(k, pose);
                    let is_new = |c: &Change| known.insert(format!("{} {:?}", c.what, c.place));
                    changes.extend(new.into_iter().filter(is_new));
                }
                Err(why) => {
                    diags.push(why);
                    return;
                }
            }
        }
        let Applied { wants_more, moving } = apply(scene, &poses.values().collect::<Vec<_>>());
        let finer = 2 * keys - 1;
        if !wants_more || finer > MOST_KEYS || moving * finer > MOST_IN_ALL {
            break;
        }
        keys = finer;
    }
    let formed = poses.iter().filter(|(k, _)| *k % FORM_STEP == 0);
    bend(scene, &formed.map(|(_, pose)| pose).collect::<Vec<_>>());
    tell(&changes, diags);
}

/// Steps of the finest time between two moments at which the forms of meshes are kept.
const FORM_STEP: usize = (MOST_KEYS - 1) / (FEWEST_KEYS - 1);

/// Whether the forms of meshes are kept at this share of the shutter's time.
pub fn has_form(share: f64) -> bool {
    (share * (FEWEST_KEYS - 1) as f64).fract() == 0.0
}

/// Writes the forms of meshes into the scene.
fn bend(scene: &mut Scene, poses: &[&Pose]) {
    let bent: BTreeSet<MeshId> = poses.iter().flat_map(|pose| pose.forms.keys().copied()).collect();
    for id in bent {
        let Some(mesh) = Arc::make_mut(&mut scene.meshes).get_mut(id.index()) else {
            continue;
        };
        let own = MeshForm {
            positions: mesh.positions.clone(),
            normals: mesh.normals.clone(),
        };
        let form = |pose: &&Pose| pose.forms.get(&id).unwrap_or(&own).clone();
        mesh.later = poses.iter().map(form).collect();
    }
}

/// What came of writing a motion into a scene.
struct Applied {
    /// Whether more keys would follow it better.
    wants_more: bool,
    /// How many objects move.
    moving: usize,
}

/// Writes the motion into the scene.
fn apply(scene: &mut Scene, poses: &[&Pose]) -> Applied {
    let (mut wants_more, mut moving) = (false, 0);
    let groups = scene.groups.iter_mut().flat_map(|g| &mut g.objects);
    let objects: Vec<&mut Object> = scene.objects.iter_mut().chain(groups).collect();
    for (i, object) in objects.into_iter().enumerate() {
        let steps = || poses.iter().map(|pose| pose.objects.get(i).unwrap_or(&Step::Lost));
        object.motion.clear();
        let is_still = steps().all(|s| *s == Step::Same) || steps().any(|s| *s == Step::Lost);
        if is_still {
            continue;
        }
        moving += 1;
        object.motion.push(DAffine3::IDENTITY);
        object.motion.extend(steps().map(|step| match step {
            Step::At(map) => **map,
            Step::Same | Step::Lost => DAffine3::IDENTITY,
        }));
        wants_more |= wants_more_keys(&object.motion);
    }
    for (i, light) in scene.lights.iter_mut().enumerate() {
        let keys: Option<Vec<LightKind>> = poses.iter().map(|pose| pose.lights.get(i).cloned().flatten()).collect();
        light.motion.clear();
        if let Some(keys) = keys.filter(|keys| keys.iter().any(|key| *key != light.kind)) {
            light.motion.push(light.kind.clone());
            light.motion.extend(keys);
            wants_more |= wants_more_keys(&light.motion.iter().map(lamp_frame).collect::<Vec<_>>());
        }
    }
    let active = scene.active_camera.and_then(|i| scene.cameras.get_mut(i));
    if let Some(camera) = active {
        let keys: Option<Vec<CameraKey>> = poses.iter().map(|pose| pose.camera).collect();
        camera.motion.clear();
        if let Some(keys) = keys.filter(|keys| keys.iter().any(|key| *key != camera.key())) {
            camera.motion.push(camera.key());
            camera.motion.extend(keys);
            wants_more |= wants_more_keys(&camera.motion.iter().map(camera_frame).collect::<Vec<_>>());
        }
    }
    Applied { wants_more, moving }
}

/// One warning for each thing that changes in more than its place.
fn tell(changes: &[Change], diags: &mut Diagnostics) {
    for change in changes.iter().take(MOST_TOLD) {
        let message = format!("{} while the shutter is open: {}", change.what, change.instead);
        let warning = Diagnostic::warning("L0006", message);
        diags.push(match &change.place {
            Place::None => warning,
            Place::Text(span) => warning.at(*span, ""),
            Place::Model(path) => warning.in_place(path.clone()),
        });
    }
    let more = changes.len().saturating_sub(MOST_TOLD);
    if more > 0 {
        let message = format!("{more} more things change in more than their place while the shutter is open");
        diags.push(Diagnostic::warning("L0006", message));
    }
}

#[cfg(test)]
mod tests;
