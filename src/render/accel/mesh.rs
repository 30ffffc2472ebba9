//! One mesh with its tree, shared by all objects that place it.

use super::bounds::Bounds;
use super::build::{build_tree, power_of_two_below};
use super::node::{LEAF, Node};
use super::simd::Isa;
use super::traverse::{BoxRay, Leaf, traverse};
use super::triangle::{LANES, Line, ShearedRay, TriangleBlock, distance};
use crate::math::robust::gamma;
use crate::render::shape::candidates::Candidates;
use crate::render::technique::BuildPreset;
use glam::Vec3;

/// Triangles ready to be hit, in a unit in which the largest coordinate is between 1 and 2, so that
/// products of three lengths stay within f32 whatever the scene's own unit.
#[derive(Clone, Debug, Default)]
pub struct MeshTree {
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
    stack_need: usize,
    /// Size of the tree's unit in the mesh's own; a power of two.
    pub unit: f64,
}

impl MeshTree {
    /// Builds the tree. Triangles with corners that do not exist or are not finite are left out.
    pub fn build(positions: &[Vec3], triangles: &[[u32; 3]], preset: BuildPreset) -> MeshTree {
        let finite = positions.iter().filter(|p| p.is_finite());
        let largest = finite.fold(0.0f32, |m, p| m.max(p.abs().max_element()));
        let unit = if largest > 0.0 {
            power_of_two_below(f64::from(largest))
        } else {
            1.0
        };
        let corner = |i: u32| {
            let p = positions.get(i as usize).filter(|p| p.is_finite())?;
            Some((p.as_dvec3() / unit).as_vec3())
        };
        let corners = |id: u32| {
            let [a, b, c] = triangles[id as usize];
            Some([corner(a)?, corner(b)?, corner(c)?])
        };
        // Which triangle each box is of, from the first one on that is left out.
        let mut ids: Option<Vec<u32>> = None;
        let mut bounds: Vec<Bounds> = Vec::with_capacity(triangles.len());
        for id in 0..triangles.len() as u32 {
            match corners(id) {
                Some(corners) => {
                    ids.iter_mut().for_each(|ids| ids.push(id));
                    bounds.push(Bounds::around(&corners));
                }
                None => {
                    ids.get_or_insert_with(|| (0..id).collect());
                }
            }
        }
        let tree = build_tree(bounds, LANES as u32, preset);
        let pack = |leaf: &[u32]| {
            let ids = leaf.iter().map(|&i| ids.as_ref().map_or(i, |ids| ids[i as usize]));
            let few: Vec<_> = ids.filter_map(|id| Some((id, corners(id)?))).collect();
            TriangleBlock::new(&few)
        };
        MeshTree {
            blocks: tree.leaves().map(pack).collect(),
            nodes: tree.nodes,
            stack_need: tree.stack_need,
            unit,
        }
    }

    /// The boxes of the root's children, which together hold the mesh more tightly than one box.
    pub fn coarse_bounds(&self) -> impl Iterator<Item = Bounds> + '_ {
        let root = self.nodes.first();
        root.into_iter()
            .flat_map(|n| (0..super::node::WIDTH).map(|i| n.bounds(i)))
            .filter(|b| !b.is_empty())
    }

    /// Memory that the tree takes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }

    /// Offers the triangles that a ray in the tree's unit meets; with `any` it ends at the first that counts.
    #[inline(always)]
    pub fn intersect<I: Isa>(&self, line: Line, any: bool, found: &mut Candidates) -> bool {
        let (line, shift) = nearer(line);
        let mut leaf = Triangles {
            blocks: &self.blocks,
            ray: ShearedRay::new(line, shift),
            any,
        };
        let boxes = BoxRay::new(line.o.as_vec3(), line.d.as_vec3(), 2.0);
        if shift == 0.0 {
            return traverse::<I>(&self.nodes, self.stack_need, &boxes, found, &mut leaf);
        }
        found.start_boxes_at(shift);
        let ended = traverse::<I>(&self.nodes, self.stack_need, &boxes, found, &mut leaf);
        found.start_boxes_at(0.0);
        ended
    }

    /// Offers one triangle, given by its number and its corners in the mesh's own unit, to a ray that is aimed at it: where
    /// it meets the plane. Returns how far in front of it a
    /// ray may seem to meet its neighbours in the same plane: edge functions and corners are rounded to f32, which
    /// moves the ray and the surface against each other by up to γ(16) of their extent, and along the ray by 1/cos as much.
    #[inline(always)]
    pub fn intersect_one(&self, line: Line, id: u32, corners: [Vec3; 3], found: &mut Candidates) -> f64 {
        let (line, shift) = nearer(line);
        let corners = corners.map(|p| (p.as_dvec3() / self.unit).as_vec3());
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        if id != found.from {
            let axis = line.d.abs().max_position();
            let t = distance(&line, axis, [a, b, c].map(|p| p.to_array()));
            found.offer(shift + t, id);
        }
        let n = (b - a).cross(c - a);
        let across = f64::from(gamma(16)) * (line.o.length() + 8.0) * n.length();
        across / n.dot(line.d).abs()
    }

    /// Takes the path for trees deeper than the stack.
    #[cfg(test)]
    pub fn pretend_deep(&mut self) {
        self.stack_need = 1000;
    }

    /// Levels of the tree.
    #[cfg(test)]
    pub fn depth(&self) -> usize {
        self.stack_need.saturating_sub(1) / (super::node::WIDTH - 1)
    }

    /// Tests every triangle.
    #[cfg(test)]
    pub fn intersect_by_force(&self, line: Line, found: &mut Candidates) {
        let (line, shift) = nearer(line);
        let ray = ShearedRay::new(line, shift);
        self.blocks.iter().for_each(|block| ray.intersect(block, found));
    }
}

/// A ray that comes from far away, started again nearby, and where along it that is. In f32 its start would be off by
/// the rounding of the way, which may be more than the mesh is large; coordinates of the mesh do not exceed 2.
#[inline(always)]
fn nearer(line: Line) -> (Line, f64) {
    const FAR: f64 = 64.0;
    const REACH: f64 = 4.0;
    if line.o.length_squared() <= FAR * FAR {
        return (line, 0.0);
    }
    let length = line.d.length();
    let shift = -line.o.dot(line.d) / (length * length) - REACH / length;
    if shift > 0.0 {
        let o = line.o + line.d * shift;
        (Line { o, d: line.d }, shift)
    } else {
        (line, 0.0) // it runs away from the mesh
    }
}

struct Triangles<'a> {
    blocks: &'a [TriangleBlock],
    ray: ShearedRay,
    any: bool,
}

impl Leaf for Triangles<'_> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, found: &mut Candidates) -> bool {
        debug_assert!(leaf & LEAF == 0);
        self.ray.intersect(&self.blocks[leaf as usize], found);
        self.any && found.found()
    }
}
