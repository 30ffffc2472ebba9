//! Which descendants of a binary node become the children of a wide one.

use super::super::node::WIDTH;
use obvhs::bvh2::Bvh2;

/// What the cheapest cover of a subtree with at most i + 1 wide children costs, for each i.
type Costs = [f32; WIDTH];

/// How many wide children lie in the left and the right half, in four bits each; 0 for one child that is the node itself.
type Halves = u8;

/// The cheapest way to cover a subtree.
#[derive(Clone, Copy, Default)]
struct Cover {
    /// With at most i + 1 wide children, for each i.
    halves: [Halves; WIDTH],
    /// When this node becomes a wide node.
    open: Halves,
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
        let mut order: Vec<u32> = Vec::with_capacity(binary.nodes.len());
        let mut work = vec![0u32];
        while let Some(n) = work.pop() {
            order.push(n);
            let node = &binary.nodes[n as usize];
            if !node.is_leaf() {
                work.extend([node.first_index, node.first_index + 1]);
            }
        }
        let mut covers = vec![Cover::default(); binary.nodes.len()];
        // Backwards, both halves of a node come right before it: their costs are the last two.
        let mut costs: Vec<Costs> = Vec::new();
        for &n in order.iter().rev() {
            let node = &binary.nodes[n as usize];
            if node.is_leaf() {
                // Leaves cost the same in every tree, so they count as nothing.
                costs.push([0.0; WIDTH]);
            } else if let (Some(right), Some(left)) = (costs.pop(), costs.pop()) {
                let (cover, cost) = join(&left, &right, node.aabb().half_area());
                covers[n as usize] = cover;
                costs.push(cost);
            }
        }
        Cuts(covers)
    }

    /// The children of the wide node that a binary node becomes; a leaf is its own only child.
    pub fn children(&self, binary: &Bvh2, root: usize) -> Vec<usize> {
        let mut children = Vec::with_capacity(WIDTH);
        let mut work = vec![(root, self.0[root].open)];
        while let Some((n, halves)) = work.pop() {
            let (left, right) = (halves >> 4, halves & 15);
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

fn join(left: &Costs, right: &Costs, area: f32) -> (Cover, Costs) {
    let split = |count: usize| {
        (1..count)
            .map(|k| (left[k - 1] + right[count - k - 1], (k << 4 | (count - k)) as Halves))
            .fold(
                (f32::INFINITY, 0x11),
                |best, next| if next.0 < best.0 { next } else { best },
            )
    };
    let (below, open) = split(WIDTH);
    let mut cost = [area + below; WIDTH];
    let mut halves = [0; WIDTH];
    for i in 1..WIDTH {
        let (split_cost, split_halves) = split(i + 1);
        // At equal cost (boxes without area) more children are better.
        (cost[i], halves[i]) = if split_cost <= cost[i - 1] {
            (split_cost, split_halves)
        } else {
            (cost[i - 1], halves[i - 1])
        };
    }
    (Cover { halves, open }, cost)
}
