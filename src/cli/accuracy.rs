//! How errors, goals and forecasts are told, as text and as JSON.

use crate::math::words::{clock, percent, range, rough_duration, rough_percent, significant};
use crate::render::estimate::Bounded;
use crate::render::report::{ErrorEstimate, Forecast, Progress, StopReason};
use crate::render::settings::StopRules;
use serde_json::{Value, json};

/// Seconds that are no time any more for who waits.
const SOON: f64 = 0.5;

/// `error 4.1 % (≤ 4.6 %)`, the bound at the asked confidence; then what else there are goals for:
/// `worst pixels 12 % (≤ 14 %)`, `display 0.52 (≤ 0.55) steps`. `doubtful` where they deserve no trust.
pub fn short(e: &ErrorEstimate) -> String {
    let mut parts = vec![format!(
        "error {} (≤ {})",
        rough_percent(e.error),
        rough_percent(e.bound)
    )];
    if let Some(Bounded { value, bound }) = e.worst {
        let (value, bound) = (rough_percent(value), rough_percent(bound));
        parts.push(format!("worst pixels {value} (≤ {bound})"));
    }
    if let Some(Bounded { value, bound }) = e.display {
        parts.push(format!("display {} (≤ {}) steps", steps(value), steps(bound)));
    }
    if e.is_doubtful() {
        parts.push("doubtful".to_owned());
    }
    parts.join("  ")
}

/// The error in full: `error 4.1 %, below 4.6 % with 90 % confidence; …`, and a warning where it deserves no trust.
pub fn full(e: &ErrorEstimate, confidence: f64) -> Vec<String> {
    let mut line = format!(
        "error {}, below {} with {} confidence",
        rough_percent(e.error),
        rough_percent(e.bound),
        percent(confidence)
    );
    if let Some(worst) = &e.worst {
        line += &format!(
            "; 99 % of the pixels {}, below {}",
            rough_percent(worst.value),
            rough_percent(worst.bound)
        );
    }
    if let Some(display) = &e.display {
        line += &format!(
            "; on display {}, below {} steps of 8 bits",
            steps(display.value),
            steps(display.bound)
        );
    }
    std::iter::once(line).chain(doubt(e)).collect()
}

/// Why the figures deserve little trust, where they do.
pub fn doubt(e: &ErrorEstimate) -> Option<String> {
    e.is_doubtful().then(|| {
        format!(
            "doubtful: {} of the error comes from rare bright finds ({} from a thousandth of the pixels); \
             the figure is rough, and light that no sample has found yet is in no figure",
            rough_percent(e.lonely.min(1.0)),
            rough_percent(e.top)
        )
    })
}

fn steps(n: f64) -> String {
    significant(n, 2)
}

/// What more time would have brought.
pub fn outlook(forecast: &Forecast, missed: bool) -> String {
    let mut text = format!(
        "half the error takes about {} more; ten times the time gives about {}",
        rough_duration(forecast.halving),
        rough_percent(forecast.tenfold)
    );
    if let Some([from, to]) = forecast.to_goal.filter(|_| missed) {
        text += &format!("; the goal needs {} more", range(from, to, rough_duration));
    }
    text
}

/// When a running render ends: `goal in 14–25 s`, `18 s left`, or both where the goal comes too late.
pub fn remaining(progress: &Progress) -> Option<String> {
    let Some([from, to]) = progress.forecast.and_then(|f| f.to_goal) else {
        return progress.remaining.map(|left| format!("{} left", clock(left)));
    };
    let needed = range(from, to, rough_duration);
    match progress.remaining {
        Some(left) if left < from => Some(format!("{} left, the goal needs {needed}", clock(left))),
        _ if to <= SOON => Some("goal at the next look".to_owned()),
        _ if from <= SOON => Some(format!("goal within {}", rough_duration(to))),
        _ => Some(format!("goal in {needed}")),
    }
}

/// `{"error": …, "bound": …, …}` as fractions, or null.
pub fn error_to_json(error: Option<&ErrorEstimate>) -> Value {
    let bounded = |b: &Bounded| json!({"value": b.value, "bound": b.bound});
    error.map_or(Value::Null, |e| {
        let mut value = json!({
            "error": e.error,
            "bound": e.bound,
            "rare_finds": e.lonely,
            "top_thousandth": e.top,
            "doubtful": e.is_doubtful(),
        });
        if let Some(worst) = &e.worst {
            value["worst_pixels"] = bounded(worst);
        }
        if let Some(display) = &e.display {
            value["display_steps"] = bounded(display);
        }
        value
    })
}

/// `{"to_goal": [from, to] or null, "halving": …, "tenfold": …, "exponent": …}` in seconds and fractions, or null.
pub fn forecast_to_json(forecast: Option<&Forecast>) -> Value {
    forecast.map_or(
        Value::Null,
        |f| json!({"to_goal": f.to_goal, "halving": f.halving, "tenfold": f.tenfold, "exponent": f.exponent}),
    )
}

/// The error goals among the rules, in words.
pub fn goals(rules: &StopRules) -> Vec<(String, StopReason)> {
    let error = rules
        .error
        .map(percent)
        .map(|g| (format!("error goal of {g}"), StopReason::Error));
    let worst = rules.error_max.map(|g| {
        (
            format!("goal of {} for 99 % of the pixels", percent(g)),
            StopReason::ErrorMax,
        )
    });
    let display = rules.error_display.map(|g| {
        (
            format!("goal of {g} steps of 8 bits on display"),
            StopReason::ErrorDisplay,
        )
    });
    [error, worst, display].into_iter().flatten().collect()
}

/// Whether there is an error goal and none was reached.
pub fn is_missed(rules: &StopRules, error: Option<&ErrorEstimate>, stop: StopReason) -> bool {
    let within = |goal: Option<f64>, now: Option<f64>| goal.zip(now).is_some_and(|(goal, now)| now <= goal);
    let reached = matches!(
        stop,
        StopReason::Error | StopReason::ErrorMax | StopReason::ErrorDisplay
    ) || error.is_some_and(|e| {
        within(rules.error, Some(e.bound))
            || within(rules.error_max, e.worst.map(|w| w.bound))
            || within(rules.error_display, e.display.map(|d| d.bound))
    });
    rules.has_error_goal() && !reached
}
