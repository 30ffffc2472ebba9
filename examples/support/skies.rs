//! Environments in code: equirectangular EXR files, the centre towards +z of a text scene, columns to the right.

use exr::prelude::*;
use glam::DVec3;
use std::path::Path;

/// Writes a sky of 256×128 half floats.
pub fn write(path: &Path, sky: fn(DVec3) -> DVec3) -> std::io::Result<()> {
    let (width, height) = (256usize, 128usize);
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let longitude = ((at.x() as f64 + 0.5) / width as f64 - 0.5) * std::f64::consts::TAU;
        let latitude = (0.5 - (at.y() as f64 + 0.5) / height as f64) * std::f64::consts::PI;
        let ((s, c), (t, d)) = (longitude.sin_cos(), latitude.sin_cos());
        let [r, g, b] = sky(DVec3::new(s * d, t, c * d)).to_array().map(f16::from_f64);
        (r, g, b)
    });
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    let written = Image::from_layer(layer).write().to_file(path);
    written.map_err(std::io::Error::other)
}

/// 1 within `inner` degrees of the axis, falling smoothly to 0 at `outer`.
fn glow(d: DVec3, axis: DVec3, inner: f64, outer: f64) -> f64 {
    let angle = d.angle_between(axis).to_degrees();
    let t = ((outer - angle) / (outer - inner)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A soft rectangle: |longitude − at| and |latitude − at| within half sizes, in degrees.
fn panel(d: DVec3, at: [f64; 2], half: [f64; 2]) -> f64 {
    let longitude = d.x.atan2(d.z).to_degrees();
    let latitude = d.y.clamp(-1.0, 1.0).asin().to_degrees();
    let turn = (longitude - at[0] + 540.0).rem_euclid(360.0) - 180.0;
    let edge = |x: f64, half: f64| ((half - x.abs()) / 4.0 + 0.5).clamp(0.0, 1.0);
    edge(turn, half[0]) * edge(latitude - at[1], half[1])
}

/// A photographer's studio: a large panel left, a cool strip right, one overhead, grey elsewhere.
pub fn studio(d: DVec3) -> DVec3 {
    let grey = DVec3::splat(0.10 + 0.10 * (0.5 + 0.5 * d.y));
    grey + DVec3::new(1.0, 0.96, 0.90) * (5.0 * panel(d, [-105.0, 30.0], [28.0, 26.0]))
        + DVec3::new(0.75, 0.87, 1.0) * (4.0 * panel(d, [105.0, 20.0], [9.0, 38.0]))
        + DVec3::splat(3.0) * (glow(d, DVec3::new(0.0, 1.0, -0.35).normalize(), 16.0, 22.0))
        + DVec3::new(1.0, 0.9, 0.8) * (1.2 * panel(d, [20.0, 14.0], [16.0, 5.0]))
}

/// The sky a quarter of an hour after sunset, still with a low red sun to the left.
pub fn dusk(d: DVec3) -> DVec3 {
    let (zenith, middle, horizon) = (
        DVec3::new(0.020, 0.045, 0.130),
        DVec3::new(0.16, 0.17, 0.28),
        DVec3::new(0.85, 0.40, 0.17),
    );
    let up = d.y.max(0.0).sqrt();
    let mut sky = if up < 0.45 {
        horizon.lerp(middle, up / 0.45)
    } else {
        middle.lerp(zenith, (up - 0.45) / 0.55)
    };
    if d.y < 0.0 {
        sky = horizon.lerp(DVec3::new(0.03, 0.028, 0.03), (-12.0 * d.y).min(1.0));
    }
    let sun = DVec3::new(-0.80, 0.10, 0.59).normalize();
    sky + DVec3::new(1.0, 0.45, 0.16) * (30.0 * glow(d, sun, 2.5, 4.5) + 0.8 * glow(d, sun, 2.0, 35.0).powi(2))
}
