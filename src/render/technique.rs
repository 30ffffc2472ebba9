//! How a picture is computed: every choice that trades accuracy for time, in one place.
//!
//! The defaults are the honest ones: nothing in them is biased. `study` varies these fields one by one; it takes the
//! struct apart exhaustively, so that a new field cannot be forgotten there.

/// A technique that is chosen by a word on the command line and in files.
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// Every value, with its word and what it means in half a line.
    const ALL: &'static [(Self, &'static str, &'static str)];

    /// The value's word.
    fn word(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(v, ..)| *v == self)
            .map_or("", |(_, word, _)| word)
    }

    /// The value of a word.
    fn from_word(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, w, _)| *w == word).map(|(value, ..)| *value)
    }
}

/// Gives an enum its words; each variant must be there, which the inner match sees to.
macro_rules! choice {
    ($name:ident { $($variant:ident $word:literal $about:literal),* $(,)? }) => {
        impl Choice for $name {
            const ALL: &'static [($name, &'static str, &'static str)] = {
                #[allow(dead_code)] // only its exhaustiveness matters
                fn all(value: $name) {
                    match value { $($name::$variant => {})* }
                }
                &[$(($name::$variant, $word, $about)),*]
            };
        }
    };
}

choice!(SamplerKind {
    Sobol "sobol" "Owen-scrambled Sobol' nets",
    Independent "independent" "Independent numbers",
});
choice!(Direct {
    Mis "mis" "Light sampling and hits, weighted against each other",
    Light "light" "Light sampling alone",
    Bsdf "bsdf" "Hits alone",
});
choice!(LightPick {
    Tree "tree" "By what each can do at the surface",
    Power "power" "By power, the same everywhere",
    Uniform "uniform" "All alike",
});
choice!(Roulette {
    Throughput "throughput" "From the second bounce on, by what the path still carries",
    Late "late" "Only after 32 bounces",
});
choice!(BuildPreset {
    Fast "fast" "Quick to build, slower to trace",
    Medium "medium" "In between",
    High "high" "Slow to build, quickest to trace",
});
choice!(FresnelModel {
    Exact "exact" "Fresnel's equations",
    Schlick "schlick" "Schlick's approximation, with the cosine on the thinner side",
    SchlickIncident "schlick-incident" "Schlick's approximation, always with the incident cosine: wrong on the way out",
});
choice!(TextureFilter {
    AsWritten "as-written" "As the scene says, bilinear by default",
    Nearest "nearest" "The nearest texel",
});

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
    /// Most bounces of a path: 0 shows only what shines itself, 1 adds direct light; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// Which share of light a dielectric reflects.
    pub fresnel: FresnelModel,
    /// Whether rough surfaces give back the light that bounces between their facets.
    pub multiple_scattering: bool,
    /// How images are looked up.
    pub textures: TextureFilter,
    /// The largest radiance of a sample in any channel, > 0: brighter samples are scaled down as a whole, so that they
    /// keep their hue. `None` for no limit.
    pub clamp: Option<f32>,
    /// Whether light counts that reaches a rough surface by way of mirrors or glass.
    ///
    /// Seen from the camera, that is a path with a rough scattering somewhere before the chain of mirror-like ones that
    /// ends on a light: camera … rough → mirror-like → … → mirror-like → light. What a lamp, an emitting surface or the
    /// environment adds at the end of such a path is left out. Mirror-like is a scattering by a delta lobe, or into a
    /// direction of density above [`crate::render::kernel::MIRROR_LIKE`]; all others are rough. Passing straight through
    /// a surface is no scattering, and lights seen in mirrors and through glass by the camera itself stay.
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

impl Technique {
    /// The command-line words of everything that differs from the default; no words for the default.
    pub fn flags(&self) -> Vec<String> {
        self.told().into_iter().flat_map(|(words, _)| words).collect()
    }

    /// The flags of what differs from the default and changes the expected picture; one entry a flag, with its value.
    pub fn biased(&self) -> Vec<String> {
        let biased = self.told().into_iter().filter(|(_, bias)| *bias);
        biased.map(|(words, _)| words.join(" ")).collect()
    }

    /// The words of each field that differs from the default, and whether it changes the expected picture.
    fn told(&self) -> Vec<(Vec<String>, bool)> {
        fn choice<T: Choice>(flag: &str, value: T, default: T) -> Option<Vec<String>> {
            (value != default).then(|| vec![flag.to_owned(), value.word().to_owned()])
        }
        let switch = |flag: &str, is_set: bool| is_set.then(|| vec![flag.to_owned()]);
        let number = |flag: &str, value: Option<String>| value.map(|v| vec![flag.to_owned(), v]);
        let Technique {
            sampler,
            direct,
            lights,
            roulette,
            adaptive,
            build,
            max_depth,
            fresnel,
            multiple_scattering,
            textures,
            clamp,
            caustics,
        } = *self;
        let d = Technique::default();
        let fields = [
            (choice("--sampler", sampler, d.sampler), false),
            (choice("--direct", direct, d.direct), false),
            (choice("--lights", lights, d.lights), false),
            (choice("--roulette", roulette, d.roulette), false),
            (switch("--adaptive", adaptive), false),
            (choice("--build", build, d.build), false),
            (
                number("--max-depth", (max_depth != d.max_depth).then(|| max_depth.to_string())),
                true,
            ),
            (choice("--fresnel", fresnel, d.fresnel), true),
            (switch("--no-multiple-scattering", !multiple_scattering), true),
            (choice("--texture-filter", textures, d.textures), true),
            (number("--clamp", clamp.map(|c| c.to_string())), true),
            (switch("--no-caustics", !caustics), true),
        ];
        let told = fields.into_iter();
        told.filter_map(|(words, bias)| Some((words?, bias))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_has_no_words_and_no_bias() {
        assert!(Technique::default().flags().is_empty());
        assert!(Technique::default().biased().is_empty());
    }

    #[test]
    fn everything_that_differs_has_its_words_and_biases_are_known() {
        let all = Technique {
            sampler: SamplerKind::Independent,
            direct: Direct::Bsdf,
            lights: LightPick::Power,
            roulette: Roulette::Late,
            adaptive: true,
            build: BuildPreset::High,
            max_depth: 3,
            fresnel: FresnelModel::SchlickIncident,
            multiple_scattering: false,
            textures: TextureFilter::Nearest,
            clamp: Some(0.1),
            caustics: false,
        };
        let unbiased = "--sampler independent --direct bsdf --lights power --roulette late --adaptive --build high";
        let biased = [
            "--max-depth 3",
            "--fresnel schlick-incident",
            "--no-multiple-scattering",
            "--texture-filter nearest",
            "--clamp 0.1",
            "--no-caustics",
        ];
        assert_eq!(all.flags().join(" "), format!("{unbiased} {}", biased.join(" ")));
        assert_eq!(all.biased(), biased);
    }

    #[test]
    fn words_lead_back_to_their_values() {
        fn check<T: Choice + std::fmt::Debug>() {
            for &(value, word, about) in T::ALL {
                assert_eq!(T::from_word(word), Some(value));
                assert_eq!(value.word(), word);
                assert!(!about.is_empty());
            }
            assert_eq!(T::from_word("nonsense"), None);
        }
        check::<SamplerKind>();
        check::<Direct>();
        check::<LightPick>();
        check::<Roulette>();
        check::<BuildPreset>();
        check::<FresnelModel>();
        check::<TextureFilter>();
    }
}
