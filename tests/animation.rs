//! Animations as the program renders them: which frames, at which clocks, into which files, and what an interruption
//! leaves behind.

#[allow(dead_code)] // the builder serves other suites too
#[path = "gltf/builder.rs"]
mod builder;

use assert_cmd::Command;
use builder::Model;
use serde_json::json;
use std::path::PathBuf;
use std::process::Output;
use tempfile::TempDir;

/// A ball that goes to the right with the clock, seen without any noise.
const BALL: &str = "camera { orthographic location -5*z direction z right 4*x up 4*y }
    sphere { <2*clock - 1, 0, 0>, 0.75 material { emission rgb 1 } }";

struct Bench(TempDir);

impl Bench {
    fn new() -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary directory"));
        std::fs::write(bench.path("ball.pts"), BALL).expect("the scene is written");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, words: &str) -> Output {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        command.current_dir(self.0.path()).args(words.split_whitespace());
        command.output().expect("the program starts")
    }

    #[track_caller]
    fn done(&self, words: &str) -> String {
        let output = self.run(words);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{words}: {told}");
        told
    }

    #[track_caller]
    fn refused(&self, words: &str, code: i32, told: &str) {
        let output = self.run(words);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{words}: {stderr}");
        assert!(stderr.contains(told), "{words}: {stderr}");
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The pixels of a picture, without what it says of itself.
    fn pixels(&self, name: &str) -> Vec<u8> {
        let bytes = self.bytes(name);
        bytes[bytes.len() - 16 * 16 * 3..].to_vec()
    }

    /// The files but the scene, in order.
    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path())
            .expect("the directory is there")
            .flatten();
        let mut names: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.retain(|n| !n.starts_with("ball") && !n.starts_with("mover"));
        names.sort();
        names
    }
}

const SMALL: &str = "-r 16x16 -s 4 --filter box --no-dither -q";

#[test]
fn the_frames_are_the_stills_of_their_clocks() {
    let bench = Bench::new();
    bench.done(&format!("ball.pts --frames 1..3 {SMALL} -o a.ppm"));
    assert_eq!(bench.files(), ["a0001.ppm", "a0002.ppm", "a0003.ppm"]);
    for (frame, clock) in [("a0001.ppm", "0"), ("a0002.ppm", "0.5"), ("a0003.ppm", "1")] {
        bench.done(&format!("ball.pts --clock {clock} {SMALL} -o still.ppm"));
        assert!(
            bench.pixels(frame) == bench.pixels("still.ppm"),
            "{frame} is not clock {clock}"
        );
    }
    assert!(
        bench.pixels("a0001.ppm") != bench.pixels("a0003.ppm"),
        "the ball does not move"
    );
    bench.done(&format!("ball.pts --frames 1..3 --frame 2 {SMALL} -o b##.ppm"));
    assert!(
        bench.pixels("b02.ppm") == bench.pixels("a0002.ppm"),
        "a frame by itself is another"
    );
    bench.done(&format!("ball.pts --frame 2 --fps 4 {SMALL} -o c.ppm"));
    assert!(
        bench.pixels("c0002.ppm") == bench.pixels("a0002.ppm"),
        "frame 2 of 4 a second is at 0.5 s"
    );
}

#[test]
fn a_scene_knows_its_place_in_the_animation() {
    let bench = Bench::new();
    let knows = "#if (!(frame_number = 12 & initial_frame = 10 & final_frame = 14 & clock_on
            & initial_clock = 2 & final_clock = 4 & clock_delta = 0.5 & clock = 3))
            #error concat(\"clock \", str(clock, 0, 9), \" delta \", str(clock_delta, 0, 9))
        #end ";
    std::fs::write(bench.path("ball.pts"), knows.to_owned() + BALL).expect("it is written");
    bench.done(&format!(
        "ball.pts --frames 10..14 --clock-range 2..4 --frame 12 {SMALL}"
    ));
    assert_eq!(bench.files().len(), 0, "the default name begins as the scene's");
    assert!(bench.path("ball0012.png").exists());
}

#[test]
fn the_shutter_of_a_frame_is_a_share_of_its_time() {
    let bench = Bench::new();
    bench.done(&format!(
        "ball.pts --frames 0..4 --frame 2 --shutter-angle 180 {SMALL} -o a.ppm"
    ));
    bench.done(&format!("ball.pts --clock 0.5 --shutter 0.125 {SMALL} -o still.ppm"));
    assert!(bench.pixels("a0002.ppm") == bench.pixels("still.ppm"));
    bench.done(&format!("ball.pts --frames 0..4 --frame 2 {SMALL} -o sharp.ppm"));
    assert!(
        bench.pixels("a0002.ppm") != bench.pixels("sharp0002.ppm"),
        "nothing is blurred"
    );
}

#[test]
fn frames_that_are_there_can_be_left_alone() {
    let bench = Bench::new();
    bench.done(&format!("ball.pts --frames 1..3 --frame 2 {SMALL} -o a.ppm"));
    std::fs::write(bench.path("a0002.ppm"), "mine").expect("it is written");
    let told = bench.done("ball.pts --frames 1..3 --skip-existing -r 4x4 -s 1 -o a.ppm");
    assert_eq!(bench.bytes("a0002.ppm"), b"mine");
    assert!(told.contains("2 frames written, 1 was there already"), "{told}");
    assert_eq!(bench.files(), ["a0001.ppm", "a0002.ppm", "a0003.ppm"]);
}

/// What the summary of a frame says makes the same file, byte by byte.
#[test]
fn a_frame_can_be_made_again() {
    let bench = Bench::new();
    let told = bench.done("ball.pts --frames 1..2 --frame 2 --clock-range 0..0.5 -r 8x8 -s 16 -o a.png");
    let command = told.lines().find_map(|l| l.trim().strip_prefix("again: pts "));
    let command = command.unwrap_or_else(|| panic!("no command in {told}"));
    let first = bench.bytes("a0002.png");
    std::fs::remove_file(bench.path("a0002.png")).expect("it is there");
    bench.done(command);
    assert!(bench.bytes("a0002.png") == first, "{command}");
}

#[test]
fn wrong_usage_is_told_before_anything_is_rendered() {
    let bench = Bench::new();
    for (flags, told) in [
        ("--frames 3..1", "no range of frames"),
        ("--frame 3", "add --frames A..B, or --fps N"),
        ("--frames 1..3 --frame 4", "not among --frames 1..3"),
        ("--fps 24", "--fps needs the frames"),
        ("--frames 1..3 --clock 2", "cannot be used with"),
        ("--frames 1..3 --fps 24 --clock-range 0..1", "cannot be used with"),
        ("--frames 1..3 --shutter-angle 180 --shutter 1", "cannot be used with"),
        ("--frames 1..3 --checkpoint c.ptspart", "--checkpoint holds one picture"),
    ] {
        bench.refused(&format!("ball.pts {flags} -o a.png"), 2, told);
    }
    bench.refused(
        "ball.pts --frames 1..2 -o - --format ppm",
        2,
        "standard output takes one picture",
    );
    assert!(bench.files().is_empty(), "{:?}", bench.files());
}

/// A mistake in one frame ends the animation there; what was finished stays.
#[test]
fn a_frame_that_fails_ends_the_animation() {
    let bench = Bench::new();
    let text = format!("{BALL} #if (frame_number = 2) #error \"not this one\" #end");
    std::fs::write(bench.path("ball.pts"), text).expect("it is written");
    bench.refused(&format!("ball.pts --frames 1..3 {SMALL} -o a.ppm"), 1, "not this one");
    assert_eq!(bench.files(), ["a0001.ppm"]);
}

/// A bare model plays by seconds, 24 frames each where nobody says otherwise.
#[test]
fn a_bare_model_plays_its_animation() {
    let bench = Bench::new();
    let mut m = Model::with_material(json!({"emissiveFactor": [1, 1, 1], "doubleSided": true}));
    let (input, output) = (
        m.floats("SCALAR", &[0.0, 1.0]),
        m.floats("VEC3", &[-2.0, -1.0, 0.0, 2.0, -1.0, 0.0]),
    );
    m.json["accessors"][input]["max"] = json!([1.0]);
    m.push(
        "animations",
        json!({
            "name": "Walk",
            "samplers": [{"input": input, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        }),
    );
    m.json["cameras"] = json!([{"name": "Front", "type": "orthographic",
        "orthographic": {"xmag": 3, "ymag": 3, "zfar": 9, "znear": 0.1}}]);
    m.push("nodes", json!({"name": "Eye", "camera": 0, "translation": [0, 0, 5]}));
    m.json["scenes"][0] = json!({"name": "Stage", "nodes": [0, 1]});
    std::fs::write(bench.path("mover.glb"), m.glb()).expect("it is written");
    bench.done(&format!("mover.glb --frames 6..18 --frame 12 {SMALL} -o a.ppm"));
    bench.done(&format!("mover.glb --clock 0.5 {SMALL} -o still.ppm"));
    assert!(bench.pixels("a0012.ppm") == bench.pixels("still.ppm"));
    bench.done(&format!("mover.glb --frames 0..1 --fps 1 {SMALL} -o b.ppm"));
    assert!(
        bench.pixels("b0000.ppm") != bench.bytes("b0001.ppm"),
        "it does not move"
    );
    // People find the names that flags choose by.
    let output = bench.run("inspect mover.glb");
    let told = String::from_utf8_lossy(&output.stdout);
    for row in [
        "cameras       Front",
        "scenes        Stage",
        "animations    Walk (1 s)",
        "nodes         nodes[0], Eye",
    ] {
        assert!(told.contains(row), "{row:?} is not in {told}");
    }
    let output = bench.run("inspect mover.glb --json");
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(found["names"]["animations"][0], json!({"name": "Walk", "seconds": 1.0}));
    bench.done(&format!("mover.glb --camera Front {SMALL} -o c.ppm"));
}

/// The frame that is rendered when Ctrl-C comes is not written; those before it are.
#[cfg(unix)]
#[test]
fn an_interruption_keeps_the_finished_frames() {
    use std::io::{BufRead, BufReader};
    let bench = Bench::new();
    let text = format!("{BALL} #if (clock > 0) render {{ spp 100000000 }} #else render {{ spp 1 }} #end");
    std::fs::write(bench.path("ball.pts"), text).expect("it is written");
    let words = "ball.pts --frames 1..3 -r 64x64 -o a.ppm --progress json";
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_pts"))
        .current_dir(bench.0.path())
        .args(words.split(' '))
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("standard error is piped")).lines();
    let is_second = |l: &String| l.contains(r#""event":"progress""#) && l.contains(r#""frame":2"#);
    let begun = lines.by_ref().map_while(Result::ok).any(|l| is_second(&l));
    assert!(begun, "the second frame ended by itself");
    let kill = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill starts").success());
    let rest: Vec<String> = lines.map_while(Result::ok).collect();
    let status = child.wait().expect("the program ends");
    assert_eq!(status.code(), Some(130), "{rest:?}");
    assert_eq!(bench.files(), ["a0001.ppm"], "{rest:?}");
}
