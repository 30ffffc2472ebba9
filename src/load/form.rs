//! How a shape has to be moved, turned and stretched to become another of its kind.

use crate::math::robust::try_normalize_f64;
use crate::scene::Shape;
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Ratios that should be equal are, up to the rounding of the few operations that made them.
const SAME: f64 = 1e-12;

/// The affine map that makes `from` into `to`, in the shapes' own space; `None` if there is none, for meshes and groups.
pub fn map(from: &Shape, to: &Shape) -> Option<DAffine3> {
    if from == to {
        return Some(DAffine3::IDENTITY);
    }
    let map = match (from, to) {
        (Shape::Sphere { center: a, radius: r }, Shape::Sphere { center: b, radius: s }) => {
            about(*a, DMat3::from_diagonal(DVec3::splat(s / r)), *b)
        }
        (Shape::Plane { normal, distance }, Shape::Plane { normal: n, distance: d }) => {
            about(*normal * *distance, turn(*normal, *n)?, *n * *d)
        }
        (Shape::Box { min, max }, Shape::Box { min: low, max: high }) => {
            let (size, other) = (*max - *min, *high - *low);
            let stretch = |a: f64, b: f64| match (a == 0.0, b == 0.0) {
                (true, true) => Some(1.0),
                (false, false) => Some(b / a),
                _ => None,
            };
            let stretch = DVec3::new(
                stretch(size.x, other.x)?,
                stretch(size.y, other.y)?,
                stretch(size.z, other.z)?,
            );
            about(*min, DMat3::from_diagonal(stretch), *low)
        }
        (
            Shape::Cone {
                base,
                base_radius,
                cap,
                cap_radius,
                open,
            },
            Shape::Cone {
                base: base2,
                base_radius: base_radius2,
                cap: cap2,
                cap_radius: cap_radius2,
                open: open2,
            },
        ) => {
            let wide = ratio([*base_radius, *cap_radius], [*base_radius2, *cap_radius2])?;
            let (axis, other) = (*cap - *base, *cap2 - *base2);
            let along = other.length() / axis.length();
            if open != open2 {
                return None;
            }
            let axis = try_normalize_f64(axis)?;
            // Across the axis by the radii, along it by the lengths.
            let outer = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
            let stretch = DMat3::IDENTITY * wide + outer * (along - wide);
            about(*base, turn(axis, try_normalize_f64(other)?)? * stretch, *base2)
        }
        (
            Shape::Disc {
                center,
                normal,
                radius,
                hole_radius,
            },
            Shape::Disc {
                center: center2,
                normal: normal2,
                radius: radius2,
                hole_radius: hole_radius2,
            },
        ) => {
            let wide = ratio([*radius, *hole_radius], [*radius2, *hole_radius2])?;
            about(*center, turn(*normal, *normal2)? * wide, *center2)
        }
        (Shape::Torus { major, minor }, Shape::Torus { major: a, minor: b }) => {
            DAffine3::from_scale(DVec3::splat(ratio([*major, *minor], [*a, *b])?))
        }
        (Shape::Triangle { vertices, .. }, Shape::Triangle { vertices: to, .. }) => {
            let frame = |[a, b, c]: [DVec3; 3]| {
                let normal = try_normalize_f64((b - a).cross(c - a))?;
                Some(DMat3::from_cols(b - a, c - a, normal))
            };
            about(vertices[0], frame(*to)? * frame(*vertices)?.inverse(), to[0])
        }
        _ => return None,
    };
    map.is_finite().then_some(map)
}

/// The map with this linear part that takes `a` to `b`.
fn about(a: DVec3, linear: DMat3, b: DVec3) -> DAffine3 {
    // Where nothing is turned or stretched the translation alone is exact.
    DAffine3::from_mat3_translation(
        linear,
        if linear == DMat3::IDENTITY {
            b - a
        } else {
            b - linear * a
        },
    )
}

/// The smallest rotation that takes one unit vector to another.
fn turn(a: DVec3, b: DVec3) -> Option<DMat3> {
    if a == b {
        return Some(DMat3::IDENTITY);
    }
    let turn = DMat3::from_quat(DQuat::from_rotation_arc(try_normalize_f64(a)?, try_normalize_f64(b)?));
    turn.is_finite().then_some(turn)
}

/// The one factor between two pairs of lengths ≥ 0; `None` if there is none.
fn ratio(from: [f64; 2], to: [f64; 2]) -> Option<f64> {
    let factor = if from[0] > from[1] {
        to[0] / from[0]
    } else {
        to[1] / from[1]
    };
    let off = |i: usize| (to[i] - factor * from[i]).abs() <= SAME * to[i].abs();
    (factor > 0.0 && factor.is_finite() && off(0) && off(1)).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goes(from: &Shape, to: &Shape, points: &[(DVec3, DVec3)]) {
        let map = map(from, to).expect("there is a map");
        for (a, b) in points {
            let found = map.transform_point3(*a);
            assert!(
                (found - *b).length() < 1e-12 * (1.0 + b.length()),
                "{a} goes to {found}, not {b}"
            );
        }
    }

    #[test]
    fn shapes_go_to_where_their_points_are() {
        let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 2.0));
        let sphere = |center, radius| Shape::Sphere { center, radius };
        goes(
            &sphere(a, 2.0),
            &sphere(b, 3.0),
            &[(a, b), (a + DVec3::X * 2.0, b + DVec3::X * 3.0)],
        );
        let block = |min, max| Shape::Box { min, max };
        let (c, d) = (a + DVec3::new(1.0, 0.0, 2.0), b + DVec3::new(3.0, 0.0, 1.0));
        goes(&block(a, c), &block(b, d), &[(a, b), (c, d)]);
        let cone = |base, cap, r0, r1| Shape::Cone {
            base,
            base_radius: r0,
            cap,
            cap_radius: r1,
            open: false,
        };
        let (n, m) = (DVec3::Y, DVec3::new(0.6, 0.8, 0.0));
        goes(
            &cone(a, a + n * 2.0, 1.0, 0.0),
            &cone(b, b + m * 5.0, 3.0, 0.0),
            &[(a, b), (a + n * 2.0, b + m * 5.0), (a + DVec3::Z, b + DVec3::Z * 3.0)],
        );
        let plane = |normal, distance| Shape::Plane { normal, distance };
        goes(
            &plane(n, 2.0),
            &plane(m, -1.0),
            &[(n * 2.0, m * -1.0), (n * 2.0 + DVec3::Z, DVec3::Z - m)],
        );
        let disc = |center, normal, radius| Shape::Disc {
            center,
            normal,
            radius,
            hole_radius: radius * 0.25,
        };
        goes(
            &disc(a, n, 2.0),
            &disc(b, m, 1.0),
            &[(a, b), (a + n * 2.0, b + m), (a + DVec3::Z, b + DVec3::Z * 0.5)],
        );
        goes(
            &Shape::Torus { major: 2.0, minor: 0.5 },
            &Shape::Torus { major: 4.0, minor: 1.0 },
            &[(a, a * 2.0)],
        );
        let triangle = |vertices| Shape::Triangle {
            vertices,
            normals: None,
        };
        let (t, u) = ([a, b, n], [m, a, -b]);
        goes(&triangle(t), &triangle(u), &[(t[0], u[0]), (t[1], u[1]), (t[2], u[2])]);
    }

    #[test]
    fn a_move_alone_is_exact() {
        let sphere = |x| Shape::Sphere {
            center: DVec3::X * x,
            radius: 0.3,
        };
        assert_eq!(
            map(&sphere(0.1), &sphere(7.3)),
            Some(DAffine3::from_translation(DVec3::X * (7.3 - 0.1)))
        );
    }

    #[test]
    fn what_changes_its_form_has_no_map() {
        let torus = |minor| Shape::Torus { major: 2.0, minor };
        assert_eq!(map(&torus(0.5), &torus(0.6)), None);
        let flat = |x| Shape::Box {
            min: DVec3::ZERO,
            max: DVec3::new(x, 1.0, 1.0),
        };
        assert_eq!(map(&flat(0.0), &flat(1.0)), None);
        let cone = |r| Shape::Cone {
            base: DVec3::ZERO,
            base_radius: 1.0,
            cap: DVec3::Y,
            cap_radius: r,
            open: false,
        };
        assert_eq!(map(&cone(0.0), &cone(0.5)), None);
        assert_eq!(map(&cone(0.5), &torus(0.5)), None);
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        let triangle = |vertices| Shape::Triangle {
            vertices,
            normals: None,
        };
        assert_eq!(map(&triangle(line), &triangle([DVec3::ZERO, DVec3::Y, DVec3::X])), None);
    }
}
