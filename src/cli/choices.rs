//! The words that flags choose from; their explanations are part of the long help.

use crate::import::gltf::Glass;
use clap::ValueEnum;

/// How `check` tells mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    /// Text for people.
    Human,
    /// One JSON document.
    Json,
}

/// How glass of a glTF is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GlassChoice {
    /// Solid where it has a volume with a thickness, else a thin sheet without refraction.
    AsWritten,
    /// Solid: it refracts.
    Solid,
    /// Thin sheets, which let light straight through.
    Thin,
}

impl GlassChoice {
    /// The word of the flag.
    pub fn word(self) -> &'static str {
        match self {
            GlassChoice::AsWritten => "as-written",
            GlassChoice::Solid => "solid",
            GlassChoice::Thin => "thin",
        }
    }

    /// The same for the front end.
    pub fn glass(self) -> Glass {
        match self {
            GlassChoice::AsWritten => Glass::AsWritten,
            GlassChoice::Solid => Glass::Solid,
            GlassChoice::Thin => Glass::Thin,
        }
    }
}

/// What a heat map of two images shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HeatmapKind {
    /// FLIP of the developed pictures, 0 to 1.
    Flip,
    /// FLIP over all exposures, 0 to 1.
    HdrFlip,
    /// Relative error of each pixel, logarithmic from 0.001 to 1.
    Error,
    /// Difference over noise in blocks: red brighter, blue darker than the reference, full where it is significant.
    Z,
}

/// Formats that can go to standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutputFormat {
    /// 8-bit sRGB, lossless.
    Png,
    /// Linear, 32-bit float, with layers.
    Exr,
    /// Linear, shared exponent.
    Hdr,
    /// 8-bit sRGB, lossy.
    Jpg,
    /// 8-bit sRGB, uncompressed.
    Ppm,
}

impl OutputFormat {
    /// The extension that means this format.
    pub fn extension(self) -> &'static str {
        match self {
            OutputFormat::Png => "png",
            OutputFormat::Exr => "exr",
            OutputFormat::Hdr => "hdr",
            OutputFormat::Jpg => "jpg",
            OutputFormat::Ppm => "ppm",
        }
    }
}

/// Layers beside the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Aov {
    /// Distance along the view axis.
    Depth,
    /// Shading normal in world space.
    Normal,
    /// Share of light the surface reflects.
    Albedo,
    /// Standard error of each pixel.
    Stderr,
    /// Samples of each pixel.
    Samples,
    /// Relative standard error of each pixel.
    Relerr,
    /// Nanoseconds of wall clock per sample.
    Time,
    /// Share of the pixel's light that its brightest net found.
    Tail,
    /// Mean of the even nets, independent of halfB.
    #[value(name = "halfA")]
    HalfA,
    /// Mean of the odd nets.
    #[value(name = "halfB")]
    HalfB,
}

/// What 8-bit images show instead of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ViewName {
    /// Relative standard error, logarithmic from 0.1 % (dark) to 100 % (bright).
    Error,
    /// Time of a sample, logarithmic.
    Time,
    /// Shading normal as colour: n/2 + 1/2.
    Normal,
    /// Share of light the surface reflects.
    Albedo,
    /// Distance along the view axis, near is bright.
    Depth,
}

/// Tone curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ToneMapKind {
    /// Values as they are, cut at white.
    None,
    /// Khronos PBR Neutral: exact up to 0.8, highlights compressed.
    Neutral,
    /// AgX: photographic.
    Agx,
    /// ACES, fitted.
    Aces,
    /// Reinhard on luminance.
    Reinhard,
}

/// Pixel filters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FilterKind {
    /// Uniform over the pixel.
    Box,
    /// Gaussian, σ = 0.5 pixels.
    Gaussian,
    /// Blackman–Harris, radius 1.5 pixels.
    BlackmanHarris,
}

/// When colours are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ColorKind {
    /// On terminals, unless NO_COLOR is set.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressKind {
    /// A bar on terminals, plain lines elsewhere.
    Auto,
    /// A bar.
    Bar,
    /// A line each 10 % or 30 seconds.
    Plain,
    /// One JSON object a line; all other messages too.
    Json,
    /// Nothing.
    None,
}
