//! `pts inspect --measure`: what each effect of the scene costs, and how long an error goal takes.
//!
//! A first part of the time renders the scene and looks at its error; in the rest the scene is rendered with and without
//! each effect, in turns, at equal samples. The pictures are small, for as many samples of as many parts as there is time
//! for; times are scaled by pixels, which error per pixel does not depend on.

use crate::compile::effects::Effect;
use crate::diag::Diagnostics;
use crate::files::Files;
use crate::render::driver;
use crate::render::report::{Silent, StopReason};
use crate::render::settings::{Settings, StopRules};
use crate::render::technique::Technique;
use crate::scene::Scene;
use crate::study::ablation::Weighing;
use crate::study::experiment::{Ablation, Row, Variant};
use crate::study::workshop::{Clock, Step, Stopped, Watch, Workshop};
use std::time::Instant;

/// The share of the time for the forecast.
const FOR_THE_FORECAST: f64 = 0.35;
/// Rounds with and without each effect.
const ROUNDS: u64 = 8;
/// The longest side of the pictures, unless the scene's own is shorter.
const LONGEST_SIDE: u32 = 96;
/// Samples of a forecast at most.
const MOST_SPP: u32 = 4096;

/// What was measured.
pub struct Measured {
    /// What each effect costs.
    pub effects: Vec<Ablation>,
    /// How long the goal takes.
    pub forecast: Option<Until>,
    /// Width and height of the pictures it was measured with.
    pub size: [u32; 2],
    /// What could not be measured, and why.
    pub notes: Vec<String>,
}

/// How long an error goal takes at full size, rendering alone, on all threads.
pub struct Until {
    /// The goal as a fraction.
    pub goal: f64,
    /// Seconds, from and to, with 90 % confidence.
    pub seconds: [f64; 2],
}

/// What is measured.
pub struct Task<'a> {
    /// The scene as it was written.
    pub scene: &'a Scene,
    /// Where its images are.
    pub files: &'a dyn Files,
    /// The effects that it has.
    pub effects: Vec<Effect>,
    /// The size of its picture.
    pub size: [u32; 2],
    /// The error goal as a fraction.
    pub goal: f64,
    /// Seconds for everything.
    pub seconds: f64,
}

impl Task<'_> {
    /// Measures within the time, compiling included as far as it is known beforehand.
    pub fn run(&self) -> Result<Measured, Stopped> {
        let started = Instant::now();
        let clock = Clock {
            started,
            budget: self.seconds,
        };
        let size = self.small_size();
        let (base, technique) = (Settings::new(size[0], size[1], MOST_SPP), Technique::default());
        let mut workshop = Workshop::new(self.scene, self.files, base.clone(), clock, &Quiet);
        // What can be wrong with the scene was told when it was inspected.
        let compiled = workshop.compiled(&technique, &mut Diagnostics::default())?;
        let settings = Settings {
            stop: StopRules {
                seconds: Some((FOR_THE_FORECAST * self.seconds).max(f64::MIN_POSITIVE)),
                error: Some(self.goal),
                ..base.stop
            },
            seed: 1,
            started: Instant::now(),
            ..base
        };
        let (_, report) = driver::render(&compiled.scene, &settings, &Silent);
        let pixels = |[w, h]: [u32; 2]| f64::from(w) * f64::from(h);
        let scale = pixels(self.size) / pixels(size);
        let spent = report.seconds;
        let more = match report.stop {
            StopReason::Error => Some([0.0; 2]),
            _ => report.forecast.and_then(|f| f.to_goal),
        };
        let mut notes = Vec::new();
        let forecast = more.map(|more| Until {
            goal: self.goal,
            seconds: more.map(|s| (spent + s) * scale),
        });
        if forecast.is_none() {
            notes.push("forecast: the time is too short for two looks at the error".to_owned());
        }
        let weighing = Weighing {
            scene: self.scene,
            files: self.files,
            technique,
            effects: &self.effects,
            seeds: &(2..2 + ROUNDS).collect::<Vec<_>>(),
            per_sample: spent * pixels(size) / (report.samples as f64).max(1.0),
            clock,
            end: self.seconds,
        };
        let weighed = weighing.run(&mut workshop)?;
        notes.extend(weighed.notes);
        Ok(Measured {
            effects: weighed.ablations,
            forecast,
            size,
            notes,
        })
    }

    fn small_size(&self) -> [u32; 2] {
        let longest = self.size[0].max(self.size[1]).max(1);
        let factor = f64::from(LONGEST_SIDE.min(longest)) / f64::from(longest);
        self.size.map(|side| ((f64::from(side) * factor).round() as u32).max(1))
    }
}

impl Measured {
    /// The share of the time that an effect takes, and its standard error; `None` if it was not measured.
    pub fn share(&self, effect: Effect) -> Option<(f64, f64)> {
        let found = self.effects.iter().find(|a| a.effect == effect.word())?;
        Some((found.time, found.time_se))
    }
}

/// Nobody watches.
struct Quiet;

impl Watch for Quiet {
    fn step(&self, _: &Step) {}

    fn row(&self, _: &Variant, _: &Row) {}

    fn should_stop(&self) -> bool {
        false
    }
}
