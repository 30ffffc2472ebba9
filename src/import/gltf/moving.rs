//! What the animations move while the shutter is open: keys for objects, cameras and lamps, poses for what bends.

use super::Loader;
use super::animation::Tracks;
use super::deform::Pose;
use super::node::Placed;
use super::{camera, light};
use crate::scene::motion::{MOST_KEYS, wants_more_keys};
use glam::DAffine3;
use gltf::json;
use serde_json::Value;

/// Keys at first. Turns that these do not follow are followed more finely.
const FEWEST_KEYS: usize = 9;

/// Moments at which the form of a mesh is known, the opening included; eight steps, or four, two or one.
const FORMS: usize = 9;

/// Vertices of all forms of all meshes of a file: 24 bytes each here, and once more in the engine.
const MOST_BENT: u64 = 1 << 23;

/// Where the nodes of a file are in the world, as far as they are in the scene.
pub(super) type World = Vec<Option<DAffine3>>;

/// Where nodes are while the shutter is open.
#[derive(Default)]
pub(super) struct Moving {
    /// By placed node its places in the world at equal steps of time; empty for one that stands still.
    keys: Vec<Vec<DAffine3>>,
    /// By node of the file, whether it moves.
    moves: Vec<bool>,
}

impl Moving {
    /// The places of the placed node `i`, the first when the shutter opens; none if it stands still.
    pub fn keys(&self, i: usize) -> &[DAffine3] {
        self.keys.get(i).map_or(&[], Vec::as_slice)
    }
}

/// How many objects, cameras and lamps there are.
pub(super) struct Counts([usize; 3]);

impl Loader<'_> {
    /// When the shutter opens, in seconds.
    pub(super) fn opening(&self) -> f64 {
        self.options.clock.unwrap_or(0.0)
    }

    /// Follows all nodes while the shutter is open.
    pub(super) fn follow(&self, placed: &[Placed], tracks: &Tracks) -> Moving {
        let shutter = self.options.shutter;
        let mut moving = Moving::default();
        if shutter <= 0.0 {
            return moving;
        }
        moving.moves = vec![false; self.doc.len("nodes")];
        // Parents stand before their children.
        for p in placed {
            let outer = p
                .parent
                .and_then(|i| placed.get(i))
                .is_some_and(|q| moving.moves[q.index]);
            moving.moves[p.index] = outer || tracks.moves(p.index);
        }
        let mut keys = FEWEST_KEYS;
        loop {
            let times: Vec<f64> = (0..keys)
                .map(|k| self.opening() + shutter * k as f64 / (keys - 1) as f64)
                .collect();
            moving.keys = Vec::with_capacity(placed.len());
            for p in placed {
                let outer = p.parent.map(|i| (moving.keys(i), placed[i].world));
                let places = if moving.moves[p.index] {
                    let place = |(k, time): (usize, &f64)| {
                        let local = match (&p.rest, tracks.moves(p.index)) {
                            (Some(rest), true) => tracks.transform(p.index, rest, *time),
                            _ => p.local,
                        };
                        match outer {
                            Some((places, still)) => places.get(k).copied().unwrap_or(still) * local,
                            None => local,
                        }
                    };
                    times.iter().enumerate().map(place).collect()
                } else {
                    Vec::new()
                };
                moving.keys.push(places);
            }
            if keys == MOST_KEYS || !moving.keys.iter().any(|k| wants_more_keys(k)) {
                return moving;
            }
            keys = 2 * keys - 1;
        }
    }

    /// What there is so far.
    pub(super) fn counts(&self) -> Counts {
        Counts([
            self.scene.objects.len(),
            self.scene.cameras.len(),
            self.scene.lights.len(),
        ])
    }

    /// Moves all that was added since with a node that is at these places; meshes that joints hold do not go with it.
    pub(super) fn give_motion(&mut self, places: &[DAffine3], since: Counts, is_skinned: bool) {
        let Some(first) = places.first().filter(|first| places.iter().any(|p| p != *first)) else {
            return;
        };
        let Counts([objects, cameras, lights]) = since;
        let back = first.inverse();
        let own = self.scene.objects.iter_mut().skip(objects);
        for object in own.filter(|_| !is_skinned) {
            // From the node's own space to the object's, which an instance may have moved.
            let inner = back * object.transform;
            let outer = inner.inverse();
            object.motion = places
                .iter()
                .map(|place| {
                    if place.matrix3 == first.matrix3 {
                        // Only shifted: exact, whatever the inverses are rounded to.
                        let shift = place.translation - first.translation;
                        DAffine3::from_translation(object.transform.matrix3.inverse() * shift)
                    } else {
                        outer * (back * *place) * inner
                    }
                })
                .collect();
        }
        for shown in &mut self.scene.cameras[cameras..] {
            shown.motion = places.iter().map(|place| camera::at_place(shown, place)).collect();
        }
        for lamp in &mut self.scene.lights[lights..] {
            lamp.motion = places.iter().map(|place| light::at_place(&lamp.kind, place)).collect();
        }
    }

    /// Where all nodes are at the moments of [`Loader::later_poses`]; none if no skin can need them.
    pub(super) fn later_worlds(&self, placed: &[Placed], moving: &Moving) -> Vec<World> {
        let is_skinned = |p: &Placed| p.visible && p.node.skin.is_some();
        if !moving.moves.contains(&true) || !placed.iter().any(is_skinned) {
            return Vec::new();
        }
        let at = |moment: usize| {
            let mut world = vec![None; self.doc.len("nodes")];
            for (i, p) in placed.iter().enumerate() {
                let keys = moving.keys(i);
                let key = keys.get(moment * keys.len().saturating_sub(1) / (FORMS - 1));
                world[p.index] = Some(key.copied().unwrap_or(p.world));
            }
            world
        };
        (1..FORMS).map(at).collect()
    }

    /// How a node bends its mesh at later moments while the shutter is open, at equal steps; none if it keeps its form. A
    /// large mesh is followed at fewer moments.
    pub(super) fn later_poses(
        &mut self,
        placed: &Placed,
        pose: &Pose,
        worlds: &[World],
        (tracks, moving): (&Tracks, &Moving),
        at: &str,
    ) -> Vec<Pose> {
        let shutter = self.options.shutter;
        if shutter <= 0.0 {
            return Vec::new();
        }
        let node = placed.index;
        let opening = self.opening();
        let weights = |moment: usize| tracks.weights(node, opening + shutter * moment as f64 / (FORMS - 1) as f64);
        let morphs = (1..FORMS).any(|k| weights(k) != weights(0));
        let skin = placed.node.skin.map(|s| s.value());
        let skin = skin.filter(|s| pose.joints.is_some() && !worlds.is_empty() && self.joints_move(*s, moving, at));
        if !morphs && skin.is_none() {
            return Vec::new();
        }
        let vertices = placed.node.mesh.map_or(0, |m| self.vertices_of(m.value()));
        let left = MOST_BENT.saturating_sub(self.bent);
        let Some(forms) = [FORMS, 5, 3, 2]
            .into_iter()
            .find(|n| vertices.saturating_mul(*n as u64) <= left)
        else {
            self.tell_still(at);
            return Vec::new();
        };
        self.bent += vertices * forms as u64;
        let stride = (FORMS - 1) / (forms - 1);
        let mut later = Vec::with_capacity(forms - 1);
        for moment in (stride..FORMS).step_by(stride) {
            let joints = match skin {
                Some(skin) => worlds.get(moment - 1).and_then(|world| self.joints(skin, world, at)),
                None => pose.joints.clone(),
            };
            later.push(Pose {
                weights: if morphs { weights(moment) } else { pose.weights.clone() },
                joints,
                later: Vec::new(),
            });
        }
        later
    }

    /// Whether the joints of a skin move while the shutter is open.
    fn joints_move(&mut self, skin: usize, moving: &Moving, at: &str) -> bool {
        let skin: Option<json::Skin> = self.doc.get(skin, at, &mut self.report);
        let joints = skin.map_or(Vec::new(), |s| s.joints);
        joints.iter().any(|j| moving.moves.get(j.value()) == Some(&true))
    }

    /// Vertices of all primitives of a mesh, as its accessors say.
    fn vertices_of(&self, mesh: usize) -> u64 {
        let table = |name: &str, index: usize| self.doc.top(name)?.get(index);
        let primitives = table("meshes", mesh).and_then(|m| m.get("primitives")?.as_array());
        let count = |p: &Value| {
            let accessor = usize::try_from(p.get("attributes")?.get("POSITION")?.as_u64()?).ok()?;
            table("accessors", accessor)?.get("count")?.as_u64()
        };
        let counts = primitives.into_iter().flatten().filter_map(count);
        counts.fold(0, u64::saturating_add)
    }

    /// Tells once that a mesh keeps its form though it should not.
    pub(super) fn tell_still(&mut self, at: &str) {
        if !self.told_still {
            self.told_still = true;
            let message = "is too large to change its form while the shutter is open, or is turned inside out; it stands as when it opens";
            self.report.warning("G0905", at, message);
        }
    }
}
