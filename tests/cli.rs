//! The program as its users meet it: exit codes, streams, files, signals.
//!
//! Tests of `mod rendering` trace rays; all others end before the first one.

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

/// A directory of its own and the program in it, with an environment that does not depend on who runs the tests.
struct Bench {
    dir: TempDir,
}

impl Bench {
    fn new() -> Bench {
        let dir = tempfile::tempdir().expect("a temporary directory");
        Bench { dir }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn run(&self, words: &[&str]) -> Output {
        self.run_with(words, &[], "")
    }

    fn run_with(&self, words: &[&str], environment: &[(&str, &str)], stdin: &str) -> Output {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        command.current_dir(self.dir.path()).args(words).write_stdin(stdin);
        for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "TERM", "CI"] {
            command.env_remove(name);
        }
        command.envs(environment.iter().copied());
        command.output().expect("the program starts")
    }

    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.dir.path()).expect("the directory is there");
        let mut names: Vec<String> = entries
            .flatten()
            .map(|e| e.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli").join(name);
    path.to_str().expect("the path is text").to_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn assert_code(output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "{}", stderr(output));
}

#[track_caller]
fn assert_tells(output: &Output, parts: &[&str]) {
    let text = stderr(output);
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
}

#[test]
fn the_help_mentions_every_group_of_flags() {
    for words in [&["--help"][..], &["-h"], &["render", "--help"]] {
        let output = Bench::new().run(words);
        assert_code(&output, 0);
        let text = String::from_utf8_lossy(&output.stdout);
        for part in [
            "Output:",
            "Picture and stop rules",
            "Camera and light:",
            "Sampling:",
            "Scene:",
            "Terminal:",
            "Exit codes:",
            "--resolution",
            "--confidence",
            "--light-scale",
            "--nets",
            "--define",
            "--progress",
        ] {
            assert!(text.contains(part), "`{part}` is not in the help of {words:?}:\n{text}");
        }
    }
}

#[test]
fn the_version_is_that_of_the_package() {
    let output = Bench::new().run(&["--version"]);
    assert_code(&output, 0);
    let expected = format!("pts {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let ball = scene("ball.pts");
    for words in [
        &["--bogus"][..],
        &[],
        &["render"],
        &[&ball, "--spp", "0"],
        &[&ball, "--error", "2"],
        &[&ball, "-r", "800"],
        &[&ball, "--camera", "place=1,2,3"],
        &[&ball, "-D", "2x=1"],
        &[&ball, "-r", "8x8", "--width", "8"],
        &[&ball, "-o", "picture.bmp"],
        &[&ball, "-o", "picture"],
        &[&ball, "-o", "a.png", "-o", "a.png"],
        &[&ball, "-o", "-"],
        &[&ball, "--format", "png"],
        &[&ball, "--aov", "depth", "-o", "a.png"],
        &[&ball, "--nets", "1", "--error", "2%"],
        &[&ball, &ball],
    ] {
        let bench = Bench::new();
        let output = bench.run(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty(), "{words:?} wrote to standard output");
        assert!(bench.files().is_empty(), "{words:?} left {:?}", bench.files());
    }
}

#[test]
fn a_missing_scene_is_named_with_one_that_looks_alike() {
    let bench = Bench::new();
    std::fs::write(bench.path("cornell.pts"), "").expect("the directory can be written to");
    for words in [&["cornel.pts"][..], &["render", "cornel.pts"], &["check", "cornel.pts"]] {
        let output = bench.run(words);
        assert_code(&output, 1);
        assert_tells(
            &output,
            &[
                "cannot read `cornel.pts`: no such file",
                "a similar file exists: cornell.pts",
            ],
        );
    }
    assert_eq!(bench.files(), ["cornell.pts"]);
}

#[test]
fn an_unknown_kind_of_scene_names_the_known_ones() {
    let bench = Bench::new();
    std::fs::write(bench.path("model.fbx"), "").expect("the directory can be written to");
    let output = bench.run(&["model.fbx"]);
    assert_code(&output, 1);
    assert_tells(&output, &[".fbx", ".pts, .pov", ".glb", ".obj"]);
}

#[test]
fn a_misspelt_command_is_recognised() {
    let output = Bench::new().run(&["chekc"]);
    assert_code(&output, 1);
    assert_tells(&output, &["pts check SCENE"]);
}

/// The scene does not exist, and yet the output is refused first: it is looked at before anything costs time.
#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_scene_is_read() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("folder.png")).expect("the directory can be written to");
    for output in ["nowhere/picture.png", "folder.png"] {
        let output = bench.run(&["missing.pts", "-o", output]);
        assert_code(&output, 4);
        assert_tells(&output, &["cannot write"]);
    }
    assert_eq!(bench.files(), ["folder.png"]);
}

#[test]
fn a_mistake_in_a_scene_is_shown_with_its_line_and_leaves_no_picture() {
    let bench = Bench::new();
    let output = bench.run(&[&scene("misspelt.pts"), "-o", "a.png"]);
    assert_code(&output, 1);
    assert_tells(&output, &["error", "`sfere`", "misspelt.pts:4:1", "4 |", "^^^^^"]);
    assert!(output.stdout.is_empty());
    assert!(bench.files().is_empty(), "{:?}", bench.files());
}

#[test]
fn no_terminal_codes_are_written_where_there_is_no_terminal_unless_asked_for() {
    let bench = Bench::new();
    let misspelt = scene("misspelt.pts");
    for (words, environment, colored) in [
        (&[&misspelt[..]][..], &[][..], false),
        (&[&misspelt], &[("TERM", "dumb")], false),
        (&[&misspelt], &[("NO_COLOR", "1")], false),
        (&[&misspelt, "--color", "always"], &[], true),
        (&[&misspelt, "--color", "never"], &[("CLICOLOR_FORCE", "1")], false),
    ] {
        let output = bench.run_with(words, environment, "");
        assert_code(&output, 1);
        assert_eq!(stderr(&output).contains('\x1b'), colored, "{words:?} {environment:?}");
    }
}

#[test]
fn json_progress_tells_mistakes_as_json_too() {
    let output = Bench::new().run(&[&scene("misspelt.pts"), "--progress", "json"]);
    assert_code(&output, 1);
    let events = json_lines(&output);
    assert_eq!(events[0]["event"], "diagnostic");
    assert_eq!(events[0]["severity"], "error");
    assert_eq!(events[0]["labels"][0]["line"], 4);
}

#[test]
fn check_reports_every_scene_as_one_json_document() {
    let output = Bench::new().run(&["check", &scene("ball.pts"), &scene("misspelt.pts"), "--format", "json"]);
    assert_code(&output, 1);
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("standard output is JSON");
    assert_eq!(document["version"], 1);
    let scenes = document["scenes"].as_array().expect("a list of scenes");
    assert_eq!((&scenes[0]["ok"], &scenes[1]["ok"]), (&true.into(), &false.into()));
    assert!(
        scenes[1]["diagnostics"][0]["place"]
            .as_str()
            .is_some_and(|p| p.ends_with("misspelt.pts:4:1"))
    );
}

#[test]
fn check_of_a_sound_scene_is_exit_code_0_and_writes_nothing() {
    let bench = Bench::new();
    let output = bench.run(&["check", &scene("ball.pts"), &scene("sky.pts")]);
    assert_code(&output, 0);
    assert_tells(&output, &["ball.pts: ok", "sky.pts: ok"]);
    assert!(output.stdout.is_empty() && bench.files().is_empty());
}

fn json_lines(output: &Output) -> Vec<serde_json::Value> {
    let text = stderr(output);
    let parse = |line: &str| serde_json::from_str(line).unwrap_or_else(|e| panic!("`{line}` is not JSON: {e}"));
    text.lines().map(parse).collect()
}

/// Tests that trace rays.
mod rendering {
    use super::*;

    const SMALL: [&str; 4] = ["-r", "24x18", "--spp", "16"];

    fn small(scene: &str, more: &[&str]) -> Vec<String> {
        let words = [&[scene][..], &SMALL, more].concat();
        words.into_iter().map(str::to_owned).collect()
    }

    fn run(bench: &Bench, words: &[String]) -> Output {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        bench.run(&words)
    }

    /// Width and height of a PNG, from its header.
    fn png_size(bytes: &[u8]) -> (u32, u32) {
        assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"), "not a PNG");
        let number = |at: usize| u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        (number(16), number(20))
    }

    #[test]
    fn the_default_output_is_a_png_named_after_the_scene() {
        let bench = Bench::new();
        let output = run(&bench, &small(&scene("ball.pts"), &[]));
        assert_code(&output, 0);
        assert_eq!(bench.files(), ["ball.png"]);
        let png = std::fs::read(bench.path("ball.png")).expect("the picture is there");
        assert_eq!(png_size(&png), (24, 18));
        assert!(output.stdout.is_empty());
        assert_tells(
            &output,
            &["wrote ball.png (24x18)", "16 samples per pixel", "again: pts render"],
        );
    }

    #[test]
    fn several_outputs_come_from_one_render() {
        let bench = Bench::new();
        let more = [
            "-o",
            "a.png",
            "-o",
            "b.exr",
            "-o",
            "c.hdr",
            "-o",
            "d.jpg",
            "-o",
            "e.ppm",
            "--aov",
            "depth,normal",
        ];
        let output = run(&bench, &small(&scene("ball.pts"), &more));
        assert_code(&output, 0);
        assert_eq!(bench.files(), ["a.png", "b.exr", "c.hdr", "d.jpg", "e.ppm"]);
    }

    #[test]
    fn standard_output_gets_the_image_and_nothing_else() {
        let bench = Bench::new();
        let output = run(&bench, &small(&scene("ball.pts"), &["-o", "-", "--format", "png"]));
        assert_code(&output, 0);
        assert_eq!(png_size(&output.stdout), (24, 18));
        let end = &output.stdout[output.stdout.len() - 8..];
        assert_eq!(&end[..4], b"IEND", "something follows the image");
        assert!(bench.files().is_empty());
    }

    #[test]
    fn a_scene_can_come_from_standard_input() {
        let bench = Bench::new();
        let text = std::fs::read_to_string(scene("ball.pts")).expect("the scene is there");
        let output = bench.run_with(&[&["-"][..], &SMALL].concat(), &[], &text);
        assert_code(&output, 0);
        assert_eq!(bench.files(), ["stdin.png"]);
    }

    #[test]
    fn a_mistake_on_standard_input_has_a_line_too() {
        let bench = Bench::new();
        let text = std::fs::read_to_string(scene("misspelt.pts")).expect("the scene is there");
        let output = bench.run_with(&["-"], &[], &text);
        assert_code(&output, 1);
        assert_tells(&output, &["<stdin>:4:1"]);
    }

    #[test]
    fn the_same_command_gives_the_same_bytes_with_any_number_of_threads() {
        let bench = Bench::new();
        for (name, threads) in [("a.png", "1"), ("b.png", "1"), ("c.png", "3")] {
            assert_code(&run(&bench, &small(&scene("sky.pts"), &["-o", name, "-j", threads])), 0);
        }
        let read = |name| std::fs::read(bench.path(name)).expect("the picture is there");
        assert!(read("a.png") == read("b.png"), "two runs differ");
        assert!(read("a.png") == read("c.png"), "the number of threads shows");
    }

    #[test]
    fn another_seed_gives_another_picture() {
        let bench = Bench::new();
        for (name, seed) in [("a.ppm", "1"), ("b.ppm", "2")] {
            assert_code(
                &run(&bench, &small(&scene("sky.pts"), &["-o", name, "--seed", seed])),
                0,
            );
        }
        let read = |name| std::fs::read(bench.path(name)).expect("the picture is there");
        assert!(read("a.ppm") != read("b.ppm"), "the seed has no effect");
    }

    #[test]
    fn more_light_makes_a_brighter_picture() {
        let bench = Bench::new();
        let sum = |name: &str, more: &[&str]| {
            let flags = [&["-o", name, "--no-dither"][..], more].concat();
            assert_code(&run(&bench, &small(&scene("ball.pts"), &flags)), 0);
            let bytes = std::fs::read(bench.path(name)).expect("the picture is there");
            bytes.iter().rev().take(24 * 18 * 3).map(|b| u64::from(*b)).sum::<u64>()
        };
        let base = sum("a.ppm", &[]);
        assert!(sum("b.ppm", &["--light-scale", "0.25"]) < base);
        assert!(sum("c.ppm", &["--env-color", "0,0,0"]) < base);
        assert!(sum("d.ppm", &["--exposure", "-2"]) < base);
    }

    #[test]
    fn quiet_says_nothing_and_plain_progress_has_no_terminal_codes() {
        let bench = Bench::new();
        let output = run(&bench, &small(&scene("ball.pts"), &["-q"]));
        assert_code(&output, 0);
        assert_eq!(stderr(&output), "");
        let output = run(&bench, &small(&scene("ball.pts"), &["--progress", "bar"]));
        assert_code(&output, 0);
        let text = stderr(&output);
        assert!(!text.contains(['\x1b', '\r']), "{text:?}");
    }

    #[test]
    fn json_progress_starts_and_ends_and_is_json_throughout() {
        let bench = Bench::new();
        let output = run(&bench, &small(&scene("ball.pts"), &["--progress", "json"]));
        assert_code(&output, 0);
        let events = json_lines(&output);
        let (first, last) = (&events[0], &events[events.len() - 1]);
        assert_eq!(first["event"], "start");
        assert_eq!(first["spp_at_most"], 16);
        assert_eq!(last["event"], "done");
        assert_eq!(last["outputs"][0], "ball.png");
        assert_eq!(last["exit"], 0);
        assert_eq!(last["spp"], 16);
    }

    #[test]
    fn an_error_goal_of_the_scene_that_is_missed_is_exit_code_3_with_a_picture() {
        let bench = Bench::new();
        let output = bench.run(&[&scene("goal.pts")]);
        assert_code(&output, 3);
        assert_eq!(bench.files(), ["goal.png"]);
        assert_tells(&output, &["is not reached"]);
    }

    #[test]
    fn an_error_goal_of_the_command_line_that_is_missed_is_exit_code_3() {
        let bench = Bench::new();
        let output = run(&bench, &small(&scene("sky.pts"), &["--error", "0.001%"]));
        assert_code(&output, 3);
        assert_eq!(bench.files(), ["sky.png"]);
    }

    #[test]
    fn samples_on_the_command_line_replace_the_goal_of_the_scene() {
        let bench = Bench::new();
        assert_code(&bench.run(&[&scene("goal.pts"), "--spp", "16"]), 0);
    }

    #[test]
    fn the_replay_command_makes_the_same_picture() {
        let bench = Bench::new();
        let first = run(&bench, &small(&scene("sky.pts"), &["-o", "a.ppm", "--seed", "5"]));
        assert_code(&first, 0);
        let text = stderr(&first);
        let replay = text
            .lines()
            .find_map(|l| l.trim().strip_prefix("again: pts "))
            .expect("a replay is told");
        let replay = replay.replace("a.ppm", "b.ppm");
        let words: Vec<&str> = replay.split(' ').map(|w| w.trim_matches('\'')).collect();
        assert_code(&bench.run(&words), 0);
        let read = |name| std::fs::read(bench.path(name)).expect("the picture is there");
        assert!(read("a.ppm") == read("b.ppm"), "`pts {replay}` makes another picture");
    }

    #[test]
    fn a_time_limit_ends_the_render_after_at_least_one_pass() {
        let bench = Bench::new();
        let output = bench.run(&[&scene("sky.pts"), "-r", "24x18", "--time", "1ms"]);
        assert_code(&output, 0);
        assert_eq!(bench.files(), ["sky.png"]);
        assert_tells(&output, &["stopped by the time limit"]);
    }

    /// A render without end is interrupted once its first progress has been told.
    #[cfg(unix)]
    #[test]
    fn an_interrupt_saves_the_picture_so_far() {
        use std::io::{BufRead, BufReader};
        use std::process::Stdio;
        for signal in ["-INT", "-TERM"] {
            let bench = Bench::new();
            let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_pts"))
                .current_dir(bench.dir.path())
                .args([
                    &scene("sky.pts")[..],
                    "-r",
                    "64x48",
                    "--spp",
                    "2147483648",
                    "--progress",
                    "json",
                ])
                .stderr(Stdio::piped())
                .spawn()
                .expect("the program starts");
            let mut lines = BufReader::new(child.stderr.take().expect("standard error is piped")).lines();
            let begun = lines
                .by_ref()
                .map_while(Result::ok)
                .any(|l| l.contains(r#""event":"progress""#));
            assert!(begun, "the render ended by itself");
            let id = child.id().to_string();
            let kill = std::process::Command::new("kill").args([signal, &id]).status();
            assert!(kill.expect("kill starts").success());
            let rest: Vec<String> = lines.map_while(Result::ok).collect();
            let status = child.wait().expect("the program ends");
            assert_eq!(status.code(), Some(130), "{signal}: {rest:?}");
            let png = std::fs::read(bench.path("sky.png")).expect("the picture is there");
            assert_eq!(png_size(&png), (64, 48));
            assert!(rest.iter().any(|l| l.contains(r#""stop":"interrupted""#)), "{rest:?}");
        }
    }
}
