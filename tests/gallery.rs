//! Every scene of the gallery loads without a complaint, renders, and nothing goes wrong on the way.

mod support;

use pts::diag::{Diagnostics, Severity, SourceMap};
use pts::files::DiskFiles;
use pts::load::{LoadOptions, load};
use pts::render::settings::Settings;
use std::fs;
use support::scenes;

fn gallery() -> Vec<String> {
    let entries = fs::read_dir(scenes::path("scenes")).expect("the gallery");
    let names = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names
        .filter(|n| n.ends_with(".pts"))
        .map(|n| format!("scenes/{n}"))
        .collect();
    names.sort();
    assert!(names.len() >= 10, "{names:?}");
    names
}

#[test]
fn every_scene_opens_with_a_comment_and_loads_without_warnings() {
    for name in gallery() {
        let text = fs::read_to_string(scenes::path(&name)).expect("readable");
        assert!(text.starts_with("//"), "{name} does not say what it shows");
        let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
        let scene = load(
            &scenes::path(&name),
            &DiskFiles::default(),
            &LoadOptions::default(),
            &mut sources,
            &mut diags,
        );
        let told: Vec<&str> = diags
            .iter()
            .filter(|d| d.severity > Severity::Note)
            .map(|d| d.message.as_str())
            .collect();
        // The scene in POV-Ray's own words shows what is substituted, so it may warn.
        assert!(
            scene.is_some() && (told.is_empty() || name.contains("pov_classic")),
            "{name}: {told:?}"
        );
    }
}

#[test]
fn every_scene_renders_without_anomalies() {
    for name in gallery() {
        let shot = scenes::ready(&name, &[], [32, 24]).shoot(&Settings::new(32, 24, 8));
        let mean: f32 = shot.picture.rgb.iter().flatten().sum::<f32>() / (3.0 * 32.0 * 24.0);
        assert!(mean > 0.005 && mean < 20.0, "{name}: mean {mean}");
    }
}
