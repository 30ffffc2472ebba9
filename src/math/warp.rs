//! Maps from the unit square to the domains that are sampled, with their densities.

use super::portable::{sin_cos_octant, sin_cos_turns};
use super::robust::sqrt_of_nonnegative;
use glam::{Vec2, Vec3};

/// 1/π.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;

/// A point of the unit disc, uniform in area; density 1/π. Concentric: neighbours stay neighbours.
/// Source: Shirley & Chiu, A Low Distortion Map Between Disk and Square, JGT 1997.
pub fn disc_concentric(u: Vec2) -> Vec2 {
    concentric(u).0
}

/// The point of the disc and its (signed) radius, without a branch that the processor could guess wrong.
#[inline(always)]
fn concentric(u: Vec2) -> (Vec2, f32) {
    let p = u * 2.0 - Vec2::ONE;
    let along_x = p.x.abs() > p.y.abs();
    let r = if along_x { p.x } else { p.y };
    let other = if along_x { p.y } else { p.x };
    let angle = std::f32::consts::FRAC_PI_4 * (other / if r == 0.0 { 1.0 } else { r });
    let (s, c) = sin_cos_octant(angle);
    let (near, far) = (r * c, r * s);
    let x = if along_x { near } else { far };
    let y = if along_x { far } else { near };
    (Vec2::new(x, y), r)
}

/// A direction about +z with density cos θ/π. The cosine is ≥ 0 and may be 0.
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (d, r) = concentric(u);
    d.extend(sqrt_of_nonnegative((1.0 - r) * (1.0 + r)))
}

/// A direction uniform over the sphere; density 1/(4π).
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = 2.0 * sqrt_of_nonnegative(u.x * (1.0 - u.x));
    let (s, c) = sin_cos_turns(u.y);
    Vec3::new(r * c, r * s, z)
}

/// A direction uniform over the cone about +z with `one_minus_cos` = 1 − cos θmax; density 1/(2π·one_minus_cos).
/// Given as 1 − cos because for a narrow cone the cosine itself has no digits left.
pub fn uniform_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let x = u.x * one_minus_cos;
    let r = sqrt_of_nonnegative(x * (2.0 - x));
    let (s, c) = sin_cos_turns(u.y);
    Vec3::new(r * c, r * s, 1.0 - x)
}

/// Barycentric coordinates (b1, b2) of a point uniform over a triangle; b0 = 1 − b1 − b2 ≥ 0.
/// Source: Heitz, A Low-Distortion Map Between Triangle and Square, 2019.
pub fn triangle(u: Vec2) -> Vec2 {
    if u.y > u.x {
        let x = u.x * 0.5;
        Vec2::new(x, u.y - x)
    } else {
        let y = u.y * 0.5;
        Vec2::new(u.x - y, y)
    }
}

#[cfg(test)]
mod tests {
    use super::super::robust::UNIT_ROUNDOFF;
    use super::super::stats::{Pcg, chi2_uniform_grid};
    use super::*;

    /// χ² of each map against its density, after mapping back to a square in which it must be uniform.
    #[test]
    fn maps_have_the_densities_they_claim() {
        let turn = |y: f32, x: f32| (y.atan2(x) / std::f32::consts::TAU).rem_euclid(1.0);
        let check = |name: &str, back: &dyn Fn(Vec2) -> Vec2| {
            let p = chi2_uniform_grid(7, 200_000, 16, back);
            assert!(p > 1e-4, "{name}: p = {p}"); // false alarm 1e-4 a case, fixed seed
        };
        check("disc", &|u| {
            let d = disc_concentric(u);
            Vec2::new(d.length_squared(), turn(d.y, d.x))
        });
        check("cosine", &|u| {
            let d = cosine_hemisphere(u);
            Vec2::new(1.0 - d.z * d.z, turn(d.y, d.x))
        });
        check("sphere", &|u| {
            let d = uniform_sphere(u);
            Vec2::new((1.0 - d.z) * 0.5, turn(d.y, d.x))
        });
        check("cone", &|u| {
            let d = uniform_cone(u, 0.3);
            Vec2::new((1.0 - d.z) / 0.3, turn(d.y, d.x))
        });
        check("triangle", &|u| {
            let b = triangle(u);
            let s = 1.0 - b.x; // P(b1 < x) = 1 − (1 − x)²; given b1, b2 is uniform on [0, 1 − b1]
            Vec2::new(s * s, b.y / s)
        });
    }

    /// No coordinate is ever negative, the third one, 1 − b1 − b2 as it is computed, included; together they are 1
    /// within 2u. The largest and the smallest numbers there are, corners, the diagonal, and a million by chance.
    #[test]
    fn barycentrics_stay_inside() {
        let mut rng = Pcg::new(47);
        let ends: Vec<f32> = (0..64)
            .map(|k| k as f32 * UNIT_ROUNDOFF)
            .flat_map(|x| [x, 1.0 - UNIT_ROUNDOFF - x])
            .collect();
        let corners = ends.iter().flat_map(|&x| ends.iter().map(move |&y| Vec2::new(x, y)));
        let diagonal = (0..4096).map(|k| Vec2::splat(k as f32 / 4096.0));
        let chance: Vec<Vec2> = (0..1_000_000).map(|_| rng.next_vec2()).collect();
        for u in corners.chain(diagonal).chain(chance) {
            let b = triangle(u);
            let b0 = 1.0 - b.x - b.y;
            assert!(b.min_element() >= 0.0 && b.x + b.y <= 1.0 && b0 >= 0.0, "{u}: {b}");
            let sum = f64::from(b0) + f64::from(b.x) + f64::from(b.y);
            assert!((sum - 1.0).abs() <= 2.0 * f64::from(UNIT_ROUNDOFF), "{u}: {sum}");
        }
    }

    /// The radius is 1 only where a number is 0: there, and nowhere else, the cosine is 0. The smallest other one is that
    /// of the smallest step, √(2·2u) ≈ 3.5e-4; nothing is NaN and every direction is a unit vector to 8u.
    #[test]
    fn the_cosine_of_a_direction_is_never_negative_nor_lost() {
        let mut smallest = 1.0f32;
        for k in 0..4096 {
            for other in [0.0, 0.25, 0.5, 0.77, 1.0 - UNIT_ROUNDOFF] {
                for x in [k as f32 * UNIT_ROUNDOFF, 1.0 - (k + 1) as f32 * UNIT_ROUNDOFF] {
                    for u in [Vec2::new(x, other), Vec2::new(other, x)] {
                        let w = cosine_hemisphere(u);
                        assert!(w.z >= 0.0 && (w.z > 0.0 || u.min_element() == 0.0), "{u}: {w}");
                        let off = w.as_dvec3().length() - 1.0;
                        assert!(off.abs() <= 8.0 * f64::from(UNIT_ROUNDOFF), "{u}: {off}");
                        smallest = if w.z > 0.0 { smallest.min(w.z) } else { smallest };
                    }
                }
            }
        }
        assert!(
            (smallest / (4.0 * UNIT_ROUNDOFF).sqrt() - 1.0).abs() < 1e-3,
            "{smallest}"
        );
    }
}
