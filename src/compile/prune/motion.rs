//! Motion that leads nowhere: all keys say that the thing stands where it stands.
//!
//! Kept to the bit: the thing is placed by the same numbers, and rays to what stands still ask for no time.

use super::{Pass, Pruned, Saved};
use crate::compile::effects::causes::kind_of;
use crate::scene::{Camera, Light, Object, Place};
use glam::DAffine3;

/// Takes such motion away from objects, lamps and cameras.
pub fn pass(pruned: &mut Pruned<'_>) {
    let scene = &*pruned.scene;
    let members = scene.groups.iter().flat_map(|g| &g.objects);
    let objects = scene.objects.iter().chain(members).filter(|o| rests(o));
    let mut still: Vec<(&'static str, String, Place)> = objects
        .map(|o| (kind_of(&o.shape), o.name.clone(), o.place.clone()))
        .collect();
    let lamps = scene.lights.iter().filter(|l| lamp_rests(l));
    still.extend(lamps.map(|l| ("lamp", l.name.clone(), l.place.clone())));
    let cameras = scene.cameras.iter().filter(|c| camera_rests(c));
    still.extend(cameras.map(|c| ("camera", c.name.clone(), c.place.clone())));
    if still.is_empty() {
        return;
    }
    let scene = pruned.scene.to_mut();
    let members = scene.groups.iter_mut().flat_map(|g| &mut g.objects);
    let objects = scene.objects.iter_mut().chain(members);
    objects.filter(|o| rests(o)).for_each(|o| o.motion.clear());
    scene
        .lights
        .iter_mut()
        .filter(|l| lamp_rests(l))
        .for_each(|l| l.motion.clear());
    scene
        .cameras
        .iter_mut()
        .filter(|c| camera_rests(c))
        .for_each(|c| c.motion.clear());
    for (kind, name, place) in still {
        let why = "it stands still while the shutter is open";
        pruned.tell(Pass::Motion, kind, &name, why, &place, Saved::default());
    }
}

fn rests(object: &Object) -> bool {
    !object.motion.is_empty() && object.motion.iter().all(|key| *key == DAffine3::IDENTITY)
}

fn lamp_rests(lamp: &Light) -> bool {
    !lamp.motion.is_empty() && lamp.motion.iter().all(|key| *key == lamp.kind)
}

fn camera_rests(camera: &Camera) -> bool {
    !camera.motion.is_empty() && camera.motion.iter().all(|key| *key == camera.key())
}
