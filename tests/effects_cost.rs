//! What a scene declares and its picture does not need costs nothing: instructions per sample, counted by callgrind.
//!
//! A scene and the same scene with something declared in vain are rendered with 1 and with 9 samples per pixel on one
//! thread; the difference of the two leaves reading, pruning and building out. No quiet machine is needed: counts repeat
//! to 10⁻⁴. Without `valgrind` there is nothing to count with, and the tests say so; where the environment sets
//! `PTS_NEED_VALGRIND`, as `.ci/run` does, that is a failure.

use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// What may differ, as a share of the instructions of all samples.
const ALLOWED: f64 = 1.001;

const TEXT: &str = "#version 3.8;
camera { location <0, 1, -5> look_at 0 angle 40 }
light_source { <2, 4, -3> rgb 1 }
light_source { <-3, 5, -4> rgb 0.5 }
plane { y, -1 material { diffuse { color rgb 0.5 } } }
sphere { <-1, 0, 0>, 1 material { glass { color rgb 1 ior 1.5 } } }
sphere { <1.2, -0.2, 0>, 0.8 material { diffuse { color rgb <0.8, 0.4, 0.2> } } }
sphere { <0, -0.6, -1.5>, 0.4 pigment { rgb 0.7 } finish { diffuse 0.8 } }
";

/// What is written in vain: its name, what it replaces (nothing: it is added at the end), and what is written.
const IN_TEXT: [(&str, &str, &str); 15] = [
    (
        "a material that nothing has",
        "",
        "#declare Spare = material { glossy { color rgb 1 roughness 0.2 ior 1.5 } };",
    ),
    (
        "an object that is not drawn",
        "",
        "#declare Spare = union { sphere { 0, 1 } sphere { 2, 1 } };",
    ),
    ("fog of no density", "", "fog { distance 0 color rgb 1 }"),
    ("fog that has only a colour", "", "fog { color rgb 1 }"),
    ("an atmosphere of nothing", "", "media { }"),
    (
        "a lens without opening",
        "angle 40",
        "angle 40 lens_radius 0 focus_distance 3",
    ),
    ("a shutter over what stands still", "", "render { shutter 1 }"),
    ("a black environment", "", "environment { color rgb 0 }"),
    ("a black background", "", "background { rgb 0 }"),
    ("a dark lamp", "", "light_source { <0, 9, 0> rgb 0 }"),
    (
        "a mix by 0",
        "diffuse { color rgb <0.8, 0.4, 0.2> }",
        "mix { material { diffuse { color rgb <0.8, 0.4, 0.2> } }, material { glossy { color rgb 1 } }, 0 }",
    ),
    (
        "dispersion of what is opaque",
        "finish { diffuse 0.8 } }",
        "finish { diffuse 0.8 } interior { ior 1.5 dispersion 1.02 } }",
    ),
    ("a reflection of 0", "diffuse 0.8", "diffuse 0.8 reflection 0"),
    (
        "an object that no ray sees",
        "",
        "box { -0.3, 0.3 pigment { rgb 1 } no_image no_shadow no_reflection }",
    ),
    (
        "an absorbing inside that light does not enter",
        "color rgb 0.5 } } }",
        "color rgb 0.5 } } interior { media { absorption 1 } } }",
    ),
];

const MODEL: &str = "mtllib a.mtl
v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl wood\nf 1/1 2/2 3/3 4/4\nf 1/1 5/2 6/3 2/4
";

const MATERIAL: &str = "newmtl wood\nKd 1 1 1\nmap_Kd wood.png\n";

const IN_MODEL: [(&str, &str); 5] = [
    (
        "a material that no face has",
        "newmtl spare\nKd 1 1 1\nmap_Kd spare.png\n",
    ),
    ("an alpha map without a hole", "map_d white.png\n"),
    ("a flat normal map", "norm flat.png\n"),
    ("emission 0 with a map", "Ke 0 0 0\n"),
    ("emission that is black all over", "map_Ke black.png\n"),
];

/// Files of scenes, all in one directory.
struct Bench(TempDir);

impl Bench {
    fn new() -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary directory"));
        let wood = [
            [90, 60, 30, 255],
            [200, 150, 90, 255],
            [120, 90, 40, 255],
            [60, 30, 10, 255],
        ];
        bench.png("wood.png", wood);
        bench.png("white.png", [[255; 4]; 4]);
        bench.png("flat.png", [[128, 128, 255, 255]; 4]);
        bench.png("black.png", [[0, 0, 0, 255]; 4]);
        bench.write("a.obj", MODEL);
        bench
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("a file is written");
    }

    fn png(&self, name: &str, texels: [[u8; 4]; 4]) {
        image::save_buffer(
            self.path(name),
            texels.as_flattened(),
            2,
            2,
            image::ExtendedColorType::Rgba8,
        )
        .expect("an image is written");
    }

    /// Counts a scene's instructions.
    fn count(&self, scene: &str, flags: &[&str]) -> Count {
        let [few, many] = [1, 9].map(|spp| self.instructions_of(scene, spp, flags));
        Count { few, many }
    }

    fn instructions_of(&self, scene: &str, spp: u32, flags: &[&str]) -> u64 {
        let output = Command::new("valgrind")
            .current_dir(self.0.path())
            .args(["--tool=callgrind", "--cache-sim=no", "--callgrind-out-file=/dev/null"])
            .arg(Path::new(env!("CARGO_BIN_EXE_pts")))
            .args([
                "render",
                scene,
                "-r",
                "32x32",
                "-j",
                "1",
                "-s",
                &spp.to_string(),
                "-o",
                "out.png",
            ])
            .args(flags)
            .output()
            .expect("valgrind starts");
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{scene}: {told}");
        let collected = told
            .lines()
            .find_map(|l| l.split_once("Collected :")?.1.trim().parse().ok());
        collected.unwrap_or_else(|| panic!("callgrind tells no count: {told}"))
    }
}

/// Instructions of renders with 1 and with 9 samples of each of 32 × 32 pixels. Waiting for one another makes threads
/// spin, so that a busy machine adds some; the least of several counts is nearest to the truth.
#[derive(Clone, Copy)]
struct Count {
    few: u64,
    many: u64,
}

impl Count {
    fn or_less(self, other: Count) -> Count {
        Count {
            few: self.few.min(other.few),
            many: self.many.min(other.many),
        }
    }

    /// Those of the samples alone.
    fn of_samples(self) -> f64 {
        assert!(self.many > self.few, "more samples take fewer instructions");
        (self.many - self.few) as f64
    }
}

/// Whether there is something to count with; where it must be there, its absence is a failure.
fn can_count() -> bool {
    let found = Command::new("valgrind").arg("--version").output();
    let is_there = found.is_ok_and(|o| o.status.success());
    let is_needed = std::env::var_os("PTS_NEED_VALGRIND").is_some();
    assert!(is_there || !is_needed, "valgrind is needed and not there");
    if !is_there {
        eprintln!("skipped: valgrind is not installed");
    } else if cfg!(debug_assertions) && !is_needed {
        eprintln!("skipped: instructions are counted in optimised programs only, see --release");
    }
    is_there && (is_needed || !cfg!(debug_assertions))
}

/// Counts again, at most twice, before it complains.
fn assert_free(what: &str, base: Count, count: impl Fn() -> Count) {
    let mut with = count();
    for _ in 0..2 {
        if with.of_samples() <= ALLOWED * base.of_samples() {
            break;
        }
        with = with.or_less(count());
    }
    let ratio = with.of_samples() / base.of_samples();
    eprintln!("{ratio:.6} {what}");
    assert!(ratio <= ALLOWED, "{what}: {ratio:.5} times the instructions");
}

#[test]
fn what_a_text_declares_in_vain_costs_nothing() {
    if !can_count() {
        return;
    }
    let bench = Bench::new();
    bench.write("a.pts", TEXT);
    let base = bench.count("a.pts", &[]).or_less(bench.count("a.pts", &[]));
    for (what, old, new) in IN_TEXT {
        let text = match old {
            "" => format!("{TEXT}{new}\n"),
            old => TEXT.replacen(old, new, 1),
        };
        assert_ne!(text, TEXT, "{what}");
        bench.write("b.pts", &text);
        assert_free(what, base, || bench.count("b.pts", &[]));
    }
}

#[test]
fn what_a_model_declares_in_vain_costs_nothing() {
    if !can_count() {
        return;
    }
    let bench = Bench::new();
    bench.write("a.mtl", MATERIAL);
    let base = bench.count("a.obj", &[]).or_less(bench.count("a.obj", &[]));
    for (what, more) in IN_MODEL {
        bench.write("a.mtl", &format!("{MATERIAL}{more}"));
        assert_free(what, base, || bench.count("a.obj", &[]));
    }
}

/// A scene of plain surfaces takes at most 0.95 of what it takes when every effect is carried along, and media alone,
/// which have a kernel of their own, are more than a run-time question.
#[test]
fn the_kernel_of_plain_surfaces_is_cheaper_than_that_of_everything() {
    if !can_count() {
        return;
    }
    let bench = Bench::new();
    let plain = TEXT.replace("glass { color rgb 1 ior 1.5 }", "specular { color rgb 0.9 }");
    for (name, text) in [("plain.pts", plain.as_str()), ("glass.pts", TEXT)] {
        bench.write(name, text);
        let own = bench.count(name, &[]).of_samples();
        let all = bench.count(name, &["--force-effects", "all"]).of_samples();
        eprintln!("{:.4} {name}", own / all);
        assert!(own <= 0.95 * all, "{name}: {:.4} of all effects", own / all);
    }
}

/// The same things do cost something where they are not pruned: the tests above would see it.
#[test]
fn without_pruning_the_count_is_higher() {
    if !can_count() {
        return;
    }
    let bench = Bench::new();
    bench.write("a.mtl", MATERIAL);
    let base = bench.count("a.obj", &["--no-prune"]).of_samples();
    bench.write("a.mtl", &format!("{MATERIAL}map_d white.png\nnorm flat.png\n"));
    let ratio = bench.count("a.obj", &["--no-prune"]).of_samples() / base;
    assert!(ratio > ALLOWED, "an alpha map and a normal map cost {ratio:.5}");
}
