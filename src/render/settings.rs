//! What a render is asked to do.

use super::technique::Technique;
use std::fmt;
use std::sync::Arc;

/// The pixel filter; all are sampled, so that each sample belongs to one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Filter {
    /// Uniform over the pixel.
    Box,
    /// Gaussian, σ = 0.5 px, cut at 1.5 px.
    Gaussian,
    /// Blackman–Harris of radius 1.5 px.
    #[default]
    BlackmanHarris,
}

/// When to stop; the first reached wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRules {
    /// Samples per pixel at most, > 0.
    pub spp: u32,
    /// Seconds of wall clock from `Settings::started`.
    pub seconds: Option<f64>,
    /// Image error E to reach, as a fraction.
    pub error: Option<f64>,
    /// Relative error that 99 % of the pixels shall stay below, pooled over their neighbours.
    pub error_max: Option<f64>,
    /// Root mean square error of the developed picture to reach, in 8-bit steps; needs [`Settings::display`].
    pub error_display: Option<f64>,
    /// Confidence of the error bounds, in (0, 1).
    pub confidence: f64,
}

impl StopRules {
    /// This many samples, and nothing else.
    pub fn samples(spp: u32) -> StopRules {
        StopRules {
            spp,
            seconds: None,
            error: None,
            error_max: None,
            error_display: None,
            confidence: 0.9,
        }
    }

    /// Whether one of the rules is about the error.
    pub fn has_error_goal(&self) -> bool {
        self.error.is_some() || self.error_max.is_some() || self.error_display.is_some()
    }
}

/// How radiance becomes display values in [0, 1], for errors in 8-bit steps.
#[derive(Clone)]
pub struct DisplayCurve(Arc<dyn Fn([f32; 3]) -> [f32; 3] + Send + Sync>);

impl DisplayCurve {
    /// From a function of linear RGB.
    pub fn new(curve: impl Fn([f32; 3]) -> [f32; 3] + Send + Sync + 'static) -> DisplayCurve {
        DisplayCurve(Arc::new(curve))
    }

    /// Display values of a colour.
    pub fn develop(&self, rgb: [f32; 3]) -> [f32; 3] {
        (self.0)(rgb)
    }
}

impl fmt::Debug for DisplayCurve {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("DisplayCurve")
    }
}

/// Which extra layers are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Aovs {
    /// Distance along the view axis of the first hit.
    pub depth: bool,
    /// Mean shading normal of the first hit, world axes.
    pub normal: bool,
    /// Mean albedo of the first hit.
    pub albedo: bool,
    /// Nanoseconds a sample took.
    pub time: bool,
    /// Share of the light that the brightest net has.
    pub tail: bool,
    /// Mean of the even nets.
    pub half_a: bool,
    /// Mean of the odd nets.
    pub half_b: bool,
}

impl Aovs {
    /// Whether one of the layers compares nets with each other, so that a single net cannot give it.
    pub fn need_nets(&self) -> bool {
        self.tail || self.half_a || self.half_b
    }
}

/// A rectangle of pixels, counted from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// First column to the right of it, > x0.
    pub x1: u32,
    /// First row below it, > y0.
    pub y1: u32,
}

impl Region {
    /// A whole picture.
    pub fn whole(width: u32, height: u32) -> Region {
        let (x0, y0, x1, y1) = (0, 0, width, height);
        Region { x0, y0, x1, y1 }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// Pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Squares of this side that cover it, smaller at the right and at the bottom; row by row.
    pub fn blocks(self, side: u32) -> impl Iterator<Item = Region> {
        let rows = (self.y0..self.y1).step_by(side as usize);
        let places = rows.flat_map(move |y| (self.x0..self.x1).step_by(side as usize).map(move |x| (x, y)));
        places.map(move |(x0, y0)| {
            let (x1, y1) = (self.x1.min(x0 + side), self.y1.min(y0 + side));
            Region { x0, y0, x1, y1 }
        })
    }
}

/// Everything that decides the bits of a picture, besides the scene.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Columns, > 0.
    pub width: u32,
    /// Rows, > 0.
    pub height: u32,
    /// The pixels to render; the others stay black.
    pub region: Region,
    /// The first sample; the samples are `first..first + stop.spp`.
    pub first: u32,
    /// When to stop.
    pub stop: StopRules,
    /// How the picture will be shown; only for the error in 8-bit steps.
    pub display: Option<DisplayCurve>,
    /// Seed of all samples.
    pub seed: u64,
    /// Independently scrambled nets: 1, 4, 8 or 16.
    pub nets: u32,
    /// Pixel filter.
    pub filter: Filter,
    /// What trades accuracy for time.
    pub technique: Technique,
    /// Extra layers.
    pub aovs: Aovs,
    /// When the clock of the time limit started.
    pub started: std::time::Instant,
}

impl Settings {
    /// Settings for a picture of this size and sample count; everything else as by default.
    pub fn new(width: u32, height: u32, spp: u32) -> Settings {
        Settings {
            width,
            height,
            region: Region::whole(width, height),
            first: 0,
            stop: StopRules::samples(spp),
            display: None,
            seed: 0,
            nets: 4,
            filter: Filter::default(),
            technique: Technique::default(),
            aovs: Aovs::default(),
            started: std::time::Instant::now(),
        }
    }
}
