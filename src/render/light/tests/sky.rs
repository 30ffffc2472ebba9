//! The environment image: orientation, means, and light beside darkness.

use super::*;
use crate::math::stats::Pcg;
use crate::math::warp::uniform_sphere;
use glam::DMat3;

/// An image of random radiances, a third of them 0, turned somehow.
pub(super) fn image(width: u32, height: u32, seed: u64) -> Option<EnvironmentImage> {
    let mut rng = Pcg::new(seed);
    let texels = (0..width * height)
        .map(|_| {
            let v = rng.next_f32();
            if v < 0.3 { [0.0; 3] } else { [v, v * v, 2.0 * v] }
        })
        .collect();
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_y(1.1);
    EnvironmentImage::new(width, height, texels, turn, true)
}

/// A black image with one bright texel.
fn one_texel(w: u32, h: u32, x: u32, y: u32, right_handed: bool) -> EnvironmentLight {
    let mut texels = vec![[0.0; 3]; (w * h) as usize];
    texels[(y * w + x) as usize] = [1.0; 3];
    let image = EnvironmentImage::new(w, h, texels, DMat3::IDENTITY, right_handed);
    EnvironmentLight::Image(image.expect("a valid image"))
}

#[test]
fn images_are_turned_as_documented() {
    // Odd sizes have a texel centre in the middle of the image.
    for (right_handed, forward) in [(false, 1.0), (true, -1.0)] {
        let centre = one_texel(9, 5, 4, 2, right_handed);
        assert!((centre.radiance(Vec3::Z * forward).x - 1.0).abs() < 1e-5);
        assert!(centre.radiance(-Vec3::Z * forward).x == 0.0);
        assert!(centre.radiance(Vec3::Y).x == 0.0);
        // Seen from inside with +y up, columns grow to the right, which is +x in both.
        let right = one_texel(8, 5, 6, 2, right_handed); // centred at 6.5/8: 5/16 turn right of the centre
        let azimuth = 0.3125 * std::f32::consts::TAU;
        let towards = Vec3::new(azimuth.sin(), 0.0, azimuth.cos() * forward);
        assert!((right.radiance(towards).x - 1.0).abs() < 1e-5);
        let top = one_texel(1, 3, 0, 0, right_handed);
        assert_eq!((top.radiance(Vec3::Y).x, top.radiance(-Vec3::Y).x), (1.0, 0.0));
    }
    let turned = EnvironmentImage::new(
        1,
        3,
        vec![[1.0; 3], [0.0; 3], [0.0; 3]],
        DMat3::from_rotation_z(-std::f64::consts::FRAC_PI_2), // takes +y to +x
        false,
    );
    let turned = turned.map(EnvironmentLight::Image).expect("a valid image");
    assert!((turned.radiance(Vec3::X).x - 1.0).abs() < 1e-5 && turned.radiance(Vec3::Y).x < 1e-5);
}

#[test]
fn wherever_there_is_light_there_is_density() {
    let light = image(16, 7, 8).map(EnvironmentLight::Image).expect("a valid image");
    let corner = one_texel(64, 32, 0, 31, false);
    let at = receiver(Vec3::ZERO, Vec3::ZERO);
    let mut rng = Pcg::new(2);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    for i in 0..200_000 {
        let wi = axes.get(i).copied().unwrap_or_else(|| uniform_sphere(rng.next_vec2()));
        for l in [&light, &corner] {
            assert!(
                l.radiance(wi).x == 0.0 || l.pdf(&at, wi) > 0.0,
                "{wi}: {}",
                l.radiance(wi)
            );
        }
    }
}

/// The integral of the radiance by importance and by directions even over the sphere, within 5 standard errors.
#[test]
fn importance_and_even_sampling_give_the_same_total() {
    let light = image(32, 16, 4).map(EnvironmentLight::Image).expect("a valid image");
    let at = receiver(Vec3::ZERO, Vec3::ZERO);
    let mut rng = Pcg::new(12);
    let n = 400_000;
    let (mut a, mut b) = ([0.0f64; 2], [0.0f64; 2]);
    for _ in 0..n {
        if let Some(s) = light.sample(&at, rng.next_vec2()) {
            let v = f64::from(s.radiance.y) / f64::from(s.pdf);
            a = [a[0] + v, a[1] + v * v];
        }
        let v = f64::from(light.radiance(uniform_sphere(rng.next_vec2())).y) * 4.0 * std::f64::consts::PI;
        b = [b[0] + v, b[1] + v * v];
    }
    let mean = |x: [f64; 2]| x[0] / f64::from(n);
    let variance = |x: [f64; 2]| (x[1] / f64::from(n) - mean(x).powi(2)) / f64::from(n);
    let off = (mean(a) - mean(b)).abs();
    assert!(
        off < 5.0 * (variance(a) + variance(b)).sqrt(),
        "{} and {}",
        mean(a),
        mean(b)
    );
    assert!(variance(a) < 0.5 * variance(b), "importance sampling does not help");
}

/// A single bright texel in a large image is found by every sample: the hottest case of importance sampling.
#[test]
fn a_small_sun_is_always_found() {
    let light = one_texel(1024, 512, 700, 100, false);
    let at = receiver(Vec3::ZERO, Vec3::ZERO);
    let mut rng = Pcg::new(31);
    let n = 20_000;
    let (mut sum, mut missed) = (0.0, 0);
    for _ in 0..n {
        match light.sample(&at, rng.next_vec2()) {
            Some(s) => sum += f64::from(s.radiance.x) / f64::from(s.pdf),
            None => missed += 1,
        }
    }
    // The tent of one texel integrates to its own solid angle, up to the change of sin θ across it.
    let theta = std::f64::consts::PI * 100.5 / 512.0;
    let exact = theta.sin() * (std::f64::consts::PI / 512.0).powi(2);
    let mean = sum / f64::from(n);
    assert!((mean / exact - 1.0).abs() < 0.05, "{mean}, about {exact}"); // 5 SE
    assert!(missed < 20, "{missed} samples missed the sun"); // directions rounded out of the lit cells
}

#[test]
fn unusable_images_are_refused_and_bad_values_are_dark() {
    let make = |w, h, n: usize| EnvironmentImage::new(w, h, vec![[1.0; 3]; n], DMat3::IDENTITY, false);
    assert!(make(0, 0, 0).is_none() && make(2, 2, 3).is_none());
    let texels = vec![[f32::NAN, -1.0, f32::INFINITY]; 2];
    let dark = EnvironmentImage::new(2, 1, texels, DMat3::IDENTITY, false).map(EnvironmentLight::Image);
    let dark = dark.expect("a valid image");
    assert_eq!(dark.radiance(Vec3::X), Vec3::ZERO);
    assert!(dark.sample(&receiver(Vec3::ZERO, Vec3::Z), Vec2::splat(0.4)).is_none());
}

/// Catalogue of hard cases H 49: at the poles the density is that of the cells there, which are caps of half a row: finite,
/// positive, and the same all around.
#[test]
fn the_poles_of_a_sky_are_ordinary_places() {
    let (w, h) = (512u32, 256u32);
    let image = EnvironmentImage::new(w, h, vec![[1.0; 3]; (w * h) as usize], DMat3::IDENTITY, false);
    let light = image.map(EnvironmentLight::Image).expect("a valid image");
    let at = receiver(Vec3::ZERO, Vec3::ZERO);
    for pole in [1.0, -1.0] {
        for tilt in [0.0, -0.0, 1e-45, 1e-30, 1e-20, 1e-7, 1e-4, 3e-3] {
            for (x, z) in [(1.0, 0.0), (0.0, -1.0), (0.6, 0.8), (-0.6, 0.8)] {
                let wi = Vec3::new(x * tilt, pole, z * tilt).normalize();
                let pdf = f64::from(light.pdf(&at, wi)) * 4.0 * std::f64::consts::PI;
                // An even sky; a row's probability is a difference of sums in f64, a cell's an integer over 2³².
                assert!((pdf - 1.0).abs() < 1e-6, "{wi}: {pdf} of an even density");
                assert_eq!(light.radiance(wi), Vec3::ONE, "{wi}");
            }
        }
    }
}
