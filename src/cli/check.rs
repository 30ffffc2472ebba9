//! `pts check`: everything a render reads is read and resolved, and all mistakes are told; nothing is rendered.

use super::args::CheckArgs;
use super::choices::ReportFormat;
use super::console::Console;
use super::{Exit, diagnostics, scene};
use crate::compile::compile;
use crate::diag::{Diagnostics, Severity, SourceMap};
use crate::import::framing;
use crate::scene::{Handedness, Scene};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// The size that scenes are compiled for; only textures that depend on it could tell the difference.
const SIZE: [u32; 2] = super::plan::DEFAULT_RESOLUTION;

/// Runs the command.
pub fn run(args: &CheckArgs) -> Exit {
    let console = Console::new(&args.terminal, None);
    let mut exit = Exit::Done;
    let mut reports = Vec::new();
    for path in &args.scenes {
        let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
        let scene = check(path, args, &mut sources, &mut diags);
        if scene.is_none() || diags.has_errors() {
            exit = Exit::Scene;
        }
        match args.format {
            ReportFormat::Json => reports.push(report(path, scene.as_ref(), &diags, &sources)),
            ReportFormat::Human => {
                console.diagnostics(&diags, &sources);
                let verdict = match scene {
                    Some(scene) if !diags.has_errors() => contents(&scene),
                    _ => diagnostics::summary(&diags),
                };
                console.say(&format!("{}: {verdict}", path.display()));
            }
        }
    }
    if args.format == ReportFormat::Json {
        let document = json!({"version": 1, "scenes": reports});
        if writeln!(std::io::stdout().lock(), "{document:#}").is_err() {
            return Exit::Output;
        }
    }
    exit
}

/// Reads and compiles a scene as `render` would.
fn check(path: &Path, args: &CheckArgs, sources: &mut SourceMap, diags: &mut Diagnostics) -> Option<Scene> {
    let (files, path) = match scene::open(path) {
        Ok(opened) => opened,
        Err(error) => {
            diags.push(crate::load::unreadable(
                path,
                &error,
                &crate::files::DiskFiles::default(),
            ));
            return None;
        }
    };
    let options = scene::load_options(&args.load, [None, None]);
    let mut scene = scene::read(&path, &files, &options, sources, diags)?;
    let [width, height] = scene.defaults.resolution.unwrap_or(SIZE);
    if scene.handedness == Handedness::Right || scene.active_camera.is_none() {
        let note = framing::frame(&mut scene, f64::from(width) / f64::from(height));
        note.into_iter().for_each(|note| diags.push(note));
    }
    compile(&scene, &files, width, height, diags)?;
    Some(scene)
}

/// `ok (3 objects, 2 lamps, 1 camera)`
fn contents(scene: &Scene) -> String {
    let plural = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    let parts = [
        plural(scene.objects.len(), "object"),
        plural(scene.lights.len(), "lamp"),
        plural(scene.cameras.len(), "camera"),
    ];
    format!("ok ({})", parts.join(", "))
}

fn report(path: &Path, scene: Option<&Scene>, diags: &Diagnostics, sources: &SourceMap) -> Value {
    json!({
        "scene": path.display().to_string(),
        "ok": scene.is_some() && !diags.has_errors(),
        "errors": diags.count(Severity::Error),
        "warnings": diags.count(Severity::Warning),
        "notes": diags.count(Severity::Note),
        "diagnostics": diags.iter().map(|d| diagnostics::to_json(d, sources)).collect::<Vec<_>>(),
    })
}
