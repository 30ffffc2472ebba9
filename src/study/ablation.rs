//! What each effect of a scene costs and brings: the scene with and without it, at equal samples and with the same
//! seeds, in turns.
//!
//! Every decision of a path has random numbers of its own, so that a seed gives both pictures the same noise wherever
//! the effect plays no part. The differences are therefore taken seed by seed, and their spread over the seeds says
//! what noise is: an effect that does nothing comes out as exactly no difference.

use super::experiment::Ablation;
use super::metrics::mean_flip;
use super::workshop::{Clock, Compiled, Order, Shot, Stopped, Workshop};
use super::{Image, blocks::NoiseTest, luminance};
use crate::compile::effects::Effect;
use crate::diag::Diagnostics;
use crate::files::Files;
use crate::render::technique::Technique;
use crate::scene::Scene;
use std::time::Instant;

/// Columns and rows of the blocks that are tested.
const BLOCK_SIDE: u32 = 8;

/// A mean difference of this many standard errors is no noise (false alarms: 0.3 % for each of three channels).
const SIGNIFICANT: f64 = 3.0;

/// Fewest rounds that tell a spread.
const FEWEST_ROUNDS: usize = 3;

/// Most samples per pixel of a picture; more would tell nothing new.
const MOST_SPP: f64 = 1024.0;

/// What is weighed, and how.
pub struct Weighing<'a> {
    /// The scene as it is.
    pub scene: &'a Scene,
    /// Where its images are.
    pub files: &'a dyn Files,
    /// How it is rendered.
    pub technique: Technique,
    /// What is left out, one at a time.
    pub effects: &'a [Effect],
    /// Rounds: each renders all pictures with a seed of its own.
    pub seeds: &'a [u64],
    /// Seconds of a sample of each pixel, about.
    pub per_sample: f64,
    /// The clock, and the second at which everything must be done.
    pub clock: Clock,
    /// Seconds since the start.
    pub end: f64,
}

/// What came out.
#[derive(Default)]
pub struct Weighed {
    /// One for each effect that was measured.
    pub ablations: Vec<Ablation>,
    /// What was left out, and why.
    pub notes: Vec<String>,
    /// The user ended it.
    pub interrupted: bool,
}

impl Weighing<'_> {
    /// Weighs all effects as well as the time allows.
    pub fn run(&self, workshop: &mut Workshop) -> Result<Weighed, Stopped> {
        let mut weighed = Weighed::default();
        let mut scales = Vec::new();
        for effect in self.effects {
            let cut = effect.left_out(self.scene, &self.technique, self.files);
            match workshop.compile_other(&cut.scene, &cut.technique, &mut Diagnostics::default()) {
                Ok(compiled) => scales.push(Scale::new(*effect, compiled, cut.technique)),
                Err(reason) => weighed
                    .notes
                    .push(format!("effect {}: {reason} without it", effect.word())),
            }
        }
        let runs = (self.seeds.len() * (scales.len() + 1)) as f64;
        // Leaving something out seldom makes a picture dearer; a fifth is kept for that.
        let spp = (0.8 * (self.end - self.clock.elapsed()) / (runs * self.per_sample))
            .min(MOST_SPP)
            .floor();
        if spp < 1.0 || scales.is_empty() {
            if !scales.is_empty() {
                weighed.notes.push("effects: no time was left to weigh them".to_owned());
            }
            return Ok(weighed);
        }
        match self.rounds(workshop, &mut scales, spp as u32) {
            Ok(()) => {}
            Err(Stopped::Interrupted) => weighed.interrupted = true,
            Err(other) => return Err(other),
        }
        let rounds = scales.iter().map(|s| s.times.len()).min().unwrap_or(0);
        if rounds < FEWEST_ROUNDS {
            let why = if weighed.interrupted {
                "interrupted"
            } else {
                "no time was left to weigh them"
            };
            weighed.notes.push(format!("effects: {why}"));
        } else {
            if rounds < self.seeds.len() {
                weighed.notes.push(format!("effects: weighed with {rounds} seeds only"));
            }
            weighed.ablations = scales.iter().filter_map(Scale::read).collect();
        }
        Ok(weighed)
    }

    fn rounds(&self, workshop: &mut Workshop, scales: &mut [Scale], spp: u32) -> Result<(), Stopped> {
        for (round, seed) in self.seeds.iter().enumerate() {
            let begun = Instant::now();
            let order = |technique, what| Order {
                technique,
                threads: None,
                seed: *seed,
                spp,
                seconds: None,
                stage: "effects",
                what,
            };
            let with = workshop.shoot(&order(self.technique, "all effects"))?;
            for scale in scales.iter_mut() {
                let without = workshop.shoot_other(&scale.compiled, &order(scale.technique, scale.effect.word()))?;
                scale.add(&with, &without);
            }
            let is_last = round + 1 == self.seeds.len();
            if !is_last && self.clock.elapsed() + begun.elapsed().as_secs_f64() > self.end {
                break;
            }
        }
        Ok(())
    }
}

/// What is known of one effect so far.
struct Scale {
    effect: Effect,
    compiled: Compiled,
    technique: Technique,
    /// ln(seconds without / seconds with) of each round.
    times: Vec<f64>,
    /// Mean luminances with and without.
    energies: Vec<[f64; 2]>,
    size: [u32; 2],
    /// Of each pixel and channel: sums of the picture with, of the difference and of its square.
    sums: Vec<[[f64; 3]; 3]>,
}

impl Scale {
    fn new(effect: Effect, compiled: Compiled, technique: Technique) -> Scale {
        Scale {
            effect,
            compiled,
            technique,
            times: Vec::new(),
            energies: Vec::new(),
            size: [0; 2],
            sums: Vec::new(),
        }
    }

    fn add(&mut self, with: &Shot, without: &Shot) {
        self.times.push((without.seconds / with.seconds).ln());
        let energy = |image: &Image| image.rgb.iter().map(|c| luminance(*c)).sum::<f64>() / image.rgb.len() as f64;
        self.energies.push([energy(&with.image), energy(&without.image)]);
        self.size = [with.image.width, with.image.height];
        self.sums.resize(with.image.rgb.len(), [[0.0; 3]; 3]);
        let pixels = with.image.rgb.iter().zip(&without.image.rgb);
        for (sum, (a, b)) in self.sums.iter_mut().zip(pixels) {
            for (c, sum) in sum.iter_mut().enumerate() {
                let (a, d) = (f64::from(a[c]), f64::from(a[c]) - f64::from(b[c]));
                [a, d, d * d].iter().zip(sum).for_each(|(v, s)| *s += v);
            }
        }
    }

    /// The result; `None` if nothing was measured.
    fn read(&self) -> Option<Ablation> {
        let n = self.times.len() as f64;
        let (log, log_se) = mean_and_error(&self.times)?;
        let whole = self.energies.iter().map(|e| e[0]).sum::<f64>() / n;
        let shares: Vec<f64> = self
            .energies
            .iter()
            .map(|[a, b]| if a == b { 0.0 } else { (a - b) / whole })
            .collect();
        let (energy, energy_se) = mean_and_error(&shares)?;
        let (with, without) = self.pictures(n);
        let test = NoiseTest::of(&with, &without, BLOCK_SIDE);
        Some(Ablation {
            effect: self.effect.word().to_owned(),
            time: 1.0 - log.exp(),
            time_se: log_se * log.exp(),
            energy,
            energy_se,
            flip: mean_flip(&with, &without).unwrap_or(f64::NAN),
            blocks: test.as_ref().map_or(0.0, |t| t.share()),
            significant: test.is_some_and(|t| t.differing > 0 || t.bias().abs() > SIGNIFICANT),
        })
    }

    /// The mean pictures with and without. The noise of the difference stands beside the first; the second is taken
    /// as exact.
    fn pictures(&self, n: f64) -> (Image, Image) {
        let [width, height] = self.size;
        let image = |f: &dyn Fn(&[f64; 3]) -> f64| -> Vec<[f32; 3]> {
            self.sums.iter().map(|p| p.each_ref().map(|c| f(c) as f32)).collect()
        };
        let with = Image {
            stderr: Some(image(&|[_, d, dd]| {
                ((dd - d * d / n).max(0.0) / (n * (n - 1.0))).sqrt()
            })),
            nets: Some(n as u32),
            ..Image::from_rgb(width, height, image(&|[a, _, _]| a / n))
        };
        (with, Image::from_rgb(width, height, image(&|[a, d, _]| (a - d) / n)))
    }
}

/// The mean and its standard error; `None` for fewer than two values.
fn mean_and_error(values: &[f64]) -> Option<(f64, f64)> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (values.len() >= 2).then(|| (mean, (squares / (n * (n - 1.0))).sqrt()))
}
