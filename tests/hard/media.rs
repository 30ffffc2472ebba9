//! Cameras and lamps inside of glass and of what absorbs.

use crate::support::estimate::{RegionMean, WHOLE};
use crate::support::scenes::ready;
use pts::render::technique::{Direct, Technique};

const SIZE: [u32; 2] = [16, 16];

fn inside(defines: &[(&str, &str)], spp: u32) -> RegionMean {
    ready("tests/hard/media/inside.pts", defines, SIZE)
        .estimate(spp, 1)
        .region(WHOLE)
}

/// From the centre of a ball each ray meets its surface straight on and comes back through the centre: of light of 1
/// around it arrives (1 − R)·a/(1 − R·a²), a = exp(−σ), R = ((n − 1)/(n + 1))².
#[test]
fn a_camera_inside_absorbing_glass_sees_what_is_left() {
    for n in ["1.5", "2.4", "1.0001"] {
        for sigma in ["0", "0.1", "0.7", "3"] {
            let (index, s): (f64, f64) = (n.parse().expect("a number"), sigma.parse().expect("a number"));
            let (r, a) = (((index - 1.0) / (index + 1.0)).powi(2), (-s).exp());
            let exact = (1.0 - r) * a / (1.0 - r * a * a);
            let what = format!("ior {n}, absorption {sigma}");
            inside(&[("N", n), ("Sigma", sigma)], 1024).assert_near([exact; 3], 0.005, 5.0, &what);
        }
    }
}

/// Without a boundary nothing is left to chance: exp(−σ) to a few roundings, from nothing to all of it.
#[test]
fn absorption_without_a_boundary_has_no_noise() {
    for sigma in ["0", "1e-9", "1e-3", "1", "20", "80"] {
        let exact = (-sigma.parse::<f64>().expect("a number")).exp();
        let found = inside(&[("Sigma", sigma)], 16).mean[1];
        // The distance and its product with σ have four roundings, which count σ times; the exponential two.
        let u = 2f64.powi(-24);
        let allowed = exact * u * (4.0 * -exact.ln() + 4.0);
        assert!(
            (found - exact).abs() <= allowed,
            "absorption {sigma}: {found}, exactly {exact}"
        );
    }
    for sigma in ["1e3", "1e6", "1e33", "1e38"] {
        assert_eq!(inside(&[("Sigma", sigma)], 16).mean, [0.0; 3], "absorption {sigma}");
    }
}

/// In the very surface of a lossless ball, looking out and in: light of 1 everywhere shows nothing of it. (In a wider
/// picture the rays of more than 42° from the axis would go round inside for ever.)
#[test]
fn a_camera_in_the_surface_of_glass_sees_the_furnace_as_it_is() {
    for x in ["1", "-1"] {
        for look in ["1", "-1"] {
            let what = format!("at {x}, looking to {look}");
            inside(&[("N", "1.5"), ("X", x), ("Look", look)], 1024).assert_near([1.0; 3], 0.002, 5.0, &what);
        }
    }
}

/// A floor in a medium is dimmer by exp(−σ·(d + 1)): 1.5 − 0.001 from the lamp, and 1 to the camera. E = π·L·(R/d)². By
/// light samples, by hits (of which there are few), and by both; a medium of 1e33 leaves nothing, and nothing else.
#[test]
fn light_samples_are_dimmed_on_their_way() {
    for sigma in ["0", "0.3", "2"] {
        let s: f64 = sigma.parse().expect("a number");
        let exact = 0.5 * 1e6 * (0.001f64 / 1.5).powi(2) * (-s * (1.5 - 0.001 + 1.0)).exp();
        for direct in [Direct::Mis, Direct::Light] {
            let technique = Technique {
                direct,
                ..Technique::default()
            };
            let settings = pts::render::settings::Settings {
                technique,
                ..crate::support::scenes::settings([8, 8], 256, 1)
            };
            let scene = ready("tests/hard/media/lamp.pts", &[("Sigma", sigma)], [8, 8]);
            let found = scene.shoot(&settings).estimate.region(WHOLE);
            // The field is 0.05° wide: the lamp stands aside by 1e-3 at most; and the floor lights itself by nothing.
            found.assert_near([exact; 3], 0.002, 5.0, &format!("absorption {sigma}, {direct:?}"));
        }
    }
    let dark = ready("tests/hard/media/lamp.pts", &[("Sigma", "1e33")], [8, 8]).estimate(16, 1);
    assert_eq!(dark.region(WHOLE).mean, [0.0; 3]);
}
