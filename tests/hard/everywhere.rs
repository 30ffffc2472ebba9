//! Furnaces, pixel by pixel: a mean over the picture would let a dark rim and a bright middle cancel.

use crate::support::estimate::Estimate;
use crate::support::scenes::{ready, settings};
use pts::render::technique::Direct;

const SIZE: [u32; 2] = [32, 32];

/// A furnace in which light is found by hits alone, so that each path carries its throughput and nothing else.
fn by_hits(scene: &str, defines: &[(&str, &str)], spp: u32) -> Estimate {
    let mut settings = settings(SIZE, spp, 1);
    settings.technique.direct = Direct::Bsdf;
    ready(scene, defines, SIZE).shoot(&settings).estimate
}

/// Every path of these ends in the light of 1 with a throughput of 1, whatever it met: each bounce multiplies by a
/// weight of 1 with at most four roundings, and 32·4·2⁻²⁴ = 7.7e-6. After 32 bounces roulette ends lossless paths too:
/// the few pixels with such a path, trapped in nested glass, are 1 up to five standard errors. A single odd path among
/// equal ones is off by one standard error; all paths off alike have none.
#[test]
fn every_pixel_of_a_lossless_furnace_is_one() {
    let materials =
        ["0", "2", "3", "7", "10"].map(|which| ("tests/hard/furnace/materials.pts", vec![("Which", which)]));
    let others = [
        ("tests/hard/furnace/relief.pts", vec![("Which", "0")]),
        ("tests/hard/furnace/relief.pts", vec![("Which", "1")]),
        ("tests/hard/furnace/nested.pts", vec![]),
        ("tests/hard/camera/inside_glass.pts", vec![]),
    ];
    for (scene, defines) in materials.into_iter().chain(others) {
        let image = by_hits(scene, &defines, 64);
        let mut odd = 0;
        for (i, rgb) in image.mean.iter().enumerate() {
            let off = rgb.iter().map(|v| (v - 1.0).abs()).fold(0.0, f64::max);
            if off > 32.0 * 4.0 * 2f64.powi(-24) {
                let (x, y) = (i % SIZE[0] as usize, i / SIZE[0] as usize);
                let noise = 5.0 * image.variance[i][1].sqrt();
                assert!(off <= noise, "{scene} {defines:?}: {rgb:?} ± {noise} at {x}, {y}");
                odd += 1;
            }
        }
        // One path in a thousand at most, and only where glass in glass can trap it.
        let most = match scene {
            "tests/hard/furnace/nested.pts" => image.mean.len() * 64 / 1000,
            _ => 0,
        };
        assert!(odd <= most, "{scene} {defines:?}: {odd} pixels are not 1");
    }
}

/// Rough lobes are compensated by tables, good to 1 % at any angle, rough glass to 1.2 %, coats to 2 % below: that, and
/// five standard errors, in each of eight rings of the ball, from its middle to its rim. A ring has some sixty pixels
/// of 16 nets, so that its error is normal: one false alarm in 1.7 million rings.
#[test]
fn rough_materials_hold_their_energy_at_every_angle() {
    // Radius of the ball in the picture: sin α = 1/5, and half of the width is tan 15°.
    let radius = 0.2f64.asin().tan() / 15f64.to_radians().tan() * f64::from(SIZE[0]) / 2.0;
    for (which, spp, low, high) in [
        ("1", 256, 0.005, 0.005),
        ("4", 1024, 0.012, 0.012),
        ("5", 512, 0.01, 0.01),
        ("6", 512, 0.02, 0.005),
        ("8", 512, 0.01, 0.01),
        ("9", 512, 0.02, 0.005),
    ] {
        for rough in ["0.1", "0.5", "1"] {
            let image = by_hits(
                "tests/hard/furnace/materials.pts",
                &[("Which", which), ("Rough", rough)],
                spp,
            );
            let mut rings = [(0.0, 0.0, 0.0); 8];
            for (i, (mean, variance)) in image.mean.iter().zip(&image.variance).enumerate() {
                let at = |k: usize| k as f64 + 0.5 - f64::from(SIZE[0]) / 2.0;
                let (x, y) = (at(i % SIZE[0] as usize), at(i / SIZE[0] as usize));
                // Rings of equal area; cos θ at the ball falls from 1 to about 0.2 over their middles.
                if let Some(ring) = rings.get_mut((8.0 * (x * x + y * y) / (radius * radius)) as usize) {
                    *ring = (ring.0 + 1.0, ring.1 + mean[1], ring.2 + variance[1]);
                }
            }
            for (k, (n, sum, variance)) in rings.into_iter().enumerate() {
                let (off, noise) = (sum / n - 1.0, 5.0 * variance.sqrt() / n);
                let what = format!("material {which}, roughness {rough}, ring {k}: {off:+.4} ± {noise:.4}");
                assert!(noise < 0.02, "{what}");
                assert!(-low - noise <= off && off <= high + noise, "{what}");
            }
        }
    }
}
