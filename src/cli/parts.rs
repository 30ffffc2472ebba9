//! What a part file says about the picture it is part of, and whether two parts are of the same picture.

use super::args::RenderArgs;
use super::choices::ToneMapKind;
use super::metadata::filter_word;
use super::replay;
use crate::math::fnv::Fnv;
use crate::render::kernel::PathStats;
use crate::render::report::{Anomalies, Anomaly};
use crate::render::settings::{Region, Settings};
use crate::render::technique::Choice;
use clap::ValueEnum;
use serde_json::{Value, json};

/// How 8-bit images of the scene look unless flags say otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Display {
    /// Tone curve.
    pub tonemap: ToneMapKind,
    /// Whether values are shown as they are, as old scenes want it.
    pub linear: bool,
}

/// The header of a part. `frame` is what all parts together are to cover; `anomalies` are those of the scene.
pub fn header(
    args: &RenderArgs,
    scene_hash: &str,
    settings: &Settings,
    display: Display,
    anomalies: &Anomalies,
) -> Value {
    let view = &args.view;
    let choices = json!({
        "width": settings.width,
        "height": settings.height,
        "seed": settings.seed,
        "nets": settings.nets,
        "max_depth": (settings.technique.max_depth != u32::MAX).then_some(settings.technique.max_depth),
        "filter": filter_word(settings.filter),
        "direct": settings.technique.direct.word(),
        "technique": settings.technique.flags(),
        "without": args.sampling.without_list(),
        "layers": layer_words(settings),
        "camera": view.camera.as_ref().map(|c| c.to_string()),
        "env_color": view.env_color,
        "env_map": view.env_map.is_some(), // its contents are part of the scene's fingerprint
        "light_scale": view.light_scale,
    });
    let mut hash = Fnv::default();
    hash.write(choices.to_string().as_bytes());
    let frame = args
        .parts
        .region
        .unwrap_or(Region::whole(settings.width, settings.height));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene().file_name().map(|n| n.to_string_lossy().into_owned()),
        "scene_hash": scene_hash,
        "settings_hash": format!("{:016x}", hash.value()),
        "settings": choices,
        "display": {"tonemap": word(display.tonemap), "linear": display.linear},
        "frame": [frame.x0, frame.y0, frame.x1, frame.y1],
        "command": replay::picture_command(args, settings),
        "biased": args.sampling.biased(),
        "clamped": 0,
        "rays": 0,
        "anomalies": anomalies_to_json(anomalies),
    })
}

/// The words of the extra layers that are summed.
fn layer_words(settings: &Settings) -> Vec<&'static str> {
    let a = settings.aovs;
    let all = [("depth", a.depth), ("normal", a.normal), ("albedo", a.albedo)];
    all.into_iter()
        .filter(|(_, wanted)| *wanted)
        .map(|(word, _)| word)
        .collect()
}

fn word(curve: ToneMapKind) -> String {
    curve
        .to_possible_value()
        .map(|v| v.get_name().to_owned())
        .unwrap_or_default()
}

/// The display that a header tells.
pub fn display(header: &Value) -> Display {
    let curve = header["display"]["tonemap"].as_str().unwrap_or_default();
    Display {
        tonemap: ToneMapKind::from_str(curve, false).unwrap_or(ToneMapKind::None),
        linear: header["display"]["linear"].as_bool().unwrap_or(false),
    }
}

/// The frame that a header tells; the whole picture where it tells none.
pub fn frame(header: &Value, width: u32, height: u32) -> Region {
    let numbers: Option<Vec<u32>> = header["frame"]
        .as_array()
        .and_then(|a| a.iter().map(|n| u32::try_from(n.as_u64()?).ok()).collect());
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height => Region { x0, y0, x1, y1 },
        _ => Region::whole(width, height),
    }
}

/// What shows that two headers are of different pictures, as `seed is 4, expected 3`.
pub fn difference(found: &Value, expected: &Value) -> Option<String> {
    let of = |name: &str, found: &Value, expected: &Value| {
        (found != expected).then(|| format!("{name} is {found}, expected {expected}"))
    };
    if found["scene_hash"] != expected["scene_hash"] {
        let (a, b) = (&found["scene_hash"], &expected["scene_hash"]);
        return Some(format!(
            "the scene's fingerprint is {a}, expected {b}: the scene or a file it uses differs"
        ));
    }
    if let Some(settings) = expected["settings"].as_object() {
        let differs = settings
            .iter()
            .find_map(|(name, value)| of(name, &found["settings"][name], value));
        if differs.is_some() {
            return differs;
        }
    }
    of("the version of pts", &found["version"], &expected["version"])
        .or_else(|| of("settings", &found["settings_hash"], &expected["settings_hash"]))
        .or_else(|| of("display", &found["display"], &expected["display"]))
}

/// Adds what happened while samples were taken.
pub fn add_stats(header: &mut Value, stats: &PathStats) {
    let mut before = anomalies(header);
    before.join(&stats.anomalies);
    header["anomalies"] = anomalies_to_json(&before);
    header["rays"] = json!(rays(header) + stats.rays);
    header["clamped"] = json!(clamped(header) + stats.clamped);
}

/// Samples of a part that were scaled down.
pub fn clamped(header: &Value) -> u64 {
    header["clamped"].as_u64().unwrap_or(0)
}

/// Rays traced for a part.
pub fn rays(header: &Value) -> u64 {
    header["rays"].as_u64().unwrap_or(0)
}

/// What was mended in the scene and went wrong while a part was rendered.
pub fn anomalies(header: &Value) -> Anomalies {
    let mut found = Anomalies::default();
    for kind in Anomaly::ALL {
        found.count(kind, header["anomalies"][kind.word()].as_u64().unwrap_or(0));
    }
    found
}

/// Every kind with its number, zeros too.
pub fn anomalies_to_json(found: &Anomalies) -> Value {
    found.iter().map(|(kind, n)| (kind.word(), n)).collect()
}
