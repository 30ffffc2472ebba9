//! The ladders: pictures of all variants, in turns, measured as they come.

use super::variants::Treatment;
use super::{Failure, Request, seeds};
use crate::study::experiment::{Phases, Row, Variant};
use crate::study::ladder::{self, BASE_SHARE, Cost, Left, Level};
use crate::study::workshop::{Order, Stopped, Watch, Workshop};
use crate::study::yardstick::Yardstick;
use std::time::Instant;

/// The first seed of a step may be this much dearer than expected before variants are dropped at it.
const SLACK: f64 = 1.5;

/// What is measured so far.
pub struct Rows<'a> {
    request: &'a Request<'a>,
    yardstick: &'a Yardstick,
    treatments: &'a [Treatment],
    costs: Vec<Cost>,
    /// When the last row must be done, in seconds since the start.
    end: f64,
    /// Seconds that are kept for the base line.
    reserve: f64,
    /// The rows; [`Row::variant`] is the index of the treatment.
    pub rows: Vec<Row>,
    notes: Vec<String>,
}

impl<'a> Rows<'a> {
    /// Nothing is measured yet; a sample of each pixel costs the base line about `per_sample` seconds.
    pub fn new(
        request: &'a Request<'a>,
        yardstick: &'a Yardstick,
        treatments: &'a [Treatment],
        per_sample: f64,
        end: f64,
    ) -> Rows<'a> {
        let most = rayon::current_num_threads();
        let slower = |t: &Treatment| most as f64 / t.threads.unwrap_or(most) as f64;
        let cost = |t: &Treatment| Cost {
            fixed: 0.0,
            per_sample: per_sample * slower(t),
            least_spp: t.least_spp(),
        };
        Rows {
            request,
            yardstick,
            treatments,
            costs: treatments.iter().map(cost).collect(),
            end,
            reserve: BASE_SHARE * (end - request.clock.elapsed()).max(0.0),
            rows: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Takes step after step while they fit. Returns whether the user ended it.
    pub fn climb(&mut self, workshop: &mut Workshop, watch: &dyn Watch) -> Result<bool, Failure> {
        let mut active: Vec<usize> = (0..self.treatments.len()).collect();
        let mut last = None;
        let given = self.request.ladder.clone();
        let mut given = given.as_ref().map(|l| l.iter().copied());
        loop {
            let left = Left {
                all: self.end - self.request.clock.elapsed(),
                reserve: self.reserve,
            };
            let level = match &mut given {
                Some(steps) => {
                    let step = steps.next();
                    step.map(|spp| ladder::fitting(spp, &active, &self.costs, self.request.seeds, left))
                        .filter(|level| !level.variants.is_empty())
                }
                None => ladder::next(last, &active, &self.costs, self.request.seeds, left),
            };
            let Some(mut level) = level else { break };
            self.tell_dropped(&active, &level);
            let waits = |v: &usize| self.treatments.get(*v).is_some_and(|t| t.least_spp() > level.spp);
            let waiting: Vec<usize> = level.variants.iter().copied().filter(waits).collect();
            level.variants.retain(|v| !waiting.contains(v));
            if self.step(&level, workshop, watch)? {
                return Ok(true);
            }
            let done = |v: &usize| self.rows.iter().any(|r| r.variant == *v && r.spp == level.spp);
            active = level.variants.iter().copied().filter(done).collect();
            if !active.is_empty() {
                active.extend(waiting);
            }
            last = Some(level.spp);
            if active.is_empty() {
                break;
            }
        }
        for spp in given.into_iter().flatten() {
            self.notes
                .push(format!("{spp} samples per pixel: left out for lack of time"));
        }
        Ok(false)
    }

    /// One step: each variant with each seed. Returns whether the user ended it.
    fn step(&mut self, level: &Level, workshop: &mut Workshop, watch: &dyn Watch) -> Result<bool, Failure> {
        let all = seeds(self.request);
        let mut dropped: Vec<usize> = Vec::new();
        for (i, seed) in all.iter().enumerate() {
            for &v in &level.variants {
                if dropped.contains(&v) {
                    continue;
                }
                let expected = self.costs.get(v).map_or(0.0, |c| c.of(level.spp));
                let remaining = (all.len() - i) as f64;
                let left = self.end - self.request.clock.elapsed();
                // All its seeds or none: what cannot be finished is not gone on with.
                if expected * remaining > left * SLACK || expected > left {
                    dropped.push(v);
                    continue;
                }
                match self.run(v, *seed, (i + 1, all.len()), level.spp, workshop)? {
                    Some(row) => {
                        if let Some(treatment) = self.treatments.get(v) {
                            watch.row(&treatment.variant, &row);
                        }
                        self.rows.push(row);
                    }
                    None => return Ok(true),
                }
            }
        }
        if !dropped.is_empty() {
            let is_dropped = |r: &Row| r.spp == level.spp && dropped.contains(&r.variant);
            self.rows.retain(|r| !is_dropped(r));
            self.note_dropped(level.spp, &dropped);
        }
        Ok(false)
    }

    /// One picture; `None` if the user ended it.
    fn run(
        &mut self,
        v: usize,
        seed: u64,
        (turn, turns): (usize, usize),
        spp: u32,
        workshop: &mut Workshop,
    ) -> Result<Option<Row>, Failure> {
        let Some(treatment) = self.treatments.get(v) else {
            return Ok(None);
        };
        let begun = Instant::now();
        let what = format!("{}, {spp} spp, seed {turn} of {turns}", name(&treatment.variant));
        let order = Order {
            technique: treatment.technique,
            threads: treatment.threads,
            seed,
            spp,
            seconds: None,
            stage: "rows",
            what: &what,
        };
        let shot = match workshop.shoot(&order) {
            Ok(shot) => shot,
            Err(Stopped::Interrupted) => return Ok(None),
            Err(other) => return Err(other.into()),
        };
        let found = self.yardstick.measure(&shot.image)?;
        if let Some(cost) = self.costs.get_mut(v) {
            *cost = Cost {
                fixed: (begun.elapsed().as_secs_f64() - shot.seconds).max(0.0),
                per_sample: shot.seconds / f64::from(spp),
                least_spp: cost.least_spp,
            };
        }
        Ok(Some(Row {
            variant: v,
            seed,
            threads: treatment.threads.unwrap_or_else(rayon::current_num_threads),
            seconds: Phases {
                load: self.request.load,
                compile: shot.compile,
                render: shot.seconds,
            },
            spp,
            samples: shot.report.samples,
            rays: shot.report.rays,
            e2: found.e2,
            e2_se: found.e2_se,
            estimate: shot.report.error.map(|e| [e.error, e.bound]),
            flip: found.flip,
            energy: found.energy,
        }))
    }

    fn tell_dropped(&mut self, active: &[usize], level: &Level) {
        let dropped: Vec<usize> = active.iter().copied().filter(|v| !level.variants.contains(v)).collect();
        if !dropped.is_empty() {
            self.note_dropped(level.spp, &dropped);
        }
    }

    fn note_dropped(&mut self, spp: u32, dropped: &[usize]) {
        let names = dropped
            .iter()
            .filter_map(|v| self.treatments.get(*v))
            .map(|t| name(&t.variant));
        let names: Vec<String> = names.collect();
        self.notes.push(format!(
            "from {spp} samples per pixel on, left out for lack of time: {}",
            names.join(", ")
        ));
    }

    /// The variants that were measured, their rows in the order of variant, samples and seed, and what was left out.
    /// After an interruption points may have fewer seeds.
    pub fn finish(mut self, interrupted: bool) -> (Vec<Variant>, Vec<Row>, Vec<String>) {
        if interrupted {
            self.notes
                .push("interrupted: the last points have fewer seeds than the others".to_owned());
        }
        let mut variants = Vec::new();
        let mut rows = Vec::new();
        for (v, treatment) in self.treatments.iter().enumerate() {
            let mut own: Vec<Row> = self.rows.iter().filter(|r| r.variant == v).cloned().collect();
            if own.is_empty() {
                let why = match treatment.least_spp() {
                    1 => String::new(),
                    least => format!(", since it differs from the base line only from {least} samples per pixel on"),
                };
                self.notes
                    .push(format!("{}: not measured{why}", name(&treatment.variant)));
                continue;
            }
            own.sort_by_key(|r| (r.spp, r.seed));
            own.iter_mut().for_each(|r| r.variant = variants.len());
            rows.extend(own);
            variants.push(treatment.variant.clone());
        }
        (variants, rows, self.notes)
    }
}

/// What people call a variant: `as written`, `roulette: late`.
fn name(variant: &Variant) -> String {
    match variant.axis.as_str() {
        crate::study::axes::SAMPLES => variant.name.clone(),
        axis => format!("{axis}: {}", variant.name),
    }
}
