//! The arguments of `study`.

use super::{LoadArgs, TerminalArgs, ViewArgs};
use crate::cli::choices::{FilterKind, ProgressKind};
use crate::cli::values::{self, Resolution};
use crate::study::axes;
use crate::study::experiment::Goal;
use crate::study::runner::{AxisChoice, FEWEST_SEEDS};
use clap::Args;
use std::path::PathBuf;

const STUDY: &str = "Study";
const PICTURES: &str = "Pictures";
const TERMINAL: &str = super::TERMINAL;

/// What the exit codes of `study` mean; part of its help.
pub const STUDY_EXIT_CODES: &str = "\
Axes:
  direct, sampler, max-depth, roulette, adaptive, clamp, lights, fresnel, multiple-scattering, textures, build, threads;
  samples are always varied. Axes that cannot matter for the scene are left out, and the study says why.

Exit codes:
  0    done
  1    the scene or an input is at fault
  2    wrong usage, also a budget that is too short for a single point
  4    the reference cannot be read, or a file cannot be written
  130  interrupted (what was measured so far is written)";

/// Everything `study` can be told.
#[derive(Args, Clone, Debug)]
pub struct StudyArgs {
    /// The scene: .pts, .pov, .gltf, .glb or .obj, or - for text on standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Directory for study.svg, study.png, study.md, study.csv and study.json; made if it is not there
    /// [default: <scene>-study in the working directory].
    #[arg(short, long, value_name = "DIR", help_heading = STUDY)]
    pub output: Option<PathBuf>,
    /// Time for everything: reading, the reference, all pictures, the effects and writing.
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = values::duration, help_heading = STUDY)]
    pub budget: f64,
    /// What to reach, as an error (2% or 0.02) or a time (30s); the recommendation is made for it
    /// [default: the scene's error or time, else 3%].
    #[arg(long, value_name = "ERROR|TIME", value_parser = goal, help_heading = STUDY)]
    pub goal: Option<Goal>,
    /// What is varied besides samples: names separated by commas, all that can matter, or none
    /// [default: as many that can matter as the budget holds].
    #[arg(long, value_name = "AXES", value_parser = axis_choice, help_heading = STUDY)]
    pub axes: Option<AxisChoice>,
    /// Pictures of each point, with a seed each; at least 5, so that their spread means something.
    #[arg(long, value_name = "N", default_value_t = FEWEST_SEEDS,
          value_parser = clap::value_parser!(u32).range(i64::from(FEWEST_SEEDS)..=1000), help_heading = STUDY)]
    pub seeds: u32,
    /// Samples per pixel to try, rising, separated by commas [default: 4, 16, 64, … while the budget lasts].
    #[arg(long, value_name = "SPP,…", value_parser = ladder, help_heading = STUDY)]
    pub ladder: Option<Ladder>,
    /// Image to measure against, of the pictures' size, best an .exr of pts with its standard errors: then its noise is
    /// subtracted [default: one is rendered, without bias, in 30 % of the budget].
    #[arg(long, value_name = "FILE", help_heading = STUDY)]
    pub reference: Option<PathBuf>,
    /// Do not measure what each effect of the scene costs and brings.
    #[arg(long, help_heading = STUDY)]
    pub no_ablation: bool,
    /// Size in pixels, for example 320x240 [default: the reference's, else the scene's aspect, at most 320 wide].
    #[arg(short, long, value_name = "WxH", conflicts_with_all = ["width", "height"], help_heading = PICTURES)]
    pub resolution: Option<Resolution>,
    /// Columns; the height follows by the scene's aspect unless given.
    #[arg(long, value_name = "N", value_parser = values::side, help_heading = PICTURES)]
    pub width: Option<u32>,
    /// Rows; the width follows by the scene's aspect unless given.
    #[arg(long, value_name = "N", value_parser = values::side, help_heading = PICTURES)]
    pub height: Option<u32>,
    /// Pixel filter [default: the scene's, else blackman-harris].
    #[arg(long, value_name = "FILTER", help_heading = PICTURES)]
    pub filter: Option<FilterKind>,
    /// Independently scrambled sample nets [default: 4].
    #[arg(long, value_name = "N", value_parser = super::sampling::nets, help_heading = PICTURES)]
    pub nets: Option<u32>,
    /// All seeds are counted from this one: rows have the seeds after N + 1000, the reference N + 1000000
    /// [default: the scene's, else 0].
    #[arg(long, value_name = "N", help_heading = PICTURES)]
    pub seed: Option<u64>,
    /// Threads [default: one for each core].
    #[arg(short = 'j', long, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=4096), help_heading = PICTURES)]
    pub threads: Option<u32>,
    /// What replaces parts of the scene.
    #[command(flatten)]
    pub view: ViewArgs,
    /// How the scene is read.
    #[command(flatten)]
    pub load: LoadArgs,
    /// What is said meanwhile.
    #[command(flatten)]
    pub terminal: TerminalArgs,
    /// How progress is shown: a bar on terminals and plain lines elsewhere (auto), or one JSON object a line.
    #[arg(long, value_name = "HOW", help_heading = TERMINAL)]
    pub progress: Option<ProgressKind>,
}

impl StudyArgs {
    /// What is given of the pictures' columns and rows.
    pub fn size(&self) -> [Option<u32>; 2] {
        match self.resolution {
            Some(r) => [Some(r.width), Some(r.height)],
            None => [self.width, self.height],
        }
    }
}

/// Samples per pixel, rising.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ladder(pub Vec<u32>);

fn ladder(text: &str) -> Result<Ladder, String> {
    let wrong = || format!("`{text}` is no ladder; write rising numbers of samples, for example 4,16,64");
    let steps: Result<Vec<u32>, String> = text
        .split(',')
        .map(|word| {
            let spp = word.trim().parse::<u32>().map_err(|_| wrong())?;
            if (1..=values::MAX_SPP).contains(&spp) {
                Ok(spp)
            } else {
                Err(wrong())
            }
        })
        .collect();
    let steps = steps?;
    if steps.is_empty() || steps.windows(2).any(|w| w[0] >= w[1]) {
        return Err(wrong());
    }
    Ok(Ladder(steps))
}

fn goal(text: &str) -> Result<Goal, String> {
    let ends_with_unit = text.trim().ends_with(|c: char| c.is_ascii_alphabetic());
    if ends_with_unit {
        return values::duration(text).map(Goal::Seconds);
    }
    values::error_goal(text)
        .map(Goal::Error)
        .map_err(|_| format!("`{text}` is neither an error (2% or 0.02) nor a time (30s or 5m)"))
}

fn axis_choice(text: &str) -> Result<AxisChoice, String> {
    match text.trim() {
        "all" => return Ok(AxisChoice::All),
        "none" => return Ok(AxisChoice::Named(Vec::new())),
        _ => {}
    }
    let known = axes::names();
    let mut chosen = Vec::new();
    for name in text.split(',').map(str::trim) {
        if !known.contains(&name) {
            let near = known.iter().min_by_key(|k| strsim::damerau_levenshtein(k, name));
            let near = near.filter(|k| strsim::damerau_levenshtein(k, name) <= 2);
            let hint = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
            return Err(format!(
                "there is no axis `{name}`{hint} (the axes: all, none, or {})",
                known.join(", ")
            ));
        }
        chosen.push(name.to_owned());
    }
    Ok(AxisChoice::Named(chosen))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_errors_or_times() {
        assert_eq!(goal("2%"), Ok(Goal::Error(0.02)));
        assert_eq!(goal("0.02"), Ok(Goal::Error(0.02)));
        assert_eq!(goal("1m30s"), Ok(Goal::Seconds(90.0)));
        for wrong in ["30", "", "0%", "fast", "0s"] {
            assert!(goal(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn ladders_rise() {
        assert_eq!(ladder("4, 16,64"), Ok(Ladder(vec![4, 16, 64])));
        for wrong in ["", "4,4", "16,4", "0,1", "4,x"] {
            assert!(ladder(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn axes_are_chosen_by_name() {
        assert_eq!(axis_choice("all"), Ok(AxisChoice::All));
        assert_eq!(axis_choice("none"), Ok(AxisChoice::Named(vec![])));
        let two = AxisChoice::Named(vec!["direct".to_owned(), "clamp".to_owned()]);
        assert_eq!(axis_choice("direct,clamp"), Ok(two));
        assert!(axis_choice("roulete").unwrap_err().contains("did you mean roulette"));
    }

    #[test]
    fn the_help_names_every_axis() {
        for name in axes::names() {
            assert!(STUDY_EXIT_CODES.contains(name), "{name}");
        }
    }
}
