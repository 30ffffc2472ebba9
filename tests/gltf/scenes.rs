//! Nodes, instances, cameras, lamps, scenes and variants.

use crate::builder::*;
use glam::{DAffine3, DMat3, DVec3};
use pts::import::gltf::GltfOptions;
use pts::scene::{Aspect, Falloff, Handedness, LightKind, Projection, Shape, SpotProfile};
use serde_json::json;
use std::f64::consts::PI;

fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() <= 1e-7 * (1.0 + b.length())
}

#[test]
fn transforms_multiply_down_the_tree_and_meshes_are_shared() {
    let mut m = Model::triangle();
    let half = (PI / 4.0).sin(); // a quarter turn about y
    m.json["nodes"] = json!([
        {"name": "top", "translation": [10, 0, 0], "rotation": [0, half, 0, half], "scale": [2, 2, 2], "children": [1, 2]},
        {"name": "a", "mesh": 0, "translation": [1, 0, 0]},
        {"mesh": 0, "matrix": [1, 0, 0, 0,  0.5, 1, 0, 0,  0, 0, -1, 0,  0, 0, 3, 1]},
    ]);
    let scene = m.load();
    assert_eq!(scene.handedness, Handedness::Right);
    assert_eq!(scene.meshes.len(), 1);
    let [a, b] = &scene.objects[..] else {
        panic!("{:?}", scene.objects);
    };
    assert_eq!((a.name.as_str(), b.name.as_str()), ("a", "nodes[2]"));
    assert_eq!(a.shape, b.shape);
    assert!(close(
        a.transform.transform_point3(DVec3::ZERO),
        DVec3::new(10.0, 0.0, -2.0)
    ));
    // The sheared, mirrored one: (1, 2, 3) → (2, 2, −3) + (0, 0, 3) → doubled and turned.
    assert!(close(
        b.transform.transform_point3(DVec3::new(1.0, 2.0, 3.0)),
        DVec3::new(10.0, 4.0, -4.0)
    ));
    assert!(b.transform.matrix3.determinant() < 0.0);
}

#[test]
fn what_stands_far_away_keeps_its_place_to_the_last_bit() {
    let mut m = Model::triangle();
    let place = [6378137.123456789, -0.1, 1e-9];
    m.json["nodes"] = json!([{"mesh": 0, "translation": place},
        {"mesh": 0, "matrix": [0.1, 0, 0, 0,  0, 0.1, 0, 0,  0, 0, 0.1, 0,  place[0], place[1], place[2], 1]}]);
    m.json["scenes"][0]["nodes"] = json!([0, 1]);
    for object in &m.load().objects {
        assert_eq!(object.transform.translation.to_array(), place);
    }
}

#[test]
fn flattened_nodes_are_not_drawn_and_hidden_ones_hide_their_children() {
    let mut m = Model::triangle();
    m.json["nodes"] = json!([
        {"children": [1, 2, 3]},
        {"mesh": 0, "scale": [1, 0, 1]},
        {"children": [4], "extensions": {"KHR_node_visibility": {"visible": false}}},
        {"mesh": 0, "name": "seen"},
        {"mesh": 0, "name": "hidden"},
    ]);
    let scene = m.load();
    assert_eq!(
        scene.objects.iter().map(|o| o.name.as_str()).collect::<Vec<_>>(),
        ["seen"]
    );
    assert_eq!(m.codes(), ["G0507"]);
}

/// A quaternion of length 2 is the rotation of its direction; of length 0 it is none, told elsewhere.
#[test]
fn rotations_of_any_length_turn_and_do_not_stretch() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let turned = |length: f64| {
        let mut m = Model::triangle();
        m.json["nodes"] = json!([{"mesh": 0, "rotation": [0, half * length, 0, half * length]}]);
        let map = m.load().objects[0].transform.matrix3;
        assert!(m.codes().is_empty(), "{:?}", m.codes());
        map
    };
    for length in [1.0, 2.0, 1e-3, 1e6] {
        let off = (turned(length) - glam::DMat3::from_rotation_y(std::f64::consts::FRAC_PI_2)).to_cols_array();
        // Normalisation and the nine sums of two products: some ten roundings of f64.
        assert!(off.iter().all(|x| x.abs() <= 10.0 * f64::EPSILON), "{length}: {off:?}");
    }
}

#[test]
fn instances_multiply_the_node() {
    let mut m = Model::triangle();
    let t = m.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 5.0, 0.0]);
    let s = m.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let r = m.bytes(
        "VEC4",
        I16,
        2,
        &[0, 0, 0, 0, 0, 0, 255, 127, 0, 0, 255, 127, 0, 0, 0, 0],
    );
    m.json["accessors"][r]["normalized"] = json!(true);
    m.json["nodes"][0]["translation"] = json!([1, 0, 0]);
    m.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": t, "SCALE": s, "ROTATION": r}}});
    m.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = m.load();
    assert_eq!((scene.meshes.len(), scene.objects.len()), (1, 2));
    assert_eq!(scene.objects[0].transform, DAffine3::from_translation(DVec3::X));
    // Half a turn about y and doubled: (1, 0, 0) → (−2, 0, 0).
    assert!(close(
        scene.objects[1].transform.transform_point3(DVec3::X),
        DVec3::new(-1.0, 5.0, 0.0)
    ));
}

#[test]
fn a_perspective_camera_looks_along_minus_z_with_its_vertical_angle() {
    let mut m = Model::triangle();
    m.json["cameras"] = json!([
        {"name": "eye", "type": "perspective", "perspective": {"yfov": PI / 2.0, "aspectRatio": 2.0, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 100}},
    ]);
    m.json["nodes"] = json!([{"mesh": 0}, {"camera": 0, "translation": [0, 0, 9], "scale": [5, 5, 5]}, {"camera": 1}]);
    m.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = m.load();
    assert_eq!(scene.active_camera, Some(0));
    assert!(!scene.is_bare_model);
    let [eye, flat] = &scene.cameras[..] else {
        panic!("{:?}", scene.cameras);
    };
    assert_eq!((eye.name.as_str(), flat.name.as_str()), ("eye", "nodes[2]"));
    assert_eq!(
        (eye.projection, eye.aspect),
        (Projection::Perspective, Aspect::FromImage)
    );
    assert_eq!((eye.location, eye.direction), (DVec3::Z * 9.0, DVec3::NEG_Z));
    assert!(
        close(eye.up, DVec3::Y * 2.0) && close(eye.right, DVec3::X * 4.0),
        "{eye:?}"
    );
    assert_eq!(flat.projection, Projection::Orthographic);
    assert_eq!((flat.right, flat.up), (DVec3::X * 6.0, DVec3::Y * 4.0));
}

#[test]
fn lamps_take_candela_and_lux() {
    let mut m = Model::triangle();
    m.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "name": "bulb", "color": [1, 0.5, 0], "intensity": 40, "range": 7},
        {"type": "directional", "intensity": PI},
        {"type": "spot", "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
    ]}});
    let light = |i| json!({"KHR_lights_punctual": {"light": i}});
    let turned = (PI / 4.0).sin(); // a quarter turn about x takes −z to +y
    m.json["nodes"] = json!([
        {"mesh": 0},
        {"translation": [1, 2, 3], "scale": [4, 4, 4], "extensions": light(0)},
        {"rotation": [turned, 0, 0, turned], "extensions": light(1)},
        {"extensions": light(2)},
    ]);
    m.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = m.load();
    assert!(!scene.is_bare_model);
    let [bulb, sun, spot] = &scene.lights[..] else {
        panic!("{:?}", scene.lights);
    };
    assert_eq!((bulb.name.as_str(), bulb.color), ("bulb", DVec3::new(40.0, 20.0, 0.0)));
    let falloff = Falloff::InverseSquare { range: Some(7.0) };
    let position = DVec3::new(1.0, 2.0, 3.0);
    assert_eq!(bulb.kind, LightKind::Point { position, falloff });
    // E = π·colour must be π lux.
    assert!(close(sun.color, DVec3::ONE));
    assert!(matches!(sun.kind, LightKind::Directional { direction } if close(direction, DVec3::Y)));
    let LightKind::Spot {
        axis, profile, falloff, ..
    } = &spot.kind
    else {
        panic!("{spot:?}");
    };
    assert_eq!(*axis, DVec3::NEG_Z);
    assert_eq!(
        *profile,
        SpotProfile::Punctual {
            inner: 0.25,
            outer: 0.5
        }
    );
    assert_eq!(*falloff, Falloff::InverseSquare { range: None });
    assert_eq!(spot.color, DVec3::ONE);
}

#[test]
fn scenes_are_chosen_by_name_or_number() {
    let mut m = Model::triangle();
    m.json["nodes"] = json!([{"mesh": 0, "name": "first"}, {"mesh": 0, "name": "second"}]);
    m.json["scenes"] = json!([{"name": "day", "nodes": [0]}, {"name": "night", "nodes": [1]}, {}]);
    let load = |scene: Option<&str>| {
        let options = GltfOptions {
            scene: scene.map(str::to_owned),
            ..GltfOptions::default()
        };
        let (scene, diags) = m.try_load(&options);
        (
            scene.map(|s| s.objects.iter().map(|o| o.name.clone()).collect::<Vec<_>>()),
            codes(&diags),
        )
    };
    assert_eq!(load(None), (Some(vec!["first".to_owned()]), vec![]));
    assert_eq!(load(Some("night")), (Some(vec!["second".to_owned()]), vec![]));
    assert_eq!(load(Some("1")), (Some(vec!["second".to_owned()]), vec![]));
    assert_eq!(
        load(Some("2")),
        (Some(vec![]), vec!["G0501"]),
        "an empty scene is legal"
    );
    assert_eq!(load(Some("dusk")), (None, vec!["G0502"]));
}

#[test]
fn without_scenes_all_trees_are_drawn() {
    let mut m = Model::triangle();
    m.json["nodes"] = json!([{"mesh": 0}, {"children": [0]}, {"mesh": 0}]);
    m.json.as_object_mut().unwrap().remove("scenes");
    m.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(m.load().objects.len(), 2);
}

#[test]
fn a_variant_changes_the_material() {
    let mut m = Model::with_material(json!({"name": "plain"}));
    m.push("materials", json!({"name": "gold"}));
    m.json["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "cheap"}, {"name": "rich"}]}});
    m.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [1]}]}});
    let worn = |variant: Option<&str>| {
        let options = GltfOptions {
            variant: variant.map(str::to_owned),
            ..GltfOptions::default()
        };
        let (scene, diags) = m.try_load(&options);
        scene.map_or_else(|| codes(&diags)[0].to_owned(), |s| s.materials[0].name.clone())
    };
    assert_eq!(worn(None), "plain");
    assert_eq!(worn(Some("cheap")), "plain");
    assert_eq!(worn(Some("rich")), "gold");
    assert_eq!(worn(Some("poor")), "G0708");
}

#[test]
fn a_deep_chain_of_nodes_is_walked() {
    let mut m = Model::triangle();
    let n = 20_000;
    let nodes = (0..n).map(|i| json!({"translation": [1, 0, 0], "children": [i + 1]}));
    m.json["nodes"] = nodes.chain([json!({"mesh": 0})]).collect();
    let scene = m.load();
    assert_eq!(scene.objects[0].transform.translation, DVec3::X * f64::from(n));
    assert_eq!(scene.objects[0].transform.matrix3, DMat3::IDENTITY);
    assert!(matches!(scene.objects[0].shape, Shape::Mesh(_)));
}
