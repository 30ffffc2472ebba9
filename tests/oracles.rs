//! The judges are judged first: the reference renderer against closed forms, the Z-test against known differences.

mod support;

use glam::DVec3;
use pts::math::stats::{Pcg, normal_quantile};
use support::estimate::{Estimate, WHOLE};
use support::reference::{Ball, Balls, Finish, Glass, Pinhole, cornell, render};
use support::{images, ztest};

fn camera() -> Pinhole {
    Pinhole {
        location: DVec3::new(0.0, 0.0, 0.3),
        direction: DVec3::NEG_Z,
        right: DVec3::X,
        up: DVec3::Y,
        near: 0.0,
    }
}

fn shell(emission: f64, albedo: f64) -> Ball {
    Ball {
        center: DVec3::ZERO,
        radius: 2.0,
        emission: DVec3::splat(emission),
        color: DVec3::splat(albedo),
        finish: Finish::Diffuse,
    }
}

/// Inside a closed surface that emits 1 and has albedo a the radiance is 1 + a + a² + … = 1/(1 − a) everywhere.
#[test]
fn the_reference_sums_the_geometric_series_of_a_furnace() {
    for albedo in [0.0, 0.5, 0.8] {
        let scene = Balls {
            balls: vec![shell(1.0, albedo)],
            camera: camera(),
            glass: Glass::Exact,
        };
        let image = render(&scene, 16, 16, 4000, 1);
        let exact = [1.0 / (1.0 - albedo); 3];
        image.region(WHOLE).assert_near(exact, 0.01, 4.0, "furnace");
    }
}

/// A lossless ball of any kind is invisible in a uniform environment; a wrong Fresnel split, a lost ray or a
/// wrong refracted side would show.
#[test]
fn lossless_balls_vanish_in_a_uniform_environment() {
    for finish in [Finish::Diffuse, Finish::Mirror, Finish::Glass(1.5), Finish::Glass(0.7)] {
        let mut scene = Balls {
            balls: vec![shell(1.0, 0.0)],
            camera: camera(),
            glass: Glass::Exact,
        };
        scene.balls.push(Ball {
            center: DVec3::new(0.0, 0.0, -0.8),
            radius: 0.5,
            emission: DVec3::ZERO,
            color: DVec3::ONE,
            finish,
        });
        let image = render(&scene, 24, 24, 100, 2);
        image
            .region(WHOLE)
            .assert_near([1.0; 3], 0.01, 4.0, &format!("{finish:?}"));
    }
}

/// Irradiance below the centre of a spherical lamp of radiance L: E = πL(R/d)²; a white plane shows L(R/d)².
/// The plane is a ball of radius 1e4 touched by the view at its pole.
#[test]
fn the_reference_knows_the_irradiance_of_a_sphere() {
    let (lamp_radius, distance) = (1.0, 2.0);
    let scene = Balls {
        balls: vec![
            Ball {
                center: DVec3::new(0.0, -1e4, 0.0),
                radius: 1e4,
                emission: DVec3::ZERO,
                color: DVec3::ONE,
                finish: Finish::Diffuse,
            },
            Ball {
                center: DVec3::new(0.0, distance, 0.0),
                radius: lamp_radius,
                emission: DVec3::ONE,
                color: DVec3::ZERO,
                finish: Finish::Diffuse,
            },
        ],
        // Looks at the pole from the side, below the lamp; the field is so narrow that E is constant in it.
        camera: Pinhole {
            location: DVec3::new(1.0, 0.1, 0.0),
            direction: DVec3::new(-1.0, -0.1, 0.0),
            right: DVec3::Z * 1e-3,
            up: DVec3::new(-0.1, 1.0, 0.0) * 1e-4,
            near: 0.0,
        },
        glass: Glass::Exact,
    };
    let image = render(&scene, 16, 16, 4000, 3);
    let exact = [(lamp_radius / distance).powi(2); 3];
    image.region(WHOLE).assert_near(exact, 0.01, 4.0, "below a lamp");
}

/// The box's picture is not mirrored: the left wall is red, the right one blue, the lamp is at the top.
#[test]
fn the_classic_box_is_the_right_way_round() {
    let image = render(&cornell(4.0 / 3.0), 16, 12, 200, 4);
    let [left, right] = [[0.0, 0.3, 0.15, 0.7], [0.85, 0.3, 1.0, 0.7]]
        .map(|bounds| image.region(support::estimate::Region { name: "", bounds }).mean);
    assert!(left[0] > 2.0 * left[2], "left wall {left:?}");
    assert!(right[2] > 2.0 * right[0], "right wall {right:?}");
    assert!(image.mean[24][0] > 5.0, "no lamp below the top: {:?}", image.mean[24]);
}

/// Normal noise about a picture: equal pictures pass, 1 % more light fails, one changed block fails.
#[test]
fn the_z_test_sees_a_small_bias_and_passes_equal_pictures() {
    let noisy = |seed: u64, factor: &dyn Fn(usize) -> f64| {
        let mut rng = Pcg::new(seed);
        let mut draw = |mean: f64| mean + 0.05 * normal_quantile(rng.next_f64().max(1e-12));
        Estimate {
            width: 48,
            height: 48,
            mean: (0..48 * 48).map(|i| [0; 3].map(|_| draw(factor(i)))).collect(),
            variance: vec![[0.05f64.powi(2); 3]; 48 * 48],
        }
    };
    let base = noisy(1, &|_| 1.0);
    for seed in 2..22 {
        let verdict = ztest::compare(&noisy(seed, &|_| 1.0), &base, 8, 1e-3);
        assert!(verdict.agree(), "seed {seed}: {verdict}");
    }
    let biased = ztest::compare(&noisy(30, &|_| 1.01), &base, 8, 1e-3);
    assert!(biased.image_z > biased.image_limit, "{biased}");
    let block = |i: usize| if i % 48 < 8 && i / 48 < 8 { 1.1 } else { 1.0 };
    let verdict = ztest::compare(&noisy(31, &block), &base, 8, 1e-3);
    assert!(
        verdict.worst_z > verdict.block_limit && verdict.worst_at.0 == [0, 0],
        "{verdict}"
    );
    let mut nan = base.clone();
    nan.mean[100][1] = f64::NAN;
    assert!(!ztest::compare(&nan, &base, 8, 1e-3).agree(), "a NaN passes");
}

/// What is written is what is read, up to the half float.
#[test]
fn estimates_survive_their_file() {
    let image = render(&cornell(1.0), 16, 16, 16, 5);
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("estimate.exr");
    images::write_estimate(&path, &image);
    let back = images::read_estimate(&path);
    assert_eq!([back.width, back.height], [16, 16]);
    for (a, b) in image.mean.iter().zip(&back.mean) {
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() <= a[c].abs() / 1024.0 + 1e-6, "{a:?} {b:?}");
        }
    }
}

/// The mean of the classic box, 0.328, as the C++ program of `tests/bench` finds it (0.3279 ± 0.0003, Schlick),
/// and what exact Fresnel changes about it: less than 0.5 %.
#[test]
fn the_classic_box_has_its_known_mean() {
    let mut scene = cornell(4.0 / 3.0);
    let (exact, exact_error) = render(&scene, 64, 48, 300, 6).level();
    scene.glass = Glass::Lecture;
    let (lecture, lecture_error) = render(&scene, 64, 48, 300, 7).level();
    println!("exact {exact:.5} ± {exact_error:.5}, lecture {lecture:.5} ± {lecture_error:.5}");
    assert!(
        (lecture - 0.328).abs() < 0.001 + 4.0 * lecture_error,
        "{lecture} ± {lecture_error}"
    );
    let noise = 4.0 * exact_error.hypot(lecture_error);
    assert!(
        (exact / lecture - 1.0).abs() < 0.005 + noise / lecture,
        "{exact} against {lecture}"
    );
}
