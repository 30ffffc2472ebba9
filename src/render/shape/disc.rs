//! The flat ring in y = 0.

use super::Line;
use super::candidates::Candidates;
use glam::DVec3;

/// Offers the intersection with the unit disc outside its hole.
pub fn intersect(hole: f64, line: Line, shift: f64, found: &mut Candidates) {
    if found.from == 0 {
        return; // a flat face cannot be hit from itself
    }
    let t = -line.o.y / line.d.y;
    let (x, z) = (line.o.x + t * line.d.x, line.o.z + t * line.d.z);
    let r2 = x * x + z * z;
    if r2 <= 1.0 && r2 >= hole * hole {
        found.offer(shift + t, 0);
    }
}

/// The point of the disc's plane under `p`, and the normal.
pub fn project(p: DVec3) -> (DVec3, DVec3) {
    (DVec3::new(p.x, 0.0, p.z), DVec3::Y)
}
