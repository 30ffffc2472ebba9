//! Which effects a scene has, and who calls for each.
//!
//! Read from the description, which knows names and places. What nothing drawn refers to does not count. Every object
//! that calls for an effect is a cause of it, so that a scene without any of the causes does not have the effect; a
//! match over all surface models makes sure that no new one is forgotten.

use super::leave_out::{has_coat, passes};
use super::receivers::Receivers;
use super::{Effect, Effect::*, image_inputs};
use crate::render::technique::Technique;
use crate::scene::{
    Camera, EnvironmentKind, Material, MaterialId, Medium, Object, OpacityMode, Place, Principled, Scene, Shape,
    SurfaceModel, Texture, TextureId,
};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Products nested deeper than this contain themselves; `compile` refuses them.
const DEEPEST: u32 = 64;

/// Who calls for an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// What it is: `sphere "ball"`, `the camera`.
    pub what: String,
    /// Why it calls for the effect: `glass of ior 1.5`.
    pub why: String,
    /// Where it was written.
    pub place: Place,
    /// How often it is drawn.
    pub times: u64,
}

/// The effects of a scene with their causes, in the order of [`Effect::ALL`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects {
    found: BTreeMap<Effect, Callers>,
}

/// Who calls for one effect.
#[derive(Clone, Debug, Default)]
struct Callers {
    causes: Vec<Cause>,
    /// Places in `causes` by the hash of all but the number of times: there may be a million.
    known: HashMap<u64, usize>,
}

impl PartialEq for Callers {
    fn eq(&self, other: &Callers) -> bool {
        self.causes == other.causes
    }
}

impl Effects {
    /// Whether the scene has it.
    pub fn has(&self, effect: Effect) -> bool {
        self.found.contains_key(&effect)
    }

    /// Who calls for it; nobody if the scene does not have it.
    pub fn causes(&self, effect: Effect) -> &[Cause] {
        self.found.get(&effect).map_or(&[], |callers| &callers.causes)
    }

    /// The effects that the scene has.
    pub fn iter(&self) -> impl Iterator<Item = Effect> + '_ {
        self.found.keys().copied()
    }

    pub(super) fn add(&mut self, effect: Effect, cause: Cause) {
        let Callers { causes, known } = self.found.entry(effect).or_default();
        let mut hasher = DefaultHasher::new();
        (&cause.what, &cause.why, &cause.place).hash(&mut hasher);
        let place = *known.entry(hasher.finish()).or_insert(causes.len());
        let is_same = |c: &&mut Cause| (&c.what, &c.why, &c.place) == (&cause.what, &cause.why, &cause.place);
        match causes.get_mut(place).filter(is_same) {
            Some(again) => again.times += cause.times,
            None => causes.push(cause),
        }
    }
}

/// The effects of a scene that is rendered by a technique.
pub fn of(scene: &Scene, technique: &Technique) -> Effects {
    let mut effects = Effects::default();
    let mut seen = Receivers::default();
    for (object, material) in drawn(scene) {
        let what = name(&object.shape, &object.name);
        let mut add = |effect: Effect, why: String| {
            let place = object.place.clone();
            let cause = Cause {
                what: what.clone(),
                why,
                place,
                times: 1,
            };
            effects.add(effect, cause);
        };
        let fallback = Material::diffuse(glam::DVec3::splat(0.8));
        let m = material
            .and_then(|m| scene.materials.get(m.index()))
            .unwrap_or(&fallback);
        let parts = parts(scene, m);
        of_whole(scene, m, &parts, &mut add);
        parts.iter().for_each(|part| of_part(scene, part, &mut add));
        seen.look_at(m, &parts, &what, object);
    }
    of_camera(scene, &mut effects);
    of_air(scene, &mut effects, &mut seen);
    super::motion::of_scene(scene, &mut |cause| effects.add(Motion, cause));
    of_environment(scene, &mut effects, &mut seen);
    seen.conclude(scene, technique, &mut effects);
    effects
}

/// What is drawn with which material, each pair once. Materials are inherited as `compile` does.
fn drawn(scene: &Scene) -> Vec<(&Object, Option<MaterialId>)> {
    type Inherited = (Option<MaterialId>, Option<MaterialId>);
    let mut out: Vec<(&Object, Option<MaterialId>)> = Vec::new();
    let mut done: BTreeSet<(usize, Inherited)> = BTreeSet::new();
    let mut queue: Vec<(&Object, Inherited)> = scene.objects.iter().rev().map(|o| (o, (None, None))).collect();
    while let Some((object, (outer, forced))) = queue.pop() {
        let own = object.material.or(outer);
        let forced = forced.or(object.material.filter(|_| object.override_material));
        // Objects live in the scene's tables, so that their address tells them apart.
        if !done.insert((std::ptr::from_ref(object) as usize, (own, forced))) {
            continue;
        }
        let pick = |m: Option<MaterialId>| forced.or(m).or(own).or(scene.default_material);
        match &object.shape {
            Shape::Group(id) => {
                let inside = scene
                    .groups
                    .get(id.index())
                    .into_iter()
                    .flat_map(|g| g.objects.iter().rev());
                queue.extend(inside.map(|o| (o, (own, forced))));
            }
            Shape::Mesh(id) => {
                let slots = scene.meshes.get(id.index()).map_or(&[][..], |m| &m.materials);
                let mut used: Vec<_> = slots.iter().map(|m| pick(*m)).collect();
                used.extend(slots.is_empty().then(|| pick(None)));
                used.sort();
                used.dedup();
                out.extend(used.into_iter().map(|m| (object, m)));
            }
            _ => out.push((object, pick(None))),
        }
    }
    out
}

/// `sphere`.
pub fn kind_of(shape: &Shape) -> &'static str {
    match shape {
        Shape::Sphere { .. } => "sphere",
        Shape::Plane { .. } => "plane",
        Shape::Box { .. } => "box",
        Shape::Cone {
            base_radius,
            cap_radius,
            ..
        } if base_radius == cap_radius => "cylinder",
        Shape::Cone { .. } => "cone",
        Shape::Disc { .. } => "disc",
        Shape::Torus { .. } => "torus",
        Shape::Triangle { .. } => "triangle",
        Shape::Mesh(_) => "mesh",
        Shape::Group(_) => "group",
    }
}

/// `sphere "ball"`.
pub(super) fn name(shape: &Shape, name: &str) -> String {
    let word = kind_of(shape);
    if name.is_empty() {
        word.to_owned()
    } else {
        format!("{word} \"{name}\"")
    }
}

/// The material itself and, of a mixture, all parts that may be seen, each once.
fn parts<'s>(scene: &'s Scene, m: &'s Material) -> Vec<&'s Material> {
    let (mut found, mut known) = (vec![m], BTreeSet::new());
    let mut next = 0;
    while let Some(part) = found.get(next).copied() {
        next += 1;
        let SurfaceModel::Mix { a, b, weight } = &part.surface else {
            continue;
        };
        let constant = weight.constant();
        let seen = [(a, constant != Some(1.0)), (b, constant != Some(0.0))];
        for (id, _) in seen.into_iter().filter(|(id, seen)| *seen && known.insert(**id)) {
            found.extend(scene.materials.get(id.index()));
        }
    }
    found
}

fn of_part(scene: &Scene, m: &Material, add: &mut dyn FnMut(Effect, String)) {
    let inputs = image_inputs(m).into_iter();
    let images: BTreeSet<String> = inputs.filter_map(|t| image_behind(scene, t, 0)).collect();
    images
        .into_iter()
        .for_each(|image| add(Textures, format!("image \"{image}\"")));
    match &m.surface {
        SurfaceModel::Black | SurfaceModel::Diffuse { .. } => {}
        SurfaceModel::Specular { .. } => add(Specular, "mirror".to_owned()),
        SurfaceModel::Glass {
            ior, roughness, abbe, ..
        } => {
            let rough = if roughness.most() > 0.0 { "rough glass" } else { "glass" };
            // By itself an index of 1 bends nothing.
            if *ior != 1.0 {
                add(Glass, format!("{rough} of ior {ior}"));
            }
            if let Some(v) = abbe.filter(|_| *ior != 1.0) {
                add(Dispersion, format!("Abbe number {v}"));
            }
        }
        SurfaceModel::Glossy { roughness, metal, .. } => {
            let what = if *metal { "metal" } else { "coat" };
            add(Glossy, format!("{what} of roughness {}", roughness.most()));
        }
        SurfaceModel::Translucent { transmit, .. } => {
            if transmit.most() > 0.0 {
                add(Translucent, format!("transmits {}", transmit.most()));
            }
        }
        SurfaceModel::Principled(p) => {
            of_principled(p, add);
        }
        SurfaceModel::Finish(f) => {
            if f.phong > 0.0 || f.specular > 0.0 {
                add(Glossy, "highlight".to_owned());
            }
            if f.reflection.is_some_and(|r| r.max.max(r.min).max_element() > 0.0) {
                add(Specular, "reflection".to_owned());
            }
            match f.ior.filter(|ior| *ior != 1.0 && passes(f)) {
                Some(ior) => {
                    add(Glass, format!("transparent, ior {ior}"));
                    if f.dispersion > 0.0 {
                        add(Dispersion, format!("Abbe number {:.1}", 20.0 / f.dispersion));
                    }
                }
                None if passes(f) => add(Alpha, "transparent without ior".to_owned()),
                None => {}
            }
            if f.diffuse_back > 0.0 {
                add(Translucent, format!("diffuse {} on the far side", f.diffuse_back));
            }
        }
        SurfaceModel::Mix { .. } => {} // its parts are looked at themselves
    }
}

/// What a material does as a whole: bend normals, leave holes, fill the inside. Normals and coverage of a mixture's parts
/// are not looked at.
fn of_whole(scene: &Scene, m: &Material, parts: &[&Material], add: &mut dyn FnMut(Effect, String)) {
    if let Some(map) = m.normal_map.filter(|n| n.scale != 0.0)
        && let Some(image) = image_behind(scene, map.texture, 0)
    {
        add(Bump, format!("normal map \"{image}\""));
    }
    if let Some(map) = m.bump_map.filter(|b| b.scale != 0.0)
        && let Some(image) = image_behind(scene, map.texture, 0)
    {
        add(Bump, format!("height map \"{image}\""));
    }
    let a = &m.opacity.alpha;
    if m.opacity.mode != OpacityMode::Opaque && (a.texture.is_some() || a.most() < 1.0) {
        add(Alpha, "coverage below 1".to_owned());
    }
    let media = filled(m, parts).into_iter();
    media.flat_map(doings).for_each(|does| add(Media, does.to_owned()));
}

/// The media that fill a solid of this material where light gets in. A mixture is filled as a whole, or as its parts are.
pub(super) fn filled<'s>(m: &'s Material, parts: &[&'s Material]) -> Vec<&'s Medium> {
    let open: Vec<&Material> = parts.iter().copied().filter(|part| lets_in(&part.surface)).collect();
    if !open.is_empty() && !m.interior.is_clear() {
        return vec![&m.interior];
    }
    open.into_iter().map(|part| &part.interior).collect()
}

/// Whether light gets into a solid of this surface, so that what fills it matters.
fn lets_in(surface: &SurfaceModel) -> bool {
    match surface {
        SurfaceModel::Glass { .. } => true,
        SurfaceModel::Principled(p) => p.thick && (p.transmission.most() > 0.0 || p.diffuse_transmission.most() > 0.0),
        SurfaceModel::Finish(f) => passes(f),
        SurfaceModel::Black
        | SurfaceModel::Diffuse { .. }
        | SurfaceModel::Specular { .. }
        | SurfaceModel::Glossy { .. }
        | SurfaceModel::Translucent { .. }
        | SurfaceModel::Mix { .. } => false,
    }
}

/// What a medium does.
fn doings(m: &Medium) -> impl Iterator<Item = &'static str> + use<> {
    let all = [
        ("absorption", m.absorption),
        ("scattering", m.scattering),
        ("emission", m.emission),
    ];
    all.into_iter()
        .filter(|(_, v)| v.max_element() > 0.0)
        .map(|(does, _)| does)
}

fn of_principled(p: &Principled, add: &mut dyn FnMut(Effect, String)) {
    let is_rough_metal = p.metallic.most() > 0.0 && p.roughness.most() > 0.0;
    let is_layered = p.clearcoat.most() > 0.0 || p.sheen_color.factor.max_element() > 0.0;
    if has_coat(p) || is_rough_metal || is_layered {
        add(Glossy, format!("principled, roughness {}", p.roughness.most()));
    }
    if p.metallic.most() > 0.0 && !is_rough_metal {
        add(Specular, "smooth metal".to_owned());
    }
    if p.transmission.most() > 0.0 && p.ior != 1.0 {
        add(Glass, format!("transmission {}, ior {}", p.transmission.most(), p.ior));
        if p.dispersion > 0.0 && p.thick && p.ior != 1.0 {
            add(Dispersion, format!("dispersion {}", p.dispersion));
        }
    }
    if p.diffuse_transmission.most() > 0.0 {
        add(
            Translucent,
            format!("diffuse transmission {}", p.diffuse_transmission.most()),
        );
    }
}

/// The name of an image behind a texture; products may be nested.
fn image_behind(scene: &Scene, texture: TextureId, depth: u32) -> Option<String> {
    match scene.textures.get(texture.index())? {
        Texture::Image(image) => {
            let image = scene.images.get(image.image.index())?;
            Some(image.name.clone())
        }
        Texture::Product(a, b) if depth < DEEPEST => {
            image_behind(scene, *a, depth + 1).or_else(|| image_behind(scene, *b, depth + 1))
        }
        _ => None,
    }
}

fn of_camera(scene: &Scene, effects: &mut Effects) {
    let radius = |c: &Camera| c.motion.iter().map(|key| key.lens_radius).fold(c.lens_radius, f64::max);
    if let Some(camera) = scene.camera().filter(|c| radius(c) > 0.0) {
        effects.add(
            Lens,
            Cause {
                what: "the camera".to_owned(),
                why: format!("lens of radius {}", radius(camera)),
                place: camera.place.clone(),
                times: 1,
            },
        );
    }
}

/// The atmosphere and the fogs in it.
fn of_air(scene: &Scene, effects: &mut Effects, seen: &mut Receivers) {
    let mut add = |what: &str, why: String, place: &Place| {
        let cause = Cause {
            what: what.to_owned(),
            why,
            place: place.clone(),
            times: 1,
        };
        effects.add(Media, cause);
    };
    for does in doings(&scene.atmosphere) {
        add("the atmosphere", does.to_owned(), &scene.atmosphere_place);
    }
    for fog in &scene.fogs {
        let kind = if fog.ground.is_some() {
            "fog on the ground"
        } else {
            "fog"
        };
        add("the air", format!("{kind} of distance {}", fog.distance), &fog.place);
    }
    seen.look_into(&scene.atmosphere, "the atmosphere", &scene.atmosphere_place);
}

fn of_environment(scene: &Scene, effects: &mut Effects, seen: &mut Receivers) {
    let why = match &scene.environment.kind {
        EnvironmentKind::Constant(c) if c.max_element() > 0.0 => "one colour everywhere".to_owned(),
        EnvironmentKind::Image { image, strength, .. } if *strength > 0.0 => {
            let name = scene.images.get(image.index()).map_or("", |i| i.name.as_str());
            format!("image \"{name}\"")
        }
        EnvironmentKind::Black | EnvironmentKind::Constant(_) | EnvironmentKind::Image { .. } => return,
    };
    if !scene.environment.illuminates {
        return;
    }
    let cause = Cause {
        what: "the environment".to_owned(),
        why,
        place: scene.environment.place.clone(),
        times: 1,
    };
    // A sky of one colour throws no caustics: it looks the same along any way.
    match scene.environment.kind {
        EnvironmentKind::Image { .. } => seen.lights.push(cause.clone()),
        _ => seen.even_sky = Some(cause.clone()),
    }
    effects.add(Environment, cause);
}
