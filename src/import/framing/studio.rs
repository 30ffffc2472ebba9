//! The light of a small studio as an environment picture: a bright room, a large warm softbox behind the camera's
//! left shoulder, a cool strip behind the model, a neutral floor. The middle of the picture is where the camera
//! looks.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Columns of the picture.
pub(super) const WIDTH: u32 = 256;
/// Rows of the picture.
pub(super) const HEIGHT: u32 = 128;
/// What camera rays see instead of the studio.
pub(super) const BACKDROP: f64 = 0.72;
/// Mean radiance over all directions: what is white and faces the camera then comes out near 0.9, its mean near 0.8.
const MEAN: f64 = 0.65;

/// A rectangular lamp far away with soft edges.
struct Softbox {
    /// Degrees to the right of the picture's middle, and above the horizon.
    azimuth: f64,
    elevation: f64,
    /// Half width and half height as tangents.
    half: DVec2,
    radiance: DVec3,
}

const SOFTBOXES: [Softbox; 3] = [
    // Key.
    Softbox {
        azimuth: -135.0,
        elevation: 45.0,
        half: DVec2::new(0.55, 0.45),
        radiance: DVec3::new(7.0, 6.5, 5.9),
    },
    // Rim.
    Softbox {
        azimuth: 48.0,
        elevation: 32.0,
        half: DVec2::new(0.22, 0.6),
        radiance: DVec3::new(4.2, 4.8, 5.6),
    },
    // Fill.
    Softbox {
        azimuth: 110.0,
        elevation: 20.0,
        half: DVec2::new(0.5, 0.5),
        radiance: DVec3::new(1.3, 1.3, 1.35),
    },
];

/// The picture, row by row from the top, linear radiance.
pub(super) fn picture() -> Vec<[f32; 3]> {
    let mut pixels: Vec<DVec3> = Vec::with_capacity((WIDTH * HEIGHT) as usize);
    let (mut sum, mut weights) = (0.0, 0.0);
    for row in 0..HEIGHT {
        let polar = (f64::from(row) + 0.5) / f64::from(HEIGHT) * PI;
        for column in 0..WIDTH {
            let azimuth = ((f64::from(column) + 0.5) / f64::from(WIDTH) - 0.5) * TAU;
            let direction = direction(azimuth, PI / 2.0 - polar);
            let value = radiance(direction);
            sum += polar.sin() * value.element_sum() / 3.0;
            weights += polar.sin();
            pixels.push(value);
        }
    }
    let scale = MEAN * weights / sum;
    pixels.iter().map(|p| (*p * scale).as_vec3().to_array()).collect()
}

/// Radiance before scaling: dome and floor meet softly at the horizon, and the softboxes shine in front of both.
fn radiance(direction: DVec3) -> DVec3 {
    let dome = DVec3::splat(0.5).lerp(DVec3::new(0.78, 0.8, 0.83), direction.y.max(0.0));
    let floor = DVec3::new(0.32, 0.315, 0.31);
    let room = floor.lerp(dome, smoothstep(-0.12, 0.12, direction.y));
    SOFTBOXES
        .iter()
        .fold(room, |sum, lamp| sum + lamp.radiance * lamp.cover(direction))
}

impl Softbox {
    /// How much of the direction the lamp covers, [0, 1].
    fn cover(&self, direction: DVec3) -> f64 {
        let (azimuth, elevation) = (self.azimuth.to_radians(), self.elevation.to_radians());
        let (axis, right) = (
            self::direction(azimuth, elevation),
            self::direction(azimuth + PI / 2.0, 0.0),
        );
        let depth = direction.dot(axis);
        if depth <= 0.0 {
            return 0.0;
        }
        let up = right.cross(axis);
        let at = DVec2::new(direction.dot(right), direction.dot(up)).abs() / depth;
        let inside = |x: f64, half: f64| 1.0 - smoothstep(half - 0.06, half + 0.06, x);
        inside(at.x, self.half.x) * inside(at.y, self.half.y)
    }
}

/// A unit vector by its angle to the right of −z and above the horizon, y up.
fn direction(azimuth: f64, elevation: f64) -> DVec3 {
    let (sin, cos) = azimuth.sin_cos();
    DVec3::new(sin * elevation.cos(), elevation.sin(), -cos * elevation.cos())
}

fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a white diffuse surface of this normal shows: E/π by summing over the pixels.
    fn white(normal: DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (i, p) in picture().iter().enumerate() {
            let (row, column) = (i as u32 / WIDTH, i as u32 % WIDTH);
            let polar = (f64::from(row) + 0.5) / f64::from(HEIGHT) * PI;
            let azimuth = ((f64::from(column) + 0.5) / f64::from(WIDTH) - 0.5) * TAU;
            let cos = direction(azimuth, PI / 2.0 - polar).dot(normal).max(0.0);
            let solid_angle = polar.sin() * (PI / f64::from(HEIGHT)) * (TAU / f64::from(WIDTH));
            sum += DVec3::from_array(p.map(f64::from)) * cos * solid_angle / PI;
        }
        sum
    }

    #[test]
    fn a_white_object_is_bright_but_not_burnt_out_and_shaded_from_left_to_right() {
        let to_camera = direction(PI, 0.3);
        let facing = white(to_camera).element_sum() / 3.0;
        assert!((0.7..1.0).contains(&facing), "{facing}");
        let (left, right) = (white(direction(-0.7 * PI, 0.5)), white(direction(0.6 * PI, 0.0)));
        assert!(left.y > 1.3 * right.y, "{left} {right}");
        assert!(left.y < 1.5 && right.y > 0.25, "{left} {right}");
        assert!(left.x > left.z, "the key is warm: {left}");
        let below = white(DVec3::NEG_Y);
        assert!(below.y < 0.5 * facing, "{below}");
    }
}
