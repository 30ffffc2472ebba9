//! What the animations move while the shutter is open: keys for objects, cameras and lamps.

use super::Loader;
use super::animation::Tracks;
use super::node::Placed;
use super::{camera, light};
use crate::scene::motion::{MOST_KEYS, wants_more_keys};
use glam::DAffine3;
use gltf::json;

/// Keys at first. Turns that these do not follow are followed more finely.
const FEWEST_KEYS: usize = 9;

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

    /// Tells once that joints move while the skin does not.
    pub(super) fn skins_stand_still(&mut self, skin: usize, moving: &Moving, at: &str) {
        let skin: Option<json::Skin> = self.doc.get(skin, at, &mut self.report);
        let joints = skin.map_or(Vec::new(), |s| s.joints);
        if joints.iter().any(|j| moving.moves.get(j.value()) == Some(&true)) {
            self.tell_still(at);
        }
    }

    /// Tells once that weights change while the shape does not.
    pub(super) fn morphs_stand_still(&mut self, tracks: &Tracks, node: usize) {
        let shutter = self.options.shutter;
        let at = |k: u32| tracks.weights(node, self.opening() + shutter * f64::from(k) / 8.0);
        if shutter > 0.0 && (1..=8).any(|k| at(k) != at(0)) {
            self.tell_still(&format!("nodes[{node}]"));
        }
    }

    fn tell_still(&mut self, at: &str) {
        if !self.told_still {
            self.told_still = true;
            let message = "skins and morph targets stand as they are when the shutter opens";
            self.report.warning("G0905", at, message);
        }
    }
}
