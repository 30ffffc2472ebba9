//! Who calls for motion blur: what really moves while the shutter is open, and is drawn or shines.

use super::causes::{Cause, name};
use crate::scene::{GroupId, Mesh, Object, Scene, Shape};
use std::collections::{BTreeMap, BTreeSet};

/// Groups nested deeper than this contain themselves; `compile` refuses them.
const DEEPEST: u32 = 256;

/// Tells each cause: objects, lamps and the camera in use. A group that moves is one cause, whatever is in it.
pub(super) fn of_scene(scene: &Scene, add: &mut dyn FnMut(Cause)) {
    let mut known = BTreeMap::new();
    let mut queue: Vec<&Object> = scene.objects.iter().rev().collect();
    let mut seen = BTreeSet::new();
    while let Some(object) = queue.pop() {
        let group = match object.shape {
            Shape::Group(id) => Some(id),
            _ => None,
        };
        if object.moves() && group.is_none_or(|id| shows(scene, id, 0, &mut known)) {
            add(Cause {
                what: name(&object.shape, &object.name),
                why: "moves while the shutter is open".to_owned(),
                place: object.place.clone(),
                times: 1,
            });
        }
        if let Shape::Mesh(id) = object.shape
            && scene.meshes.get(id.index()).is_some_and(Mesh::bends)
        {
            add(Cause {
                what: name(&object.shape, &object.name),
                why: "changes its form while the shutter is open".to_owned(),
                place: object.place.clone(),
                times: 1,
            });
        }
        if let Some(id) = group.filter(|id| seen.insert(*id)) {
            queue.extend(
                scene
                    .groups
                    .get(id.index())
                    .into_iter()
                    .flat_map(|g| g.objects.iter().rev()),
            );
        }
    }
    for light in scene.lights.iter().filter(|l| l.color.max_element() > 0.0 && l.moves()) {
        add(Cause {
            what: match light.name.as_str() {
                "" => "lamp".to_owned(),
                name => format!("lamp \"{name}\""),
            },
            why: "moves while the shutter is open".to_owned(),
            place: light.place.clone(),
            times: 1,
        });
    }
    if let Some(camera) = scene.camera().filter(|c| c.moves()) {
        add(Cause {
            what: "the camera".to_owned(),
            why: "moves while the shutter is open".to_owned(),
            place: camera.place.clone(),
            times: 1,
        });
    }
}

/// Whether anything is drawn of a group.
fn shows(scene: &Scene, id: GroupId, depth: u32, known: &mut BTreeMap<GroupId, bool>) -> bool {
    if let Some(known) = known.get(&id) {
        return *known;
    }
    let objects = scene.groups.get(id.index()).map_or(&[][..], |g| &g.objects);
    let found = depth < DEEPEST
        && objects.iter().any(|o| match o.shape {
            Shape::Group(inner) => shows(scene, inner, depth + 1, known),
            _ => true,
        });
    known.insert(id, found);
    found
}
