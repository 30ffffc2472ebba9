//! Animations at a clock and over a shutter.

use crate::builder::{Model, U8, codes};
use glam::{DAffine3, DQuat, DVec3};
use pts::import::gltf::GltfOptions;
use pts::scene::{LightKind, Object, Scene};
use serde_json::{Value, json};

/// At a clock, with a shutter.
fn at(clock: Option<f64>, shutter: f64) -> GltfOptions {
    GltfOptions {
        clock,
        shutter,
        ..GltfOptions::default()
    }
}

impl Model {
    /// An animation of one channel.
    fn animate(&mut self, node: usize, path: &str, way: &str, times: &[f32], kind: &str, values: &[f32]) -> usize {
        let (input, output) = (self.floats("SCALAR", times), self.floats(kind, values));
        self.push(
            "animations",
            json!({
                "samplers": [{"input": input, "output": output, "interpolation": way}],
                "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
            }),
        )
    }
}

fn read(m: &Model, options: &GltfOptions) -> Scene {
    let (scene, diags) = m.try_load(options);
    assert_eq!(codes(&diags), Vec::<&str>::new(), "{diags:?}");
    scene.expect("a scene")
}

/// Where a point of the mesh is at key k.
fn point(object: &Object, k: usize, p: DVec3) -> DVec3 {
    let moved = object.motion.get(k).copied().unwrap_or(DAffine3::IDENTITY);
    (object.transform * moved).transform_point3(p)
}

/// One second along x, one up, one back.
fn mover(way: &str) -> Model {
    let mut m = Model::triangle();
    m.json["nodes"][0]["translation"] = json!([7, 0, 0]);
    let places = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    m.animate(0, "translation", way, &[0.0, 1.0, 2.0, 3.0], "VEC3", &places);
    m
}

#[test]
fn one_animation_is_chosen_by_its_name() {
    let mut m = mover("LINEAR");
    m.animate(
        0,
        "translation",
        "LINEAR",
        &[0.0, 1.0],
        "VEC3",
        &[0.0, 0.0, 5.0, 0.0, 0.0, 9.0],
    );
    for (i, name) in ["Walk", "Run"].into_iter().enumerate() {
        m.json["animations"][i]["name"] = json!(name);
    }
    let named = |animation: &str, clock: Option<f64>| GltfOptions {
        animation: Some(animation.to_owned()),
        ..at(clock, 0.0)
    };
    let place = |options: &GltfOptions| read(&m, options).objects[0].transform.translation;
    assert_eq!(place(&named("Walk", Some(1.0))), DVec3::X);
    assert_eq!(place(&named("Run", Some(1.0))), DVec3::Z * 9.0);
    assert_eq!(place(&named("Run", None)), DVec3::Z * 5.0);
    let (scene, diags) = m.try_load(&named("Fly", None));
    assert!(scene.is_none());
    assert_eq!(codes(&diags), ["G0903"]);
}

#[test]
fn without_clock_and_shutter_everything_stands_as_written() {
    let scene = read(&mover("LINEAR"), &at(None, 0.0));
    assert_eq!(scene.objects[0].transform.translation, DVec3::X * 7.0);
    assert!(scene.objects[0].motion.is_empty());
}

#[test]
fn a_clock_shows_a_moment() {
    for (way, clock, place) in [
        ("LINEAR", 0.0, DVec3::ZERO),
        ("LINEAR", 0.5, DVec3::X * 0.5),
        ("LINEAR", 1.25, DVec3::new(1.0, 0.25, 0.0)),
        ("LINEAR", 99.0, DVec3::ZERO),
        ("STEP", 1.75, DVec3::X),
        ("STEP", -3.0, DVec3::ZERO),
    ] {
        let scene = read(&mover(way), &at(Some(clock), 0.0));
        let object = &scene.objects[0];
        assert_eq!(object.transform.translation, place, "{way} at {clock}");
        assert!(object.motion.is_empty());
    }
}

/// Keys where the channel is; what an instance or a parent adds goes with them.
#[test]
fn a_shutter_gives_keys() {
    let mut m = mover("LINEAR");
    m.json["nodes"] = json!([{"translation": [7, 0, 0], "children": [1]},
        {"mesh": 0, "rotation": [0.0, 0.0, 0.6, 0.8], "scale": [2, 2, 2], "translation": [0, 0, 3]}]);
    let turn = |t: f64| DQuat::from_rotation_y((40.0 * t).to_radians());
    let turns: Vec<f32> = [0.0, 1.0].iter().flat_map(|&t| turn(t).as_quat().to_array()).collect();
    m.animate(0, "rotation", "LINEAR", &[0.0, 1.0], "VEC4", &turns);
    let scene = read(&m, &at(Some(0.25), 0.5));
    let object = &scene.objects[0];
    assert_eq!(object.motion.len(), 9);
    let child = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.0),
        DQuat::from_xyzw(0.0, 0.0, 0.6, 0.8),
        DVec3::Z * 3.0,
    );
    for k in 0..9 {
        let t = 0.25 + 0.5 * k as f64 / 8.0;
        let world = DAffine3::from_rotation_translation(turn(t), DVec3::X * t) * child;
        let p = DVec3::new(0.3, -0.5, 0.0);
        let off = point(object, k, p) - world.transform_point3(p);
        // Rotations are written in f32.
        assert!(off.length() < 1e-6, "{k}: {off}");
    }
}

#[test]
fn fast_turns_get_more_keys() {
    let mut m = Model::triangle();
    let turns: Vec<f32> = (0..=8)
        .flat_map(|k| {
            DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2 * f64::from(k))
                .as_quat()
                .to_array()
        })
        .collect();
    let times: Vec<f32> = (0..=8).map(|k| k as f32).collect();
    m.animate(0, "rotation", "LINEAR", &times, "VEC4", &turns);
    let keys = |shutter| read(&m, &at(None, shutter)).objects[0].motion.len();
    assert_eq!([keys(0.2), keys(4.0)], [9, 65]);
}

#[test]
fn cameras_and_lamps_go_with_their_nodes() {
    let mut m = mover("LINEAR");
    m.push(
        "cameras",
        json!({"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}),
    );
    m.json["nodes"][0]["camera"] = json!(0);
    m.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    m.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    let scene = read(&m, &at(Some(0.0), 1.0));
    let camera = scene.camera().expect("a camera");
    assert_eq!(camera.motion.len(), 9);
    assert_eq!(camera.motion[0], camera.key());
    assert_eq!(camera.motion[8].location, DVec3::X);
    let Some(LightKind::Point { position, .. }) = scene.lights[0].motion.get(4) else {
        panic!("{:?}", scene.lights[0])
    };
    assert_eq!(*position, DVec3::X * 0.5);
    assert!(scene.lights[0].moves() && camera.moves());
}

/// What does not move over this shutter has no motion, though it is animated.
#[test]
fn a_channel_that_holds_still_is_no_motion() {
    let scene = read(&mover("LINEAR"), &at(Some(10.0), 2.0));
    assert!(!scene.objects[0].moves());
    assert!(!read(&mover("STEP"), &at(Some(0.1), 0.5)).objects[0].moves());
}

/// Several animations are one, as long as they move different things; the first comes first.
#[test]
fn animations_that_move_the_same_are_not_mixed() {
    let mut m = mover("LINEAR");
    m.animate(
        0,
        "scale",
        "LINEAR",
        &[0.0, 1.0],
        "VEC3",
        &[1.0, 1.0, 1.0, 3.0, 3.0, 3.0],
    );
    m.animate(0, "translation", "LINEAR", &[0.0, 1.0], "VEC3", &[50.0; 6]);
    let (scene, diags) = m.try_load(&at(Some(0.5), 0.0));
    assert_eq!(codes(&diags), ["G0901"]);
    let object = &scene.expect("a scene").objects[0];
    assert_eq!(point(object, 0, DVec3::X), DVec3::X * 2.5);
}

/// Where the first vertex is at each moment.
fn ways(scene: &Scene) -> Vec<DVec3> {
    let mesh = &scene.meshes[0];
    let forms = std::iter::once(&mesh.positions).chain(mesh.later.iter().map(|f| &f.positions));
    forms.map(|p| mesh.center + p[0].as_dvec3()).collect()
}

/// Nine forms at equal steps, where the weights are then.
#[test]
fn morph_targets_move_over_the_shutter() {
    let mut m = Model::triangle();
    let d = m.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    m.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": d}]);
    m.json["meshes"][0]["weights"] = json!([0.0]);
    m.animate(0, "weights", "LINEAR", &[0.0, 1.0], "SCALAR", &[0.0, 4.0]);
    assert_eq!(ways(&read(&m, &at(Some(0.5), 0.0))), [DVec3::X * 2.0]);
    let scene = read(&m, &at(Some(0.5), 0.5));
    let expected: Vec<DVec3> = (0..9).map(|k| DVec3::X * (2.0 + 0.25 * f64::from(k))).collect();
    assert_eq!(ways(&scene), expected);
    assert!(scene.moves() && !scene.objects[0].moves());
    // Behind the last key nothing changes.
    assert!(!read(&m, &at(Some(2.0), 0.5)).moves());
}

/// A joint takes its vertices along: here with a turn, met at each moment.
#[test]
fn skins_move_over_the_shutter() {
    let mut m = Model::triangle();
    let joints = m.bytes("VEC4", U8, 3, &[0; 12]);
    let weights = m.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    let normals = m.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let attributes = &mut m.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    attributes["NORMAL"] = json!(normals);
    m.json["skins"] = json!([{"joints": [2]}]);
    m.json["nodes"] = json!([{"mesh": 0, "skin": 0, "translation": [9, 9, 9]}, {"children": [2]}, {}]);
    m.json["scenes"][0]["nodes"] = json!([0, 1]);
    m.animate(
        1,
        "translation",
        "LINEAR",
        &[0.0, 1.0],
        "VEC3",
        &[0.0, 0.0, 0.0, 0.0, 8.0, 0.0],
    );
    let turn = |t: f64| DQuat::from_rotation_y((40.0 * t).to_radians());
    let turns: Vec<f32> = [0.0, 1.0].iter().flat_map(|&t| turn(t).as_quat().to_array()).collect();
    m.animate(2, "rotation", "LINEAR", &[0.0, 1.0], "VEC4", &turns);
    let posed = ways(&read(&m, &at(Some(0.5), 0.0)));
    assert!(
        posed.len() == 1 && (posed[0] - DVec3::Y * 4.0).length() < 1e-6,
        "{posed:?}"
    );
    let scene = read(&m, &at(Some(0.5), 0.5));
    let mesh = &scene.meshes[0];
    assert_eq!(ways(&scene).len(), 9);
    for (k, place) in ways(&scene).iter().enumerate() {
        let t = 0.5 + 0.5 * k as f64 / 8.0;
        assert!((*place - DVec3::Y * 8.0 * t).length() < 1e-6, "{k}: {place}");
        if k > 0 {
            let off = mesh.later[k - 1].normals[0].as_dvec3() - turn(t) * DVec3::Z;
            // Rotations are written in f32.
            assert!(off.length() < 1e-6, "{k}: {off}");
        }
    }
    assert!(!scene.objects[0].moves(), "the node's own place does not count");
}

/// Each is told with its place; nothing panics, and without a clock nobody looks.
#[test]
fn broken_animations_are_told_where_they_are() {
    let edits: [(&str, Value, &str, bool); 14] = [
        ("/animations/0/channels/0/sampler", json!(9), "G0902", true),
        ("/animations/0/channels/0/sampler", json!("a"), "G0203", true),
        (
            "/animations/0/channels/0/target",
            json!({"node": 99, "path": "scale"}),
            "G0202",
            true,
        ),
        ("/animations/0/channels/0/target/path", json!("colour"), "G0902", true),
        ("/animations/0/channels/0/target/path", json!("rotation"), "G0402", true),
        ("/animations/0/samplers/0/input", json!(77), "G0202", true),
        ("/animations/0/samplers/0/output", json!(-1), "G0203", true),
        ("/animations/0/samplers/0", json!({"input": 1}), "G0902", true),
        (
            "/animations/0/samplers/0/interpolation",
            json!("CUBICSPLINE"),
            "G0904",
            true,
        ),
        (
            "/animations/0/samplers/0/interpolation",
            json!("BOUNCE"),
            "G0903",
            false,
        ),
        ("/accessors/1/count", json!(3), "G0904", true),
        ("/accessors/1/count", json!(99), "G0404", true),
        (
            "/nodes/0",
            json!({"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}),
            "G0903",
            false,
        ),
        ("/accessors/1/componentType", json!(5121), "G0904", false),
    ];
    for (path, value, code, is_error) in edits {
        let mut m = mover("LINEAR");
        *m.json.pointer_mut(path).expect("it is there") = value.clone();
        let (scene, diags) = m.try_load(&at(Some(0.5), 1.0));
        assert!(codes(&diags).contains(&code), "{path} = {value}: {diags:?}");
        assert_eq!(scene.is_none(), is_error, "{path} = {value}: {diags:?}");
        let has_place = |d: &pts::diag::Diagnostic| d.place.as_deref().is_some_and(|p| p.contains("model.gltf: "));
        assert!(diags.iter().all(has_place), "{diags:?}");
        let (scene, _) = m.try_load(&at(None, 0.0));
        assert!(
            scene.is_some() || path.starts_with("/accessors"),
            "{path}: nobody asks for animations"
        );
    }
    // Times that stand still or run backwards, and values that are none.
    for (times, value) in [
        ([0.0, 0.0], 1.0),
        ([1.0, 0.0], 1.0),
        ([0.0, f32::NAN], 1.0),
        ([0.0, 1.0], f32::INFINITY),
    ] {
        let mut m = Model::triangle();
        m.animate(0, "translation", "LINEAR", &times, "VEC3", &[value; 6]);
        let (scene, diags) = m.try_load(&at(Some(0.5), 1.0));
        assert_eq!(codes(&diags), ["G0904"]);
        assert!(scene.is_some_and(|s| !s.objects[0].moves()));
    }
}
