//! Whether error goals keep their promise, on five kinds of scene: a run that stops at `--error E` is within E in at
//! least 90 % of runs, takes hardly more samples than somebody would who knew the truth, and foretells when it ends.
//!
//! The truth of a run is the mean of all other runs, whose own noise is subtracted. The small version runs with all
//! tests. The full one, whose results stand in docs/accuracy.md, takes about an hour on two cores:
//! `cargo test --release --test calibration -- --ignored --nocapture` (PTS_SEEDS, PTS_GOALS, PTS_CAP, PTS_NETS and
//! PTS_KINDS change it).

mod support;

use pts::math::color::luminance_f64 as luminance;
use pts::render::driver::{self, Continuity};
use pts::render::forecast::{Forecast, Look};
use pts::render::pixels::{Pixels, Rows};
use pts::render::report::Silent;
use pts::render::settings::Settings;
use rayon::prelude::*;
use support::scenes;

const SIZE: [u32; 2] = [32, 24];
const KINDS: [&str; 5] = ["diffuse_room", "glass_caustic", "sky", "many_lamps", "glossy_interior"];

/// A run at one of its looks.
struct Sight {
    spp: u32,
    error: f64,
    bound: f64,
    doubtful: bool,
    rgb: Vec<[f32; 3]>,
}

/// One seed: its looks up to the smallest goal or the cap.
struct Story {
    sights: Vec<Sight>,
}

/// How one goal fared on one scene.
#[derive(Default)]
struct Score {
    runs: usize,
    stopped: usize,
    kept: usize,
    samples: f64,
    /// First looks at which the truth was within the goal, of the same runs.
    needed: f64,
    /// Forecasts of the remaining samples at a quarter of the run, over the truth.
    foretold: Vec<f64>,
    doubtful: usize,
}

/// The looks of a run: 64, then eight in an octave.
fn next_look(spp: u32, nets: u32) -> u32 {
    if spp == 0 {
        return 64;
    }
    spp + ((1u32 << spp.ilog2()) / 8).next_multiple_of(nets)
}

fn tell(ready: &scenes::Ready, seed: u64, nets: u32, least_goal: f64, cap: u32) -> Story {
    let mut sights = Vec::new();
    let mut kept: Option<Pixels> = None;
    let mut spp = 0;
    while spp < cap {
        spp = next_look(spp, nets).min(cap);
        let settings = Settings {
            seed,
            nets,
            ..Settings::new(SIZE[0], SIZE[1], spp)
        };
        let continuity = Continuity {
            kept: kept.as_ref(),
            checkpoint: None,
        };
        let rendered = driver::render_on(&ready.compiled, &settings, &Silent, continuity).expect("it goes on");
        let error = rendered.report.error.expect("there are several nets");
        sights.push(Sight {
            spp,
            error: error.error,
            bound: error.bound,
            doubtful: error.is_doubtful(),
            rgb: rendered.picture.rgb,
        });
        if error.bound <= least_goal {
            break;
        }
        kept = Some(Pixels {
            shape: rendered.tiles.shape(),
            rows: (0..SIZE[1]).map(|y| rendered.tiles.row(y)).collect(),
        });
    }
    Story { sights }
}

/// What all runs but one say about the truth: mean, and variance of that mean, weighted by samples.
struct Truth {
    mean: Vec<[f64; 3]>,
    weight: Vec<f64>,
    noise: f64,
}

fn truth_without(stories: &[Story], left_out: usize) -> Truth {
    let others: Vec<&Sight> = stories
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != left_out)
        .filter_map(|(_, s)| s.sights.last())
        .collect();
    let total: f64 = others.iter().map(|s| f64::from(s.spp)).sum();
    let pixels = others[0].rgb.len();
    let mean: Vec<[f64; 3]> = (0..pixels)
        .map(|p| {
            let channel = |c: usize| {
                others
                    .iter()
                    .map(|s| f64::from(s.spp) * f64::from(s.rgb[p][c]))
                    .sum::<f64>()
            };
            [0, 1, 2].map(|c| channel(c) / total)
        })
        .collect();
    let bright = mean.iter().map(|m| luminance(*m)).sum::<f64>() / pixels as f64;
    let weight: Vec<f64> = mean
        .iter()
        .map(|m| 1.0 / (luminance(*m).powi(2) + 1e-2 * bright * bright))
        .collect();
    // Variance of a weighted mean whose weights are the samples: Σ wᵢ(xᵢ − m)²/((k − 1)·Σ w).
    let k = others.len() as f64;
    let noise = (0..pixels)
        .map(|p| {
            let square = |c: usize| {
                let d = others
                    .iter()
                    .map(|s| f64::from(s.spp) * (f64::from(s.rgb[p][c]) - mean[p][c]).powi(2));
                d.sum::<f64>() / ((k - 1.0) * total)
            };
            weight[p] * (square(0) + square(1) + square(2)) / 3.0
        })
        .sum::<f64>()
        / pixels as f64;
    Truth { mean, weight, noise }
}

impl Truth {
    fn error_of(&self, rgb: &[[f32; 3]]) -> f64 {
        let squares = rgb
            .iter()
            .zip(&self.mean)
            .zip(&self.weight)
            .map(|((x, m), w)| w * (0..3).map(|c| (f64::from(x[c]) - m[c]).powi(2)).sum::<f64>() / 3.0);
        (squares.sum::<f64>() / rgb.len() as f64 - self.noise).max(0.0).sqrt()
    }
}

/// The remaining samples that the run foretells a quarter of its way to the look at which it stops, over the truth.
fn forecast(story: &Story, stop: usize, goal: f64) -> Option<f64> {
    let end = f64::from(story.sights[stop].spp);
    let quarter = story.sights.iter().rposition(|s| f64::from(s.spp) <= 0.25 * end)?;
    let looks: Vec<Look> = story.sights[..=quarter]
        .iter()
        .map(|s| Look {
            spp: f64::from(s.spp),
            error: s.error,
            bound: s.bound,
        })
        .collect();
    let now = &story.sights[quarter];
    let [from, to] = Forecast::from_looks(&looks, 1.0, Some(now.bound / goal))?.to_goal?;
    Some((from * to).sqrt() / (end - f64::from(now.spp)))
}

/// A run that stopped.
struct Stop {
    kept: bool,
    samples: f64,
    needed: f64,
    foretold: Option<f64>,
    doubtful: bool,
}

fn scores(kind: &str, seeds: u64, nets: u32, goals: &[f64], cap: u32) -> Vec<Score> {
    let ready = scenes::ready(&format!("tests/calibration/{kind}.pts"), &[], SIZE);
    let least = goals.iter().copied().fold(f64::INFINITY, f64::min);
    let stories: Vec<Story> = (0..seeds)
        .into_par_iter()
        .map(|seed| tell(&ready, 1000 + seed, nets, least, cap))
        .collect();
    let judged: Vec<Vec<Option<Stop>>> = (0..stories.len())
        .into_par_iter()
        .map(|i| {
            let (story, truth) = (&stories[i], truth_without(&stories, i));
            let errors: Vec<f64> = story.sights.iter().map(|s| truth.error_of(&s.rgb)).collect();
            let judge = |goal: &f64| {
                let stop = story.sights.iter().position(|s| s.bound <= *goal)?;
                let needed = errors.iter().position(|e| e <= goal).unwrap_or(stop);
                let sight = &story.sights[stop];
                Some(Stop {
                    kept: errors[stop] <= *goal,
                    samples: f64::from(sight.spp),
                    needed: f64::from(story.sights[needed].spp),
                    foretold: forecast(story, stop, *goal),
                    doubtful: sight.doubtful,
                })
            };
            goals.iter().map(judge).collect()
        })
        .collect();
    let score = |g: usize| {
        let mut score = Score {
            runs: stories.len(),
            ..Score::default()
        };
        for stop in judged.iter().filter_map(|j| j[g].as_ref()) {
            score.stopped += 1;
            score.kept += usize::from(stop.kept);
            score.samples += stop.samples;
            score.needed += stop.needed;
            score.doubtful += usize::from(stop.doubtful);
            score.foretold.extend(stop.foretold);
        }
        score.foretold.sort_by(f64::total_cmp);
        score
    };
    (0..goals.len()).map(score).collect()
}

impl Score {
    /// Forecasts within ×0.6 … ×1.5.
    fn near(&self) -> usize {
        self.foretold.iter().filter(|r| (0.6..=1.5).contains(*r)).count()
    }

    /// The 5th, 50th and 95th percentile of the forecasts.
    fn quantiles(&self) -> String {
        let at = |q: f64| self.foretold.get((q * self.foretold.len() as f64) as usize);
        let text = |v: Option<&f64>| v.map_or("-".to_owned(), |v| format!("{v:.2}"));
        [0.05, 0.5, 0.95].map(|q| text(at(q))).join(" / ")
    }
}

fn line(kind: &str, goal: f64, s: &Score) -> String {
    let n = s.stopped.max(1) as f64;
    format!(
        "| {kind} | {:.0} % | {} of {} | {:.0} % | {:.0} | {:.0} | {:.2} | {} of {} | {} | {} |",
        100.0 * goal,
        s.stopped,
        s.runs,
        100.0 * s.kept as f64 / n,
        s.samples / n,
        s.needed / n,
        s.samples / s.needed.max(1.0),
        s.near(),
        s.foretold.len(),
        s.quantiles(),
        s.doubtful
    )
}

const HEAD: &str = "| scene | goal | runs that stop | promise kept | samples | needed | ratio | forecasts within ×0.6…×1.5 | forecast/truth 5, 50, 95 % | doubtful |\n|---|---|---|---|---|---|---|---|---|---|";

/// 5 scenes of 14 seeds with one goal each: of 70 promises at 90 %, 54 or fewer are kept with p = 0.002 (binomial); the
/// seeds are fixed. The limit for the price has the 1.35 of a hundred seeds widened by what 14 leave open.
#[test]
fn error_goals_are_kept_and_not_overpaid() {
    let goals = [0.12, 0.2, 0.05, 0.2, 0.15];
    let (mut stopped, mut kept, mut foretold) = (0, 0, [0, 0]);
    println!("{HEAD}");
    for (kind, goal) in KINDS.iter().zip(goals) {
        let score = &scores(kind, 14, 4, &[goal], 2048)[0];
        println!("{}", line(kind, goal, score));
        assert_eq!(score.stopped, score.runs, "{kind} does not reach {goal}");
        let most = if *kind == "glass_caustic" { 2.2 } else { 1.5 };
        assert!(
            score.samples / score.needed < most,
            "{kind}: {} for {}",
            score.samples,
            score.needed
        );
        stopped += score.stopped;
        kept += score.kept;
        foretold[0] += score.foretold.len();
        foretold[1] += score.near();
    }
    assert_eq!(stopped, 70);
    assert!(kept >= 55, "{kept} of {stopped} promises were kept");
    assert!(foretold[1] * 4 >= foretold[0] * 3, "{foretold:?} forecasts are near");
}

fn number<T: std::str::FromStr>(name: &str, otherwise: T) -> T {
    let value = std::env::var(name).ok();
    value.map_or(otherwise, |v| {
        v.parse().unwrap_or_else(|_| panic!("{name} is no number: {v}"))
    })
}

/// The table of docs/accuracy.md.
#[test]
#[ignore = "takes about an hour"]
fn calibration_in_full() {
    let goals = std::env::var("PTS_GOALS").unwrap_or("0.1,0.05,0.02".to_owned());
    let goals: Vec<f64> = goals
        .split(',')
        .map(|g| g.parse().expect("a goal is a fraction"))
        .collect();
    let kinds = std::env::var("PTS_KINDS").unwrap_or(KINDS.join(","));
    let (seeds, cap, nets) = (
        number("PTS_SEEDS", 100),
        number("PTS_CAP", 65536),
        number("PTS_NETS", 4),
    );
    println!("{HEAD}");
    for kind in kinds.split(',') {
        for (goal, score) in goals.iter().zip(scores(kind, seeds, nets, &goals, cap)) {
            println!("{}", line(kind, *goal, &score));
        }
    }
}

/// What nets cost: the variance of R nets over that of one, at equal samples.
#[test]
#[ignore = "takes minutes"]
fn the_price_of_nets() {
    let seeds: u64 = number("PTS_SEEDS", 24);
    println!("| scene | samples | E with 1 net | 4 nets | 8 nets | 16 nets |\n|---|---|---|---|---|---|");
    for kind in KINDS {
        let ready = scenes::ready(&format!("tests/calibration/{kind}.pts"), &[], SIZE);
        for spp in [64, 256, 1024] {
            let square = [1, 4, 8, 16].map(|nets| {
                let shots: Vec<Story> = (0..seeds)
                    .into_par_iter()
                    .map(|seed| {
                        let settings = Settings {
                            seed: 5000 + seed,
                            nets,
                            ..Settings::new(SIZE[0], SIZE[1], spp)
                        };
                        let (picture, _) = driver::render(&ready.compiled, &settings, &Silent);
                        let sight = Sight {
                            spp,
                            error: 0.0,
                            bound: 0.0,
                            doubtful: false,
                            rgb: picture.rgb,
                        };
                        Story { sights: vec![sight] }
                    })
                    .collect();
                let errors = (0..shots.len()).into_par_iter();
                let squares = errors.map(|i| truth_without(&shots, i).error_of(&shots[i].sights[0].rgb).powi(2));
                squares.sum::<f64>() / seeds as f64
            });
            let price = [1, 2, 3].map(|i| format!("{:.2}", square[i] / square[0]));
            println!(
                "| {kind} | {spp} | {:.1} % | {} |",
                100.0 * square[0].sqrt(),
                price.join(" | ")
            );
        }
    }
}
