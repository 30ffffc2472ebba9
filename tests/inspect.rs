//! `pts inspect` tells what a scene calls for and what it does not need; `--without` takes effects away.

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

const SCENE: &str = r#"#version 3.8;
camera { location <0, 1, -4> look_at 0 angle 40 lens_radius 0 focus_distance 4 }
light_source { <2, 4, -3> rgb 1 }
light_source { <-2, 4, -3> rgb 0 }
#declare Spare = material { glossy { color rgb 1 roughness 0.2 ior 1.5 } }
plane { y, -1 material { diffuse { color rgb 0.5 } } }
sphere { 0, 1
  material { glass { color rgb 1 ior 1.5 absorption rgb 0.2 } } }
sphere { <2, 0, 0>, 0.5 material { glass { color rgb 1 ior 1 } } }
"#;

struct Bench {
    dir: TempDir,
}

impl Bench {
    fn new() -> Bench {
        let dir = tempfile::tempdir().expect("a temporary directory");
        std::fs::write(dir.path().join("a.pts"), SCENE).expect("the scene is written");
        Bench { dir }
    }

    fn run(&self, words: &[&str]) -> (String, String) {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        let output = command
            .current_dir(self.dir.path())
            .args(words)
            .output()
            .expect("it starts");
        let [out, err] = [output.stdout, output.stderr].map(|s| String::from_utf8_lossy(&s).into_owned());
        assert!(output.status.success(), "{words:?}: {err}");
        (out, err)
    }

    fn json(&self) -> Value {
        serde_json::from_str(&self.run(&["inspect", "a.pts", "--format", "json"]).0).expect("JSON")
    }
}

#[test]
fn effects_are_told_with_their_places() {
    let found = Bench::new().json();
    let on = |effect: &str| found["effects"][effect]["on"] == true;
    for effect in ["glass", "media", "indirect", "caustics"] {
        assert!(on(effect), "{effect}: {found:#}");
    }
    for effect in [
        "textures",
        "bump",
        "alpha",
        "dispersion",
        "lens",
        "motion",
        "environment",
        "glossy",
        "translucent",
        "light_tree",
    ] {
        assert!(!on(effect), "{effect}: {found:#}");
    }
    let causes = found["effects"]["glass"]["causes"].as_array().expect("causes");
    assert_eq!(causes.len(), 1, "{causes:?}");
    assert_eq!(causes[0]["place"], "a.pts:7:1");
    assert_eq!(causes[0]["why"], "glass of ior 1.5");
    assert_eq!(found["hints"].as_array().map(Vec::len), Some(1));
    let pruned = found["pruned"].as_array().expect("a list");
    let kinds: Vec<_> = pruned.iter().filter_map(|p| p["kind"].as_str()).collect();
    assert_eq!(kinds, ["lamp", "material", "lens"], "{pruned:?}");
    let lamp = &pruned[0];
    assert_eq!(
        [&lamp["pass"], &lamp["kind"], &lamp["why"], &lamp["place"]],
        ["lights", "lamp", "it is dark", "a.pts:4:1"]
    );
    assert_eq!(
        (&lamp["saved"]["lights"], &found["saved"]["lights"]),
        (&1.into(), &1.into())
    );
    assert_eq!(found["lights"], 1);
    assert_eq!(found["files"].as_array().map(Vec::len), Some(1));
}

#[test]
fn the_text_names_causes_and_what_is_off() {
    let (text, _) = Bench::new().run(&["inspect", "a.pts"]);
    for part in [
        "a.pts:7:1: sphere (glass of ior 1.5)",
        "not called for",
        "textures, bump",
        "pruned\n  lamp          a.pts:4:1: it is dark (1 light)\n  material      a.pts:5:10: \"Spare\": declared",
        "\n  saved in all  1 light\n",
        "hints",
    ] {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
}

/// `--json` is short for `--format json`; without pruning all lights are counted, and the text says why.
#[test]
fn pruning_can_be_turned_off() {
    let bench = Bench::new();
    let (text, _) = bench.run(&["inspect", "a.pts", "--no-prune"]);
    assert!(
        text.contains("pruned\n                nothing, as --no-prune asks\n"),
        "{text}"
    );
    let short = bench.run(&["inspect", "a.pts", "--no-prune", "--json"]).0;
    let found: Value = serde_json::from_str(&short).expect("JSON");
    assert_eq!((&found["prune"], &found["lights"]), (&false.into(), &2.into()));
    let (_, told) = bench.run(&[
        "render",
        "a.pts",
        "-r",
        "8x8",
        "--spp",
        "4",
        "--no-prune",
        "-o",
        "a.png",
    ]);
    assert!(told.contains("--no-prune"), "the command that makes it again: {told}");
}

/// What is left out is told in the summary and in the picture, and the command that is told to make the picture
/// again leaves it out as well.
#[test]
fn what_is_left_out_is_stamped_and_replayed() {
    let bench = Bench::new();
    let render = [
        "render",
        "a.pts",
        "-r",
        "8x8",
        "--spp",
        "16",
        "--without",
        "glass,media",
        "-o",
        "a.png",
    ];
    let (_, told) = bench.run(&render);
    assert!(
        told.contains("--without glass,media (not the scene as written)"),
        "{told}"
    );
    let again = told
        .lines()
        .find_map(|l| l.trim().strip_prefix("again: pts "))
        .expect("a command");
    let first = std::fs::read(bench.dir.path().join("a.png")).expect("the picture");
    bench.run(&again.split(' ').collect::<Vec<_>>());
    assert_eq!(
        first,
        std::fs::read(bench.dir.path().join("a.png")).expect("the picture")
    );
    let (_, told) = bench.run(&["render", "a.pts", "-r", "8x8", "--spp", "16", "-o", "a.png"]);
    assert!(!told.contains("not the scene"), "{told}");
    assert_ne!(
        first,
        std::fs::read(bench.dir.path().join("a.png")).expect("the picture")
    );
}
