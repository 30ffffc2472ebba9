//! Scenes that are the same in two descriptions give the same picture, up to noise; false alarms: one in a thousand.

use crate::support::scenes::ready;
use crate::support::ztest;

const SIZE: [u32; 2] = [32, 32];

#[track_caller]
fn assert_same(scene: &str, a: &[(&str, &str)], b: &[(&str, &str)], spp: u32) {
    let [one, other] = [(a, 1), (b, 2)].map(|(defines, seed)| ready(scene, defines, SIZE).estimate(spp, seed));
    let verdict = ztest::compare(&other, &one, 4, 1e-3);
    assert!(verdict.agree(), "{scene}: {b:?} against {a:?}: {verdict}");
}

#[test]
fn a_scene_turned_with_its_camera_is_the_same_picture() {
    for turn in ["30", "-77"] {
        assert_same("tests/hard/scale/still_life.pts", &[], &[("Turn", turn)], 256);
    }
}

#[test]
fn a_scene_mirrored_with_its_camera_is_the_same_picture() {
    let mirrored = [("Turn", "20"), ("Flip", "-1")];
    assert_same("tests/hard/scale/still_life.pts", &[], &mirrored, 256);
}

/// A ball of radius 1e5 leaves its tangent plane by 2e-5 at a distance of 2: nothing that a pixel could see.
#[test]
fn walls_that_are_huge_balls_are_walls_that_are_planes() {
    assert_same("tests/hard/room/box.pts", &[], &[("Round", "1")], 256);
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
