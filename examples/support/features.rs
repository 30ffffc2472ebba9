//! One small model for each thing that glTF can say about shape and placing: what the grids of materials leave out.

use super::gltf::{Model, Stored, triangles};
use super::{Surface, shapes, textures};
use glam::{DMat4, DQuat, DVec3};
use serde_json::{Value, json};
use std::path::Path;

/// A name, and what fills the model of that name.
type Feature = (&'static str, fn(&mut Model));

/// Writes all of them; each with its own small buffer.
pub fn write(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let models: [Feature; 9] = [
        ("nodes", nodes),
        ("morph", morph),
        ("skin", skin),
        ("vertex_colors", vertex_colors),
        ("quantized_instances", quantized_instances),
        ("textures", textured),
        ("topologies", topologies),
        ("lights", lights),
        ("orthographic", orthographic),
    ];
    for (name, fill) in models {
        let mut model = Model::new();
        fill(&mut model);
        model.write(&folder.join(format!("{name}.gltf")), &format!("{name}.bin"))?;
    }
    Ok(())
}

fn paint(color: [f64; 3]) -> Value {
    let [r, g, b] = color;
    json!({ "pbrMetallicRoughness":
        { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5 } })
}

fn ball(model: &mut Model) -> Stored {
    model.store(&shapes::ball(0.45, 20, 10))
}

/// A sun from the upper left, a camera, and a floor.
fn stage(model: &mut Model) {
    light(
        model,
        json!({ "type": "directional", "intensity": 3.0 }),
        json!({ "rotation": [-0.5, 0.25, 0.1, 0.82] }),
    );
    light(
        model,
        json!({ "type": "directional", "intensity": 1.0 }),
        json!({ "rotation": [-0.2, -0.5, 0.0, 0.84] }),
    );
    floor(model);
    model.camera([0.0, 0.25, 5.0], 0.56, 1.5);
}

fn floor(model: &mut Model) {
    let floor = model.store(&shapes::cuboid([12.0, 0.1, 9.0]));
    let gray = model.material(paint([0.4; 3]));
    let mesh = model.mesh(&floor, gray);
    model.root(json!({ "name": "floor", "mesh": mesh, "translation": [0.0, -0.55, 0.0] }));
}

fn light(model: &mut Model, light: Value, mut node: Value) {
    model.uses("KHR_lights_punctual");
    if model.json["extensions"].is_null() {
        model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [] } });
    }
    let list = model.json["extensions"]["KHR_lights_punctual"]["lights"].as_array_mut();
    let list = list.expect("just made");
    list.push(light);
    node["extensions"] = json!({ "KHR_lights_punctual": { "light": list.len() - 1 } });
    model.root(node);
}

/// A picture with letters, which shows whether anything is mirrored, its normals and its roughness.
fn planks(model: &mut Model) -> [usize; 3] {
    let images = [
        textures::crate_color(48),
        textures::crate_normals(48),
        textures::roughness(48),
    ];
    images.map(|i| {
        let source = model.image(&i.into());
        model.push("textures", json!({ "source": source }))
    })
}

/// Mirrored, turned, sheared, and nested under a stretching parent; one is not visible.
fn nodes(model: &mut Model) {
    let [color, normals, _] = planks(model);
    let stored = ball(model);
    let mut material = paint([1.0; 3]);
    material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": color });
    material["normalTexture"] = json!({ "index": normals });
    let material = model.material(material);
    let mesh = model.mesh(&stored, material);
    model.root(json!({ "mesh": mesh, "translation": [-1.2, 0.0, 0.0], "scale": [-1.0, 1.0, 1.0] }));
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.6, 0.2).to_array();
    model.root(json!({ "mesh": mesh, "translation": [-0.3, 0.0, 0.0], "rotation": turn, "scale": [0.8, 0.5, 0.8] }));
    let mut shear = DMat4::from_translation(DVec3::new(0.6, 0.0, 0.0));
    shear.y_axis.x = 0.6;
    shear.y_axis.y = 0.8;
    model.root(json!({ "mesh": mesh, "matrix": shear.to_cols_array() }));
    let child = model.push(
        "nodes",
        json!({ "mesh": mesh, "rotation": [0.0, 0.38, 0.0, 0.925], "scale": [0.7, 0.7, 0.7] }),
    );
    model.root(json!({ "translation": [1.5, 0.1, 0.0], "scale": [0.6, 1.2, 0.6], "children": [child] }));
    model.uses("KHR_node_visibility");
    model.root(json!({ "mesh": mesh, "translation": [0.0, 0.6, 0.5],
        "extensions": { "KHR_node_visibility": { "visible": false } } }));
    stage(model);
}

/// Two targets; the weights of the mesh, and those of a node instead.
fn morph(model: &mut Model) {
    let surface = shapes::ball(0.45, 20, 10);
    let stored = model.store(&surface);
    let moved = |scale: DVec3| -> Vec<[f32; 3]> {
        surface
            .positions
            .iter()
            .map(|p| (*p * scale).as_vec3().to_array())
            .collect()
    };
    let wide = model.floats(&moved(DVec3::new(0.6, -0.5, 0.2)));
    let tall = model.floats(&moved(DVec3::new(0.0, 0.6, 0.0)));
    let material = model.material(paint([0.3, 0.6, 0.8]));
    let mesh = model.mesh(&stored, material);
    model.json["meshes"][mesh]["primitives"][0]["targets"] = json!([{ "POSITION": wide }, { "POSITION": tall }]);
    model.json["meshes"][mesh]["weights"] = json!([0.7, 0.0]);
    model.root(json!({ "mesh": mesh, "translation": [-0.8, 0.0, 0.0] }));
    model.root(json!({ "mesh": mesh, "translation": [0.8, 0.0, 0.0], "weights": [0.0, 1.0] }));
    stage(model);
}

/// A tube bent by two joints; its own node's place does not count.
fn skin(model: &mut Model) {
    let tube = Surface::grid(16, 12, &|u, v| {
        let (s, c) = (-std::f64::consts::TAU * u).sin_cos();
        DVec3::new(0.22 * c, 1.4 * v - 0.5, 0.22 * s)
    });
    let stored = model.store(&tube);
    let joints: Vec<u8> = tube.positions.iter().flat_map(|_| [0, 1, 0, 0]).collect();
    let weights: Vec<[f32; 4]> = tube
        .uvs
        .iter()
        .map(|uv| [uv.y as f32, 1.0 - uv.y as f32, 0.0, 0.0])
        .collect();
    let joints = model.accessor("VEC4", 5121, tube.positions.len(), &joints);
    let weights = model.floats(&weights);
    let mut attributes = stored.attributes.clone();
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let mut material = paint([0.8, 0.5, 0.2]);
    material["doubleSided"] = true.into();
    let material = model.material(material);
    let mesh = model.mesh(&Stored { attributes, ..stored }, material);
    let upper = model.push(
        "nodes",
        json!({ "translation": [0.0, 0.7, 0.0], "rotation": [0.0, 0.0, 0.38, 0.925] }),
    );
    let lower = model.root(json!({ "translation": [0.0, -0.5, 0.0], "children": [upper] }));
    let rest = |y: f64| {
        DMat4::from_translation(DVec3::new(0.0, y, 0.0))
            .as_mat4()
            .to_cols_array()
    };
    let inverse = model.floats(&[rest(0.5), rest(-0.2)]);
    model.push(
        "skins",
        json!({ "joints": [lower, upper], "inverseBindMatrices": inverse }),
    );
    model.root(json!({ "mesh": mesh, "skin": 0, "translation": [5.0, 5.0, 5.0] }));
    stage(model);
}

/// Colours of vertices as floats, as bytes with alpha, and alone above a base colour.
fn vertex_colors(model: &mut Model) {
    let surface = shapes::ball(0.45, 20, 10);
    let stored = model.store(&surface);
    let colors: Vec<[f32; 4]> = surface
        .normals
        .iter()
        .zip(&surface.uvs)
        .map(|(n, uv)| (*n * 0.5 + 0.5).extend(uv.x).as_vec4().to_array())
        .collect();
    let bytes: Vec<u8> = colors.iter().flatten().map(|v| (v * 255.0).round() as u8).collect();
    let floats = model.floats(&colors);
    let bytes = model.accessor("VEC4", 5121, colors.len(), &bytes);
    model.json["accessors"][bytes]["normalized"] = true.into();
    for (i, (accessor, mode)) in [(floats, "OPAQUE"), (bytes, "OPAQUE"), (floats, "BLEND")]
        .into_iter()
        .enumerate()
    {
        let mut attributes = stored.attributes.clone();
        attributes["COLOR_0"] = accessor.into();
        let mut material = paint([1.0, 0.9, 0.8]);
        material["alphaMode"] = mode.into();
        let material = model.material(material);
        let mesh = model.mesh(
            &Stored {
                attributes,
                ..stored.clone()
            },
            material,
        );
        model.root(json!({ "mesh": mesh, "translation": [1.1 * (i as f64 - 1.0), 0.0, 0.0] }));
    }
    stage(model);
}

/// Positions of 16 and normals of 8 bits, placed nine times by instance attributes, with some positions replaced (sparse).
fn quantized_instances(model: &mut Model) {
    let surface = shapes::ball(0.7, 16, 8);
    let shorts: Vec<u8> = surface
        .positions
        .iter()
        .flat_map(|p| [p.x, p.y, p.z, 0.0])
        .flat_map(|v| ((v * 32767.0).round() as i16).to_le_bytes())
        .collect();
    let view = model.view(&shorts);
    model.json["bufferViews"][view]["byteStride"] = 8.into();
    // The pole rises to a spike by sparse values.
    let spike: Vec<u8> = [0i16, 32767, 0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let (at, values) = (model.view(&8u16.to_le_bytes()), model.view(&spike));
    let n = surface.positions.len();
    let position = model.push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5122, "normalized": true, "count": n, "type": "VEC3",
            "min": [-1.0, -1.0, -1.0], "max": [1.0, 1.0, 1.0],
            "sparse": { "count": 1, "indices": { "bufferView": at, "componentType": 5123 },
                "values": { "bufferView": values } } }),
    );
    let normals: Vec<u8> = surface
        .normals
        .iter()
        .flat_map(|n| [n.x, n.y, n.z, 0.0])
        .map(|v| (v * 127.0).round() as i8 as u8)
        .collect();
    let view = model.view(&normals);
    model.json["bufferViews"][view]["byteStride"] = 4.into();
    let normal = model.push(
        "accessors",
        json!({ "bufferView": view, "componentType": 5120, "normalized": true, "count": n, "type": "VEC3" }),
    );
    let indices: Vec<u16> = triangles(&surface).flatten().collect();
    let stored = Stored {
        attributes: json!({ "POSITION": position, "NORMAL": normal }),
        indices: model.indices(&indices),
    };
    let material = model.material(paint([0.7, 0.5, 0.7]));
    let mesh = model.mesh(&stored, material);
    let cells = || (0..9).map(|i| (f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0));
    let places: Vec<[f32; 3]> = cells()
        .map(|(x, z)| DVec3::new(1.6 * x, -0.2, 1.6 * z).as_vec3().to_array())
        .collect();
    let scales: Vec<[f32; 3]> = cells().map(|(x, z)| [0.9, (0.9 + 0.3 * x * z) as f32, 0.9]).collect();
    let places = model.floats(&places);
    let scales = model.floats(&scales);
    for name in ["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"] {
        model.uses(name);
    }
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    // The node's scale makes real units of the quantized ones, places of the instances included.
    model.root(json!({ "mesh": mesh, "scale": [0.6, 0.6, 0.6], "extensions":
        { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places, "SCALE": scales } } } }));
    stage(model);
}

/// Samplers, transforms, a second set of coordinates, packed maps, a mask and a blend.
fn textured(model: &mut Model) {
    let [color, normals, roughness] = planks(model);
    let mirrored = model.push("samplers", json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }));
    let source = model.json["textures"][color]["source"].clone();
    let nearest = model.push("textures", json!({ "source": source, "sampler": mirrored }));
    let leaf = image::RgbaImage::from_fn(32, 32, |x, y| {
        let d = f64::hypot(f64::from(x) - 15.5, f64::from(y) - 15.5) / 15.5;
        image::Rgba([60, 150, 40, ((1.4 - d) * 180.0).clamp(0.0, 255.0) as u8])
    });
    let source = model.image(&leaf.into());
    let leaf = model.push("textures", json!({ "source": source }));
    let surface = shapes::cuboid([0.8, 0.8, 0.8]);
    let stored = model.store(&surface);
    let second: Vec<[f32; 2]> = surface.uvs.iter().map(|uv| [uv.y as f32, uv.x as f32]).collect();
    let second = model.floats(&second);
    let mut attributes = stored.attributes.clone();
    attributes["TEXCOORD_1"] = second.into();
    let stored = Stored { attributes, ..stored };
    model.uses("KHR_texture_transform");
    let transform = json!({ "KHR_texture_transform": { "offset": [0.2, 0.1], "rotation": 0.5, "scale": [2.0, 1.5] } });
    let base = |info: Value| {
        let mut material = paint([1.0; 3]);
        material["pbrMetallicRoughness"]["baseColorTexture"] = info;
        material
    };
    let mut mapped = base(json!({ "index": color, "texCoord": 1 }));
    mapped["normalTexture"] = json!({ "index": normals, "scale": 0.8 });
    mapped["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({ "index": roughness });
    mapped["pbrMetallicRoughness"]["roughnessFactor"] = 0.8.into();
    let mut mask = base(json!({ "index": leaf }));
    mask["alphaMode"] = "MASK".into();
    mask["alphaCutoff"] = 0.6.into();
    mask["doubleSided"] = true.into();
    let mut blend = base(json!({ "index": leaf }));
    blend["alphaMode"] = "BLEND".into();
    blend["doubleSided"] = true.into();
    let turned = base(json!({ "index": nearest, "extensions": transform }));
    for (i, material) in [mapped, turned, mask, blend].into_iter().enumerate() {
        let material = model.material(material);
        let mesh = model.mesh(&stored, material);
        let at = [1.05 * (i as f64 - 1.5), 0.0, 0.0];
        model.root(json!({ "mesh": mesh, "translation": at, "rotation": [0.15, 0.3, 0.0, 0.94] }));
    }
    stage(model);
}

/// A strip, a fan, a list without indices, and points, which are left out.
fn topologies(model: &mut Model) {
    let strip: Vec<[f32; 3]> = (0..10)
        .map(|i| [(i / 2) as f32 * 0.2 - 0.4, (i % 2) as f32 * 0.8 - 0.4, 0.0])
        .collect();
    let rim = |i: u32| (f64::from(i) * std::f64::consts::TAU / 12.0).sin_cos();
    let fan: Vec<[f32; 3]> = std::iter::once([0.0; 3])
        .chain((0..=12).map(|i| [0.42 * rim(i).1 as f32, 0.42 * rim(i).0 as f32, 0.0]))
        .collect();
    let list: Vec<[f32; 3]> = vec![[-0.4, -0.4, 0.0], [0.4, -0.4, 0.0], [0.0, 0.4, 0.0]];
    let mut material = paint([0.4, 0.7, 0.3]);
    material["doubleSided"] = true.into();
    let material = model.material(material);
    for (i, (corners, mode)) in [(strip, 5), (fan, 6), (list.clone(), 4), (list, 0)]
        .into_iter()
        .enumerate()
    {
        let position = model.floats(&corners);
        let primitive = json!({ "attributes": { "POSITION": position }, "mode": mode, "material": material });
        let mesh = model.push("meshes", json!({ "primitives": [primitive] }));
        model.root(json!({ "mesh": mesh, "translation": [1.05 * (i as f64 - 1.5), 0.0, 0.0] }));
    }
    stage(model);
}

/// Two points of light, one with a range, a spot and a sun, none of them scaled by its node.
fn lights(model: &mut Model) {
    let stored = ball(model);
    let material = model.material(paint([0.8; 3]));
    let mesh = model.mesh(&stored, material);
    for x in [-1.1, 0.0, 1.1] {
        model.root(json!({ "mesh": mesh, "translation": [x, 0.0, 0.0] }));
    }
    let red = json!({ "type": "point", "intensity": 6.0, "color": [1.0, 0.3, 0.2] });
    light(
        model,
        red,
        json!({ "translation": [-2.0, 1.5, 1.0], "scale": [3.0, 3.0, 3.0] }),
    );
    let near = json!({ "type": "point", "intensity": 6.0, "color": [0.2, 0.4, 1.0], "range": 2.5 });
    light(model, near, json!({ "translation": [2.0, 1.5, 1.0] }));
    let spot = json!({ "type": "spot", "intensity": 25.0, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.3 } });
    light(
        model,
        spot,
        json!({ "translation": [0.0, 2.5, 1.5], "rotation": [-0.5, 0.0, 0.0, 0.866] }),
    );
    let sun = json!({ "type": "directional", "intensity": 0.6 });
    light(model, sun, json!({ "rotation": [-0.707, 0.0, 0.0, 0.707] }));
    floor(model);
    model.camera([0.0, 0.25, 5.0], 0.56, 1.5);
}

/// An orthographic camera; its magnifications are half extents.
fn orthographic(model: &mut Model) {
    let stored = ball(model);
    let material = model.material(paint([0.8, 0.3, 0.3]));
    let mesh = model.mesh(&stored, material);
    for x in [-1.1, 0.0, 1.1] {
        model.root(json!({ "mesh": mesh, "translation": [x, 0.0, -x] }));
    }
    let lens = json!({ "xmag": 1.8, "ymag": 1.2, "znear": 0.1, "zfar": 20.0 });
    let camera = model.push("cameras", json!({ "type": "orthographic", "orthographic": lens }));
    let turn = DQuat::from_rotation_x(-0.4).to_array();
    model.root(json!({ "camera": camera, "translation": [0.0, 2.0, 5.0], "rotation": turn }));
    stage(model);
    // The stage's camera is the second; the first is the active one.
}
