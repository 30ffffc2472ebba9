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
    /// |T·Tᵗ − I| ≤ 8u for every n that is a unit vector but for rounding, (0, 0, −1) included: 3u are n's own.
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
    use super::super::robust::{UNIT_ROUNDOFF, try_normalize};
    use super::super::stats::Pcg;
    use super::super::warp::uniform_sphere;
    use super::*;

    /// |T·Tᵗ − I| of the frame, each product in f64; the normal itself is what it is.
    fn off_orthonormal(n: Vec3) -> f64 {
        let f = Frame::from_normal(n);
        let [t, b, n] = [f.t, f.b, f.n].map(Vec3::as_dvec3);
        let products = [t.dot(b), b.dot(n), t.dot(n), t.dot(t) - 1.0, b.dot(b) - 1.0];
        assert!(
            (t.cross(b) - n).length() < 16.0 * f64::from(UNIT_ROUNDOFF),
            "{n}: not right-handed"
        );
        products.into_iter().fold(0.0, |worst, p| worst.max(p.abs()))
    }

    /// Catalogue of hard cases H 46, for every unit normal; the poles, both signs of a zero, the normals around −z where
    /// the textbook's frame divides by almost nothing, and a million others. A rounded unit vector is off by 3u in the
    /// square of its length; an entry has five roundings, of which two entries in a product make 10u at worst.
    #[test]
    fn frames_are_orthonormal_everywhere() {
        let mut rng = Pcg::new(46);
        let mut normals = vec![Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y];
        for zero in [0.0f32, -0.0] {
            for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.6, 0.8), (zero, 1.0)] {
                normals.push(Vec3::new(x, y, zero));
            }
            normals.extend([1.0, -1.0].map(|z| Vec3::new(zero, -zero, z)));
        }
        for exponent in 1..=45 {
            let tilt = 10f32.powi(-exponent);
            for z in [1.0, -1.0] {
                normals.extend([(1.0, 0.0), (-0.3, 0.9), (0.0, -1.0)].map(|(x, y)| Vec3::new(x * tilt, y * tilt, z)));
            }
        }
        normals.extend((0..1_000_000).map(|_| uniform_sphere(rng.next_vec2())));
        let mut worst = (0.0, Vec3::Z);
        for n in normals.into_iter().filter_map(try_normalize) {
            let off = off_orthonormal(n);
            if off.is_nan() || off > worst.0 {
                worst = (off, n);
            }
        }
        assert!(
            worst.0 <= 8.0 * f64::from(UNIT_ROUNDOFF),
            "{} u at {}",
            worst.0 / f64::from(UNIT_ROUNDOFF),
            worst.1
        );
    }

    /// The x axis lies in the plane of the tangent; a tangent along the normal, or none, gives some frame all the same.
    #[test]
    fn a_tangent_that_says_nothing_does_no_harm() {
        let n = Vec3::new(0.48, 0.6, 0.64);
        for tangent in [Vec3::ZERO, n, -n, n * 1e-20, Vec3::splat(f32::NAN)] {
            let f = Frame::from_normal_and_tangent(n, tangent);
            assert!(
                (f.t.length() - 1.0).abs() < 1e-6 && f.t.dot(n).abs() < 1e-6,
                "{tangent}: {f:?}"
            );
        }
        for scale in [1e-30, 1.0, 1e30] {
            let f = Frame::from_normal_and_tangent(n, (n + Vec3::X) * scale);
            assert!(
                f.t.x > 0.5 && f.t.dot(n).abs() < 1e-6 && (f.b - n.cross(f.t)).length() < 1e-6,
                "{f:?}"
            );
        }
    }
}
