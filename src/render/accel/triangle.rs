//! Four triangles at a time, watertight.

use crate::render::shape::candidates::Candidates;
use glam::{Vec2, Vec3, Vec4};

/// Triangles of a leaf.
pub const LANES: usize = 4;

const ALL_LANES: u32 = (1 << LANES) - 1;

/// Up to four triangles by coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct TriangleBlock {
    /// Coordinates by corner and axis, one lane a triangle.
    pub corners: [[Vec4; 3]; 3],
    /// Triangle numbers; unused lanes repeat a used one.
    pub ids: [u32; LANES],
}

impl TriangleBlock {
    /// Packs one to four triangles. Free lanes repeat the last one, which changes no answer.
    pub fn new(triangles: &[(u32, [Vec3; 3])]) -> TriangleBlock {
        let mut block = TriangleBlock {
            corners: [[Vec4::ZERO; 3]; 3],
            ids: [u32::MAX; LANES],
        };
        for lane in 0..LANES {
            let Some((id, corners)) = triangles.get(lane.min(triangles.len().saturating_sub(1))) else {
                break;
            };
            block.ids[lane] = *id;
            for (k, corner) in corners.iter().enumerate() {
                for axis in 0..3 {
                    block.corners[k][axis][lane] = corner[axis];
                }
            }
        }
        block
    }
}

/// A ray in the space in which it runs along +z from the origin.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    origin: [f32; 3],
    /// Axes that become x, y and z; z is the direction's largest.
    axes: [usize; 3],
    shear: [f32; 3],
}

impl ShearedRay {
    /// Prepares a ray; a zero direction meets nothing.
    #[inline(always)]
    pub fn new(origin: Vec3, dir: Vec3) -> ShearedRay {
        let a = dir.abs();
        let z = if a.x >= a.y && a.x >= a.z {
            0
        } else if a.y >= a.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let d = dir.to_array();
        ShearedRay {
            origin: origin.to_array(),
            axes: [x, y, z],
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        }
    }

    /// Offers the triangles of a block that the ray meets.
    ///
    /// Both triangles at an edge form the same products from the same sheared corners, so one of them takes the ray; where
    /// an f32 edge function is exactly 0 its sign is decided in f64. No fused operations: they would treat the
    /// two neighbours differently. Only an exactly zero determinant is refused, so that small triangles stay.
    /// t is formed from the barycentric coordinates, which keeps it in range where a determinant times a length is not.
    /// Source: Woop, Benthin & Wald, Watertight Ray/Triangle Intersection, JCGT 2013.
    #[inline(always)]
    pub fn intersect(&self, block: &TriangleBlock, found: &mut Candidates) {
        let [kx, ky, kz] = self.axes;
        let o = self.origin;
        let mut xs = [Vec4::ZERO; 3];
        let mut ys = [Vec4::ZERO; 3];
        let mut zs = [Vec4::ZERO; 3];
        for k in 0..3 {
            let c = &block.corners[k];
            let z = c[kz] - o[kz];
            xs[k] = (c[kx] - o[kx]) - z * self.shear[0];
            ys[k] = (c[ky] - o[ky]) - z * self.shear[1];
            zs[k] = z * self.shear[2];
        }
        // The edge opposite a corner runs from the next corner to the one after.
        let edge = |a: usize, b: usize| xs[b] * ys[a] - ys[b] * xs[a];
        let (u, v, w) = (edge(1, 2), edge(2, 0), edge(0, 1));
        let zero = Vec4::ZERO;
        let below = u.cmplt(zero) | v.cmplt(zero) | w.cmplt(zero);
        let above = u.cmpgt(zero) | v.cmpgt(zero) | w.cmpgt(zero);
        let beside = (below & above).bitmask();
        if beside == ALL_LANES {
            return;
        }
        let doubtful = (u.cmpeq(zero) | v.cmpeq(zero) | w.cmpeq(zero)).bitmask();
        let inv = Vec4::ONE / (u + v + w);
        let (b1, b2) = (v * inv, w * inv);
        let t = u * inv * zs[0] + b1 * zs[1] + b2 * zs[2];
        let wanted = (t.cmpgt(zero) & t.cmple(Vec4::splat(found.t))).bitmask();
        let mut hits = !beside & (wanted | doubtful) & ALL_LANES;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize & (LANES - 1);
            hits &= hits - 1;
            let id = block.ids[i];
            if id == found.from {
                continue; // flat: a ray cannot come back to it
            }
            if doubtful >> i & 1 == 0 {
                found.offer_rounded(t[i], id, Vec2::new(b1[i], b2[i]));
            } else if let Some((t, b)) = on_an_edge(xs.map(|x| x[i]), ys.map(|y| y[i]), zs.map(|z| z[i])) {
                found.offer_rounded(t, id, b);
            }
        }
    }
}

/// The test in f64, where products of f32 are exact.
#[cold]
fn on_an_edge(x: [f32; 3], y: [f32; 3], z: [f32; 3]) -> Option<(f32, Vec2)> {
    let (x, y, z) = (x.map(f64::from), y.map(f64::from), z.map(f64::from));
    let edge = |a: usize, b: usize| x[b] * y[a] - y[b] * x[a];
    let (u, v, w) = (edge(1, 2), edge(2, 0), edge(0, 1));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    if det == 0.0 {
        return None;
    }
    let (b0, b1, b2) = (u / det, v / det, w / det);
    let t = b0 * z[0] + b1 * z[1] + b2 * z[2];
    Some((t as f32, Vec2::new(b1 as f32, b2 as f32)))
}
