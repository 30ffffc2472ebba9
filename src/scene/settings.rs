//! What a scene asks of the renderer; the command line overrides each of these.

/// The pixel filter. All are applied by importance sampling: one pixel a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FilterKind {
    /// Uniform over the pixel.
    Box,
    /// Gaussian, σ = 0.5 px, cut at 1.5 px.
    Gaussian,
    /// Blackman–Harris of radius 1.5 px.
    #[default]
    BlackmanHarris,
}

/// The contents of `render { … }`; what is `None` was not written.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct RenderDefaults {
    /// Width and height in pixels.
    pub resolution: Option<[u32; 2]>,
    /// Samples per pixel.
    pub spp: Option<u32>,
    /// Error goal as a fraction (2 % is 0.02).
    pub error: Option<f64>,
    /// Confidence of the error goal as a fraction.
    pub confidence: Option<f64>,
    /// Time limit in seconds.
    pub time: Option<f64>,
    /// Most bounces of a path.
    pub max_depth: Option<u32>,
    /// Seed of the sampler.
    pub seed: Option<u64>,
    /// Pixel filter.
    pub filter: Option<FilterKind>,
    /// How long the shutter is open, in units of the clock, ≥ 0; 0 (or nothing) shows a moment.
    pub shutter: Option<f64>,
}
