//! Orthonormal frames around a normal.

use glam::Vec3;

/// A right-handed orthonormal frame; `n` is its z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x.
    pub t: Vec3,
    /// Local y.
    pub b: Vec3,
    /// Local z.
    pub n: Vec3,
}

impl Frame {
    /// A frame whose z axis is the unit vector `n`; x and y are arbitrary but depend on `n` alone.
    /// |T·Tᵗ − I| ≤ 4u for every unit n, (0, 0, −1) included.
    /// Source: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017.
    pub fn from_normal(n: Vec3) -> Frame {
        let sign = 1.0f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Frame {
            t: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            b: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// A frame around `n` whose x axis is as close to `tangent` as it can be; arbitrary if they are parallel.
    pub fn from_normal_and_tangent(n: Vec3, tangent: Vec3) -> Frame {
        match super::robust::try_normalize(tangent - n * n.dot(tangent)) {
            Some(t) => Frame { t, b: n.cross(t), n },
            None => Frame::from_normal(n),
        }
    }

    /// World to local.
    pub fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.t), v.dot(self.b), v.dot(self.n))
    }

    /// Local to world.
    pub fn to_world(self, v: Vec3) -> Vec3 {
        self.t * v.x + self.b * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_also_at_the_poles() {
        let tiny = Vec3::new(3e-4, -2e-5, -1.0).normalize();
        for n in [
            Vec3::Z,
            -Vec3::Z,
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::X,
            tiny,
            Vec3::splat(-1.0).normalize(),
        ] {
            let f = Frame::from_normal(n);
            for (a, b, want) in [
                (f.t, f.b, 0.0),
                (f.b, f.n, 0.0),
                (f.t, f.n, 0.0),
                (f.t, f.t, 1.0),
                (f.b, f.b, 1.0),
            ] {
                assert!((a.dot(b) - want).abs() <= 4e-7, "{n}: {}", a.dot(b));
            }
            assert!((f.t.cross(f.b) - f.n).length() < 1e-6);
        }
    }
}
