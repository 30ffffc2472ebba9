//! Four triangles at a time, watertight.

use crate::render::shape::candidates::Candidates;
use glam::{DVec3, Vec2, Vec3, Vec4};

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
    shear: [f32; 2],
    /// The ray before it was rounded.
    exact: Line,
    /// Where it starts, counted from the start of the ray in the world.
    shift: f64,
}

/// A ray in the mesh's space: through `o` along `d`.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Start.
    pub o: DVec3,
    /// Direction, of any length.
    pub d: DVec3,
}

impl ShearedRay {
    /// Prepares a ray; a zero direction meets nothing.
    #[inline(always)]
    pub fn new(line: Line, shift: f64) -> ShearedRay {
        let (origin, dir) = (line.o.as_vec3(), line.d.as_vec3());
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
            shear: [d[x] / d[z], d[y] / d[z]],
            exact: line,
            shift,
        }
    }

    /// Offers the triangles of a block that the ray meets.
    ///
    /// Both triangles at an edge form the same products from the same sheared corners, so one of them takes the ray; where
    /// an f32 edge function is exactly 0 its sign is decided in f64. No fused operations: they would treat the
    /// two neighbours differently. Only an exactly zero determinant is refused, so that small triangles stay.
    /// Only which triangle it is comes from f32; where, from the ray before it was rounded ([`distance`]).
    /// Source: Woop, Benthin & Wald, Watertight Ray/Triangle Intersection, JCGT 2013.
    #[inline(always)]
    pub fn intersect(&self, block: &TriangleBlock, found: &mut Candidates) {
        let [kx, ky, kz] = self.axes;
        let o = self.origin;
        let mut xs = [Vec4::ZERO; 3];
        let mut ys = [Vec4::ZERO; 3];
        for k in 0..3 {
            let c = &block.corners[k];
            let z = c[kz] - o[kz];
            xs[k] = (c[kx] - o[kx]) - z * self.shear[0];
            ys[k] = (c[ky] - o[ky]) - z * self.shear[1];
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
        // Lines that pass far beside a small mesh overflow: sums that are no numbers have no sign and are no hits.
        let det = u + v + w;
        let sensible = det.abs().cmplt(Vec4::INFINITY).bitmask();
        let inv = Vec4::ONE / det;
        let (b1, b2) = (v * inv, w * inv);
        let mut hits = !beside & sensible & ALL_LANES;
        while hits != 0 {
            let i = hits.trailing_zeros() as usize & (LANES - 1);
            hits &= hits - 1;
            let id = block.ids[i];
            if id == found.from {
                continue; // flat: a ray cannot come back to it
            }
            let mut b = Vec2::new(b1[i], b2[i]);
            if doubtful >> i & 1 != 0 || !b.is_finite() {
                match on_an_edge(xs.map(|x| x[i]), ys.map(|y| y[i])) {
                    Some(in_f64) if in_f64.is_finite() => b = in_f64,
                    _ => continue,
                }
            }
            let corners = block.corners.map(|c| c.map(|axis| f64::from(axis[i])));
            found.offer_at(self.shift + distance(&self.exact, kz, corners), id, b);
        }
    }
}

/// Where the ray meets the plane of a triangle that it is known to pass through; `axis` is the direction's largest.
///
/// In f64, where a ray that starts beside the plane by the rounding of a coordinate is still on the right side of it, however
/// large the triangle: no offset has to cover the rounding of the triangle's size. Edge-on, where the plane does
/// not say, the corners do: the distance is at most the triangle's own depth away from them.
#[inline(always)]
pub fn distance(line: &Line, axis: usize, corners: [[f64; 3]; 3]) -> f64 {
    let [v0, v1, v2] = corners.map(DVec3::from_array);
    let n = (v1 - v0).cross(v2 - v0);
    let along = n.dot(line.d);
    let t = n.dot(v0 - line.o) / along;
    const EDGE_ON: f64 = 1e-16; // the square of a cosine; 10⁵ roundings of f64 are left at 1e-8
    if along * along > EDGE_ON * n.length_squared() * line.d.length_squared() {
        return t;
    }
    let depth = |v: DVec3| (v[axis] - line.o[axis]) / line.d[axis];
    let (a, b, c) = (depth(v0), depth(v1), depth(v2));
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let room = high - low;
    // The order of arguments sends a NaN to the nearest corner.
    t.max(low - room).min(high + room)
}

/// The test in f64, where products of f32 are exact.
#[cold]
fn on_an_edge(x: [f32; 3], y: [f32; 3]) -> Option<Vec2> {
    let (x, y) = (x.map(f64::from), y.map(f64::from));
    let edge = |a: usize, b: usize| x[b] * y[a] - y[b] * x[a];
    let (u, v, w) = (edge(1, 2), edge(2, 0), edge(0, 1));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    if det == 0.0 {
        return None;
    }
    Some(Vec2::new((v / det) as f32, (w / det) as f32))
}
