//! The layers beside the colour, each against what it says it is.

mod support;

use assert_cmd::Command;
use pts::render::settings::{Aovs, Settings};
use pts::render::technique::Direct;
use support::images::read_planes;
use support::scenes::{Ready, bits, path, ready};
use tempfile::TempDir;

/// Mean over renders of the squared standard errors that they tell, and the variance between them, by pixel and channel.
struct Truth {
    told: Vec<[f64; 3]>,
    variance: Vec<[f64; 3]>,
    /// Squared standard errors of each render.
    renders: Vec<Vec<[f64; 3]>>,
}

fn truth(ready: &Ready, [width, height]: [u32; 2], spp: u32, renders: u32) -> Truth {
    let pixels = (width * height) as usize;
    let mut of_renders = Vec::new();
    let (mut sums, mut squares) = (vec![[0.0; 3]; pixels], vec![[0.0; 3]; pixels]);
    let mut told = vec![[0.0; 3]; pixels];
    for seed in 1..=renders {
        let settings = Settings {
            seed: u64::from(seed),
            ..Settings::new(width, height, spp)
        };
        let estimate = ready.shoot(&settings).estimate;
        for i in 0..pixels {
            for c in 0..3 {
                let x = estimate.mean[i][c];
                sums[i][c] += x;
                squares[i][c] += x * x;
                told[i][c] += estimate.variance[i][c] / f64::from(renders);
            }
        }
        of_renders.push(estimate.variance);
    }
    let n = f64::from(renders);
    let variance = |i: usize, c: usize| (squares[i][c] - sums[i][c] * sums[i][c] / n) / (n - 1.0);
    Truth {
        variance: (0..pixels).map(|i| [0, 1, 2].map(|c| variance(i, c))).collect(),
        told,
        renders: of_renders,
    }
}

/// √(sum of `a` / sum of `b`) over each block of 8×8 pixels.
fn block_ratios(a: &[[f64; 3]], b: &[[f64; 3]], [width, height]: [u32; 2]) -> Vec<f64> {
    let (width, height) = (width as usize, height as usize);
    let corners = (0..height)
        .step_by(8)
        .flat_map(|y| (0..width).step_by(8).map(move |x| (x, y)));
    let sum = |v: &[[f64; 3]], x0: usize, y0: usize| {
        let pixels = (y0..y0 + 8).flat_map(|y| (x0..x0 + 8).map(move |x| y * width + x));
        pixels.map(|i| v[i].iter().sum::<f64>()).sum::<f64>()
    };
    corners.map(|(x, y)| (sum(a, x, y) / sum(b, x, y)).sqrt()).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Nets are independent, so that their spread tells the variance of the mean without bias, whatever the paths do.
/// A block of 64 pixels knows its true variance from 60 renders to about 4 %, its root to 2 %, the median of twelve
/// blocks to 0.8 %: 5 % are six standard errors. (The median over single pixels says less: four nets leave each
/// pixel's own figure with three degrees of freedom, whose median is 0.89, and lower still where light comes rarely.)
#[test]
fn standard_errors_are_right_to_5_percent() {
    let size = [32, 24];
    for glossy in ["0", "1"] {
        let scene = ready("tests/layers/room.pts", &[("Glossy", glossy)], size);
        let truth = truth(&scene, size, 64, 60);
        let ratios = block_ratios(&truth.told, &truth.variance, size);
        let right = median(ratios.clone());
        assert!((right - 1.0).abs() < 0.05, "glossy {glossy}: {right} of {ratios:?}");
        let fair = ratios.iter().filter(|r| (0.8..1.25).contains(*r)).count();
        assert!(10 * fair >= 9 * ratios.len(), "glossy {glossy}: {ratios:?}");
        // What one render tells alone, on the average: its blocks' medians.
        let of_renders = truth
            .renders
            .iter()
            .map(|told| median(block_ratios(told, &truth.variance, size)));
        let single = of_renders.sum::<f64>() / truth.renders.len() as f64;
        assert!(
            (single - 1.0).abs() < 0.05,
            "glossy {glossy}: one render alone tells {single}"
        );
    }
}

fn all_layers() -> Aovs {
    Aovs {
        depth: true,
        normal: true,
        albedo: true,
        time: true,
        tail: true,
        half_a: true,
        half_b: true,
    }
}

/// ((A − B)/2)² and the squared standard error are two unbiased figures for the same variance. Over 768 pixels, whose
/// channels go together, the first is known to √(2/768) = 5 %, to 10 % where few pixels carry most: 30 % are three
/// standard errors of the worse, and nets in common would double one side.
#[test]
fn halves_are_independent_and_average_to_the_picture() {
    let (size, spp) = ([32, 24], 64);
    let settings = Settings {
        aovs: all_layers(),
        ..Settings::new(size[0], size[1], spp)
    };
    let picture = ready("tests/layers/room.pts", &[], size).shoot(&settings).picture;
    let (a, b) = (picture.half_a.expect("asked for"), picture.half_b.expect("asked for"));
    let (mut between, mut told) = (0.0, 0.0);
    for (i, rgb) in picture.rgb.iter().enumerate() {
        for c in 0..3 {
            let (a, b) = (f64::from(a[i][c]), f64::from(b[i][c]));
            let mean = 0.5 * (a + b);
            // Three roundings to f32: of the halves and of the mean.
            assert!(
                (mean - f64::from(rgb[c])).abs() <= 2.0 * f64::from(f32::EPSILON) * mean,
                "pixel {i}"
            );
            between += 0.25 * (a - b) * (a - b);
            told += f64::from(picture.stderr[i][c]).powi(2);
        }
    }
    let ratio = between / told;
    assert!((ratio - 1.0).abs() < 0.3, "{ratio}");
}

#[test]
fn layers_change_nothing_and_are_there_only_if_asked_for() {
    let size = [20, 12];
    let scene = ready("tests/layers/room.pts", &[("Glossy", "1")], size);
    let plain = Settings::new(size[0], size[1], 24);
    let full = Settings {
        aovs: all_layers(),
        ..plain.clone()
    };
    let [plain, full] = [plain, full].map(|settings| scene.shoot(&settings).picture);
    assert!(bits(&plain) == bits(&full));
    assert!(plain.depth.is_none() && plain.normal.is_none() && plain.albedo.is_none());
    assert!(plain.time.is_none() && plain.tail.is_none() && plain.half_a.is_none() && plain.half_b.is_none());
    let (time, tail) = (full.time.expect("asked for"), full.tail.expect("asked for"));
    assert!(time.iter().all(|t| t.is_finite() && *t > 0.0), "{time:?}");
    // With four nets the brightest has at least a quarter, up to rounding.
    let least = 0.25 - f32::EPSILON;
    assert!(tail.iter().all(|t| (least..=1.0).contains(t)), "{tail:?}");
}

/// A lamp that only chance finds: nearly all of a pixel's light comes from one net, and under an even sky from all alike.
#[test]
fn the_tail_shows_what_hangs_on_a_single_find() {
    let size = [16, 16];
    let share = |lamp: &str| {
        let mut settings = Settings {
            aovs: all_layers(),
            ..Settings::new(size[0], size[1], 64)
        };
        settings.technique.direct = Direct::Bsdf;
        let scene = ready("tests/layers/find.pts", &[("Lamp", lamp)], size);
        let tail = scene.shoot(&settings).picture.tail.expect("asked for");
        median(tail.into_iter().map(f64::from).filter(|t| *t > 0.0).collect())
    };
    // A matte floor under an even sky is the same for every path.
    assert!((share("0") - 0.25).abs() < 1e-6, "{}", share("0"));
    // A ball lamp of radius R at distance d is hit by a share (R/d)² = 1/2500 of the paths: 0.026 of 64, so that of
    // the pixels with any light all but about one in a hundred have one find.
    assert!(share("1") > 0.999, "{}", share("1"));
}

/// A directory of its own, the program in it, and the room.
struct Bench(TempDir);

impl Bench {
    fn new() -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary directory"));
        std::fs::copy(path("tests/layers/room.pts"), bench.0.path().join("room.pts")).expect("the scene is copied");
        bench
    }

    /// Runs the program and returns what it says, which must end with this exit code.
    #[track_caller]
    fn run(&self, words: &str, code: i32) -> String {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        let command = command.current_dir(self.0.path()).env("NO_COLOR", "1");
        let output = command
            .args(words.split_whitespace())
            .output()
            .expect("the program starts");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{words}: {told}");
        told
    }

    fn exr(&self, name: &str) -> Vec<(String, Vec<u32>)> {
        let planes = read_planes(&self.0.path().join(name));
        let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect();
        planes
            .channels
            .into_iter()
            .map(|(name, values)| (name, bits(values)))
            .collect()
    }

    fn png(&self, name: &str) -> Vec<u8> {
        let picture = image::open(self.0.path().join(name)).expect("a picture");
        picture.into_rgb8().into_raw()
    }
}

const ROOM: &str = "render room.pts -r 24x16 -q";

#[test]
fn open_exr_files_have_the_layers_by_their_names() {
    let bench = Bench::new();
    bench.run(
        &format!("{ROOM} -s 16 -o a.exr --aov depth,normal,albedo,relerr,time,tail,halfA,halfB"),
        0,
    );
    let names: Vec<String> = bench.exr("a.exr").into_iter().map(|(name, _)| name).collect();
    let mut expected = [
        "R", "G", "B", "A", "stderr.R", "stderr.G", "stderr.B", "samples", "Z", "N.X", "N.Y", "N.Z", "albedo.R",
        "albedo.G", "albedo.B", "relerr", "time", "tail", "halfA.R", "halfA.G", "halfA.B", "halfB.R", "halfB.G",
        "halfB.B",
    ];
    expected.sort_unstable();
    assert_eq!(names, expected);
}

#[test]
fn merged_parts_have_the_tails_and_halves_of_one_run_and_no_times() {
    let bench = Bench::new();
    let layers = "--aov tail,halfA,halfB";
    bench.run(
        &format!("{ROOM} -s 50 -o whole.exr -o whole.png {layers} --view error"),
        0,
    );
    bench.run(&format!("{ROOM} --samples 0..21 -o a.ptspart"), 0);
    bench.run(&format!("{ROOM} --samples 21..50 -o b.ptspart -j 1"), 0);
    let told = bench.run(
        &format!("merge b.ptspart a.ptspart -o m.exr -o m.png {layers} --view error"),
        0,
    );
    assert!(
        told.contains("view: relative error, 0.1 % dark … 100 % bright"),
        "{told}"
    );
    assert!(bench.exr("m.exr") == bench.exr("whole.exr"));
    assert!(bench.png("m.png") == bench.png("whole.png"));
    for words in ["-o m.exr --aov time", "-o m.png --view time"] {
        let told = bench.run(&format!("merge a.ptspart b.ptspart {words}"), 2);
        assert!(
            told.contains("part files hold what was sampled, not how long it took"),
            "{told}"
        );
    }
    let told = bench.run("merge a.ptspart b.ptspart -o m.png --view depth", 1);
    assert!(told.contains("without the layer depth"), "{told}");
}

#[test]
fn what_nets_are_needed_for_is_refused_without_them() {
    let bench = Bench::new();
    for words in [
        "-o a.exr --aov tail",
        "-o a.exr --aov halfA",
        "-o a.exr --aov halfB",
        "-o a.png --view error",
    ] {
        let told = bench.run(&format!("{ROOM} -s 4 --nets 1 {words}"), 2);
        assert!(told.contains("several nets"), "{told}");
    }
    for words in [
        "-o a.exr --view depth",
        "-o a.hdr --view depth",
        "-o a.ptspart --aov time",
    ] {
        bench.run(&format!("{ROOM} -s 4 {words}"), 2);
    }
    bench.run(&format!("{ROOM} -s 4 --nets 1 -o a.ptspart"), 0);
    let told = bench.run("merge a.ptspart -o a.exr --aov tail", 1);
    assert!(told.contains("--nets 1"), "{told}");
    assert!(!bench.0.path().join("a.exr").exists());
}

#[test]
fn a_view_is_written_to_pictures_and_leaves_open_exr_files_as_they_are() {
    let bench = Bench::new();
    bench.run(&format!("{ROOM} -s 16 -o plain.exr -o plain.png --aov albedo"), 0);
    let mut seen = vec![bench.png("plain.png")];
    for view in ["error", "time", "normal", "albedo", "depth"] {
        bench.run(&format!("{ROOM} -s 16 -o v.exr -o v.png --aov albedo --view {view}"), 0);
        assert!(bench.exr("v.exr") == bench.exr("plain.exr"), "{view}");
        seen.push(bench.png("v.png"));
    }
    for (i, one) in seen.iter().enumerate() {
        assert!(
            seen[..i].iter().all(|other| other != one),
            "picture {i} is that of another view"
        );
    }
    // The top left corner looks at the wall, whose normal is −z and whose albedo is the floor's.
    let pixel = |view: usize| seen[view][..3].to_vec();
    assert_eq!(pixel(3), [128, 128, 0]);
    let expected = [0.5, 0.45, 0.4].map(|v| (255.0 * pts::math::color::srgb_from_linear(v)).round() as u8);
    assert_eq!(pixel(4), expected);
}
