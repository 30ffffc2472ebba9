//! Which descendants of a binary node become the children of a wide one.

use super::super::node::WIDTH;
use obvhs::bvh2::Bvh2;

/// The cheapest way to cover a subtree with at most i + 1 wide children, for each i.
#[derive(Clone, Copy)]
struct Cover {
    cost: [f32; WIDTH],
    /// How many of them lie in the left and the right half; (0, 0) for one child that is this node itself.
    halves: [(u8, u8); WIDTH],
    /// The halves when this node becomes a wide node.
    open: (u8, u8),
}

/// The cheapest cover of every binary node.
///
/// The cost of a tree is the summed area of its inner nodes, the chance that a ray which enters the root visits them.
/// Dynamic programming from the leaves up finds the optimum; taking the largest box first leaves half the slots empty.
/// Source: Ylitie, Karras & Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 2017.
pub struct Cuts(Vec<Cover>);

impl Cuts {
    /// Computes all covers.
    pub fn new(binary: &Bvh2) -> Cuts {
        let mut order = Vec::with_capacity(binary.nodes.len());
        let mut work = vec![0usize];
        while let Some(n) = work.pop() {
            order.push(n);
            let node = &binary.nodes[n];
            if !node.is_leaf() {
                work.extend([node.first_index as usize, node.first_index as usize + 1]);
            }
        }
        // Leaves cost the same in every tree, so they count as nothing.
        let leaf = Cover {
            cost: [0.0; WIDTH],
            halves: [(0, 0); WIDTH],
            open: (0, 0),
        };
        let mut covers = vec![leaf; binary.nodes.len()];
        for &n in order.iter().rev() {
            let node = &binary.nodes[n];
            if !node.is_leaf() {
                let first = node.first_index as usize;
                covers[n] = join(&covers[first], &covers[first + 1], node.aabb().half_area());
            }
        }
        Cuts(covers)
    }

    /// The children of the wide node that a binary node becomes; a leaf is its own only child.
    pub fn children(&self, binary: &Bvh2, root: usize) -> Vec<usize> {
        let mut children = Vec::with_capacity(WIDTH);
        let mut work = vec![(root, self.0[root].open)];
        while let Some((n, (left, right))) = work.pop() {
            if left == 0 {
                children.push(n);
                continue;
            }
            let first = binary.nodes[n].first_index as usize;
            for (half, count) in [(first + 1, right), (first, left)] {
                work.push((half, self.0[half].halves[usize::from(count) - 1]));
            }
        }
        children
    }
}

fn join(left: &Cover, right: &Cover, area: f32) -> Cover {
    let split = |count: usize| {
        (1..count)
            .map(|k| {
                (
                    left.cost[k - 1] + right.cost[count - k - 1],
                    (k as u8, (count - k) as u8),
                )
            })
            .fold(
                (f32::INFINITY, (1, 1)),
                |best, next| if next.0 < best.0 { next } else { best },
            )
    };
    let (below, open) = split(WIDTH);
    let mut cover = Cover {
        cost: [area + below; WIDTH],
        halves: [(0, 0); WIDTH],
        open,
    };
    for i in 1..WIDTH {
        let (cost, halves) = split(i + 1);
        // At equal cost (boxes without area) more children are better.
        (cover.cost[i], cover.halves[i]) = if cost <= cover.cost[i - 1] {
            (cost, halves)
        } else {
            (cover.cost[i - 1], cover.halves[i - 1])
        };
    }
    cover
}
