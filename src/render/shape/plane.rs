//! Unbounded planes. They stand outside every box tree.

use super::candidates::Candidates;
use glam::DVec3;

/// Offers where the line meets the plane `normal·p = distance`. Whatever the slope, only an exactly parallel line
/// has no intersection; a ray that starts on the plane cannot meet it again.
#[inline]
pub fn intersect(normal: DVec3, distance: f64, o: DVec3, d: DVec3, found: &mut Candidates) {
    if found.from == 0 {
        return;
    }
    let t = (distance - normal.dot(o)) / normal.dot(d);
    found.offer(t, 0);
}
