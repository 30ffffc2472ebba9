//! From the description to the IR: what the scene reaches is converted, once for each shared thing. What cannot be drawn
//! is an error here, and only here.

use super::emit_material::Materials;
use super::emit_model::Models;
use crate::diag::Diagnostic;
use crate::lang::desc::{Look, ObjectDesc, ShapeDesc};
use crate::lang::eval::Interp;
use crate::scene::{GroupId, ImageSource, LeftOut, MeshId, Object, Place, Scene, Shape};
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

/// Objects of one scene, those of unions counted as often as they are placed.
const MAX_PLACED: u64 = 1 << 32;

/// What was converted already, by the address of its description (which is kept alive by the scene's).
#[derive(Default)]
pub struct Emitted {
    pub(super) groups: HashMap<*const (), (GroupId, bool)>,
    meshes: HashMap<*const (), Option<MeshId>>,
    pub(super) models: Models,
    pub(super) materials: Materials,
}

impl Interp<'_> {
    /// Converts all that the scene reaches. Errors are reported.
    pub fn emit(&mut self) -> Scene {
        let mut out = Scene {
            display_is_linear: self.display_is_linear(),
            defaults: self.scene.defaults.clone(),
            ..Scene::default()
        };
        let mut done = Emitted::default();
        let default = Look {
            layers: Some(Rc::new([self.default_layer()])),
            ..Look::default()
        };
        let objects = std::mem::take(&mut self.scene.objects);
        let placed = objects.iter().fold(0u64, |n, o| n.saturating_add(o.leaves));
        if let (true, Some(largest)) = (placed > MAX_PLACED, objects.iter().max_by_key(|o| o.leaves)) {
            let message = format!("the scene places {placed} objects, at most {MAX_PLACED} are drawn");
            self.fatal("P0602", largest.span, message);
            return out;
        }
        for object in &objects {
            if let Some(o) = self.emit_object(object, DAffine3::IDENTITY, &mut out, &mut done) {
                out.objects.push(o);
            }
        }
        let mut known = vec![None; out.groups.len()];
        if out.objects.iter().any(|o| !has_own_material(o, &out, &mut known)) {
            out.default_material = self.emit_look(&default, &mut out, &mut done.materials);
            self.warn_black_default(&objects);
        }
        if let Some(camera) = self.scene.camera.clone().or(self.scene.default_camera.clone())
            && let Ok(camera) = self.final_camera(&camera)
        {
            out.cameras.insert(0, camera);
        }
        // The scene's own camera, else the first one of its models.
        out.active_camera = (!out.cameras.is_empty()).then_some(0);
        self.emit_environment(&mut out);
        let media = std::mem::take(&mut self.scene.media);
        out.atmosphere = self.medium_of(&media);
        let first = media.iter().find(|m| !m.is_clear());
        out.atmosphere_place = first.map_or(Place::None, |m| Place::Text(m.span));
        self.emit_fogs(&mut out);
        out.left_out.extend(self.take_unread());
        self.emit_left_out(&mut out);
        for (path, mut missing) in std::mem::take(&mut self.missing_models) {
            missing.severity = crate::diag::Severity::Note;
            missing.message = format!("\"{}\" is not there, but nothing drawn needs it", path.display());
            self.report(missing);
        }
        out
    }

    /// Lists the files that the text names and nothing drawn asks for.
    fn emit_left_out(&mut self, out: &mut Scene) {
        let shown = |path: &PathBuf| out.images.iter().any(|i| i.source == ImageSource::File(path.clone()));
        let idle = std::mem::take(&mut self.named_files).into_iter();
        let idle = idle
            .filter(|(_, path, _)| !shown(path))
            .map(|(kind, file, span)| LeftOut {
                kind,
                name: file.display().to_string(),
                why: "nothing drawn shows it".to_owned(),
                bytes: 0,
                file: Some(file),
                place: Place::Text(span),
            });
        let idle: Vec<LeftOut> = idle.collect();
        out.left_out.extend(idle);
    }

    fn warn_black_default(&mut self, objects: &[Rc<ObjectDesc>]) {
        if self.scene_version >= 3.8
            || self
                .scene
                .default_layer
                .as_ref()
                .is_some_and(|l| l.pigment.color[..3] != [0.0; 3])
        {
            return;
        }
        let bare = objects.iter().find(|o| o.look.is_bare() && is_primitive(&o.shape));
        if let Some(object) = bare {
            let d =
                Diagnostic::warning("P0318", "object has no texture and is black, as in POV-Ray").at(object.span, "");
            self.report(d.hint("give it a `pigment { … }` or a `material { … }`"));
        }
    }

    fn emit_object(
        &mut self,
        object: &ObjectDesc,
        parent: DAffine3,
        out: &mut Scene,
        done: &mut Emitted,
    ) -> Option<Object> {
        let to_world = parent * object.transform;
        let mut transform = object.transform;
        let mut override_material = false;
        let shape = match &object.shape {
            ShapeDesc::Primitive(shape) => (**shape).clone(),
            ShapeDesc::Mesh(mesh) => Shape::Mesh(self.emit_mesh(mesh, out, done)?),
            ShapeDesc::Union(children) => Shape::Group(self.emit_union(children, to_world, out, done)?),
            ShapeDesc::Light(light) => {
                self.emit_light(light, to_world, out);
                let shown = light.looks_like.as_ref()?;
                // The thing a lamp looks like stands at the lamp and does not shade it.
                let place = object.transform * DAffine3::from_translation(light.position);
                let mut o = self.emit_object(shown, parent * place, out, done)?;
                o.transform = place * o.transform;
                o.visibility.shadow = false;
                return Some(o);
            }
            ShapeDesc::Model(model) => {
                // Models are right-handed: mirrored, they look as their author meant.
                let mirror = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
                override_material = true;
                transform *= mirror;
                Shape::Group(self.emit_model(model, to_world * mirror, out, done)?)
            }
            ShapeDesc::Unsupported(word) => {
                let message = format!("`{word}` is not supported yet");
                let d = Diagnostic::error("P0404", message).at(object.span, "drawn from here");
                self.report(d);
                return None;
            }
        };
        if !crate::lang::transform::is_invertible(&to_world) {
            self.error(
                "P0310",
                object.span,
                "transforms leave the range of numbers: the object vanishes or is infinite",
            );
            return None;
        }
        let material = if object.look.is_bare() && object.look.interior.is_none() {
            None
        } else {
            self.emit_look(&object.look, out, &mut done.materials)
        };
        if let (ShapeDesc::Primitive(shape), Some(id)) = (&object.shape, material) {
            self.warn_without_coordinates(shape, id, object.span, out);
        }
        Some(Object {
            shape,
            transform,
            motion: Vec::new(),
            override_material: override_material && material.is_some(),
            material,
            visibility: object.visibility,
            name: String::new(),
            place: Place::Text(object.span),
        })
    }

    fn emit_mesh(
        &mut self,
        desc: &Rc<crate::lang::desc::MeshDesc>,
        out: &mut Scene,
        done: &mut Emitted,
    ) -> Option<MeshId> {
        let key = Rc::as_ptr(desc).cast::<()>();
        if let Some(&known) = done.meshes.get(&key) {
            return known;
        }
        let mut mesh = desc.mesh.clone();
        if !desc.looks.is_empty() {
            mesh.materials.push(None);
            for look in &desc.looks {
                let material = self.emit_look(look, out, &mut done.materials);
                mesh.materials.push(material);
            }
        }
        let id = out.add_mesh(mesh);
        done.meshes.insert(key, Some(id));
        Some(id)
    }

    /// A union becomes a group, once however often it is placed; lamps inside are placed each time.
    fn emit_union(
        &mut self,
        children: &Rc<[Rc<ObjectDesc>]>,
        to_world: DAffine3,
        out: &mut Scene,
        done: &mut Emitted,
    ) -> Option<GroupId> {
        let key = children.as_ptr().cast::<()>();
        let known = done.groups.get(&key).copied();
        if let Some((id, has_lamps)) = known {
            if has_lamps {
                self.emit_lamps(children, to_world, out, done);
            }
            return Some(id);
        }
        let before = (out.lights.len(), out.cameras.len());
        let mut objects = Vec::with_capacity(children.len());
        for child in children.iter() {
            if let Some(o) = self.emit_object(child, to_world, out, done) {
                objects.push(o);
            }
        }
        let id = out.add_group(objects);
        done.groups
            .insert(key, (id, (out.lights.len(), out.cameras.len()) != before));
        Some(id)
    }
}

fn is_primitive(shape: &ShapeDesc) -> bool {
    matches!(shape, ShapeDesc::Primitive(_) | ShapeDesc::Mesh(_))
}

/// Whether every surface of an object has a material of its own. `known` remembers groups: one may be placed often.
fn has_own_material(object: &Object, scene: &Scene, known: &mut [Option<bool>]) -> bool {
    if object.material.is_some() {
        return true;
    }
    match object.shape {
        Shape::Group(g) => {
            if let Some(Some(k)) = known.get(g.index()) {
                return *k;
            }
            let objects = scene.groups.get(g.index()).map_or(&[][..], |g| &g.objects);
            let all = objects.iter().all(|o| has_own_material(o, scene, known));
            if let Some(k) = known.get_mut(g.index()) {
                *k = Some(all);
            }
            all
        }
        Shape::Mesh(m) => scene.meshes.get(m.index()).is_some_and(|m| {
            !m.materials.is_empty() && (0..m.triangles.len()).all(|f| m.slot_material(m.slot(f)).is_some())
        }),
        _ => false,
    }
}
