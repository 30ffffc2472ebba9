//! From a study to one command: the way to the asked error, or the best picture in the asked time.

use super::experiment::{Goal, Row, Study};
use super::fit::{Band, Law};
use super::points::{median, points, usable};
use crate::math::words::{duration, percent, range, rough_duration, rough_percent, shell_word, significant};

/// How much faster another variant must be expected to be before it is preferred to the scene as written.
const WORTH_IT: f64 = 1.25;
/// The same for a biased variant against the best unbiased one.
const WORTH_BIAS: f64 = 1.5;
/// A floor counts as well below the goal up to this share of it: then it adds 13 % to the error at most.
const FLOOR_SHARE: f64 = 0.5;
/// Samples per pixel beyond those measured up to which a law is followed, as a factor: a hundred times less error. The
/// band grows with the distance, and the text says how far it is.
const REACH: f64 = 1e4;
/// Rows with this share of the longest rung's samples tell how a run's own bound relates to the true error.
const LATE: f64 = 0.25;

/// What to type, and what it is expected to give.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Index into [`Study::variants`].
    pub variant: usize,
    /// The command line.
    pub command: String,
    /// Samples per pixel it is expected to take.
    pub spp: u64,
    /// Expected true error E: lower, middle, upper; 90 % lie between.
    pub error: Band,
    /// Expected seconds: lower, middle, upper.
    pub seconds: Band,
}

/// The answer to the goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    /// `None` where the data cannot say.
    pub choice: Option<Choice>,
    /// In words, in Markdown: command, expected error and time, and why; or why there is no answer.
    pub text: String,
}

impl Recommendation {
    fn none(text: impl Into<String>) -> Self {
        Self {
            choice: None,
            text: text.into(),
        }
    }
}

/// A variant that can meet the goal.
#[derive(Clone, Debug)]
struct Candidate {
    variant: usize,
    law: Law,
    /// Samples per pixel, one or more.
    n: f64,
    /// To be minimised: seconds for an error goal, error for a time goal (as the seconds that a base line with
    /// exponent ½ would need, so that both compare on one scale).
    cost: f64,
}

/// The command for the goal of the study. Variants are compared by their fitted laws (see [`super::fit`]): the scene
/// as written unless another variant is clearly faster; a biased one only if its floor is well below the goal and it is
/// much faster than all unbiased ones. The command makes the picture at its full size: of the same samples per pixel it
/// has about the error that the study's smaller one has, and its time grows with the pixels.
pub fn recommend(study: &Study) -> Recommendation {
    let laws: Vec<(usize, Law)> = (0..study.variants.len())
        .filter_map(|v| {
            let mut law = Law::of(study, v)?;
            law.per_sample = law.per_sample.map(|seconds| seconds * study.enlargement());
            Some((v, law))
        })
        .collect();
    if laws.is_empty() {
        return Recommendation::none("Nothing was measured that a recommendation could rest on.");
    }
    match (study.goal, study.error_goal(), study.time_goal()) {
        (_, Some(goal), _) => for_error(study, &laws, goal),
        (_, _, Some(goal)) => for_seconds(study, &laws, goal),
        _ => Recommendation::none("The goal is not a positive number."),
    }
}

fn for_error(study: &Study, laws: &[(usize, Law)], goal: f64) -> Recommendation {
    let candidates: Vec<Candidate> = laws
        .iter()
        .filter(|(v, law)| !study.is_biased(*v) || law.floor_bound <= FLOOR_SHARE * goal)
        .filter_map(|(v, law)| {
            // A run that stops on its own bound ends at a smaller true error than the goal.
            let target = if study.is_biased(*v) {
                goal
            } else {
                goal / caution(study, *v)
            };
            let n = law.samples_for_error(target)?.max(1.0).ceil();
            Some(Candidate {
                variant: *v,
                law: law.clone(),
                n,
                cost: law.seconds(n)[1],
            })
        })
        .collect();
    let candidates = within_reach(proven(study, candidates));
    let Some(pick) = pick(study, &candidates) else {
        return Recommendation::none(format!("No variant leads to an error of {}.", percent(goal)));
    };
    if pick.best.n > REACH * pick.best.law.measured[1] {
        let least = pick.best.law.error(pick.best.law.measured[1])[1];
        return Recommendation::none(format!(
            "The data cannot say how to reach an error of {}: the longest run had {} samples per pixel and an error of \
             {}; the goal would take about {} times as many. Give the study a larger budget or a larger goal.",
            percent(goal),
            pick.best.law.measured[1],
            percent(least),
            significant(pick.best.n / pick.best.law.measured[1], 2),
        ));
    }
    finish(study, &pick)
}

fn for_seconds(study: &Study, laws: &[(usize, Law)], goal: f64) -> Recommendation {
    let candidates: Vec<Candidate> = laws
        .iter()
        .filter_map(|(v, law)| {
            let n = law.samples_for_seconds(goal).filter(|n| *n >= 1.0)?.floor();
            let error = law.error(n)[1];
            let sound = !study.is_biased(*v) || law.floor_bound <= FLOOR_SHARE * error;
            sound.then(|| Candidate {
                variant: *v,
                law: law.clone(),
                n,
                cost: error * error,
            })
        })
        .collect();
    let candidates = proven(study, candidates);
    let Some(pick) = pick(study, &candidates) else {
        return Recommendation::none(format!(
            "{} are too short: reading the scene and one sample for each pixel take longer.",
            duration(goal)
        ));
    };
    if pick.best.n > REACH * pick.best.law.measured[1] {
        return Recommendation::none(format!(
            "The data cannot say what {} give: the longest run took {}. Give the study a larger budget.",
            duration(goal),
            duration(pick.best.law.seconds(pick.best.law.measured[1])[1]),
        ));
    }
    finish(study, &pick)
}

/// The candidates that the pictures themselves speak for: at the most samples that a variant and the base line both
/// have, its worst seed takes less E²·seconds than the best seed of the base line (by chance alone one in 252 variants
/// does, of five seeds each). Laws through few noisy points promise much.
fn proven(study: &Study, candidates: Vec<Candidate>) -> Vec<Candidate> {
    let points = points(study);
    let of = |variant: usize| points.iter().filter(move |p| p.variant == variant);
    let speaks = |variant: usize| {
        let pairs = of(variant).filter_map(|own| of(0).find(|base| base.spp == own.spp).map(|base| (own, base)));
        let last = pairs.max_by_key(|(own, _)| own.spp);
        last.is_some_and(|(own, base)| own.seconds * own.spread.end.powi(2) < base.seconds * base.spread.start.powi(2))
    };
    candidates
        .into_iter()
        .filter(|c| c.variant == 0 || speaks(c.variant))
        .collect()
}

/// The candidates whose laws reach as far as the goal; all if there are none, so that the nearest can be told.
fn within_reach(candidates: Vec<Candidate>) -> Vec<Candidate> {
    let reaches = |c: &Candidate| c.n <= REACH * c.law.measured[1];
    if !candidates.iter().any(reaches) {
        return candidates;
    }
    candidates.into_iter().filter(reaches).collect()
}

/// A candidate, and what it gains over the base line and, if biased, over the best unbiased one.
struct Pick<'a> {
    best: &'a Candidate,
    over_base: Option<f64>,
    over_unbiased: Option<f64>,
}

fn pick<'a>(study: &Study, candidates: &'a [Candidate]) -> Option<Pick<'a>> {
    let least = |biased: bool| {
        let own = candidates.iter().filter(move |c| study.is_biased(c.variant) == biased);
        own.filter(|c| c.cost.is_finite())
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    };
    let base = candidates.iter().find(|c| c.variant == 0);
    let unbiased = match (base, least(false)) {
        (Some(base), Some(other)) if base.cost < WORTH_IT * other.cost => Some(base),
        (_, other) => other,
    };
    let best = match (unbiased, least(true)) {
        (Some(sound), Some(biased)) if sound.cost < WORTH_BIAS * biased.cost => sound,
        (_, Some(biased)) => biased,
        (sound, None) => sound?,
    };
    let gain = |over: Option<&Candidate>| over.filter(|o| o.variant != best.variant).map(|o| o.cost / best.cost);
    Some(Pick {
        best,
        over_base: gain(base),
        over_unbiased: gain(unbiased).filter(|_| study.is_biased(best.variant)),
    })
}

/// Median of a run's own bound over its true error, late in the ladder; of all unbiased variants if this one says
/// nothing, and 1 if none does.
fn caution(study: &Study, variant: usize) -> f64 {
    let ratio = |of: &dyn Fn(usize) -> bool| {
        let rows: Vec<&Row> = usable(study).filter(|row| of(row.variant) && row.e2 > 0.0).collect();
        let last = rows.iter().map(|row| row.spp).max().unwrap_or(0);
        let late = rows.iter().filter(|row| f64::from(row.spp) >= LATE * f64::from(last));
        let bounds = late.filter_map(|row| row.estimate.map(|[_, bound]| bound / row.error()));
        let middle = median(bounds.filter(|b| b.is_finite()).collect());
        (middle.is_finite() && middle > 0.0).then_some(middle)
    };
    ratio(&|v| v == variant)
        .or_else(|| ratio(&|v| !study.is_biased(v)))
        .unwrap_or(1.0)
}

fn finish(study: &Study, pick: &Pick) -> Recommendation {
    let Candidate { variant, law, n, .. } = pick.best;
    let biased = study.is_biased(*variant);
    let flags = study.variants.get(*variant).map_or("", |v| v.flags.trim());
    let mut command = format!("pts render {}", shell_word(&study.scene));
    if study.full_size == study.size {
        command += &format!(" -r {}x{}", study.size[0], study.size[1]);
    }
    for flags in [study.scene_flags.trim(), flags].into_iter().filter(|f| !f.is_empty()) {
        command += &format!(" {flags}");
    }
    let by_time = study.time_goal().filter(|_| study.error_goal().is_none());
    // A run's own error estimate does not see bias, so that the sample count has to say when to stop.
    command += &match (by_time, study.goal) {
        (Some(seconds), _) => format!(" --time {}s", significant(seconds, 4)),
        (None, Goal::Error(e)) if !biased => format!(" --error {}%", significant(100.0 * e, 4)),
        _ => format!(" --spp {n}"),
    };
    let error = law.error(*n);
    let mut seconds = law.seconds(*n);
    if by_time.is_none() && !biased {
        // How many samples the run takes until its bound is below the goal varies as its error does, squared.
        let [low, middle, high] = error;
        seconds = [
            law.seconds(n * (low / middle).powi(2))[0],
            seconds[1],
            law.seconds(n * (high / middle).powi(2))[2],
        ];
    }
    if let Some(goal) = by_time {
        seconds = [goal; 3];
    }
    let choice = Choice {
        variant: *variant,
        command,
        spp: *n as u64,
        error,
        seconds,
    };
    Recommendation {
        text: text(study, pick, &choice),
        choice: Some(choice),
    }
}

fn text(study: &Study, pick: &Pick, choice: &Choice) -> String {
    let law = &pick.best.law;
    let threads = if study.threads == 1 {
        "1 thread"
    } else {
        &format!("{} threads", study.threads)
    };
    let picture = match study.full_size {
        size if size == study.size => String::new(),
        [width, height] => format!(" for {width} × {height} pixels"),
    };
    let [low, middle, high] = choice.error;
    let mut sentences = vec![format!(
        "Expected{picture} on {threads} of this processor: an error of about {} ({}) in about {}{}, {} samples per pixel.",
        rough_percent(middle),
        range(low, high, rough_percent),
        rough_duration(choice.seconds[1]),
        match range(choice.seconds[0], choice.seconds[2], rough_duration) {
            same if same == rough_duration(choice.seconds[1]) => String::new(),
            range => format!(" ({range})"),
        },
        choice.spp,
    )];
    let label = study.label(choice.variant);
    match (pick.over_unbiased, pick.over_base) {
        (Some(gain), _) => sentences.push(format!(
            "`{label}` changes the expected picture, by less than {} here, and is {} times faster than the best variant \
             that does not.",
            rough_percent(law.floor_bound),
            significant(gain, 2)
        )),
        (None, Some(gain)) => sentences.push(format!(
            "`{label}` is {} times faster than the scene as written, for the same error.",
            significant(gain, 2)
        )),
        (None, None) if choice.variant == 0 && study.variants.len() > 1 => {
            sentences.push("No other variant is clearly better than the scene as written.".to_owned());
        }
        _ => {}
    }
    let n = choice.spp as f64;
    if n > 4.0 * law.measured[1] {
        sentences.push(format!(
            "This lies beyond what was measured: {} times the samples of the longest run.",
            significant(n / law.measured[1], 2)
        ));
    }
    format!("    {}\n\n{}", choice.command, sentences.join(" "))
}

#[cfg(test)]
mod tests;
