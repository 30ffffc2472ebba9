//! Transforms of the language: degrees, row vectors, applied in the order they are written.

use glam::{DAffine3, DMat3, DVec3};

/// Sine and cosine of an angle in degrees, exact at quarter turns.
fn sin_cos_deg(deg: f64) -> (f64, f64) {
    let turn = deg % 360.0;
    match turn {
        0.0 => (0.0, 1.0),
        90.0 | -270.0 => (1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        270.0 | -90.0 => (-1.0, 0.0),
        _ => turn.to_radians().sin_cos(),
    }
}

/// Rotation about x, then y, then z. In the left-handed world y turns to z, z to x and x to y.
pub fn rotation_deg(deg: DVec3) -> DMat3 {
    let (sx, cx) = sin_cos_deg(deg.x);
    let (sy, cy) = sin_cos_deg(deg.y);
    let (sz, cz) = sin_cos_deg(deg.z);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cx, sx), DVec3::new(0.0, -sx, cx));
    let about_y = DMat3::from_cols(DVec3::new(cy, 0.0, -sy), DVec3::Y, DVec3::new(sy, 0.0, cy));
    let about_z = DMat3::from_cols(DVec3::new(cz, sz, 0.0), DVec3::new(-sz, cz, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// Rotation about an axis; `None` if the axis is 0.
pub fn rotate_about(axis: DVec3, deg: f64) -> Option<DMat3> {
    let k = (axis / axis.abs().max_element()).try_normalize()?;
    let (s, c) = sin_cos_deg(deg);
    let cross = DMat3::from_cols(
        DVec3::new(0.0, k.z, -k.y),
        DVec3::new(-k.z, 0.0, k.x),
        DVec3::new(k.y, -k.x, 0.0),
    );
    let outer = DMat3::from_cols(k * k.x, k * k.y, k * k.z);
    Some(DMat3::IDENTITY * c + cross * s + outer * (1.0 - c))
}

/// Whether a transform is finite and can be undone.
pub fn is_invertible(t: &DAffine3) -> bool {
    t.is_finite() && {
        let d = t.matrix3.determinant();
        d != 0.0 && t.inverse().is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: POV-Ray's vrotate(x,z*90) = y, vrotate(x,y*90) = −z, vrotate(y,x*90) = z.
    #[test]
    fn quarter_turns_are_left_handed_and_exact() {
        assert_eq!(rotation_deg(DVec3::Z * 90.0) * DVec3::X, DVec3::Y);
        assert_eq!(rotation_deg(DVec3::Y * 90.0) * DVec3::X, DVec3::NEG_Z);
        assert_eq!(rotation_deg(DVec3::X * 90.0) * DVec3::Y, DVec3::Z);
    }

    #[test]
    fn rotation_about_an_axis_agrees_with_the_axis_rotations() {
        for (axis, deg) in [(DVec3::X, 33.0), (DVec3::Y, -71.0), (DVec3::Z, 125.0)] {
            let (a, b) = (rotate_about(axis * 5.0, deg), rotation_deg(axis * deg));
            let off = a.map_or(1.0, |a| {
                (a * DVec3::new(1.0, 2.0, 3.0) - b * DVec3::new(1.0, 2.0, 3.0)).length()
            });
            assert!(off < 1e-14, "{axis} by {deg}: off by {off}");
        }
        assert_eq!(rotate_about(DVec3::ZERO, 10.0), None);
    }
}
