//! Every scene of the gallery loads without a complaint, renders, and nothing goes wrong on the way.

mod support;

use pts::compile::compile_pruned;
use pts::compile::prune::{Pruned, prune};
use pts::diag::{Diagnostics, Severity, SourceMap};
use pts::files::DiskFiles;
use pts::load::{LoadOptions, load};
use pts::render::driver;
use pts::render::report::Silent;
use pts::render::settings::Settings;
use std::fs;
use support::scenes;

/// The files of a folder with this ending, of which there are at least so many.
fn files(folder: &str, ending: &str, least: usize) -> Vec<String> {
    let entries = fs::read_dir(scenes::path(folder)).expect("a folder of the gallery");
    let names = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names
        .filter(|n| n.ends_with(ending))
        .map(|n| format!("{folder}/{n}"))
        .collect();
    names.sort();
    assert!(names.len() >= least, "{names:?}");
    names
}

fn gallery() -> Vec<String> {
    files("scenes", ".pts", 10)
}

/// The grids of glTF's material extensions.
fn extensions() -> Vec<String> {
    files("scenes/extensions", ".gltf", 15)
}

#[test]
fn every_scene_opens_with_a_comment_and_loads_without_warnings() {
    for name in gallery().into_iter().chain(extensions()) {
        let text = fs::read_to_string(scenes::path(&name)).expect("readable");
        assert!(
            text.starts_with("//") || name.ends_with(".gltf"),
            "{name} does not say what it shows"
        );
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
    for name in gallery().into_iter().chain(extensions()) {
        let shot = scenes::ready(&name, &[], [32, 24]).shoot(&Settings::new(32, 24, 8));
        let mean: f32 = shot.picture.rgb.iter().flatten().sum::<f32>() / (3.0 * 32.0 * 24.0);
        assert!(mean > 0.005 && mean < 20.0, "{name}: mean {mean}");
    }
}

/// The gallery declares little in vain, and nothing that lights depend on: pruned and unpruned pictures have the same bits.
#[test]
fn pruning_changes_no_bit() {
    let (files, settings) = (DiskFiles::default(), Settings::new(24, 16, 4));
    for name in gallery() {
        let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
        let path = scenes::path(&name);
        let scene = load(&path, &files, &LoadOptions::default(), &mut sources, &mut diags).expect("it loads");
        let bits = |pruned: Pruned<'_>| {
            let compiled = compile_pruned(pruned, 24, 16, &settings.technique, &mut Diagnostics::default());
            let (picture, _) = driver::render(&compiled.expect("it compiles"), &settings, &Silent);
            let numbers = picture.rgb.iter().flatten().map(|v| v.to_bits());
            numbers.collect::<Vec<_>>()
        };
        let pruned = prune(&scene, &files, &mut diags);
        assert!(pruned.keeps_bits(), "{name}: {:?}", pruned.what);
        assert!(bits(pruned) == bits(Pruned::untouched(&scene, &files)), "{name}");
    }
}
