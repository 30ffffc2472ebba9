//! What a scene does not call for changes nothing: forced on, effects of the scene leave every bit of every picture of the
//! gallery as it is, and strategies agree with what they replace.

mod support;

use pts::compile::compile_with;
use pts::compile::effects::{Effect, causes};
use pts::diag::{Diagnostics, SourceMap};
use pts::files::DiskFiles;
use pts::load::{LoadOptions, load};
use pts::render::driver;
use pts::render::kernel::tier::KernelTier;
use pts::render::report::Silent;
use pts::render::scene::CompiledScene;
use pts::render::settings::Settings;
use pts::render::technique::{LightPick, Technique};
use pts::scene::Scene;
use std::fs;
use support::scenes::{bits, estimate, path, settings};
use support::ztest;

const SIZE: [u32; 2] = [24, 18];

fn gallery() -> Vec<String> {
    let entries = fs::read_dir(path("scenes")).expect("the gallery");
    let names = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".pts")).collect();
    names.sort();
    assert!(names.len() >= 12, "{names:?}");
    names.into_iter().map(|n| format!("scenes/{n}")).collect()
}

fn described(name: &str) -> (Scene, DiskFiles) {
    let (files, mut sources, mut diags) = (DiskFiles::default(), SourceMap::default(), Diagnostics::default());
    let options = LoadOptions {
        width: Some(SIZE[0]),
        height: Some(SIZE[1]),
        ..LoadOptions::default()
    };
    let scene = load(&path(name), &files, &options, &mut sources, &mut diags);
    (scene.unwrap_or_else(|| panic!("{name} does not load")), files)
}

fn compiled(scene: &Scene, files: &DiskFiles, technique: &Technique) -> CompiledScene {
    let mut diags = Diagnostics::default();
    compile_with(scene, files, SIZE[0], SIZE[1], technique, &mut diags).expect("the scene compiles")
}

fn pixels(scene: &CompiledScene) -> Vec<[u32; 3]> {
    bits(&driver::render(scene, &Settings::new(SIZE[0], SIZE[1], 4), &Silent).0)
}

/// Each effect alone where the scene does not have it, and all at once.
#[test]
fn forcing_an_effect_of_the_scene_changes_no_bit() {
    for name in gallery() {
        let (scene, files) = described(&name);
        let technique = Technique::default();
        let effects = causes::of(&scene, &technique);
        let plain = pixels(&compiled(&scene, &files, &technique));
        let of_scene = || Effect::ALL.into_iter().filter(|e| !e.is_strategy());
        let unused: Vec<Effect> = of_scene().filter(|e| !effects.has(*e)).collect();
        assert!(
            unused.contains(&Effect::Motion) || name.contains("motion"),
            "{name}: {unused:?}"
        );
        let alone = unused.iter().map(|e| vec![*e]);
        for forced in alone.chain([of_scene().collect()]) {
            let mut more = compiled(&scene, &files, &technique);
            forced.iter().for_each(|e| e.force(&mut more));
            assert!(pixels(&more) == plain, "{name}: {forced:?} changes the picture");
        }
    }
}

/// A scene gets the kernel that it calls for, and a larger one only if that is forced.
#[test]
fn kernels_follow_the_scene() {
    for name in gallery() {
        let (scene, files) = described(&name);
        let technique = Technique::default();
        let effects = causes::of(&scene, &technique);
        let between = effects.has(Effect::Media) || effects.has(Effect::Dispersion);
        let mut compiled = compiled(&scene, &files, &technique);
        let tier = KernelTier::of(&compiled.traits);
        assert_eq!(tier == KernelTier::All, between, "{name}: {}", tier.word());
        Effect::Media.force(&mut compiled);
        assert_eq!(KernelTier::of(&compiled.traits), KernelTier::All);
    }
}

/// Strategies against what they replace, in expectation: lights by a tree against lights by power; and a technique that
/// leaves nothing out. One false alarm in ten thousand for each comparison.
#[test]
fn forcing_a_strategy_agrees_in_expectation() {
    for (name, spp) in [("scenes/night_lamps.pts", 512), ("scenes/cornell_quads.pts", 256)] {
        let (scene, files) = described(name);
        let by_power = Technique {
            lights: LightPick::Power,
            ..Technique::default()
        };
        let mut forced = by_power;
        Effect::LightTree.force_technique(&mut forced);
        assert_eq!(forced.lights, LightPick::Tree);
        let shoot = |technique: Technique, seed| {
            let settings = Settings {
                technique,
                ..settings(SIZE, spp, seed)
            };
            let scene = compiled(&scene, &files, &technique);
            estimate(&driver::render(&scene, &settings, &Silent).0)
        };
        let verdict = ztest::compare(&shoot(by_power, 1), &shoot(forced, 2), 6, 1e-4);
        assert!(verdict.agree(), "{name}: {verdict}");
    }
    let mut technique = Technique {
        caustics: false,
        max_depth: 1,
        ..Technique::default()
    };
    Effect::Caustics.force_technique(&mut technique);
    Effect::Indirect.force_technique(&mut technique);
    assert_eq!(technique, Technique::default());
}
