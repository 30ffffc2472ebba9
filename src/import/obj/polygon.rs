//! Polygons to triangles, concave ones included.

use glam::{DVec2, DVec3};

/// Triangles (indices into the polygon, in its own orientation) and whether they cover it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Triangulation {
    /// Corner numbers.
    pub triangles: Vec<[usize; 3]>,
    /// Whether the outline crosses itself, so that no triangulation is right.
    pub is_crossed: bool,
}

/// Concave polygons of more corners are not cut by ears, which may take quadratic time.
const MOST_CORNERS: usize = 1 << 15;

/// Cuts a polygon of at least three corners into triangles. It is flattened onto the plane that fits its outline best
/// (Newell's normal); convex ones become a fan, others are cut by ears. A polygon without area or with
/// corners that are not finite becomes a fan too: its triangles are sorted out later, and counted.
pub(super) fn triangulate(corners: &[DVec3]) -> Triangulation {
    let fan = || Triangulation {
        triangles: (2..corners.len()).map(|i| [0, i - 1, i]).collect(),
        is_crossed: false,
    };
    if corners.len() <= 3 {
        return fan();
    }
    let Some(flat) = flatten(corners) else { return fan() };
    if is_convex(&flat) {
        return fan();
    }
    if corners.len() > MOST_CORNERS {
        return Triangulation {
            is_crossed: true,
            ..fan()
        };
    }
    let coordinates: Vec<f64> = flat.iter().flat_map(|p| [p.x, p.y]).collect();
    let Ok(indices) = earcutr::earcut(&coordinates, &[], 2) else {
        return fan();
    };
    let mut triangles = Vec::with_capacity(corners.len() - 2);
    let mut covered = 0.0;
    for triangle in indices.chunks_exact(3) {
        let &[a, b, c] = triangle else { continue };
        let (Some(&pa), Some(&pb), Some(&pc)) = (flat.get(a), flat.get(b), flat.get(c)) else {
            continue;
        };
        let area = (pb - pa).perp_dot(pc - pa);
        covered += area.abs();
        // Ears come out in either orientation; the polygon's is positive.
        triangles.push(if area < 0.0 { [a, c, b] } else { [a, b, c] });
    }
    let outline = doubled_area(&flat);
    // The two sums differ by rounding alone (about n·2⁻⁵³) or by whole crossings.
    let is_crossed = (covered - outline).abs() > 1e-6 * outline;
    if triangles.is_empty() {
        return Triangulation { is_crossed, ..fan() };
    }
    Triangulation { triangles, is_crossed }
}

/// The corners in a plane, counter-clockwise on the whole, around the first one.
fn flatten(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let &origin = corners.first()?;
    let local = || corners.iter().map(|c| *c - origin);
    let next = local().cycle().skip(1);
    let normal = local()
        .zip(next)
        .fold(DVec3::ZERO, |sum, (a, b)| sum + a.cross(b))
        .try_normalize()?;
    let (x, y) = normal.any_orthonormal_pair();
    let flat: Vec<DVec2> = local().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect();
    flat.iter().all(|p| p.is_finite()).then_some(flat)
}

/// Twice the area inside the outline.
fn doubled_area(flat: &[DVec2]) -> f64 {
    flat.iter()
        .zip(flat.iter().cycle().skip(1))
        .map(|(a, b)| a.perp_dot(*b))
        .sum()
}

/// Whether the outline turns left everywhere and goes round once.
fn is_convex(flat: &[DVec2]) -> bool {
    let at = |i: usize| flat.get(i % flat.len()).copied().unwrap_or_default();
    let mut turned = 0.0;
    for i in 0..flat.len() {
        let (a, b) = (at(i + 1) - at(i), at(i + 2) - at(i + 1));
        if a.perp_dot(b) < 0.0 {
            return false;
        }
        turned += a.angle_to(b);
    }
    turned < 1.5 * std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3], t: &Triangulation) -> DVec3 {
        let cross = |&[a, b, c]: &[usize; 3]| (corners[b] - corners[a]).cross(corners[c] - corners[a]);
        t.triangles.iter().map(cross).sum::<DVec3>() * 0.5
    }

    /// A star of 2n corners with radii 1 and 0.3, turned out of every axis. Area: n · sin(π/n) · 1 · 0.3.
    #[test]
    fn a_concave_star_is_covered_once_in_its_own_orientation() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.7);
        for n in [3_u32, 5, 40] {
            let corner = |i: u32| {
                let (r, angle) = (
                    if i.is_multiple_of(2) { 1.0 } else { 0.3 },
                    f64::from(i) * std::f64::consts::PI / f64::from(n),
                );
                turn * DVec3::new(angle.cos() * r, angle.sin() * r, 0.0) + DVec3::splat(1e3)
            };
            let corners: Vec<DVec3> = (0..2 * n).map(corner).collect();
            let result = triangulate(&corners);
            let normal = turn * DVec3::Z;
            let expected = f64::from(n) * (std::f64::consts::PI / f64::from(n)).sin() * 0.3;
            let one_by_one: f64 = result
                .triangles
                .iter()
                .map(|t| {
                    area(
                        &corners,
                        &Triangulation {
                            triangles: vec![*t],
                            is_crossed: false,
                        },
                    )
                    .dot(normal)
                })
                .inspect(|a| assert!(*a > 0.0, "a triangle of the star of {n} is turned over"))
                .sum();
            assert!((one_by_one - expected).abs() < 1e-9, "{one_by_one} for {expected}");
            assert_eq!(result.triangles.len() as u32, 2 * n - 2);
            assert!(!result.is_crossed);
        }
    }

    #[test]
    fn a_dart_is_not_cut_outside_of_itself() {
        let dart = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let result = triangulate(&dart);
        for t in &result.triangles {
            let middle = t.iter().map(|&i| dart[i]).sum::<DVec3>() / 3.0;
            assert!(
                middle.x > 0.5 || (middle.y - 1.0).abs() > 0.2,
                "{t:?} lies in the notch"
            );
        }
        assert!((area(&dart, &result).z - 1.5).abs() < 1e-12);
    }

    #[test]
    fn bad_polygons_do_no_harm() {
        let bow_tie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        assert!(triangulate(&bow_tie).is_crossed);
        let line: Vec<DVec3> = (0..5).map(|i| DVec3::X * f64::from(i)).collect();
        assert_eq!(triangulate(&line).triangles.len(), 3);
        let nan = [DVec3::NAN, DVec3::X, DVec3::Y, DVec3::Z];
        assert_eq!(triangulate(&nan).triangles.len(), 2);
    }
}
