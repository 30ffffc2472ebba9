//! Turned shapes: profiles of (radius, height) about the y axis.

use super::Surface;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Foot of the lantern.
pub const BASE: &[[f64; 2]] = &[
    [0.0, 0.0],
    [0.38, 0.0],
    [0.38, 0.05],
    [0.32, 0.07],
    [0.32, 0.12],
    [0.10, 0.15],
    [0.0, 0.15],
];
/// Its roof.
pub const ROOF: &[[f64; 2]] = &[
    [0.0, 0.0],
    [0.40, 0.0],
    [0.40, 0.03],
    [0.24, 0.16],
    [0.12, 0.20],
    [0.10, 0.26],
    [0.04, 0.28],
    [0.0, 0.28],
];
/// One of its posts.
pub const POST: &[[f64; 2]] = &[[0.025, 0.0], [0.018, 0.34], [0.025, 0.68]];
/// What glows in it.
pub const FLAME: &[[f64; 2]] = &[
    [0.0, 0.0],
    [0.07, 0.04],
    [0.11, 0.12],
    [0.10, 0.22],
    [0.05, 0.34],
    [0.0, 0.46],
];

/// Turns a profile; edges are sharp, each segment a smooth cone.
pub fn turned(profile: &[[f64; 2]], columns: u32) -> Surface {
    let mut all = Surface::default();
    for pair in profile.windows(2) {
        let (a, b) = (DVec2::from(pair[0]), DVec2::from(pair[1]));
        let slope = DVec2::new(b.y - a.y, a.x - b.x).normalize();
        let mut segment = Surface::grid(columns, 1, &move |u, v| {
            let p = a + (b - a) * v;
            // u runs clockwise seen from above, so that ∂u × ∂v points outwards.
            let (s, c) = (-TAU * u).sin_cos();
            DVec3::new(p.x * c, p.y, p.x * s)
        });
        for (i, n) in segment.normals.iter_mut().enumerate() {
            let u = (i % (columns as usize + 1)) as f64 / f64::from(columns);
            let (s, c) = (-TAU * u).sin_cos();
            *n = DVec3::new(slope.x * c, slope.y, slope.x * s);
        }
        all.append(segment);
    }
    all
}

/// A vase with a belly and a narrow neck, whose flutes turn once by a quarter on the way up; it has an inner wall.
pub fn fluted_vase(rows: u32, columns: u32) -> Surface {
    let wall = 0.035;
    let outer = |u: f64, v: f64| {
        let angle = -TAU * u;
        let belly = 0.30 + 0.34 * (std::f64::consts::PI * (0.12 + 1.05 * v)).sin().powi(2) + 0.16 * (v - 0.82).max(0.0);
        let flutes = 0.035 * (1.0 - v).min(8.0 * v).clamp(0.0, 1.0) * (10.0 * (angle + 1.6 * v)).cos();
        let r = belly + flutes;
        DVec3::new(r * angle.cos(), 1.6 * v, r * angle.sin())
    };
    let mut vase = Surface::grid(columns, rows, &outer);
    // The inner wall runs from the rim down, which keeps the winding outward (into the hollow).
    vase.append(Surface::grid(columns, rows / 2, &move |u, v| {
        let p = outer(u, 1.0 - 0.94 * v);
        let (r, y) = (p.x.hypot(p.z), p.y);
        DVec3::new(p.x, 0.0, p.z) * ((r - wall) / r) + DVec3::Y * y
    }));
    // The rim and the two floors: rings at one height, from radius r·k₀ − w₀ to r·k₁ − w₁.
    let ring = |v: f64, from: (f64, f64), to: (f64, f64)| {
        Surface::grid(columns, 1, &move |u, t| {
            let p = outer(u, v);
            let r = p.x.hypot(p.z);
            let radius = |(k, w): (f64, f64)| r * k - w;
            DVec3::new(p.x, 0.0, p.z) * ((radius(from) * (1.0 - t) + radius(to) * t) / r) + DVec3::Y * p.y
        })
    };
    vase.append(ring(1.0, (1.0, 0.0), (1.0, wall)));
    vase.append(ring(0.06, (1.0, wall), (1e-4, 0.0)));
    vase.append(ring(0.0, (1e-4, 0.0), (1.0, 0.0)));
    vase
}
