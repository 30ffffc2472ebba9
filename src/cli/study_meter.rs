//! What is shown while a study runs: a bar by its budget on terminals, a line for each stage and tenth elsewhere, JSON
//! for programs.

use super::choices::ProgressKind;
use super::console::Console;
use super::progress::bar;
use super::signals;
use crate::math::words::clock;
use crate::study::experiment::{Row, Variant};
use crate::study::workshop::{Step, Watch};
use indicatif::ProgressBar;
use serde_json::json;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// JSON events of progress come no more often than this.
const JSON_INTERVAL: Duration = Duration::from_millis(500);

/// Watches a study for the user, and tells it when the user wants it to end.
pub struct StudyMeter {
    console: Console,
    bar: Option<ProgressBar>,
    shown: Mutex<Shown>,
}

/// What was shown last.
struct Shown {
    at: Option<Instant>,
    stage: &'static str,
    tenth: u32,
}

impl StudyMeter {
    /// A meter for the study that begins now.
    pub fn new(console: Console) -> StudyMeter {
        let bar = bar(&console, STEPS);
        let shown = Shown {
            at: None,
            stage: "",
            tenth: 0,
        };
        StudyMeter {
            console,
            bar,
            shown: Mutex::new(shown),
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn show(&self, step: &Step, shown: &mut Shown) {
        let fraction = (step.elapsed / step.budget).clamp(0.0, 1.0);
        match self.console.progress() {
            ProgressKind::Bar => {
                if let Some(bar) = &self.bar {
                    bar.set_position((fraction * STEPS as f64) as u64);
                    bar.set_message(line(step, fraction));
                }
            }
            ProgressKind::Plain => {
                let tenth = (fraction * 10.0) as u32;
                if step.stage != shown.stage || tenth > shown.tenth {
                    self.console.line(&line(step, fraction));
                    (shown.stage, shown.tenth) = (step.stage, tenth);
                }
            }
            ProgressKind::Json => {
                if shown.at.is_none_or(|at| at.elapsed() >= JSON_INTERVAL) {
                    self.console.event(&json!({
                        "event": "progress",
                        "stage": step.stage,
                        "what": step.what,
                        "fraction": fraction,
                        "elapsed": step.elapsed,
                        "budget": step.budget,
                    }));
                    shown.at = Some(Instant::now());
                }
            }
            ProgressKind::None | ProgressKind::Auto => {}
        }
    }
}

/// ` 40 %  24 s of 1:00 min  roulette late, 64 spp, seed 3 of 5`.
fn line(step: &Step, fraction: f64) -> String {
    format!(
        "{:3.0} %  {} of {}  {}",
        100.0 * fraction,
        clock(step.elapsed),
        clock(step.budget),
        step.what
    )
}

impl Watch for StudyMeter {
    fn step(&self, step: &Step) {
        // Whoever finds the lock taken leaves it to the other thread.
        if let Ok(mut shown) = self.shown.try_lock() {
            self.show(step, &mut shown);
        }
    }

    fn row(&self, variant: &Variant, row: &Row) {
        if self.console.is_json() {
            self.console.event(&json!({
                "event": "row",
                "axis": variant.axis,
                "variant": variant.name,
                "spp": row.spp,
                "seed": row.seed,
                "threads": row.threads,
                "seconds": row.seconds.total(),
                "error": row.error(),
            }));
        }
    }

    fn should_stop(&self) -> bool {
        signals::stop_asked()
    }
}
