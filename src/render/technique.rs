//! How a picture is computed: every choice that trades accuracy for time, in one place.
//!
//! The defaults are the honest ones: nothing in them is biased. `study` varies these fields one by one; it takes the
//! struct apart exhaustively, so that a new field cannot be forgotten there.

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SamplerKind {
    /// Owen-scrambled Sobol' nets.
    #[default]
    Sobol,
    /// Independent numbers.
    Independent,
}

/// How direct light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Direct {
    /// Light sampling and hits, combined by multiple importance sampling.
    #[default]
    Mis,
    /// Light sampling only (hits count where no light sample can reach).
    Light,
    /// Hits only; lamps without a shape are still sampled.
    Bsdf,
}

/// How one of several lights is picked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LightPick {
    /// By a tree with bounds on distance and direction.
    #[default]
    Tree,
    /// In proportion to power, the same everywhere.
    Power,
    /// All alike.
    Uniform,
}

/// How paths end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Roulette {
    /// By their throughput, from the second bounce on.
    #[default]
    Throughput,
    /// Only in the long run, where light has become too weak to matter, so that lossless rooms end.
    Late,
}

/// How the tree of boxes is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum BuildPreset {
    /// Quick to build, slower to trace.
    Fast,
    /// In between.
    #[default]
    Medium,
    /// Slow to build, quickest to trace.
    High,
}

/// Which share of light a dielectric reflects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FresnelModel {
    /// Fresnel's equations.
    #[default]
    Exact,
    /// Schlick's approximation with the cosine on the optically thinner side.
    Schlick,
    /// Schlick's approximation with the cosine of the incident side always, the slip of many lectures.
    SchlickIncident,
}

/// How images are looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TextureFilter {
    /// As the scene says, at least bilinear by default.
    #[default]
    AsWritten,
    /// The nearest texel always.
    Nearest,
}

/// Everything that trades accuracy for time, besides the number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Technique {
    /// Where random numbers come from.
    pub sampler: SamplerKind,
    /// How direct light is found.
    pub direct: Direct,
    /// How one of several lights is picked.
    pub lights: LightPick,
    /// How paths end.
    pub roulette: Roulette,
    /// Whether noisy parts of the picture get more samples than others.
    pub adaptive: bool,
    /// How the tree of boxes is built.
    pub build: BuildPreset,
    /// Most bounces after the first hit; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// Which share of light a dielectric reflects.
    pub fresnel: FresnelModel,
    /// Whether rough surfaces give back the light that bounces between their facets.
    pub multiple_scattering: bool,
    /// How images are looked up.
    pub textures: TextureFilter,
    /// The largest contribution of a sample, per channel; `None` for no limit.
    pub clamp: Option<f32>,
    /// Whether light that reaches a rough surface by way of mirrors or glass counts.
    pub caustics: bool,
}

impl Default for Technique {
    fn default() -> Technique {
        Technique {
            sampler: SamplerKind::default(),
            direct: Direct::default(),
            lights: LightPick::default(),
            roulette: Roulette::default(),
            adaptive: false,
            build: BuildPreset::default(),
            max_depth: u32::MAX,
            fresnel: FresnelModel::default(),
            multiple_scattering: true,
            textures: TextureFilter::default(),
            clamp: None,
            caustics: true,
        }
    }
}
