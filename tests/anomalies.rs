//! Nothing is repaired in silence: every kind of repair is injected, and seen in the summary, in the events and in the
//! metadata of the picture.

use assert_cmd::Command;
use pts::diag::Anomaly;
use pts::pictures::exr::{ChannelData, NamedChannel, encode};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

const VIEW: &str = "#version 3.8; camera { location <0, 0, -4> look_at 0 angle 40 }\n";

/// Renders 8x8 pixels and returns what was told, the JSON of the picture and that of the last event.
fn render(dir: &Path, scene: &str) -> (String, Value, Value) {
    std::fs::write(dir.join("a.pts"), format!("{VIEW}{scene}")).expect("the scene is written");
    let run = |more: &[&str]| {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        command
            .current_dir(dir)
            .args(["render", "a.pts", "-r", "8x8", "--spp", "16", "-o", "a.exr"]);
        let output = command.args(more).output().expect("the program starts");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        told
    };
    let told = run(&[]);
    let events = run(&["--progress", "json"]);
    let last = events.lines().last().expect("an event");
    let image = ::exr::image::read::read_first_flat_layer_from_file(dir.join("a.exr")).expect("the picture is read");
    let attributes = &image.layer_data.attributes.other;
    let (_, text) = attributes.iter().find(|(name, _)| **name == *"pts").expect("metadata");
    let ::exr::meta::attribute::AttributeValue::Text(text) = text else {
        panic!("the metadata is no text");
    };
    let json = |text: &str| serde_json::from_str(text).expect("JSON");
    (told, json(&text.to_string()), json(last))
}

#[track_caller]
fn assert_counted(dir: &TempDir, kind: Anomaly, at_least: u64, scene: &str) {
    let (told, metadata, event) = render(dir.path(), scene);
    let n = |json: &Value| json["anomalies"][kind.word()].as_u64();
    let found = n(&metadata).expect("every kind is listed");
    assert!(found >= at_least, "{kind:?}: {found}, expected {at_least}\n{told}");
    assert_eq!(n(&event), Some(found), "{kind:?}");
    assert!(told.contains(kind.sentence()), "{kind:?} is not told:\n{told}");
    for other in Anomaly::ALL.into_iter().filter(|k| *k != kind) {
        assert_eq!(
            metadata["anomalies"][other.word()],
            0,
            "{other:?} beside {kind:?}\n{told}"
        );
    }
}

fn bench() -> TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

#[test]
fn a_sound_scene_has_none() {
    let (told, metadata, _) = render(
        bench().path(),
        "sphere { 0, 1 material { diffuse { color rgb 1 } emission 1 } }",
    );
    assert!(told.contains("anomalies: none"), "{told}");
    for kind in Anomaly::ALL {
        assert_eq!(metadata["anomalies"][kind.word()], 0);
    }
}

/// Two surfaces of 3e38 that light each other are brighter than f32 goes.
#[test]
fn samples_beyond_all_numbers_are_counted() {
    let glowing = "material { diffuse { color rgb 0.9 } emission rgb 3e38 }";
    let scene = format!("sphere {{ 0, 10 {glowing} }} sphere {{ 0, 1 {glowing} }}");
    assert_counted(&bench(), Anomaly::NonFinite, 100, &scene);
}

#[test]
fn surfaces_nested_too_deeply_are_counted() {
    let sheets = "#for (I, 1, 5000) disc { z * I / 1000, z, 9 pigment { rgbt <1, 1, 1, 0.99999> } } #end";
    assert_counted(&bench(), Anomaly::StackOverflow, 1, sheets);
}

#[test]
fn faces_without_area_are_counted() {
    let white = "material { diffuse { color rgb 1 } }";
    let sound = "triangle { <-1,-1,0>, <1,-1,0>, <0,1,0> }";
    let flat = "triangle { <0,0,0>, <1,0,0>, <2,0,0> }";
    let repeated = "triangle { <0,0,0>, <1,0,0>, <1,0,0> }";
    let mesh = format!("mesh {{ {sound} {flat} {repeated} {white} }}");
    assert_counted(&bench(), Anomaly::DroppedFace, 2, &mesh);
    let loose = format!("triangle {{ <0,0,0>, <1,0,0>, <2,0,0> {white} }} sphere {{ 0, 1 {white} }}");
    assert_counted(&bench(), Anomaly::DroppedFace, 1, &loose);
}

#[test]
fn objects_that_cannot_be_drawn_are_counted() {
    let dir = bench();
    let corners: Vec<u8> = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        base64::Engine::encode(&base64::engine::general_purpose::STANDARD, corners)
    );
    let model = serde_json::json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 36, "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "scale": [1, 0, 1]}],
    });
    std::fs::write(dir.path().join("a.gltf"), model.to_string()).expect("the model is written");
    assert_counted(
        &dir,
        Anomaly::DroppedShape,
        1,
        "gltf { \"a.gltf\" } background { rgb 1 }",
    );
}

#[test]
fn lamps_brighter_than_numbers_go_are_counted() {
    let scene = "light_source { <0, 5, 0> rgb 1e39 } sphere { 0, 1 }";
    assert_counted(&bench(), Anomaly::DroppedShape, 1, scene);
}

#[test]
fn normals_without_direction_are_counted() {
    let mesh = "mesh2 { vertex_vectors { 3, <-1,-1,0>, <1,-1,0>, <0,1,0> } \
                normal_vectors { 3, <0,0,-1>, <0,0,0>, <0,0,-1> } face_indices { 1, <0,1,2> } }";
    assert_counted(&bench(), Anomaly::ReplacedNormal, 1, mesh);
}

#[test]
fn values_that_are_moved_are_counted() {
    assert_counted(&bench(), Anomaly::MovedValue, 1, "sphere { 0, 1 scale <1, 0, 1> }");
}

#[test]
fn texels_that_are_no_light_are_counted() {
    let dir = bench();
    let channel = |name: &str, data: [f32; 4]| NamedChannel {
        name: name.to_owned(),
        data: ChannelData::F32(data.to_vec()),
    };
    let channels = vec![
        channel("R", [1.0, f32::NAN, 1.0, 1.0]),
        channel("G", [1.0, 1.0, f32::INFINITY, 1.0]),
        channel("B", [1.0, 1.0, 1.0, -1.0]),
    ];
    let bytes = encode([2, 2], channels, None).expect("an image");
    std::fs::write(dir.path().join("sky.exr"), bytes).expect("written");
    assert_counted(
        &dir,
        Anomaly::BadTexel,
        3,
        "environment { image \"sky.exr\" } sphere { 0, 1 }",
    );
}

/// Parts of one picture: what belongs to the scene counts once, what belongs to samples adds up.
#[test]
fn merged_parts_count_the_scene_once() {
    let dir = bench();
    let scene = format!("{VIEW} sphere {{ 0, 1 scale <1, 0, 1> }}");
    std::fs::write(dir.path().join("a.pts"), scene).expect("written");
    let run = |words: &[&str]| {
        let mut command = Command::cargo_bin("pts").expect("the program is built");
        let output = command.current_dir(dir.path()).args(words).output().expect("it starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let samples = [("0..16", "a.ptspart"), ("16..32", "b.ptspart")];
    for (range, part) in samples {
        run(&["render", "a.pts", "-r", "8x8", "--samples", range, "-o", part]);
    }
    run(&["merge", "a.ptspart", "b.ptspart", "-o", "c.exr"]);
    let bytes = std::fs::read(dir.path().join("c.exr")).expect("the picture");
    let text = String::from_utf8_lossy(&bytes);
    assert!(
        text.contains("\"moved_values\":1,"),
        "not once: {}",
        &text[..2000.min(text.len())]
    );
}
