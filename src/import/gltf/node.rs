//! The chosen scene's node tree: transforms, meshes with their instances, lamps and cameras.

use super::Loader;
use super::accessor::Wanted;
use super::animation::{Rest, Tracks};
use super::budget::Cost;
use super::deform::{Pose, affine_from_columns};
use super::document::{extension, index_of};
use super::extension::exact;
use super::mesh::VEC3;
use super::moving::{Moving, World};
use super::variant::known;
use crate::diag::{Anomaly, Diagnostic};
use crate::scene::{Object, Shape};
use glam::{DAffine3, DQuat, DVec3};
use gltf::json;
use serde_json::Value;

/// A node of the scene with its place in the world.
pub(super) struct Placed {
    pub index: usize,
    pub node: json::Node,
    /// Which of the placed nodes it stands in.
    pub parent: Option<usize>,
    /// Its own transform as it is shown, or when the shutter opens.
    pub local: DAffine3,
    /// As it is written, unless it has a matrix.
    pub rest: Option<Rest>,
    pub world: DAffine3,
    pub visible: bool,
}

/// Most nodes that are met twice before the walk is given up.
const MOST_STRAYS: usize = 100;

impl Loader<'_> {
    /// Reads everything that the chosen scene reaches.
    pub(super) fn load_scene(&mut self) {
        let Some(roots) = self.scene_roots() else {
            return;
        };
        let options = self.options;
        let played = options.clock.is_some() || options.animation.is_some() || options.shutter > 0.0;
        let tracks = if played { self.tracks() } else { Tracks::default() };
        let mut placed = self.place_nodes(roots, &tracks);
        let Some(origin) = self.keep_subtree(&mut placed) else {
            return;
        };
        let moving = self.follow(&placed, &tracks);
        let mut world = vec![None; self.doc.len("nodes")];
        for p in &placed {
            world[p.index] = Some(p.world);
        }
        let later = self.later_worlds(&placed, &moving);
        for (i, p) in placed.iter().enumerate().filter(|(_, p)| p.visible) {
            let before = self.counts();
            let is_skinned = self.load_node(p, (&world, &later), &tracks, &moving);
            self.give_motion(moving.keys(i), before, is_skinned);
        }
        self.put_origin(origin);
        if self.scene.objects.is_empty() && !self.report.failed {
            self.report.warning("G0501", "", "the scene has nothing to draw");
        }
    }

    /// The root nodes of the scene asked for, each with the place that names it: by the caller's choice, the file's
    /// own, or its first; without any scene all nodes that have no parent.
    fn scene_roots(&mut self) -> Option<Vec<(usize, String)>> {
        let index = match (&self.options.scene, self.doc.top("scene")) {
            (Some(wanted), _) => self.scene_named(wanted)?,
            (None, Some(_)) => index_of(self.doc.root(), "scene", "", &mut self.report)?,
            (None, None) if self.doc.len("scenes") == 0 => return Some(self.parentless()),
            (None, None) => 0,
        };
        self.chosen_scene = Some(index);
        let scene = self.doc.raw("scenes", index, "scene", &mut self.report)?;
        let at = format!("scenes[{index}].nodes");
        match scene.get("nodes") {
            None => Some(Vec::new()),
            Some(list) => Some(self.node_list(list, &at)),
        }
    }

    fn scene_named(&mut self, wanted: &str) -> Option<usize> {
        let count = self.doc.len("scenes");
        let names: Vec<String> = (0..count).map(|i| self.doc.name("scenes", i)).collect();
        let by_number = || wanted.parse().ok().filter(|i| *i < count);
        let found = names.iter().position(|n| n == wanted).or_else(by_number);
        if found.is_none() {
            let d = Diagnostic::error("G0502", format!("there is no scene \"{wanted}\""));
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            self.report.push("", d.hint(known("scenes", &names)));
        }
        found
    }

    /// All nodes that are nobody's child.
    fn parentless(&mut self) -> Vec<(usize, String)> {
        let nodes = self
            .doc
            .top("nodes")
            .and_then(Value::as_array)
            .map_or(&[][..], Vec::as_slice);
        let mut is_child = vec![false; nodes.len()];
        let children = nodes.iter().filter_map(|n| n.get("children")?.as_array());
        for child in children.flatten().filter_map(Value::as_u64) {
            if let Some(flag) = is_child.get_mut(child as usize) {
                *flag = true;
            }
        }
        let roots = (0..nodes.len()).filter(|i| !is_child[*i]);
        roots.map(|i| (i, format!("nodes[{i}]"))).collect()
    }

    /// An array of node indices with the place of each.
    fn node_list(&mut self, list: &Value, at: &str) -> Vec<(usize, String)> {
        let Some(items) = list.as_array() else {
            self.report.error("G0203", at, "is not an array of indices");
            return Vec::new();
        };
        let mut out = Vec::with_capacity(items.len());
        for (i, item) in items.iter().enumerate() {
            let at = format!("{at}[{i}]");
            match item.as_u64() {
                Some(index) => out.push((index as usize, at)),
                None => self.report.error("G0203", &at, format!("is {item}, expected an index")),
            }
        }
        out
    }

    /// Walks the tree. A node met a second time is an error, so the walk ends whatever the file says.
    fn place_nodes(&mut self, roots: Vec<(usize, String)>, tracks: &Tracks) -> Vec<Placed> {
        struct Visit {
            index: usize,
            at: String,
            parent: Option<usize>,
            /// Which of the placed nodes it stands in.
            inside: Option<usize>,
            world: DAffine3,
            visible: bool,
        }
        let root = |(index, at)| Visit {
            index,
            at,
            parent: None,
            inside: None,
            world: DAffine3::IDENTITY,
            visible: true,
        };
        let mut stack: Vec<Visit> = roots.into_iter().rev().map(root).collect();
        let mut parents: Vec<Option<Option<usize>>> = vec![None; self.doc.len("nodes")];
        let (mut placed, mut strays) = (Vec::new(), 0);
        while let Some(visit) = stack.pop() {
            let index = visit.index;
            let Some(raw) = self.doc.raw("nodes", index, &visit.at, &mut self.report) else {
                continue;
            };
            if parents[index].is_some() {
                self.second_visit(index, visit.parent, &parents, &visit.at);
                strays += 1;
                if strays >= MOST_STRAYS {
                    break;
                }
                continue;
            }
            parents[index] = Some(visit.parent);
            let here = format!("nodes[{index}]");
            let Some(node) = self.doc.get::<json::Node>(index, &visit.at, &mut self.report) else {
                continue;
            };
            let Some((local, rest)) = self.local_transform(raw, &node, &here, tracks, index) else {
                continue;
            };
            let hidden =
                extension(raw, "KHR_node_visibility").and_then(|e| e.get("visible")) == Some(&Value::Bool(false));
            let (world, visible) = (visit.world * local, visit.visible && !hidden);
            if let Some(children) = raw.get("children") {
                let children = self.node_list(children, &format!("{here}.children"));
                stack.extend(children.into_iter().rev().map(|(child, at)| Visit {
                    index: child,
                    at,
                    parent: Some(index),
                    inside: Some(placed.len()),
                    world,
                    visible,
                }));
            }
            placed.push(Placed {
                index,
                node,
                parent: visit.inside,
                local,
                rest,
                world,
                visible,
            });
        }
        placed
    }

    /// Reports why a node is met twice: it is its own ancestor, or it has two parents.
    fn second_visit(&mut self, index: usize, parent: Option<usize>, parents: &[Option<Option<usize>>], at: &str) {
        let mut ancestor = parent;
        while let Some(a) = ancestor.filter(|a| *a != index) {
            ancestor = parents.get(a).copied().flatten().flatten();
        }
        let d = match ancestor {
            Some(_) => Diagnostic::error("G0503", format!("node {index} is its own ancestor")),
            None => Diagnostic::error("G0504", format!("node {index} has two parents (or is a root as well)")),
        };
        self.report
            .push(at, d.hint("nodes must form trees: export the model again"));
    }

    /// A node's own transform: its matrix, or translation · rotation · scale. The numbers are taken as written, since
    /// f32 would move what stands far away.
    fn local_transform(
        &mut self,
        raw: &Value,
        node: &json::Node,
        at: &str,
        tracks: &Tracks,
        index: usize,
    ) -> Option<(DAffine3, Option<Rest>)> {
        let mut rest = None;
        let local = match node.matrix {
            Some(rounded) => {
                let m = exact(raw, "matrix").unwrap_or(rounded.map(f64::from));
                if m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0 {
                    let message = "the last row is not 0 0 0 1; it is ignored";
                    let place = format!("{at}.matrix");
                    self.report.mended("G0505", &place, message, Anomaly::MovedValue, 1);
                }
                affine_from_columns(m)
            }
            None => {
                let vector = |key, default| exact(raw, key).map_or(default, DVec3::from_array);
                let [x, y, z, w] = exact(raw, "rotation").unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let rotation = DQuat::from_xyzw(x, y, z, w);
                let unit = rotation.length_recip().is_finite().then(|| rotation.normalize());
                if unit.is_none() {
                    let message = "is no rotation (its length is 0 or not finite); none is applied";
                    let place = format!("{at}.rotation");
                    self.report.mended("G0505", &place, message, Anomaly::MovedValue, 1);
                }
                let (scale, translation) = (vector("scale", DVec3::ONE), vector("translation", DVec3::ZERO));
                let written = rest.insert(Rest {
                    translation,
                    rotation: unit.unwrap_or(DQuat::IDENTITY),
                    scale,
                });
                if tracks.moves(index) {
                    tracks.transform(index, written, self.opening())
                } else {
                    written.transform()
                }
            }
        };
        let reach = local
            .matrix3
            .to_cols_array()
            .into_iter()
            .chain(local.translation.to_array());
        if !reach.map(|v| v as f32).all(f32::is_finite) {
            self.report.error(
                "G0506",
                at,
                "the transform is not finite, or beyond what single precision holds",
            );
            return None;
        }
        Some((local, rest))
    }

    /// Adds what stands at a node; whether joints hold its mesh.
    fn load_node(
        &mut self,
        placed: &Placed,
        (world, later): (&World, &[World]),
        tracks: &Tracks,
        moving: &Moving,
    ) -> bool {
        let mut is_skinned = false;
        let at = format!("nodes[{}]", placed.index);
        let Some(raw) = self.doc.raw("nodes", placed.index, &at, &mut self.report) else {
            return false;
        };
        let name = self.doc.name("nodes", placed.index);
        if let Some(camera) = placed.node.camera {
            self.load_camera(camera.value(), placed.world, name.clone(), &format!("{at}.camera"));
        }
        if let Some(light) = extension(raw, "KHR_lights_punctual") {
            let at = format!("{at}.extensions.KHR_lights_punctual");
            if let Some(index) = index_of(light, "light", &at, &mut self.report) {
                self.load_light(index, placed.world, name.clone(), &format!("{at}.light"));
            }
        }
        if let Some(mesh) = placed.node.mesh {
            let mut pose = Pose {
                weights: self.weights_of(placed, tracks),
                joints: None,
                later: Vec::new(),
            };
            if let Some(skin) = placed.node.skin {
                let skins = self
                    .doc
                    .top("skins")
                    .and_then(|t| t.get(skin.value())?.get("joints")?.as_array());
                if self
                    .afford(Cost::Joints, skins.map_or(0, Vec::len) as u64, &at)
                    .is_none()
                {
                    return false;
                }
                pose.joints = self.joints(skin.value(), world, &format!("{at}.skin"));
            }
            pose.later = self.later_poses(placed, &pose, later, (tracks, moving), &at);
            // A skin places its mesh by its joints alone; the node's own transform is ignored.
            is_skinned = pose.joints.is_some();
            let place = if is_skinned { DAffine3::IDENTITY } else { placed.world };
            let instances = self.instances(raw, &at).unwrap_or_default();
            self.met_meshes.insert(mesh.value());
            let meshes = self.meshes_of(mesh.value(), &pose, &format!("{at}.mesh"));
            let objects = meshes.len() as u64 * instances.len() as u64;
            if self.afford(Cost::Objects, objects, &at).is_none() {
                return is_skinned;
            }
            for &id in meshes.iter() {
                for instance in &instances {
                    let object = Object {
                        name: name.clone(),
                        place: self.report.origin(&at),
                        ..Object::new(Shape::Mesh(id)).transformed(place * *instance)
                    };
                    self.add_object(object, &at);
                }
            }
        }
        is_skinned
    }

    /// Weights of the morph targets, by the animations or the node.
    fn weights_of(&mut self, placed: &Placed, tracks: &Tracks) -> Option<Vec<f32>> {
        let index = placed.index;
        if tracks.has_weights(index) {
            return tracks.weights(index, self.opening());
        }
        placed.node.weights.clone()
    }

    /// Adds an object unless its transform flattens it to nothing or leaves the finite numbers.
    fn add_object(&mut self, object: Object, at: &str) {
        let inverse = object.transform.inverse();
        if object.transform.is_finite() && inverse.is_finite() {
            self.scene.objects.push(object);
        } else {
            let message = "the transform is singular (a scale of 0?); the node is not drawn";
            let d = Diagnostic::note("G0507", message);
            self.report.push(at, d.counting(Anomaly::DroppedShape, 1));
        }
    }

    /// The transforms of `EXT_mesh_gpu_instancing`, or just one that does nothing.
    fn instances(&mut self, raw: &Value, at: &str) -> Option<Vec<DAffine3>> {
        const VEC4: Wanted = Wanted {
            components: &[4],
            normalize: true,
        };
        let Some(attributes) = extension(raw, "EXT_mesh_gpu_instancing").and_then(|e| e.get("attributes")) else {
            return Some(vec![DAffine3::IDENTITY]);
        };
        let at = format!("{at}.extensions.EXT_mesh_gpu_instancing.attributes");
        let mut read = |key: &str, wanted| {
            let index = index_of(attributes, key, &at, &mut self.report);
            index.map(|i| self.floats(i, wanted, &format!("{at}.{key}")))
        };
        let translations = read("TRANSLATION", VEC3).map_or(Some(None), |n| n.map(Some))?;
        let rotations = read("ROTATION", VEC4).map_or(Some(None), |n| n.map(Some))?;
        let scales = read("SCALE", VEC3).map_or(Some(None), |n| n.map(Some))?;
        let counts: Vec<usize> = [&translations, &rotations, &scales]
            .iter()
            .filter_map(|n| n.as_ref().map(|n| n.count()))
            .collect();
        let count = counts.first().copied().unwrap_or(1);
        if counts.iter().any(|c| *c != count) {
            let message = format!("the counts are {counts:?}, expected the same for all");
            self.report.error("G0508", &at, message);
            return None;
        }
        self.afford(Cost::Objects, count as u64, &at)?;
        let vector = |numbers: &Option<std::rc::Rc<super::accessor::Numbers>>, i, default: DVec3| {
            numbers
                .as_ref()
                .map_or(default, |n| DVec3::from_array(n.get::<3>(i, 0.0).map(f64::from)))
        };
        let rotation = |i| {
            let [x, y, z, w] = rotations
                .as_ref()
                .map_or([0.0, 0.0, 0.0, 1.0], |n| n.get::<4>(i, 0.0))
                .map(f64::from);
            let q = DQuat::from_xyzw(x, y, z, w);
            q.length_recip().is_finite().then(|| q.normalize())
        };
        let bad = (0..count).filter(|&i| rotation(i).is_none()).count() as u64;
        if bad > 0 {
            let message =
                format!("{bad} of {count} are no rotations (their length is 0 or not finite); none is applied");
            let place = format!("{at}.attributes.ROTATION");
            self.report.mended("G0505", &place, message, Anomaly::MovedValue, bad);
        }
        let transform = |i| {
            let (scale, translation) = (vector(&scales, i, DVec3::ONE), vector(&translations, i, DVec3::ZERO));
            DAffine3::from_scale_rotation_translation(scale, rotation(i).unwrap_or(DQuat::IDENTITY), translation)
        };
        Some((0..count).map(transform).collect())
    }
}
