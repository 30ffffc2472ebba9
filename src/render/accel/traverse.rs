//! Walking an 8-wide tree, nearest child first.

use super::node::{LEAF, Node, WIDTH};
use super::simd::{Baseline, BoxTest, Isa};
use crate::math::robust::{UNIT_ROUNDOFF, gamma};
use crate::render::shape::candidates::Candidates;
use glam::Vec3;

/// What the walk does at a leaf.
pub trait Leaf {
    /// Tests the primitives of a leaf; returns whether the walk may end.
    fn visit(&mut self, leaf: u32, found: &mut Candidates) -> bool;
}

/// A ray as boxes see it.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay {
    /// Start as seen by the planes where the ray enters, by axis; moved against the ray by the padding.
    near_origin: [f32; 3],
    /// Start as seen by the planes where the ray leaves, moved along the ray.
    far_origin: [f32; 3],
    /// 1/direction; infinite where the direction is 0, with the sign of that zero.
    inverse: [f32; 3],
    /// The same, a little larger: covers the rounding of the quotients.
    far_inverse: [f32; 3],
    /// Which plane of each axis is entered.
    near_plane: [usize; 3],
}

impl BoxRay {
    /// Prepares a ray for boxes whose coordinates do not exceed `extent`.
    ///
    /// Boxes are padded by the rounding of the primitives' own tests: a triangle may claim a ray that passes beside its
    /// box by a few units in the last place of the distance between them, while its neighbour gives that ray up.
    /// Padding the ray's origin pads all boxes at once.
    #[inline(always)]
    pub fn new(origin: Vec3, dir: Vec3, extent: f32) -> BoxRay {
        let pad = 8.0 * UNIT_ROUNDOFF * (origin.abs().max_element() + extent);
        let (o, d) = (origin.to_array(), dir.to_array());
        let mut ray = BoxRay {
            near_origin: o,
            far_origin: o,
            inverse: [0.0; 3],
            far_inverse: [0.0; 3],
            near_plane: [0; 3],
        };
        for axis in 0..3 {
            ray.inverse[axis] = 1.0 / d[axis];
            ray.far_inverse[axis] = ray.inverse[axis] * (1.0 + 2.0 * gamma(4));
            let backwards = d[axis].is_sign_negative();
            let toward = if backwards { -pad } else { pad };
            ray.near_origin[axis] = o[axis] + toward;
            ray.far_origin[axis] = o[axis] - toward;
            ray.near_plane[axis] = 2 * axis + usize::from(backwards);
        }
        ray
    }

    /// The set of children of a node that are hit not beyond `t_max`, and where each is entered.
    ///
    /// 0·∞ gives NaN where an axis-parallel ray runs in a plane; what the other axes say then stands, which errs on the
    /// safe side. Source: Ize, Robust BVH Ray Traversal, JCGT 2013.
    #[inline(always)]
    fn meet<I: Isa>(&self, node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
        let [x, y, z] = self.near_plane;
        let planes = &node.planes;
        I::meet(&BoxTest {
            entered: [&planes[x], &planes[y], &planes[z]],
            left: [&planes[x ^ 1], &planes[y ^ 1], &planes[z ^ 1]],
            near_origin: &self.near_origin,
            far_origin: &self.far_origin,
            inverse: &self.inverse,
            far_inverse: &self.far_inverse,
            t_max,
        })
    }
}

/// Waiting entries that fit on the machine's stack; deeper trees use the heap.
const STACK: usize = 96;

/// Visits every leaf whose box the ray meets not beyond the best hit, roughly from near to far. `need` is the tree's
/// `stack_need`. Returns whether a visit ended the walk.
#[inline(always)]
pub fn traverse<I: Isa>(
    nodes: &[Node],
    need: usize,
    ray: &BoxRay,
    found: &mut Candidates,
    leaf: &mut impl Leaf,
) -> bool {
    if nodes.is_empty() {
        return false;
    }
    if need <= STACK {
        walk::<I>(nodes, ray, found, leaf, &mut [0; STACK])
    } else {
        walk_on_heap(nodes, need, ray, found, leaf)
    }
}

/// For trees so deep that speed is lost anyway.
#[cold]
fn walk_on_heap(nodes: &[Node], need: usize, ray: &BoxRay, found: &mut Candidates, leaf: &mut impl Leaf) -> bool {
    walk::<Baseline>(nodes, ray, found, leaf, &mut vec![0; need])
}

/// Entries are the entry distance's bits above the child reference: non-negative floats order like their bits.
#[inline(always)]
fn walk<I: Isa>(nodes: &[Node], ray: &BoxRay, found: &mut Candidates, leaf: &mut impl Leaf, stack: &mut [u64]) -> bool {
    let mut waiting = 0;
    let mut current = 0u32;
    loop {
        if current & LEAF != 0 {
            if leaf.visit(current & !LEAF, found) {
                return true;
            }
        } else {
            let node = &nodes[current as usize];
            let (hits, near) = ray.meet::<I>(node, found.t);
            let hits = hits & node.used;
            let mut hits_left = hits;
            let mut next = || {
                let i = hits_left.trailing_zeros() as usize & (WIDTH - 1);
                hits_left &= hits_left.wrapping_sub(1);
                let entry = u64::from(near[i].to_bits()) << 32 | u64::from(node.child[i]);
                (entry, hits_left == 0)
            };
            if hits != 0 {
                // Mostly one or two children are met; the nearest is walked without waiting.
                let (mut nearest, mut last) = next();
                let base = waiting;
                while !last {
                    let entry;
                    (entry, last) = next();
                    let far = nearest.max(entry);
                    nearest = nearest.min(entry);
                    // Insertion keeps the nearer on top; there are at most seven.
                    let mut at = waiting;
                    while at > base && stack[at - 1] < far {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = far;
                    waiting += 1;
                }
                current = nearest as u32;
                continue;
            }
        }
        loop {
            if waiting == 0 {
                return false;
            }
            waiting -= 1;
            let entry = stack[waiting];
            // Equal distances are still visited: a lower primitive may tie.
            if f32::from_bits((entry >> 32) as u32) <= found.t {
                current = entry as u32;
                break;
            }
        }
    }
}
