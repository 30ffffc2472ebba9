//! Small scenes against pictures made earlier, statistically: a block Z-test with both variances, one false alarm
//! in a thousand draws of the seed for each scene. `PTS_BLESS=1` makes the pictures anew, with many samples.
//! They guard what no closed form covers; when one fails, look at the strip that the message names.

mod support;

use support::{images, scenes, ztest};

const ALPHA: f64 = 1e-3;

fn check(scene: &str) {
    check_picture(&format!("tests/golden/{scene}"), [32, 32], 8192);
}

/// `scene`: a path in the repository; its picture is `tests/golden/NAME.exr`, of this size and made with so many samples.
fn check_picture(scene: &str, size: [u32; 2], spp: u32) {
    let stem = scenes::path(scene);
    let stem = stem.file_stem().and_then(|s| s.to_str()).expect("a name");
    let golden = scenes::path(&format!("tests/golden/{stem}.exr"));
    let ready = scenes::ready(scene, &[], size);
    if std::env::var_os("PTS_BLESS").is_some() {
        images::write_estimate(&golden, &ready.estimate(spp, 77));
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

/// A feature of glTF: models that `examples/make_models.rs` writes. Their pictures were compared with those of another
/// renderer by eye and by their means when they were made, but for shear, visibility and ranges of lamps, which it lacks.
fn check_feature(name: &str) {
    check_picture(&format!("tests/golden/features/{name}.gltf"), [48, 32], 2048);
}

/// An extension of glTF's materials: the grid of the gallery.
fn check_extension(name: &str) {
    check_picture(&format!("scenes/extensions/{name}.gltf"), [50, 30], 2048);
}

macro_rules! golden {
    ($check:ident: $($name:ident $file:literal),* $(,)?) => {
        $(#[test]
        fn $name() {
            $check($file);
        })*
    };
}

golden! { check:
    shapes_look_as_before "shapes.pts",
    materials_look_as_before "materials.pts",
    words_of_pov_ray_look_as_before "pov_words.pov",
    a_lens_looks_as_before "lens.pts",
    an_orthographic_sky_looks_as_before "orthographic_sky.pts",
    a_gltf_model_looks_as_before "model_gltf.pts",
    obj_models_look_as_before "model_obj.pts",
    many_lamps_look_as_before "many_lamps.pts",
}

golden! { check_feature:
    gltf_nodes "nodes",
    gltf_morph "morph",
    gltf_skin "skin",
    gltf_vertex_colors "vertex_colors",
    gltf_quantized_instances "quantized_instances",
    gltf_textures "textures",
    gltf_topologies "topologies",
    gltf_lights "lights",
    gltf_orthographic "orthographic",
}

golden! { check_extension:
    extension_alpha "alpha",
    extension_anisotropy "anisotropy",
    extension_clearcoat "clearcoat",
    extension_diffuse_transmission "diffuse_transmission",
    extension_dispersion "dispersion",
    extension_emissive_strength "emissive_strength",
    extension_ior "ior",
    extension_iridescence "iridescence",
    extension_metallic_roughness "metallic_roughness",
    extension_sheen "sheen",
    extension_specular "specular",
    extension_specular_glossiness "specular_glossiness",
    extension_transmission "transmission",
    extension_unlit "unlit",
    extension_volume "volume",
}
