//! Colour in linear Rec. 709 RGB.

use glam::{DVec3, Vec3};

/// Weights of the luminance of linear Rec. 709 RGB.
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Luminance of a linear colour.
pub fn luminance(c: Vec3) -> f32 {
    c.dot(LUMINANCE)
}

/// Luminance in double precision.
pub fn luminance_f64([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Display value in [0, 1] to linear, IEC 61966-2-1; values outside continue the curve, oddly below 0.
pub fn linear_from_srgb(v: f64) -> f64 {
    let a = v.abs();
    let l = if a <= 0.04045 {
        a / 12.92
    } else {
        ((a + 0.055) / 1.055).powf(2.4)
    };
    l.copysign(v)
}

/// Linear to display value, the inverse of [`linear_from_srgb`].
pub fn srgb_from_linear(v: f64) -> f64 {
    let a = v.abs();
    let s = if a <= 0.003_130_8 {
        a * 12.92
    } else {
        1.055 * a.powf(1.0 / 2.4) - 0.055
    };
    s.copysign(v)
}

/// [`linear_from_srgb`] of each component.
pub fn linear_from_srgb_rgb(c: DVec3) -> DVec3 {
    DVec3::new(linear_from_srgb(c.x), linear_from_srgb(c.y), linear_from_srgb(c.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_back_is_the_identity() {
        for i in 0..=255 {
            let v = f64::from(i) / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(v)) - v).abs() < 1e-7);
        }
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-6); // IEC 61966-2-1
    }
}
