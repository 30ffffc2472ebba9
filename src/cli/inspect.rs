//! `pts inspect`: which effects a scene calls for and who calls, what it holds and does not need, how large it is.

use super::args::InspectArgs;
use super::choices::ReportFormat;
use super::console::Console;
use super::{Exit, plan, scene};
use crate::compile::effects::Effect;
use crate::compile::effects::causes::{self, Cause, Effects};
use crate::compile::{compile_with, unused};
use crate::diag::{Diagnostics, SourceMap};
use crate::files::Files;
use crate::math::words::{bytes, grouped};
use crate::render::scene::CompiledScene;
use crate::render::technique::Technique;
use crate::scene::{Place, Scene, SurfaceModel};
use serde_json::{Value, json};
use std::io::Write;

/// Causes of an effect that are told by name; the others are counted.
const CAUSES_TOLD: usize = 3;

/// Things not needed that are told by name, of each kind.
const UNUSED_TOLD: usize = 5;

/// Runs the command.
pub fn run(args: &InspectArgs) -> Exit {
    let console = Console::new(&args.terminal, None);
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let found = inspect(args, &console, &mut sources, &mut diags);
    console.diagnostics(&diags, &sources);
    let Some(found) = found.filter(|_| !diags.has_errors()) else {
        return Exit::Scene;
    };
    let text = match args.format {
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
    unused: Vec<unused::Unused>,
    opened: Vec<String>,
    hints: Vec<(String, Place)>,
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
    scene::select_camera(&mut described, &args.view, diags);
    let of_scene = described.defaults.resolution.unwrap_or(plan::DEFAULT_RESOLUTION);
    let size = args.resolution.map_or(of_scene, |r| [r.width, r.height]);
    scene::finish(&mut described, &args.view, size, console, diags);
    let technique = Technique::default();
    let compiled = compile_with(&described, &files, size[0], size[1], &technique, diags)?;
    Some(Found {
        name: args.scene.display().to_string(),
        size,
        effects: causes::of(&described, &technique),
        unused: unused::of(&described),
        hints: hints(&described),
        opened: files.opened().iter().map(|p| p.display().to_string()).collect(),
        scene: described,
        compiled,
    })
}

/// What somebody has written in vain.
fn hints(scene: &Scene) -> Vec<(String, Place)> {
    let mut out = Vec::new();
    let reached = unused::Reached::from(scene);
    for material in reached
        .materials
        .iter()
        .filter_map(|id| scene.materials.get(id.index()))
    {
        if let SurfaceModel::Glass { ior: 1.0, color, .. } = &material.surface
            && color.texture.is_none()
            && color.factor == glam::DVec3::ONE
            && material.interior.is_clear()
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
    fn text(&self, sources: &SourceMap) -> String {
        let mut lines = vec![format!("{}  {}x{}", self.name, self.size[0], self.size[1])];
        let row = |head: &str, rest: &str| format!("  {head:<13} {rest}").trim_end().to_owned();
        lines.push("effects".to_owned());
        for effect in self.effects.iter() {
            let causes = self.effects.causes(effect);
            let mut told: Vec<String> = causes.iter().take(CAUSES_TOLD).map(|c| cause(c, sources)).collect();
            if causes.len() > CAUSES_TOLD {
                told.push(format!("and {} more", grouped((causes.len() - CAUSES_TOLD) as u64)));
            }
            for (i, told) in told.iter().enumerate() {
                lines.push(row(if i == 0 { effect.word() } else { "" }, told));
            }
        }
        let off = Effect::ALL.into_iter().filter(|e| !self.effects.has(*e));
        let off: Vec<&str> = off.map(Effect::word).collect();
        lines.push("not called for".to_owned());
        lines.push(row("", &off.join(", ")));
        if !self.unused.is_empty() {
            lines.push("not needed".to_owned());
            lines.extend(self.left_alone(sources).iter().map(|l| row("", l)));
        }
        lines.push("size".to_owned());
        let size = self.measure();
        lines.push(row("objects", &grouped(size.objects)));
        lines.push(row(
            "triangles",
            &format!("{} ({})", grouped(size.triangles), bytes(size.mesh_bytes)),
        ));
        lines.push(row("lights", &grouped(size.lights)));
        lines.push(row(
            "textures",
            &format!("{} ({})", grouped(size.images), bytes(size.image_bytes)),
        ));
        lines.push(row("files read", &self.opened.join(", ")));
        if !self.hints.is_empty() {
            lines.push("hints".to_owned());
            for (hint, at) in &self.hints {
                lines.push(row("", &format!("{}{hint}", prefix(at, sources))));
            }
        }
        lines.join("\n") + "\n"
    }

    /// What is not needed, some of each kind by name.
    fn left_alone(&self, sources: &SourceMap) -> Vec<String> {
        let mut lines = Vec::new();
        let mut kinds: Vec<&str> = self.unused.iter().map(|u| u.kind).collect();
        kinds.dedup();
        for kind in kinds {
            let of_kind: Vec<_> = self.unused.iter().filter(|u| u.kind == kind).collect();
            for u in of_kind.iter().take(UNUSED_TOLD) {
                let name = if u.name.is_empty() {
                    String::new()
                } else {
                    format!(" \"{}\"", u.name)
                };
                let size = if u.bytes > 0 {
                    format!(" ({})", bytes(u.bytes))
                } else {
                    String::new()
                };
                lines.push(format!("{}{kind}{name}: {}{size}", prefix(&u.place, sources), u.why));
            }
            if of_kind.len() > UNUSED_TOLD {
                let more = (of_kind.len() - UNUSED_TOLD) as u64;
                lines.push(format!("and {} more of the kind {kind}", grouped(more)));
            }
        }
        lines
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
            images: images.len() as u64,
            image_bytes: images.iter().map(|i| i.bytes()).sum(),
        }
    }

    fn json(&self, sources: &SourceMap) -> Value {
        let effects: Value = Effect::ALL
            .into_iter()
            .map(|effect| {
                let causes = self.effects.causes(effect).iter();
                let causes: Vec<Value> = causes
                    .map(|c| json!({"what": c.what, "why": c.why, "place": place(&c.place, sources), "times": c.times}))
                    .collect();
                let value = json!({
                    "on": self.effects.has(effect),
                    "strategy": effect.is_strategy(),
                    "causes": causes,
                });
                (effect.word().to_owned(), value)
            })
            .collect();
        let unused: Vec<Value> = self
            .unused
            .iter()
            .map(|u| json!({"kind": u.kind, "name": u.name, "why": u.why, "place": place(&u.place, sources), "bytes": u.bytes}))
            .collect();
        let hints = self
            .hints
            .iter()
            .map(|(hint, at)| json!({"hint": hint, "place": place(at, sources)}));
        let cameras: Vec<&str> = self.scene.cameras.iter().map(|c| c.name.as_str()).collect();
        let size = self.measure();
        json!({
            "version": 1,
            "scene": self.name,
            "width": self.size[0],
            "height": self.size[1],
            "effects": effects,
            "not_needed": unused,
            "objects": size.objects,
            "triangles": size.triangles,
            "mesh_bytes": size.mesh_bytes,
            "lights": size.lights,
            "images": size.images,
            "image_bytes": size.image_bytes,
            "cameras": cameras,
            "files": self.opened,
            "hints": hints.collect::<Vec<_>>(),
        })
    }
}

/// How large the compiled scene is.
struct Size {
    objects: u64,
    triangles: u64,
    mesh_bytes: u64,
    lights: u64,
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

fn prefix(at: &Place, sources: &SourceMap) -> String {
    place(at, sources).map_or(String::new(), |p| format!("{p}: "))
}

/// `scene.pts:41:3: sphere "ball" (glass of ior 1.5)`
fn cause(c: &Cause, sources: &SourceMap) -> String {
    let times = if c.times > 1 {
        format!(", {} times", grouped(c.times))
    } else {
        String::new()
    };
    format!("{}{} ({}{times})", prefix(&c.place, sources), c.what, c.why)
}
