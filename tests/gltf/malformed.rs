//! Broken files: each says where it is broken, none panics or hangs.

use crate::builder::*;
use pts::diag::{Diagnostics, Severity};
use pts::files::{DiskFiles, MemoryFiles};
use pts::import::gltf::{GltfOptions, load};
use serde_json::json;
use std::path::Path;

/// Every file of the folder with the code that it must give and the end of the place it must name.
const CASES: &[(&str, &str, &str)] = &[
    ("accessor-component-unknown.gltf", "G0401", "accessors[0]"),
    ("accessor-count-huge.gltf", "G0404", "accessors[0]"),
    ("accessor-count-negative.gltf", "G0203", "accessors[0]"),
    ("accessor-four-billion-zeros.gltf", "G0405", "accessors[0]"),
    ("accessor-of-no-view.gltf", "G0202", "accessors[0].bufferView"),
    ("accessor-offset-huge.gltf", "G0404", "accessors[0]"),
    ("accessor-past-view.gltf", "G0404", "accessors[0]"),
    ("buffer-bad-base64.gltf", "G0301", "buffers[0].uri"),
    ("buffer-missing.gltf", "G0303", "buffers[0].uri"),
    ("buffer-on-the-network.gltf", "G0302", "buffers[0].uri"),
    ("buffer-outside.gltf", "G0305", "buffers[0].uri"),
    ("buffer-percent-ff.gltf", "G0303", "buffers[0].uri"),
    ("buffer-shorter-than-it-says.gltf", "G0313", "buffers[0]"),
    ("camera-field-of-view.gltf", "G0811", "cameras[0].perspective.yfov"),
    ("cut-in-the-middle.gltf", "G0104", "line 39, column 21"),
    ("empty.gltf", "G0104", "line 1, column 0"),
    ("fewer-normals-than-positions.gltf", "G0611", "attributes.NORMAL"),
    ("glb-binary-chunk-cut.glb", "G0103", "glb-binary-chunk-cut.glb"),
    ("glb-header-cut.glb", "G0102", "glb-header-cut.glb"),
    ("glb-json-chunk-too-long.glb", "G0103", "glb-json-chunk-too-long.glb"),
    ("glb-length-huge.glb", "G0102", "glb-length-huge.glb"),
    ("glb-length-wrong.glb", "G0102", "glb-length-wrong.glb"),
    ("glb-version-1.glb", "G0102", "glb-version-1.glb"),
    ("glb-without-binary-chunk.glb", "G0312", "buffers[0]"),
    ("glb-without-json.glb", "G0103", "glb-without-json.glb"),
    ("gltf-1.gltf", "G0201", "asset.version"),
    ("image-empty.gltf", "G0705", "images[0]"),
    ("image-missing.gltf", "G0303", "images[0].uri"),
    ("image-view-outside.gltf", "G0311", "bufferViews[2]"),
    ("index-out-of-range.gltf", "G0605", "meshes[0].primitives[0].indices"),
    ("indices-are-floats.gltf", "G0403", "accessors[1]"),
    (
        "instances-of-unlike-counts.gltf",
        "G0508",
        "EXT_mesh_gpu_instancing.attributes",
    ),
    ("joint-out-of-range.gltf", "G0607", "attributes.JOINTS_0"),
    ("joint-outside-the-scene.gltf", "G0609", "skins[0].joints[0]"),
    ("json-is-an-array.gltf", "G0104", "json-is-an-array.gltf"),
    ("light-cone-inside-out.gltf", "G0801", "lights[0].spot"),
    (
        "light-missing.gltf",
        "G0202",
        "nodes[0].extensions.KHR_lights_punctual.light",
    ),
    ("light-type-unknown.gltf", "G0802", "lights[0].type"),
    ("material-alpha-mode-unknown.gltf", "G0206", "materials[0].alphaMode"),
    ("material-factor-is-text.gltf", "G0203", "materials[0]"),
    ("material-missing.gltf", "G0202", "meshes[0].primitives[0].material"),
    ("matrix-not-finite.gltf", "G0506", "nodes[0]"),
    ("matrix-of-nine.gltf", "G0203", "nodes[0]"),
    ("mesh-missing.gltf", "G0202", "nodes[0].mesh"),
    ("mesh-without-primitives.gltf", "G0203", "meshes[0]"),
    ("mode-unknown.gltf", "G0604", "meshes[0].primitives[0].mode"),
    ("needs-gltf-3.gltf", "G0201", "asset.minVersion"),
    ("nested-too-deeply.gltf", "G0104", "line 1, column 128"),
    ("no-position.gltf", "G0602", "attributes.POSITION"),
    ("node-children-doubled.gltf", "G0504", "children[1]"),
    ("node-cycle.gltf", "G0503", "nodes[1].children[0]"),
    ("node-is-its-own-child.gltf", "G0503", "nodes[0].children[0]"),
    ("node-missing.gltf", "G0202", "scenes[0].nodes[0]"),
    ("node-with-two-parents.gltf", "G0504", "nodes[1].children[0]"),
    ("not-json.gltf", "G0104", "line 1, column 1"),
    ("not-utf8.gltf", "G0104", "not-utf8.gltf"),
    (
        "packed-triangles-cut.gltf",
        "G0314",
        "bufferViews[0].extensions.EXT_meshopt_compression",
    ),
    (
        "packed-view-of-huge-count.gltf",
        "G0620",
        "bufferViews[0].extensions.EXT_meshopt_compression",
    ),
    (
        "packed-view-outside-buffer.gltf",
        "G0311",
        "bufferViews[0].extensions.EXT_meshopt_compression",
    ),
    (
        "packed-view-with-stride-zero.gltf",
        "G0314",
        "bufferViews[0].extensions.EXT_meshopt_compression",
    ),
    (
        "packed-view-with-unknown-mode.gltf",
        "G0314",
        "bufferViews[0].extensions.EXT_meshopt_compression",
    ),
    (
        "packed-view-with-wrong-header.gltf",
        "G0314",
        "bufferViews[0].extensions.EXT_meshopt_compression",
    ),
    (
        "position-of-no-accessor.gltf",
        "G0202",
        "meshes[0].primitives[0].attributes.POSITION",
    ),
    ("positions-not-finite.gltf", "G0613", "attributes.POSITION"),
    (
        "positions-of-two-components.gltf",
        "G0402",
        "meshes[0].primitives[0].attributes.POSITION",
    ),
    ("required-unknown.gltf", "G0204", "extensionsRequired[1]"),
    ("rotation-of-length-zero.gltf", "G0505", "nodes[0].rotation"),
    ("scene-missing.gltf", "G0202", "scene"),
    ("sparse-index-out-of-range.gltf", "G0406", "accessors[0].sparse.indices"),
    ("sparse-longer-than-view.gltf", "G0404", "accessors[0].sparse.indices"),
    ("stride-less-than-element.gltf", "G0404", "accessors[0]"),
    ("texture-missing.gltf", "G0202", "materials[0].emissiveTexture.index"),
    ("two-corners.gltf", "G0606", "meshes[0].primitives[0]"),
    ("view-of-no-buffer.gltf", "G0202", "bufferViews[1].buffer"),
    ("view-outside-buffer.gltf", "G0311", "bufferViews[0]"),
];

#[test]
fn every_broken_file_names_its_fault_and_place() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad/gltf");
    let mut found: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    let listed: Vec<&str> = CASES.iter().map(|c| c.0).collect();
    assert_eq!(found, listed);
    let faults: Vec<String> = CASES.iter().filter_map(|case| fault(&folder, *case).err()).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What is wrong with the answer to one broken file.
fn fault(folder: &Path, (name, code, place): (&str, &str, &str)) -> Result<(), String> {
    let mut diags = Diagnostics::default();
    let scene = load(
        &folder.join(name),
        &DiskFiles::default(),
        &GltfOptions::default(),
        &mut diags,
    );
    if scene.is_none() != diags.has_errors() {
        return Err(format!("{name}: a scene beside errors, or neither"));
    }
    let Some(hit) = diags.iter().find(|d| d.code == code) else {
        return Err(format!(
            "{name}: expected {code}, found {:?}",
            diags.iter().collect::<Vec<_>>()
        ));
    };
    let at = hit.place.as_deref().unwrap_or("");
    if hit.severity < Severity::Warning || !at.contains(name) || !at.ends_with(place) {
        return Err(format!("{name}: expected {place}, found {at}"));
    }
    Ok(())
}

#[test]
fn primitives_that_share_an_accessor_too_often_are_refused_before_memory_ends() {
    let mut m = Model::new();
    let p = m.bytes(
        "VEC3",
        U8,
        30_000,
        &(0..90_000u64).map(|i| (i * i % 251) as u8).collect::<Vec<_>>(),
    );
    let primitive = json!({"attributes": {"POSITION": p}});
    m.push("meshes", json!({"primitives": vec![primitive; 20_000]}));
    assert!(m.codes().contains(&"G0610"));
}

/// A model that uses as much of the reader as fits into a small file.
fn rich_model() -> Model {
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "scale": [2, 2]}}});
    let mut m = Model::with_texture(json!({
        "pbrMetallicRoughness": {"baseColorTexture": info}, "normalTexture": {"index": 0}, "alphaMode": "MASK",
        "extensions": {"KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 1},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1}},
    }));
    let n = m.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let uv = m.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    let j = m.bytes("VEC4", U8, 3, &[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let w = m.bytes("VEC4", U8, 3, &[255, 0, 0, 0].repeat(3));
    let i = m.bytes("SCALAR", U32, 3, &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let delta = m.floats("VEC3", &[0.5; 9]);
    let attributes = json!({"POSITION": 0, "NORMAL": n, "TEXCOORD_0": uv, "JOINTS_0": j, "WEIGHTS_0": w});
    m.json["meshes"][0] = json!({"weights": [0.5], "primitives": [{"attributes": attributes, "indices": i,
        "material": 0, "targets": [{"POSITION": delta}]}]});
    m.json["skins"] = json!([{"joints": [1, 2]}]);
    m.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    m.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}});
    m.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"children": [2], "rotation": [0, 0, 0, 1]},
        {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": delta}}}}]);
    m.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    m
}

/// Loads bytes as a model; panics are the test's to catch.
fn survive(bytes: Vec<u8>) -> bool {
    let mut files = MemoryFiles::default();
    files.insert("m.glb", bytes);
    load_from(&files, "m.glb", &GltfOptions::default()).0.is_some()
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let whole = rich_model().glb();
    assert!(survive(whole.clone()));
    for length in 0..whole.len() {
        assert!(!survive(whole[..length].to_vec()), "cut at {length}");
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let (text, glb) = (rich_model().text(), rich_model().glb());
    let mut state = 0x9E37_79B9_7F4A_7C15u64;
    let mut random = move |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % n
    };
    let mut survived = 0;
    for round in 0..6000 {
        let mut bytes = if round % 2 == 0 { text.clone() } else { glb.clone() };
        for _ in 0..=random(3) {
            let at = random(bytes.len());
            // Digits and brackets keep the JSON well-formed often enough to reach the deeper checks.
            bytes[at] = match random(4) {
                0 => random(256) as u8,
                1 => b"[]{},:\" "[random(8)],
                _ => b'0' + random(10) as u8,
            };
        }
        survived += usize::from(survive(bytes));
    }
    assert!(
        survived > 300,
        "the damage must leave some files readable, so that it reaches the readers: {survived}"
    );
}

#[test]
fn every_number_of_the_json_may_be_absurd() {
    fn numbers(value: &serde_json::Value, path: &str, out: &mut Vec<String>) {
        match value {
            serde_json::Value::Number(_) => out.push(path.to_owned()),
            serde_json::Value::Array(items) => {
                items
                    .iter()
                    .enumerate()
                    .for_each(|(i, v)| numbers(v, &format!("{path}/{i}"), out));
            }
            serde_json::Value::Object(members) => members
                .iter()
                .for_each(|(k, v)| numbers(v, &format!("{path}/{k}"), out)),
            _ => {}
        }
    }
    let m = rich_model();
    let mut paths = Vec::new();
    numbers(&m.json, "", &mut paths);
    assert!(paths.len() >= 80, "{}", paths.len());
    for path in &paths {
        for absurd in [
            json!(-1),
            json!(0),
            json!(1e308),
            json!(u64::MAX),
            json!(4294967295u64),
            json!("x"),
            json!(0.5),
        ] {
            let mut broken = rich_model();
            *broken.json.pointer_mut(path).unwrap() = absurd;
            survive(broken.text());
        }
    }
}

/// Files of some kilobytes that ask for memory or time without end. Each is refused, and quickly: the numbers that a
/// file may have are a few hundred million at most, however small it is.
#[test]
fn small_files_that_ask_for_much_are_refused() {
    let refused = |m: &Model, code: &str| {
        let begun = std::time::Instant::now();
        let (scene, diags) = m.try_load(&GltfOptions::default());
        assert!(scene.is_none(), "{code}");
        assert!(codes(&diags).contains(&code), "{code}: {:?}", codes(&diags));
        assert!(begun.elapsed().as_secs() < 30, "{code} took {:?}", begun.elapsed());
    };
    // Zeros that nothing holds: as positions, as a sparse base, as instances, as targets.
    let zeros = json!({"componentType": F32, "count": 4_000_000, "type": "VEC3"});
    let mut m = Model::triangle();
    m.json["accessors"] = json!(vec![zeros.clone(); 40]);
    m.json["meshes"][0]["primitives"] = (0..40)
        .map(|i| json!({"attributes": {"POSITION": i}, "indices": 39}))
        .collect();
    m.json["accessors"][39] = json!({"bufferView": 0, "componentType": U8, "count": 3, "type": "SCALAR"});
    refused(&m, "G0405");

    let mut m = Model::triangle();
    let places = m.push(
        "accessors",
        json!({"componentType": F32, "count": 5_000_000, "type": "VEC3"}),
    );
    let instancing = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    m.json["nodes"][0]["extensions"] = instancing.clone();
    refused(&m, "G0620");
    m.json["accessors"][places]["count"] = json!(100_000);
    m.json["nodes"] = json!(vec![json!({"mesh": 0, "extensions": instancing}); 50]);
    m.json["scenes"][0]["nodes"] = (0..50).collect();
    refused(&m, "G0620");

    // One view that many accessors read anew.
    let mut m = Model::new();
    let view = m.view(&vec![0x41; 1_200_000]);
    let accessor = json!({"bufferView": view, "componentType": U8, "count": 400_000, "type": "VEC3"});
    let corners = m.bytes("SCALAR", U8, 3, &[0, 1, 2]);
    let first = m.json["accessors"].as_array().unwrap().len();
    for _ in 0..2000 {
        m.push("accessors", accessor.clone());
    }
    let primitive = |i: usize| json!({"attributes": {"POSITION": first + i}, "indices": corners});
    m.push(
        "meshes",
        json!({"primitives": (0..2000).map(primitive).collect::<Vec<_>>()}),
    );
    refused(&m, "G0620");

    // One packed stream that many views unpack: 60 000 equal elements take two bits each.
    let count = 60_000;
    let mut stream = vec![0xA0];
    let mut left = count;
    while left > 0 {
        let block = left.min(256);
        (0..4).for_each(|_| stream.extend(vec![0; (block as usize).div_ceil(64)]));
        left -= block;
    }
    stream.extend([0; 32]);
    let mut m = Model::new();
    m.view(&stream);
    let packed = json!({"buffer": 0, "byteLength": count * 4, "extensions": {"EXT_meshopt_compression": {"buffer": 0,
        "byteLength": stream.len(), "byteStride": 4, "count": count, "mode": "ATTRIBUTES"}}});
    let mut primitives = Vec::new();
    for _ in 0..3000 {
        let view = m.push("bufferViews", packed.clone());
        let p = m.push(
            "accessors",
            json!({"bufferView": view, "componentType": U8, "count": 3, "type": "VEC3"}),
        );
        primitives.push(json!({"attributes": {"POSITION": p}}));
    }
    m.push("meshes", json!({"primitives": primitives}));
    refused(&m, "G0620");

    // A mesh that every node bends anew, and a skin that every node poses anew.
    let mut m = Model::triangle();
    m.json["meshes"][0]["primitives"] = json!(vec![json!({"attributes": {}, "mode": 0}); 2000]);
    m.json["nodes"] = json!(vec![json!({"mesh": 0, "weights": [0.5]}); 1000]);
    m.json["scenes"][0]["nodes"] = (0..1000).collect();
    refused(&m, "G0620");
    let mut m = Model::triangle();
    m.json["skins"] = json!([{"joints": vec![0; 20_000]}]);
    m.json["nodes"] = json!(vec![json!({"mesh": 0, "skin": 0}); 2000]);
    m.json["scenes"][0]["nodes"] = (0..2000).collect();
    refused(&m, "G0620");

    // Children that are named again and again below a deep chain.
    let mut m = Model::triangle();
    let depth = 20_000;
    let mut nodes: Vec<_> = (1..depth).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"children": vec![0; 20_000]}));
    m.json["nodes"] = json!(nodes);
    refused(&m, "G0503");
}

#[test]
fn json_of_too_many_values_is_refused_before_it_is_parsed() {
    let mut text = br#"{"asset":{"version":"2.0"},"extras":["[[[[,,,,\\\"{{{{",0"#.to_vec();
    text.extend(b",0".repeat(9_000_000));
    text.extend(b"]}");
    let mut files = MemoryFiles::default();
    files.insert("m.gltf", text);
    let (_, diags) = load_from(&files, "m.gltf", &GltfOptions::default());
    assert_eq!(codes(&diags), ["G0105"]);
    // What stands in strings is no value.
    let mut m = Model::triangle();
    m.json["extras"] = json!(",[{".repeat(5_000_000));
    m.load();
}
