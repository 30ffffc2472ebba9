//! The command line as data. Every flag is declared and explained here, once; the commands only read the result.

use super::animation::Moment;
use super::camera::CameraChoice;
use super::choices::{
    Aov, ColorKind, GlassChoice, HeatmapKind, OutputFormat, ProgressKind, ReportFormat, ToneMapKind, ViewName,
};
use super::values::{self, Forced, Resolution};
use crate::compile::effects::Effect;
use clap::{Args, Parser, Subcommand};
use std::path::{Path, PathBuf};

mod animation;
mod parts;
mod sampling;
mod study;

pub use animation::AnimationArgs;
pub use parts::{MergeArgs, PartArgs};
pub use sampling::SamplingArgs;
pub use study::{STUDY_EXIT_CODES, StudyArgs};

/// A path tracer for scenes written as text (POV-Ray's language, grown), glTF and OBJ, with honest error figures.
///
/// `pts scene.pts` is short for `pts render scene.pts`.
#[derive(Debug, Parser)]
#[command(
    name = "pts",
    version,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    arg_required_else_help = true,
    after_help = EXIT_CODES,
    max_term_width = 110
)]
pub struct Cli {
    /// What to do; without a command the scene is rendered.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The arguments of `render`, where no command is named.
    #[command(flatten)]
    pub render: RenderArgs,
}

/// What each exit code means; part of the help.
pub const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    the scene or an input is at fault
  2    wrong usage
  3    an error goal that was asked for was not reached (the picture is written)
  4    an image cannot be written
  130  interrupted (the picture so far is saved)";

/// What the exit codes of `compare` mean; part of its help.
pub const COMPARE_EXIT_CODES: &str = "\
Exit codes:
  0    within all thresholds, or none was given
  1    beyond a threshold
  2    wrong usage
  4    an image cannot be read, the sizes differ, or a heat map cannot be written";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to image files.
    #[command(after_help = EXIT_CODES)]
    Render(Box<RenderArgs>),
    /// Read scenes and everything they use, and report all mistakes, without rendering.
    Check(CheckArgs),
    /// Show what a scene calls for and who calls for it, what is pruned because the picture does not need it, and how large it is.
    Inspect(Box<InspectArgs>),
    /// Measure how far an image is from a reference, and whether noise explains it.
    #[command(after_help = COMPARE_EXIT_CODES)]
    Compare(CompareArgs),
    /// Measure what accuracy costs in time: render a scene in many ways and draw error against seconds.
    #[command(visible_alias = "tradeoff", after_help = STUDY_EXIT_CODES)]
    Study(Box<StudyArgs>),
    /// Bring part files (.ptspart) together: the picture is the one that a single render of all samples gives, bit by bit.
    #[command(after_help = EXIT_CODES)]
    Merge(MergeArgs),
}

/// Everything `render` can be told.
#[derive(Args, Clone, Debug)]
pub struct RenderArgs {
    /// The scene: .pts, .pov, .gltf, .glb or .obj, or - for text on standard input.
    #[arg(value_name = "SCENE", required = true)]
    scene: Option<PathBuf>,
    /// Where pictures go.
    #[command(flatten)]
    pub output: OutputArgs,
    /// How large the picture is and when it is good enough.
    #[command(flatten)]
    pub quality: QualityArgs,
    /// What replaces parts of the scene.
    #[command(flatten)]
    pub view: ViewArgs,
    /// How light is sampled.
    #[command(flatten)]
    pub sampling: SamplingArgs,
    /// What is taken out of the scene.
    #[command(flatten)]
    pub prune: PruneArgs,
    /// Which part of the picture is rendered.
    #[command(flatten)]
    pub parts: PartArgs,
    /// Which frames of an animation are rendered.
    #[command(flatten)]
    pub animation: AnimationArgs,
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

impl RenderArgs {
    /// The scene's path; `-` is standard input. Never empty where these are the arguments of the command that runs:
    /// clap asks for it, and lets it be missing only beside another command.
    pub fn scene(&self) -> &Path {
        self.scene.as_deref().unwrap_or(Path::new(""))
    }
}

const OUTPUT: &str = "Output";
const PICTURE: &str = "Picture and stop rules (the first rule reached wins)";
const VIEW: &str = "Camera and light";
const SCENE: &str = "Scene";
const TERMINAL: &str = "Terminal";

/// Where pictures go and how they are developed.
#[derive(Args, Clone, Debug)]
pub struct OutputArgs {
    /// Image to write, by extension .png .exr .hdr .jpg or .ppm; - is standard output;
    /// .ptspart keeps the exact sums for pts merge. Can be repeated.
    /// [default: the scene's name with .png, in the working directory]
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    pub output: Vec<PathBuf>,
    /// Format of standard output, for -o -.
    #[arg(long, value_name = "FORMAT", help_heading = OUTPUT)]
    pub format: Option<OutputFormat>,
    /// Extra layers of EXR files, separated by commas (stderr and samples are always there).
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', help_heading = OUTPUT)]
    pub aov: Vec<Aov>,
    /// What .png, .jpg and .ppm files show instead of the picture; .exr and .hdr files are as without it.
    #[arg(long, value_name = "WHAT", conflicts_with_all = ["tonemap", "exposure", "no_dither"], help_heading = OUTPUT)]
    pub view: Option<ViewName>,
    /// Tone curve of 8-bit images [default: none for text scenes, neutral for bare models].
    #[arg(long, value_name = "CURVE", help_heading = OUTPUT)]
    pub tonemap: Option<ToneMapKind>,
    /// Exposure of 8-bit images in stops: each doubles the light [default: 0].
    #[arg(long, value_name = "EV", allow_negative_numbers = true, value_parser = values::finite, help_heading = OUTPUT)]
    pub exposure: Option<f64>,
    /// Round 8-bit images to the nearest value instead of dithering them.
    #[arg(long, help_heading = OUTPUT)]
    pub no_dither: bool,
}

/// How large the picture is and when it is good enough.
#[derive(Args, Clone, Debug)]
pub struct QualityArgs {
    /// Size in pixels, for example 1280x720 [default: the scene's, or by the aspect of its camera, or 800x600].
    #[arg(short, long, value_name = "WxH", conflicts_with_all = ["width", "height"], help_heading = PICTURE)]
    pub resolution: Option<Resolution>,
    /// Columns; the height follows by the scene's aspect unless given.
    #[arg(long, value_name = "N", value_parser = values::side, help_heading = PICTURE)]
    pub width: Option<u32>,
    /// Rows; the width follows by the scene's aspect unless given.
    #[arg(long, value_name = "N", value_parser = values::side, help_heading = PICTURE)]
    pub height: Option<u32>,
    /// Samples per pixel at most. Any of --spp, --time and the error goals replaces all stop rules of the scene
    /// [default: the scene's rules, else --error 3% with at most 1024 samples].
    #[arg(short, long, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=values::MAX_SPP as i64), help_heading = PICTURE)]
    pub spp: Option<u32>,
    /// Time from the start of the program, for example 90s, 10m or 1h; one pass is always completed.
    #[arg(long, value_name = "DURATION", value_parser = values::duration, help_heading = PICTURE)]
    pub time: Option<f64>,
    /// Stop when the relative error of the picture is below this, for example 2% or 0.02, with the given confidence.
    #[arg(long, value_name = "GOAL", value_parser = values::error_goal, help_heading = PICTURE)]
    pub error: Option<f64>,
    /// Stop when the relative error of 99 % of the pixels, each pooled over its neighbours, is below this, with the
    /// given confidence.
    #[arg(long, value_name = "GOAL", value_parser = values::error_goal, help_heading = PICTURE)]
    pub error_max: Option<f64>,
    /// Stop when the error of the developed picture is below this many steps of 8 bits (root mean square), for
    /// example 1, with the given confidence.
    #[arg(long, value_name = "STEPS", value_parser = values::above_zero, help_heading = PICTURE)]
    pub error_display: Option<f64>,
    /// Confidence of the error bounds in percent [default: 90].
    #[arg(long, value_name = "PERCENT", value_parser = values::confidence, help_heading = PICTURE)]
    pub confidence: Option<f64>,
}

impl QualityArgs {
    /// Whether one of the stop rules is about the error.
    pub fn has_error_goal(&self) -> bool {
        self.error.is_some() || self.error_max.is_some() || self.error_display.is_some()
    }
}

/// What replaces parts of the scene.
#[derive(Args, Clone, Debug)]
pub struct ViewArgs {
    /// Camera by name, or from numbers: "location=x,y,z look_at=x,y,z angle=degrees" (each part optional; also sky=x,y,z).
    #[arg(long, value_name = "NAME|SPEC", help_heading = VIEW)]
    pub camera: Option<CameraChoice>,
    /// Replace the environment by this radiance, linear.
    #[arg(long, value_name = "R,G,B", value_parser = values::color, conflicts_with = "env_map", help_heading = VIEW)]
    pub env_color: Option<[f64; 3]>,
    /// Replace the environment by an equirectangular image (.hdr, .exr, …).
    #[arg(long, value_name = "FILE", help_heading = VIEW)]
    pub env_map: Option<PathBuf>,
    /// Turn the image of the environment about the vertical by so many degrees: 90 turns what is in its middle to the
    /// right, once more to the back.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = values::finite, help_heading = VIEW)]
    pub env_rotate: Option<f64>,
    /// Multiply the light of the environment by this, the given one's, the scene's or the one that a bare model gets.
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, help_heading = VIEW)]
    pub env_strength: Option<f64>,
    /// Multiply the light of all lamps and emitting surfaces (not of the environment) by this.
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, help_heading = VIEW)]
    pub light_scale: Option<f64>,
}

/// How scenes are read, for all commands that read one.
#[derive(Args, Clone, Debug)]
pub struct LoadArgs {
    /// Directory in which #include and images are looked up, after the scene's own and before those of POVINC. Can be repeated.
    #[arg(short = 'I', long = "include", value_name = "DIR", help_heading = SCENE)]
    pub include: Vec<PathBuf>,
    /// Declare an identifier before the text scene is read: -D radius=2. Can be repeated.
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = values::define, help_heading = SCENE)]
    pub define: Vec<(String, String)>,
    /// When the shutter opens: `clock` in text scenes, seconds of the animations of a bare glTF [default: 0; a glTF
    /// stands as it is written].
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = values::finite, help_heading = SCENE)]
    pub clock: Option<f64>,
    /// How long the shutter is open, in units of the clock: what moves meanwhile is blurred. 0 shows a moment [default: the scene's, or 0].
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = values::factor, help_heading = SCENE)]
    pub shutter: Option<f64>,
    /// Which scene of a bare glTF to show, by name [default: the file's default scene].
    #[arg(long, value_name = "NAME", help_heading = SCENE)]
    pub gltf_scene: Option<String>,
    /// Which material variant of a bare glTF to show, by name.
    #[arg(long, value_name = "NAME", help_heading = SCENE)]
    pub variant: Option<String>,
    /// The only animation of a bare glTF that is played, by name; from its beginning without a clock [default: all, each
    /// as far as it does not contradict an earlier one].
    #[arg(long, value_name = "NAME", help_heading = SCENE)]
    pub animation: Option<String>,
    /// Let a glTF read buffers and images outside its own folder. For models that you trust.
    #[arg(long, help_heading = SCENE)]
    pub allow_outside: bool,
    /// How glass of a glTF is drawn: by the specification, all solid (what Blender shows of glass that it exports without
    /// thickness), or all as thin sheets [default: as-written].
    #[arg(long, value_name = "HOW", help_heading = SCENE)]
    pub glass: Option<GlassChoice>,
    /// Where in an animation it is read; decided by the flags of the animation.
    #[arg(skip)]
    pub moment: Option<Moment>,
}

/// What is taken out of a scene before it is rendered.
#[derive(Args, Clone, Debug)]
pub struct PruneArgs {
    /// Compute also what the picture does not need: dark lamps, coverage that is full everywhere, images that are one
    /// colour, … The picture stays the same but for noise.
    #[arg(long, help_heading = SCENE)]
    pub no_prune: bool,
    /// Compute effects whether or not the scene calls for them, or `all`: the picture stays the same, the time tells what
    /// they cost. Can be repeated.
    #[arg(long, value_name = "EFFECT,…", value_delimiter = ',', value_parser = values::forced(), help_heading = SCENE)]
    pub force_effects: Vec<Forced>,
}

impl PruneArgs {
    /// The effects that are computed whatever the scene says, each once.
    pub fn forced(&self) -> impl Iterator<Item = Effect> + '_ {
        let is_asked = |e: &Effect| {
            self.force_effects
                .iter()
                .any(|f| *f == Forced::All || *f == Forced::One(*e))
        };
        Effect::ALL.into_iter().filter(is_asked)
    }

    /// The words of [`PruneArgs::forced`], separated by commas; `None` for none.
    pub fn forced_list(&self) -> Option<String> {
        let words: Vec<&str> = self.forced().map(Effect::word).collect();
        (!words.is_empty()).then(|| words.join(","))
    }
}

/// What is said on the terminal, for all commands.
#[derive(Args, Clone, Debug)]
pub struct TerminalArgs {
    /// Say less: -q leaves warnings and errors, -qq only errors.
    #[arg(short, long, action = clap::ArgAction::Count, conflicts_with = "verbose", help_heading = TERMINAL)]
    pub quiet: u8,
    /// Say more: the time of each stage and the files that were read.
    #[arg(short, long, action = clap::ArgAction::Count, help_heading = TERMINAL)]
    pub verbose: u8,
    /// When to use colours [default: auto; NO_COLOR is respected].
    #[arg(long, value_name = "WHEN", help_heading = TERMINAL)]
    pub color: Option<ColorKind>,
}

/// The arguments of `check`.
#[derive(Args, Clone, Debug)]
pub struct CheckArgs {
    /// The scenes to read.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    /// How mistakes are told: as text on standard error, or as one JSON document on standard output.
    #[arg(long, value_name = "FORMAT", default_value = "human", help_heading = OUTPUT)]
    pub format: ReportFormat,
    /// How the scenes are read.
    #[command(flatten)]
    pub load: LoadArgs,
    /// What is said meanwhile.
    #[command(flatten)]
    pub terminal: TerminalArgs,
}

/// The arguments of `inspect`.
#[derive(Args, Clone, Debug)]
pub struct InspectArgs {
    /// The scene: .pts, .pov, .gltf, .glb or .obj, or - for text on standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// How it is told on standard output: as text, or as one JSON document.
    #[arg(long, value_name = "FORMAT", default_value = "human", help_heading = OUTPUT)]
    pub format: ReportFormat,
    /// The same as --format json.
    #[arg(long, conflicts_with = "format", help_heading = OUTPUT)]
    pub json: bool,
    /// Width and height of the picture [default: the scene's, else 800x600].
    #[arg(short, long, value_name = "WxH", help_heading = PICTURE)]
    pub resolution: Option<Resolution>,
    /// Render for this long, as in 3s, and tell what share of the time each effect takes and how long --error will take.
    #[arg(long, value_name = "TIME", value_parser = values::duration, help_heading = OUTPUT)]
    pub measure: Option<f64>,
    /// The error whose time --measure forecasts [default: the scene's, else 3%].
    #[arg(long, value_name = "E", value_parser = values::error_goal, requires = "measure", help_heading = OUTPUT)]
    pub error: Option<f64>,
    /// What replaces parts of the scene.
    #[command(flatten)]
    pub view: ViewArgs,
    /// What is taken out of it.
    #[command(flatten)]
    pub prune: PruneArgs,
    /// How the scene is read.
    #[command(flatten)]
    pub load: LoadArgs,
    /// What is said meanwhile.
    #[command(flatten)]
    pub terminal: TerminalArgs,
}

const THRESHOLDS: &str = "Thresholds (exit code 1 beyond one of them)";

/// The arguments of `compare`.
#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    /// The image to judge: .exr .png .jpg .hdr .ppm and the other formats of textures. Integers are read as sRGB.
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,
    /// What it should be, of the same size.
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// How the result is told on standard output: as text, or as one JSON document.
    #[arg(long, value_name = "FORMAT", default_value = "human", help_heading = OUTPUT)]
    pub format: ReportFormat,
    /// Image to write that shows where the differences are: .png, .jpg, .ppm, .exr or .hdr.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub heatmap: Option<PathBuf>,
    /// What the heat map shows.
    #[arg(long, value_name = "KIND", default_value = "flip", requires = "heatmap", help_heading = OUTPUT)]
    pub heatmap_kind: HeatmapKind,
    /// Exposure in stops at which pictures are developed for PSNR and FLIP.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true,
          value_parser = values::finite, help_heading = OUTPUT)]
    pub exposure: f64,
    /// Columns and rows of the blocks in which differences are tested against noise: 4 or 8.
    #[arg(long, value_name = "N", default_value = "8", value_parser = block_side, help_heading = OUTPUT)]
    pub block_size: u32,
    /// Largest relative error E, for example 2% or 0.02.
    #[arg(long, value_name = "SHARE", value_parser = values::share, help_heading = THRESHOLDS)]
    pub max_e: Option<f64>,
    /// Largest mean FLIP, from 0 to 1.
    #[arg(long, value_name = "NUMBER", value_parser = values::factor, help_heading = THRESHOLDS)]
    pub max_flip: Option<f64>,
    /// Largest mean HDR-FLIP, from 0 to 1.
    #[arg(long, value_name = "NUMBER", value_parser = values::factor, help_heading = THRESHOLDS)]
    pub max_hdr_flip: Option<f64>,
    /// Largest root mean square error, in the unit of the images.
    #[arg(long, value_name = "NUMBER", value_parser = values::factor, help_heading = THRESHOLDS)]
    pub max_rmse: Option<f64>,
    /// Largest share of blocks that differ beyond noise, for example 0.1%; an image needs its standard errors.
    #[arg(long, value_name = "SHARE", value_parser = values::share, help_heading = THRESHOLDS)]
    pub max_blocks: Option<f64>,
    /// What is said meanwhile.
    #[command(flatten)]
    pub terminal: TerminalArgs,
}

fn block_side(text: &str) -> Result<u32, String> {
    match text {
        "4" => Ok(4),
        "8" => Ok(8),
        _ => Err("expected 4 or 8".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(words: &[&str]) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(std::iter::once(&"pts").chain(words))
    }

    #[test]
    fn the_declared_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_scene_alone_is_rendered() {
        let short = parse(&["a.pts", "-s", "4", "-o", "x.png"]).unwrap();
        assert!(short.command.is_none());
        let short = short.render;
        let Some(Command::Render(long)) = parse(&["render", "-s", "4", "-o", "x.png", "a.pts"]).unwrap().command else {
            panic!("`render` is not the command");
        };
        assert_eq!(short.scene(), long.scene());
        assert_eq!(short.scene(), Path::new("a.pts"));
        assert_eq!(short.quality.spp, Some(4));
        assert_eq!(long.quality.spp, Some(4));
        assert_eq!(short.output.output, long.output.output);
    }

    #[test]
    fn a_command_can_be_followed_by_its_own_arguments_alone() {
        let cli = parse(&["check", "a.pts", "b.gltf"]).unwrap();
        assert!(matches!(cli.command, Some(Command::Check(c)) if c.scenes.len() == 2));
    }

    #[test]
    fn contradictory_flags_are_refused() {
        for words in [
            &["a.pts", "-r", "8x8", "--width", "8"][..],
            &["a.pts", "--env-color", "1", "--env-map", "a.hdr"],
            &["a.pts", "-q", "-v"],
            &["a.pts", "--nets", "3"],
            &["a.pts", "--spp", "0"],
            &["a.pts", "b.pts"],
            &["-s", "4"],
            &["render", "-s", "4"],
        ] {
            assert!(parse(words).is_err(), "{words:?} was accepted");
        }
    }

    #[test]
    fn negative_numbers_are_values() {
        let cli = parse(&["a.pts", "--exposure", "-1.5", "--clock", "-2"]).unwrap().render;
        assert_eq!(cli.output.exposure, Some(-1.5));
        assert_eq!(cli.load.clock, Some(-2.0));
    }
}
