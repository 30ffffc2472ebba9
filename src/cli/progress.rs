//! What is shown while a render runs: a bar on terminals, a line now and then elsewhere, JSON for programs.

use super::choices::ProgressKind;
use super::console::Console;
use super::{accuracy, signals};
use crate::math::words::{clock, count, rough_duration};
use crate::render::report::{Observer, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Plain lines come at each tenth of the work, and at the latest after this time.
const PLAIN_INTERVAL: Duration = Duration::from_secs(30);

/// Least time between two looks at what the rendering threads report.
const LOOK_INTERVAL: Duration = Duration::from_millis(100);

/// JSON events come no more often than this.
const JSON_INTERVAL: Duration = Duration::from_millis(500);

/// Watches a render for the user, and tells it when the user wants it to end.
pub struct Meter {
    console: Console,
    began: Instant,
    /// Milliseconds after `began` before which news are dropped, so that threads seldom meet at the lock.
    next_look: AtomicU64,
    shown: Mutex<Shown>,
    bar: Option<ProgressBar>,
}

/// What was shown last.
struct Shown {
    at: Instant,
    tenth: u32,
}

impl Meter {
    /// A meter for the render that begins now.
    pub fn new(console: Console) -> Meter {
        let began = Instant::now();
        let bar = bar(&console, STEPS);
        bar.iter()
            .for_each(|bar| bar.set_message(console.frame_prefix() + "first pass"));
        Meter {
            console,
            began,
            next_look: AtomicU64::new(LOOK_INTERVAL.as_millis() as u64),
            shown: Mutex::new(Shown { at: began, tenth: 0 }),
            bar,
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn show(&self, progress: &Progress, shown: &mut Shown) {
        let rendering = self.began.elapsed();
        match self.console.progress() {
            ProgressKind::Bar => {
                if let Some(bar) = &self.bar {
                    bar.set_position((progress.fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
                    bar.set_message(self.console.frame_prefix() + &line(progress, rendering));
                }
            }
            ProgressKind::Plain => {
                let tenth = (progress.fraction * 10.0) as u32;
                if tenth > shown.tenth || shown.at.elapsed() >= PLAIN_INTERVAL {
                    self.console
                        .line(&(self.console.frame_prefix() + &line(progress, rendering)));
                    *shown = Shown {
                        at: Instant::now(),
                        tenth,
                    };
                }
            }
            ProgressKind::Json => {
                if shown.at.elapsed() >= JSON_INTERVAL {
                    self.console.event(&event(progress));
                    shown.at = Instant::now();
                }
            }
            ProgressKind::None | ProgressKind::Auto => {}
        }
    }
}

impl Observer for Meter {
    fn progress(&self, progress: &Progress) {
        if self.console.progress() == ProgressKind::None {
            return;
        }
        let now = self.began.elapsed().as_millis() as u64;
        if now < self.next_look.load(Ordering::Relaxed) {
            return;
        }
        // Whoever finds the lock taken leaves it to the other thread.
        if let Ok(mut shown) = self.shown.try_lock() {
            self.next_look
                .store(now + LOOK_INTERVAL.as_millis() as u64, Ordering::Relaxed);
            self.show(progress, &mut shown);
        }
    }

    fn should_stop(&self) -> bool {
        signals::stop_asked()
    }
}

/// A bar of this many steps, where bars are shown.
pub fn bar(console: &Console, steps: u64) -> Option<ProgressBar> {
    (console.progress() == ProgressKind::Bar).then(|| {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr_with_hz(8));
        let style = match console.is_colored() {
            true => "{bar:20.cyan/blue} {wide_msg}",
            false => "{bar:20} {wide_msg}",
        };
        bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar
    })
}

/// ` 40 %  128 spp  error 4.1 % (≤ 4.6 %)  12 s  18 s left  3.20 M samples/s`: what matters most stands first,
/// since narrow terminals cut the end off.
fn line(progress: &Progress, rendering: Duration) -> String {
    let mut parts = vec![
        format!("{:3.0} %", 100.0 * progress.fraction.clamp(0.0, 1.0)),
        format!("{} spp", progress.spp),
    ];
    if let Some(error) = &progress.error {
        parts.push(accuracy::short(error));
    }
    parts.push(clock(progress.elapsed));
    parts.extend(accuracy::remaining(progress));
    if let Some(forecast) = &progress.forecast {
        parts.push(format!("[half the error: +{}]", rough_duration(forecast.halving)));
    }
    let seconds = rendering.as_secs_f64();
    if seconds > 0.0 {
        parts.push(format!("{} samples/s", count(progress.samples as f64 / seconds)));
    }
    parts.join("  ")
}

fn event(progress: &Progress) -> Value {
    json!({
        "event": "progress",
        "fraction": progress.fraction,
        "spp": progress.spp,
        "samples": progress.samples,
        "samples_at_most": progress.samples_at_most,
        "elapsed": progress.elapsed,
        "remaining": progress.remaining,
        "error": accuracy::error_to_json(progress.error.as_ref()),
        "forecast": accuracy::forecast_to_json(progress.forecast.as_ref()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::estimate::Bounded;
    use crate::render::report::{ErrorEstimate, Forecast};

    #[test]
    fn a_line_tells_share_speed_time_and_error() {
        let progress = Progress {
            spp: 128,
            samples: 32_000_000,
            samples_at_most: 80_000_000,
            fraction: 0.4,
            elapsed: 12.0,
            remaining: Some(18.0),
            error: Some(ErrorEstimate {
                error: 0.041,
                bound: 0.046,
                ..ErrorEstimate::default()
            }),
            forecast: None,
        };
        let text = line(&progress, Duration::from_secs(10));
        assert_eq!(
            text,
            " 40 %  128 spp  error 4.1 % (≤ 4.6 %)  12 s  18 s left  3.20 M samples/s"
        );
        let progress = Progress {
            forecast: Some(Forecast {
                to_goal: Some([14.0, 25.0]),
                halving: 36.0,
                tenfold: 0.013,
                exponent: 0.5,
            }),
            ..progress
        };
        let text = line(&progress, Duration::from_secs(10));
        assert!(
            text.contains("12 s  goal in 14–25 s  [half the error: +36 s]  3.20 M"),
            "{text}"
        );
        let too_late = Progress {
            remaining: Some(5.0),
            ..progress
        };
        let text = line(&too_late, Duration::from_secs(10));
        assert!(text.contains("5.0 s left, the goal needs 14–25 s"), "{text}");
        for (to_goal, told) in [
            ([0.0, 0.3], "goal at the next look"),
            ([0.2, 3.27], "goal within 3.3 s"),
            ([70.0, 604.0], "goal in 70 s – 10 min"),
        ] {
            let progress = Progress {
                remaining: Some(1000.0),
                forecast: progress.forecast.map(|f| Forecast {
                    to_goal: Some(to_goal),
                    ..f
                }),
                ..progress
            };
            let text = line(&progress, Duration::from_secs(10));
            assert!(text.contains(told), "{text}");
        }
    }

    #[test]
    fn a_line_tells_every_figure_that_has_a_goal() {
        let figure = |value| {
            Some(Bounded {
                value,
                bound: 1.1 * value,
            })
        };
        let progress = Progress {
            spp: 128,
            samples: 1,
            samples_at_most: 2,
            fraction: 0.5,
            elapsed: 1.0,
            remaining: None,
            error: Some(ErrorEstimate {
                error: 0.02,
                bound: 0.03,
                lonely: 1.0,
                worst: figure(0.1),
                display: figure(0.5),
                ..ErrorEstimate::default()
            }),
            forecast: None,
        };
        let text = line(&progress, Duration::ZERO);
        let told = "error 2 % (≤ 3 %)  worst pixels 10 % (≤ 11 %)  display 0.5 (≤ 0.55) steps  doubtful  1.0 s";
        assert_eq!(text, format!(" 50 %  128 spp  {told}"));
    }
}
