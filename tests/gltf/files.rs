//! Buffers and images in other files.

use crate::builder::*;
use pts::diag::Severity;
use pts::files::{Files, MemoryFiles};
use pts::import::gltf::{Glass, GltfOptions};
use pts::scene::ImageSource;
use serde_json::json;
use std::path::Path;

/// The triangle in a folder, its buffer at `uri`, with the buffer's bytes.
fn in_folder(uri: &str) -> (MemoryFiles, Vec<u8>) {
    let mut m = Model::triangle();
    m.json["buffers"] = json!([{"byteLength": m.bin.len(), "uri": uri}]);
    let mut files = MemoryFiles::default();
    files.insert("models/a.gltf", m.text());
    (files, m.bin)
}

#[test]
fn buffers_are_found_beside_the_model_also_percent_encoded() {
    for (uri, name) in [
        ("b.bin", "models/b.bin"),
        ("sub/../b.bin", "models/b.bin"),
        ("./my%20data/%C3%A4.bin", "models/my data/ä.bin"),
        ("100%.bin", "models/100%.bin"),
        ("a%20b.bin", "models/a%20b.bin"),
    ] {
        let (mut files, data) = in_folder(uri);
        files.insert(name, data);
        let (scene, diags) = load_from(&files, "models/a.gltf", &GltfOptions::default());
        assert!(scene.is_some() && diags.is_empty(), "{uri}: {diags:?}");
        assert_eq!(files.opened().last().map(|p| p.as_path()), Some(Path::new(name)));
    }
}

#[test]
fn letter_case_and_windows_paths_are_forgiven_with_a_warning() {
    for uri in ["B.BIN", "C:\\Users\\me\\b.bin", "..\\other\\b.bin"] {
        let (mut files, data) = in_folder(uri);
        files.insert("models/b.bin", data);
        let (scene, diags) = load_from(&files, "models/a.gltf", &GltfOptions::default());
        assert!(scene.is_some(), "{uri}: {diags:?}");
        assert_eq!(codes(&diags), ["G0304"], "{uri}");
    }
}

#[test]
fn files_outside_the_models_folder_are_not_read_unless_allowed() {
    for uri in [
        "../secret.bin",
        "/secret.bin",
        "sub/../../secret.bin",
        "file:///secret.bin",
        "%2E%2E/secret.bin",
    ] {
        let (mut files, data) = in_folder(uri);
        files.insert("models/../secret.bin", data.clone());
        files.insert("models/sub/../../secret.bin", data.clone());
        files.insert("/secret.bin", data);
        let (scene, diags) = load_from(&files, "models/a.gltf", &GltfOptions::default());
        assert!(scene.is_none(), "{uri}");
        assert_eq!(codes(&diags), ["G0305"], "{uri}");
        assert_eq!(files.opened().len(), 1, "{uri}: only the model itself");
        assert!(diags.iter().all(|d| !d.hints.is_empty()));
        let options = GltfOptions {
            allow_outside: true,
            ..GltfOptions::default()
        };
        assert!(load_from(&files, "models/a.gltf", &options).0.is_some(), "{uri}");
    }
}

#[test]
fn a_missing_buffer_is_an_error_and_a_missing_image_a_warning() {
    let (files, _) = in_folder("gone.bin");
    let (_, diags) = load_from(&files, "models/a.gltf", &GltfOptions::default());
    assert_eq!(codes(&diags), ["G0303"]);
    let d = diags.iter().next().unwrap();
    assert_eq!(d.place.as_deref(), Some("models/a.gltf: buffers[0].uri"));

    let base = json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "baseColorTexture": {"index": 0}}});
    let mut m = Model::with_texture(base);
    m.json["images"][0] = json!({"uri": "skin.png"});
    let (scene, diags) = m.try_load(&GltfOptions::default());
    let scene = scene.unwrap();
    assert_eq!(principled(&scene).base_color.texture, None);
    assert_eq!(principled(&scene).base_color.factor.to_array(), [1.0, 0.0, 0.0]);
    let warning = diags.iter().next().unwrap();
    assert_eq!((warning.severity, warning.code), (Severity::Warning, "G0303"));
}

#[test]
fn images_are_named_not_opened() {
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let mut m = Model::with_texture(base);
    m.json["images"][0] = json!({"uri": "skin.png"});
    let mut files = MemoryFiles::default();
    files.insert("m/model.gltf", m.text());
    files.insert("m/skin.png", *b"not a picture");
    let (scene, _) = load_from(&files, "m/model.gltf", &GltfOptions::default());
    assert_eq!(scene.unwrap().images[0].source, ImageSource::File("m/skin.png".into()));
    assert_eq!(files.opened(), [Path::new("m/model.gltf")]);
}

#[test]
fn an_image_in_a_view_keeps_its_bytes() {
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let mut m = Model::with_texture(base);
    let view = m.view(b"jpeg bytes");
    m.json["images"][0] = json!({"bufferView": view, "mimeType": "image/jpeg"});
    let source = m.load().images.remove(0).source;
    assert_eq!(source, ImageSource::Bytes((*b"jpeg bytes").into()));
}

#[test]
fn a_byte_order_mark_and_float_counts_are_tolerated() {
    let mut m = Model::triangle();
    m.json["accessors"][0]["count"] = json!(3.0);
    let mut text = b"\xEF\xBB\xBF".to_vec();
    text.extend(m.text());
    let mut files = MemoryFiles::default();
    files.insert("model.gltf", text);
    let (scene, diags) = load_from(&files, "model.gltf", &GltfOptions::default());
    assert!(scene.is_some() && diags.is_empty(), "{diags:?}");
}

#[test]
fn the_best_format_that_is_read_comes_first_and_the_plain_image_is_its_fallback() {
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let sources = |texture: serde_json::Value| {
        let mut m = Model::with_texture(base.clone());
        m.json["images"] = json!([{"uri": "data:,png"}, {"uri": "data:,webp"}, {"uri": "data:,ktx2"}, {"uri": "gone"}]);
        m.json["textures"][0] = texture;
        let image = m.load().images.remove(0);
        let text = |source: ImageSource| match source {
            ImageSource::Bytes(bytes) => String::from_utf8(bytes.to_vec()).unwrap(),
            other => panic!("{other:?}"),
        };
        (text(image.source), image.fallback.map(text))
    };
    let webp = json!({"EXT_texture_webp": {"source": 1}});
    let both = json!({"EXT_texture_webp": {"source": 1}, "KHR_texture_basisu": {"source": 2}});
    let avif = json!({"EXT_texture_avif": {"source": 1}});
    let gone = json!({"KHR_texture_basisu": {"source": 3}});
    let some = |s: &str| Some(s.to_owned());
    assert_eq!(sources(json!({"source": 0})), ("png".into(), None));
    assert_eq!(
        sources(json!({"source": 0, "extensions": webp})),
        ("webp".into(), some("png"))
    );
    assert_eq!(sources(json!({"extensions": webp})), ("webp".into(), None));
    assert_eq!(
        sources(json!({"source": 0, "extensions": both})),
        ("ktx2".into(), some("png"))
    );
    assert_eq!(sources(json!({"source": 0, "extensions": avif})), ("png".into(), None));
    assert_eq!(sources(json!({"source": 0, "extensions": gone})), ("png".into(), None));
}

#[test]
fn whatever_is_wrong_with_a_texture_costs_the_texture_and_one_warning() {
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    for (pointer, value) in [
        ("/textures/0/source", json!(7)),
        ("/textures/0/source", json!("x")),
        ("/textures/0/sampler", json!(3)),
        ("/images/0/uri", json!("data:image/png;base64,***")),
        ("/images/0/uri", json!("../outside.png")),
        ("/images/0/uri", json!("https://example.org/a.png")),
        ("/images/0/uri", json!(5)),
        ("/images/0", json!({"bufferView": 9})),
        ("/images/0", json!({})),
        ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", json!(1)),
    ] {
        let mut m = Model::with_texture(base.clone());
        m.json["textures"][0]["sampler"] = json!(0);
        m.json["samplers"] = json!([{}]);
        *m.json.pointer_mut(pointer).unwrap() = value.clone();
        let (scene, diags) = m.try_load(&GltfOptions::default());
        let scene = scene.unwrap_or_else(|| panic!("{pointer} {value}: {diags:?}"));
        assert_eq!(principled(&scene).base_color.texture, None, "{pointer} {value}");
        assert_eq!(diags.iter().count(), 1, "{pointer} {value}: {diags:?}");
        assert_eq!(scene.meshes.len(), 1);
    }
}

#[test]
fn glass_is_solid_or_thin_if_the_caller_says_so() {
    let glass = |volume: serde_json::Value| {
        let mut extensions = json!({"KHR_materials_transmission": {"transmissionFactor": 1}});
        if !volume.is_null() {
            extensions["KHR_materials_volume"] = volume;
        }
        Model::with_material(json!({"extensions": extensions}))
    };
    let (thin, solid) = (
        glass(json!(null)),
        glass(json!({"thicknessFactor": 1, "attenuationDistance": 1,
        "attenuationColor": [0.5, 0.5, 0.5]})),
    );
    for (choice, of_thin, of_solid) in [
        (Glass::AsWritten, false, true),
        (Glass::Solid, true, true),
        (Glass::Thin, false, false),
    ] {
        for (model, thick) in [(&thin, of_thin), (&solid, of_solid)] {
            let options = GltfOptions {
                glass: choice,
                ..GltfOptions::default()
            };
            let scene = model.try_load(&options).0.expect("it loads");
            assert_eq!(principled(&scene).thick, thick, "{choice:?}");
            let absorbs = scene.materials[0].interior != Default::default();
            assert_eq!(absorbs, thick && std::ptr::eq(model, &solid), "{choice:?}");
        }
    }
    let opaque = Model::with_material(json!({}));
    let options = GltfOptions {
        glass: Glass::Solid,
        ..GltfOptions::default()
    };
    assert!(!principled(&opaque.try_load(&options).0.expect("it loads")).thick);
}

#[test]
fn the_first_bytes_decide_what_a_file_is_and_spare_chunks_are_skipped() {
    let m = Model::triangle();
    for (name, bytes) in [("text.glb", m.text()), ("binary.gltf", m.glb())] {
        let mut files = MemoryFiles::default();
        files.insert(name, bytes);
        let (scene, diags) = load_from(&files, name, &GltfOptions::default());
        assert!(scene.is_some() && diags.is_empty(), "{name}: {diags:?}");
    }
    // A second binary chunk and one of a kind that nobody knows.
    let mut glb = m.glb();
    for kind in [0x004E_4942u32, 0x5858_5858] {
        glb.extend(4u32.to_le_bytes());
        glb.extend(kind.to_le_bytes());
        glb.extend([0xFF; 4]);
    }
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
    let mut files = MemoryFiles::default();
    files.insert("m.glb", glb.clone());
    let (scene, diags) = load_from(&files, "m.glb", &GltfOptions::default());
    assert!(diags.is_empty(), "{diags:?}");
    assert_eq!(positions(&scene.unwrap().meshes[0])[1], [2.0, 0.0, 0.0]);
    // Bytes behind the end cost a warning.
    glb.extend(b"trailing");
    files.insert("m.glb", glb);
    let (scene, diags) = load_from(&files, "m.glb", &GltfOptions::default());
    assert_eq!((scene.is_some(), codes(&diags)), (true, vec!["G0102"]));
}

#[test]
fn a_glb_may_keep_its_buffer_in_another_file() {
    let mut m = Model::triangle();
    let data = std::mem::take(&mut m.bin);
    m.json["buffers"] = json!([{"byteLength": data.len(), "uri": "b.bin"}]);
    let mut text = serde_json::to_vec(&m.json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF".to_vec();
    for word in [2, 20 + text.len(), text.len(), 0x4E4F_534A] {
        glb.extend((word as u32).to_le_bytes());
    }
    glb.extend(text);
    let mut files = MemoryFiles::default();
    files.insert("m.glb", glb);
    files.insert("b.bin", data);
    let (scene, diags) = load_from(&files, "m.glb", &GltfOptions::default());
    assert!(scene.is_some() && diags.is_empty(), "{diags:?}");
}

#[test]
fn a_buffer_that_many_name_is_read_once() {
    let (mut files, data) = in_folder("b.bin");
    let mut m = Model::triangle();
    let length = data.len();
    m.json["buffers"] = json!(vec![json!({"byteLength": length, "uri": "b.bin"}); 3]);
    m.json["bufferViews"] = (0..3).map(|b| json!({"buffer": b, "byteLength": length})).collect();
    m.json["accessors"] = (0..3)
        .map(|v| json!({"bufferView": v, "componentType": F32, "count": 3, "type": "VEC3"}))
        .collect();
    m.json["meshes"][0]["primitives"] = (0..3).map(|a| json!({"attributes": {"POSITION": a}})).collect();
    files.insert("models/a.gltf", m.text());
    files.insert("models/b.bin", data);
    let (scene, _) = load_from(&files, "models/a.gltf", &GltfOptions::default());
    assert_eq!(scene.unwrap().meshes[0].triangles.len(), 3);
    assert_eq!(files.opened().len(), 2);
}

#[test]
fn old_files_are_told_apart_by_their_form_also_without_a_version() {
    for json in [
        json!({"asset": {"version": "1.0"}, "meshes": {}}),
        json!({"meshes": {"mesh_1": {"primitives": []}}}),
    ] {
        let mut files = MemoryFiles::default();
        files.insert("m.gltf", json.to_string().into_bytes());
        let (_, diags) = load_from(&files, "m.gltf", &GltfOptions::default());
        assert_eq!(codes(&diags), ["G0201"]);
        assert!(diags.iter().next().unwrap().message.contains("1.0"));
    }
    let mut m = Model::triangle();
    m.json["asset"].take();
    assert_eq!(m.codes(), ["G0201"]);
    m.load();
}

#[test]
fn file_uris_name_files_of_the_models_folder() {
    for uri in ["file:b.bin", "file://b.bin", "FILE:./b.bin"] {
        let (mut files, data) = in_folder(uri);
        files.insert("models/b.bin", data);
        let (scene, diags) = load_from(&files, "models/a.gltf", &GltfOptions::default());
        assert!(scene.is_some() && diags.is_empty(), "{uri}: {diags:?}");
    }
}

#[test]
fn scenes_without_anything_to_draw_say_so() {
    for scenes in [json!([{}]), json!([{"nodes": []}]), json!([{"nodes": [1]}])] {
        let mut m = Model::triangle();
        m.json["scenes"] = scenes;
        m.push("nodes", json!({"name": "empty"}));
        assert_eq!(m.codes(), ["G0501"]);
        assert!(m.load().objects.is_empty());
    }
}

/// The flag of the command line, with a file of each kind.
#[test]
fn the_command_line_lets_a_model_read_outside_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let (inner, model) = (folder.path().join("models"), folder.path().join("models/a.gltf"));
    let (_, data) = in_folder("../b.bin");
    let mut m = Model::triangle();
    m.json["buffers"] = json!([{"byteLength": data.len(), "uri": "../b.bin"}]);
    std::fs::create_dir(&inner).unwrap();
    std::fs::write(&model, m.text()).unwrap();
    std::fs::write(folder.path().join("b.bin"), data).unwrap();
    let text = folder.path().join("scene.pts");
    std::fs::write(
        &text,
        "camera { location -5*z look_at 0 }\ngltf { \"models/a.gltf\" }\n",
    )
    .unwrap();
    for scene in [&model, &text] {
        let run = |flags: &[&str]| {
            let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_pts"));
            let output = command.arg("check").args(flags).arg(scene).output().unwrap();
            (
                output.status.code(),
                String::from_utf8_lossy(&output.stderr).into_owned(),
            )
        };
        let (code, told) = run(&[]);
        assert!(code == Some(1) && told.contains("--allow-outside"), "{code:?}: {told}");
        let (code, told) = run(&["--allow-outside"]);
        assert_eq!(code, Some(0), "{told}");
    }
}
