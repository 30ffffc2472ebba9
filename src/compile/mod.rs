//! From the description to the engine: only here are both known.
//!
//! First the description is pruned ([`prune`]). Then the camera becomes the origin; groups are flattened; shapes,
//! materials, textures, images and lights that are used are turned into the engine's tables. What nothing uses is not
//! decoded and not built.

mod camera;
mod caps;
pub mod effects;
mod flatten;
mod images;
mod lights;
mod loose;
mod materials;
mod media;
mod motion;
mod objects;
pub mod prune;
mod winding;

use crate::diag::{Diagnostic, Diagnostics};
use crate::files::Files;
use crate::render::geometry::{GeomObject, Geometry};
use crate::render::light::{Light, LightSet};
use crate::render::material::{Alpha, Material, SurfaceModel};
use crate::render::ray::ray_mask;
use crate::render::scene::{CompiledScene, SceneTraits};
use crate::render::technique::Technique;
use crate::render::texture::Textures;
use crate::scene::{MaterialId, Place, Scene, Shape};
use glam::Vec3;
use images::Images;
use prune::Pruned;

/// Makes a scene ready to render at this size by the default technique. `None` if there are errors. Images are read
/// through `files`, only those that something visible uses.
pub fn compile(
    scene: &Scene,
    files: &dyn Files,
    width: u32,
    height: u32,
    diags: &mut Diagnostics,
) -> Option<CompiledScene> {
    compile_with(scene, files, width, height, &Technique::default(), diags)
}

/// As [`compile`], for a technique: [`prune::prune`], then [`compile_pruned`].
pub fn compile_with(
    scene: &Scene,
    files: &dyn Files,
    width: u32,
    height: u32,
    technique: &Technique,
    diags: &mut Diagnostics,
) -> Option<CompiledScene> {
    let pruned = prune::prune(scene, files, diags);
    compile_pruned(pruned, width, height, technique, diags)
}

/// As [`compile`], for a scene that is pruned already, or left as it was written ([`Pruned::untouched`]), and for a
/// technique: how lights are chosen, how the tree is built, what approximations materials use and
/// how images are looked up is decided here. Render with the same technique, which decides the rest.
pub fn compile_pruned(
    pruned: Pruned<'_>,
    width: u32,
    height: u32,
    technique: &Technique,
    diags: &mut Diagnostics,
) -> Option<CompiledScene> {
    let scene: &Scene = &pruned.scene;
    let mut images: Images<'_> = pruned.images;
    let errors = |d: &Diagnostics| d.count(crate::diag::Severity::Error);
    let before = errors(diags);
    let Some(camera) = scene.camera() else {
        diags.push(
            Diagnostic::error("C0202", "the scene has no camera")
                .hint("add `camera { location <0, 1, -5> look_at <0, 0, 0> }`"),
        );
        return None;
    };
    let origin = camera.location;
    let engine_camera = camera::compile_camera(camera, width, height, diags);
    let mut leaves = flatten::leaves(scene, diags);
    // Of surfaces in one place the first counts: a lamp set into a ceiling is seen, not the ceiling.
    leaves.sort_by_key(|leaf| !materials_of(scene, leaf).any(|id| emits(scene, id)));
    if leaves.is_empty() && matches!(scene.environment.kind, crate::scene::EnvironmentKind::Black) {
        diags.push(Diagnostic::warning(
            "C0105",
            "nothing to draw: the scene has no objects and no environment",
        ));
    }

    let (environment, backdrop) = lights::environment(scene, &mut images, diags);
    let used = leaves.iter().flat_map(|leaf| materials_of(scene, leaf));
    images.decode_all(&materials::images_of(scene, used), diags);

    let mut lamps = lights::lamps(scene, origin, diags);
    lamps.extend(environment);
    let mut materials = materials::Materials::new(scene, &mut images, technique);
    let mut objects = objects::Objects::new(scene, origin, &mut materials, lamps);
    for leaf in &leaves {
        objects.add(leaf, diags);
    }
    objects.finish(diags);
    let (objects, meshes, mut lights) = (objects.objects, objects.meshes, objects.lights);
    let atmosphere = materials.media.add_atmosphere(scene, diags);
    let (materials, media, nodes) = (materials.materials, materials.media.table, materials.nodes);
    if errors(diags) > before {
        return None;
    }
    // A wall that no shadow ray meets hides nothing of a lamp, and one that moves does not hide it always.
    let hides = |o: &&GeomObject| o.visibility & ray_mask::SHADOW != 0 && o.motion.is_none();
    caps::cut_by_walls(
        &mut lights,
        objects.iter().filter(hides).map(|o| &o.shape),
        glam::DVec3::ZERO,
    );
    let geometry = Geometry::build_as(technique.build, objects, meshes);
    let lights = LightSet::with_pick(lights, technique.lights, geometry.bounds());
    let fogs = media::fogs(scene, origin);
    let traits = SceneTraits {
        see_through: materials.iter().any(is_see_through),
        lamp_through_glass: lights.has_delta() && materials.iter().any(|m| m.interior),
        solids: materials.iter().any(|m| m.interior),
        media: media.len() > 1 || !fogs.is_empty(),
        dispersion: materials.iter().any(|m| m.dispersion > 0.0),
        moves: engine_camera.as_ref().is_some_and(|c| c.moves())
            || geometry.objects().iter().any(|o| o.motion.is_some())
            || (0..lights.len() as u32).any(|i| matches!(lights.get(i), Some(Light::Moving(_)))),
    };
    Some(CompiledScene {
        contacts: contacts(&geometry, &materials),
        origin,
        camera: engine_camera?,
        geometry,
        media,
        atmosphere,
        fogs,
        materials,
        textures: Textures {
            nodes,
            images: images.into_data(),
        },
        lights,
        backdrop,
        traits,
    })
}

/// The boxes in which the boxes of two solids that refract or absorb meet; of very many, one around all solids.
fn contacts(geometry: &Geometry, materials: &[Material]) -> Vec<(Vec3, Vec3)> {
    const MOST: usize = 32;
    const EVERYWHERE: (Vec3, Vec3) = (Vec3::NEG_INFINITY, Vec3::INFINITY);
    let is_solid = |m: &u32| materials.get(*m as usize).is_some_and(|m| m.interior);
    let solids = (0u32..)
        .zip(geometry.objects())
        .filter(|(_, o)| o.materials.iter().any(is_solid));
    let boxes: Vec<_> = solids
        .map(|(i, _)| geometry.bounds_of(i).unwrap_or(EVERYWHERE))
        .collect();
    let mut common = Vec::new();
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[..i] {
            let (min, max) = (a.0.max(b.0), a.1.min(b.1));
            if min.cmple(max).all() {
                common.push((min, max));
            }
            if common.len() > MOST {
                let around = |x: (Vec3, Vec3), y: &(Vec3, Vec3)| (x.0.min(y.0), x.1.max(y.1));
                return vec![boxes.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), around)];
            }
        }
    }
    common
}

/// The materials a leaf may show.
fn materials_of<'a>(scene: &'a Scene, leaf: &flatten::Leaf<'_>) -> impl Iterator<Item = MaterialId> + use<'a> {
    let own = leaf.override_material.or(leaf.material).or(scene.default_material);
    let mesh = match leaf.object.shape {
        Shape::Mesh(id) if leaf.override_material.is_none() => scene.meshes.get(id.index()),
        _ => None,
    };
    let slots = mesh.into_iter().flat_map(|m| m.materials.iter().copied().flatten());
    own.into_iter().chain(slots)
}

fn emits(scene: &Scene, id: MaterialId) -> bool {
    let emission = scene.materials.get(id.index()).map(|m| &m.emission);
    emission.is_some_and(|e| e.factor != glam::DVec3::ZERO)
}

/// Whether light may pass a material unbent.
fn is_see_through(m: &Material) -> bool {
    let alpha = !matches!(m.alpha, Alpha::Opaque);
    alpha
        || m.unlit
        || match &m.surface {
            // Also with an ior: inside a medium of the same index nothing is bent.
            SurfaceModel::Finish(f) => f.filter > 0.0 || f.transmit > 0.0,
            SurfaceModel::Principled(p) => !p.transmission.is_nothing() && !p.thick,
            SurfaceModel::Black
            | SurfaceModel::Diffuse { .. }
            | SurfaceModel::Specular { .. }
            | SurfaceModel::Glass { .. }
            | SurfaceModel::Glossy { .. }
            | SurfaceModel::Translucent { .. }
            | SurfaceModel::Mix { .. } => false, // the parts of a mix are materials themselves
        }
}

/// Adds a place of the description to a diagnostic.
fn at_place(d: Diagnostic, place: &Place) -> Diagnostic {
    match place {
        Place::None => d,
        Place::Text(span) => d.at(*span, ""),
        Place::Model(path) => d.in_place(path.clone()),
    }
}
