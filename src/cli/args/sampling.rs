//! Flags that say how light is sampled: what trades accuracy for time, besides the number of samples.

use crate::cli::choices::FilterKind;
use crate::cli::values;
use crate::compile::effects::Effect;
use crate::render::technique::{
    BuildPreset, Direct, FresnelModel, LightPick, Roulette, SamplerKind, Technique, TextureFilter,
};
use clap::Args;

const SAMPLING: &str = "Sampling";
const BIASED: &str = "Faster but biased (what is used is told after the render and in the image)";

/// How light is sampled.
#[derive(Args, Clone, Debug)]
pub struct SamplingArgs {
    /// Seed of all random choices: the same seed gives the same picture, bit by bit [default: the scene's, else 0].
    #[arg(long, value_name = "N", help_heading = SAMPLING)]
    pub seed: Option<u64>,
    /// Most bounces of a path: 0 shows only what shines itself, 1 adds direct light [default: the scene's, else unlimited].
    #[arg(long, value_name = "N", help_heading = SAMPLING)]
    pub max_depth: Option<u32>,
    /// Pixel filter [default: the scene's, else blackman-harris].
    #[arg(long, value_name = "FILTER", help_heading = SAMPLING)]
    pub filter: Option<FilterKind>,
    /// Where random numbers come from [default: sobol].
    #[arg(long, value_name = "KIND", value_parser = values::choice::<SamplerKind>(), help_heading = SAMPLING)]
    pub sampler: Option<SamplerKind>,
    /// How direct light is found: by light sampling and by hits (mis, the default), or by one of them alone.
    #[arg(long, value_name = "HOW", value_parser = values::choice::<Direct>(), help_heading = SAMPLING)]
    pub direct: Option<Direct>,
    /// How one of several lights is picked [default: tree].
    #[arg(long, value_name = "HOW", value_parser = values::choice::<LightPick>(), help_heading = SAMPLING)]
    pub lights: Option<LightPick>,
    /// How paths end by chance [default: throughput].
    #[arg(long, value_name = "HOW", value_parser = values::choice::<Roulette>(), help_heading = SAMPLING)]
    pub roulette: Option<Roulette>,
    /// Give noisy parts of the picture more samples than others.
    #[arg(long, help_heading = SAMPLING)]
    pub adaptive: bool,
    /// How thoroughly the tree that finds what rays hit is built [default: medium].
    #[arg(long, value_name = "PRESET", value_parser = values::choice::<BuildPreset>(), help_heading = SAMPLING)]
    pub build: Option<BuildPreset>,
    /// Independently scrambled sample nets; the error is estimated from their spread, so that 1 knows none [default: 4].
    #[arg(long, value_name = "N", value_parser = nets, help_heading = SAMPLING)]
    pub nets: Option<u32>,
    /// Threads [default: one for each core].
    #[arg(short = 'j', long, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=4096), help_heading = SAMPLING)]
    pub threads: Option<u32>,
    /// Which share of light glass and coats reflect [default: exact].
    #[arg(long, value_name = "MODEL", value_parser = values::choice::<FresnelModel>(), help_heading = BIASED)]
    pub fresnel: Option<FresnelModel>,
    /// Lose the light that bounces between the facets of rough surfaces.
    #[arg(long, help_heading = BIASED)]
    pub no_multiple_scattering: bool,
    /// How images on surfaces are looked up [default: as-written].
    #[arg(long, value_name = "HOW", value_parser = values::choice::<TextureFilter>(), help_heading = BIASED)]
    pub texture_filter: Option<TextureFilter>,
    /// Scale samples down whose brightest channel is above this: fewer fireflies, and less light.
    #[arg(long, value_name = "VALUE", value_parser = values::limit, help_heading = BIASED)]
    pub clamp: Option<f32>,
    /// Leave out light that reaches rough surfaces by way of mirrors or glass.
    #[arg(long, help_heading = BIASED)]
    pub no_caustics: bool,
    /// Leave effects out, whatever the scene calls for: the picture is then not the scene as written. Can be repeated.
    #[arg(long, value_name = "EFFECT,…", value_delimiter = ',', value_parser = values::effect(), help_heading = BIASED)]
    pub without: Vec<Effect>,
}

impl SamplingArgs {
    /// The effects that are left out, separated by commas; `None` for none.
    pub fn without_list(&self) -> Option<String> {
        let words: Vec<&str> = self.without.iter().map(|e| e.word()).collect();
        (!words.is_empty()).then(|| words.join(","))
    }

    /// The flags that bias the picture.
    pub fn biased(&self) -> Vec<String> {
        let mut flags = self.technique().biased();
        flags.extend(self.without_list().map(|list| format!("--without {list}")));
        flags
    }

    /// What trades accuracy for time. A limit of bounces that stands only in the scene belongs to the picture that is
    /// asked for, and is not among these.
    pub fn technique(&self) -> Technique {
        let base = Technique::default();
        Technique {
            sampler: self.sampler.unwrap_or(base.sampler),
            direct: self.direct.unwrap_or(base.direct),
            lights: self.lights.unwrap_or(base.lights),
            roulette: self.roulette.unwrap_or(base.roulette),
            adaptive: self.adaptive,
            build: self.build.unwrap_or(base.build),
            max_depth: self.max_depth.unwrap_or(base.max_depth),
            fresnel: self.fresnel.unwrap_or(base.fresnel),
            multiple_scattering: !self.no_multiple_scattering,
            textures: self.texture_filter.unwrap_or(base.textures),
            clamp: self.clamp,
            caustics: !self.no_caustics,
        }
    }
}

/// A number of nets.
pub(super) fn nets(text: &str) -> Result<u32, String> {
    match text {
        "1" => Ok(1),
        "4" => Ok(4),
        "8" => Ok(8),
        "16" => Ok(16),
        _ => Err("expected 1, 4, 8 or 16".to_owned()),
    }
}
