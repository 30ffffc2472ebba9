//! Cameras, lenses, rooms and radiances at their ends.

use crate::support::estimate::WHOLE;
use crate::support::images::read_planes;
use crate::support::scenes::{Ready, bits, estimate_of, ready, settings};
use pts::output::{Develop, Layers, write};
use pts::render::driver;
use pts::render::report::{Anomaly, Silent};
use std::path::Path;

fn picture(scene: &Ready) -> Vec<[u32; 3]> {
    bits(&scene.shoot(&settings([24, 24], 16, 3)).picture)
}

/// Straight down, `sky y` does not say where up is. The picture comes out all the same, the one that `sky z` gives.
#[test]
fn a_camera_that_looks_along_its_sky_has_a_picture() {
    let [told, untold] = ["1", "0"].map(|told| ready("tests/hard/camera/along_sky.pts", &[("Told", told)], [24, 24]));
    assert!(picture(&told) == picture(&untold));
}

/// A lens of radius 0, whatever its focus, is a camera without a word about a lens, bit for bit.
#[test]
fn a_lens_of_no_size_is_no_lens() {
    let none = picture(&ready("tests/hard/lens/no_words.pts", &[], [24, 24]));
    for focus in ["1e-3", "8", "1e20", "1e300"] {
        let closed = ready("tests/hard/lens/spot.pts", &[("A", "0"), ("F", focus)], [24, 24]);
        assert!(picture(&closed) == none, "focus {focus}");
    }
}

/// Focused at 1e20 the blur of a point at 8 is as wide as the lens: radius a at 8, the angle a/8.
#[test]
fn a_lens_focused_at_infinity_blurs_by_its_own_width() {
    for focus in ["1e20", "1e300"] {
        let (size, a, d) = (96u32, 0.25f64, 8.0);
        let image = estimate_of(
            "tests/hard/lens/spot.pts",
            &[("A", "0.25"), ("F", focus)],
            [size, size],
            256,
        );
        let radius = crate::blur_radius(&image);
        let exact = a.hypot(0.02) / d;
        assert!(
            (radius / exact - 1.0).abs() < 0.02,
            "focus {focus}: radius {radius}, expected {exact}"
        );
    }
}

/// A disc fills π·(R/D)²/(2·tan(angle/2))² of the picture, from fields of a ten-thousandth of a degree to nearly all that a
/// plane can show. Its rim crosses a hundred pixels: the rest has no noise.
#[test]
fn the_field_of_view_is_as_wide_as_it_says() {
    for (angle, r, d) in [
        ("1e-4", "3e-7", "1"),
        ("1e-4", "0.3", "1e6"),
        ("1", "0.003", "1"),
        ("179.9", "500", "1"),
        ("179.9", "5e-4", "1e-6"),
        ("179.999", "3e4", "1"),
    ] {
        let number = |s: &str| s.parse::<f64>().expect("a number");
        let half = (0.5 * number(angle)).to_radians().tan();
        let share = std::f64::consts::PI * (number(r) / number(d) / (2.0 * half)).powi(2);
        let defines = [("Angle", angle), ("R", r), ("D", d)];
        let found = estimate_of("tests/hard/camera/field.pts", &defines, [32, 32], 256).region(WHOLE);
        found.assert_near([share; 3], 0.005, 5.0, &format!("{defines:?}"));
    }
}

/// Catalogue of hard cases L 70: roulette by the brightest channel of the throughput. Each channel has its own sum,
/// 1/(1 − ρ): 10, 2 and 1/0.99; and so has a room that roulette enters late.
#[test]
fn roulette_keeps_every_channel_of_a_coloured_room() {
    use pts::render::technique::{Roulette, Technique};
    let scene = ready("tests/hard/furnace/coloured.pts", &[], [8, 8]);
    for roulette in [Roulette::Throughput, Roulette::Late] {
        let mut settings = settings([8, 8], 1024, 1);
        settings.technique = Technique {
            roulette,
            ..Technique::default()
        };
        let found = scene.shoot(&settings).estimate.region(WHOLE);
        found.assert_near([10.0, 2.0, 1.0 / 0.99], 0.02, 5.0, &format!("{roulette:?}"));
    }
}

/// Catalogue of hard cases M 76: bands of 1e-9 to 1e30 have the radiance that was written down, as nearly as f32 holds it,
/// in the picture and in the file, which half floats would end at 65 504.
#[test]
fn radiance_keeps_its_range_into_the_file() {
    let [width, height] = [56, 4];
    let shot = ready("tests/hard/film/bands.pts", &[], [width, height]).shoot(&settings([width, height], 64, 1));
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bands.exr");
    let layers = Layers {
        width,
        height,
        rgb: shot.picture.rgb.clone(),
        ..Layers::default()
    };
    write(&path, &layers, &Develop::default(), &serde_json::Value::Null).expect("written");
    let planes = read_planes(&path);
    for (i, rgb) in shot.picture.rgb.iter().enumerate() {
        let band = i % width as usize / 4;
        let exact = 10f64.powi(3 * band as i32 - 9) as f32;
        for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
            let off = (f64::from(rgb[c]) / f64::from(exact) - 1.0).abs();
            assert!(off <= 2f64.powi(-23), "band {band}: {} instead of {exact}", rgb[c]);
            assert_eq!(
                planes.channel(name)[i].to_bits(),
                rgb[c].to_bits(),
                "band {band} in the file"
            );
        }
    }
}

/// What f32 cannot hold is counted and black, and touches nothing beside it.
#[test]
fn radiance_beyond_f32_is_counted() {
    let scene = ready("tests/hard/film/overflow.pts", &[], [8, 8]);
    let (picture, report) = driver::render(&scene.compiled, &settings([8, 8], 16, 1), &Silent);
    assert_eq!(
        report.anomalies.of(Anomaly::NonFinite),
        8 * 4 * 16,
        "{:?}",
        report.anomalies
    );
    for (i, rgb) in picture.rgb.iter().enumerate() {
        let exact = if i % 8 < 4 { 1.0 } else { 0.0 };
        assert_eq!(*rgb, [exact; 3], "pixel {i}");
    }
}
