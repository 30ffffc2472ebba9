//! Whole pictures of a floor under a lamp, pixel by pixel against the irradiance in closed form.

use crate::support::estimate::Estimate;
use crate::support::scenes::ready;
use crate::support::ztest;
use glam::DVec3;

const SIZE: usize = 24;
const LAMP: DVec3 = DVec3::new(0.3, 2.0, -0.2);
const ALBEDO: f64 = 0.5;

/// The picture whose radiance at the floor's point is `radiance`: the mean over each pixel by the midpoint rule.
pub fn expected(radiance: impl Fn(DVec3) -> f64) -> Estimate {
    const SUB: usize = 8;
    let at = |k: usize| 2.0 * (k as f64 + 0.5) / (SIZE * SUB) as f64 - 1.0;
    let pixel = |i: usize| {
        let (x, y) = (i % SIZE * SUB, i / SIZE * SUB);
        let points = (0..SUB * SUB).map(|k| DVec3::new(at(x + k % SUB), 0.0, -at(y + k / SUB)));
        [points.map(&radiance).sum::<f64>() / (SUB * SUB) as f64; 3]
    };
    Estimate {
        width: SIZE,
        height: SIZE,
        mean: (0..SIZE * SIZE).map(pixel).collect(),
        variance: vec![[0.0; 3]; SIZE * SIZE],
    }
}

/// Blocks of 2×2 pixels against the closed form, one false alarm in a thousand; the noise must be below 1 % of the light.
#[track_caller]
fn assert_picture(which: &str, spp: u32, radiance: impl Fn(DVec3) -> f64) {
    let size = [SIZE as u32; 2];
    let found = ready("tests/hard/lamps/floor.pts", &[("Which", which)], size).estimate(spp, 1);
    let verdict = ztest::compare(&found, &expected(radiance), 2, 1e-3);
    assert!(verdict.agree(), "lamp {which}: {verdict}");
    let level = found.mean.iter().map(|m| m[1]).sum::<f64>();
    let noise = found.variance.iter().map(|v| v[1].sqrt()).sum::<f64>();
    println!("lamp {which}: noise {:.4}, {verdict}", noise / level);
    assert!(
        level > 0.0 && noise < 0.01 * level,
        "lamp {which}: noise {noise} in {level}"
    );
}

/// cos θ at the floor and the distance of a point of the lamp.
fn toward(p: DVec3, lamp: DVec3) -> (f64, f64) {
    let d = lamp - p;
    (d.y / d.length(), d.length())
}

/// POV-Ray's cone: all light to 8°, none from 24° on, between them s²(3 − 2s) of the angle; all of it times cos³.
#[test]
fn a_spotlight_has_its_cone_everywhere() {
    let axis = (DVec3::new(0.1, 0.0, 0.1) - LAMP).normalize();
    assert_picture("0", 256, |p| {
        let (cos, _) = toward(p, LAMP);
        let along = axis.dot((p - LAMP).normalize());
        let s = ((24.0 - along.acos().to_degrees()) / (24.0 - 8.0)).clamp(0.0, 1.0);
        ALBEDO * 3.0 * cos * s * s * (3.0 - 2.0 * s) * along.powi(3)
    });
}

/// 2/(1 + (r/d)²) with d = 1e-3 is 2d²/r² to one part in a million.
#[test]
fn a_fading_lamp_obeys_the_inverse_square_law_everywhere() {
    assert_picture("1", 64, |p| {
        let (cos, r) = toward(p, LAMP);
        ALBEDO * 3e6 * cos * 2e-6 / (r * r)
    });
}

/// A ball of radiance L and radius R far above the floor's horizon gives E = π·L·(R/r)²·cos θ, exactly.
#[test]
fn a_glowing_ball_obeys_the_inverse_square_law_everywhere() {
    assert_picture("4", 256, |p| {
        let (cos, r) = toward(p, LAMP);
        ALBEDO * 100.0 * cos * (0.2 / r) * (0.2 / r)
    });
}

/// The mean of cos θ over an area of 1 × 0.6, from `from` of its x on; midpoints of 16×16 parts.
fn area(p: DVec3, from: f64) -> f64 {
    const N: usize = 16;
    let left = from.clamp(LAMP.x - 0.5, LAMP.x + 0.5);
    let width = LAMP.x + 0.5 - left;
    let part = |k: usize| {
        let (u, v) = ((k % N) as f64 + 0.5, (k / N) as f64 + 0.5);
        let q = DVec3::new(left + width * u / N as f64, LAMP.y, LAMP.z + 0.6 * (v / N as f64 - 0.5));
        toward(p, q).0
    };
    (0..N * N).map(part).sum::<f64>() / (N * N) as f64 * width
}

#[test]
fn an_area_light_is_the_mean_of_its_points() {
    assert_picture("2", 256, |p| ALBEDO * 3.0 * area(p, -1.0));
}

/// The edge at height 0.5 hides a point q of the lamp from p where p.x + (q.x − p.x)/4 < 0, that is q.x < −3·p.x.
#[test]
fn an_area_light_has_a_half_shadow_of_the_right_width() {
    assert_picture("3", 1024, |p| ALBEDO * 3.0 * area(p, -3.0 * p.x));
}
