//! `pts inspect`: which effects a scene calls for and who calls, what it holds and does not need, how large it is.

mod json;
mod measure;
mod names;
mod pruned;
mod text;

use self::measure::{Measured, Task};
use self::names::Names;
use super::args::InspectArgs;
use super::choices::ReportFormat;
use super::console::Console;
use super::{Exit, plan, scene};
use crate::compile::compile_pruned;
use crate::compile::effects::causes::{self, Effects};
use crate::compile::prune::{Pruned, Reached, Removal, prune};
use crate::diag::{Diagnostics, SourceMap};
use crate::files::{DiskFiles, Files};
use crate::render::kernel::tier::KernelTier;
use crate::render::scene::CompiledScene;
use crate::render::technique::Technique;
use crate::scene::{Place, Scene, SurfaceModel};
use std::io::Write;

/// The error whose time is forecast where nobody names one: that of `render`.
const DEFAULT_GOAL: f64 = 0.03;

/// Runs the command.
pub fn run(args: &InspectArgs) -> Exit {
    let console = Console::new(&args.terminal, None);
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let found = inspect(args, &console, &mut sources, &mut diags);
    console.diagnostics(&diags, &sources);
    let Some(found) = found.filter(|_| !diags.has_errors()) else {
        return Exit::Scene;
    };
    let format = if args.json { ReportFormat::Json } else { args.format };
    let text = match format {
        ReportFormat::Json => format!("{:#}\n", found.json(&sources)),
        ReportFormat::Human => found.text(&sources),
    };
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Ok(()) => Exit::Done,
        Err(_) => Exit::Output,
    }
}

/// What was found.
struct Found {
    name: String,
    size: [u32; 2],
    scene: Scene,
    compiled: CompiledScene,
    effects: Effects,
    /// What was taken out; `None` where nothing may be.
    pruned: Option<Vec<Removal>>,
    opened: Vec<String>,
    hints: Vec<(String, Place)>,
    names: Names,
    /// What rendering it costs, if that was asked for.
    measured: Option<Measured>,
}

fn inspect(args: &InspectArgs, console: &Console, sources: &mut SourceMap, diags: &mut Diagnostics) -> Option<Found> {
    let (files, path) = match scene::open(&args.scene) {
        Ok(opened) => opened,
        Err(error) => {
            console.error(&format!("cannot read standard input: {error}"));
            return None;
        }
    };
    let given = args.resolution.map(|r| [Some(r.width), Some(r.height)]);
    let options = scene::load_options(&args.load, given.unwrap_or_default());
    let mut described = scene::read(&path, &files, &options, sources, diags)?;
    let names = Names::of(&described, &path, &DiskFiles::default()); // apart from what the picture needs
    scene::select_camera(&mut described, &args.view, diags);
    let of_scene = described.defaults.resolution.unwrap_or(plan::DEFAULT_RESOLUTION);
    let size = args.resolution.map_or(of_scene, |r| [r.width, r.height]);
    scene::finish(&mut described, &args.view, size, console, diags);
    let technique = Technique::default();
    let mut pruned = if args.prune.no_prune {
        Pruned::untouched(&described, &files)
    } else {
        prune(&described, &files, diags)
    };
    let what = std::mem::take(&mut pruned.what);
    let effects = causes::of(&pruned.scene, &technique);
    let mut compiled = compile_pruned(pruned, size[0], size[1], &technique, diags)?;
    args.prune.forced().for_each(|effect| effect.force(&mut compiled));
    let measured = match args.measure {
        Some(seconds) => {
            let task = Task {
                scene: &described,
                files: &files,
                effects: effects.iter().collect(),
                size,
                goal: args.error.or(described.defaults.error).unwrap_or(DEFAULT_GOAL),
                seconds,
            };
            match task.run() {
                Ok(measured) => Some(measured),
                Err(stopped) => {
                    console.error(&format!("nothing was measured: {stopped}"));
                    return None;
                }
            }
        }
        None => None,
    };
    Some(Found {
        measured,
        name: args.scene.display().to_string(),
        size,
        effects,
        pruned: (!args.prune.no_prune).then_some(what),
        hints: hints(&described),
        names,
        opened: files.opened().iter().map(|p| p.display().to_string()).collect(),
        scene: described,
        compiled,
    })
}

/// What somebody has written in vain.
fn hints(scene: &Scene) -> Vec<(String, Place)> {
    let mut out = Vec::new();
    let reached = Reached::from(scene).materials;
    for material in reached.iter().filter_map(|id| scene.materials.get(id.index())) {
        if let SurfaceModel::Glass { ior: 1.0, color, .. } = &material.surface
            && color.texture.is_none()
            && color.factor == glam::DVec3::ONE
            && material.interior.is_clear()
            && scene.atmosphere.is_clear()
            && scene.fogs.is_empty()
        {
            let hint = "glass of ior 1 without tint or medium cannot be seen: it only costs time";
            out.push((hint.to_owned(), material.place.clone()));
        }
        if let SurfaceModel::Mix { weight, .. } = &material.surface
            && weight.texture.is_none()
            && (weight.factor == 0.0 || weight.factor == 1.0)
        {
            let hint = format!("a mix by {} is one of its parts alone", weight.factor);
            out.push((hint, material.place.clone()));
        }
    }
    out
}

impl Found {
    fn solids(&self) -> u64 {
        let is_solid = |m: &u32| self.compiled.materials.get(*m as usize).is_some_and(|m| m.interior);
        let objects = self.compiled.geometry.objects().iter();
        objects.filter(|o| o.materials.iter().any(is_solid)).count() as u64
    }

    fn measure(&self) -> Size {
        let geometry = &self.compiled.geometry;
        let meshes = geometry.meshes();
        let images = &self.compiled.textures.images;
        Size {
            objects: geometry.objects().len() as u64,
            triangles: meshes.iter().map(|m| m.triangles.len() as u64).sum(),
            mesh_bytes: geometry.bytes(),
            lights: self.compiled.lights.len() as u64,
            kernel: KernelTier::of(&self.compiled.traits),
            solids: self.solids(),
            meetings: self.compiled.contacts.len() as u64,
            media: self.compiled.media.len() as u64 - 1 + self.compiled.fogs.len() as u64,
            images: images.len() as u64,
            image_bytes: images.iter().map(|i| i.bytes()).sum(),
        }
    }
}

/// How large the compiled scene is.
struct Size {
    objects: u64,
    triangles: u64,
    mesh_bytes: u64,
    lights: u64,
    /// What paths are compiled to watch for.
    kernel: KernelTier,
    /// Objects that light enters.
    solids: u64,
    /// Pairs of them that may touch or lie within each other, as far as their boxes tell.
    meetings: u64,
    /// What fills them and the space between them; fogs.
    media: u64,
    images: u64,
    image_bytes: u64,
}

/// `scene.pts:41:3`, a path in a model, or nothing.
fn place(place: &Place, sources: &SourceMap) -> Option<String> {
    match place {
        Place::None => None,
        Place::Text(span) => Some(sources.place(*span)),
        Place::Model(path) => Some(path.clone()),
    }
}
