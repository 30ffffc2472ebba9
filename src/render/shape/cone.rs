//! Truncated cones and cylinders about the y axis between y = 0 and y = 1.

use super::Line;
use super::candidates::Candidates;
use glam::DVec3;

const WALL: u32 = 0;
const BASE: u32 = 1;
const CAP: u32 = 2;

/// Offers where the line enters and leaves the solid, or meets the wall if it is open.
///
/// The inside is the common part of the slab 0 ≤ y ≤ 1 and the infinite cone, each an interval of t: wall and caps
/// share their rim exactly, so nothing slips through between them.
pub fn intersect(r0: f64, r1: f64, open: bool, line: Line, shift: f64, found: &mut Candidates) {
    let (o, d) = (line.o, line.d);
    let slope = r1 - r0;
    let radius = r0 + slope * o.y;
    let growth = slope * d.y;
    // a·t² + 2b·t + c < 0 inside the double cone x² + z² = (r0 + slope·y)².
    let a = d.x * d.x + d.z * d.z - growth * growth;
    let b = o.x * d.x + o.z * d.z - radius * growth;
    let across = (o.x * o.x + o.z * o.z).sqrt();
    let c = (across - radius) * (across + radius);
    let from_wall = found.from == WALL;
    // A ray that left the wall to the outside cannot meet the wall again, nor the convex solid.
    if from_wall && across > radius {
        return;
    }
    if (found.from == BASE && o.y <= 0.0) || (found.from == CAP && o.y >= 1.0) {
        return;
    }
    let wall = wall_interval(a, b, c, radius, growth);
    if open {
        if let Some((near, far)) = wall {
            for t in [near, far] {
                let y = o.y + t * d.y;
                if (0.0..=1.0).contains(&y) {
                    found.offer(shift + t, WALL);
                }
            }
        }
        return;
    }
    let Some((mut enter, mut leave)) = wall else { return };
    let (mut enter_face, mut leave_face) = (WALL, WALL);
    if d.y == 0.0 {
        if !(0.0..=1.0).contains(&o.y) {
            return;
        }
    } else {
        let (t_base, t_cap) = (-o.y / d.y, (1.0 - o.y) / d.y);
        let (near, near_face, far, far_face) = if d.y > 0.0 {
            (t_base, BASE, t_cap, CAP)
        } else {
            (t_cap, CAP, t_base, BASE)
        };
        if near > enter {
            (enter, enter_face) = (near, near_face);
        }
        if far < leave {
            (leave, leave_face) = (far, far_face);
        }
    }
    if enter <= leave {
        found.offer(shift + enter, enter_face);
        found.offer(shift + leave, leave_face);
    }
}

/// The t at which the line is inside the infinite cone, on the nappe whose radius is positive; `None` if never.
fn wall_interval(a: f64, b: f64, c: f64, radius: f64, growth: f64) -> Option<(f64, f64)> {
    // A line through the apex may get a slightly negative discriminant when a < 0, where it cannot be negative.
    let disc = b * b - a * c;
    let disc = if a < 0.0 { disc.max(0.0) } else { disc };
    if disc.is_nan() || disc < 0.0 {
        return None;
    }
    let q = -(b + disc.sqrt().copysign(b));
    if a == 0.0 {
        // Parallel to a generator (or, if b = 0 too, never crossing the wall).
        if b == 0.0 {
            return (c <= 0.0 && radius >= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let t = -c / (2.0 * b);
        return Some(if b > 0.0 {
            (f64::NEG_INFINITY, t)
        } else {
            (t, f64::INFINITY)
        });
    }
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
    let (t0, t1) = if t0 <= t1 { (t0, t1) } else { (t1, t0) };
    if a < 0.0 {
        return Some(if growth > 0.0 {
            (t1, f64::INFINITY)
        } else {
            (f64::NEG_INFINITY, t0)
        });
    }
    (radius + growth * (0.5 * (t0 + t1)) >= 0.0).then_some((t0, t1))
}

/// The point of a face next to `p`, and its normal.
pub fn project(r0: f64, r1: f64, face: u32, p: DVec3) -> (DVec3, DVec3) {
    match face {
        BASE => (DVec3::new(p.x, 0.0, p.z), -DVec3::Y),
        CAP => (DVec3::new(p.x, 1.0, p.z), DVec3::Y),
        _ => {
            let y = p.y.clamp(0.0, 1.0);
            let radius = r0 + (r1 - r0) * y;
            let across = (p.x * p.x + p.z * p.z).sqrt();
            let (x, z) = if across > 0.0 {
                (p.x / across, p.z / across)
            } else {
                (1.0, 0.0)
            };
            (DVec3::new(x * radius, y, z * radius), DVec3::new(x, r0 - r1, z))
        }
    }
}
