//! When a render stops: the rule that is reached first, what is told about it, and the command that makes the same
//! picture again. All tests run the program.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;
use std::process::Output;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Runs the program in a directory.
fn run(dir: &TempDir, words: &[&str]) -> Output {
    let mut command = Command::cargo_bin("pts").expect("the program is built");
    command.current_dir(dir.path()).args(words);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "TERM", "CI"] {
        command.env_remove(name);
    }
    command.output().expect("the program starts")
}

/// Renders a scene of the tests into `picture.png`, at 48x36.
fn render(dir: &TempDir, scene: &str, flags: &str) -> Output {
    let scene = scene_path(scene);
    let words = [&scene, "-r", "48x36", "-o", "picture.png"];
    let flags = flags.split_whitespace();
    run(dir, &words.into_iter().chain(flags).collect::<Vec<_>>())
}

fn scene_path(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
    path.to_str().expect("the path is text").to_owned()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The exit code is this one, and standard error tells these things.
#[track_caller]
fn assert_ends(output: &Output, code: i32, parts: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
}

fn picture(dir: &TempDir, name: &str) -> Vec<u8> {
    std::fs::read(dir.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn events(output: &Output) -> Vec<Value> {
    let parse = |line: &str| serde_json::from_str(line).unwrap_or_else(|e| panic!("`{line}` is not JSON: {e}"));
    stderr(output).lines().map(parse).collect()
}

const SKY: &str = "cli/sky.pts";
const HORIZON: &str = "stops/horizon.pts";

/// Two seconds end after 1.8 to 2.1 s of wall clock as the caller sees it, plus what starting and ending the program
/// takes: that is measured just before by a render of one sample, and half a second is allowed for a machine that is
/// busy with other tests.
#[test]
fn a_time_limit_is_met_and_made_use_of() {
    let dir = folder();
    let took = |flags: &str| {
        let begun = Instant::now();
        let output = render(&dir, SKY, flags);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (begun.elapsed(), output)
    };
    let (start, _) = took("--spp 1");
    let (whole, output) = took("--time 2s");
    assert_ends(&output, 0, &["stopped by the time limit of 2 s\n"]);
    assert!(whole > Duration::from_millis(1800), "{whole:?}");
    let most = Duration::from_millis(2100 + 500) + start;
    assert!(whole < most, "{whole:?}, starting alone took {start:?}");
}

/// Each rule is named in the summary when it ends the render, and what is said to make the picture again does.
#[test]
fn every_rule_is_named_and_its_picture_can_be_made_again() {
    for (scene, flags, told) in [
        (SKY, "--spp 48", "stopped after all samples\n"),
        (SKY, "--time 700ms", "stopped by the time limit of 700 ms\n"),
        (SKY, "--error 4%", "stopped at the error goal of 4 %\n"),
        (
            SKY,
            "--error 4% --confidence 99.9",
            "stopped at the error goal of 4 %\n",
        ),
        (
            SKY,
            "--error-max 10%",
            "stopped at the goal of 10 % for 99 % of the pixels\n",
        ),
        (
            SKY,
            "--error-display 4.5",
            "stopped at the goal of 4.5 steps of 8 bits on display\n",
        ),
        (HORIZON, "--adaptive --error 1%", "stopped at the error goal of 1 %\n"),
        (HORIZON, "--adaptive --spp 100", "stopped after all samples\n"),
        (
            HORIZON,
            "--adaptive --time 700ms",
            "stopped by the time limit of 700 ms\n",
        ),
    ] {
        let dir = folder();
        let first = render(&dir, scene, flags);
        assert_ends(&first, 0, &[told]);
        let text = stderr(&first);
        let again = text.lines().find_map(|l| l.trim().strip_prefix("again: pts "));
        let again = again.unwrap_or_else(|| panic!("{flags}: no command in\n{text}"));
        assert_eq!(again.contains("--adaptive"), flags.contains("--adaptive"), "{again}");
        assert!(again.contains(" --spp "), "{again}");
        let again = again.replace("picture.png", "again.png");
        let second = run(
            &dir,
            &again.split(' ').map(|w| w.trim_matches('\'')).collect::<Vec<_>>(),
        );
        assert_ends(&second, 0, &["stopped after all samples\n"]);
        let same = picture(&dir, "picture.png") == picture(&dir, "again.png");
        assert!(same, "{flags}: `pts {again}` makes another picture");
    }
}

#[test]
fn the_first_rule_reached_wins() {
    for (flags, code, told) in [
        (
            "--spp 64 --time 1h --error 0.01%",
            3,
            "stopped after all samples; the error goal of 0.01 % is not reached\n",
        ),
        (
            "--spp 2000000 --time 300ms --error-max 0.01%",
            3,
            "stopped by the time limit of 300 ms; the goal of 0.01 %",
        ),
        (
            "--error 50% --error-max 0.01% --error-display 0.001",
            0,
            "stopped at the error goal of 50 %\n",
        ),
        (
            "--error 0.01% --error-max 90% --error-display 0.001",
            0,
            "stopped at the goal of 90 % for 99 % of the pixels\n",
        ),
        (
            "--error 0.01% --error-max 0.01% --error-display 90",
            0,
            "stopped at the goal of 90 steps of 8 bits on display\n",
        ),
    ] {
        let dir = folder();
        assert_ends(&render(&dir, SKY, flags), code, &[told]);
        assert!(!picture(&dir, "picture.png").is_empty());
    }
}

/// The bound decides, and all goals that were asked for are told when none is reached.
#[test]
fn goals_missed_within_the_samples_are_exit_code_3_with_a_picture() {
    for (flags, goal) in [
        ("--error 0.01%", "the error goal of 0.01 % is not reached"),
        (
            "--error-max 0.01%",
            "the goal of 0.01 % for 99 % of the pixels is not reached",
        ),
        (
            "--error-display 0.01",
            "the goal of 0.01 steps of 8 bits on display is not reached",
        ),
        ("--adaptive --error 0.01%", "the error goal of 0.01 % is not reached"),
        (
            "--error 0.01% --error-display 0.01",
            "the error goal of 0.01 % and the goal of 0.01 steps of 8 bits on display is not reached",
        ),
    ] {
        let dir = folder();
        let output = render(&dir, HORIZON, &format!("{flags} --spp 80"));
        assert_ends(
            &output,
            3,
            &["stopped after all samples; ", goal, "the goal needs ", " more\n"],
        );
        assert!(picture(&dir, "picture.png").starts_with(b"\x89PNG"));
    }
}

#[test]
fn progress_for_programs_tells_the_forecast() {
    let dir = folder();
    let output = render(
        &dir,
        SKY,
        "--progress json --time 3s --error 0.01% --error-display 0.0001",
    );
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let events = events(&output);
    let of = |kind: &'static str| events.iter().filter(move |e| e["event"] == kind);
    let start = of("start").next().expect("there is a beginning");
    assert_eq!(
        (&start["error_goal"], &start["error_display_goal"]),
        (&1e-4.into(), &1e-4.into())
    );
    assert!(start["error_max_goal"].is_null());
    let mut before = 0.0;
    for event in of("progress") {
        let fraction = event["fraction"].as_f64().expect("a share of the work");
        assert!((before..=1.0).contains(&fraction), "{before}, then {event}");
        before = fraction;
        assert!(
            event["remaining"]
                .as_f64()
                .is_some_and(|left| (0.0..=3.0).contains(&left)),
            "{event}"
        );
    }
    let foretold = of("progress").chain(of("done")).filter(|e| !e["forecast"].is_null());
    let mut n = 0;
    for event in foretold {
        n += 1;
        let forecast = &event["forecast"];
        let number = |name: &str| {
            forecast[name]
                .as_f64()
                .unwrap_or_else(|| panic!("no {name} in {event}"))
        };
        let goal = [0, 1].map(|i| forecast["to_goal"][i].as_f64().expect("a range"));
        assert!(0.0 < goal[0] && goal[0] < goal[1], "{event}");
        assert!(number("halving") > 0.0, "{event}");
        let error = event["error"]["error"].as_f64().expect("an error");
        assert!(0.0 < number("tenfold") && number("tenfold") < error, "{event}");
        assert!(event["error"]["display_steps"]["bound"].is_number(), "{event}");
    }
    assert!(
        n >= 2,
        "a forecast comes while the render runs and at its end: {events:?}"
    );
}

#[test]
fn rules_that_contradict_each_other_are_wrong_usage() {
    for flags in [
        "--nets 1 --error-max 5%",
        "--nets 1 --error-display 1",
        "--nets 1 --adaptive",
        "--error-display 0",
        "--error-display -1",
        "--error-display nan",
        "--error-max 0",
        "--error-max 200%",
        "--adaptive --checkpoint kept.ptspart",
        "--adaptive -o kept.ptspart",
        "--adaptive --samples 0..64",
        "--adaptive --tile 0/2 --spp 64",
        "--tile 0/2 --error-display 1",
        "--samples 0..4 --error-max 5%",
    ] {
        let dir = folder();
        let output = render(&dir, SKY, flags);
        assert_eq!(output.status.code(), Some(2), "{flags}: {}", stderr(&output));
        assert!(!stderr(&output).is_empty(), "{flags} is refused without a reason");
        let left: Vec<_> = std::fs::read_dir(dir.path()).expect("the directory is there").collect();
        assert!(left.is_empty(), "{flags} left {left:?}");
    }
}

/// A caustic that is found by few paths: whatever the goal, and whether it is reached, the figures are called doubtful.
#[test]
fn figures_that_hang_on_rare_finds_are_called_doubtful() {
    const CAUSTIC: &str = "stops/caustic.pts";
    for (flags, code) in [("--error 5% --spp 256", 3), ("--error-display 200 --spp 256", 0)] {
        let dir = folder();
        assert_ends(
            &render(&dir, CAUSTIC, flags),
            code,
            &["doubtful: ", "rare bright finds"],
        );
        assert_ends(
            &render(&dir, CAUSTIC, &format!("{flags} -q")),
            code,
            &["warning: doubtful: "],
        );
        let output = render(&dir, CAUSTIC, &format!("{flags} --progress json"));
        let events = events(&output);
        assert_eq!(events[events.len() - 1]["error"]["doubtful"], true, "{events:?}");
    }
    // The word means something: it is not said of a plain sky.
    let dir = folder();
    assert!(!stderr(&render(&dir, SKY, "--error 5%")).contains("doubtful"));
}
