//! Shapes that are not turned: a torus knot, a ring, a box.

use super::Surface;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// The (p, q) torus knot as a tube with a slow twist of its oval cross-section.
pub fn knot(p: u32, q: u32, along: u32, around: u32) -> Surface {
    let (p, q) = (f64::from(p), f64::from(q));
    let curve = move |t: f64| {
        let (a, b) = (TAU * p * t, TAU * q * t);
        let r = 1.0 + 0.42 * b.cos();
        DVec3::new(r * a.cos(), 0.42 * b.sin() * 1.15, r * a.sin())
    };
    Surface::grid(around, along, &move |u, v| {
        let h = 1e-4;
        let tangent = (curve(v + h) - curve(v - h)).normalize();
        // The frame leans on the direction away from the torus' centre line: closed by construction.
        let a = TAU * p * v;
        let out = curve(v) - DVec3::new(a.cos(), 0.0, a.sin());
        let side = (out - tangent * out.dot(tangent)).normalize();
        let angle = TAU * u;
        let (s, c) = angle.sin_cos();
        let radius = 0.17 * (1.0 + 0.12 * (3.0 * angle + 12.0 * TAU * v).cos());
        curve(v) + (side * c + tangent.cross(side) * s) * radius
    })
}

/// A ring standing in the xy plane.
pub fn ring(major: f64, minor: f64, along: u32, around: u32) -> Surface {
    Surface::grid(along, around, &move |u, v| {
        let ((s, c), (t, d)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        DVec3::new((major + minor * d) * c, (major + minor * d) * s, minor * t)
    })
}

/// A box about the origin; each side face shows the whole texture upright.
pub fn cuboid(size: [f64; 3]) -> Surface {
    let half = DVec3::from(size) * 0.5;
    let mut s = Surface::default();
    // Normal, and the directions of growing u and of the top of the picture, seen from outside.
    let faces = [
        (DVec3::Z, DVec3::X, DVec3::Y),
        (DVec3::X, DVec3::NEG_Z, DVec3::Y),
        (DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y),
        (DVec3::NEG_X, DVec3::Z, DVec3::Y),
        (DVec3::Y, DVec3::X, DVec3::NEG_Z),
        (DVec3::NEG_Y, DVec3::X, DVec3::Z),
    ];
    for (normal, right, up) in faces {
        let first = s.positions.len() as u32;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            s.positions.push((normal + right * x + up * y) * half);
            s.normals.push(normal);
            s.uvs.push(DVec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y));
        }
        s.quads.push([first, first + 1, first + 2, first + 3]);
    }
    s
}

/// A ball about the origin, poles on the y axis, u once around from +z by +x; the seam closes to the bit.
pub fn ball(radius: f64, around: u32, down: u32) -> Surface {
    let mut s = Surface::default();
    for j in 0..=down {
        for i in 0..=around {
            let (u, v) = (f64::from(i) / f64::from(around), f64::from(j) / f64::from(down));
            let (sin, cos) = (TAU * f64::from(i % around) / f64::from(around)).sin_cos();
            let ring = if j == 0 || j == down {
                0.0
            } else {
                (0.5 * TAU * v).sin()
            };
            let n = DVec3::new(ring * sin, (0.5 * TAU * v).cos(), ring * cos);
            s.positions.push(n * radius);
            s.normals.push(n);
            s.uvs.push(DVec2::new(u, v));
        }
    }
    for j in 0..down {
        for i in 0..around {
            let a = j * (around + 1) + i;
            s.quads.push([a + around + 1, a + around + 2, a + 1, a]);
        }
    }
    s
}
