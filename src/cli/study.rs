//! `pts study`: what accuracy costs in time, for one scene.

use super::args::StudyArgs;
use super::console::Console;
use super::outputs::Refusal;
use super::study_files::Place;
use super::study_meter::StudyMeter;
use super::{Exit, plan, replay, scene, signals};
use crate::compile::prune::prune;
use crate::diag::{Diagnostics, SourceMap};
use crate::files::Files;
use crate::math::words::{clock, shell_word};
use crate::render::settings::Settings;
use crate::render::technique::Technique;
use crate::scene::{RenderDefaults, Scene};
use crate::study::Image;
use crate::study::experiment::Goal;
use crate::study::runner::{self, AxisChoice, Failure, Outcome, Request};
use crate::study::workshop::{Clock, Stopped};
use clap::ValueEnum;
use std::path::Path;
use std::time::Instant;

/// The error to reach where nobody names a goal: that of `render`.
const DEFAULT_GOAL: Goal = Goal::Error(0.03);

/// Runs the command.
pub fn run(args: &StudyArgs) -> Exit {
    let started = Instant::now();
    let console = Console::new(&args.terminal, args.progress);
    signals::install_for(!console.is_json(), "what was measured so far is written");
    match study(args, &console, started) {
        Ok(exit) => exit,
        Err((exit, message)) => {
            if !message.is_empty() {
                console.error(&message);
            }
            exit
        }
    }
}

/// A refusal without words has been told already.
fn study(args: &StudyArgs, console: &Console, started: Instant) -> Result<Exit, Refusal> {
    let reference = args.reference.as_deref().map(read_reference).transpose()?;
    if let Some(threads) = args.threads {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads as usize)
            .build_global();
        pool.map_err(|e| (Exit::Usage, format!("cannot start {threads} threads: {e}")))?;
    }
    let place = Place::prepare(args)?;
    let outcome = match measure(args, console, started, reference) {
        Ok(outcome) => outcome,
        Err(refusal) => {
            place.abandon();
            return Err(refusal);
        }
    };
    let written = place.write(&outcome.study, console);
    if !console.is_json() {
        super::study_files::summary(&outcome.study)
            .iter()
            .for_each(|line| console.say(line));
    }
    let files = written?;
    if console.is_json() {
        console.event(&serde_json::json!({
            "event": "done",
            "interrupted": outcome.interrupted,
            "seconds": started.elapsed().as_secs_f64(),
            "rows": outcome.study.rows.len(),
            "outputs": files,
        }));
    } else {
        let took = clock(started.elapsed().as_secs_f64());
        console.say(&format!("wrote {} in {took}", files.join(", ")));
    }
    Ok(if outcome.interrupted {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

fn read_reference(path: &Path) -> Result<(String, Image), Refusal> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| (Exit::Output, format!("the reference {name} cannot be read: {e}")))?;
    let image = Image::decode(&bytes, &name).map_err(|d| {
        (
            Exit::Output,
            format!("the reference {name} cannot be read: {}", d.message),
        )
    })?;
    Ok((name, image))
}

/// Reads the scene and runs the study; warnings and mistakes of the scene are told.
fn measure(
    args: &StudyArgs,
    console: &Console,
    started: Instant,
    reference: Option<(String, Image)>,
) -> Result<Outcome, Refusal> {
    let (files, path) =
        scene::open(&args.scene).map_err(|error| (Exit::Scene, format!("cannot read standard input: {error}")))?;
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let given = match (&reference, args.size()) {
        (Some((_, image)), [None, None]) => [Some(image.width), Some(image.height)],
        (_, size) => size,
    };
    let found = read(args, &files, &path, given, console, (&mut sources, &mut diags));
    let Some((scene, size)) = found.filter(|_| !diags.has_errors()) else {
        console.diagnostics(&diags, &sources);
        return Err((Exit::Scene, String::new()));
    };
    // What the picture does not need is no effect to weigh and no axis to vary. Compiling will tell what cannot be read.
    let scene = prune(&scene, &files, &mut Diagnostics::default()).scene.into_owned();
    if let Some((name, image)) = &reference
        && [image.width, image.height] != size
    {
        let message = format!(
            "the reference {name} has {}x{} pixels, the pictures would have {}x{}: leave -r out",
            image.width, image.height, size[0], size[1]
        );
        return Err((Exit::Output, message));
    }
    let request = Request {
        scene: &scene,
        files: &files,
        name: args.scene.display().to_string(),
        command: command(),
        scene_flags: scene_flags(args),
        version: version(),
        processor: processor(),
        settings: settings(args, &scene.defaults, size),
        may_shrink: given == [None, None],
        clock: Clock {
            started,
            budget: args.budget,
        },
        load: started.elapsed().as_secs_f64(),
        axes: args.axes.clone().unwrap_or(AxisChoice::Fitting),
        seeds: args.seeds,
        ladder: args.ladder.clone().map(|l| l.0),
        ablation: !args.no_ablation,
        reference,
        goal: args.goal.unwrap_or_else(|| default_goal(&scene.defaults)),
    };
    signals::rendering_begins();
    let meter = StudyMeter::new(*console);
    let outcome = runner::run(request, &meter, &mut diags);
    meter.finish();
    console.diagnostics(&diags, &sources);
    outcome.map_err(refuse)
}

/// Reads the scene and what the flags put in its place, and decides the size that it would be rendered at.
fn read(
    args: &StudyArgs,
    files: &dyn Files,
    path: &Path,
    given: [Option<u32>; 2],
    console: &Console,
    (sources, diags): (&mut SourceMap, &mut Diagnostics),
) -> Option<(Scene, [u32; 2])> {
    let options = scene::load_options(&args.load, given);
    let mut scene = scene::read(path, files, &options, sources, diags)?;
    scene::select_camera(&mut scene, &args.view, diags);
    let size = plan::size(given, &scene);
    scene::finish(&mut scene, &args.view, size, console, diags);
    Some((scene, size))
}

fn settings(args: &StudyArgs, defaults: &RenderDefaults, size: [u32; 2]) -> Settings {
    let base = Settings::new(size[0], size[1], 1);
    Settings {
        seed: args.seed.or(defaults.seed).unwrap_or(base.seed),
        nets: args.nets.unwrap_or(base.nets),
        filter: plan::filter(args.filter, defaults),
        technique: Technique {
            max_depth: defaults.max_depth.unwrap_or(base.technique.max_depth),
            ..base.technique
        },
        ..base
    }
}

/// The scene's own goal, else that of `render`.
fn default_goal(defaults: &RenderDefaults) -> Goal {
    let error = defaults.error.map(Goal::Error);
    error.or(defaults.time.map(Goal::Seconds)).unwrap_or(DEFAULT_GOAL)
}

fn refuse(failure: Failure) -> Refusal {
    let exit = match &failure {
        // The diagnostics have told what is wrong with the scene.
        Failure::Stopped(Stopped::Scene) => return (Exit::Scene, String::new()),
        Failure::Stopped(Stopped::Interrupted) => {
            return (
                Exit::Interrupted,
                "interrupted before the first picture: nothing is written".to_owned(),
            );
        }
        Failure::Stopped(Stopped::Threads(_)) => Exit::Usage,
        Failure::Reference(_) => Exit::Output,
        Failure::Budget { .. } => {
            return (
                Exit::Usage,
                format!("{failure}; give a larger --budget or a smaller -r"),
            );
        }
    };
    (exit, failure.to_string())
}

/// The words that were given, as a shell takes them.
fn command() -> String {
    let words = std::env::args_os().skip(1).map(|w| shell_word(&w.to_string_lossy()));
    std::iter::once("pts".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

/// What of the words also belongs to a render of the same scene.
fn scene_flags(args: &StudyArgs) -> String {
    let mut words = replay::scene_words(&args.view, &args.load);
    let filter = args
        .filter
        .and_then(|f| f.to_possible_value())
        .map(|f| f.get_name().to_owned());
    let nets = args.nets.map(|n| n.to_string());
    for (name, value) in [("--filter", filter), ("--nets", nets)] {
        words.extend(value.into_iter().flat_map(|v| [name.to_owned(), v]));
    }
    words.iter().map(|w| shell_word(w)).collect::<Vec<_>>().join(" ")
}

/// `0.1.0 (1a2b3c4)`, without the commit where the program was not built from a repository.
fn version() -> String {
    let number = env!("CARGO_PKG_VERSION");
    match option_env!("PTS_COMMIT").filter(|c| !c.is_empty()) {
        Some(commit) => format!("{number} ({commit})"),
        None => number.to_owned(),
    }
}

/// The processor's name as Linux tells it.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find(|line| line.starts_with("model name"));
    let name = model.and_then(|line| line.split_once(':')).map(|(_, name)| name.trim());
    name.filter(|n| !n.is_empty()).unwrap_or("unknown").to_owned()
}
