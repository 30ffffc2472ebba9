//! Things in one place, or too near each other for single precision: lamps, blocks of glass, front and back.

use crate::SIGMAS;
use crate::support::estimate::WHOLE;
use crate::support::scenes::estimate_of;
use std::f64::consts::PI;

/// A ray sees one of several emitters in one place, so they light as one. Radiance of the floor is 0.5·E/π with E in
/// closed form: the square by Lambert's formula, the disc π/(1 + h²), the ball π/d².
#[test]
fn emitters_in_one_place_are_one() {
    let square = {
        let a: f64 = 1.0 / 3.0;
        let q = (1.0 + a * a).sqrt();
        4.0 * (a / q) * (a / q).atan()
    };
    for which in 0..8 {
        let e = match which {
            0..6 => square,
            6 => PI / 5.0,
            _ => PI / 25.0,
        };
        let which = which.to_string();
        let image = estimate_of("tests/hard/lamps/one_place.pts", &[("Which", &which)], [8, 8], 4096);
        image
            .region(WHOLE)
            .assert_near([0.5 * e / PI; 3], 0.003, SIGMAS, &format!("way {which}"));
    }
}

/// Seen along its axis the octahedron is a square with a diagonal of 2R: E = L·2R²/d², and L = d²/R².
#[test]
fn the_back_of_a_far_lamp_does_not_shine_through_its_front() {
    for (r, d) in [("1e-3", "1e4"), ("1", "1e7"), ("1e-2", "10")] {
        let image = estimate_of("tests/hard/lamps/far_mesh.pts", &[("R", r), ("D", d)], [8, 8], 4096);
        image
            .region(WHOLE)
            .assert_near([1.0 / PI; 3], 0.004, SIGMAS, &format!("R = {r} at {d}"));
    }
}

/// Its disc covers π(R/√(D² − R²))² of a picture (3R/D)² in size: π/9·D²/(D² − R²).
#[test]
fn a_far_ball_covers_its_share_of_a_narrow_view() {
    for (r, d) in [("1", "10"), ("1", "1e4"), ("1e-3", "1e4")] {
        for aim in ["0", "1", "2"] {
            let defines = [("R", r), ("D", d), ("Aim", aim)];
            let image = estimate_of("tests/hard/lens/far_ball.pts", &defines, [32, 32], 256);
            let (r, d): (f64, f64) = (r.parse().unwrap_or(f64::NAN), d.parse().unwrap_or(f64::NAN));
            let exact = PI / 9.0 * d * d / (d * d - r * r);
            image
                .region(WHOLE)
                .assert_near([exact; 3], 0.002, SIGMAS, &format!("{defines:?}"));
        }
    }
}

/// Every path ends in the light of 1, whatever it took to be inside of what. Those that meet eighty surfaces end by chance
/// now and then, which is noise.
#[test]
fn glass_of_any_topology_cannot_be_seen_in_a_white_furnace() {
    for which in 0..=9 {
        let relative = if which == 0 { 0.02 } else { 3e-3 };
        let which = which.to_string();
        let image = estimate_of("tests/hard/glass/piles.pts", &[("Which", &which)], [16, 16], 256);
        image
            .region(WHOLE)
            .assert_near([1.0; 3], relative, SIGMAS, &format!("pile {which}"));
    }
}

/// exp(−σ·1) however many blocks it is cut into; rays that meet 20 surfaces end by chance now and then.
#[test]
fn blocks_in_contact_absorb_as_one() {
    for n in ["1", "2", "10", "20"] {
        for down in ["0", "1"] {
            let defines = [("N", n), ("Down", down)];
            let image = estimate_of("tests/hard/glass/stack.pts", &defines, [8, 8], 1024);
            image
                .region(WHOLE)
                .assert_near([f64::exp(-0.7); 3], 0.02, SIGMAS, &format!("{defines:?}"));
        }
    }
}

/// Unpolarised reflectance of an interface of index 1.5.
fn fresnel(angle: f64) -> f64 {
    let (sin_i, cos_i) = angle.sin_cos();
    let cos_t = (1.0 - sin_i * sin_i / 2.25).sqrt();
    let s = (cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t);
    let p = (1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// (1 − R)/(1 + R), though the triangles are 10⁸ times as large as the slab is thick.
#[test]
fn a_thin_slab_of_large_triangles_is_a_slab() {
    for thickness in ["1e-5", "1e-3", "10"] {
        for tilt in [0.0, 60.0f64] {
            let r = fresnel(tilt.to_radians());
            let tilt = tilt.to_string();
            let defines = [("T", thickness), ("Tilt", &*tilt)];
            let image = estimate_of("tests/hard/glass/mesh_slab.pts", &defines, [8, 8], 4096);
            image
                .region(WHOLE)
                .assert_near([(1.0 - r) / (1.0 + r); 3], 0.002, SIGMAS, &format!("{defines:?}"));
        }
    }
}

/// (1 − R)²·a/(1 − R²·a²) with a = exp(−0.7), though the slab is as thin as a hundred roundings of its place.
#[test]
fn a_thin_slab_absorbs_by_its_own_thickness() {
    let (r, a) = (0.04f64, f64::exp(-0.7));
    let exact = (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a);
    for (thickness, sigma) in [("1e-5", "7e4"), ("1e-3", "7e2"), ("1", "0.7")] {
        let defines = [("T", thickness), ("Sigma", sigma)];
        let image = estimate_of("tests/hard/glass/slab.pts", &defines, [8, 8], 4096);
        image
            .region(WHOLE)
            .assert_near([exact; 3], 0.003, SIGMAS, &format!("{defines:?}"));
    }
}

/// 1/(1 − ρ) where a path meets its walls 200 times: the error it tells must be the error it has.
#[test]
fn a_nearly_lossless_room_sums_its_series() {
    let image = estimate_of("tests/hard/furnace/closed.pts", &[("Rho", "0.995")], [8, 8], 512);
    image
        .region(WHOLE)
        .assert_near([200.0; 3], 0.06, SIGMAS, "albedo 0.995");
}
