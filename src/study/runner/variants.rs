//! Which ways to render a study tries.

use super::{AxisChoice, Request};
use crate::render::driver::FIRST_LOOK;
use crate::render::technique::Technique;
use crate::study::axes::{self, Axis};
use crate::study::experiment::{Kind, Variant};
use crate::study::workshop::Workshop;

/// One way to render, with what the runner needs to know of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Treatment {
    /// What tables say of it.
    pub variant: Variant,
    /// How it renders.
    pub technique: Technique,
    /// On how many threads; `None` for all.
    pub threads: Option<usize>,
}

impl Treatment {
    /// Samples per pixel from which on it differs from the base line: adaptive sampling begins after the first look at
    /// the noise.
    pub fn least_spp(&self) -> u32 {
        if self.technique.adaptive { FIRST_LOOK + 1 } else { 1 }
    }
}

/// Compiling all variants that need it may take this share of the budget.
const COMPILE_SHARE: f64 = 0.15;

/// The base line and what was chosen of the axes; `compile` is the seconds of compiling once.
pub fn plan(request: &Request, axes: &[Axis], compile: f64, notes: &mut Vec<String>) -> Vec<Treatment> {
    let base = request.settings.technique;
    let mut planned = vec![Treatment {
        variant: Variant {
            axis: axes::SAMPLES.to_owned(),
            name: "as written".to_owned(),
            kind: Kind::Variance,
            flags: String::new(),
        },
        technique: base,
        threads: None,
    }];
    let mut compiled = Vec::new();
    for axis in axes.iter().filter(|axis| is_chosen(&request.axes, axis)) {
        if let Some(why) = axis.useless {
            notes.push(format!("axis {}: left out, since {why}", axis.name));
            continue;
        }
        let again = |t: &Technique| Workshop::compiles_again(t, &base);
        let fresh = axis.values.iter().filter(|c| again(&c.technique)).count();
        if (compiled.len() + fresh) as f64 * compile > COMPILE_SHARE * request.clock.budget && fresh > 0 {
            notes.push(format!(
                "axis {}: left out, since compiling the scene again ({compile:.1} s) would take too much of the budget",
                axis.name
            ));
            continue;
        }
        compiled.extend(axis.values.iter().filter(|c| again(&c.technique)).map(|c| c.technique));
        planned.extend(axis.values.iter().map(|value| Treatment {
            variant: value.variant(axis, &base),
            technique: value.technique,
            threads: value.threads,
        }));
    }
    planned
}

fn is_chosen(choice: &AxisChoice, axis: &Axis) -> bool {
    match choice {
        AxisChoice::Fitting | AxisChoice::All => true,
        AxisChoice::Named(names) => names.iter().any(|n| n == axis.name),
    }
}

/// Drops whole axes from the end until 4 and 16 samples of everything fit into `seconds`.
pub fn fit(treatments: &mut Vec<Treatment>, seeds: u32, per_sample: f64, seconds: f64, notes: &mut Vec<String>) {
    const LEAST: f64 = 4.0 + 16.0;
    let mut dropped = Vec::new();
    while let Some(last) = treatments.last().map(|t| t.variant.axis.clone())
        && last != axes::SAMPLES
        && LEAST * per_sample * f64::from(seeds) * treatments.len() as f64 > seconds
    {
        treatments.retain(|t| t.variant.axis != last);
        dropped.insert(0, last);
    }
    if !dropped.is_empty() {
        notes.push(format!(
            "axes left out for lack of time: {} (a larger --budget, or --axes, brings them in)",
            dropped.join(", ")
        ));
    }
}
