//! A handful of spheres, tested together: faster than any tree, and large spheres overlap everything anyway.

use crate::render::ray::{PrimRef, Ray};
use crate::render::shape::candidates::{Candidates, comparable};
use crate::render::shape::sphere;
use glam::DVec3;

/// Spheres tested at a time.
const LANES: usize = 4;

/// More spheres than this go into the tree.
pub const FEW: usize = 16;

/// Four spheres by coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Block {
    center: [[f64; LANES]; 3],
    radius_squared: [f64; LANES],
    /// Object numbers as floats, so that they compare in the same vector unit.
    object: [f64; LANES],
    visibility: [u64; LANES],
}

/// The list. Spheres are in ascending order of their objects.
#[derive(Clone, Debug, Default)]
pub struct SphereList {
    blocks: Vec<Block>,
    count: usize,
}

impl SphereList {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Adds a sphere; objects must come in ascending order.
    pub fn push(&mut self, object: u32, center: DVec3, radius: f64, visibility: u8) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.blocks.push(Block {
                center: [[0.0; LANES]; 3],
                radius_squared: [-1.0; LANES], // met by nothing
                object: [-1.0; LANES],
                visibility: [0; LANES],
            });
        }
        if let Some(block) = self.blocks.last_mut() {
            for axis in 0..3 {
                block.center[axis][lane] = center[axis];
            }
            block.radius_squared[lane] = radius * radius;
            block.object[lane] = f64::from(object);
            block.visibility[lane] = u64::from(visibility);
        }
        self.count += 1;
    }

    /// Offers the nearest sphere.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, found: &mut Candidates) {
        let (o, d) = (ray.origin.as_dvec3().to_array(), ray.direction().to_array());
        let dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let inv_dd = 1.0 / dd;
        // A sphere has one face, 0; other faces mean none of these.
        let named = |p: PrimRef| if p.prim == 0 { f64::from(p.object) } else { -2.0 };
        let (from, to) = (named(ray.from), named(ray.to));
        let mask = u64::from(ray.mask);
        let mut nearest = [found.exact; LANES];
        let mut object = [-1.0f64; LANES];
        for block in &self.blocks {
            for i in 0..LANES {
                let f = [
                    o[0] - block.center[0][i],
                    o[1] - block.center[1][i],
                    o[2] - block.center[2][i],
                ];
                let t = sphere::distance(f, d, dd, inv_dd, block.radius_squared[i], block.object[i] == from);
                let t = comparable(t);
                let seen = (block.visibility[i] & mask != 0) & (block.object[i] != to);
                let better = seen & (t > 0.0) & ((t < nearest[i]) | ((t == nearest[i]) & (object[i] < 0.0)));
                nearest[i] = if better { t } else { nearest[i] };
                object[i] = if better { block.object[i] } else { object[i] };
            }
        }
        // The best lane, without branches: the nearest, of equals the lowest object.
        let (mut best, mut which) = (nearest[0], object[0]);
        for i in 1..LANES {
            let (t, o) = (nearest[i], object[i]);
            let met = o >= 0.0;
            let take = met & ((t < best) | (which < 0.0) | ((t == best) & (o < which)));
            best = if take { t } else { best };
            which = if take { o } else { which };
        }
        if which >= 0.0 {
            found.object = which as u32;
            found.to = u32::MAX;
            found.offer(best, 0);
        }
    }
}
