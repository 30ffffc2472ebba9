//! What is told after a render: what was written, how good it is, why it ended, how to make it again.

use super::accuracy::{self, error_to_json, forecast_to_json};
use super::metadata::{bias_words, stop_word};
use super::parts::anomalies_to_json;
use super::plan::Goal;
use crate::math::words::{clock, count, duration, grouped};
use crate::render::report::{Anomalies, Report, StopReason};
use crate::render::settings::Settings;
use serde_json::{Value, json};

/// Fewer samples per pixel than this give no standard errors.
const LEAST_SPP_FOR_ERRORS: u32 = 16;

/// Everything the summary speaks of.
pub struct Summary<'a> {
    /// Files that were written.
    pub written: &'a [String],
    /// What was asked.
    pub settings: &'a Settings,
    /// When it should have ended.
    pub goal: &'a Goal,
    /// What came out.
    pub report: &'a Report,
    /// The flags that bias the picture.
    pub biased: &'a [String],
    /// What 8-bit images show instead of the picture.
    pub view: Option<&'a str>,
    /// The command that makes it again.
    pub replay: &'a str,
}

impl Summary<'_> {
    /// As text, a fact a line.
    pub fn text(&self) -> String {
        let (report, settings) = (self.report, self.settings);
        let mut lines = Vec::new();
        if !self.written.is_empty() {
            lines.push(format!(
                "wrote {} ({}x{})",
                self.written.join(", "),
                settings.width,
                settings.height
            ));
        }
        let mut work = format!("  {} samples per pixel in {}", report.spp, clock(report.seconds));
        if report.seconds > 0.0 {
            let rates = [(report.samples, "samples/s"), (report.rays, "rays/s")];
            let rates = rates.map(|(n, unit)| format!("{} {unit}", count(n as f64 / report.seconds)));
            work += &format!(" ({})", rates.join(", "));
        }
        lines.push(work);
        lines.extend(self.view.map(|view| format!("  view: {view}")));
        lines.extend(self.error().iter().map(|line| format!("  {line}")));
        lines.push(format!("  {}", self.stop()));
        if let Some(forecast) = &report.forecast {
            lines.push(format!(
                "  {}",
                accuracy::outlook(forecast, is_goal_missed(self.goal, report))
            ));
        }
        if !self.biased.is_empty() {
            lines.push(format!("  biased: {}", bias_words(self.biased, report.clamped)));
        }
        lines.extend(anomalies(&report.anomalies));
        if report.stop != StopReason::Interrupted {
            lines.push(format!("  again: {}", self.replay)); // an interrupted picture cannot be made again
        }
        lines.join("\n")
    }

    fn error(&self) -> Vec<String> {
        let unknown = match &self.report.error {
            Some(e) => return accuracy::full(e, self.goal.rules.confidence),
            None if self.settings.nets == 1 => "it shows in the spread of several nets (--nets 4)".to_owned(),
            None if self.report.spp < LEAST_SPP_FOR_ERRORS => {
                format!("standard errors need {LEAST_SPP_FOR_ERRORS} samples per pixel")
            }
            None => "too few samples per pixel to estimate it".to_owned(),
        };
        vec![format!("error unknown: {unknown}")]
    }

    fn stop(&self) -> String {
        let rules = &self.goal.rules;
        let goals = accuracy::goals(rules);
        let named: Vec<&str> = goals.iter().map(|(goal, _)| goal.as_str()).collect();
        let missed = match named.join(" and the ") {
            goals if is_goal_missed(self.goal, self.report) => format!("; the {goals} is not reached"),
            _ => String::new(),
        };
        match self.report.stop {
            StopReason::Samples => format!("stopped after all samples{missed}"),
            StopReason::Time => format!(
                "stopped by the time limit of {}{missed}",
                duration(rules.seconds.unwrap_or(0.0))
            ),
            StopReason::Interrupted => "interrupted: this is the picture so far".to_owned(),
            StopReason::Error | StopReason::ErrorMax | StopReason::ErrorDisplay => {
                let reached = goals.iter().find(|(_, reason)| *reason == self.report.stop);
                format!("stopped at the {}", reached.map_or("error goal", |(goal, _)| goal))
            }
        }
    }

    /// As the last JSON event.
    pub fn event(&self, exit: u8) -> Value {
        let report = self.report;
        json!({
            "event": "done",
            "exit": exit,
            "outputs": self.written,
            "width": self.settings.width,
            "height": self.settings.height,
            "spp": report.spp,
            "samples": report.samples,
            "rays": report.rays,
            "seconds": report.seconds,
            "stop": stop_word(report.stop),
            "error": error_to_json(report.error.as_ref()),
            "forecast": forecast_to_json(report.forecast.as_ref()),
            "anomalies": anomalies_to_json(&report.anomalies),
            "biased": self.biased,
            "clamped": report.clamped,
            "view": self.view,
            "replay": self.replay,
        })
    }
}

/// Whether there are error goals, asked for or built in, and none was reached.
pub fn is_goal_missed(goal: &Goal, report: &Report) -> bool {
    accuracy::is_missed(&goal.rules, report.error.as_ref(), report.stop)
}

/// What was repaired or left out, a kind a line; one line where nothing was.
pub fn anomalies(found: &Anomalies) -> Vec<String> {
    if found.is_empty() {
        return vec!["  anomalies: none".to_owned()];
    }
    let told = found.iter().filter(|(_, n)| *n > 0);
    told.map(|(kind, n)| format!("  anomalies: {} {}", grouped(n), kind.sentence()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::report::{Anomaly, ErrorEstimate};
    use crate::render::settings::StopRules;

    fn report(stop: StopReason, bound: Option<f64>) -> Report {
        Report {
            stop,
            spp: 256,
            samples: 1_000_000,
            rays: 5_000_000,
            seconds: 2.0,
            error: bound.map(|bound| ErrorEstimate {
                error: 0.9 * bound,
                bound,
                ..ErrorEstimate::default()
            }),
            forecast: None,
            anomalies: Anomalies::default(),
            clamped: 12_345,
        }
    }

    fn goal(error: Option<f64>) -> Goal {
        Goal {
            rules: StopRules {
                error,
                ..StopRules::samples(256)
            },
            error_was_asked: true,
        }
    }

    #[test]
    fn a_goal_is_judged_by_the_bound() {
        for (stop, bound, missed) in [
            (StopReason::Samples, Some(0.031), true),
            (StopReason::Samples, Some(0.03), false),
            (StopReason::Samples, None, true),
            (StopReason::Time, Some(0.2), true),
            (StopReason::Error, Some(0.02), false),
        ] {
            assert_eq!(
                is_goal_missed(&goal(Some(0.03)), &report(stop, bound)),
                missed,
                "{stop:?} {bound:?}"
            );
            assert!(!is_goal_missed(&goal(None), &report(stop, bound)));
        }
    }

    #[test]
    fn the_summary_tells_files_error_reason_anomalies_and_replay() {
        let mut report = report(StopReason::Samples, Some(0.05));
        report.anomalies.count(Anomaly::NonFinite, 12);
        let (settings, goal) = (Settings::new(8, 4, 256), goal(Some(0.03)));
        let summary = Summary {
            written: &["a.png".to_owned(), "a.exr".to_owned()],
            settings: &settings,
            goal: &goal,
            report: &report,
            biased: &["--clamp 10".to_owned(), "--no-caustics".to_owned()],
            view: Some("albedo"),
            replay: "pts render a.pts",
        };
        let text = summary.text();
        for part in [
            "wrote a.png, a.exr (8x4)",
            "256 samples per pixel in 2.0 s (500 k samples/s, 2.50 M rays/s)",
            "error 4.5 %, below 5 % with 90 % confidence",
            "the error goal of 3 % is not reached",
            "\n  view: albedo\n",
            "anomalies: 12 samples were not finite",
            "biased: --clamp 10 (12 345 samples clamped), --no-caustics",
            "again: pts render a.pts",
        ] {
            assert!(text.contains(part), "`{part}` is not in\n{text}");
        }
        assert_eq!(summary.event(3)["error"]["bound"], 0.05);
    }
}
