//! Models inside of text scenes: what is taken from the file, what replaces its materials, what is shared, and that
//! nothing is mirrored.

#[allow(dead_code)] // the builder serves other suites too
#[path = "gltf/builder.rs"]
mod builder;
mod support;

use builder::Model;
use glam::DVec3;
use pts::compile::compile;
use pts::diag::{Diagnostics, SourceMap};
use pts::files::MemoryFiles;
use pts::load::{LoadOptions, load};
use pts::render::driver;
use pts::render::report::Silent;
use pts::scene::{Scene, Shape};
use serde_json::json;
use support::scenes::settings;

/// Reads a text beside a model.
fn try_read(model: &Model, text: &str) -> (Option<Scene>, Diagnostics, MemoryFiles) {
    let mut files = MemoryFiles::default();
    files.insert("model.gltf", model.text());
    files.insert("scene.pts", text.as_bytes());
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load(
        "scene.pts".as_ref(),
        &files,
        &LoadOptions::default(),
        &mut sources,
        &mut diags,
    );
    (scene, diags, files)
}

fn read(model: &Model, text: &str) -> Scene {
    let (scene, diags, _) = try_read(model, text);
    scene.unwrap_or_else(|| panic!("{diags:#?}"))
}

fn error(model: &Model, text: &str) -> String {
    let (scene, diags, _) = try_read(model, text);
    assert!(scene.is_none(), "{text} was read");
    let first = diags.iter().next().expect("a refusal has a reason");
    format!("{} {}", first.message, first.hints.join(" "))
}

/// A cart at (0, 5, 0) with a wheel on it at (1, 0, 0) of the cart, turned; a lamp and a camera beside them.
fn cart() -> Model {
    let mut m = Model::with_material(json!({"name": "Wood"}));
    m.push("materials", json!({"name": "Iron"}));
    let p = m.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].clone();
    m.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": p}, "material": 1}]}),
    );
    m.json["nodes"] = json!([
        {"name": "Cart", "mesh": 0, "translation": [0, 5, 0], "children": [1]},
        {"name": "Wheel", "mesh": 1, "translation": [1, 0, 0], "rotation": [0, 0, 0.6, 0.8]},
        {"name": "Sun", "extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 9, 0]},
        {"name": "Eye", "camera": 0, "translation": [0, 0, 8]},
    ]);
    m.json["scenes"][0]["nodes"] = json!([0, 2, 3]);
    m.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    m.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    m.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 2, "znear": 0.1}}]);
    m
}

/// The first corner of all triangles, in the space of the scene.
fn corners(scene: &Scene) -> Vec<DVec3> {
    let mut out = Vec::new();
    for object in &scene.objects {
        let Shape::Group(group) = object.shape else { continue };
        for inner in &scene.groups[group.index()].objects {
            let Shape::Mesh(mesh) = inner.shape else { continue };
            let mesh = &scene.meshes[mesh.index()];
            let corner = mesh.center + mesh.positions[0].as_dvec3();
            out.push((object.transform * inner.transform).transform_point3(corner));
        }
    }
    out
}

fn near(a: &[DVec3], b: &[DVec3]) {
    assert_eq!(a.len(), b.len(), "{a:?}, not {b:?}");
    // Translations are exact, rotations of unit size are rounded.
    assert!(
        a.iter().zip(b).all(|(a, b)| (*a - *b).length() < 1e-12),
        "{a:?}, not {b:?}"
    );
}

/// z points away from the viewer in text scenes: models are mirrored along it.
#[test]
fn a_node_is_drawn_in_its_place_or_in_its_own_space() {
    let all = corners(&read(&cart(), "gltf { \"model.gltf\" }"));
    near(&all, &[DVec3::new(0.0, 5.0, 0.0), DVec3::new(1.0, 5.0, 0.0)]);
    let wheel = read(&cart(), "gltf { \"model.gltf\" node \"Wheel\" translate z }");
    near(&corners(&wheel), &[DVec3::new(1.0, 5.0, 1.0)]);
    assert!(
        wheel.lights.is_empty() && wheel.cameras.is_empty(),
        "what does not hang on the node"
    );
    let own = read(&cart(), "gltf { \"model.gltf\" node \"Wheel\" local translate z }");
    near(&corners(&own), &[DVec3::Z]);
    let whole = read(&cart(), "gltf { \"model.gltf\" node \"Cart\" local }");
    near(&corners(&whole), &[DVec3::ZERO, DVec3::X]);
}

#[test]
fn names_that_do_not_exist_are_told_with_those_that_do() {
    for (wish, named) in [
        ("node \"Wheels\"", ["there is no node \"Wheels\"", "\"Wheel\""]),
        ("scene \"Night\"", ["there is no scene \"Night\"", "scenes are"]),
        (
            "variant \"Blue\"",
            ["there is no material variant \"Blue\"", "no variants"],
        ),
        (
            "material \"Steel\" { diffuse { color rgb 1 } }",
            ["no material \"Steel\"", "\"Iron\", \"Wood\""],
        ),
    ] {
        let told = error(&cart(), &format!("gltf {{ \"model.gltf\" {wish} }}"));
        assert!(named.iter().all(|n| told.contains(n)), "{wish}: {told}");
    }
}

#[test]
fn lamps_and_cameras_are_taken_or_left() {
    let both = read(&cart(), "gltf { \"model.gltf\" scale 2 }");
    assert_eq!(
        (both.lights.len(), both.cameras.len(), both.active_camera),
        (1, 1, Some(0))
    );
    let eye = &both.cameras[0];
    assert_eq!((eye.name.as_str(), eye.location), ("Eye", DVec3::new(0.0, 0.0, -16.0)));
    assert!(
        eye.direction.normalize().distance(DVec3::Z) < 1e-12,
        "{}",
        eye.direction
    );
    assert!(eye.right.x > 0.0 && eye.up.y > 0.0, "{} {}", eye.right, eye.up);
    let none = read(&cart(), "gltf { \"model.gltf\" lights off cameras off }");
    assert!(none.lights.is_empty() && none.cameras.is_empty());
    let own = read(&cart(), "camera { location -9*z } gltf { \"model.gltf\" }");
    assert_eq!((own.cameras.len(), own.active_camera), (2, Some(0)));
    assert_eq!((own.cameras[0].location.z, own.cameras[1].name.as_str()), (-9.0, "Eye"));
}

#[test]
fn instances_share_what_was_loaded_once() {
    let text = "#for (I, 1, 100) gltf { \"model.gltf\" translate I*x } #end
        gltf { \"model.gltf\" material \"Wood\" { diffuse { color rgb <1, 0, 0> } } }
        gltf { \"model.gltf\" node \"Wheel\" }";
    let (scene, diags, files) = try_read(&cart(), text);
    let scene = scene.unwrap_or_else(|| panic!("{diags:#?}"));
    // The whole, the whole with other wood (its meshes are the same), and the part.
    assert_eq!((scene.groups.len(), scene.meshes.len()), (3, 3));
    let reads = pts::files::Files::opened(&files);
    let of_model = reads.iter().filter(|p| p.ends_with("model.gltf")).count();
    assert_eq!(of_model, 2, "one for the whole and one for the part: {reads:?}");
    let compiled = compile(&scene, &files, 8, 8, &mut Diagnostics::default()).expect("it compiles");
    // Light from all instances, memory of two meshes and the one of the part.
    assert_eq!(compiled.geometry.objects().len(), 203);
    let triangles: usize = compiled.geometry.meshes().iter().map(|m| m.triangles.len()).sum();
    assert_eq!(triangles, 3);
}

#[test]
fn a_material_is_replaced_by_its_name() {
    let scene = read(
        &cart(),
        "gltf { \"model.gltf\" material \"Iron\" { specular { color rgb .5 } } }",
    );
    let Shape::Group(group) = scene.objects[0].shape else {
        panic!("{:?}", scene.objects)
    };
    let objects = &scene.groups[group.index()].objects;
    let look = |i: usize| {
        let mesh = match objects[i].shape {
            Shape::Mesh(m) => &scene.meshes[m.index()],
            _ => panic!("{:?}", objects[i]),
        };
        let own = objects[i].material.filter(|_| objects[i].override_material);
        let id = own.or(mesh.slot_material(0)).expect("it has a material");
        scene.materials[id.index()].clone()
    };
    assert_eq!(look(0).name, "Wood");
    assert!(
        matches!(look(1).surface, pts::scene::SurfaceModel::Specular { .. }),
        "{:?}",
        look(1)
    );
}

/// The model's animation plays by the scene's clock, and over the shutter.
#[test]
fn a_model_plays_by_the_clock_that_it_is_given() {
    let mut m = cart();
    let (input, output) = (
        m.floats("SCALAR", &[0.0, 1.0]),
        m.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]),
    );
    m.push(
        "animations",
        json!({
            "samplers": [{"input": input, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        }),
    );
    let rest = read(&m, "gltf { \"model.gltf\" }");
    near(&corners(&rest)[..1], &[DVec3::Y * 5.0]);
    let later = read(&m, "gltf { \"model.gltf\" clock 0.5 }");
    near(&corners(&later)[..1], &[DVec3::X * 2.0]);
    let mut files = MemoryFiles::default();
    files.insert("model.gltf", m.text());
    files.insert("scene.pts", &b"gltf { \"model.gltf\" clock 2*clock scale 3 }"[..]);
    let options = LoadOptions {
        clock: Some(0.125),
        shutter: Some(0.25),
        ..LoadOptions::default()
    };
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load("scene.pts".as_ref(), &files, &options, &mut sources, &mut diags);
    let scene = scene.unwrap_or_else(|| panic!("{diags:#?}"));
    let cart = &scene.groups[0].objects[0];
    assert_eq!(cart.motion.len(), 9, "{cart:?}");
    for (k, key) in cart.motion.iter().enumerate() {
        let clock = 2.0 * (0.125 + 0.25 * k as f64 / 8.0);
        let place = (cart.transform * *key).transform_point3(DVec3::ZERO);
        assert!((place - DVec3::X * 4.0 * clock).length() < 1e-12, "{k}: {place}");
    }
}

/// Morph targets of a model that plays are followed over the shutter.
#[test]
fn a_model_that_plays_changes_its_form() {
    let mut m = Model::triangle();
    let d = m.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    m.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": d}]);
    let (input, output) = (m.floats("SCALAR", &[0.0, 1.0]), m.floats("SCALAR", &[0.0, 8.0]));
    m.push(
        "animations",
        json!({
            "samplers": [{"input": input, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
        }),
    );
    let mut files = MemoryFiles::default();
    files.insert("model.gltf", m.text());
    files.insert(
        "scene.pts",
        &b"gltf { \"model.gltf\" clock clock } gltf { \"model.gltf\" }"[..],
    );
    let options = LoadOptions {
        clock: Some(0.25),
        shutter: Some(0.5),
        ..LoadOptions::default()
    };
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load("scene.pts".as_ref(), &files, &options, &mut sources, &mut diags);
    let scene = scene.unwrap_or_else(|| panic!("{diags:#?}"));
    assert!(diags.is_empty(), "{diags:?}");
    let [played, still] = [&scene.meshes[0], &scene.meshes[1]];
    assert!(played.bends() && !still.bends());
    let x = |p: &[glam::Vec3]| played.center.x + f64::from(p[0].x);
    let ways: Vec<f64> = std::iter::once(x(&played.positions))
        .chain(played.later.iter().map(|f| x(&f.positions)))
        .collect();
    let expected: Vec<f64> = (0..9).map(|k| 8.0 * (0.25 + 0.5 * f64::from(k) / 8.0)).collect();
    assert_eq!(ways, expected);
}

/// A wall of 2 by 2 texels: white, red above; green, blue below.
fn wall() -> Model {
    let texels = [255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255];
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 2, 2);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texels).expect("four texels");
    writer.finish().expect("a file");
    let mut m = Model::new();
    let p = m.floats("VEC3", &[-1., -1., 0., 1., -1., 0., 1., 1., 0., -1., 1., 0.]);
    let uv = m.floats("VEC2", &[0., 1., 1., 1., 1., 0., 0., 0.]);
    let faces = m.indices(&[0, 1, 2, 0, 2, 3]);
    let attributes = json!({"POSITION": p, "TEXCOORD_0": uv});
    m.push(
        "meshes",
        json!({"primitives": [{"attributes": attributes, "indices": faces, "material": 0}]}),
    );
    let unlit = json!({"KHR_materials_unlit": {}});
    let pbr = json!({"baseColorTexture": {"index": 0}});
    m.push(
        "materials",
        json!({"name": "Wall", "pbrMetallicRoughness": pbr, "extensions": unlit}),
    );
    m.json["extensionsUsed"] = json!(["KHR_materials_unlit"]);
    let view = m.view(&png);
    m.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    m.push("samplers", json!({"magFilter": 9728}));
    m.push("textures", json!({"source": 0, "sampler": 0}));
    m.json["cameras"] = json!([{"type": "orthographic",
        "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1}}]);
    m.push("nodes", json!({"name": "Front", "camera": 0, "translation": [0, 0, 5]}));
    m.json["scenes"][0]["nodes"] = json!([0, 1]);
    m
}

/// The colours of a picture of 2 by 2 pixels.
fn seen(name: &str, text: &str) -> Vec<[f32; 3]> {
    let mut files = MemoryFiles::default();
    files.insert("model.gltf", wall().text());
    files.insert("scene.pts", text.as_bytes());
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load(name.as_ref(), &files, &LoadOptions::default(), &mut sources, &mut diags);
    let scene = scene.unwrap_or_else(|| panic!("{diags:#?}"));
    let compiled = compile(&scene, &files, 2, 2, &mut diags).unwrap_or_else(|| panic!("{diags:#?}"));
    driver::render(&compiled, &settings([2, 2], 16, 1), &Silent).0.rgb
}

/// What a person reads from the left is read from the left, whoever holds the camera.
#[test]
fn an_image_on_a_model_is_not_mirrored() {
    let (white, red, green, blue) = ([1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let upright = vec![white, red, green, blue];
    let camera = "camera { orthographic location -5*z direction z right 2*x up 2*y }";
    for (name, text) in [
        ("model.gltf", String::new()),
        ("scene.pts", "gltf { \"model.gltf\" }".to_owned()),
        ("scene.pts", format!("{camera} gltf {{ \"model.gltf\" }}")),
        (
            "scene.pts",
            format!(
                "{camera} gltf {{ \"model.gltf\" rotate 90*y rotate -90*y node \"Front\" }} gltf {{ \"model.gltf\" }}"
            ),
        ),
    ] {
        assert_eq!(seen(name, &text), upright, "{name}: {text}");
    }
    // By an image of the scene's own instead of the model's, on the model's coordinates.
    let behind = "camera { orthographic location 5*z look_at 0 right 2*x up 2*y } gltf { \"model.gltf\" }";
    assert_eq!(seen("scene.pts", behind), [red, white, blue, green], "from behind");
}
