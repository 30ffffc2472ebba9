//! One mesh with its tree, shared by all objects that place it.

use super::bounds::Bounds;
use super::build::{build_tree, power_of_two_below};
use super::node::{LEAF, Node};
use super::simd::Isa;
use super::traverse::{BoxRay, Leaf, traverse};
use super::triangle::{LANES, Line, ShearedRay, TriangleBlock, distance};
use crate::math::robust::{UNIT_ROUNDOFF, gamma};
use crate::render::bend::Bend;
use crate::render::shape::candidates::Candidates;
use crate::render::technique::BuildPreset;
use glam::Vec3;
use std::sync::Arc;

/// Triangles ready to be hit, in a unit in which the largest coordinate is between 1 and 2, so that
/// products of three lengths stay within f32 whatever the scene's own unit.
#[derive(Clone, Debug, Default)]
pub struct MeshTree {
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
    stack_need: usize,
    /// Size of the tree's unit in the mesh's own; a power of two.
    pub unit: f64,
    /// Instead of blocks, for a mesh that changes its form.
    bending: Option<Box<Bending>>,
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
            bending: None,
        }
    }

    /// The same for a mesh that changes its form: boxes hold triangles on all their way.
    pub fn build_bending(bend: Arc<Bend>, triangles: &[[u32; 3]], preset: BuildPreset) -> MeshTree {
        let points = bend.forms().iter().flat_map(|f| &f.positions);
        let largest = points.fold(0.0f32, |m, p| m.max(p.abs().max_element()));
        let unit = match largest > 0.0 {
            true => power_of_two_below(f64::from(largest)),
            false => 1.0,
        };
        let is_there = |t: &[u32; 3]| bend.corners_at(*t, 0.0).is_some();
        let ids: Vec<u32> = (0..triangles.len() as u32)
            .filter(|i| is_there(&triangles[*i as usize]))
            .collect();
        let on_its_way = |id: &u32| {
            let corners = triangles[*id as usize];
            let points = bend
                .forms()
                .iter()
                .flat_map(|f| corners.map(|c| f.positions[c as usize]));
            let points: Vec<Vec3> = points.map(|p| in_unit(p, unit)).collect();
            // Between two forms the difference, its share and the sum are rounded: by 5 units of the largest coordinate.
            Bounds::around(&points).padded(8.0 * UNIT_ROUNDOFF)
        };
        let bounds: Vec<Bounds> = ids.iter().map(on_its_way).collect();
        let tree = build_tree(bounds, LANES as u32, preset);
        let pack = |leaf: &[u32]| {
            let mut few = [u32::MAX; LANES];
            few.iter_mut().zip(leaf).for_each(|(to, i)| *to = ids[*i as usize]);
            few
        };
        let bending = Bending {
            leaves: tree.leaves().map(pack).collect(),
            bend,
            triangles: triangles.to_vec(),
        };
        MeshTree {
            blocks: Vec::new(),
            nodes: tree.nodes,
            stack_need: tree.stack_need,
            unit,
            bending: Some(Box::new(bending)),
        }
    }

    /// Whether it changes its form: rays then need to tell their time.
    pub fn bends(&self) -> bool {
        self.bending.is_some()
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
        let of_bending = |b: &Bending| size_of_val(&b.leaves[..]) + size_of_val(&b.triangles[..]);
        let bending = self.bending.as_deref().map_or(0, of_bending);
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..]) + bending
    }

    /// As [`MeshTree::intersect`] for a mesh that changes its form, at a time in [0, 1].
    #[inline(always)]
    pub fn intersect_at<I: Isa>(&self, line: Line, time: f32, any: bool, found: &mut Candidates) -> bool {
        let Some(bending) = self.bending.as_deref() else {
            return self.intersect::<I>(line, any, found);
        };
        let (line, shift) = nearer(line);
        let mut leaf = Bent {
            bending,
            unit: self.unit,
            time,
            ray: ShearedRay::new(line, shift),
            any,
        };
        let boxes = BoxRay::new(line.o.as_vec3(), line.d.as_vec3(), 2.0);
        found.start_boxes_at(shift);
        let ended = traverse::<I>(&self.nodes, self.stack_need, &boxes, found, &mut leaf);
        found.start_boxes_at(0.0);
        ended
    }

    /// Offers the triangles that a ray in the tree's unit meets; with `any` it ends at the first that counts. The mesh must
    /// not bend.
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
        let corners = corners.map(|p| in_unit(p, self.unit));
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

    /// Tests every triangle where it is at a time.
    #[cfg(test)]
    pub fn intersect_by_force(&self, line: Line, time: f32, found: &mut Candidates) {
        let (line, shift) = nearer(line);
        let ray = ShearedRay::new(line, shift);
        if let Some(bending) = self.bending.as_deref() {
            let leaves = 0..bending.leaves.len();
            leaves.for_each(|i| ray.intersect(&bending.block(i, self.unit, time), found));
        }
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

/// A length of the mesh in the unit of its tree; a power of two, which changes no digit.
#[inline(always)]
fn in_unit(p: Vec3, unit: f64) -> Vec3 {
    (p.as_dvec3() / unit).as_vec3()
}

/// Triangles on their way, gathered by leaves.
#[derive(Clone, Debug)]
struct Bending {
    bend: Arc<Bend>,
    triangles: Vec<[u32; 3]>,
    /// Triangle numbers; `u32::MAX` fills up.
    leaves: Vec<[u32; LANES]>,
}

impl Bending {
    /// The triangles of a leaf where they are at a time.
    #[inline(always)]
    fn block(&self, leaf: usize, unit: f64, time: f32) -> TriangleBlock {
        let mut few = [(0, [Vec3::ZERO; 3]); LANES];
        let mut count = 0;
        for id in self.leaves[leaf].into_iter().filter(|id| *id != u32::MAX) {
            if let Some(corners) = self.bend.corners_at(self.triangles[id as usize], time) {
                few[count] = (id, corners.map(|p| in_unit(p, unit)));
                count += 1;
            }
        }
        TriangleBlock::new(&few[..count])
    }
}

struct Bent<'a> {
    bending: &'a Bending,
    unit: f64,
    time: f32,
    ray: ShearedRay,
    any: bool,
}

impl Leaf for Bent<'_> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, found: &mut Candidates) -> bool {
        debug_assert!(leaf & LEAF == 0);
        let block = self.bending.block(leaf as usize, self.unit, self.time);
        self.ray.intersect(&block, found);
        self.any && found.found()
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
