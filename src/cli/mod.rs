//! The command line: reads flags, calls the library, tells people (or programs) what happened.
//!
//! Streams: pictures go to files, or to standard output on request; everything else goes to standard error.
//! (The reports of `compare`, `inspect` and `check --format json` are the exceptions: they are the product.)

pub mod accuracy;
pub mod animation;
mod args;
pub mod camera;
pub mod check;
pub mod checkpoint;
pub mod choices;
pub mod compare;
pub mod compare_report;
pub mod console;
pub mod diagnostics;
pub mod frames;
pub mod inspect;
pub mod merge;
pub mod metadata;
pub mod outputs;
pub mod parts;
pub mod plan;
pub mod progress;
pub mod ranges;
pub mod render;
pub mod replay;
pub mod scene;
pub mod signals;
pub mod study;
pub mod study_files;
pub mod study_meter;
pub mod summary;
pub mod values;
pub mod view;

use args::{Cli, Command};
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// As asked.
    Done,
    /// The scene or an input is at fault.
    Scene,
    /// An image is farther from its reference than allowed.
    Beyond,
    /// The command line is at fault.
    Usage,
    /// An error goal that was asked for was not reached.
    GoalMissed,
    /// An image cannot be written, or (where images are what is read) not be read.
    Output,
    /// The user ended it.
    Interrupted,
}

impl Exit {
    /// The process's exit code.
    pub fn code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::Scene | Exit::Beyond => 1,
            Exit::Usage => 2,
            Exit::GoalMissed => 3,
            Exit::Output => 4,
            Exit::Interrupted => 130,
        }
    }
}

/// Stack of the thread that reads scenes: deeply nested ones need more than some systems give the first thread.
const STACK: usize = 256 << 20;

/// Exit code after a panic, the one Rust programs have.
const PANICKED: u8 = 101;

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    install_panic_hook();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    let run = move || match cli.command {
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Inspect(args)) => inspect::run(&args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::Merge(args)) => merge::run(&args),
        Some(Command::Study(args)) => study::run(&args),
        None => render::run(&cli.render),
    };
    match std::thread::Builder::new().stack_size(STACK).spawn(run) {
        // The panic hook has told what happened.
        Ok(command) => ExitCode::from(command.join().map_or(PANICKED, Exit::code)),
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: cannot start a thread: {error}");
            ExitCode::from(Exit::Usage.code())
        }
    }
}

/// A panic is a mistake of this program, never of the scene: say so in one line. Debug builds keep the details. Those
/// of guarded decoders are told by whoever guards them.
fn install_panic_hook() {
    let detailed = cfg!(debug_assertions).then(std::panic::take_hook);
    std::panic::set_hook(Box::new(move |info| {
        if crate::diag::is_guarded() {
            return;
        }
        if let Some(hook) = &detailed {
            return hook(info);
        }
        let payload = info.payload();
        let text = payload.downcast_ref::<&str>().copied();
        let message = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        let place = info
            .location()
            .map(|l| format!(" at {}:{}", l.file(), l.line()))
            .unwrap_or_default();
        let _ = writeln!(
            std::io::stderr(),
            "pts {}: internal error{place}: {}; this is a mistake in pts, please report it with the scene and the command",
            env!("CARGO_PKG_VERSION"),
            message.unwrap_or("unknown"),
        );
    }));
}
