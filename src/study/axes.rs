//! What can be varied about a render: each axis once, with what it does to the expected picture.
//!
//! [`all`] takes [`Technique`] apart field by field, so that a new field does not compile before it has its axis here.
//! Samples are no axis of this list: every variant is measured over a ladder of them.

use super::experiment::{Kind, Variant};
use super::uses::Uses;
use crate::render::technique::{Choice, Technique};

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
    pub values: Vec<Value>,
}

/// One value of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// The value's name, as in `late`.
    pub name: String,
    /// How it renders.
    pub technique: Technique,
    /// Threads; `None` for all that there are.
    pub threads: Option<usize>,
}

/// Depths that are tried: 1 is direct light alone.
const DEPTHS: [u32; 4] = [1, 2, 4, 8];

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
    let shallower = DEPTHS.iter().filter(|d| **d < max_depth).map(|d| (d.to_string(), *d));
    let clamps = CLAMPS.iter().map(|c| (c.to_string(), Some(*c)));
    vec![
        around.words("direct", Kind::Variance, direct, |t, v| t.direct = v),
        around.words("sampler", Kind::Variance, sampler, |t, v| t.sampler = v),
        around.axis("max-depth", Kind::Bias, max_depth, shallower, |t, v| t.max_depth = v),
        around.words("roulette", Kind::Variance, roulette, |t, v| t.roulette = v),
        around.axis("adaptive", Kind::Variance, adaptive, on_off(), |t, v| t.adaptive = v),
        around.axis("clamp", Kind::Bias, clamp, clamps, |t, v| t.clamp = v),
        around.words("lights", Kind::Variance, lights, |t, v| t.lights = v),
        around.words("fresnel", Kind::Bias, fresnel, |t, v| t.fresnel = v),
        around.axis(
            "multiple-scattering",
            Kind::Bias,
            multiple_scattering,
            on_off(),
            |t, v| t.multiple_scattering = v,
        ),
        around.words("textures", Kind::Bias, textures, |t, v| t.textures = v),
        around.words("build", Kind::Variance, build, |t, v| t.build = v),
        around.threads(threads),
    ]
}

/// The names of all axes, for those who choose among them.
pub fn names() -> Vec<&'static str> {
    let axes = all(&Technique::default(), 1, &Uses::default());
    std::iter::once(SAMPLES).chain(axes.iter().map(|a| a.name)).collect()
}

/// What axes are made around.
struct Around<'a> {
    base: &'a Technique,
    uses: &'a Uses,
}

impl Around<'_> {
    /// The axis of a field with words.
    fn words<V: Choice>(&self, name: &'static str, kind: Kind, own: V, set: impl Fn(&mut Technique, V)) -> Axis {
        let words = V::ALL.iter().map(|(value, word, _)| ((*word).to_owned(), *value));
        self.axis(name, kind, own, words, set)
    }

    fn axis<V: PartialEq + Copy>(
        &self,
        name: &'static str,
        kind: Kind,
        own: V,
        values: impl IntoIterator<Item = (String, V)>,
        set: impl Fn(&mut Technique, V),
    ) -> Axis {
        let others = values.into_iter().filter(|(_, v)| *v != own);
        let values = others.map(|(name, value)| {
            let mut technique = *self.base;
            set(&mut technique, value);
            Value {
                name,
                technique,
                threads: None,
            }
        });
        Axis {
            name,
            kind,
            useless: useless(name, self.uses),
            values: values.collect(),
        }
    }

    /// Powers of two below the number of threads.
    fn threads(&self, most: usize) -> Axis {
        let fewer = std::iter::successors(Some(1), |n| Some(n * 2)).take_while(|n| *n < most);
        let value = |n: usize| Value {
            name: n.to_string(),
            technique: *self.base,
            threads: Some(n),
        };
        Axis {
            name: THREADS,
            kind: Kind::Variance,
            useless: (most < 2).then_some("there is one thread"),
            values: fewer.map(value).collect(),
        }
    }
}

impl Value {
    /// The variant that this value of `axis` is.
    pub fn variant(&self, axis: &Axis, base: &Technique) -> Variant {
        Variant {
            axis: axis.name.to_owned(),
            name: self.name.clone(),
            kind: axis.kind,
            flags: match self.threads {
                Some(threads) => format!("--threads {threads}"),
                None => {
                    // A limit that stands in the scene needs no words.
                    let is_scenes = self.technique.max_depth == base.max_depth;
                    let honest = Technique::default().max_depth;
                    let max_depth = if is_scenes { honest } else { self.technique.max_depth };
                    let technique = Technique {
                        max_depth,
                        ..self.technique
                    };
                    technique.flags().join(" ")
                }
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
        "build" => (
            uses.many_shapes,
            "the scene has too few shapes for the tree of boxes to matter",
        ),
        _ => (true, ""),
    };
    (!matters).then_some(why)
}

fn on_off() -> [(String, bool); 2] {
    [("on".to_owned(), true), ("off".to_owned(), false)]
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
        let mut all: Vec<&Value> = axes.iter().flat_map(|a| &a.values).collect();
        assert!(axes.iter().all(|a| !a.values.is_empty()));
        assert!(all.iter().all(|c| c.technique != base || c.threads.is_some()));
        let n = all.len();
        all.dedup_by(|a, b| a.technique == b.technique && a.threads == b.threads);
        assert_eq!(all.len(), n, "no choice stands twice");
    }

    #[test]
    fn the_kind_of_an_axis_agrees_with_what_is_called_a_bias() {
        for axis in all(&Technique::default(), 4, &everything()) {
            for value in &axis.values {
                let departs = !value.technique.biased().is_empty();
                assert_eq!(departs, axis.kind == Kind::Bias, "{} {}", axis.name, value.name);
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
            "build",
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
        let names: Vec<&str> = depths.values.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["1", "2"]);
        assert_eq!(depths.values[0].variant(depths, &base).flags, "--max-depth 1");
        assert_eq!(axes[0].values[0].variant(&axes[0], &base).flags, "--direct light");
    }

    #[test]
    fn threads_go_by_powers_of_two_below_all() {
        let threads = |n: usize| -> Vec<Option<usize>> {
            let axes = all(&Technique::default(), n, &everything());
            axes.last().unwrap().values.iter().map(|c| c.threads).collect()
        };
        assert_eq!(threads(6), [Some(1), Some(2), Some(4)]);
        assert_eq!(threads(2), [Some(1)]);
        assert!(threads(1).is_empty());
    }
}
