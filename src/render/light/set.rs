//! All lights of a scene, and the choice among them.

use super::bounds::LightBounds;
use super::choice::{Table, extend};
use super::coincident::Copies;
use super::distant::{DistantLights, is_distant, split_number};
use super::tree::LightTree;
use super::{Aim, EnvironmentLight, HitOnLight, Light, LightSample, Receiver, coincident, power};
use crate::render::technique::LightPick;
use glam::{Vec2, Vec3};

/// The lights of a scene, ready to be sampled.
///
/// A single light is chosen always. Otherwise the lights with 1/r² stand in a tree, the others beside it; the group is
/// chosen by an estimate of the irradiance it brings, kept within [1/8, 7/8] where both bring some. A light that can
/// contribute at the receiver has a positive probability; one that cannot may have 0. For comparison, lights can also be
/// chosen by their power or evenly, with the same probabilities everywhere.
#[derive(Clone, Debug, Default)]
pub struct LightSet {
    lights: Vec<Light>,
    /// What chooses among several lights.
    choice: Option<Box<Choice>>,
    environments: Vec<u32>,
    /// By light, whether copies of it stand in its place; empty if there are no copies at all.
    hiding: Vec<bool>,
    has_delta: bool,
}

#[derive(Clone, Debug)]
enum Choice {
    /// By what they can do at the receiver.
    Weighed(Weighed),
    /// With the same probabilities everywhere.
    Fixed(Table),
}

#[derive(Clone, Debug)]
struct Weighed {
    tree: LightTree,
    distant: DistantLights,
}

/// The least probability of a group that can contribute.
const MIN_GROUP: f64 = 0.125;
/// The part of the probability that lights chosen by power share evenly: a weak lamp must not be starved.
const MIN_SHARE: f64 = 1.0 / 1024.0;

impl LightSet {
    /// Takes the lights; their indices stay what they are. At most 2³¹ lights. Of emitters with exactly the same shape
    /// and place only the one with the lowest primitive is ever chosen, since rays see only that one.
    pub fn new(lights: Vec<Light>) -> LightSet {
        LightSet::with_pick(lights, LightPick::Tree, None)
    }

    /// As [`LightSet::new`], with the way in which one of several is chosen. `bounds` is the box of what stands in the
    /// scene, which says how much of the sun and the sky it can catch; only [`LightPick::Power`] asks for it.
    pub fn with_pick(lights: Vec<Light>, pick: LightPick, bounds: Option<(Vec3, Vec3)>) -> LightSet {
        let Copies { hidden, mut hiding } = coincident::copies(&lights);
        if !hiding.contains(&true) {
            hiding = Vec::new();
        }
        let choice = (lights.len() > 1).then(|| {
            if pick == LightPick::Tree {
                let near = (0u32..)
                    .zip(lights.iter().zip(&hidden))
                    .filter(|(_, (l, hidden))| !is_distant(l) && !**hidden)
                    .filter_map(|(i, (l, _))| Some((i, LightBounds::of(l)?)));
                return Box::new(Choice::Weighed(Weighed {
                    tree: LightTree::new(lights.len(), near),
                    distant: DistantLights::new(&lights),
                }));
            }
            let reach = power::reach(&lights, bounds);
            let weigh = |(light, hidden): (&Light, &bool)| {
                let power = if *hidden { 0.0 } else { power::of(light, reach) };
                if pick == LightPick::Uniform && power > 0.0 {
                    1.0
                } else {
                    power
                }
            };
            let weights: Vec<f64> = lights.iter().zip(&hidden).map(weigh).collect();
            let even_share = if pick == LightPick::Power { MIN_SHARE } else { 0.0 };
            Box::new(Choice::Fixed(Table::new(&weights, even_share)))
        });
        let environments = (0u32..)
            .zip(&lights)
            .filter_map(|(i, l)| matches!(l, Light::Environment(_)).then_some(i))
            .collect();
        let has_delta = lights.iter().any(Light::is_delta);
        LightSet {
            lights,
            choice,
            environments,
            hiding,
            has_delta,
        }
    }

    /// Whether there is no light at all.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// The light of this index.
    pub fn get(&self, light: u32) -> Option<&Light> {
        self.lights.get(light as usize)
    }

    /// Whether some lights can only be found by light sampling.
    pub fn has_delta(&self) -> bool {
        self.has_delta
    }

    /// Whether light comes from infinitely far away, other than from directional lamps.
    pub fn has_environment(&self) -> bool {
        !self.environments.is_empty()
    }

    /// Chooses a light for the shading point `p` and a direction towards it. `n` is the unit shading normal whose
    /// positive side receives light, or zero; with `two_sided` both sides do. `u_pick` and `u` are in [0, 1).
    ///
    /// The estimate is f·cos·radiance/pdf, and 0 for `None`: where the chosen group or point turns out not to
    /// contribute, no other is tried, since that would change the densities. `time` is that of the path, in [0, 1).
    pub fn sample(&self, p: Vec3, n: Vec3, two_sided: bool, u_pick: f32, u: Vec2, time: f32) -> Option<LightSample> {
        let at = Receiver { p, n, two_sided };
        // The number that picks among many lights borrows its low bits from those that pick the point.
        let (light, probability) = match self.choice {
            None => (0, 1.0),
            Some(_) => self.choose(&at, extend(u_pick, u.x.to_bits() ^ u.y.to_bits().rotate_left(16)))?,
        };
        let l = self.lights.get(light as usize)?;
        let mut aim = aim(l, &at, u, time)?;
        if self.hiding.get(light as usize) == Some(&true) {
            aim.t_max = coincident::shadow_end(l, &at, &aim);
        }
        let pdf = match l {
            // Several environments overlap; the densities of all of them add up.
            Light::Environment(_) if self.environments.len() > 1 => self.environment_pdf(p, n, two_sided, aim.wi),
            _ => aim.pdf * probability,
        };
        let radiance = match l {
            Light::Environment(_) if self.environments.len() > 1 => self.escaped(aim.wi),
            _ => aim.radiance,
        };
        (pdf > 0.0).then_some(LightSample {
            wi: aim.wi,
            wi_low: aim.wi_low,
            radiance,
            pdf,
            delta: l.is_delta(),
            t_max: aim.t_max,
            distance: aim.distance,
            slant: aim.slant,
            to: aim.to,
            b: aim.b,
            textured: aim.textured,
            light,
            casts_shadow: aim.casts_shadow,
            time,
        })
    }

    /// A light and the probability of its choice.
    pub(crate) fn choose(&self, at: &Receiver, u: f64) -> Option<(u32, f32)> {
        match &self.choice {
            None if self.lights.is_empty() => None,
            None => Some((0, 1.0)),
            Some(choice) => choice.sample(at, u),
        }
    }

    /// The density per solid angle, probability of the choice included, with which `sample` at the same `p`, `n`,
    /// `two_sided` gives the direction `wi` that was found to hit `light` at `hit`. 0 for delta lights.
    pub fn pdf(&self, light: u32, p: Vec3, n: Vec3, two_sided: bool, wi: Vec3, hit: &HitOnLight) -> f32 {
        let at = Receiver { p, n, two_sided };
        let pdf = match self.lights.get(light as usize) {
            Some(Light::Sphere(l)) => l.pdf(&at, wi),
            Some(Light::SphereCap(l)) => l.pdf(wi, hit),
            Some(Light::Triangle(l)) => l.pdf(&at, wi, hit),
            Some(Light::Parallelogram(l)) => l.pdf(&at, wi, hit),
            Some(Light::Disc(l)) => l.pdf(wi, hit),
            Some(Light::Environment(l)) => l.pdf(&at, wi),
            Some(Light::Moving(l)) => l.pdf(&at, wi, hit),
            Some(Light::Point(_) | Light::Spot(_) | Light::Directional(_) | Light::Area(_)) | None => return 0.0,
        };
        if pdf == 0.0 {
            return 0.0;
        }
        pdf * self.probability(light, &at)
    }

    /// Radiance that arrives from infinitely far away along the unit direction `wi`.
    pub fn escaped(&self, wi: Vec3) -> Vec3 {
        self.environments().map(|(_, l)| l.radiance(wi)).sum()
    }

    /// The density with which `sample` gives the direction `wi` by choosing an environment.
    pub fn environment_pdf(&self, p: Vec3, n: Vec3, two_sided: bool, wi: Vec3) -> f32 {
        let at = Receiver { p, n, two_sided };
        self.environments()
            .map(|(i, l)| match l.pdf(&at, wi) {
                0.0 => 0.0,
                pdf => pdf * self.probability(i, &at),
            })
            .sum()
    }

    fn environments(&self) -> impl Iterator<Item = (u32, &EnvironmentLight)> {
        self.environments.iter().filter_map(|&i| match self.get(i) {
            Some(Light::Environment(l)) => Some((i, l.as_ref())),
            _ => None,
        })
    }

    /// The probability with which `sample` chooses this light at the receiver.
    pub(crate) fn probability(&self, light: u32, at: &Receiver) -> f32 {
        match &self.choice {
            None if light == 0 && !self.lights.is_empty() => 1.0,
            None => 0.0,
            Some(choice) => choice.probability(at, light),
        }
    }
}

/// A direction towards a light at a time.
#[inline(always)]
fn aim(light: &Light, at: &Receiver, u: Vec2, time: f32) -> Option<Aim> {
    match light {
        Light::Point(l) => l.sample(at),
        Light::Spot(l) => l.sample(at),
        Light::Directional(l) => Some(l.sample()),
        Light::Area(l) => l.sample(at, u),
        Light::Sphere(l) => l.sample(at, u),
        Light::SphereCap(l) => l.sample(at, u),
        Light::Triangle(l) => l.sample(at, u),
        Light::Parallelogram(l) => l.sample(at, u),
        Light::Disc(l) => l.sample(at, u),
        Light::Environment(l) => l.sample(at, u),
        Light::Moving(l) => l.sample(at, u, time),
    }
}

impl Choice {
    fn sample(&self, at: &Receiver, u: f64) -> Option<(u32, f32)> {
        match self {
            Choice::Weighed(weighed) => weighed.sample(at, u),
            Choice::Fixed(table) => table.sample(u).map(|(light, p)| (light as u32, p as f32)),
        }
    }

    fn probability(&self, at: &Receiver, light: u32) -> f32 {
        match self {
            Choice::Weighed(weighed) => weighed.probability(at, light),
            Choice::Fixed(table) => table.probability(light as usize) as f32,
        }
    }
}

impl Weighed {
    /// Probability of the tree; `None` if neither group can contribute.
    fn tree_share(&self, at: &Receiver) -> Option<f64> {
        if self.distant.is_empty() {
            return Some(1.0);
        }
        let (tree, distant) = (self.tree.irradiance(at), self.distant.irradiance(at));
        match (tree > 0.0, distant > 0.0) {
            (false, false) => None,
            (true, false) => Some(1.0),
            (false, true) => Some(0.0),
            (true, true) => Some((tree / (tree + distant)).clamp(MIN_GROUP, 1.0 - MIN_GROUP)),
        }
    }

    fn sample(&self, at: &Receiver, u: f64) -> Option<(u32, f32)> {
        let share = self.tree_share(at)?;
        let (in_tree, u) = split_number(u, share);
        let (light, probability, share) = if in_tree {
            let (light, probability) = self.tree.sample(at, u)?;
            (light, probability, share as f32)
        } else {
            let (light, probability) = self.distant.sample(at, u)?;
            (light, probability, (1.0 - share) as f32)
        };
        Some((light, probability * share))
    }

    fn probability(&self, at: &Receiver, light: u32) -> f32 {
        let Some(share) = self.tree_share(at) else {
            return 0.0;
        };
        let in_tree = self.tree.probability(at, light);
        if in_tree > 0.0 {
            return in_tree * share as f32;
        }
        self.distant.probability(at, light) * (1.0 - share) as f32
    }
}
