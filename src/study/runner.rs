//! Runs a study: measures what a sample costs, makes the reference, climbs the ladders, weighs the effects; all
//! within one budget of seconds.

mod reference;
mod rows;
mod variants;

use super::ablation::Weighing;
use super::axes;

use super::experiment::{Goal, Study};
use super::ladder;
use super::uses::Uses;
use super::workshop::{Clock, Order, Stopped, Watch, Workshop};
use super::{CompareError, Image};
use crate::compile::effects::causes;
use crate::diag::Diagnostics;
use crate::files::Files;
use crate::render::settings::Settings;
use crate::scene::Scene;
use rows::Rows;

/// Fewest seeds of a point: fewer tell no spread.
pub const FEWEST_SEEDS: u32 = 5;

/// Most columns of a picture whose size the study chooses.
pub const WIDEST: u32 = 320;

/// Shares of the budget: for the reference, for the effects, and for writing.
const REFERENCE_SHARE: f64 = 0.3;
const EFFECTS_SHARE: f64 = 0.15;
const WRITING_SHARE: f64 = 0.03;

/// A picture that takes more than this share of the budget is not made twice to learn its price.
const PILOT_SHARE: f64 = 0.01;

/// Seconds that writing takes at least, as far as a twentieth of the budget allows it.
const WRITING_SECONDS: f64 = 1.0;

/// Which axes are varied.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisChoice {
    /// Those that can matter for the scene, as many as the budget holds.
    Fitting,
    /// Those that can matter for the scene.
    All,
    /// Those of these names, as far as they can matter.
    Named(Vec<String>),
}

/// What is studied, and how.
pub struct Request<'a> {
    /// The scene, ready to compile.
    pub scene: &'a Scene,
    /// Where its images are.
    pub files: &'a dyn Files,
    /// What tables call it.
    pub name: String,
    /// The command line that makes the study again.
    pub command: String,
    /// The words that say how the scene is read and seen, for commands that are recommended.
    pub scene_flags: String,
    /// Version and commit of the program.
    pub version: String,
    /// The processor's name.
    pub processor: String,
    /// Size, filter, nets, seed and technique of the base line.
    pub settings: Settings,
    /// Whether a smaller picture than that of `settings` may be chosen, so that more fits into the budget.
    pub may_shrink: bool,
    /// When the program began, and the budget.
    pub clock: Clock,
    /// Seconds that reading the scene took.
    pub load: f64,
    /// What is varied.
    pub axes: AxisChoice,
    /// Seeds of a point, at least [`FEWEST_SEEDS`].
    pub seeds: u32,
    /// Samples per pixel to try, rising; `None` for as many steps as fit.
    pub ladder: Option<Vec<u32>>,
    /// Whether effects are weighed.
    pub ablation: bool,
    /// What to measure against, and its name; `None` to render it.
    pub reference: Option<(String, Image)>,
    /// What the user wants to reach.
    pub goal: Goal,
}

/// What came out.
pub struct Outcome {
    /// The study, as far as it got.
    pub study: Study,
    /// Whether the user ended it early.
    pub interrupted: bool,
}

/// Why there is no study.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// No picture can be made.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The reference cannot be used.
    #[error("the reference cannot be used: {0}")]
    Reference(#[from] CompareError),
    /// Not even the base line's first point fits into the budget.
    #[error(
        "the budget of {budget} s is too short: {seeds} pictures of {spp} samples per pixel at {width}x{height} do \
         not fit into what is left of it after {spent:.1} s of reading, compiling and trying"
    )]
    Budget {
        /// The budget in seconds.
        budget: f64,
        /// Seconds that are gone.
        spent: f64,
        /// Pictures of the first point.
        seeds: u32,
        /// Samples of the first point.
        spp: u32,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

/// Runs a study. Mistakes of the scene go to `diags`.
pub fn run(request: Request, watch: &dyn Watch, diags: &mut Diagnostics) -> Result<Outcome, Failure> {
    let mut notes = Vec::new();
    let clock = request.clock;
    let base = request.settings.technique;
    let mut settings = request.settings.clone();
    if request.may_shrink {
        let natural = [settings.width, settings.height];
        resize(&mut settings, ladder::picture_size(natural, WIDEST, 0.0, 1.0, f64::MAX));
    }
    let mut workshop = workshop(&request, &settings, watch);
    let compiled = workshop.compiled(&base, diags)?;
    let (uses, compile_seconds) = (Uses::of(request.scene, &compiled.scene.lights), compiled.seconds);
    let per_sample = pilot(&mut workshop, &request)?;
    let effects = if request.ablation {
        causes::of(request.scene, &base).iter().collect()
    } else {
        Vec::new()
    };
    let shares = Shares::new(&request, !effects.is_empty());

    let threads = rayon::current_num_threads();
    let room = (1.0 - ladder::BASE_SHARE) * (shares.rows_end - clock.elapsed() - shares.reference);
    let mut treatments = variants::plan(&request, &axes::all(&base, threads, &uses), compile_seconds, &mut notes);
    if request.axes == AxisChoice::Fitting {
        let smallest = if request.may_shrink {
            smallest_cost(&settings, per_sample)
        } else {
            per_sample
        };
        variants::fit(&mut treatments, request.seeds, smallest, room, &mut notes);
    }
    if request.may_shrink {
        let natural = [request.settings.width, request.settings.height];
        let per_pixel = per_sample / (f64::from(settings.width) * f64::from(settings.height));
        let runs = f64::from(request.seeds) * treatments.len() as f64;
        let size = ladder::picture_size(natural, WIDEST, per_pixel, runs, room);
        resize(&mut settings, size);
        if size != natural {
            let [w, h] = natural;
            let larger = f64::from(w) * f64::from(h) / (f64::from(size[0]) * f64::from(size[1]));
            notes.push(format!(
                "pictures are {}x{} pixels instead of {w}x{h}, so that the budget holds more of them (-r WxH chooses \
                 another size); at {w}x{h} the same samples per pixel take about {larger:.0} times as long",
                size[0], size[1]
            ));
        }
    }
    // Compiled anew: the size is another, and the first time reads files that are in memory from now on.
    let mut workshop = self::workshop(&request, &settings, watch);
    for treatment in &treatments {
        workshop.compiled(&treatment.technique, &mut Diagnostics::default())?;
    }
    let per_sample = pilot(&mut workshop, &request)?;
    let too_short = || Failure::Budget {
        budget: clock.budget,
        spent: clock.elapsed(),
        seeds: request.seeds,
        spp: first_step(&request),
        width: settings.width,
        height: settings.height,
    };
    let room = shares.rows_end - clock.elapsed();
    if f64::from(request.seeds * first_step(&request)) * per_sample > room {
        return Err(too_short());
    }
    let seconds = shares.reference.min(0.5 * room);
    let (yardstick, reference) = reference::find(&request, &mut workshop, watch, seconds, &mut notes)?;

    let mut rows = Rows::new(&request, &yardstick, &treatments, per_sample, shares.rows_end);
    let mut interrupted = rows.climb(&mut workshop, watch)?;
    if !rows.rows.iter().any(|row| row.variant == 0) {
        return Err(match interrupted {
            true => Failure::Stopped(Stopped::Interrupted),
            false => too_short(),
        });
    }
    let (variants, rows, row_notes) = rows.finish(interrupted);
    notes.extend(row_notes);
    notes.extend(reference::note(&reference, &rows));

    let mut ablations = Vec::new();
    if !effects.is_empty() && !interrupted {
        let weighing = Weighing {
            scene: request.scene,
            files: request.files,
            technique: base,
            effects: &effects,
            seeds: &seeds(&request),
            per_sample,
            clock,
            end: shares.end,
        };
        let weighed = weighing.run(&mut workshop)?;
        ablations = weighed.ablations;
        notes.extend(weighed.notes);
        interrupted |= weighed.interrupted;
    }
    Ok(Outcome {
        study: Study {
            scene: request.name,
            size: [settings.width, settings.height],
            full_size: [request.settings.width, request.settings.height],
            command: request.command,
            scene_flags: request.scene_flags,
            version: request.version,
            processor: request.processor,
            threads,
            seconds: clock.elapsed(),
            reference,
            goal: request.goal,
            variants,
            rows,
            ablations,
            notes,
        },
        interrupted,
    })
}

/// Seconds of the parts of a study.
struct Shares {
    /// How long the reference may take.
    reference: f64,
    /// When the rows must be done, in seconds since the start.
    rows_end: f64,
    /// When everything but writing must be done.
    end: f64,
}

impl Shares {
    fn new(request: &Request, has_effects: bool) -> Shares {
        let budget = request.clock.budget;
        let writing = (budget * WRITING_SHARE).max(WRITING_SECONDS.min(budget * 0.05));
        let end = budget - writing;
        let effects = if has_effects { budget * EFFECTS_SHARE } else { 0.0 };
        Shares {
            reference: if request.reference.is_some() {
                0.0
            } else {
                budget * REFERENCE_SHARE
            },
            rows_end: end - effects,
            end,
        }
    }
}

fn workshop<'a>(request: &Request<'a>, settings: &Settings, watch: &'a dyn Watch) -> Workshop<'a> {
    Workshop::new(request.scene, request.files, settings.clone(), request.clock, watch)
}

fn resize(settings: &mut Settings, [width, height]: [u32; 2]) {
    let sized = Settings::new(width, height, settings.stop.spp);
    (settings.width, settings.height, settings.region) = (width, height, sized.region);
}

/// Samples of the first point.
fn first_step(request: &Request) -> u32 {
    let given = request.ladder.as_ref().and_then(|l| l.first().copied());
    given.unwrap_or(ladder::FIRST)
}

/// Rows have the seeds after this one beyond the base line's: far from those that people give to references.
const ROW_SEEDS: u64 = 1000;

/// The seeds of rows and of effects.
fn seeds(request: &Request) -> Vec<u64> {
    (1..=u64::from(request.seeds))
        .map(|i| request.settings.seed.wrapping_add(ROW_SEEDS + i))
        .collect()
}

/// Seconds of a sample of each pixel, measured on the second picture where time allows one: the first warms up.
fn pilot(workshop: &mut Workshop, request: &Request) -> Result<f64, Stopped> {
    let order = Order {
        technique: request.settings.technique,
        threads: None,
        seed: request.settings.seed,
        spp: 1,
        seconds: None,
        stage: "scene",
        what: "measuring the price of a sample",
    };
    let first = workshop.shoot(&order)?.seconds;
    let is_cheap = first < PILOT_SHARE * request.clock.budget;
    Ok(if is_cheap {
        workshop.shoot(&order)?.seconds
    } else {
        first
    })
}

/// The price of a sample of each pixel in the smallest picture that may be chosen.
fn smallest_cost(settings: &Settings, per_sample: f64) -> f64 {
    let size = [settings.width, settings.height];
    let [w, h] = ladder::picture_size(size, WIDEST, 1.0, 1.0, 0.0);
    per_sample * f64::from(w) * f64::from(h) / (f64::from(size[0]) * f64::from(size[1]))
}
