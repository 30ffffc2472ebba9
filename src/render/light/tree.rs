//! The light tree: chooses one of many lights by what their group can do at the receiver.
//!
//! A binary tree of [`LightBounds`]. Going down, each child is taken with a probability proportional to its importance,
//! so a choice costs the depth of the tree. `sample` and `probability` compute the very same branch probabilities;
//! the way to a light is remembered as one bit per level.
//! Source: Conty Estevez & Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, 2018; PBRT-4 §12.6.3.

use super::Receiver;
use super::bounds::{Cluster, LightBounds};
use super::choice::remap;
use super::split::{Item, split};
use glam::Vec3;

/// A node; its two children stand side by side.
#[derive(Clone, Copy, Debug)]
struct Node {
    cluster: Cluster,
    /// The light of a leaf with [`LEAF`] set, else the index of the first child.
    link: u32,
}

const LEAF: u32 = 1 << 31;
/// The path of a light that is not in the tree.
const NOT_HERE: u64 = u64::MAX;
/// The least probability of a child that can contribute: bounds the loss where the estimate misleads.
const MIN_BRANCH: f32 = 1.0 / 1024.0;

/// A tree over the lights that have bounds.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    nodes: Vec<Node>,
    /// By light: the branches from the root, first in the lowest bit, 1 for the second child; a 1 ends the path.
    paths: Vec<u64>,
    /// Powers of two that bring lengths and intensities near 1, so that a scene of any size gives the same choices.
    length_scale: f32,
    /// Undoes both scales: importance times this is an irradiance.
    irradiance_scale: f64,
}

impl LightTree {
    /// A tree over lights with these indices, all below `count` ≤ 2³¹, and bounds.
    pub fn new(count: usize, bounds: impl Iterator<Item = (u32, LightBounds)>) -> LightTree {
        let bounds: Vec<(u32, LightBounds)> = bounds.filter(|(_, b)| b.intensity > 0.0).collect();
        let all = bounds
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY, 0.0f32), |(lo, hi, i), (_, b)| {
                (lo.min(b.min), hi.max(b.max), i.max(b.intensity))
            });
        let length_scale = inverse_power_of_two((all.1 - all.0).max_element());
        let intensity_scale = inverse_power_of_two(all.2);
        let mut items: Vec<Item> = bounds
            .into_iter()
            .map(|(light, b)| Item::new(light, b.scaled(length_scale, intensity_scale)))
            .collect();
        let mut tree = LightTree {
            nodes: Vec::new(),
            paths: vec![NOT_HERE; count],
            length_scale,
            irradiance_scale: f64::from(length_scale) * f64::from(length_scale) / f64::from(intensity_scale),
        };
        tree.build(&mut items);
        tree
    }

    /// Builds top-down with a stack of our own, then bounds bottom-up: children always come after their parent.
    fn build(&mut self, items: &mut [Item]) {
        struct Task {
            node: usize,
            start: usize,
            end: usize,
            depth: u32,
            path: u64,
        }
        if items.is_empty() {
            return;
        }
        let count = 2 * items.len() - 1;
        let mut bounds = Vec::with_capacity(count);
        let mut links = Vec::with_capacity(count);
        bounds.push(LightBounds::DARK);
        links.push(0u32);
        let mut stack = vec![Task {
            node: 0,
            start: 0,
            end: items.len(),
            depth: 0,
            path: 0,
        }];
        while let Some(task) = stack.pop() {
            let list = &mut items[task.start..task.end];
            if let [item] = list {
                bounds[task.node] = item.bounds;
                links[task.node] = item.light | LEAF;
                self.paths[item.light as usize] = task.path | 1 << task.depth;
                continue;
            }
            let middle = task.start + split(list, task.depth);
            let first = bounds.len();
            links[task.node] = first as u32;
            for _ in 0..2 {
                bounds.push(LightBounds::DARK);
                links.push(0);
            }
            let depth = task.depth + 1;
            stack.push(Task {
                node: first + 1,
                start: middle,
                end: task.end,
                depth,
                path: task.path | 1 << task.depth,
            });
            stack.push(Task {
                node: first,
                start: task.start,
                end: middle,
                depth,
                path: task.path,
            });
        }
        for i in (0..bounds.len()).rev() {
            if links[i] & LEAF == 0 {
                let first = links[i] as usize;
                bounds[i] = bounds[first].union(&bounds[first + 1]);
            }
        }
        let node = |(b, &link): (&LightBounds, &u32)| Node {
            cluster: b.cluster(),
            link,
        };
        self.nodes = bounds.iter().zip(&links).map(node).collect();
    }

    fn localize(&self, at: &Receiver) -> Receiver {
        Receiver {
            p: at.p * self.length_scale,
            ..*at
        }
    }

    /// An estimate of the irradiance of the whole tree at the receiver; 0 only if it brings none.
    pub fn irradiance(&self, at: &Receiver) -> f64 {
        let importance = self
            .nodes
            .first()
            .map_or(0.0, |n| n.cluster.importance(&self.localize(at)));
        f64::from(importance) * self.irradiance_scale
    }

    /// Probability of the first of two children; `None` if neither can contribute.
    fn first_branch(&self, children: usize, at: &Receiver) -> Option<f32> {
        let first = self.nodes[children].cluster.importance(at);
        let second = self.nodes[children + 1].cluster.importance(at);
        match (first > 0.0, second > 0.0) {
            (false, false) => None,
            (true, false) => Some(1.0),
            (false, true) => Some(0.0),
            (true, true) => Some((first / (first + second)).clamp(MIN_BRANCH, 1.0 - MIN_BRANCH)),
        }
    }

    /// A light and its probability; `None` if it ends where nothing contributes.
    pub fn sample(&self, at: &Receiver, mut u: f64) -> Option<(u32, f32)> {
        let at = self.localize(at);
        let (mut node, mut probability) = (0usize, 1.0f32);
        loop {
            let link = self.nodes.get(node)?.link;
            if link & LEAF != 0 {
                return Some((link & !LEAF, probability));
            }
            let first = self.first_branch(link as usize, &at)?;
            if u < f64::from(first) {
                u = remap(u, 0.0, f64::from(first));
                probability *= first;
                node = link as usize;
            } else {
                u = remap(u, f64::from(first), 1.0);
                probability *= 1.0 - first;
                node = link as usize + 1;
            }
        }
    }

    /// The probability with which `sample` chooses this light; 0 for lights outside the tree.
    pub fn probability(&self, at: &Receiver, light: u32) -> f32 {
        let Some(&path) = self.paths.get(light as usize) else {
            return 0.0;
        };
        if path == NOT_HERE {
            return 0.0;
        }
        let at = self.localize(at);
        let (mut node, mut probability, mut path) = (0usize, 1.0f32, path);
        while path != 1 {
            let children = self.nodes[node].link as usize;
            let Some(first) = self.first_branch(children, &at) else {
                return 0.0;
            };
            if path & 1 == 0 {
                probability *= first;
                node = children;
            } else {
                probability *= 1.0 - first;
                node = children + 1;
            }
            if probability == 0.0 {
                return 0.0;
            }
            path >>= 1;
        }
        probability
    }
}

/// The power of two near 1/x; 1 if x is 0 or no number.
fn inverse_power_of_two(x: f32) -> f32 {
    if !(x > 0.0 && x.is_finite()) {
        return 1.0;
    }
    let exponent = (x.to_bits() >> 23) as i32 - 127; // −127 for subnormal x, which is near enough
    f32::from_bits((((-exponent).clamp(-126, 127) + 127) as u32) << 23)
}
