//! Lights whose irradiance does not fall with 1/r²: the sun, the sky, and lamps with another falloff.
//!
//! A tree that ranks by 1/r² would starve them, so they stand beside it. A few are weighed at each receiver;
//! many get fixed probabilities.

use super::bounds::{Cluster, LightBounds, in_range};
use super::choice::{Table, remap};
use super::lamp::Falloff;
use super::{Light, Receiver};
use crate::math::color::luminance;
use crate::math::robust::gamma;
use glam::Vec3;
use std::f32::consts::PI;

/// Up to this many are weighed one by one.
const FEW: usize = 16;
/// The part of the probability that is shared evenly among those that can contribute.
const EVEN_SHARE: f64 = 0.125;

/// How the irradiance of one of them is estimated.
#[derive(Clone, Copy, Debug)]
enum Reach {
    /// Equally strong everywhere.
    Constant,
    /// From this unit direction.
    From(Vec3),
    /// From a place.
    Lamp(Cluster, Falloff),
}

#[derive(Clone, Debug)]
struct Entry {
    light: u32,
    /// π times the luminance of its colour, or the mean of the sky.
    irradiance: f32,
    reach: Reach,
}

/// The lights beside the tree.
#[derive(Clone, Debug, Default)]
pub(crate) struct DistantLights {
    entries: Vec<Entry>,
    /// By light: its entry plus one, 0 for lights that are not here.
    entry_of: Vec<u32>,
    /// Fixed probabilities, used if there are more than [`FEW`].
    table: Table,
    sum: f64,
}

/// Whether a light belongs here and not into the tree.
pub(crate) fn is_distant(light: &Light) -> bool {
    let other = |falloff: &Falloff| !matches!(falloff, Falloff::InverseSquare { .. });
    match light {
        Light::Directional(_) | Light::Environment(_) => true,
        Light::Point(l) => other(&l.falloff),
        Light::Spot(l) => other(&l.falloff),
        Light::Area(l) => other(&l.falloff),
        Light::Moving(l) => is_distant(l.opening()),
        Light::Sphere(_) | Light::SphereCap(_) | Light::Triangle(_) | Light::Parallelogram(_) | Light::Disc(_) => false,
    }
}

/// The luminance of a light's colour and how it falls; `None` for emitting surfaces.
fn strength(light: &Light) -> Option<(f32, Falloff)> {
    Some(match light {
        Light::Environment(l) => (l.mean_luminance() as f32, Falloff::None),
        Light::Directional(l) => (luminance(l.color), Falloff::None),
        Light::Point(l) => (luminance(l.color), l.falloff),
        Light::Spot(l) => (luminance(l.color), l.falloff),
        Light::Area(l) => (luminance(l.color), l.falloff),
        Light::Moving(l) => return strength(l.opening()),
        Light::Sphere(_) | Light::SphereCap(_) | Light::Triangle(_) | Light::Parallelogram(_) | Light::Disc(_) => {
            return None;
        }
    })
}

impl DistantLights {
    pub fn new(lights: &[Light]) -> DistantLights {
        let mut set = DistantLights::default();
        for (i, light) in lights.iter().enumerate().filter(|(_, l)| is_distant(l)) {
            let Some((brightness, falloff)) = strength(light) else {
                continue;
            };
            let reach = match (light, LightBounds::of(light)) {
                (Light::Directional(l), _) => Reach::From(-l.direction),
                (_, Some(bounds)) => Reach::Lamp(bounds.cluster(), falloff),
                (_, None) => Reach::Constant,
            };
            let irradiance = if brightness > 0.0 {
                in_range(brightness * PI)
            } else {
                0.0
            };
            if irradiance > 0.0 {
                set.entry_of.resize(i, 0);
                set.entries.push(Entry {
                    light: i as u32,
                    irradiance,
                    reach,
                });
                set.entry_of.push(set.entries.len() as u32);
            }
        }
        let weights: Vec<f64> = set.entries.iter().map(|e| f64::from(e.irradiance)).collect();
        set.sum = weights.iter().sum();
        if set.entries.len() > FEW {
            set.table = Table::new(&weights, EVEN_SHARE);
        }
        set
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The weights of a few lights at the receiver, their sum, and how many are not 0.
    fn weigh(&self, at: &Receiver) -> ([f64; FEW], f64, f64) {
        let mut weights = [0.0; FEW];
        let (mut sum, mut lit) = (0.0, 0.0);
        for (w, entry) in weights.iter_mut().zip(&self.entries) {
            *w = f64::from(entry.weight(at));
            sum += *w;
            lit += if *w > 0.0 { 1.0 } else { 0.0 };
        }
        (weights, sum, lit)
    }

    /// An estimate of the irradiance of all of them at the receiver; 0 only if they bring none.
    pub fn irradiance(&self, at: &Receiver) -> f64 {
        if self.entries.len() > FEW {
            self.sum
        } else {
            self.weigh(at).1
        }
    }

    /// A light and its probability; `None` if none contributes.
    pub fn sample(&self, at: &Receiver, u: f64) -> Option<(u32, f32)> {
        if let [only] = self.entries.as_slice() {
            return Some((only.light, 1.0));
        }
        if self.entries.len() > FEW {
            let (i, probability) = self.table.sample(u)?;
            return Some((self.entries.get(i)?.light, probability as f32));
        }
        let (weights, sum, lit) = self.weigh(at);
        let mut end = 0.0;
        let mut last = None;
        for (entry, &w) in self.entries.iter().zip(&weights) {
            if w > 0.0 {
                let probability = mixed(w, sum, lit);
                end += probability;
                last = Some((entry.light, probability as f32));
                if u < end {
                    break;
                }
            }
        }
        last
    }

    /// The probability with which `sample` chooses this light; 0 for lights that are not here.
    pub fn probability(&self, at: &Receiver, light: u32) -> f32 {
        let Some(i) = self.entry_of.get(light as usize).and_then(|e| e.checked_sub(1)) else {
            return 0.0;
        };
        let i = i as usize;
        if self.entries.len() == 1 {
            return 1.0;
        }
        if self.entries.len() > FEW {
            return self.table.probability(i) as f32;
        }
        let (weights, sum, lit) = self.weigh(at);
        match weights.get(i) {
            Some(&w) if w > 0.0 => mixed(w, sum, lit) as f32,
            _ => 0.0,
        }
    }
}

/// Proportional to the weight, with an even share for each that can contribute.
fn mixed(weight: f64, sum: f64, lit: f64) -> f64 {
    (1.0 - EVEN_SHARE) * (weight / sum) + EVEN_SHARE / lit
}

impl Entry {
    /// An estimate of the irradiance at the receiver; 0 only if there is none.
    fn weight(&self, at: &Receiver) -> f32 {
        match &self.reach {
            Reach::Constant => self.irradiance,
            Reach::From(wi) => {
                let cos = at.cosine(*wi) + gamma(8);
                if cos > 0.0 { self.irradiance * cos } else { 0.0 }
            }
            Reach::Lamp(cluster, falloff) => match cluster.view(at) {
                Some(view) => {
                    let by_distance = falloff.irradiance(f64::from(view.d2).sqrt()) * std::f32::consts::FRAC_1_PI;
                    in_range(self.irradiance * view.factor * by_distance).max(f32::MIN_POSITIVE)
                }
                None => 0.0,
            },
        }
    }
}

/// Splits a random number between two groups: whether it falls into the first, of probability `first`, and what is
/// left of it.
pub(crate) fn split_number(u: f64, first: f64) -> (bool, f64) {
    if u < first {
        (true, remap(u, 0.0, first))
    } else {
        (false, remap(u, first, 1.0))
    }
}
