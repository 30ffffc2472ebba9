//! Draco: `data/ring-draco-*.glb` are `data/ring.glb` packed by the extension's reference encoder (positions 14 bits,
//! normals 10, texture coordinates and generic attributes 12, colours 8), so that the plain ring is the oracle.

use crate::builder::*;
use glam::{DVec3, Vec2, Vec3, Vec4};
use pts::diag::Severity;
use pts::import::gltf::GltfOptions;
use pts::scene::{Mesh, Scene};
use serde_json::json;

const PLAIN: &[u8] = include_bytes!("data/ring.glb");
const PACKED: [&[u8]; 2] = [
    include_bytes!("data/ring-draco-edgebreaker.glb"),
    include_bytes!("data/ring-draco-sequential.glb"),
];

/// A corner of a triangle with all its attributes.
type Corner = (DVec3, Vec3, Vec2, Vec4);

fn corners(mesh: &Mesh) -> Vec<[Corner; 3]> {
    let at = |v: u32| {
        let v = v as usize;
        let p = mesh.center + mesh.positions[v].as_dvec3();
        (p, mesh.normals[v], mesh.uvs[0][v], mesh.colors[v])
    };
    mesh.triangles.iter().map(|t| t.map(at)).collect()
}

/// Half a step of each quantisation. The ring is 5.4 wide; joint 1 lifts by its weight, whose two numbers are rounded
/// and then divided by their sum.
fn is_same(a: &Corner, b: &Corner) -> bool {
    let weight = 0.5 / 4095.0;
    let position = DVec3::splat(0.5 * 5.4 / 16383.0) + DVec3::Y * 2.0 * weight;
    // Half the diagonal of a step on the octahedron, which unfolding it to the sphere stretches by less than 2.
    let normal = 2.0 * 2f32.sqrt() / 1023.0;
    let slack = 1e-6; // rounding of f32 numbers up to 4
    (a.0 - b.0).abs().cmple(position + slack).all()
        && (a.1 - b.1).length() <= normal
        && (a.2 - b.2).abs().max_element() <= (0.5 / 4095.0) + 1e-6
        && a.3 == b.3
}

fn assert_same(plain: &Scene, packed: &Scene) {
    let (plain, packed) = (corners(&plain.meshes[0]), corners(&packed.meshes[0]));
    assert_eq!(plain.len(), packed.len());
    let mut left = plain;
    for face in &packed {
        // Packing may turn a triangle, but not mirror it.
        let turned = |t: &[Corner; 3]| (0..3).any(|k| (0..3).all(|i| is_same(&t[(i + k) % 3], &face[i])));
        let found = left.iter().position(turned).unwrap_or_else(|| panic!("{face:?}"));
        left.swap_remove(found);
    }
}

#[test]
fn draco_data_of_both_kinds_hold_the_triangles_of_the_plain_model() {
    let plain = Model::from_glb(PLAIN).load();
    assert_eq!(plain.meshes[0].triangles.len(), 96);
    for packed in PACKED {
        let (scene, diags) = Model::from_glb(packed).try_load(&GltfOptions::default());
        assert!(diags.is_empty(), "{diags:?}");
        assert_same(&plain, &scene.unwrap());
    }
}

#[test]
fn primitives_may_share_draco_data_and_strips_are_triangles_there() {
    let mut m = Model::from_glb(PACKED[0]);
    let mut second = m.json["meshes"][0]["primitives"][0].clone();
    second["mode"] = json!(5);
    m.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    assert_eq!(m.load().meshes[0].triangles.len(), 192);
}

#[test]
fn morph_targets_beside_draco_data_move_its_points() {
    let mut m = Model::from_glb(PACKED[1]);
    let lift = m.floats("VEC3", &[0.0, 0.0, 3.0].repeat(48));
    m.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": lift}]);
    let before = m.load().meshes[0].center;
    m.json["meshes"][0]["weights"] = json!([0.5]);
    let after = m.load().meshes[0].center;
    assert!((after - before - DVec3::Z * 1.5).length() < 1e-6, "{before} {after}");
}

/// The plain ring with the packed one's data beside it, of which `damage` is made.
fn with_both(damage: impl Fn(&mut Vec<u8>)) -> Model {
    let packed = Model::from_glb(PACKED[0]);
    let mut stream = packed.bin[..1025].to_vec();
    damage(&mut stream);
    let mut m = Model::from_glb(PLAIN);
    let view = m.view(&stream);
    let mut extension = packed.json["meshes"][0]["primitives"][0]["extensions"].clone();
    extension["KHR_draco_mesh_compression"]["bufferView"] = json!(view);
    m.json["meshes"][0]["primitives"][0]["extensions"] = extension;
    m
}

#[test]
fn plain_data_beside_draco_data_serve_where_those_are_broken() {
    let plain = Model::from_glb(PLAIN).load();
    assert_same(&plain, &with_both(|_| ()).load());
    let broken = with_both(|stream| stream.truncate(600));
    let (scene, diags) = broken.try_load(&GltfOptions::default());
    assert_same(&plain, &scene.unwrap());
    assert_eq!(codes(&diags), ["G0315"]);
    assert!(diags.iter().all(|d| d.severity == Severity::Warning));
}

#[test]
fn draco_data_without_anything_beside_them_are_an_error_where_they_are_broken() {
    let whole = Model::from_glb(PACKED[0]);
    let is_refused = |m: &Model| {
        let (scene, diags) = m.try_load(&GltfOptions::default());
        let at = diags.iter().next().and_then(|d| d.place.clone()).unwrap_or_default();
        scene.is_none() && at.ends_with("meshes[0].primitives[0].extensions.KHR_draco_mesh_compression")
    };
    for length in (0..1000).step_by(37) {
        let mut m = Model::from_glb(PACKED[0]);
        m.json["bufferViews"][0]["byteLength"] = json!(length);
        assert!(is_refused(&m), "cut at {length}");
    }
    for (key, value) in [
        ("bufferView", json!("x")),
        ("attributes", json!({"POSITION": 77})),
        ("attributes", json!(1)),
    ] {
        let mut m = Model::from_glb(PACKED[0]);
        m.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"][key] = value;
        assert!(is_refused(&m), "{key}");
    }
    // A damaged byte gives other numbers or an error, but always an end.
    for at in 0..1025 {
        for flip in [1, 0x80, 0xFF] {
            let mut m = Model::from_glb(PACKED[at % 2]);
            m.bin[at] ^= flip;
            m.try_load(&GltfOptions::default());
        }
    }
    assert!(whole.try_load(&GltfOptions::default()).0.is_some());
}
