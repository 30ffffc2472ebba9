//! What a study measured: variants of a technique, one row for each picture, and what each effect costs.
//!
//! Pure data. The runner fills it; charts, tables and recommendations only read it.

use std::ops::Range;

/// What changing a technique along an axis does to the expected picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Nothing: only noise and time change.
    Variance,
    /// The expected picture changes too: more time does not bring the error to zero.
    Bias,
}

/// One way to render the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// What is varied: `samples` for the base line, else the name of the axis, as in `roulette`.
    pub axis: String,
    /// The value, as in `late`; `as written` for the base line.
    pub name: String,
    /// What it does to the expected picture.
    pub kind: Kind,
    /// The command line's words that choose it; empty for the base line.
    pub flags: String,
}

/// Seconds of one run, by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phases {
    /// Reading the scene (measured once for all runs).
    pub load: f64,
    /// From the description to the engine, the tree of boxes included.
    pub compile: f64,
    /// Rendering.
    pub render: f64,
}

impl Phases {
    /// Seconds of all phases.
    pub fn total(&self) -> f64 {
        self.load + self.compile + self.render
    }
}

/// One picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Index into [`Study::variants`].
    pub variant: usize,
    /// Its seed; never one of the reference's.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
    /// Seconds by phase.
    pub seconds: Phases,
    /// Samples of each pixel (the mean, for adaptive sampling).
    pub spp: u32,
    /// Samples of all pixels.
    pub samples: u64,
    /// Rays.
    pub rays: u64,
    /// E² against the reference with the reference's own noise subtracted; negative where noise had the last word.
    pub e2: f64,
    /// Standard error of `e2`, by jackknife over blocks of pixels, the reference's noise included.
    pub e2_se: f64,
    /// The error estimate that the run itself gave: E and its bound.
    pub estimate: Option<[f64; 2]>,
    /// Mean FLIP.
    pub flip: f64,
    /// Mean luminance over the reference's.
    pub energy: f64,
}

impl Row {
    /// E; 0 where `e2` is negative.
    pub fn error(&self) -> f64 {
        self.e2.max(0.0).sqrt()
    }

    /// E at ± 1.64 standard errors: an interval of 90 % confidence.
    pub fn interval(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| (self.e2 + sign * 1.645 * self.e2_se).max(0.0).sqrt())
    }
}

/// What leaving one effect out does.
#[derive(Clone, Debug, PartialEq)]
pub struct Ablation {
    /// The effect, as in `caustics`.
    pub effect: String,
    /// Share of the render's time that it takes: 1 − time without / time with, at equal samples.
    pub time: f64,
    /// Standard error of `time` over the seeds.
    pub time_se: f64,
    /// Mean luminance that goes with it, over the mean luminance of the whole: (with − without) / with. Negative where
    /// the picture is brighter without it.
    pub energy: f64,
    /// Standard error of `energy` over the seeds.
    pub energy_se: f64,
    /// Mean FLIP between the pictures with and without it.
    pub flip: f64,
    /// Share of blocks of pixels that differ beyond noise.
    pub blocks: f64,
    /// Whether the difference as a whole is above the noise.
    pub significant: bool,
}

/// What everything is measured against.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Where it came from: a file, or how it was rendered.
    pub source: String,
    /// Samples per pixel, where known.
    pub spp: Option<u64>,
    /// Its own error E, from its standard errors; `None` if unknown (then nothing is subtracted).
    pub error: Option<f64>,
    /// Seconds it took to render here.
    pub seconds: Option<f64>,
}

/// A finished study.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The scene's file name.
    pub scene: String,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Columns and rows of the picture that the user wants in the end, which the study may have made smaller.
    pub full_size: [u32; 2],
    /// The command line that makes it again.
    pub command: String,
    /// The command line's words that say how the scene is read and seen (camera, light, definitions, filter, seed);
    /// empty if there are none.
    pub scene_flags: String,
    /// Version and commit of the program.
    pub version: String,
    /// The processor's name.
    pub processor: String,
    /// Threads of rows on no threads axis.
    pub threads: usize,
    /// Seconds the whole study took.
    pub seconds: f64,
    /// What everything is measured against.
    pub reference: Reference,
    /// The error or the seconds that were asked for.
    pub goal: Goal,
    /// The ways to render it; the first is the base line.
    pub variants: Vec<Variant>,
    /// The pictures.
    pub rows: Vec<Row>,
    /// What each effect costs.
    pub ablations: Vec<Ablation>,
    /// What was left out, and why.
    pub notes: Vec<String>,
}

impl Study {
    /// Pixels of the picture that the user wants in the end, over those of the study's: at equal samples per pixel,
    /// the factor in time.
    pub fn enlargement(&self) -> f64 {
        let pixels = |[w, h]: [u32; 2]| f64::from(w) * f64::from(h);
        pixels(self.full_size) / pixels(self.size)
    }
}

/// What the user wants to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// An error E.
    Error(f64),
    /// Seconds.
    Seconds(f64),
}

/// The rows of one variant with the same number of samples and threads, as a point of the chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Index into [`Study::variants`].
    pub variant: usize,
    /// Samples per pixel.
    pub spp: u32,
    /// Threads.
    pub threads: usize,
    /// Rows behind it.
    pub rows: usize,
    /// Median seconds.
    pub seconds: f64,
    /// Root of the mean of E².
    pub error: f64,
    /// Least and largest E of the seeds.
    pub spread: Range<f64>,
}
