//! Axis-aligned boxes, flat ones included.

use super::Line;
use super::candidates::Candidates;
use glam::DVec3;

/// Offers where the line enters and leaves the box. The box is the common part of three slabs, so that neighbouring
/// faces share their edge exactly and nothing slips through.
pub fn intersect(min: DVec3, max: DVec3, line: Line, shift: f64, found: &mut Candidates) {
    let (mut enter, mut enter_face) = (f64::NEG_INFINITY, 0);
    let (mut leave, mut leave_face) = (f64::INFINITY, 0);
    for axis in 0..3 {
        let (o, d) = (line.o[axis], line.d[axis]);
        let low = 2 * axis as u32;
        if d == 0.0 {
            if o < min[axis] || o > max[axis] {
                return;
            }
            continue;
        }
        let (t_low, t_high) = ((min[axis] - o) / d, (max[axis] - o) / d);
        // Of the two coincident faces of a flat box the lower number counts, whatever the direction.
        let flat = min[axis] == max[axis];
        let (near, near_face, far, far_face) = if d > 0.0 || flat {
            (t_low, low, t_high, if flat { low } else { low + 1 })
        } else {
            (t_high, low + 1, t_low, low)
        };
        if near > enter || (near == enter && near_face < enter_face) {
            (enter, enter_face) = (near, near_face);
        }
        if far < leave || (far == leave && far_face < leave_face) {
            (leave, leave_face) = (far, far_face);
        }
    }
    if enter > leave || starts_outside(min, max, found.from, line.o) {
        return;
    }
    found.offer(shift + enter, enter_face);
    found.offer(shift + leave, leave_face);
}

/// Whether the ray starts on face `from` and beyond it: it left a convex solid, which it cannot meet again.
fn starts_outside(min: DVec3, max: DVec3, from: u32, o: DVec3) -> bool {
    let Some(axis) = (from < 6).then_some((from / 2) as usize) else {
        return false;
    };
    // The faces of a flat box are one sheet: a ray from it never returns.
    min[axis] == max[axis]
        || if from.is_multiple_of(2) {
            o[axis] <= min[axis]
        } else {
            o[axis] >= max[axis]
        }
}

/// The point of a face next to `p`, and its normal.
pub fn project(min: DVec3, max: DVec3, face: u32, p: DVec3) -> (DVec3, DVec3) {
    let axis = (face / 2).min(2) as usize;
    let mut q = p.max(min).min(max);
    let mut n = DVec3::ZERO;
    (q[axis], n[axis]) = if face.is_multiple_of(2) {
        (min[axis], -1.0)
    } else {
        (max[axis], 1.0)
    };
    (q, n)
}
