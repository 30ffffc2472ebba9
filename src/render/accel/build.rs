//! From boxes to an 8-wide tree, by way of obvhs's binary one.

use super::bounds::Bounds;
use super::node::{LEAF, Node, Tree, WIDTH};
use obvhs::bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer};
use obvhs::ploc::PlocBuilder;
use obvhs::{Boundable, BvhBuildParams, aabb::Aabb};

struct Item(Aabb);

impl Boundable for Item {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A tree over these boxes with at most `leaf_size` primitives a leaf. Empty input gives an empty tree; identical boxes,
/// flat ones and huge ones are all fine.
pub fn build_tree(bounds: &[Bounds], leaf_size: u32) -> Tree {
    if bounds.is_empty() {
        return Tree::default();
    }
    // Areas of boxes around 1e20 overflow f32, those around 1e-20 vanish: build in a friendlier unit.
    // A power of two changes no digit.
    let largest = bounds.iter().map(|b| b.largest()).fold(0.0f32, f32::max);
    let unit = if largest > 1e12 || (largest < 1e-6 && largest > 0.0) {
        power_of_two_below(f64::from(largest))
    } else {
        1.0
    };
    let items: Vec<Item> = bounds.iter().map(|b| Item(scaled(*b, 1.0 / unit))).collect();
    let binary = build_binary(&items, leaf_size);
    let mut tree = widen(&binary, unit);
    tree.stack_need = stack_need(&tree);
    tree
}

/// The largest power of two not above a positive finite number.
pub fn power_of_two_below(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) & 0x7ff;
    f64::from_bits(exponent.max(1) << 52)
}

fn scaled(b: Bounds, factor: f64) -> Aabb {
    let s = |v: glam::Vec3| (v.as_dvec3() * factor).as_vec3();
    let (mut min, mut max) = (s(b.min), s(b.max));
    if factor != 1.0 {
        // Digits lost below the smallest number must not shrink the box.
        min = glam::Vec3::from_array(min.to_array().map(f32::next_down));
        max = glam::Vec3::from_array(max.to_array().map(f32::next_up));
    }
    Aabb::new(min.into(), max.into())
}

fn build_binary(items: &[Item], leaf_size: u32) -> Bvh2 {
    let params = BvhBuildParams::medium_build();
    let mut bvh = PlocBuilder::with_capacity(items.len()).build(
        params.ploc_search_distance,
        items,
        (0..items.len() as u32).collect(),
        params.sort_precision,
        params.search_depth_threshold,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut bvh, params.reinsertion_batch_ratio, None);
    if leaf_size > 1 {
        collapse(&mut bvh, leaf_size, params.collapse_traversal_cost);
        let ratio = params.reinsertion_batch_ratio * params.post_collapse_reinsertion_batch_ratio_multiplier;
        optimizer.run(&mut bvh, ratio, None);
    }
    bvh
}

/// Pulls grandchildren up until each node has eight children, opening the largest first.
fn widen(binary: &Bvh2, unit: f64) -> Tree {
    let mut tree = Tree::default();
    let box_of = |i: usize| {
        let b = binary.nodes[i].aabb();
        let s = |v: glam::Vec3A| (glam::Vec3::from(v).as_dvec3() * unit).as_vec3();
        Bounds {
            min: s(b.min),
            max: s(b.max),
        }
    };
    // Binary node to expand, and the slot of the wide node that waits for its number.
    let mut work: Vec<(usize, Option<(usize, usize)>)> = vec![(0, None)];
    while let Some((root, waiting)) = work.pop() {
        let index = tree.nodes.len();
        if let Some((parent, slot)) = waiting {
            tree.nodes[parent].child[slot] = index as u32;
        }
        let mut children = [root; WIDTH];
        let mut count = 1;
        while count < WIDTH {
            let inner = (0..count).filter(|&i| !binary.nodes[children[i]].is_leaf());
            let area = |i: &usize| binary.nodes[children[*i]].aabb().half_area();
            let Some(open) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else {
                break;
            };
            let first = binary.nodes[children[open]].first_index as usize;
            children[open] = first;
            children[count] = first + 1;
            count += 1;
        }
        let mut node = Node::EMPTY;
        for (slot, &child) in children[..count].iter().enumerate() {
            let from = &binary.nodes[child];
            let reference = if from.is_leaf() {
                let first = from.first_index as usize;
                tree.leaves
                    .push(binary.primitive_indices[first..first + from.prim_count as usize].to_vec());
                LEAF | (tree.leaves.len() - 1) as u32
            } else {
                work.push((child, Some((index, slot))));
                u32::MAX
            };
            node.set(slot, box_of(child), reference);
        }
        tree.nodes.push(node);
    }
    tree
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
