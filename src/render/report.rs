//! What is told during and after a render.

pub use super::estimate::{Bounded, ErrorEstimate};
pub use super::forecast::Forecast;
pub use crate::diag::{Anomalies, Anomaly};

/// A look at a running render, given to the observer after every tile.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Samples per pixel that are complete all over the image.
    pub spp: u32,
    /// Samples traced so far, all pixels.
    pub samples: u64,
    /// Samples the render takes if no other rule stops it.
    pub samples_at_most: u64,
    /// Share of the work done, in [0, 1], by the rule that is nearest to stopping it. It never falls.
    pub fraction: f64,
    /// Seconds since the clock was started.
    pub elapsed: f64,
    /// Seconds that are likely left, ≥ 0; `None` as long as nothing is known: before the first samples, and with error
    /// goals and no time limit before the first forecast.
    pub remaining: Option<f64>,
    /// The error at the last look, once there was one.
    pub error: Option<ErrorEstimate>,
    /// What more time would bring, once there were two looks.
    pub forecast: Option<Forecast>,
}

/// Somebody who watches a render. Called from the rendering threads: keep it short.
pub trait Observer: Sync {
    /// News.
    fn progress(&self, progress: &Progress);

    /// Whether to stop now; the samples that are complete are kept.
    fn should_stop(&self) -> bool {
        false
    }
}

/// An observer that watches nothing.
pub struct Silent;

impl Observer for Silent {
    fn progress(&self, _: &Progress) {}
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// All samples were taken.
    Samples,
    /// The time was up.
    Time,
    /// The error goal was reached.
    Error,
    /// The goal for the worst pixels was reached.
    ErrorMax,
    /// The goal for the developed picture was reached.
    ErrorDisplay,
    /// The observer asked for it.
    Interrupted,
}

/// What a render did.
#[derive(Clone, Debug)]
pub struct Report {
    /// Why it ended.
    pub stop: StopReason,
    /// Samples of every pixel.
    pub spp: u32,
    /// Samples of all pixels.
    pub samples: u64,
    /// Rays traced, camera, bounce and shadow rays together.
    pub rays: u64,
    /// Seconds of rendering.
    pub seconds: f64,
    /// The error at the end, where it can be estimated.
    pub error: Option<ErrorEstimate>,
    /// What more time would have brought.
    pub forecast: Option<Forecast>,
    /// What went wrong with samples; what was mended in the scene is counted with its diagnostics.
    pub anomalies: Anomalies,
    /// Samples that were scaled down by [`super::technique::Technique::clamp`].
    pub clamped: u64,
}

/// A finished picture: linear RGB means and what else was asked for, row by row from the top left.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Mean radiance of each pixel.
    pub rgb: Vec<[f32; 3]>,
    /// Standard error of the mean; NaN where it cannot be known (one net, fewer than 16 samples).
    pub stderr: Vec<[f32; 3]>,
    /// Samples of each pixel.
    pub samples: Vec<u32>,
    /// Mean distance along the view axis of first hits; infinite where nothing was hit.
    pub depth: Option<Vec<f32>>,
    /// Unit mean normal facing the camera; zero where nothing was hit.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Mean albedo.
    pub albedo: Option<Vec<[f32; 3]>>,
    /// Nanoseconds of wall clock that a sample took on its thread, over the samples of this run; NaN where there are
    /// none. What else the machine did meanwhile is in it, so that no two runs give the same.
    pub time: Option<Vec<f32>>,
    /// max |s|/Σ|s| over the nets, s the sum R + G + B of a net's mean: 1/nets where all nets agree, 1 where all the
    /// light was found by one of them; 0 for a black pixel, NaN where fewer than two nets have samples.
    pub tail: Option<Vec<f32>>,
    /// Mean of the samples of nets 0, 2, 4, …; NaN where those have none but others do. Independent of `half_b`.
    pub half_a: Option<Vec<[f32; 3]>>,
    /// As `half_a`, of nets 1, 3, 5, …
    pub half_b: Option<Vec<[f32; 3]>>,
}
