//! A binary tree from the top down, for boxes that clustering cannot sort out.
//!
//! Clustering along a space-filling curve is better and faster on what models look like. Where most boxes overlap most
//! others, or nearly all stand in one cell of the curve, it merges one pair a round (quadratic time) or at random.

use super::super::bounds::Bounds;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};

/// Fewer boxes than this are quick whatever happens.
const MANY: usize = 1024;

/// Bins per split.
const BINS: usize = 16;

/// Below this depth splits are even, so that the depth stays logarithmic.
const DEEP: usize = 48;

/// Whether these boxes are of the kind that clustering cannot sort out.
pub fn is_needed(bounds: &[Bounds]) -> bool {
    if bounds.len() < MANY {
        return false;
    }
    let total = bounds.iter().fold(Bounds::EMPTY, |a, b| a.union(*b));
    let sum: f64 = bounds.iter().map(half_area).sum();
    let overlapping = sum > bounds.len() as f64 / 32.0 * half_area(&total);
    let cell = |b: &Bounds| {
        let at = (center(b) - total.min) / (total.max - total.min) * 32767.0;
        (at.x as u64) << 32 | (at.y as u64) << 16 | at.z as u64
    };
    let mut cells: Vec<u64> = bounds.iter().map(cell).collect();
    cells.sort_unstable();
    cells.dedup();
    overlapping || cells.len() * 8 < bounds.len()
}

fn center(b: &Bounds) -> glam::Vec3 {
    b.min * 0.5 + b.max * 0.5
}

fn half_area(b: &Bounds) -> f64 {
    if b.is_empty() {
        return 0.0;
    }
    let e = (b.max - b.min).as_dvec3();
    e.x * e.y + e.y * e.z + e.z * e.x
}

fn around(items: &[u32], bounds: &[Bounds]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |a, &i| a.union(bounds[i as usize]))
}

/// A tree with at most `leaf_size` boxes a leaf.
pub fn build(bounds: &[Bounds], leaf_size: usize) -> Bvh2 {
    let mut items: Vec<u32> = (0..bounds.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    // Node to fill, its range of items, its depth.
    let mut work = vec![(0usize, 0usize, items.len(), 0usize)];
    while let Some((node, start, end, depth)) = work.pop() {
        let part = &mut items[start..end];
        let b = around(part, bounds);
        let aabb = Aabb::new(b.min.into(), b.max.into());
        if part.len() <= leaf_size.max(1) {
            nodes[node] = Bvh2Node::new(aabb, part.len() as u32, start as u32);
            continue;
        }
        let middle = start + split(part, bounds, depth >= DEEP);
        let first = nodes.len();
        nodes[node] = Bvh2Node::new(aabb, 0, first as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        work.push((first, start, middle, depth + 1));
        work.push((first + 1, middle, end, depth + 1));
    }
    Bvh2 {
        nodes,
        primitive_indices: items,
        ..Bvh2::default()
    }
}

/// Puts the items of the lower half first and returns their number, which is neither 0 nor all.
/// The cheapest of the planes between bins by the surface area heuristic, along the axis on which the centres spread most.
fn split(items: &mut [u32], bounds: &[Bounds], evenly: bool) -> usize {
    let centers = items.iter().map(|&i| center(&bounds[i as usize]));
    let (low, high) = centers.fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(a, b), c| {
        (a.min(c), b.max(c))
    });
    let spread = high - low;
    let axis = spread.max_position();
    let half = items.len() / 2;
    let at = |i: u32| center(&bounds[i as usize])[axis];
    let bin = |i: u32| (((at(i) - low[axis]) / spread[axis] * BINS as f32) as usize).min(BINS - 1);
    if spread[axis] > 0.0 && !evenly {
        let mut count = [0usize; BINS];
        let mut boxes = [Bounds::EMPTY; BINS];
        for &i in items.iter() {
            count[bin(i)] += 1;
            boxes[bin(i)] = boxes[bin(i)].union(bounds[i as usize]);
        }
        let cost = |bins: std::ops::Range<usize>| {
            let b = boxes[bins.clone()].iter().fold(Bounds::EMPTY, |a, b| a.union(*b));
            half_area(&b) * count[bins].iter().sum::<usize>() as f64
        };
        let costs = (1..BINS).map(|k| (k, cost(0..k) + cost(k..BINS)));
        let best = costs.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(1, |b| b.0);
        // Stable by index, so that the tree does not depend on the library's partition.
        items.sort_by_key(|&i| (bin(i) >= best, i));
        let lower: usize = count[..best].iter().sum();
        if lower > 0 && lower < items.len() {
            return lower;
        }
    }
    items.select_nth_unstable_by(half, |&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
    half
}
