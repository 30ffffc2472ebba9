//! Models: each file is loaded once for equal wishes and placed as a group, however often it is drawn.

use super::emit::Emitted;
use super::emit_light::MAX_LIGHTS;
use super::emit_material::Materials;
use crate::diag::{Diagnostic, Diagnostics, Severity, Span};
use crate::lang::ModelRequest;
use crate::lang::desc::{Look, ModelDesc};
use crate::lang::eval::{Interp, nearest};
use crate::scene::{Camera, GroupId, Light, MaterialId, Mesh, MeshId, Object, Scene, Shape};
use glam::DAffine3;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::rc::Rc;

/// Names that a message lists.
const NAMES_TOLD: usize = 12;

/// Models loaded already.
#[derive(Default)]
pub struct Models {
    /// By file and wishes; `None` for one that could not be.
    loaded: HashMap<String, Option<Rc<Loaded>>>,
    /// Groups with some materials replaced, by the group and what replaces what.
    replaced: HashMap<(GroupId, Replacements), GroupId>,
    /// Meshes with some materials replaced.
    meshes: HashMap<(MeshId, Replacements), MeshId>,
}

/// Which material stands for which.
type Replacements = Vec<(MaterialId, MaterialId)>;

/// A model that is in the scene's tables, in its own space.
struct Loaded {
    group: GroupId,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    /// Its materials among the scene's.
    materials: Range<u32>,
}

impl Interp<'_> {
    /// The group of a model; its lamps and cameras are placed.
    pub(super) fn emit_model(
        &mut self,
        m: &ModelDesc,
        to_world: DAffine3,
        out: &mut Scene,
        done: &mut Emitted,
    ) -> Option<GroupId> {
        let key = format!("{:?} {} {}", m.kind, m.path.display(), m.options.key());
        self.named_files.retain(|(_, path, _)| *path != m.path);
        if let Some(i) = self.missing_models.iter().position(|(path, _)| *path == m.path) {
            let missing = self.missing_models[i].1.clone();
            self.missing_models.retain(|(path, _)| *path != m.path);
            self.report(missing);
            done.models.loaded.insert(key.clone(), None);
        }
        if !done.models.loaded.contains_key(&key) {
            let loaded = self.load_model(m, out).map(Rc::new);
            done.models.loaded.insert(key.clone(), loaded);
        }
        let model = done.models.loaded.get(&key)?.clone()?;
        let count = out.lights.len() + out.cameras.len() + model.lights.len() + model.cameras.len();
        if count > MAX_LIGHTS {
            self.fatal("P0602", m.span, format!("more than {MAX_LIGHTS} lamps and cameras"));
            return None;
        }
        if m.lights {
            let placed = model.lights.iter().map(|l| l.clone().transformed(to_world));
            out.lights.extend(placed);
        }
        if m.cameras {
            let placed = model.cameras.iter().map(|c| c.clone().transformed(&to_world));
            out.cameras.extend(placed);
        }
        let replacements = self.replacements(m, &model, out, &mut done.materials)?;
        if replacements.is_empty() {
            return Some(model.group);
        }
        let key = (model.group, replacements);
        if let Some(known) = done.models.replaced.get(&key) {
            return Some(*known);
        }
        let objects = out.groups.get(model.group.index())?.objects.clone();
        let by: BTreeMap<MaterialId, MaterialId> = key.1.iter().copied().collect();
        let objects = objects
            .into_iter()
            .map(|o| done.models.painted(o, &by, &key.1, out))
            .collect();
        let group = out.add_group(objects);
        done.models.replaced.insert(key, group);
        Some(group)
    }

    /// Reads a model into the scene's tables.
    fn load_model(&mut self, m: &ModelDesc, out: &mut Scene) -> Option<Loaded> {
        let request = ModelRequest {
            kind: m.kind,
            path: m.path.clone(),
            options: m.options.clone(),
            span: m.span,
        };
        let mut told = Diagnostics::default();
        let loaded = (self.options.models)(&request, &mut told);
        let refused = told.has_errors();
        if refused {
            for d in told.iter().cloned() {
                self.diags.push(match d.severity {
                    Severity::Error => d.with_context(m.span, "this model"),
                    _ => d,
                });
            }
        } else {
            self.diags.extend(told);
        }
        let Some(mut model) = loaded else {
            if !refused {
                let message = format!("cannot load {}", m.path.display());
                self.error("P0503", m.span, message);
            }
            return None;
        };
        let lamps = out.lights.len();
        let first = out.materials.len() as u32;
        let cameras = std::mem::take(&mut model.cameras);
        let group = out.absorb(model, DAffine3::IDENTITY);
        Some(Loaded {
            group,
            lights: out.lights.split_off(lamps),
            cameras,
            materials: first..out.materials.len() as u32,
        })
    }

    /// What replaces which of a model's materials. `None` if it names one that the model does not have.
    fn replacements(
        &mut self,
        m: &ModelDesc,
        model: &Loaded,
        out: &mut Scene,
        done: &mut Materials,
    ) -> Option<Replacements> {
        let mut all = Replacements::new();
        for (name, at, look) in &m.materials {
            let is_meant = |id: &u32| out.materials.get(*id as usize).is_some_and(|m| m.name == *name);
            let meant: Vec<u32> = model.materials.clone().filter(is_meant).collect();
            if meant.is_empty() {
                self.no_such_material(name, *at, model, out);
                return None;
            }
            let new = self.replacement(look, out, done)?;
            all.extend(meant.into_iter().map(|old| (MaterialId(old), new)));
        }
        Some(all)
    }

    fn replacement(&mut self, look: &Look, out: &mut Scene, done: &mut Materials) -> Option<MaterialId> {
        self.emit_look(look, out, done)
    }

    fn no_such_material(&mut self, name: &str, at: Span, model: &Loaded, out: &Scene) {
        let ids = model.materials.clone();
        let mut names: Vec<&str> = ids
            .filter_map(|id| out.materials.get(id as usize))
            .map(|m| &*m.name)
            .collect();
        names.retain(|name| !name.is_empty());
        names.sort_unstable();
        names.dedup();
        let mut d = Diagnostic::error("P0505", format!("the model draws no material \"{name}\"")).at(at, "");
        if let Some(best) = nearest(name, names.iter().copied()) {
            d = d.hint(format!("did you mean \"{best}\"?"));
        }
        let told: Vec<String> = names.iter().take(NAMES_TOLD).map(|n| format!("\"{n}\"")).collect();
        let rest = if names.len() > told.len() { ", …" } else { "" };
        let d = match told.is_empty() {
            true => d.hint("its materials have no names; a `material` without a name replaces all"),
            false => d.hint(format!("its materials are {}{rest}", told.join(", "))),
        };
        self.report(d);
    }
}

impl Models {
    /// An object of a model with some of its materials replaced. Its mesh is shared unless it has some of them and others
    /// too.
    fn painted(
        &mut self,
        mut object: Object,
        by: &BTreeMap<MaterialId, MaterialId>,
        key: &Replacements,
        out: &mut Scene,
    ) -> Object {
        if let Some(new) = object.material.and_then(|m| by.get(&m)) {
            object.material = Some(*new);
        }
        let Shape::Mesh(id) = object.shape else { return object };
        let Some(mesh) = out.meshes.get(id.index()) else {
            return object;
        };
        let new_of = |slot: &Option<MaterialId>| slot.and_then(|old| by.get(&old).copied());
        let new: Vec<Option<MaterialId>> = mesh.materials.iter().map(new_of).collect();
        match new.as_slice() {
            [] => {}
            none if none.iter().all(Option::is_none) => {}
            [Some(first), rest @ ..] if rest.iter().all(|n| *n == Some(*first)) => {
                object.material = Some(*first);
                object.override_material = true;
            }
            _ => {
                let known = self.meshes.get(&(id, key.clone())).copied();
                let made = match known {
                    Some(known) => known,
                    None => {
                        let materials = mesh.materials.iter().zip(&new).map(|(old, new)| new.or(*old));
                        let materials = materials.collect();
                        let mesh = mesh.clone();
                        out.add_mesh(Mesh { materials, ..mesh })
                    }
                };
                self.meshes.insert((id, key.clone()), made);
                object.shape = Shape::Mesh(made);
            }
        }
        object
    }
}
