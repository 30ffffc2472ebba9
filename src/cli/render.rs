//! `pts render`: a scene to image files.

use super::animation::Animation;
use super::args::RenderArgs;
use super::console::Console;
use super::outputs::{self, Finished, Targets};
use super::parts::{self, Display};
use super::plan::{self, Goal};
use super::progress::Meter;
use super::summary::{self, Summary, is_goal_missed};
use super::{Exit, accuracy, checkpoint, frames, metadata, replay, scene, signals};
use crate::compile::compile_pruned;
use crate::compile::effects::{Effect, causes};
use crate::compile::prune::{Pruned, prune};
use crate::diag::{Diagnostics, SourceMap};
use crate::files::{DiskFiles, Files};
use crate::load;
use crate::math::words::clock;
use crate::output::part::Part;
use crate::output::{Develop, Format};
use crate::render::driver::{self, Checkpoint, Continuity, Rendered};
use crate::render::report::StopReason;
use crate::render::scene::CompiledScene;
use crate::render::settings::Settings;
use crate::render::tiles::Tiles;
use metadata::HashingFiles;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Most pixels of a picture: its buffers must fit into memory.
const MAX_PIXELS: u64 = 1 << 30;

/// What is known before the first ray.
struct Job {
    compiled: CompiledScene,
    settings: Settings,
    goal: Goal,
    develop: Develop,
    hash: String,
    /// What the scene calls for.
    effects: Vec<&'static str>,
    /// What part files say of the picture.
    header: Value,
}

/// Runs the command.
pub fn run(args: &RenderArgs) -> Exit {
    let started = Instant::now();
    let console = Console::new(&args.terminal, args.progress);
    let animation = match Animation::of(&args.animation, is_model(args.scene())) {
        Ok(animation) => animation,
        Err(message) => {
            console.error(&message);
            return Exit::Usage;
        }
    };
    if let Some(animation) = animation {
        return frames::run(args, &animation, console);
    }
    signals::install(!console.is_json());
    match prepare(args, &Path::to_owned) {
        Ok(targets) => render(args, &targets, console, started),
        Err((exit, message)) => {
            console.error(&message);
            exit
        }
    }
}

/// Whether a scene is a bare model. What kind an unknown file is, reading it tells.
fn is_model(scene: &Path) -> bool {
    let kind = load::kind_of(scene, &DiskFiles::default(), &mut Diagnostics::default());
    scene != Path::new("-") && kind.is_some_and(|kind| kind != load::Kind::Text)
}

/// Renders one picture.
pub(super) fn render(args: &RenderArgs, targets: &Targets, console: Console, started: Instant) -> Exit {
    let job = match read(args, &console, started) {
        Ok(job) => job,
        Err(exit) => return exit,
    };
    let (kept, rendered) = match trace(args, &job, console) {
        Ok(done) => done,
        Err((exit, message)) => {
            console.error(&message);
            return exit;
        }
    };
    conclude(args, &job, targets, kept, rendered, &console)
}

/// Renders, from the checkpoint on if there is one. Returns the header of the sums and what was rendered.
fn trace(args: &RenderArgs, job: &Job, console: Console) -> Result<(Value, Rendered), outputs::Refusal> {
    let kept = checkpoint::resume(&args.parts, &job.header, &console)?;
    announce(args, job, &console);
    signals::rendering_begins();
    let header = kept.as_ref().map_or(&job.header, |part: &Part| &part.header);
    let path = args.parts.checkpoint.as_slice();
    let save = |tiles: &Tiles| {
        outputs::write_parts(path, &header_of(header, tiles), tiles, &console);
    };
    let meter = Meter::new(console);
    let continuity = Continuity {
        kept: kept.as_ref().map(|part| &part.pixels),
        checkpoint: args.parts.checkpoint.is_some().then_some(Checkpoint {
            every: checkpoint::interval(&args.parts),
            save: &save,
        }),
    };
    let rendered = driver::render_on(&job.compiled, &job.settings, &meter, continuity);
    meter.finish();
    match (rendered, path.first()) {
        (Ok(rendered), _) => Ok((header_of(header, &rendered.tiles), rendered)),
        (Err(misfit), Some(path)) => Err(checkpoint::cannot_resume(path, &misfit)),
        (Err(misfit), None) => Err((Exit::Scene, misfit.to_string())),
    }
}

/// The header of the sums so far, whose beginning had the header `before`.
fn header_of(before: &Value, tiles: &Tiles) -> Value {
    let mut header = before.clone();
    parts::add_stats(&mut header, &tiles.stats());
    header
}

/// Everything that can be wrong without looking at the scene. `name` makes the names of files from those that were given.
pub(super) fn prepare(args: &RenderArgs, name: &dyn Fn(&Path) -> PathBuf) -> Result<Targets, outputs::Refusal> {
    if args.sampling.nets == Some(1) && args.quality.has_error_goal() {
        let message = "an error goal needs several sample nets to estimate the error from: leave --nets 1 out";
        return Err((Exit::Usage, message.to_owned()));
    }
    if args.sampling.nets == Some(1)
        && let Some(why) = plan::needs_nets(&args.output)
    {
        return Err((Exit::Usage, why.to_owned()));
    }
    if args.sampling.nets == Some(1) && args.sampling.adaptive {
        let message = "--adaptive needs several sample nets to see where the noise is: leave --nets 1 out";
        return Err((Exit::Usage, message.to_owned()));
    }
    let targets = outputs::plan(&args.output, args.scene(), name)?;
    let parts = &args.parts;
    let is_part = parts.checkpoint.is_some() || parts.samples.is_some() || parts.tile.is_some();
    if args.sampling.adaptive && (is_part || !targets.parts.is_empty()) {
        let message =
            "--adaptive gives each tile its own samples, which parts and checkpoints cannot hold: leave one out";
        return Err((Exit::Usage, message.to_owned()));
    }
    checkpoint::check(&args.parts)?;
    if let Some(threads) = args.sampling.threads {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads as usize)
            .build_global();
        pool.map_err(|e| (Exit::Usage, format!("cannot start {threads} threads: {e}")))?;
    }
    Ok(targets)
}

/// Reads and compiles the scene, and decides the settings. All mistakes have been told when it fails.
fn read(args: &RenderArgs, console: &Console, started: Instant) -> Result<Job, Exit> {
    let (files, path) = scene::open(args.scene()).map_err(|error| {
        console.error(&format!("cannot read standard input: {error}"));
        Exit::Scene
    })?;
    let mut reading = Reading {
        files: HashingFiles::new(files),
        path,
        sources: SourceMap::default(),
        diags: Diagnostics::default(),
    };
    let job = build(args, console, started, &mut reading);
    let refused = reading.diags.has_errors();
    console.diagnostics(&reading.diags, &reading.sources);
    match job {
        Ok(Some(job)) if !refused => {
            for file in reading.files.opened() {
                console.detail(&format!("read {}", file.display()));
            }
            Ok(job)
        }
        Ok(_) => {
            if !refused {
                console.error("the scene could not be compiled; this is a mistake in pts, please report it");
            }
            Err(Exit::Scene)
        }
        Err((exit, message)) => {
            console.error(&message);
            Err(exit)
        }
    }
}

/// A scene on its way in, with what is found wrong with it.
struct Reading<F> {
    files: HashingFiles<F>,
    path: PathBuf,
    sources: SourceMap,
    diags: Diagnostics,
}

/// `None` where the scene is at fault, which the diagnostics tell; a refusal where the command line is.
fn build<F: Files>(
    args: &RenderArgs,
    console: &Console,
    started: Instant,
    reading: &mut Reading<F>,
) -> Result<Option<Job>, outputs::Refusal> {
    let (quality, files, diags) = (&args.quality, &reading.files, &mut reading.diags);
    let given = quality.resolution.map(|r| [Some(r.width), Some(r.height)]);
    let options = scene::load_options(&args.load, given.unwrap_or([quality.width, quality.height]));
    let Some(mut scene) = scene::read(&reading.path, files, &options, &mut reading.sources, diags) else {
        return Ok(None);
    };
    console.detail(&format!("read the scene in {}", clock(started.elapsed().as_secs_f64())));
    scene::select_camera(&mut scene, &args.view, diags);
    let size = plan::resolution(quality, &scene);
    if u64::from(size[0]) * u64::from(size[1]) > MAX_PIXELS {
        let message = format!(
            "{}x{} are more pixels than the {MAX_PIXELS} that are supported",
            size[0], size[1]
        );
        return Err((Exit::Usage, message));
    }
    scene::finish(&mut scene, &args.view, size, console, diags);
    let mut goal = plan::stop_rules(quality, &scene.defaults);
    if let Some(samples) = &args.parts.samples {
        goal = plan::exactly(&samples.0, goal);
    }
    if args.parts.tile.is_some() && (goal.rules.has_error_goal() || goal.rules.seconds.is_some()) {
        let message = "--tile needs as many samples in each tile: add --spp N or --samples A..B";
        return Err((Exit::Usage, message.to_owned()));
    }
    let mut settings = plan::settings(args, &scene, size, &goal, started);
    settings.region = plan::region(&args.parts, size).map_err(|message| (Exit::Usage, message))?;
    if settings.nets == 1 && goal.error_was_asked {
        let message =
            "the scene has an error goal, which --nets 1 cannot estimate: add --spp or --time, or leave --nets 1 out";
        return Err((Exit::Usage, message.to_owned()));
    }
    if diags.has_errors() {
        return Ok(None);
    }
    for effect in &args.sampling.without {
        effect.leave_out(&mut scene, &mut settings.technique, files);
    }
    let compiling = Instant::now();
    let pruned = if args.prune.no_prune {
        Pruned::untouched(&scene, files)
    } else {
        prune(&scene, files, diags)
    };
    let effects = causes::of(&pruned.scene, &settings.technique)
        .iter()
        .map(Effect::word)
        .collect();
    for effect in args.prune.forced() {
        effect.force_technique(&mut settings.technique);
    }
    let Some(mut compiled) = compile_pruned(pruned, size[0], size[1], &settings.technique, diags) else {
        return Ok(None);
    };
    args.prune.forced().for_each(|effect| effect.force(&mut compiled));
    console.detail(&format!("compiled it in {}", clock(compiling.elapsed().as_secs_f64())));
    let display = Display {
        tonemap: plan::scene_tone_map(&scene),
        linear: scene.display_is_linear,
    };
    let curve = args.output.tonemap.unwrap_or(display.tonemap);
    let develop = outputs::develop(&args.output, curve, display.linear);
    settings.display = goal.rules.error_display.map(|_| develop.curve());
    let hash = files.scene_hash(args);
    Ok(Some(Job {
        compiled,
        develop,
        header: parts::header(args, &hash, &settings, display, diags.anomalies()),
        settings,
        goal,
        hash,
        effects,
    }))
}

fn announce(args: &RenderArgs, job: &Job, console: &Console) {
    if console.is_json() {
        let rules = &job.goal.rules;
        console.event(&json!({
            "event": "start",
            "version": env!("CARGO_PKG_VERSION"),
            "scene": args.scene().display().to_string(),
            "scene_hash": job.hash,
            "width": job.settings.width,
            "height": job.settings.height,
            "seed": job.settings.seed,
            "nets": job.settings.nets,
            "spp_at_most": rules.spp,
            "seconds_at_most": rules.seconds,
            "error_goal": rules.error,
            "error_max_goal": rules.error_max,
            "error_display_goal": rules.error_display,
            "confidence": rules.confidence,
            "threads": rayon::current_num_threads(),
        }));
    } else {
        let threads = rayon::current_num_threads();
        console.detail(&format!(
            "rendering {}x{} with {threads} threads",
            job.settings.width, job.settings.height
        ));
    }
}

/// Writes the picture, tells how it went, and decides the exit code.
fn conclude(
    args: &RenderArgs,
    job: &Job,
    targets: &Targets,
    header: Value,
    rendered: Rendered,
    console: &Console,
) -> Exit {
    let (picture, mut report, tiles) = (rendered.picture, rendered.report, rendered.tiles);
    // Of the scene and of all samples, also of those before a checkpoint.
    report.anomalies = parts::anomalies(&header);
    report.clamped = parts::clamped(&header);
    let report = &report;
    let interrupted = report.stop == StopReason::Interrupted;
    let (written, all_written, view) = if interrupted && tiles.samples().1 == 0 {
        console.warn("interrupted before the first sample: nothing is written");
        (Vec::new(), true, None)
    } else if let Some(moment) = args.load.moment.filter(|_| interrupted) {
        // Among finished frames nobody would notice one that is not.
        let number = moment.frame.number;
        console.warn(&format!(
            "interrupted: frame {number} is not finished and is not written"
        ));
        let path = args.parts.checkpoint.as_slice();
        let (kept, done) = outputs::write_parts(path, &header, &tiles, console);
        (kept, done, None)
    } else {
        let paths = [&targets.parts[..], args.parts.checkpoint.as_slice()].concat();
        let (parts_written, parts_done) = outputs::write_parts(&paths, &header, &tiles, console);
        drop(tiles);
        let picture = Finished::new(picture, &args.output, job.develop);
        let describe = |format: Format| {
            // Only OpenEXR files tell how it went, so that what is told to make it again gives the same PNG byte by byte.
            metadata::describe(
                args,
                &job.hash,
                &job.settings,
                &job.goal,
                report,
                &job.effects,
                format == Format::Exr,
            )
        };
        let (written, images_done) = outputs::write_all(&targets.images, &picture, describe, console);
        let view = picture.about_view();
        ([written, parts_written].concat(), images_done && parts_done, view)
    };
    let exit = if !all_written {
        Exit::Output
    } else if interrupted {
        Exit::Interrupted
    } else if job.goal.error_was_asked && is_goal_missed(&job.goal, report) {
        Exit::GoalMissed
    } else {
        Exit::Done
    };
    let replay = replay::command(args, &job.settings, report.spp, true);
    let summary = Summary {
        written: &written,
        settings: &job.settings,
        goal: &job.goal,
        report,
        biased: &args.sampling.biased(),
        view: view.as_deref(),
        replay: &replay,
    };
    if console.is_json() {
        console.event(&summary.event(exit.code()));
    } else if interrupted && args.load.moment.is_some() {
        // There is no picture to speak of.
    } else if console.is_quiet() {
        if !report.anomalies.is_empty() {
            summary::anomalies(&report.anomalies)
                .iter()
                .for_each(|line| console.warn(line.trim_start()));
        }
        // Nobody shall take a goal for reached who was not told how little that means.
        let doubt = report.error.as_ref().and_then(accuracy::doubt);
        if let Some(doubt) = doubt.filter(|_| job.goal.error_was_asked) {
            console.warn(&doubt);
        }
    } else {
        console.say(&summary.text());
    }
    exit
}
