//! Scenes that are the same in two descriptions give the same picture: the same bits where rounding scales along, up to
//! noise elsewhere (false alarms: one in a thousand draws of the seeds).

use crate::support::scenes::{bits, ready, settings};
use crate::support::ztest;

const SIZE: [u32; 2] = [32, 32];
/// Things of every material, and lamps of every kind over things of every shape.
const SCENES: [&str; 2] = ["tests/hard/scale/still_life.pts", "tests/hard/scale/lamps.pts"];

#[track_caller]
fn assert_same(scene: &str, a: &[(&str, &str)], b: &[(&str, &str)], spp: u32) {
    let [one, other] = [(a, 1), (b, 2)].map(|(defines, seed)| ready(scene, defines, SIZE).estimate(spp, seed));
    let verdict = ztest::compare(&other, &one, 4, 1e-3);
    assert!(verdict.agree(), "{scene}: {b:?} against {a:?}: {verdict}");
}

/// Lengths scaled by a power of two change no bit: no length is compared with a fixed number anywhere.
#[test]
fn a_scene_scaled_by_a_power_of_two_has_the_same_bits() {
    for scene in SCENES {
        let shoot = |k: i32| {
            let scale = format!("{:e}", 2f64.powi(k));
            bits(
                &ready(scene, &[("S", &scale)], SIZE)
                    .shoot(&settings(SIZE, 16, 3))
                    .picture,
            )
        };
        let one = shoot(0);
        for k in (-20..=20).filter(|k| *k != 0) {
            let other = shoot(k);
            let differing = one.iter().zip(&other).filter(|(a, b)| a != b).count();
            assert!(differing == 0, "{scene} scaled by 2^{k}: {differing} values differ");
        }
    }
}

/// Micrometres for metres and the other way round, and inches: numbers round differently then, and nothing else changes.
#[test]
fn a_scene_in_other_units_is_the_same_picture() {
    for scene in SCENES {
        for unit in ["1e-6", "0.0254", "1e6"] {
            assert_same(scene, &[], &[("S", unit)], 256);
        }
    }
}

/// Positions are relative to the camera before they are rounded to f32.
#[test]
fn a_scene_far_from_the_origin_is_the_same_picture() {
    for scene in SCENES {
        for far in ["1e3", "1e4", "1e6", "-1e8"] {
            assert_same(scene, &[], &[("M", far)], 256);
        }
    }
}

/// Nanometres somewhere in a town.
#[test]
fn a_small_scene_far_from_the_origin_is_the_same_picture() {
    for scene in SCENES {
        assert_same(scene, &[], &[("M", "1e3"), ("S", "1e-6")], 256);
    }
}

#[test]
fn a_scene_turned_with_its_camera_is_the_same_picture() {
    for scene in SCENES {
        for turn in ["30", "-77"] {
            assert_same(scene, &[], &[("Turn", turn)], 256);
        }
    }
}

#[test]
fn a_scene_mirrored_with_its_camera_is_the_same_picture() {
    for scene in SCENES {
        assert_same(scene, &[], &[("Turn", "20"), ("Flip", "-1")], 256);
    }
}

/// A ball of radius 1e5 leaves its tangent plane by 2e-5 at a distance of 2: nothing that a pixel could see.
#[test]
fn walls_that_are_huge_balls_are_walls_that_are_planes() {
    for radius in ["1e5", "1e7"] {
        assert_same("tests/hard/room/box.pts", &[], &[("Round", radius)], 256);
    }
}

#[test]
fn walls_that_are_huge_balls_are_walls_of_two_triangles() {
    for radius in ["1e5", "1e7"] {
        assert_same("tests/hard/room/box.pts", &[("Quads", "1")], &[("Round", radius)], 256);
    }
}

/// Any number of lamps in one place with a light of 3 together, of each kind that has no shape; and any number of
/// emitting balls in one place, of which only one can be seen.
#[test]
fn lamps_in_one_place_add_up() {
    for which in ["0", "1", "3", "4", "5", "6"] {
        for copies in ["2", "7"] {
            let copied = [("Which", which), ("Copies", copies)];
            assert_same("tests/hard/lamps/floor.pts", &[("Which", which)], &copied, 256);
        }
    }
}
