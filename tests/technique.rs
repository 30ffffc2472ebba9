//! What trades accuracy for time: choices that change only the noise give the expected picture of the default, and
//! biased ones do what they say and nothing else. All seeds are fixed.

mod support;

use assert_cmd::Command;
use glam::{DAffine2, DVec3, Vec2};
use pts::compile::compile_with;
use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::render::driver;
use pts::render::report::Silent;
use pts::render::settings::{Filter, Settings};
use pts::render::technique::{BuildPreset, Direct, LightPick, Roulette, SamplerKind, Technique, TextureFilter};
use pts::scene::{
    Camera, Encoding, Image, ImageSource, ImageTexture, Material, Mesh, Object, Place, Projection, Scene, Shape,
    TexelFilter, Texture, Wrap,
};
use support::scenes::{Shot, bits, ready_for, settings};
use support::ztest;

const CORNELL: &str = "scenes/cornell.pts";
const LIGHTS: &str = "tests/technique/lights.pts";
const SIZE: [u32; 2] = [32, 24];

/// Pictures that agree are told apart once in a thousand draws of the seed, for each comparison.
const ALPHA: f64 = 1e-3;

fn shoot(technique: &Technique, scene: &str, spp: u32, seed: u64) -> Shot {
    let settings = Settings {
        technique: *technique,
        ..settings(SIZE, spp, seed)
    };
    ready_for(technique, scene, &[], SIZE).shoot(&settings)
}

fn with(change: impl FnOnce(&mut Technique)) -> Technique {
    let mut technique = Technique::default();
    change(&mut technique);
    technique
}

#[test]
fn choices_that_only_change_the_noise_agree_with_the_default() {
    let independent = with(|t| t.sampler = SamplerKind::Independent);
    let late = with(|t| t.roulette = Roulette::Late);
    let by_power = with(|t| t.lights = LightPick::Power);
    let uniform = with(|t| t.lights = LightPick::Uniform);
    let high = with(|t| t.build = BuildPreset::High);
    for (scene, variants) in [
        (CORNELL, vec![independent, late]),
        (LIGHTS, vec![independent, by_power, uniform, high]),
        ("tests/golden/many_lamps.pts", vec![by_power, uniform]),
    ] {
        let expected = shoot(&Technique::default(), scene, 256, 1).estimate;
        for (seed, technique) in (2..).zip(&variants) {
            let found = shoot(technique, scene, 256, seed).estimate;
            let verdict = ztest::compare(&found, &expected, 4, ALPHA);
            assert!(verdict.agree(), "{scene} with {:?}: {verdict}", technique.flags());
            // The test can fail: another picture is told apart.
            let mut brighter = found;
            brighter.mean.iter_mut().flatten().for_each(|v| *v *= 1.05);
            assert!(
                !ztest::compare(&brighter, &expected, 4, ALPHA).agree(),
                "{scene}: too noisy to judge"
            );
        }
    }
}

/// Variance of the mean of 64 samples from eight independent runs of one net each, summed over the picture.
fn variance(technique: &Technique) -> f64 {
    let ready = ready_for(technique, "tests/technique/smooth.pts", &[], SIZE);
    let runs: Vec<_> = (0..8)
        .map(|seed| {
            let settings = Settings {
                technique: *technique,
                nets: 1,
                ..settings(SIZE, 64, 100 + seed)
            };
            ready.shoot(&settings).estimate.mean
        })
        .collect();
    let n = runs.len() as f64;
    (0..runs[0].len())
        .map(|i| {
            let mean = runs.iter().map(|r| r[i][0]).sum::<f64>() / n;
            runs.iter().map(|r| (r[i][0] - mean).powi(2)).sum::<f64>() / (n - 1.0)
        })
        .sum()
}

/// 768 pixels of 7 degrees of freedom each know the ratio to a few percent; it was 83 when this was written.
#[test]
fn nets_are_four_times_better_at_smooth_direct_light_at_least() {
    let direct = |sampler| with(|t| (t.sampler, t.max_depth) = (sampler, 1));
    let ratio = variance(&direct(SamplerKind::Independent)) / variance(&direct(SamplerKind::Sobol));
    println!("variance of independent numbers over that of nets: {ratio:.1}");
    assert!(ratio > 4.0, "ratio {ratio}");
}

#[test]
fn a_limit_scales_single_samples_and_counts_them() {
    let limit = 0.5;
    let one = |technique: &Technique| {
        let settings = Settings {
            technique: *technique,
            nets: 1,
            ..settings(SIZE, 1, 3)
        };
        ready_for(technique, CORNELL, &[], SIZE).shoot(&settings)
    };
    let (free, clamped) = (one(&Technique::default()), one(&with(|t| t.clamp = Some(limit))));
    let mut bright = 0;
    for (free, clamped) in free.picture.rgb.iter().zip(&clamped.picture.rgb) {
        let brightest = free.iter().copied().fold(0.0, f32::max);
        if brightest <= limit {
            assert_eq!(free.map(f32::to_bits), clamped.map(f32::to_bits));
            continue;
        }
        bright += 1;
        for (a, b) in free.iter().zip(clamped) {
            assert!((a / brightest * limit - b).abs() < 1e-6, "{free:?} became {clamped:?}");
        }
    }
    assert!(bright > 50, "only {bright} bright samples: nothing to see");
    assert_eq!((free.report.clamped, clamped.report.clamped), (0, bright));
}

#[test]
fn a_limit_never_brightens_and_leaves_darker_pictures_alone() {
    let free = shoot(&Technique::default(), CORNELL, 32, 4);
    let clamped = shoot(&with(|t| t.clamp = Some(1.0)), CORNELL, 32, 4);
    assert_never_brighter(&free, &clamped);
    assert!(clamped.report.clamped > 0);
    let high = shoot(&with(|t| t.clamp = Some(1e6)), CORNELL, 32, 4);
    assert_eq!(high.report.clamped, 0);
    assert!(bits(&high.picture) == bits(&free.picture));
}

#[track_caller]
fn assert_never_brighter(free: &Shot, less: &Shot) {
    for (a, b) in free.picture.rgb.iter().zip(&less.picture.rgb) {
        assert!(a.iter().zip(b).all(|(a, b)| b <= a), "{a:?} became {b:?}");
    }
}

fn sum(shot: &Shot) -> f64 {
    shot.picture.rgb.iter().flatten().map(|v| f64::from(*v)).sum()
}

/// The same random numbers: a path without the light of caustics is the same path.
#[test]
fn caustics_are_what_is_lost_without_them() {
    let without = with(|t| t.caustics = false);
    for scene in [LIGHTS, "tests/technique/mirror.pts"] {
        let (all, less) = (
            shoot(&Technique::default(), scene, 32, 5),
            shoot(&without, scene, 32, 5),
        );
        assert!(sum(&all) > 0.0, "{scene} is black");
        assert!(bits(&all.picture) == bits(&less.picture), "{scene} has no caustics");
    }
    let (all, less) = (
        shoot(&Technique::default(), CORNELL, 64, 6),
        shoot(&without, CORNELL, 64, 6),
    );
    assert_never_brighter(&all, &less);
    let lost = 1.0 - sum(&less) / sum(&all);
    println!("caustics of the classic box: {:.1} % of the light", 100.0 * lost);
    assert!((0.005..0.5).contains(&lost), "{lost} of the light is lost");
}

/// What counts as a mirror is decided alike for light samples and for hits, or the ways of finding direct light would
/// lose different light.
#[test]
fn all_ways_of_finding_direct_light_lose_the_same_caustics() {
    let scene = "tests/technique/caustics.pts";
    let [mis, light, bsdf] = [(Direct::Mis, 256), (Direct::Light, 512), (Direct::Bsdf, 512)].map(|(direct, spp)| {
        let technique = with(|t| (t.direct, t.caustics) = (direct, false));
        shoot(&technique, scene, spp, 9 + direct as u64).estimate
    });
    for (name, other) in [("light", &light), ("bsdf", &bsdf)] {
        let verdict = ztest::compare(other, &mis, 4, ALPHA);
        assert!(verdict.agree(), "{name}: {verdict}");
    }
    // There is something to lose, and these samples are enough to see it.
    let all = shoot(&Technique::default(), scene, 256, 12).estimate;
    let verdict = ztest::compare(&all, &mis, 4, ALPHA);
    assert!(!verdict.agree(), "no caustics are seen: {verdict}");
}

#[test]
fn what_rays_hit_does_not_depend_on_how_the_tree_was_built() {
    for scene in ["tests/technique/heap.pts", "tests/golden/model_obj.pts"] {
        let [fast, medium, high] = [BuildPreset::Fast, BuildPreset::Medium, BuildPreset::High]
            .map(|build| bits(&shoot(&with(|t| t.build = build), scene, 16, 7).picture));
        assert!(fast == medium && medium == high, "{scene}");
    }
}

/// Without what facets give one another the picture of rough things is darker, but for noise of one in a thousand.
#[test]
fn rough_surfaces_lose_light_without_multiple_scattering() {
    let scene = "tests/golden/materials.pts";
    let all = shoot(&Technique::default(), scene, 64, 8).estimate;
    let less = shoot(&with(|t| t.multiple_scattering = false), scene, 64, 8).estimate;
    let total = |e: &support::estimate::Estimate| e.mean.iter().flatten().sum::<f64>();
    assert!(
        total(&less) < 0.999 * total(&all),
        "{} of {}",
        total(&less),
        total(&all)
    );
}

/// A square of 2x2 texels that shines by itself, seen without perspective.
fn shining_square() -> Scene {
    let mut scene = Scene::default();
    scene.cameras.push(Camera {
        location: DVec3::new(0.0, 0.0, -1.0),
        direction: DVec3::Z,
        right: DVec3::X,
        up: DVec3::Y,
        projection: Projection::Orthographic,
        ..Camera::default()
    });
    scene.active_camera = Some(0);
    let image = scene.add_image(Image {
        name: "texels".to_owned(),
        source: ImageSource::Pixels {
            width: 2,
            height: 2,
            data: TEXELS.to_vec().into(),
        },
        fallback: None,
        place: Place::None,
    });
    let texture = scene.add_texture(Texture::Image(ImageTexture {
        image,
        uv_set: 0,
        uv_transform: DAffine2::IDENTITY,
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        filter: TexelFilter::Bilinear,
        encoding: Encoding::Linear,
    }));
    let mut material = Material::diffuse(DVec3::ZERO).emitting(DVec3::ONE);
    material.emission.texture = Some(texture);
    let material = scene.add_material(material);
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    let positions = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
    let mut mesh = Mesh::from_f64("square", &positions, &[[0, 2, 1], [0, 3, 2]]).expect("a mesh");
    mesh.uvs = vec![corners.map(|(x, y)| Vec2::new(x as f32 + 0.5, 0.5 - y as f32)).to_vec()];
    let mesh = scene.add_mesh(mesh);
    scene
        .objects
        .push(Object::new(Shape::Mesh(mesh)).with_material(material));
    scene
}

const TEXELS: [[f32; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.25, 0.5, 0.75]];

#[test]
fn the_nearest_texel_is_what_is_seen() {
    let colors = |technique: &Technique| {
        let (scene, mut diags) = (shining_square(), Diagnostics::default());
        let compiled = compile_with(&scene, &MemoryFiles::default(), 16, 16, technique, &mut diags);
        let compiled = compiled.expect("the scene compiles");
        let settings = Settings {
            filter: Filter::Box,
            technique: *technique,
            ..Settings::new(16, 16, 4)
        };
        driver::render(&compiled, &settings, &Silent).0.rgb
    };
    let nearest = colors(&with(|t| t.textures = TextureFilter::Nearest));
    for (i, found) in nearest.iter().enumerate() {
        let (x, y) = (i % 16 / 8, i / 16 / 8);
        let expected = TEXELS[2 * y + x];
        let near = found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near, "pixel {i} is {found:?}, its texel {expected:?}");
    }
    let smooth = colors(&Technique::default());
    let between = smooth.iter().zip(&nearest).filter(|(a, b)| (a[0] - b[0]).abs() > 0.01);
    assert!(between.count() > 64, "as written it is bilinear");
}

/// A directory of its own and the program in it.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary directory"));
        std::fs::copy(
            support::scenes::path("tests/cli/ball.pts"),
            bench.0.path().join("ball.pts"),
        )
        .expect("the scene is copied");
        bench
    }

    /// What is said on standard error; the exit code is as expected.
    #[track_caller]
    fn run(&self, words: &str, code: i32) -> String {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        let command = command.current_dir(self.0.path()).args(words.split_whitespace());
        let output = command.env("NO_COLOR", "1").output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{words}: {said}");
        said
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn holds(&self, name: &str, text: &str) -> bool {
        self.bytes(name).windows(text.len()).any(|w| w == text.as_bytes())
    }
}

const ALL_FLAGS: &str = "--sampler independent --direct light --lights power --roulette late --build fast \
     --max-depth 6 --fresnel schlick --no-multiple-scattering --texture-filter nearest --clamp 0.25 --no-caustics";

#[test]
fn flags_are_replayed_stamped_and_told() {
    let bench = Bench::new();
    let said = bench.run(&format!("ball.pts -r 16x12 -s 4 -o a.png -o a.exr {ALL_FLAGS}"), 0);
    let biased = said
        .lines()
        .find_map(|l| l.trim().strip_prefix("biased: "))
        .expect("biases are told");
    for flag in [
        "--max-depth 6",
        "--fresnel schlick",
        "--no-multiple-scattering",
        "--texture-filter nearest",
        "--clamp 0.25 (",
        " samples clamped)",
        "--no-caustics",
    ] {
        assert!(biased.contains(flag), "`{flag}` is not in {biased}");
    }
    assert!(!biased.contains("--sampler"), "{biased}");
    assert!(!biased.contains("(0 samples"), "{biased}");
    for name in ["a.png", "a.exr"] {
        assert!(bench.holds(name, biased), "{name} does not say `{biased}`");
        assert!(
            bench.holds(name, "--sampler independent"),
            "{name} does not name its technique"
        );
    }
    let replay = said
        .lines()
        .find_map(|l| l.trim().strip_prefix("again: pts "))
        .expect("a replay is told");
    bench.run(&replay.replace("a.png", "b.png").replace("a.exr", "b.exr"), 0);
    assert!(
        bench.bytes("a.png") == bench.bytes("b.png"),
        "`{replay}` makes another picture"
    );
}

#[test]
fn the_usual_technique_is_not_stamped_and_nonsense_is_refused() {
    let bench = Bench::new();
    let said = bench.run(
        "ball.pts -r 8x8 -s 1 -o a.png --sampler sobol --fresnel exact --build medium",
        0,
    );
    assert!(!said.contains("biased"), "{said}");
    assert!(!bench.holds("a.png", "biased") && !bench.holds("a.png", "technique"));
    for flags in [
        "--sampler dice",
        "--clamp 0",
        "--clamp -1",
        "--clamp nan",
        "--lights 3",
        "--fresnel",
    ] {
        bench.run(&format!("ball.pts {flags}"), 2);
    }
    let said = bench.run("ball.pts --roulette never", 2);
    assert!(said.contains("throughput") && said.contains("late"), "{said}");
}

#[test]
fn parts_of_another_technique_are_refused_and_biases_survive_a_merge() {
    let bench = Bench::new();
    let part = |samples: &str, flags: &str, name: &str| {
        bench.run(
            &format!("ball.pts -r 16x12 --samples {samples} {flags} -o {name}.ptspart"),
            0,
        );
    };
    part("0..4", "--clamp 0.25", "a");
    part("4..8", "--clamp 0.25", "b");
    part("4..8", "", "c");
    part("4..8", "--clamp 0.25 --sampler independent", "d");
    for other in ["c", "d"] {
        let said = bench.run(&format!("merge a.ptspart {other}.ptspart -o m.png"), 1);
        assert!(
            said.contains("another picture") && said.contains("technique is"),
            "{said}"
        );
    }
    bench.run("merge b.ptspart a.ptspart -o m.png", 0);
    let said = bench.run("ball.pts -r 16x12 -s 8 --clamp 0.25 -o whole.png", 0);
    let biased = said
        .lines()
        .find_map(|l| l.trim().strip_prefix("biased: "))
        .expect("biases are told");
    assert!(
        bench.holds("m.png", biased),
        "the merged picture does not say `{biased}`"
    );
}
