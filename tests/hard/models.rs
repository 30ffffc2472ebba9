//! glTF models through the whole renderer.

use crate::support::scenes::{ready, settings};
use crate::support::ztest;

const SIZE: [u32; 2] = [24, 24];
const SCENE: &str = "tests/hard/models/model.pts";

/// Products of scales and ways there and back leave the place as it was but for the rounding of 1e6 in f64.
#[test]
fn nested_scales_ways_and_mirrors_cancel() {
    let [plain, nested] =
        [("0", 1), ("1", 2)].map(|(which, seed)| ready(SCENE, &[("Which", which)], SIZE).estimate(1024, seed));
    let verdict = ztest::compare(&nested, &plain, 4, 1e-3);
    assert!(verdict.agree(), "{verdict}");
}

/// An index of 0 means infinite, by the extension's own words: everything is reflected, and a mirror cannot be seen.
#[test]
fn an_index_of_zero_reflects_everything() {
    let image = ready(SCENE, &[("Which", "2")], SIZE)
        .shoot(&settings(SIZE, 64, 1))
        .estimate;
    // One reflection: a dozen roundings of f32.
    let off = image.mean.iter().flatten().map(|v| (v - 1.0).abs()).fold(0.0, f64::max);
    assert!(off <= 12.0 * 2f64.powi(-24), "off by {off}");
}
