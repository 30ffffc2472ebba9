//! Decides what is rendered: the command line over the scene over the built-in defaults.

use super::args::{OutputArgs, PartArgs, QualityArgs, RenderArgs};
use super::choices::{FilterKind, ToneMapKind};
use super::values::MAX_SPP;
use crate::render::settings::{Aovs, Filter, Region, Settings, StopRules};
use crate::render::technique::Technique;
use crate::scene::{self, Aspect, Handedness, RenderDefaults, Scene};
use std::time::Instant;

/// Width and height where nobody names any.
pub const DEFAULT_RESOLUTION: [u32; 2] = [800, 600];

/// The goal and its cap where neither the command line nor the scene has a stop rule.
const DEFAULT_ERROR: f64 = 0.03;
const DEFAULT_ERROR_SPP: u32 = 1024;

/// Cap of an error goal that came without any other rule.
const ERROR_ALONE_SPP: u32 = 65_536;

/// Stop rules, and whether somebody asked for their error goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The rules.
    pub rules: StopRules,
    /// The error goal stands on the command line or in the scene: missing it is worth an exit code.
    pub error_was_asked: bool,
}

/// The stop rules in force. Any stop rule on the command line replaces all rules of the scene.
pub fn stop_rules(args: &QualityArgs, scene: &RenderDefaults) -> Goal {
    let confidence = args.confidence.or(scene.confidence);
    let from_args = Asked {
        spp: args.spp,
        seconds: args.time,
        error: args.error,
        error_max: args.error_max,
        error_display: args.error_display,
    };
    let from_scene = Asked {
        spp: scene.spp,
        seconds: scene.time,
        error: scene.error,
        ..Asked::default()
    };
    if from_args != Asked::default() {
        from_args.rules(args.confidence, true)
    } else if from_scene != Asked::default() {
        from_scene.rules(confidence, true)
    } else {
        let built_in = Asked {
            spp: Some(DEFAULT_ERROR_SPP),
            error: Some(DEFAULT_ERROR),
            ..Asked::default()
        };
        built_in.rules(confidence, false)
    }
}

/// Stop rules as somebody gave them.
#[derive(Default, PartialEq)]
struct Asked {
    spp: Option<u32>,
    seconds: Option<f64>,
    error: Option<f64>,
    error_max: Option<f64>,
    error_display: Option<f64>,
}

impl Asked {
    fn rules(&self, confidence: Option<f64>, was_asked: bool) -> Goal {
        let mut rules = StopRules {
            seconds: self.seconds,
            error: self.error,
            error_max: self.error_max,
            error_display: self.error_display,
            ..StopRules::samples(MAX_SPP)
        };
        let alone = rules.has_error_goal() && rules.seconds.is_none();
        rules.spp = self.spp.unwrap_or(if alone { ERROR_ALONE_SPP } else { MAX_SPP });
        rules.confidence = confidence.unwrap_or(rules.confidence);
        Goal {
            rules,
            error_was_asked: was_asked && rules.has_error_goal(),
        }
    }
}

/// `--samples`: exactly these, whatever the scene says.
pub fn exactly(samples: &std::ops::Range<u32>, goal: Goal) -> Goal {
    Goal {
        rules: StopRules {
            confidence: goal.rules.confidence,
            ..StopRules::samples(samples.end - samples.start)
        },
        error_was_asked: false,
    }
}

/// The pixels to render. An error if they are not in the picture.
pub fn region(args: &PartArgs, [width, height]: [u32; 2]) -> Result<Region, String> {
    if let Some(tile) = &args.tile {
        return tile.region(width, height);
    }
    let region = args.region.unwrap_or(Region::whole(width, height));
    if region.x1 > width || region.y1 > height {
        return Err(format!("--region ends outside the picture of {width}x{height} pixels"));
    }
    Ok(region)
}

/// Width and height: flags, else the scene's, else by the aspect of a model's camera, else 800×600.
/// Where only one of both is given the other follows by the aspect of what would have been chosen.
pub fn resolution(args: &QualityArgs, scene: &Scene) -> [u32; 2] {
    match args.resolution {
        Some(r) => [r.width, r.height],
        None => size([args.width, args.height], scene),
    }
}

/// The same where columns and rows are given one by one.
pub fn size(given: [Option<u32>; 2], scene: &Scene) -> [u32; 2] {
    let base = scene.defaults.resolution.unwrap_or_else(|| by_camera(scene));
    let aspect = f64::from(base[0]) / f64::from(base[1]);
    match given {
        [Some(width), Some(height)] => [width, height],
        [Some(width), None] => [width, pixels(f64::from(width) / aspect)],
        [None, Some(height)] => [pixels(f64::from(height) * aspect), height],
        [None, None] => base,
    }
}

/// The size a model's camera suggests: its aspect, with 600 pixels along the shorter side.
fn by_camera(scene: &Scene) -> [u32; 2] {
    let Some(camera) = scene.camera().filter(|c| c.aspect == Aspect::FromImage) else {
        return DEFAULT_RESOLUTION;
    };
    let aspect = camera.right.length() / camera.up.length();
    let short = f64::from(DEFAULT_RESOLUTION[1]);
    if !(aspect.is_finite() && aspect > 0.0) {
        DEFAULT_RESOLUTION
    } else if aspect >= 1.0 {
        [pixels(short * aspect), DEFAULT_RESOLUTION[1]]
    } else {
        [DEFAULT_RESOLUTION[1], pixels(short / aspect)]
    }
}

fn pixels(side: f64) -> u32 {
    (side.round() as u32).max(1)
}

/// The engine's settings for a scene.
pub fn settings(args: &RenderArgs, scene: &Scene, size: [u32; 2], goal: &Goal, started: Instant) -> Settings {
    let (sampling, defaults) = (&args.sampling, &scene.defaults);
    let base = Settings::new(size[0], size[1], goal.rules.spp);
    Settings {
        first: args.parts.samples.as_ref().map_or(0, |s| s.0.start),
        stop: goal.rules,
        seed: sampling.seed.or(defaults.seed).unwrap_or(base.seed),
        nets: sampling.nets.unwrap_or(base.nets),
        filter: filter(sampling.filter, defaults),
        technique: technique(args, defaults),
        aovs: aovs(&args.output),
        started,
        ..base
    }
}

/// What trades accuracy for time.
fn technique(args: &RenderArgs, defaults: &RenderDefaults) -> Technique {
    let given = args.sampling.technique();
    Technique {
        max_depth: args
            .sampling
            .max_depth
            .or(defaults.max_depth)
            .unwrap_or(given.max_depth),
        ..given
    }
}

/// The pixel filter: the flag's, else the scene's, else the default.
pub fn filter(flag: Option<FilterKind>, defaults: &RenderDefaults) -> Filter {
    match (flag, defaults.filter) {
        (Some(FilterKind::Box), _) | (None, Some(scene::FilterKind::Box)) => Filter::Box,
        (Some(FilterKind::Gaussian), _) | (None, Some(scene::FilterKind::Gaussian)) => Filter::Gaussian,
        (Some(FilterKind::BlackmanHarris), _) | (None, Some(scene::FilterKind::BlackmanHarris)) => {
            Filter::BlackmanHarris
        }
        (None, None) => Filter::default(),
    }
}

/// The layers that the engine has to give, for `--aov` and for `--view`.
pub fn aovs(output: &OutputArgs) -> Aovs {
    use super::choices::{Aov, ViewName};
    let asked = |aov| output.aov.contains(&aov);
    let seen = |view| output.view == Some(view);
    Aovs {
        depth: asked(Aov::Depth) || seen(ViewName::Depth),
        normal: asked(Aov::Normal) || seen(ViewName::Normal),
        albedo: asked(Aov::Albedo) || seen(ViewName::Albedo),
        time: asked(Aov::Time) || seen(ViewName::Time),
        tail: asked(Aov::Tail),
        half_a: asked(Aov::HalfA),
        half_b: asked(Aov::HalfB),
    }
}

/// Why a single net cannot give the layers that are asked for, if it cannot.
pub fn needs_nets(output: &OutputArgs) -> Option<&'static str> {
    if aovs(output).need_nets() {
        Some(
            "the layers tail, halfA and halfB come from the spread of several nets, and --nets 1 has one: leave it out",
        )
    } else if output.view == Some(super::choices::ViewName::Error) {
        Some("--view error comes from the spread of several nets, and --nets 1 has one: leave it out")
    } else {
        None
    }
}

/// The tone curve without a flag: none for text scenes (they say what they mean) and neutral for bare models.
pub fn scene_tone_map(scene: &Scene) -> ToneMapKind {
    match scene.handedness {
        Handedness::Left => ToneMapKind::None,
        Handedness::Right => ToneMapKind::Neutral,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Cli, Command};
    use crate::render::technique::Direct;
    use crate::scene::Camera;
    use clap::Parser;
    use glam::DVec3;

    fn args(flags: &str) -> RenderArgs {
        let words = ["pts", "render", "a.pts"].into_iter().chain(flags.split_whitespace());
        match Cli::parse_from(words).command {
            Some(Command::Render(args)) => *args,
            other => panic!("{other:?}"),
        }
    }

    fn rules(flags: &str, scene: &RenderDefaults) -> (u32, Option<f64>, Option<f64>, f64, bool) {
        let goal = stop_rules(&args(flags).quality, scene);
        let rules = goal.rules;
        (
            rules.spp,
            rules.seconds,
            rules.error,
            rules.confidence,
            goal.error_was_asked,
        )
    }

    #[test]
    fn without_rules_the_goal_is_three_percent_and_nobody_asked_for_it() {
        let none = RenderDefaults::default();
        assert_eq!(rules("", &none), (1024, None, Some(0.03), 0.9, false));
        assert_eq!(rules("--confidence 95", &none), (1024, None, Some(0.03), 0.95, false));
    }

    #[test]
    fn one_rule_of_the_command_line_replaces_all_of_the_scene() {
        let scene = RenderDefaults {
            spp: Some(7),
            error: Some(0.01),
            time: Some(5.0),
            confidence: Some(0.5),
            ..RenderDefaults::default()
        };
        assert_eq!(rules("", &scene), (7, Some(5.0), Some(0.01), 0.5, true));
        assert_eq!(rules("--confidence 80", &scene), (7, Some(5.0), Some(0.01), 0.8, true));
        assert_eq!(rules("-s 16", &scene), (16, None, None, 0.9, false));
        assert_eq!(rules("--time 1m", &scene), (1 << 31, Some(60.0), None, 0.9, false));
        assert_eq!(rules("--error 2%", &scene), (65_536, None, Some(0.02), 0.9, true));
    }

    #[test]
    fn a_time_limit_is_a_cap_for_an_error_goal() {
        let none = RenderDefaults::default();
        assert_eq!(
            rules("--error 1% --time 1h", &none),
            (1 << 31, Some(3600.0), Some(0.01), 0.9, true)
        );
        assert_eq!(rules("--error 1% -s 100", &none), (100, None, Some(0.01), 0.9, true));
    }

    fn with_camera(aspect: f64) -> Scene {
        Scene {
            cameras: vec![Camera {
                right: DVec3::X * aspect,
                aspect: Aspect::FromImage,
                ..Camera::default()
            }],
            active_camera: Some(0),
            ..Scene::default()
        }
    }

    #[test]
    fn the_size_comes_from_flags_then_the_scene_then_the_camera() {
        let mut scene = with_camera(2.0);
        assert_eq!(resolution(&args("").quality, &scene), [1200, 600]);
        assert_eq!(resolution(&args("").quality, &with_camera(0.5)), [600, 1200]);
        assert_eq!(resolution(&args("").quality, &with_camera(f64::NAN)), [800, 600]);
        assert_eq!(resolution(&args("").quality, &Scene::default()), [800, 600]);
        scene.defaults.resolution = Some([300, 100]);
        assert_eq!(resolution(&args("").quality, &scene), [300, 100]);
        assert_eq!(resolution(&args("--width 60").quality, &scene), [60, 20]);
        assert_eq!(resolution(&args("--height 60").quality, &scene), [180, 60]);
        assert_eq!(resolution(&args("--height 1 --width 2").quality, &scene), [2, 1]);
        assert_eq!(resolution(&args("-r 5x6").quality, &scene), [5, 6]);
    }

    #[test]
    fn flags_win_over_the_scenes_settings() {
        let mut scene = Scene::default();
        scene.defaults.seed = Some(3);
        scene.defaults.max_depth = Some(4);
        scene.defaults.filter = Some(scene::FilterKind::Box);
        let settings = |flags: &str| {
            let args = args(flags);
            let goal = stop_rules(&args.quality, &scene.defaults);
            settings(&args, &scene, [8, 8], &goal, Instant::now())
        };
        let s = settings("");
        assert_eq!((s.seed, s.technique.max_depth, s.filter), (3, 4, Filter::Box));
        let s = settings("--seed 9 --max-depth 0 --filter gaussian --nets 8 --direct bsdf");
        assert_eq!((s.seed, s.technique.max_depth, s.filter), (9, 0, Filter::Gaussian));
        assert_eq!((s.nets, s.technique.direct), (8, Direct::Bsdf));
    }

    #[test]
    fn bare_models_are_tone_mapped_and_text_scenes_are_not() {
        let mut scene = Scene::default();
        assert_eq!(scene_tone_map(&scene), ToneMapKind::None);
        scene.handedness = Handedness::Right;
        assert_eq!(scene_tone_map(&scene), ToneMapKind::Neutral);
    }
}
