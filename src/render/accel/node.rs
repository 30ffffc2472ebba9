//! The 8-wide tree.

use super::bounds::Bounds;

/// Children of a node.
pub const WIDTH: usize = 8;

/// Marks a child reference as a leaf; the rest of the number is the leaf's.
pub const LEAF: u32 = 1 << 31;

/// An inner node: the boxes of its children by plane, so that one plane of all children is one vector.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// Planes by `2·axis + side`, side 0 the lower one; empty children have no points.
    pub planes: [[f32; WIDTH]; 6],
    /// Node index, or leaf with [`LEAF`] set.
    pub child: [u32; WIDTH],
    /// The slots in use, as bits. Their boxes keep sensible rays off the others; rays that overflow or are not numbers
    /// meet every box.
    pub used: u32,
}

impl Node {
    /// A node without children.
    pub const EMPTY: Node = Node {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        child: [u32::MAX; WIDTH],
        used: 0,
    };

    /// Fills one slot.
    pub fn set(&mut self, slot: usize, bounds: Bounds, child: u32) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.child[slot] = child;
        self.used |= 1 << slot;
    }

    /// The box of a slot.
    pub fn bounds(&self, slot: usize) -> Bounds {
        let plane = |i: usize| self.planes[i][slot];
        Bounds {
            min: glam::Vec3::new(plane(0), plane(2), plane(4)),
            max: glam::Vec3::new(plane(1), plane(3), plane(5)),
        }
    }
}

/// A tree over numbered primitives.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Nodes, the root first, parents before children; none without primitives.
    pub nodes: Vec<Node>,
    /// Primitives, leaf after leaf.
    pub primitives: Vec<u32>,
    /// Where each leaf's primitives end.
    pub leaf_ends: Vec<u32>,
    /// Entries a traversal may have waiting at most.
    pub stack_need: usize,
}

impl Tree {
    /// The primitives of each leaf in turn.
    pub fn leaves(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.leaf_ends.iter().copied());
        starts
            .zip(&self.leaf_ends)
            .map(|(start, &end)| &self.primitives[start as usize..end as usize])
    }

    /// Adds a leaf and returns the reference to it.
    pub fn push_leaf(&mut self, primitives: &[u32]) -> u32 {
        self.primitives.extend_from_slice(primitives);
        self.leaf_ends.push(self.primitives.len() as u32);
        LEAF | (self.leaf_ends.len() as u32 - 1)
    }
}
