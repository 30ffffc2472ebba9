//! An animation: one picture after the other, each with a scene of its own.

use super::animation::Animation;
use super::args::RenderArgs;
use super::console::Console;
use super::outputs::{self, Refusal, Targets};
use super::{Exit, render, signals};
use std::path::Path;
use std::time::Instant;

/// Renders the frames. One that fails ends the animation; one that misses its error goal does not.
pub fn run(args: &RenderArgs, animation: &Animation, console: Console) -> Exit {
    signals::install_for(!console.is_json(), "the finished frames are kept");
    let mut done = Done::default();
    let mut exit = Exit::Done;
    for number in animation.chosen.numbers() {
        if signals::stop_asked() {
            exit = Exit::Interrupted;
            break;
        }
        let started = Instant::now();
        let mut args = args.clone();
        args.load.moment = Some(animation.moment(number));
        let targets = match plan(&args, animation, number) {
            Ok(targets) => targets,
            Err((exit, message)) => {
                console.error(&message);
                return exit;
            }
        };
        if args.animation.skip_existing && targets.exist() {
            done.skipped += 1;
            continue;
        }
        match render::render(&args, &targets, console.for_frame(number, animation.all.last), started) {
            Exit::Done => done.written += 1,
            Exit::GoalMissed => {
                done.written += 1;
                exit = Exit::GoalMissed;
            }
            Exit::Interrupted => {
                exit = Exit::Interrupted;
                break;
            }
            failed => {
                console.say(&done.text());
                return failed;
            }
        }
    }
    console.say(&done.text());
    exit
}

/// Where a frame goes. What can be wrong with the flags is told with the first one.
fn plan(args: &RenderArgs, animation: &Animation, number: u32) -> Result<Targets, Refusal> {
    let name = |path: &Path| animation.numbered(path, number);
    if number != animation.chosen.first {
        return outputs::plan(&args.output, args.scene(), &name);
    }
    let several = animation.chosen.count() > 1;
    if several && args.parts.checkpoint.is_some() {
        let message =
            "--checkpoint holds one picture: add --frame N, or use --skip-existing to go on with an animation";
        return Err((Exit::Usage, message.to_owned()));
    }
    let targets = render::prepare(args, &name)?;
    if several && targets.to_stdout() {
        let message = "standard output takes one picture: add --frame N, or name files";
        return Err((Exit::Usage, message.to_owned()));
    }
    Ok(targets)
}

/// What has been done.
#[derive(Default)]
struct Done {
    written: u32,
    skipped: u32,
}

impl Done {
    fn text(&self) -> String {
        let frames = |n: u32| format!("{n} {}", if n == 1 { "frame" } else { "frames" });
        let skipped = match self.skipped {
            0 => String::new(),
            1 => ", 1 was there already".to_owned(),
            n => format!(", {n} were there already"),
        };
        format!("{} written{skipped}", frames(self.written))
    }
}
