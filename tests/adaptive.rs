//! Adaptive sampling: the expected picture is that of uniform sampling, the bits do not depend on threads, samples go
//! where the noise is, and the error that is told is the error there is. All seeds are fixed.

mod support;

use pts::math::color::luminance_f64 as luminance;
use pts::render::settings::Settings;
use pts::render::technique::{SamplerKind, Technique};
use rayon::prelude::*;
use support::estimate::Estimate;
use support::scenes::{Ready, bits, ready};
use support::ztest;

const HORIZON: &str = "tests/stops/horizon.pts";
const CAUSTIC: &str = "tests/calibration/glass_caustic.pts";
const SIZE: [u32; 2] = [32, 32];

fn settings(adaptive: bool, spp: u32, seed: u64) -> Settings {
    Settings {
        seed,
        technique: Technique {
            adaptive,
            ..Technique::default()
        },
        ..Settings::new(SIZE[0], SIZE[1], spp)
    }
}

/// A run: its picture, and the error it tells.
struct Run {
    rgb: Vec<[f64; 3]>,
    error: f64,
    bound: f64,
    samples: u64,
}

fn runs(ready: &Ready, adaptive: bool, spp: u32, seeds: std::ops::Range<u64>) -> Vec<Run> {
    let run = |seed| {
        let shot = ready.shoot(&settings(adaptive, spp, seed));
        let told = shot.report.error.expect("there are enough samples");
        Run {
            rgb: shot.picture.rgb.iter().map(|v| v.map(f64::from)).collect(),
            error: told.error,
            bound: told.bound,
            samples: shot.report.samples,
        }
    };
    seeds.into_par_iter().map(run).collect()
}

/// The mean of runs, and its variance from the spread between them: nothing that a run says of itself goes in.
fn mean(runs: &[Run]) -> Estimate {
    let n = runs.len() as f64;
    let pixel = |i: usize| {
        [0, 1, 2].map(|c| {
            let mean = runs.iter().map(|r| r.rgb[i][c]).sum::<f64>() / n;
            let squares = runs.iter().map(|r| (r.rgb[i][c] - mean) * (r.rgb[i][c] - mean));
            (mean, squares.sum::<f64>() / (n - 1.0) / n)
        })
    };
    let pixels: Vec<[(f64, f64); 3]> = (0..runs[0].rgb.len()).map(pixel).collect();
    Estimate {
        width: SIZE[0] as usize,
        height: SIZE[1] as usize,
        mean: pixels.iter().map(|p| p.map(|(mean, _)| mean)).collect(),
        variance: pixels.iter().map(|p| p.map(|(_, variance)| variance)).collect(),
    }
}

/// E as `docs/accuracy.md` defines it.
fn relative_error(rgb: &[[f64; 3]], truth: &Estimate) -> f64 {
    let pixels = rgb.len() as f64;
    let level = truth.mean.iter().map(|m| luminance(*m)).sum::<f64>() / pixels;
    let term = |(x, m): (&[f64; 3], &[f64; 3])| {
        let squares: f64 = (0..3).map(|c| (x[c] - m[c]) * (x[c] - m[c])).sum();
        squares / 3.0 / (luminance(*m).powi(2) + 1e-2 * level * level)
    };
    (rgb.iter().zip(&truth.mean).map(term).sum::<f64>() / pixels).sqrt()
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = values.fold((0.0, 0.0), |(n, s), v| (n + 1.0, s + v * v));
    (sum / n).sqrt()
}

/// Blocks of 4x4 pixels and the whole image; equal pictures are told apart once in a thousand choices of the seeds, for
/// each scene. That more samples are drawn where bright finds were made could show as a loss of light where such finds
/// are rare: hence the caustic.
#[test]
fn no_bias_of_adaptive_sampling_is_seen() {
    for (scene, seeds) in [(HORIZON, 32), (CAUSTIC, 48)] {
        let ready = ready(scene, &[], SIZE);
        let uniform = mean(&runs(&ready, false, 128, 1..1 + seeds));
        let adaptive = mean(&runs(&ready, true, 128, 1001..1001 + seeds));
        let verdict = ztest::compare(&adaptive, &uniform, 4, 1e-3);
        println!("{scene}: {verdict}");
        assert!(verdict.agree(), "{scene}: {verdict}");
        // The test can fail: two percent less light are seen.
        let darker = Estimate {
            mean: adaptive.mean.iter().map(|m| m.map(|v| 0.98 * v)).collect(),
            ..adaptive
        };
        let verdict = ztest::compare(&darker, &uniform, 4, 1e-3);
        assert!(!verdict.agree(), "{scene}, darker: {verdict}");
    }
}

#[test]
fn adaptive_pictures_have_the_same_bits_with_any_number_of_threads() {
    let size = [40, 30];
    let ready = ready(HORIZON, &[], size);
    let settings = |adaptive| Settings {
        width: size[0],
        height: size[1],
        region: pts::render::settings::Region::whole(size[0], size[1]),
        ..settings(adaptive, 128, 1)
    };
    let shoot = |threads: usize, adaptive: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let shot = pool
            .expect("a thread pool")
            .install(|| ready.shoot(&settings(adaptive)));
        (bits(&shot.picture), shot.report.spp, shot.report.samples)
    };
    let one = shoot(1, true);
    for threads in [2, 3] {
        assert!(one == shoot(threads, true), "{threads} threads");
    }
    assert!(one != shoot(1, false), "samples are not divided at all");
}

/// Half of the picture has no noise: with the first 64 samples as all it gets, 1.75 times the average is left for the
/// other half, and E falls to 1/√1.75 = 0.756 where it falls like n^-½ and the noise is even. Nets lose something where
/// their points are no power of two: hence the margin. Each run is compared with the mean of all others, which adds
/// 1/63 to E² in both.
#[test]
fn samples_go_where_the_noise_is_and_the_error_told_is_right() {
    let spp = 256;
    let ready = ready(HORIZON, &[], SIZE);
    let (uniform, adaptive) = (runs(&ready, false, spp, 1..33), runs(&ready, true, spp, 1001..1033));
    let pixels = u64::from(SIZE[0] * SIZE[1]);
    for run in &adaptive {
        let spent = run.samples as f64 / (pixels * u64::from(spp)) as f64;
        assert!(
            (0.97..1.03).contains(&spent),
            "{spent} times the samples that were asked for"
        );
    }
    let all: Vec<&Run> = uniform.iter().chain(&adaptive).collect();
    let errors: Vec<f64> = all
        .par_iter()
        .enumerate()
        .map(|(i, run)| {
            let others = all.iter().enumerate().filter(|(k, _)| *k != i);
            let n = (all.len() - 1) as f64;
            let mut truth = vec![[0.0; 3]; run.rgb.len()];
            for (_, other) in others {
                for (sum, v) in truth.iter_mut().zip(&other.rgb) {
                    (0..3).for_each(|c| sum[c] += v[c] / n);
                }
            }
            let truth = Estimate {
                width: SIZE[0] as usize,
                height: SIZE[1] as usize,
                variance: Vec::new(),
                mean: truth,
            };
            relative_error(&run.rgb, &truth)
        })
        .collect();
    let (of_uniform, of_adaptive) = errors.split_at(uniform.len());
    let ratio = root_mean_square(of_adaptive.iter().copied()) / root_mean_square(of_uniform.iter().copied());
    println!("E of adaptive over uniform sampling: {ratio:.3}");
    assert!(
        (0.7..0.87).contains(&ratio),
        "E with adaptive sampling is {ratio:.3} times that without"
    );

    let told = root_mean_square(adaptive.iter().map(|r| r.error));
    let truth = root_mean_square(of_adaptive.iter().copied());
    println!("told {told:.5}, truth {truth:.5}");
    assert!(
        (0.95..1.25).contains(&(told / truth)),
        "told {told:.5}, truth {truth:.5}"
    );
    // A bound of 90 % confidence holds in fewer than 24 of 32 runs once in 270 choices of the seeds (binomial).
    let held = adaptive
        .iter()
        .zip(of_adaptive)
        .filter(|(run, truth)| **truth <= run.bound)
        .count();
    println!("bounds held: {held} of 32");
    assert!(held >= 24, "the bound held in {held} of 32 runs");
}

/// Powers of two only change exponents: the picture scales bit by bit, and the error, which is relative, does not
/// change at all.
#[test]
fn light_scaled_by_a_power_of_two_scales_the_picture_and_stops_at_the_same_samples() {
    for adaptive in [false, true] {
        let shoot = |factor: f64| {
            let mut settings = settings(adaptive, 4096, 3);
            settings.stop.error = Some(0.012);
            ready(HORIZON, &[("Light", &factor.to_string())], SIZE).shoot(&settings)
        };
        let plain = shoot(1.0);
        assert!((72..4096).contains(&plain.report.spp), "{} samples", plain.report.spp);
        for k in [-20, 3, 20] {
            let factor = 2f64.powi(k);
            let scaled = shoot(factor);
            assert_eq!(scaled.report.spp, plain.report.spp, "2^{k}, adaptive: {adaptive}");
            assert_eq!(scaled.report.error, plain.report.error, "2^{k}, adaptive: {adaptive}");
            let expected = plain.picture.rgb.iter().map(|v| v.map(|x| x * factor as f32));
            assert!(
                expected.eq(scaled.picture.rgb.iter().copied()),
                "2^{k}, adaptive: {adaptive}: the picture is not the scaled one"
            );
        }
    }
}

/// How fast the true error falls from 8 to 512 samples per pixel: −ΔlnE/ln 64, where E comes from the spread between
/// 12 runs at each. Its standard deviation is about 0.005 (256 pixels, 11 degrees of freedom each).
fn exponent(scene: &str, sampler: SamplerKind) -> f64 {
    let size = [16, 16];
    let ready = ready(scene, &[], size);
    let [few, many] = [8, 512].map(|spp| {
        let run = |seed: u64| {
            let shot = ready.shoot(&Settings {
                seed: seed + u64::from(spp),
                technique: Technique {
                    sampler,
                    ..Technique::default()
                },
                ..Settings::new(size[0], size[1], spp)
            });
            shot.picture.rgb
        };
        let runs: Vec<Vec<[f32; 3]>> = (0..12u64).into_par_iter().map(run).collect();
        let n = runs.len() as f64;
        let variance = |i: usize, c: usize| {
            let mean = runs.iter().map(|r| f64::from(r[i][c])).sum::<f64>() / n;
            let squares = runs.iter().map(|r| (f64::from(r[i][c]) - mean).powi(2));
            squares.sum::<f64>() / (n - 1.0) / (mean * mean)
        };
        let pixels = runs[0].len();
        let sum: f64 = (0..pixels).flat_map(|i| [0, 1, 2].map(|c| variance(i, c))).sum();
        (sum / (3 * pixels) as f64).sqrt()
    });
    (few / many).ln() / 64f64.ln()
}

/// Independent samples give n^-½ whatever the scene; nets are faster where what a pixel adds up is smooth.
#[test]
fn the_error_falls_as_theory_says() {
    let smooth = "tests/stops/smooth.pts";
    for scene in [smooth, HORIZON] {
        let plain = exponent(scene, SamplerKind::Independent);
        println!("{scene}, independent: {plain:.3}");
        assert!(
            (plain - 0.5).abs() < 0.03,
            "{scene}: E falls like n^-{plain:.3} with independent samples"
        );
    }
    let nets = exponent(smooth, SamplerKind::Sobol);
    println!("{smooth}, nets: {nets:.3}");
    assert!(nets > 0.7, "E falls like n^-{nets:.3} with nets");
}
