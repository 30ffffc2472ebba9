//! Parts of a picture: however it was cut, in whatever order it is brought together, the bits are those of one run.

use assert_cmd::Command;
use pts::compile::compile;
use pts::diag::{Diagnostics, SourceMap};
use pts::files::DiskFiles;
use pts::load::{LoadOptions, load};
use pts::math::stats::Pcg;
use pts::pictures::{Limits, read_exr_channels};
use pts::render::driver::{Continuity, render, render_on};
use pts::render::pixels::{Pixels, Rows};
use pts::render::report::{Observer, Progress, Silent, StopReason};
use pts::render::scene::CompiledScene;
use pts::render::settings::{Region, Settings};
use pts::render::tiles::Tiles;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::atomic::{AtomicU32, Ordering};
use tempfile::TempDir;

const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;

fn sky() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/sky.pts")
}

fn compiled() -> CompiledScene {
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let files = DiskFiles::default();
    let scene = load(&sky(), &files, &LoadOptions::default(), &mut sources, &mut diags).expect("the scene is read");
    compile(&scene, &files, WIDTH, HEIGHT, &mut diags).expect("the scene compiles")
}

fn collect(rows: &Tiles) -> Pixels {
    Pixels {
        shape: rows.shape(),
        rows: (0..HEIGHT).map(|y| rows.row(y)).collect(),
    }
}

/// Equality of bits, also of zeros.
#[track_caller]
fn assert_same(found: &Pixels, expected: &Pixels, what: &str) {
    for (y, (a, b)) in found.rows.iter().zip(&expected.rows).enumerate() {
        assert_eq!(a.len(), b.len(), "runs of row {y}, {what}");
        for (a, b) in a.iter().zip(b) {
            assert_eq!((&a.columns, &a.samples), (&b.columns, &b.samples), "row {y}, {what}");
            let bits = |sums: &[f64]| sums.iter().map(|s| s.to_bits()).collect::<Vec<_>>();
            assert!(bits(&a.sums) == bits(&b.sums), "row {y} differs, {what}");
        }
    }
}

fn part(scene: &CompiledScene, settings: &Settings, region: Region, begin: u32, end: u32) -> Pixels {
    let mut settings = settings.clone();
    settings.region = region;
    settings.first = begin;
    settings.stop.spp = end - begin;
    let rendered = render_on(scene, &settings, &Silent, Continuity::default()).expect("nothing to go on from");
    collect(&rendered.tiles)
}

fn shuffle<T>(items: &mut [T], rng: &mut Pcg) {
    for i in (1..items.len()).rev() {
        items.swap(i, rng.next_u32() as usize % (i + 1));
    }
}

/// Cuts through samples and rows at once, at any number, for every number of nets.
#[test]
fn any_cut_in_any_order_gives_the_sums_of_one_run() {
    let (scene, mut rng) = (compiled(), Pcg::new(5));
    for nets in [1, 4, 8, 16] {
        let mut settings = Settings::new(WIDTH, HEIGHT, 1);
        settings.nets = nets;
        settings.aovs.depth = true;
        for trial in 0..4 {
            let (begin, end) = ([0, 3][trial % 2], 90 + rng.next_u32() % 60);
            let whole = part(&scene, &settings, settings.region, begin, end);
            let mut parts = Vec::new();
            let middle = 1 + rng.next_u32() % (HEIGHT - 1);
            for (y0, y1) in [(0, middle), (middle, HEIGHT)] {
                let band = Region {
                    y0,
                    y1,
                    ..settings.region
                };
                let mut cuts: Vec<u32> = (0..4).map(|_| begin + rng.next_u32() % (end - begin)).collect();
                cuts.extend([begin, end]);
                cuts.sort_unstable();
                cuts.dedup();
                parts.extend(cuts.windows(2).map(|w| part(&scene, &settings, band, w[0], w[1])));
            }
            shuffle(&mut parts, &mut rng);
            let mut merged = Pixels::new(whole.shape);
            for part in parts {
                merged.add(part).expect("the parts do not overlap");
            }
            assert_same(&merged, &whole, &format!("{nets} nets, samples {begin}..{end}"));
            assert_eq!(merged.gap(&settings.region, &(begin..end)), None);
        }
    }
}

#[test]
fn a_render_goes_on_from_sums_that_were_kept() {
    let scene = compiled();
    let mut settings = Settings::new(WIDTH, HEIGHT, 1);
    let whole = part(&scene, &settings, settings.region, 0, 200);
    settings.stop.spp = 200;
    let (picture, _) = render(&scene, &settings, &Silent);
    for cut in [1, 33, 199, 200] {
        let kept = part(&scene, &settings, settings.region, 0, cut);
        let continuity = Continuity {
            kept: Some(&kept),
            checkpoint: None,
        };
        let rendered = render_on(&scene, &settings, &Silent, continuity).expect("the sums fit");
        assert_same(&collect(&rendered.tiles), &whole, &format!("cut at {cut}"));
        assert!(rendered.picture.rgb == picture.rgb && rendered.picture.stderr == picture.stderr);
    }
}

/// Asks to stop at the n-th tile.
struct Impatient(AtomicU32);

impl Observer for Impatient {
    fn progress(&self, _: &Progress) {}

    fn should_stop(&self) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) == 1
    }
}

/// Also where the interruption leaves some tiles ahead of others, and the picture still stops at the same look.
#[test]
fn an_interrupted_render_reaches_its_error_goal_with_the_same_samples() {
    let scene = compiled();
    let mut settings = Settings::new(WIDTH, HEIGHT, 100_000);
    settings.stop.error = Some(0.01);
    let (picture, report) = render(&scene, &settings, &Silent);
    assert_eq!(report.stop, StopReason::Error);
    for tiles in [1, 4, 42, 50, 61] {
        let observer = Impatient(AtomicU32::new(tiles));
        let first = render_on(&scene, &settings, &observer, Continuity::default()).expect("a fresh render");
        assert_eq!(first.report.stop, StopReason::Interrupted, "after {tiles} tiles");
        let kept = collect(&first.tiles);
        let continuity = Continuity {
            kept: Some(&kept),
            checkpoint: None,
        };
        let second = render_on(&scene, &settings, &Silent, continuity).expect("the sums fit");
        assert_eq!(second.report.spp, report.spp, "after {tiles} tiles");
        assert!(second.picture.rgb == picture.rgb, "after {tiles} tiles");
    }
}

#[test]
fn overlaps_and_gaps_are_found_where_they_are() {
    let scene = compiled();
    let settings = Settings::new(WIDTH, HEIGHT, 1);
    let band = |y0, y1| Region {
        y0,
        y1,
        ..settings.region
    };
    let mut sums = part(&scene, &settings, band(0, 10), 0, 20);
    let gap = sums.gap(&settings.region, &(0..20)).expect("rows are missing");
    assert_eq!((gap.x, gap.y, gap.samples), (0, 10, 0..20));
    let more = part(&scene, &settings, band(10, HEIGHT), 0, 15);
    sums.add(more).expect("they do not overlap");
    let gap = sums.gap(&settings.region, &(0..20)).expect("samples are missing");
    assert_eq!((gap.x, gap.y, gap.samples), (0, 10, 15..20));
    let again = part(&scene, &settings, band(9, 11), 14, 30);
    let overlap = sums.add(again).expect_err("they overlap");
    assert_eq!((overlap.x, overlap.y, overlap.samples), (0, 9, 14..20));
}

/// A directory of its own and the program in it.
struct Bench(TempDir);

const SIZE: &str = "37x21";

impl Bench {
    fn new() -> Bench {
        Bench(tempfile::tempdir().expect("a temporary directory"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, words: &str) -> Output {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        command
            .current_dir(self.0.path())
            .args(words.split_whitespace())
            .env("NO_COLOR", "1");
        command.output().expect("the program starts")
    }

    #[track_caller]
    fn done(&self, words: &str) {
        let output = self.run(words);
        assert_eq!(output.status.code(), Some(0), "{words}: {}", text(&output));
    }

    #[track_caller]
    fn render(&self, words: &str) {
        self.done(&format!("render sky.pts -r {SIZE} {words}"));
    }

    #[track_caller]
    fn refused(&self, words: &str, code: i32, parts: &[&str]) {
        let output = self.run(words);
        assert_eq!(output.status.code(), Some(code), "{words}: {}", text(&output));
        for part in parts {
            assert!(text(&output).contains(part), "`{part}` is not in\n{}", text(&output));
        }
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// All channels of an OpenEXR file.
    fn channels(&self, name: &str) -> String {
        let image = read_exr_channels(&self.bytes(name), Limits::default()).expect("an OpenEXR file");
        format!("{:?}", image.channels)
    }
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn bench() -> Bench {
    let bench = Bench::new();
    std::fs::copy(sky(), bench.path("sky.pts")).expect("the scene is copied");
    bench
}

#[test]
fn merged_files_are_those_of_one_run() {
    let bench = bench();
    let layers = "--aov depth,normal,albedo,relerr";
    bench.render(&format!("-s 100 {layers} -o whole.exr -o whole.ppm -o whole.ptspart"));
    bench.render(&format!("--samples 0..37 {layers} -o a.ptspart -j 1"));
    bench.render(&format!("--samples 37..100 --tile 0/2 {layers} -o b.ptspart -j 3"));
    bench.render(&format!("--samples 37..100 --tile 1/2 {layers} -o c.ptspart"));
    for order in ["a b c", "c a b", "b c a"] {
        let parts: Vec<String> = order.split(' ').map(|p| format!("{p}.ptspart")).collect();
        let outputs = "-o m.exr -o m.ppm -o m.ptspart --aov relerr";
        bench.done(&format!("merge {} {outputs}", parts.join(" ")));
        assert!(bench.channels("m.exr") == bench.channels("whole.exr"), "order {order}");
        assert!(
            bench.bytes("m.ptspart") == bench.bytes("whole.ptspart"),
            "order {order}"
        );
        // Down to what the files say about how they were made.
        assert!(bench.bytes("m.ppm") == bench.bytes("whole.ppm"), "order {order}");
    }
    // Two steps give what one gives.
    bench.done("merge c.ptspart b.ptspart -o bc.ptspart");
    bench.done("merge bc.ptspart a.ptspart -o m.ptspart");
    assert!(bench.bytes("m.ptspart") == bench.bytes("whole.ptspart"));
}

#[test]
fn a_region_is_that_of_the_whole_picture_and_black_elsewhere() {
    let bench = bench();
    bench.render("-s 20 -o whole.ppm --no-dither");
    bench.render("-s 20 -o region.ppm --no-dither --region 5,3,21,17");
    let (whole, region) = (bench.bytes("whole.ppm"), bench.bytes("region.ppm"));
    let pixel = |file: &[u8], x: usize, y: usize| file[file.len() - 37 * 21 * 3..][(y * 37 + x) * 3..][..3].to_vec();
    for (x, y) in (0..21).flat_map(|y| (0..37).map(move |x| (x, y))) {
        let inside = (5..21).contains(&x) && (3..17).contains(&y);
        let expected = if inside { pixel(&whole, x, y) } else { vec![0; 3] };
        assert_eq!(pixel(&region, x, y), expected, "{x}, {y}");
    }
}

#[test]
fn parts_that_do_not_belong_together_are_refused_by_name() {
    let bench = bench();
    bench.render("--samples 0..20 -o a.ptspart");
    bench.render("--samples 10..30 -o over.ptspart");
    bench.render("--samples 40..50 -o later.ptspart");
    bench.render("--samples 20..30 --seed 4 -o seed.ptspart");
    bench.render("--samples 20..30 -D Size=2 -o scene.ptspart");
    bench.render("--samples 20..30 --tile 1/3 -o tile.ptspart");
    let mut cut = bench.bytes("later.ptspart");
    cut.truncate(cut.len() - 100);
    std::fs::write(bench.path("cut.ptspart"), &cut).expect("it is written");
    let mut damaged = bench.bytes("later.ptspart");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    std::fs::write(bench.path("damaged.ptspart"), &damaged).expect("it is written");
    let mut newer = bench.bytes("later.ptspart");
    newer[8] = 99;
    std::fs::write(bench.path("newer.ptspart"), &newer).expect("it is written");
    for (other, said) in [
        ("over.ptspart", &["over.ptspart", "overlaps", "a.ptspart", "10..20"][..]),
        ("a.ptspart", &["overlaps"]),
        ("later.ptspart", &["20..40", "--allow-gaps"]),
        ("tile.ptspart", &["20..30", "--allow-gaps"]),
        (
            "seed.ptspart",
            &["seed.ptspart", "another picture", "seed is 4, expected 0"],
        ),
        ("scene.ptspart", &["scene.ptspart", "fingerprint"]),
        ("cut.ptspart", &["cut.ptspart", "cut off"]),
        ("damaged.ptspart", &["damaged.ptspart", "damaged"]),
        ("newer.ptspart", &["newer.ptspart", "newer"]),
        ("sky.pts", &["sky.pts", "no part file"]),
        ("missing.ptspart", &["missing.ptspart"]),
    ] {
        bench.refused(&format!("merge a.ptspart {other} -o x.ppm"), 1, said);
        assert!(!bench.path("x.ppm").exists(), "{other}");
    }
    bench.done("merge later.ptspart a.ptspart --allow-gaps -o x.ppm");
    bench.done("merge tile.ptspart a.ptspart --allow-gaps -o x.ppm");
}

#[test]
fn parts_need_a_fixed_number_of_samples() {
    let bench = bench();
    for flags in [
        "--samples 0..4 --error 2%",
        "--samples 0..4 --time 1s",
        "--samples 0..4 --spp 4",
        "--samples 4..4",
        "--tile 0/2 --error 2%",
        "--tile 0/2 --time 1s",
        "--tile 0/2",
        "--tile 2/2 -s 1",
        "--tile 0/30 -s 1",
        "--region 0,0,38,21 -s 1",
        "--resume -s 1",
        "--every 1s -s 1",
    ] {
        bench.refused(&format!("render sky.pts -r {SIZE} {flags}"), 2, &["error"]);
    }
    bench.refused("merge a.ptspart", 2, &["-o"]);
}

#[test]
fn a_checkpoint_is_neither_lost_nor_mixed_up() {
    let bench = bench();
    bench.render("-s 10 --checkpoint c.ptspart --resume -o a.ppm");
    let again = format!("render sky.pts -r {SIZE} --checkpoint c.ptspart");
    bench.refused(&format!("{again} -s 20"), 2, &["c.ptspart", "--resume"]);
    bench.refused(
        &format!("{again} -s 20 --seed 3 --resume"),
        1,
        &["c.ptspart", "seed is 0, expected 3"],
    );
    bench.refused(
        &format!("{again} -s 5 --resume"),
        1,
        &["c.ptspart", "10 samples per pixel"],
    );
    bench.refused(&format!("{again} -s 20 --region 0,0,8,8 --resume"), 1, &["outside"]);
    bench.render("-s 50 --checkpoint c.ptspart --resume -o a.exr");
    bench.render("-s 50 -o b.exr");
    assert!(bench.channels("a.exr") == bench.channels("b.exr"));
}

/// A render is ended in its middle, by force or gently, and goes on as if nothing had happened.
#[cfg(unix)]
#[test]
fn a_render_that_was_killed_goes_on_from_its_checkpoint() {
    let bench = bench();
    let common = "-r 64x48 -s 1500 -q --aov depth";
    bench.done(&format!("render sky.pts {common} -o whole.exr"));
    for signal in ["-KILL", "-INT"] {
        let checkpoint = bench.path("c.ptspart");
        let words = format!("render sky.pts {common} -o part.exr --checkpoint c.ptspart --every 50ms");
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_pts"))
            .current_dir(bench.0.path())
            .args(words.split(' '))
            .spawn()
            .expect("the program starts");
        while !checkpoint.exists() {
            assert!(
                child.try_wait().expect("it runs").is_none(),
                "it ended without a checkpoint"
            );
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let id = child.id().to_string();
        let kill = std::process::Command::new("kill").args([signal, &id]).status();
        assert!(kill.expect("kill starts").success());
        assert!(!child.wait().expect("it ends").success(), "{signal} came too late");
        bench.done(&format!("{words} --resume"));
        assert!(bench.channels("part.exr") == bench.channels("whole.exr"), "{signal}");
        std::fs::remove_file(checkpoint).expect("it is there");
    }
}
