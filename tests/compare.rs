//! `pts compare` as its users meet it: what it says, what it writes, and with which code it ends.
//!
//! The images are written by the library, so that no rays are traced.

use assert_cmd::Command;
use pts::output::{Develop, Layers, write};
use pts::pictures::{Limits, decode};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::Output;
use tempfile::TempDir;

/// A directory of its own and the program in it.
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

    fn image(&self, name: &str, layers: &Layers) {
        let how = Develop {
            dither: false,
            ..Develop::default()
        };
        write(&self.path(name), layers, &how, &json!({"nets": 4})).expect("the image is written");
    }

    /// Writes a uniform grey image.
    fn grey(&self, name: &str, size: [u32; 2], value: f32) {
        self.image(name, &grey(size, value));
    }

    fn run(&self, words: &[&str]) -> Output {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        command.current_dir(self.dir.path()).arg("compare").args(words);
        command.output().expect("the program starts")
    }

    #[track_caller]
    fn json(&self, words: &[&str]) -> Value {
        let output = self.run(&[words, &["--format", "json"]].concat());
        serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stderr(&output)))
    }
}

fn grey(size: [u32; 2], value: f32) -> Layers {
    Layers::from_rgb(size[0], size[1], vec![[value; 3]; (size[0] * size[1]) as usize])
}

/// The same with a standard error that is the same everywhere.
fn noisy(size: [u32; 2], value: f32, stderr: f32) -> Layers {
    let layers = grey(size, value);
    Layers {
        stderr: Some(vec![[stderr; 3]; layers.rgb.len()]),
        ..layers
    }
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn assert_ends(output: &Output, code: i32, told: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{text}");
    for part in told {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
}

#[test]
fn an_image_is_within_every_threshold_of_itself() {
    let bench = Bench::new();
    for value in [0.0, 0.5, 7.0] {
        bench.grey("a.exr", [9, 5], value);
        let zero = [
            "--max-e",
            "0",
            "--max-flip",
            "0",
            "--max-hdr-flip",
            "0",
            "--max-rmse",
            "0",
        ];
        let output = bench.run(&[&["a.exr", "a.exr"][..], &zero].concat());
        assert_ends(&output, 0, &[]);
        assert_eq!(stderr(&output), "");
        for part in [
            "a.exr against a.exr (9x5 pixels)",
            "E             0 %",
            "PSNR          ∞",
            "× 1.000",
        ] {
            assert!(
                stdout(&output).contains(part),
                "`{part}` is not in\n{}",
                stdout(&output)
            );
        }
        let report = bench.json(&["a.exr", "a.exr"]);
        assert_eq!(
            (&report["e"], &report["flip"], &report["psnr_db"]),
            (&json!(0.0), &json!(0.0), &json!(null))
        );
        assert_eq!((&report["within"], &report["noise"]), (&json!(true), &json!(null)));
    }
}

/// By hand: 1.25 against 1: E = 0.25 / sqrt(1.01), RMSE = 0.25.
#[test]
fn json_holds_the_numbers_and_the_thresholds_they_are_beyond() {
    let bench = Bench::new();
    bench.grey("a.exr", [8, 4], 1.25);
    bench.grey("b.exr", [8, 4], 1.0);
    let report = bench.json(&[
        "a.exr",
        "b.exr",
        "--max-e",
        "24%",
        "--max-rmse",
        "0.25",
        "--max-hdr-flip",
        "0",
    ]);
    let close = |value: &Value, expected: f64| {
        let found = value.as_f64().unwrap_or(f64::NAN);
        assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
    };
    close(&report["e"], 0.25 / 1.01f64.sqrt());
    close(&report["relmse"], 0.0625 / 1.01);
    close(&report["rmse"], 0.25);
    close(&report["energy"]["ratio"], 1.25);
    close(&report["largest"]["value"], 0.25);
    close(&report["pixels"], 32.0);
    assert_eq!(report["flip"], 0.0, "both are white on a display");
    assert_eq!(report["within"], false);
    let beyond = report["beyond"].as_array().expect("an array");
    let names: Vec<_> = beyond
        .iter()
        .map(|e| e["metric"].as_str().unwrap_or_default())
        .collect();
    assert_eq!(names, ["E", "HDR-FLIP"]);
    close(&beyond[0]["limit"], 0.24);
}

#[test]
fn beyond_a_threshold_is_exit_code_1_and_says_which() {
    let bench = Bench::new();
    bench.grey("a.png", [8, 8], 0.25);
    bench.grey("b.png", [8, 8], 0.5);
    let pair = ["a.png", "b.png"];
    let run = |words: &[&str]| bench.run(&[&pair, words].concat());
    assert_ends(&run(&[]), 0, &[]);
    assert_ends(
        &run(&["--max-e", "60%", "--max-rmse", "0.3", "--max-flip", "1"]),
        0,
        &[],
    );
    assert_ends(
        &run(&["--max-e", "2%"]),
        1,
        &["error: E is 50.0", "more than the 2.000 % allowed"],
    );
    assert_ends(
        &run(&["--max-rmse", "0.2"]),
        1,
        &["RMSE is 0.25", "more than the 0.2000 allowed"],
    );
    assert_ends(
        &run(&["--max-flip", "0.05", "--max-e", "60%"]),
        1,
        &["error: FLIP is 0."],
    );
    let both = run(&["--max-flip", "0.05", "--max-e", "2%", "--max-rmse", "9"]);
    assert_ends(&both, 1, &["E is", "FLIP is"]);
    assert!(!stderr(&both).contains("RMSE"), "{}", stderr(&both));
    assert!(stdout(&both).contains("FLIP"), "the report comes all the same");
}

/// A block of 64 pixels with a standard error of 0.08 each knows its mean to 0.01; of two images, to 0.0141.
#[test]
fn blocks_are_compared_with_the_noise_that_the_files_tell() {
    let bench = Bench::new();
    let mut a = noisy([32, 16], 1.0, 0.08);
    bench.image("b.exr", &a);
    for y in 8..16 {
        for x in 16..24 {
            a.rgb[y * 32 + x] = [1.1; 3];
        }
    }
    bench.image("a.exr", &a);
    bench.grey("exact.exr", [32, 16], 1.0);
    let report = bench.json(&["a.exr", "b.exr"]);
    let noise = &report["noise"];
    assert_eq!(
        (&noise["blocks"], &noise["differing"], &noise["share"]),
        (&json!(8), &json!(1), &json!(0.125))
    );
    assert_eq!(
        (&noise["farthest"]["x"], &noise["farthest"]["y"]),
        (&json!(16), &json!(8))
    );
    let z = noise["farthest"]["z"].as_f64().expect("a number");
    assert!(
        (z - 0.1 / 0.0002f64.sqrt()).abs() < 0.3,
        "{z}: a little less than 7.07 by Student's t"
    );
    let exact = bench.json(&["a.exr", "exact.exr"]);
    assert_eq!(exact["noise"]["exact"], json!({"image": false, "reference": true}));
    assert!(exact["noise"]["farthest"]["z"].as_f64().expect("a number") > 9.0);
    let small = bench.json(&["a.exr", "b.exr", "--block-size", "4"]);
    assert_eq!(small["noise"]["blocks"], 32);
    assert_ends(&bench.run(&["a.exr", "b.exr", "--max-blocks", "13%"]), 0, &[]);
    let output = bench.run(&["a.exr", "b.exr", "--max-blocks", "0.1%"]);
    assert_ends(&output, 1, &["the share of blocks that differ beyond noise is 12.50 %"]);
    assert!(stdout(&output).contains("1 of 8, 8x8 pixels"), "{}", stdout(&output));
    assert_ends(&bench.run(&["b.exr", "exact.exr", "--max-blocks", "0"]), 0, &[]);
}

#[test]
fn a_noise_threshold_without_noise_is_wrong_usage() {
    let bench = Bench::new();
    bench.grey("a.exr", [8, 8], 1.0);
    bench.image("b.exr", &noisy([8, 8], 1.0, f32::NAN));
    bench.image("c.exr", &noisy([8, 8], 1.0, 0.1));
    bench.grey("d.png", [8, 8], 1.0);
    for pair in [["a.exr", "a.exr"], ["a.exr", "b.exr"], ["c.exr", "d.png"]] {
        let needs = ["--max-blocks needs known standard errors", "help: render both to .exr"];
        assert_ends(&bench.run(&[&pair[..], &["--max-blocks", "0"]].concat()), 2, &needs);
        let map = ["--heatmap", "z.png", "--heatmap-kind", "z"];
        assert_ends(&bench.run(&[&pair[..], &map].concat()), 2, &["--heatmap-kind z needs"]);
        assert!(!bench.path("z.png").exists());
    }
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let bench = Bench::new();
    bench.grey("a.exr", [8, 8], 1.0);
    for words in [
        &["a.exr"][..],
        &["a.exr", "a.exr", "a.exr"],
        &["a.exr", "a.exr", "--max-e", "2"],
        &["a.exr", "a.exr", "--max-flip", "-1"],
        &["a.exr", "a.exr", "--block-size", "5"],
        &["a.exr", "a.exr", "--heatmap-kind", "z"],
        &["a.exr", "a.exr", "--heatmap", "map.tiff"],
        &["a.exr", "a.exr", "--format", "xml"],
    ] {
        let output = bench.run(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", stderr(&output));
        assert_eq!(stdout(&output), "", "{words:?}");
    }
}

#[test]
fn images_that_cannot_be_read_or_differ_in_size_are_exit_code_4() {
    let bench = Bench::new();
    bench.grey("a.exr", [8, 4], 1.0);
    bench.grey("b.png", [4, 8], 1.0);
    bench.grey("nan.exr", [8, 4], f32::NAN);
    std::fs::write(bench.path("text.png"), "no image").expect("writes");
    let whole = std::fs::read(bench.path("a.exr")).expect("reads");
    std::fs::write(bench.path("half.exr"), &whole[..whole.len() / 2]).expect("writes");
    assert_ends(
        &bench.run(&["a.exr", "b.png"]),
        4,
        &["differ in size: 8x4 and 4x8 pixels", "a.exr and b.png"],
    );
    assert_ends(
        &bench.run(&["none.exr", "a.exr"]),
        4,
        &["image cannot be read", "none.exr", "help: check the name"],
    );
    assert_ends(&bench.run(&["a.exr", "text.png"]), 4, &["not an image", "text.png"]);
    assert_ends(&bench.run(&["half.exr", "a.exr"]), 4, &["OpenEXR", "half.exr"]);
    assert_ends(
        &bench.run(&["nan.exr", "a.exr"]),
        4,
        &["no pixel is finite in both images"],
    );
    assert_ends(&bench.run(&["a.exr", "."]), 4, &["image cannot be read"]);
    let nowhere = ["a.exr", "a.exr", "--heatmap", "none/map.png"];
    assert_ends(&bench.run(&nowhere), 4, &["none"]);
}

#[test]
fn pixels_that_are_not_finite_are_told_and_left_out() {
    let bench = Bench::new();
    let mut image = grey([8, 4], 1.0);
    bench.image("b.exr", &image);
    image.rgb[3] = [1.0, f32::NAN, 1.0];
    image.rgb[9] = [f32::INFINITY; 3];
    bench.image("a.exr", &image);
    let output = bench.run(&["a.exr", "b.exr", "--max-e", "0"]);
    assert_ends(&output, 0, &["warning: a.exr: 2 pixels are not finite and left out"]);
    let report = bench.json(&["a.exr", "b.exr"]);
    assert_eq!(
        (&report["pixels"], &report["non_finite"]["image"]),
        (&json!(30), &json!(2))
    );
}

/// Pictures of the same codes are the same whatever holds them.
#[test]
fn formats_mix_and_8_bit_ones_are_read_as_srgb() {
    let bench = Bench::new();
    for name in ["a.png", "a.ppm", "a.exr"] {
        bench.grey(name, [8, 8], 0.5);
    }
    let output = bench.run(&["a.png", "a.ppm", "--max-rmse", "0"]);
    assert_ends(&output, 0, &[]);
    // 0.5 has the code 188, which means 0.502886: half a step off at most.
    let report = bench.json(&["a.png", "a.exr"]);
    let rmse = report["rmse"].as_f64().expect("a number");
    assert!((rmse - 0.002_886).abs() < 1e-5, "{rmse}");
    assert_eq!((&report["psnr_db"], &report["flip"]), (&json!(null), &json!(0.0)));
}

#[test]
fn a_heat_map_has_the_size_of_the_images_and_shows_where_they_differ() {
    let bench = Bench::new();
    let mut a = noisy([48, 16], 0.25, 0.01);
    bench.image("b.exr", &a);
    for y in 0..16 {
        a.rgb[y * 48..][..8].fill([0.9, 0.2, 0.1]);
    }
    bench.image("a.exr", &a);
    for kind in ["flip", "hdr-flip", "error", "z"] {
        let output = bench.run(&["a.exr", "b.exr", "--heatmap", "map.png", "--heatmap-kind", kind]);
        assert_ends(&output, 0, &[]);
        let bytes = std::fs::read(bench.path("map.png")).expect("it is written");
        let map = decode(&bytes, "map.png", Limits::default()).expect("it is an image");
        assert_eq!((map.width, map.height), (48, 16), "{kind}");
        let light = |x, y| map.rgba(x, y).expect("inside")[..3].iter().sum::<f32>();
        assert!(light(3, 8) > 1.0, "{kind}: {} where they differ", light(3, 8));
        assert!(light(45, 8) < 0.02, "{kind}: {} where they do not", light(45, 8));
    }
}

#[test]
fn a_misspelt_command_is_recognised() {
    let output = Command::cargo_bin("pts")
        .expect("built")
        .arg("compaer")
        .output()
        .expect("starts");
    assert_ends(&output, 1, &["pts compare"]);
}
