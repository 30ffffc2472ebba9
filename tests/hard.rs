//! Hard cases through the whole renderer, each against a closed form or an invariance.
//! Seeds are fixed. Noise is allowed five standard errors (a false alarm in 2 million draws a value).

mod support;

#[path = "hard/catalogue.rs"]
mod catalogue;
#[path = "hard/contact.rs"]
mod contact;
#[path = "hard/everywhere.rs"]
mod everywhere;
#[path = "hard/extremes.rs"]
mod extremes;
#[path = "hard/invariance.rs"]
mod invariance;
#[path = "hard/lamps.rs"]
mod lamps;
#[path = "hard/media.rs"]
mod media;
#[path = "hard/models.rs"]
mod models;
#[path = "hard/oblique.rs"]
mod oblique;
#[path = "hard/one_place.rs"]
mod one_place;

use pts::render::settings::Settings;
use support::estimate::{Estimate, WHOLE};
use support::scenes::{bits, estimate_of, ready};

const SIGMAS: f64 = 5.0;

/// Radiance of a picture that should be the same everywhere.
#[track_caller]
fn assert_uniform(scene: &str, defines: &[(&str, &str)], spp: u32, exact: f64, relative: f64) {
    let image = estimate_of(scene, defines, [16, 16], spp);
    image
        .region(WHOLE)
        .assert_near([exact; 3], relative, SIGMAS, &format!("{scene} {defines:?}"));
}

#[test]
fn lossless_materials_cannot_be_seen_in_a_white_furnace() {
    for which in 0..=10 {
        for rough in ["0.1", "0.5", "1"] {
            if rough != "0.5" && [0, 2, 3, 7, 10].contains(&which) {
                continue; // no roughness to vary
            }
            let which = which.to_string();
            // Compensated lobes hold 1 %, everything else only noise.
            assert_uniform(
                "tests/hard/furnace/materials.pts",
                &[("Which", &which), ("Rough", rough)],
                256,
                1.0,
                0.012,
            );
        }
    }
}

#[test]
fn nested_glass_cannot_be_seen_in_a_white_furnace() {
    assert_uniform("tests/hard/furnace/nested.pts", &[], 1024, 1.0, 0.002);
}

/// Inside glass radiance is n² times that outside; the camera's own inside is air, so it records it without the n².
#[test]
fn a_camera_inside_lossless_glass_sees_the_furnace_as_it_is() {
    assert_uniform("tests/hard/camera/inside_glass.pts", &[], 1024, 1.0, 0.002);
}

/// Geometric series 1 + ρ + ρ² + …; also when the room is as small as 1e-5 or as large as 1e5.
#[test]
fn a_closed_glowing_room_sums_the_geometric_series() {
    for (rho, exact) in [("0", 1.0), ("0.5", 2.0), ("0.9", 10.0)] {
        for size in ["1", "1e-5", "1e5"] {
            assert_uniform(
                "tests/hard/furnace/closed.pts",
                &[("Rho", rho), ("R", size)],
                1024,
                exact,
                0.01,
            );
        }
    }
}

/// Radiance of the lit plane is albedo·E/π with E in closed form:
/// sphere π·L·R²/d², disc π·L·R²/(R² + h²), rectangle by Lambert's formula, lamps by POV-Ray's rules.
#[test]
fn irradiance_under_lamps_is_exact() {
    let rectangle = {
        // Four quarters [0,1]×[0,1] at height 3: form factor (1/2π)·2·(a/√(1+a²))·atan(b/√(1+a²)), a = b = 1/3.
        let a: f64 = 1.0 / 3.0;
        let q = (1.0 + a * a).sqrt();
        4.0 * (a / q) * (a / q).atan() / std::f64::consts::PI
    };
    let cases = [
        (0, 3.0 * 1.0 / 25.0),
        (1, 3.0 * 4.0 / 20.0),
        (2, 3.0 * rectangle),
        (3, 3.0 * rectangle),
        (4, 3.0),                               // E = π·colour at any distance
        (5, 3e14 * 1e-6 / 1e8),                 // tiny and far: R/d = 1e-7
        (6, 3.0 * (1e4f64 / 10_002.0).powi(2)), // huge and near
        (7, 3.0 * 2.0 / (1.0 + 4.0)),           // fade: 2/(1 + (4/2)²)
    ];
    for (which, e_over_pi) in cases {
        for scale in ["1", "1e-4", "1e4"] {
            if which == 5 && scale != "1" {
                continue; // its emission does not scale into f32
            }
            let which = which.to_string();
            let image = estimate_of(
                "tests/hard/irradiance/plane.pts",
                &[("Which", &which), ("S", scale)],
                [8, 8],
                4096,
            );
            let what = format!("lamp {which} at scale {scale}");
            image
                .region(WHOLE)
                .assert_near([0.5 * e_over_pi; 3], 0.004, SIGMAS, &what);
        }
    }
}

/// A slab passes (1 − R)/(1 + R) of the light, R = ((n − 1)/(n + 1))², however thick it is; with absorption
/// (1 − R)²·a/(1 − R²·a²), a = exp(−σ·T).
#[test]
fn a_glass_slab_passes_the_same_share_at_any_thickness() {
    let r = 0.04f64;
    for thickness in ["1e-5", "1e-2", "1", "1e2"] {
        let image = estimate_of("tests/hard/glass/slab.pts", &[("T", thickness)], [8, 8], 4096);
        image
            .region(WHOLE)
            .assert_near([(1.0 - r) / (1.0 + r); 3], 0.005, SIGMAS, &format!("slab {thickness}"));
    }
    let a = (-0.7f64).exp();
    let exact = (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a);
    let image = estimate_of("tests/hard/glass/slab.pts", &[("Sigma", "0.7")], [8, 8], 4096);
    image
        .region(WHOLE)
        .assert_near([exact; 3], 0.005, SIGMAS, "absorbing slab");
    let image = estimate_of("tests/hard/glass/slab.pts", &[("N", "1")], [8, 8], 64);
    image
        .region(WHOLE)
        .assert_near([1.0; 3], 0.0001, SIGMAS, "index-matched slab");
}

/// Radius of the blurred spot of tests/hard/lens/spot.pts, a picture 20° wide, as an angle: the second moment of a disc
/// is half of its squared radius.
fn blur_radius(image: &Estimate) -> f64 {
    let half_width = f64::tan(10f64.to_radians());
    let (mut weight, mut moment) = (0.0, 0.0);
    for (i, rgb) in image.mean.iter().enumerate() {
        let at = |k: usize| ((k as f64 + 0.5) / image.width as f64 - 0.5) * 2.0 * half_width;
        let (x, y) = (at(i % image.width), at(i / image.width));
        weight += rgb[1];
        moment += rgb[1] * (x * x + y * y);
    }
    (2.0 * moment / weight).sqrt()
}

/// A point at D out of focus F spreads over a disc of radius a·|D − F|/F on the plane in focus; as an angle from the
/// lens centre a·|D − F|/(F·D). Its second moment is radius²/2 (mean squared distance from the centre).
#[test]
fn the_circle_of_confusion_has_its_radius() {
    let (size, a, f, d) = (96u32, 0.25f64, 4.0, 8.0);
    let image = estimate_of("tests/hard/lens/spot.pts", &[("A", "0.25")], [size, size], 4096);
    let radius = blur_radius(&image);
    // The disc itself is 0.02 wide; second moments of a blur and what is blurred add up.
    let exact = (a * (d - f) / (f * d)).hypot(0.02 / d);
    assert!((radius / exact - 1.0).abs() < 0.02, "radius {radius}, expected {exact}");
}

#[test]
fn a_lens_of_no_size_is_a_pinhole() {
    let pictures = ["4", "1e20"].map(|f| {
        let ready = ready("tests/hard/lens/spot.pts", &[("A", "0"), ("F", f)], [24, 24]);
        bits(&ready.shoot(&Settings::new(24, 24, 16)).picture)
    });
    assert!(pictures[0] == pictures[1]);
}
