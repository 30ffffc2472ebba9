//! Flat lights of extreme shapes, sizes and distances, against Lambert's formula in f64.

use super::*;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::stats::Pcg;

/// Irradiance at the origin, facing +z, from a polygon of radiance 1 above the horizon, by Lambert's formula: half the
/// sum over edges of the angle seen times the cosine between normals. The angle by its tangent: slivers keep theirs.
fn polygon(corners: &[DVec3]) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let across = a.cross(*b);
            let sine = across.length();
            if sine > 0.0 {
                sine.atan2(a.dot(*b)) * across.z / sine
            } else {
                0.0
            }
        })
        .sum();
    (0.5 * sum).abs()
}

/// A rectangle of this width and length at this height, with its middle `aside` of its width and 0.7 times that of its
/// length from straight above.
fn rectangle(width: f64, length: f64, height: f64, aside: f64) -> [Vec3; 4] {
    let (x, y) = (width * (aside - 0.5), length * (0.7 * aside - 0.5));
    let corner = |i: f64, j: f64| DVec3::new(x + width * i, y + length * j, height).as_vec3();
    [corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)]
}

/// (width, length, height): far, near, huge, tiny, and as slender as a hair a kilometre long.
const SHAPES: [(f64, f64, f64); 14] = [
    (1.0, 1.0, 3.0),
    (1.0, 1.0, 1e3),
    (1.0, 1.0, 1e6),
    (1e-3, 1e-3, 1e4),
    (1e-6, 1e-6, 1.0),
    (1.0, 1.0, 0.1),
    (1.0, 1.0, 1e-3),
    (1.0, 1.0, 1e-6),
    (1e4, 1e4, 1.0),
    (1.0, 1e3, 1.0),
    (1.0, 1e5, 1.0),
    (1e-4, 1.0, 1.0),
    (1e-6, 1.0, 1.0),
    (1e-3, 1e3, 10.0),
];

/// Light samples and chance hits together, as a surface has them, bring what Lambert's formula says: within five standard
/// errors, which are 2 % at most.
#[test]
fn polygons_of_any_shape_bring_their_irradiance() {
    for (width, length, height) in SHAPES {
        for aside in [0.1, 2.0] {
            let [a, b, c, d] = rectangle(width, length, height, aside);
            let wide = [a, b, c, d].map(|v| v.as_dvec3());
            let shapes = [
                ("rectangle", parallelogram(a, b - a, d - a), polygon(&wide)),
                ("triangle", triangle(c, d, b, false), polygon(&wide[1..])),
            ];
            for (name, light, exact) in shapes {
                let found = super::strategies::estimate(&[light], true, 64);
                let (off, noise) = (found.mean() / exact - 1.0, 5.0 * found.variance().sqrt() / exact);
                let what = format!("{name} {width} × {length} at {height}, {aside} aside: {off:+} ± {noise}");
                assert!(noise <= 0.1 && off.abs() <= noise + 1e-5, "{what}");
            }
        }
    }
}

/// Midpoints of the light's own directions are good to 1e-3 where those are uniform in solid angle, so that the cosine
/// alone varies, and where the light is so far that nothing does: no noise to hide in.
#[test]
fn directions_to_polygons_are_as_even_as_they_say() {
    let wider_than_far = |(w, l, h): &(f64, f64, f64)| w.min(*l) > 0.1 * h.max(w.max(*l)) && *h > 1e-5 * w;
    let far = |(w, l, h): &(f64, f64, f64)| w.max(*l) < 0.01 * h;
    for (width, length, height) in SHAPES.into_iter().filter(|s| wider_than_far(s) || far(s)) {
        let [a, b, c, d] = rectangle(width, length, height, 0.1);
        let wide = [a, b, c, d].map(|v| v.as_dvec3());
        for (light, exact) in [
            (parallelogram(a, b - a, d - a), polygon(&wide)),
            (triangle(c, d, b, false), polygon(&wide[1..])),
        ] {
            let found = irradiance(&light, Vec3::ZERO, Vec3::Z, 256);
            assert!(
                (found / exact - 1.0).abs() < 1e-3,
                "{width} × {length} at {height}: {found}, exactly {exact}"
            );
        }
    }
}

/// On its axis an ellipse with half axes a and b at height h brings π·ab/√((a² + h²)(b² + h²)). Its directions are even in
/// area: midpoints are good to 1e-3 where it is not much wider than far.
#[test]
fn discs_of_any_shape_bring_their_irradiance() {
    for (a, b, h) in [
        (1.0, 1.0, 3.0),
        (1.0, 1.0, 1.0),
        (1.0, 1.0, 1e6),
        (1e-6, 1e-6, 1.0),
        (1.0, 1e-6, 1.0),
        (1e-9, 1e3, 2e3),
        (1e8, 1e8, 2e8),
        (1e-15, 1e-15, 1e-15),
    ] {
        let light = disc(DVec3::Z * h, DVec3::Y * b, DVec3::X * a, 0.0);
        let exact = std::f64::consts::PI * a * b / ((a * a + h * h) * (b * b + h * h)).sqrt();
        let found = irradiance(&light, Vec3::ZERO, Vec3::Z, 256);
        assert!(
            (found / exact - 1.0).abs() < 1e-3,
            "{a}, {b} at {h}: {found}, exactly {exact}"
        );
    }
}

/// Catalogue of hard cases J 64: on the light, at its corners and edges, in its plane, and closer than the square of the
/// distance can be told from 0. A sample is none, or sound: and then the density found for it is the one that it states.
#[test]
fn receivers_on_and_beside_flat_lights_are_sound() {
    let (p0, e1, e2) = (Vec3::ZERO, Vec3::Y, Vec3::X); // looks down
    let lights = [
        parallelogram(p0, e1, e2),
        triangle(p0, p0 + e1, p0 + e2, false),
        triangle(p0, p0 + e1, p0 + e2, true),
        disc(DVec3::new(0.5, 0.5, 0.0), DVec3::Y * 0.5, DVec3::X * 0.5, 0.0),
    ];
    let places = [
        (0.0, 0.0),
        (1.0, 0.0),
        (0.0, 1.0),
        (0.25, 0.0),
        (0.25, 0.25),
        (0.5, 0.5),
        (2.0, 0.5),
        (1.0, 1.0),
    ];
    let mut rng = Pcg::new(64);
    for light in &lights {
        let set = LightSet::new(vec![light.clone()]);
        for (x, y) in places {
            for z in [0.0, -1e-45, -1e-38, -1e-20, -1e-10, -1e-3, 1e-20, 1e-3] {
                for n in [Vec3::ZERO, Vec3::Z, -Vec3::Z, Vec3::X] {
                    let p = Vec3::new(x, y, z);
                    for i in 0..64 {
                        let ends = [0.0, UNIT_ROUNDOFF, 0.5, 1.0 - UNIT_ROUNDOFF];
                        let u = match i {
                            0..16 => Vec2::new(ends[i % 4], ends[i / 4]),
                            _ => rng.next_vec2(),
                        };
                        let Some(s) = set.sample(p, n, false, 0.5, u, 0.0) else {
                            continue;
                        };
                        let what = format!("{light:?} from {p}, {u}: {s:?}");
                        assert!((s.wi.length() - 1.0).abs() < 1e-6, "{what}");
                        assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{what}");
                        assert!(
                            s.distance >= 0.0 && s.distance.is_finite() && s.t_max <= s.distance,
                            "{what}"
                        );
                        assert!(s.b.min_element() >= 0.0 && s.b.max_element() <= 1.0, "{what}");
                    }
                }
            }
        }
    }
}

/// A hair below its middle a square is all of the sky: E = π. Nearer than a few millionths of its size directions are even
/// in its area, and all but the nearest points are found by chance.
#[test]
fn a_square_that_is_all_but_touched_is_all_of_the_sky() {
    for height in [1e-3f32, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-20, 1e-30] {
        for aside in [0.0, 0.2] {
            let [a, b, _, d] = rectangle(1.0, 1.0, 0.0, aside);
            let light = parallelogram(a + Vec3::Z * height, b - a, d - a);
            let found = super::strategies::estimate(&[light], true, 65);
            // The rim of the square is seen at an elevation of 4 heights at most.
            let off = (found.mean() / std::f64::consts::PI - 1.0).abs();
            let noise = 5.0 * found.variance().sqrt() / std::f64::consts::PI;
            assert!(
                noise < 0.05 && off < noise + 4.0 * f64::from(height) + 1e-6,
                "at {height}: {off} ± {noise}"
            );
        }
    }
}
