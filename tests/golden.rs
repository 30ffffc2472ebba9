//! Small scenes against pictures made earlier, statistically: a block Z-test with both variances, one false alarm
//! in a thousand draws of the seed for each scene. `PTS_BLESS=1` makes the pictures anew, with many samples.
//! They guard what no closed form covers; when one fails, look at the strip that the message names.

mod support;

use support::{images, scenes, ztest};

const SIZE: [u32; 2] = [32, 32];
const ALPHA: f64 = 1e-3;

fn check(scene: &str) {
    let stem = scene.split('.').next().expect("a name");
    let golden = scenes::path(&format!("tests/golden/{stem}.exr"));
    let ready = scenes::ready(&format!("tests/golden/{scene}"), &[], SIZE);
    if std::env::var_os("PTS_BLESS").is_some() {
        images::write_estimate(&golden, &ready.estimate(8192, 77));
    }
    let expected = images::read_estimate(&golden);
    let found = ready.estimate(256, 1);
    let verdict = ztest::compare(&found, &expected, 4, ALPHA);
    assert!(
        verdict.agree(),
        "{scene}: {verdict}\nsee {}; if the change is meant, PTS_BLESS=1 cargo test --release --test golden",
        images::write_strip(stem, &expected, &found).display()
    );
}

macro_rules! golden {
    ($($name:ident $file:literal),* $(,)?) => {
        $(#[test]
        fn $name() {
            check($file);
        })*
    };
}

golden! {
    shapes_look_as_before "shapes.pts",
    materials_look_as_before "materials.pts",
    words_of_pov_ray_look_as_before "pov_words.pov",
    a_lens_looks_as_before "lens.pts",
    an_orthographic_sky_looks_as_before "orthographic_sky.pts",
    a_gltf_model_looks_as_before "model_gltf.pts",
    obj_models_look_as_before "model_obj.pts",
    many_lamps_look_as_before "many_lamps.pts",
}
