//! `pts study` as its users meet it: what it writes, what it says, and with which code it ends.

use assert_cmd::Command;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Output;
use std::sync::OnceLock;
use tempfile::TempDir;

/// A grey room open to the viewer, with a lamp, a mirror ball and a glass ball: every axis that needs no image.
const SCENE: &str = "
    render { resolution <32, 24> }
    camera { location <0, 1, -3.4> look_at <0, 1, 0> angle 50 }
    #declare Grey = material { diffuse { color rgb 0.6 } }
    plane { y, 0 material { Grey } }
    plane { -y, -2 material { Grey } }
    plane { -z, -1.5 material { Grey } }
    sphere { <-0.6, 0.5, 0.3>, 0.5 material { specular { color rgb 0.9 } } }
    sphere { <0.6, 0.5, 0>, 0.5 material { glass { color rgb 1 ior 1.5 } } }
    sphere { <0, 1.7, 0>, 0.2 material { diffuse { color rgb 0 } emission rgb 20 } }
";

/// A directory of its own and the program in it.
struct Bench {
    dir: TempDir,
}

impl Bench {
    fn new() -> Bench {
        let dir = tempfile::tempdir().expect("a temporary directory");
        std::fs::write(dir.path().join("room.pts"), SCENE).expect("the scene is written");
        Bench { dir }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn run(&self, words: &[&str]) -> Output {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        command.current_dir(self.dir.path()).arg("study").args(words);
        command.output().expect("the program starts")
    }

    #[track_caller]
    fn refuse(&self, words: &[&str], code: i32, told: &str) {
        let output = self.run(words);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {text}");
        assert!(text.contains(told), "{words:?}: `{told}` is not in\n{text}");
        assert!(!self.path("room-study").exists(), "{words:?}: nothing is left behind");
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// One study for all tests that only read it: a ladder is given, so that time decides only how much of it is climbed.
fn study() -> &'static (Bench, Value, String) {
    static STUDY: OnceLock<(Bench, Value, String)> = OnceLock::new();
    STUDY.get_or_init(|| {
        let bench = Bench::new();
        let axes = "direct,sampler,max-depth,roulette,fresnel,lights,textures,threads";
        let words = [
            "room.pts", "--budget", "40s", "--ladder", "4,16,64", "--axes", axes, "-j", "2", "--goal", "5%",
        ];
        let output = bench.run(&words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let json = serde_json::from_str(&bench.read("room-study/study.json")).expect("JSON");
        (bench, json, stderr(&output))
    })
}

/// A row of the table of all pictures.
#[derive(Debug)]
struct Row {
    axis: String,
    variant: String,
    kind: String,
    spp: u32,
    seed: u64,
    e2: f64,
    e2_se: f64,
    samples: u64,
    seconds: f64,
}

fn rows() -> Vec<Row> {
    let text = study().0.read("room-study/study.csv");
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let at = |name: &str| {
        columns
            .iter()
            .position(|c| *c == name)
            .unwrap_or_else(|| panic!("no column {name}"))
    };
    lines
        .map(|line| {
            let words: Vec<&str> = line.split(',').collect();
            let number = |name: &str| {
                words[at(name)]
                    .parse::<f64>()
                    .unwrap_or_else(|e| panic!("{name}: {e}: {line}"))
            };
            Row {
                axis: words[at("axis")].to_owned(),
                variant: words[at("variant")].to_owned(),
                kind: words[at("kind")].to_owned(),
                spp: number("spp") as u32,
                seed: number("seed") as u64,
                e2: number("error_squared"),
                e2_se: number("error_squared_se"),
                samples: number("samples") as u64,
                seconds: number("seconds"),
            }
        })
        .collect()
}

/// The mean of E² over the seeds of a point and its standard error, from their spread.
fn point(axis: &str, variant: &str, spp: u32) -> (f64, f64) {
    let all = rows();
    let own = all
        .iter()
        .filter(|r| r.axis == axis && r.variant == variant && r.spp == spp);
    let values: Vec<f64> = own.map(|r| r.e2).collect();
    let n = values.len() as f64;
    assert!(n >= 5.0, "{axis} {variant} has {n} rows at {spp} samples");
    let mean = values.iter().sum::<f64>() / n;
    let spread: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (spread / (n * (n - 1.0))).sqrt())
}

#[test]
fn a_study_writes_its_five_files() {
    let (bench, json, told) = study();
    for name in ["study.svg", "study.md", "study.csv", "study.json"] {
        assert!(bench.read(&format!("room-study/{name}")).len() > 500, "{name}");
    }
    let png = std::fs::read(bench.path("room-study/study.png")).expect("the chart");
    let limits = pts::pictures::Limits::default();
    pts::pictures::decode(&png, "study.png", limits).expect("a picture");
    assert!(
        bench.read("room-study/study.svg").starts_with("<svg") || bench.read("room-study/study.svg").contains("<svg")
    );
    assert!(json.is_object());
    assert!(told.contains("room-study/study.md"), "{told}");
}

#[test]
fn every_point_has_at_least_five_seeds_and_tells_its_cost() {
    let all = rows();
    assert!(!all.is_empty());
    for row in &all {
        let peers = all
            .iter()
            .filter(|r| (&r.axis, &r.variant, r.spp) == (&row.axis, &row.variant, row.spp));
        let seeds: std::collections::BTreeSet<u64> = peers.map(|r| r.seed).collect();
        assert!(seeds.len() >= 5, "{row:?}");
        assert!(row.seconds > 0.0 && row.e2_se > 0.0, "{row:?}");
        assert_eq!(row.samples, 32 * 24 * u64::from(row.spp), "{row:?}");
    }
}

#[test]
fn more_samples_bring_less_error() {
    let [few, more, most] = [4, 16, 64].map(|spp| point("samples", "as written", spp).0);
    // Independent samples would give 4 and 4; nets give no less, up to the spread of five seeds.
    assert!(few > 2.0 * more && more > 2.0 * most, "{few} {more} {most}");
}

#[test]
fn variants_that_are_called_unbiased_agree_in_their_expected_picture() {
    let all = rows();
    let energy_of = |axis: &str| all.iter().any(|r| r.axis == axis && r.kind != "bias");
    for axis in ["direct", "sampler", "roulette", "threads"] {
        assert!(energy_of(axis), "{axis} is missing, or called a bias");
    }
    for axis in ["max-depth", "fresnel"] {
        assert!(all.iter().any(|r| r.axis == axis && r.kind == "bias"), "{axis}");
    }
    // Fewer bounces leave light out: no number of samples brings the error down to that of all bounces.
    let (cut, cut_se) = point("max-depth", "1", 64);
    let (whole, whole_se) = point("samples", "as written", 64);
    assert!(
        cut - whole > 5.0 * cut_se.hypot(whole_se),
        "{cut} ± {cut_se}, {whole} ± {whole_se}"
    );
    // The number of threads changes no bit.
    for spp in [4, 16] {
        assert_eq!(point("threads", "1", spp), point("samples", "as written", spp));
    }
}

#[test]
fn what_cannot_matter_is_left_out_and_said() {
    let text = study().0.read("room-study/study.md");
    for axis in ["lights", "textures"] {
        assert!(rows().iter().all(|r| r.axis != axis));
        assert!(
            text.contains(&format!("axis {axis}: left out, since")),
            "{axis} in\n{text}"
        );
    }
}

#[test]
fn the_effects_of_the_scene_are_weighed() {
    let effects = study().1["ablations"].as_array().expect("a list").clone();
    let find = |name: &str| {
        let own = effects.iter().find(|e| e["effect"] == name);
        own.unwrap_or_else(|| panic!("{name} is not in {effects:?}")).clone()
    };
    let indirect = find("indirect");
    assert_eq!(indirect["significant"], true, "{indirect}");
    assert!(indirect["energy"].as_f64().expect("a number") > 0.1, "{indirect}");
    assert!(indirect["time"].as_f64().expect("a number") > 0.1, "{indirect}");
    assert_eq!(find("specular")["significant"], true);
    assert_eq!(find("caustics")["significant"], true);
}

#[test]
fn a_budget_is_kept() {
    let bench = Bench::new();
    let begun = std::time::Instant::now();
    let output = bench.run(&["room.pts", "--budget", "4s", "--progress", "json"]);
    let took = begun.elapsed().as_secs_f64();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // By one run at most; the machine may be busy with other tests.
    assert!(took < 8.0, "{took} s");
    let events: Vec<Value> = stderr(&output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
        .collect();
    let kinds = |kind: &str| events.iter().filter(|e| e["event"] == kind).count();
    assert!(kinds("progress") > 0 && kinds("row") >= 5, "{events:?}");
    let done = events.last().expect("events");
    assert_eq!(
        (&done["event"], done["outputs"].as_array().map(Vec::len)),
        (&Value::from("done"), Some(5))
    );
}

#[test]
fn an_effect_that_does_nothing_is_not_told_from_noise() {
    let bench = Bench::new();
    // Where it is seen, the image is its own mean; two texels in unseen corners differ, or it would be pruned.
    let mut texels = vec![[0.5; 3]; 256];
    (texels[0], texels[255]) = ([0.25; 3], [0.75; 3]);
    let grey = pts::output::Layers::from_rgb(16, 16, texels);
    let how = pts::output::Develop {
        dither: false,
        ..Default::default()
    };
    pts::output::write(&bench.path("flat.exr"), &grey, &how, &serde_json::json!({})).expect("written");
    let model = "mtllib quad.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0.2 0.2\nvt 0.8 0.2\nvt 0.8 0.8\nvt 0.2 0.8\n\
                 usemtl a\nf 1/1 2/2 3/3 4/4\n";
    let scene = "
        camera { location <0, 0, -3> look_at 0 angle 60 }
        obj { \"quad.obj\" }
        sphere { <0, 0, -0.5>, 0.3 material { diffuse { color rgb 0.7 } } }
        light_source { <3, 4, -5>, rgb 1 }
    ";
    let material = "newmtl a\nKd 1 1 1\nmap_Kd flat.exr\nillum 1\n";
    for (name, text) in [("quad.obj", model), ("quad.mtl", material), ("flat.pts", scene)] {
        std::fs::write(bench.path(name), text).expect("written");
    }
    let words = [
        "flat.pts", "-r", "32x24", "--budget", "8s", "--axes", "none", "--ladder", "4", "-o", "out",
    ];
    let output = bench.run(&words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: Value = serde_json::from_str(&bench.read("out/study.json")).expect("JSON");
    let effects = json["ablations"].as_array().expect("a list");
    let textures = effects.iter().find(|e| e["effect"] == "textures").expect("weighed");
    assert_eq!(textures["significant"], false, "{textures}");
    assert!(
        textures["energy"].as_f64().expect("a number").abs() < 1e-6,
        "{textures}"
    );
    assert!(textures["flip"].as_f64().expect("a number") < 1e-3, "{textures}");
}

#[test]
fn a_reference_is_taken_from_a_file() {
    let bench = Bench::new();
    let mut render = Command::cargo_bin("pts").expect("the program is built");
    let words = [
        "render", "room.pts", "-r", "24x18", "--spp", "256", "--seed", "77", "-o", "ref.exr", "-q",
    ];
    render.current_dir(bench.dir.path()).args(words).assert().success();
    let words = [
        "room.pts",
        "--reference",
        "ref.exr",
        "--budget",
        "6s",
        "--axes",
        "none",
        "--no-ablation",
        "-o",
        "out",
    ];
    let output = bench.run(&words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: Value = serde_json::from_str(&bench.read("out/study.json")).expect("JSON");
    assert!(
        json["reference"]["source"]
            .as_str()
            .expect("a name")
            .contains("ref.exr"),
        "{}",
        json["reference"]
    );
    assert!(json["reference"]["error"].as_f64().expect("its noise") > 0.0);
    assert_eq!(json["ablations"].as_array().map(Vec::len), Some(0));
    bench.refuse(&["room.pts", "--reference", "ref.exr", "-r", "8x8"], 4, "24x18");
    bench.refuse(&["room.pts", "--reference", "none.exr"], 4, "none.exr");
    bench.refuse(&["room.pts", "--reference", "room.pts"], 4, "room.pts");
}

#[test]
fn bad_input_is_refused_before_anything_is_measured() {
    let bench = Bench::new();
    std::fs::write(bench.path("bad.pts"), "sphere {").expect("written");
    bench.refuse(&["none.pts"], 1, "no such file");
    bench.refuse(&["bad.pts"], 1, "error");
    bench.refuse(&["room.pts", "--axes", "roulete"], 2, "did you mean roulette");
    bench.refuse(&["room.pts", "--seeds", "4"], 2, "5..");
    bench.refuse(&["room.pts", "--goal", "7"], 2, "neither an error");
    bench.refuse(&["room.pts", "--ladder", "16,4"], 2, "rising");
    bench.refuse(&["room.pts", "--budget", "0s"], 2, "duration");
    bench.refuse(&["room.pts", "-r", "600x400", "--budget", "100ms"], 2, "too short");
    std::fs::write(bench.path("file"), "").expect("written");
    bench.refuse(&["room.pts", "-o", "file"], 4, "file");
}
