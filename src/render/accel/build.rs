//! From boxes to an 8-wide tree, by way of obvhs's binary one.

use super::bounds::Bounds;
use super::node::{LEAF, Node, Tree, WIDTH};
use crate::render::technique::BuildPreset;
use obvhs::bvh2::{Bvh2, leaf_collapser::collapse, node::Bvh2Node, reinsertion::ReinsertionOptimizer};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance};
use obvhs::{BvhBuildParams, aabb::Aabb};
use rayon::slice::ParallelSliceMut;
use std::collections::HashMap;

mod cuts;
mod topdown;

use cuts::Cuts;

/// A tree over these boxes with at most `leaf_size` primitives a leaf. Empty input gives an empty tree; identical boxes,
/// flat ones and huge ones are all fine. How thoroughly it is built changes what a ray visits, never what it hits.
/// The boxes are taken so that they need not stay in memory while the tree grows.
pub fn build_tree(bounds: Vec<Bounds>, leaf_size: u32, preset: BuildPreset) -> Tree {
    if bounds.is_empty() {
        return Tree::default();
    }
    // Areas of boxes around 1e20 overflow f32, those around 1e-20 vanish: build in a friendlier unit.
    // A power of two changes no digit.
    let largest = bounds.iter().map(|b| b.largest()).fold(0.0f32, f32::max);
    const SMALL: f32 = 1e-6;
    const LARGE: f32 = 1e12;
    let unit = if largest > LARGE || (largest < SMALL && largest > 0.0) {
        power_of_two_below(f64::from(largest))
    } else {
        1.0
    };
    let stacks = Stacks::find(&bounds);
    let (boxes, bounds) = stacks.boxes(bounds, 1.0 / unit);
    let binary = if topdown::is_needed(&boxes) {
        topdown::build(&boxes, leaf_size as usize)
    } else {
        cluster(boxes, leaf_size, preset)
    };
    let leaves = Leaves {
        bounds: &bounds,
        size: leaf_size as usize,
    };
    let mut tree = widen(&binary, unit, &stacks, &leaves);
    tree.stack_need = stack_need(&tree);
    tree
}

/// Boxes around one centre, gathered where there are many: clustering by area merges equal and nested boxes one by one, in
/// quadratic time. The builder sees one box of each stack.
struct Stacks {
    /// The lowest primitive of each stack or the only one, ascending; empty where there are no stacks.
    lowest: Vec<u32>,
    /// All primitives of real stacks, by the lowest; from small to large.
    members: HashMap<u32, Vec<u32>>,
}

impl Stacks {
    /// This many are left to the builder: the two triangles of an upright rectangle share their box.
    const HARMLESS: usize = 8;

    fn find(bounds: &[Bounds]) -> Stacks {
        let center = |i: u32| bounds[i as usize].min * 0.5 + bounds[i as usize].max * 0.5;
        let mut keys: Vec<(u64, u32)> = (0..bounds.len() as u32).map(|i| (hash(center(i)), i)).collect();
        keys.par_sort_unstable();
        let mut members = HashMap::new();
        let mut covered = Vec::new();
        for run in keys.chunk_by(|a, b| a.0 == b.0) {
            if run.len() > Self::HARMLESS {
                let lowest = run[0].1;
                let mut stack: Vec<u32> = run
                    .iter()
                    .map(|k| k.1)
                    .filter(|&i| center(i) == center(lowest))
                    .collect();
                covered.extend_from_slice(&stack[1..]);
                let extent = |i: u32| bounds[i as usize].max - bounds[i as usize].min;
                stack.sort_by(|&a, &b| {
                    extent(a)
                        .max_element()
                        .total_cmp(&extent(b).max_element())
                        .then(a.cmp(&b))
                });
                members.insert(lowest, stack);
            }
        }
        covered.sort_unstable();
        let is_lowest = |i: &u32| covered.binary_search(i).is_err();
        let all = if covered.is_empty() { 0 } else { bounds.len() as u32 };
        Stacks {
            lowest: (0..all).filter(is_lowest).collect(),
            members,
        }
    }

    /// The builder's boxes, scaled, and the primitives' own where there are stacks to be opened again.
    fn boxes(&self, mut bounds: Vec<Bounds>, factor: f64) -> (Vec<Bounds>, Vec<Bounds>) {
        if self.members.is_empty() {
            bounds.iter_mut().for_each(|b| *b = scaled(*b, factor));
            return (bounds, Vec::new());
        }
        let scaled = |&i: &u32| scaled(self.bounds(&bounds, i), factor);
        (self.lowest.iter().map(scaled).collect(), bounds)
    }

    /// The box of a stack or single primitive.
    fn bounds(&self, bounds: &[Bounds], lowest: u32) -> Bounds {
        match self.members.get(&lowest) {
            Some(stack) => union(stack, bounds),
            None => bounds[lowest as usize],
        }
    }

    /// Lists the primitives behind some of the builder's items.
    fn primitives(&self, items: &[u32], all: &mut Vec<u32>) {
        all.clear();
        if self.members.is_empty() {
            all.extend_from_slice(items);
            return;
        }
        for &item in items {
            let lowest = self.lowest[item as usize];
            match self.members.get(&lowest) {
                Some(stack) => all.extend_from_slice(stack),
                None => all.push(lowest),
            }
        }
    }
}

fn union(primitives: &[u32], bounds: &[Bounds]) -> Bounds {
    let each = primitives.iter().map(|&i| bounds[i as usize]);
    each.fold(Bounds::EMPTY, Bounds::union)
}

fn hash(center: glam::Vec3) -> u64 {
    center.to_array().into_iter().fold(0xCBF2_9CE4_8422_2325, |h: u64, x| {
        (h ^ u64::from(x.to_bits()))
            .wrapping_mul(0x9E37_79B9_7F4A_7C15)
            .rotate_left(29)
    })
}

/// The largest power of two not above a positive finite number.
pub fn power_of_two_below(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) & 0x7ff;
    f64::from_bits(exponent.max(1) << 52)
}

fn scaled(b: Bounds, factor: f64) -> Bounds {
    if factor == 1.0 {
        return b;
    }
    // Digits lost below the smallest number must not shrink the box.
    let s = |v: glam::Vec3, round: fn(f32) -> f32| {
        let v = (v.as_dvec3() * factor).as_vec3();
        glam::Vec3::from_array(v.to_array().map(round))
    };
    Bounds {
        min: s(b.min, f32::next_down),
        max: s(b.max, f32::next_up),
    }
}

/// The usual way: clustering, then optimisation by reinsertion, then leaves as full as they may be (a leaf costs the
/// same however full it is).
fn cluster(boxes: Vec<Bounds>, leaf_size: u32, preset: BuildPreset) -> Bvh2 {
    // In a row of equal boxes all neighbours are equally good, and one pair would be merged a round. Widening each box
    // by its own share of 2⁻¹² breaks the ties.
    // The library's presets, of which pre-splitting and the cost model of leaves are not used here.
    let params = match preset {
        BuildPreset::Fast => BvhBuildParams::fastest_build(),
        BuildPreset::Medium => BvhBuildParams::medium_build(),
        BuildPreset::High => BvhBuildParams::very_slow_build(),
    };
    let count = boxes.len();
    let mut total = Aabb::empty();
    let leaf = |(b, i): (Bounds, u32)| {
        let share = (i.wrapping_mul(0x9E37_79B9) >> 8) as f32 / 16_777_216.0 / 4096.0;
        let max = b.max + (b.max - b.min).max_element() * share;
        let aabb = Aabb::new(b.min.into(), max.into());
        total = total.union(&aabb);
        Bvh2Node::new(aabb, 1, i)
    };
    // The builder's working set is the peak of all memory; its leaves take the boxes' place.
    let mut builder = PlocBuilder::new();
    builder.current_nodes = boxes.into_iter().zip(0..).map(leaf).collect();
    let mut bvh = Bvh2::zeroed(count);
    bvh.primitive_indices = (0..count as u32).collect();
    let (precision, threshold) = (params.sort_precision, params.search_depth_threshold);
    match params.ploc_search_distance {
        PlocSearchDistance::Minimum => {
            builder.build_ploc_from_leaves::<1, false>(&mut bvh, total, precision, threshold)
        }
        PlocSearchDistance::VeryLow => {
            builder.build_ploc_from_leaves::<2, false>(&mut bvh, total, precision, threshold)
        }
        PlocSearchDistance::Low => builder.build_ploc_from_leaves::<6, false>(&mut bvh, total, precision, threshold),
        PlocSearchDistance::Medium => {
            builder.build_ploc_from_leaves::<14, false>(&mut bvh, total, precision, threshold)
        }
        PlocSearchDistance::High => builder.build_ploc_from_leaves::<24, false>(&mut bvh, total, precision, threshold),
        PlocSearchDistance::VeryHigh => {
            builder.build_ploc_from_leaves::<32, false>(&mut bvh, total, precision, threshold)
        }
    }
    drop(builder);
    let mut optimizer = ReinsertionOptimizer::default();
    let mut optimize = |bvh: &mut Bvh2, ratio: f32| {
        if ratio > 0.0 {
            optimizer.run(bvh, ratio, None);
        }
    };
    optimize(&mut bvh, params.reinsertion_batch_ratio);
    if leaf_size > 1 {
        collapse(&mut bvh, leaf_size, f32::from(u8::MAX));
        let ratio = params.reinsertion_batch_ratio * params.post_collapse_reinsertion_batch_ratio_multiplier;
        optimize(&mut bvh, ratio);
    }
    bvh
}

/// Pulls descendants up until each node has eight children, where possible, as [`Cuts`] says.
fn widen(binary: &Bvh2, unit: f64, stacks: &Stacks, leaves: &Leaves) -> Tree {
    let mut tree = Tree::default();
    let box_of = |i: usize| {
        let b = binary.nodes[i].aabb();
        let s = |v: glam::Vec3A| (glam::Vec3::from(v).as_dvec3() * unit).as_vec3();
        Bounds {
            min: s(b.min),
            max: s(b.max),
        }
    };
    let cuts = Cuts::new(binary);
    let mut primitives = Vec::new();
    // Binary node to expand, and the slot of the wide node that waits for its number.
    let mut work: Vec<(usize, Option<(usize, usize)>)> = vec![(0, None)];
    while let Some((root, waiting)) = work.pop() {
        let index = tree.nodes.len();
        if let Some((parent, slot)) = waiting {
            tree.nodes[parent].child[slot] = index as u32;
        }
        let children = cuts.children(binary, root);
        tree.nodes.push(Node::EMPTY);
        for (slot, &child) in children.iter().enumerate() {
            let from = &binary.nodes[child];
            let reference = if from.is_leaf() {
                let first = from.first_index as usize;
                let items = &binary.primitive_indices[first..first + from.prim_count as usize];
                stacks.primitives(items, &mut primitives);
                leaves.add(&mut tree, &primitives)
            } else {
                work.push((child, Some((index, slot))));
                u32::MAX
            };
            tree.nodes[index].set(slot, box_of(child), reference);
        }
    }
    tree
}

/// How leaves are made.
struct Leaves<'a> {
    /// The primitives' boxes; none where no leaf can be too full.
    bounds: &'a [Bounds],
    /// Most primitives of one.
    size: usize,
}

impl Leaves<'_> {
    /// A leaf, or where the primitives are too many for one, nodes above evenly filled leaves (depth log₈ of their number).
    fn add(&self, tree: &mut Tree, primitives: &[u32]) -> u32 {
        let size = self.size.max(1);
        if primitives.len() <= size {
            return tree.push_leaf(primitives);
        }
        let index = tree.nodes.len();
        tree.nodes.push(Node::EMPTY);
        let share = primitives.len().div_ceil(WIDTH).max(size);
        for (slot, part) in primitives.chunks(share).enumerate() {
            let child = self.add(tree, part);
            tree.nodes[index].set(slot, union(part, self.bounds), child);
        }
        index as u32
    }
}

/// Each level leaves at most seven siblings waiting.
fn stack_need(tree: &Tree) -> usize {
    let mut depth = vec![1usize; tree.nodes.len()];
    let mut deepest = 1;
    for i in 0..tree.nodes.len() {
        deepest = deepest.max(depth[i]);
        for &child in &tree.nodes[i].child {
            if child & LEAF == 0 {
                depth[child as usize] = depth[i] + 1;
            }
        }
    }
    deepest * (WIDTH - 1) + 1
}
