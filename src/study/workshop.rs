//! Where the pictures of a study are made and timed: scenes compiled once for each technique that needs it, renders on
//! as many threads as asked.

use super::Image;
use super::experiment::{Row, Variant};
use crate::compile::compile_with;
use crate::diag::Diagnostics;
use crate::files::Files;
use crate::render::driver;
use crate::render::report::{Observer, Picture, Progress, Report, StopReason};
use crate::render::scene::CompiledScene;
use crate::render::settings::{Settings, StopRules};
use crate::render::technique::{Roulette, SamplerKind, Technique};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::time::Instant;

/// Somebody who watches a study.
pub trait Watch: Sync {
    /// What is being done, now and then: called from the rendering threads too, so keep it short.
    fn step(&self, step: &Step);

    /// A picture was measured.
    fn row(&self, variant: &Variant, row: &Row);

    /// Whether to stop now; what was measured is kept.
    fn should_stop(&self) -> bool;
}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'a> {
    /// The stage: `scene`, `reference`, `rows` or `effects`.
    pub stage: &'static str,
    /// What of it, as in `roulette late, 64 spp, seed 3`.
    pub what: &'a str,
    /// Seconds since the start.
    pub elapsed: f64,
    /// Seconds that the study may take.
    pub budget: f64,
}

/// The time of a study: when it began and how long it may last.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// When the program began to work.
    pub started: Instant,
    /// Seconds for everything.
    pub budget: f64,
}

impl Clock {
    /// Seconds since the start.
    pub fn elapsed(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Seconds up to a share of the budget; negative when it is past.
    pub fn left_until(&self, share: f64) -> f64 {
        self.budget * share - self.elapsed()
    }
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stopped {
    /// The user ended it.
    #[error("interrupted")]
    Interrupted,
    /// The scene cannot be compiled, which the diagnostics tell.
    #[error("the scene cannot be compiled")]
    Scene,
    /// No pool of so many threads.
    #[error("cannot start {0} threads")]
    Threads(usize),
}

/// A compiled scene and how long it took.
pub struct Compiled {
    /// The scene.
    pub scene: CompiledScene,
    /// Seconds.
    pub seconds: f64,
}

/// What is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order<'a> {
    /// How.
    pub technique: Technique,
    /// On how many threads; `None` for all.
    pub threads: Option<usize>,
    /// The seed.
    pub seed: u64,
    /// Samples per pixel at most.
    pub spp: u32,
    /// Seconds at most.
    pub seconds: Option<f64>,
    /// For the watcher.
    pub stage: &'static str,
    /// For the watcher.
    pub what: &'a str,
}

/// A finished picture.
pub struct Shot {
    /// The picture.
    pub image: Image,
    /// What the render tells of itself.
    pub report: Report,
    /// Mean samples of a pixel.
    pub spp: f64,
    /// Seconds of rendering, from the compiled scene to the picture.
    pub seconds: f64,
    /// Seconds of compiling, measured once for all pictures of the same compiled scene.
    pub compile: f64,
}

/// Makes pictures of one size from one description.
pub struct Workshop<'a> {
    scene: &'a Scene,
    files: &'a dyn Files,
    /// Size, filter and nets of all pictures.
    base: Settings,
    clock: Clock,
    watch: &'a dyn Watch,
    compiled: Vec<(Technique, Compiled)>,
    pools: BTreeMap<usize, rayon::ThreadPool>,
}

impl<'a> Workshop<'a> {
    /// A workshop in which nothing is compiled yet. All pictures have the size, the filter and the nets of `base`.
    pub fn new(
        scene: &'a Scene,
        files: &'a dyn Files,
        base: Settings,
        clock: Clock,
        watch: &'a dyn Watch,
    ) -> Workshop<'a> {
        Workshop {
            scene,
            files,
            base,
            clock,
            watch,
            compiled: Vec::new(),
            pools: BTreeMap::new(),
        }
    }

    /// The settings that all pictures share.
    pub fn base(&self) -> &Settings {
        &self.base
    }

    /// The scene compiled for a technique; compiled now if it was not yet.
    pub fn compiled(&mut self, technique: &Technique, diags: &mut Diagnostics) -> Result<&Compiled, Stopped> {
        let key = compile_key(technique);
        let known = self.compiled.iter().position(|(k, _)| *k == key);
        let place = match known {
            Some(place) => place,
            None => {
                let fresh = compile_timed(self.scene, self.files, &self.base, technique, diags)?;
                self.compiled.push((key, fresh));
                self.compiled.len() - 1
            }
        };
        self.compiled.get(place).map(|(_, c)| c).ok_or(Stopped::Scene)
    }

    /// Whether a technique needs a compiled scene of its own, other than that of `base`.
    pub fn compiles_again(technique: &Technique, base: &Technique) -> bool {
        compile_key(technique) != compile_key(base)
    }

    /// Renders the scene as ordered.
    pub fn shoot(&mut self, order: &Order) -> Result<Shot, Stopped> {
        // What can be wrong with the scene was told when it was compiled for the first time.
        self.compiled(&order.technique, &mut Diagnostics::default())?;
        let most = rayon::current_num_threads();
        if let Some(n) = order.threads.filter(|n| *n != most)
            && !self.pools.contains_key(&n)
        {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
            self.pools.insert(n, pool.map_err(|_| Stopped::Threads(n))?);
        }
        let key = compile_key(&order.technique);
        let found = self.compiled.iter().find(|(k, _)| *k == key);
        let compiled = found.map(|(_, c)| c).ok_or(Stopped::Scene)?;
        let pool = order.threads.and_then(|n| self.pools.get(&n));
        let mut shot = shoot_in(&compiled.scene, &self.base, order, pool, self.clock, self.watch)?;
        shot.compile = compiled.seconds;
        Ok(shot)
    }

    /// Renders another scene than that of the workshop, with everything else the same.
    pub fn shoot_other(&self, other: &Compiled, order: &Order) -> Result<Shot, Stopped> {
        let mut shot = shoot_in(&other.scene, &self.base, order, None, self.clock, self.watch)?;
        shot.compile = other.seconds;
        Ok(shot)
    }

    /// Compiles another scene for pictures like those of the workshop.
    pub fn compile_other(
        &self,
        scene: &Scene,
        technique: &Technique,
        diags: &mut Diagnostics,
    ) -> Result<Compiled, Stopped> {
        compile_timed(scene, self.files, &self.base, technique, diags)
    }
}

/// The technique as far as compiling reads it: what a render alone decides is set to its default.
fn compile_key(technique: &Technique) -> Technique {
    let honest = Technique::default();
    Technique {
        sampler: SamplerKind::default(),
        direct: honest.direct,
        roulette: Roulette::default(),
        adaptive: false,
        max_depth: honest.max_depth,
        clamp: None,
        caustics: true,
        ..*technique
    }
}

fn compile_timed(
    scene: &Scene,
    files: &dyn Files,
    base: &Settings,
    technique: &Technique,
    diags: &mut Diagnostics,
) -> Result<Compiled, Stopped> {
    let begun = Instant::now();
    let compiled = compile_with(scene, files, base.width, base.height, technique, diags).ok_or(Stopped::Scene)?;
    Ok(Compiled {
        scene: compiled,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

fn shoot_in(
    scene: &CompiledScene,
    base: &Settings,
    order: &Order,
    pool: Option<&rayon::ThreadPool>,
    clock: Clock,
    watch: &dyn Watch,
) -> Result<Shot, Stopped> {
    let begun = Instant::now();
    let settings = Settings {
        stop: StopRules {
            spp: order.spp,
            seconds: order.seconds,
            ..base.stop
        },
        seed: order.seed,
        technique: order.technique,
        started: begun,
        ..base.clone()
    };
    let ear = Ear { order, clock, watch };
    ear.tell();
    let render = || driver::render(scene, &settings, &ear);
    let (picture, report) = match pool {
        Some(pool) => pool.install(render),
        None => render(),
    };
    let seconds = begun.elapsed().as_secs_f64();
    if report.stop == StopReason::Interrupted {
        return Err(Stopped::Interrupted);
    }
    let pixels = f64::from(settings.width) * f64::from(settings.height);
    Ok(Shot {
        spp: report.samples as f64 / pixels,
        image: image_of(picture, settings.nets),
        report,
        seconds,
        compile: 0.0,
    })
}

fn image_of(picture: Picture, nets: u32) -> Image {
    Image {
        width: picture.width,
        height: picture.height,
        rgb: picture.rgb,
        stderr: Some(picture.stderr),
        nets: Some(nets),
        samples: Some(picture.samples),
        is_developed: false,
    }
}

/// Hands on what a render tells.
struct Ear<'a> {
    order: &'a Order<'a>,
    clock: Clock,
    watch: &'a dyn Watch,
}

impl Ear<'_> {
    fn tell(&self) {
        self.watch.step(&Step {
            stage: self.order.stage,
            what: self.order.what,
            elapsed: self.clock.elapsed(),
            budget: self.clock.budget,
        });
    }
}

impl Observer for Ear<'_> {
    fn progress(&self, _: &Progress) {
        self.tell();
    }

    fn should_stop(&self) -> bool {
        self.watch.should_stop()
    }
}
