//! What can be varied about a render: each axis once, with what it does to the expected picture.
//!
//! [`all`] takes [`Technique`] apart field by field, so that a new field does not compile before it has its axis here.
//! Samples are no axis of this list: every variant is measured over a ladder of them.

use super::experiment::{Kind, Variant};
use super::uses::Uses;
use crate::render::technique::{
    BuildPreset, Direct, FresnelModel, LightPick, Roulette, SamplerKind, Technique, TextureFilter,
};

/// The name of the base line's axis: only samples differ.
pub const SAMPLES: &str = "samples";

/// The name of the axis that is no part of the technique.
pub const THREADS: &str = "threads";

/// One thing that can be varied.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its name, as in `roulette`.
    pub name: &'static str,
    /// What it does to the expected picture.
    pub kind: Kind,
    /// Why it cannot matter for the scene; `None` if it may.
    pub useless: Option<&'static str>,
    /// The other values than that of the base line.
    pub choices: Vec<Choice>,
}

/// One value of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The value's name, as in `late`.
    pub name: String,
    /// How it renders.
    pub technique: Technique,
    /// Threads; `None` for all that there are.
    pub threads: Option<usize>,
}

/// Depths that are tried.
const DEPTHS: [u32; 5] = [0, 1, 2, 4, 8];

/// Largest contributions of a sample that are tried, in the unit of radiance: what other programs propose.
const CLAMPS: [f32; 2] = [10.0, 1.0];

/// All axes, the one that matters most first, around a base line that renders with `base` on `threads` threads.
pub fn all(base: &Technique, threads: usize, uses: &Uses) -> Vec<Axis> {
    // Exhaustive on purpose: a new field must be given an axis here (or be told to be an effect, as the last one).
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
        caustics: _, // an effect of the scene: left out by the ablation
    } = *base;
    let around = Around { base, uses };
    let deeper = DEPTHS.iter().filter(|d| **d < max_depth).map(|d| (d.to_string(), *d));
    let clamps = CLAMPS.iter().filter(|c| clamp.is_none_or(|own| **c < own));
    vec![
        around.axis("direct", Kind::Variance, direct, direct_names(), |t, v| t.direct = v),
        around.axis("sampler", Kind::Variance, sampler, sampler_names(), |t, v| {
            t.sampler = v
        }),
        around.axis("max-depth", Kind::Bias, max_depth, deeper, |t, v| t.max_depth = v),
        around.axis("roulette", Kind::Variance, roulette, roulette_names(), |t, v| {
            t.roulette = v
        }),
        around.axis("adaptive", Kind::Variance, adaptive, on_off(), |t, v| t.adaptive = v),
        around.axis(
            "clamp",
            Kind::Bias,
            clamp,
            clamps.map(|c| (c.to_string(), Some(*c))),
            |t, v| t.clamp = v,
        ),
        around.axis("lights", Kind::Variance, lights, light_names(), |t, v| t.lights = v),
        around.axis("fresnel", Kind::Bias, fresnel, fresnel_names(), |t, v| t.fresnel = v),
        around.axis(
            "multiple-scattering",
            Kind::Bias,
            multiple_scattering,
            on_off(),
            |t, v| t.multiple_scattering = v,
        ),
        around.axis("textures", Kind::Bias, textures, texture_names(), |t, v| t.textures = v),
        around.axis("build", Kind::Variance, build, build_names(), |t, v| t.build = v),
        around.threads(threads),
    ]
}

/// The names of all axes, for those who choose among them.
pub fn names() -> Vec<&'static str> {
    let axes = all(&Technique::default(), 1, &Uses::default());
    std::iter::once(SAMPLES).chain(axes.iter().map(|a| a.name)).collect()
}

/// The fields in which a technique departs from the unbiased one, by the names of their axes.
pub fn biases(technique: &Technique) -> Vec<&'static str> {
    let honest = Technique::default();
    let Technique {
        sampler: _,
        direct: _,
        lights: _,
        roulette: _,
        adaptive: _,
        build: _,
        max_depth,
        fresnel,
        multiple_scattering,
        textures,
        clamp,
        caustics,
    } = *technique;
    let departures = [
        ("max-depth", max_depth != honest.max_depth),
        ("fresnel", fresnel != honest.fresnel),
        ("multiple-scattering", multiple_scattering != honest.multiple_scattering),
        ("textures", textures != honest.textures),
        ("clamp", clamp != honest.clamp),
        ("caustics", caustics != honest.caustics),
    ];
    departures
        .into_iter()
        .filter(|(_, departs)| *departs)
        .map(|(name, _)| name)
        .collect()
}

/// The technique without the departures that [`biases`] names: the expected picture is the true one.
pub fn unbiased(technique: &Technique) -> Technique {
    let honest = Technique::default();
    Technique {
        max_depth: honest.max_depth,
        fresnel: honest.fresnel,
        multiple_scattering: honest.multiple_scattering,
        textures: honest.textures,
        clamp: honest.clamp,
        caustics: honest.caustics,
        ..*technique
    }
}

/// What axes are made around.
struct Around<'a> {
    base: &'a Technique,
    uses: &'a Uses,
}

impl Around<'_> {
    fn axis<V: PartialEq + Copy>(
        &self,
        name: &'static str,
        kind: Kind,
        own: V,
        values: impl IntoIterator<Item = (String, V)>,
        set: impl Fn(&mut Technique, V),
    ) -> Axis {
        let others = values.into_iter().filter(|(_, v)| *v != own);
        let choices = others.map(|(name, value)| {
            let mut technique = *self.base;
            set(&mut technique, value);
            Choice {
                name,
                technique,
                threads: None,
            }
        });
        Axis {
            name,
            kind,
            useless: useless(name, self.uses),
            choices: choices.collect(),
        }
    }

    /// Powers of two below the number of threads.
    fn threads(&self, most: usize) -> Axis {
        let fewer = std::iter::successors(Some(1), |n| Some(n * 2)).take_while(|n| *n < most);
        let choice = |n: usize| Choice {
            name: n.to_string(),
            technique: *self.base,
            threads: Some(n),
        };
        Axis {
            name: THREADS,
            kind: Kind::Variance,
            useless: (most < 2).then_some("there is one thread"),
            choices: fewer.map(choice).collect(),
        }
    }
}

impl Choice {
    /// The variant that this value of `axis` is.
    pub fn variant(&self, axis: &Axis, base: &Technique) -> Variant {
        Variant {
            axis: axis.name.to_owned(),
            name: self.name.clone(),
            // A base line with a bias of its own passes it on.
            kind: if biases(base).is_empty() { axis.kind } else { Kind::Bias },
            flags: match self.threads {
                Some(threads) => format!("--threads {threads}"),
                None => format!("--{} {}", axis.name, self.name),
            },
        }
    }
}

/// Why an axis cannot matter for a scene.
fn useless(axis: &str, uses: &Uses) -> Option<&'static str> {
    let (matters, why) = match axis {
        "direct" => (uses.hittable_lights, "no light of the scene can be hit by a ray"),
        "lights" => (uses.lights > 1, "the scene has no more than one light"),
        "fresnel" => (uses.dielectrics, "no surface of the scene is a dielectric"),
        "multiple-scattering" => (uses.rough_lobes, "no surface of the scene has a rough specular lobe"),
        "textures" => (uses.images, "no surface of the scene has an image"),
        _ => (true, ""),
    };
    (!matters).then_some(why)
}

fn named<V: Copy, const N: usize>(values: [(&str, V); N]) -> impl Iterator<Item = (String, V)> {
    values.map(|(name, v)| (name.to_owned(), v)).into_iter()
}

fn on_off() -> impl Iterator<Item = (String, bool)> {
    named([("on", true), ("off", false)])
}

fn direct_names() -> impl Iterator<Item = (String, Direct)> {
    named([("mis", Direct::Mis), ("light", Direct::Light), ("bsdf", Direct::Bsdf)])
}

fn sampler_names() -> impl Iterator<Item = (String, SamplerKind)> {
    named([("sobol", SamplerKind::Sobol), ("independent", SamplerKind::Independent)])
}

fn roulette_names() -> impl Iterator<Item = (String, Roulette)> {
    named([("throughput", Roulette::Throughput), ("late", Roulette::Late)])
}

fn light_names() -> impl Iterator<Item = (String, LightPick)> {
    named([
        ("tree", LightPick::Tree),
        ("power", LightPick::Power),
        ("uniform", LightPick::Uniform),
    ])
}

fn fresnel_names() -> impl Iterator<Item = (String, FresnelModel)> {
    named([
        ("exact", FresnelModel::Exact),
        ("schlick", FresnelModel::Schlick),
        ("schlick-incident", FresnelModel::SchlickIncident),
    ])
}

fn texture_names() -> impl Iterator<Item = (String, TextureFilter)> {
    named([
        ("as-written", TextureFilter::AsWritten),
        ("nearest", TextureFilter::Nearest),
    ])
}

fn build_names() -> impl Iterator<Item = (String, BuildPreset)> {
    named([
        ("fast", BuildPreset::Fast),
        ("medium", BuildPreset::Medium),
        ("high", BuildPreset::High),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn everything() -> Uses {
        Uses {
            lights: 9,
            hittable_lights: true,
            dielectrics: true,
            rough_lobes: true,
            images: true,
            ..Uses::default()
        }
    }

    #[test]
    fn every_choice_departs_from_the_base_line_in_one_thing() {
        let base = Technique::default();
        let axes = all(&base, 8, &everything());
        let mut all: Vec<&Choice> = axes.iter().flat_map(|a| &a.choices).collect();
        assert!(axes.iter().all(|a| !a.choices.is_empty() && a.useless.is_none()));
        assert!(all.iter().all(|c| c.technique != base || c.threads.is_some()));
        let n = all.len();
        all.dedup_by(|a, b| a.technique == b.technique && a.threads == b.threads);
        assert_eq!(all.len(), n, "no choice stands twice");
    }

    #[test]
    fn the_kind_of_an_axis_agrees_with_what_is_called_a_bias() {
        for axis in all(&Technique::default(), 4, &everything()) {
            for choice in &axis.choices {
                let departs = !biases(&choice.technique).is_empty();
                assert_eq!(departs, axis.kind == Kind::Bias, "{} {}", axis.name, choice.name);
                assert!(biases(&unbiased(&choice.technique)).is_empty());
            }
        }
    }

    #[test]
    fn what_the_scene_does_not_use_is_left_out_with_a_reason() {
        let axes = all(&Technique::default(), 1, &Uses::default());
        let useless: Vec<&str> = axes.iter().filter(|a| a.useless.is_some()).map(|a| a.name).collect();
        let expected = [
            "direct",
            "lights",
            "fresnel",
            "multiple-scattering",
            "textures",
            "threads",
        ];
        assert_eq!(useless, expected);
    }

    #[test]
    fn a_scene_that_limits_its_depth_is_only_varied_below_it() {
        let base = Technique {
            max_depth: 3,
            ..Technique::default()
        };
        let axes = all(&base, 1, &everything());
        let depths = axes.iter().find(|a| a.name == "max-depth").unwrap();
        let names: Vec<&str> = depths.choices.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["0", "1", "2"]);
        // Nothing measured around a biased base line is unbiased.
        assert_eq!(axes[0].choices[0].variant(&axes[0], &base).kind, Kind::Bias);
    }

    #[test]
    fn threads_go_by_powers_of_two_below_all() {
        let threads = |n: usize| -> Vec<Option<usize>> {
            let axes = all(&Technique::default(), n, &everything());
            axes.last().unwrap().choices.iter().map(|c| c.threads).collect()
        };
        assert_eq!(threads(6), [Some(1), Some(2), Some(4)]);
        assert_eq!(threads(2), [Some(1)]);
        assert!(threads(1).is_empty());
    }
}
