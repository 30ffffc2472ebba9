//! Accessors and primitives.

use crate::builder::*;
use glam::{Vec2, Vec3, Vec4};
use pts::diag::Severity;
use pts::scene::{MaterialId, Texture};
use serde_json::json;

#[test]
fn an_indexed_triangle_keeps_its_corners_and_order_in_text_and_binary() {
    let mut m = Model::triangle();
    let i = m.bytes("SCALAR", U8, 3, &[2, 0, 1]);
    m.json["meshes"][0]["primitives"][0]["indices"] = json!(i);
    let scene = m.load();
    let mut files = pts::files::MemoryFiles::default();
    files.insert("model.glb", m.glb());
    let (binary, diags) = load_from(&files, "model.glb", &Default::default());
    assert!(diags.is_empty(), "{diags:?}");
    for scene in [scene, binary.unwrap()] {
        let mesh = &scene.meshes[0];
        assert_eq!(positions(mesh), [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
        assert_eq!(mesh.center.to_array(), [1.0, 1.0, 0.0]);
        assert_eq!(mesh.triangles, [[2, 0, 1]]);
        assert!(mesh.normals.is_empty() && mesh.tangents.is_empty() && mesh.uvs.is_empty());
        assert!(!mesh.flip_winding);
        assert!(scene.is_bare_model);
    }
}

#[test]
fn strips_and_fans_of_a_square_face_the_same_way_as_its_list() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, order) in [(4, &[0u16, 1, 2, 2, 1, 3][..]), (5, &[0, 1, 2, 3]), (6, &[0, 1, 3, 2])] {
        let mut m = Model::new();
        let (p, i) = (m.floats("VEC3", &square), m.indices(order));
        m.push(
            "meshes",
            json!({"primitives": [{"attributes": {"POSITION": p}, "indices": i, "mode": mode}]}),
        );
        let scene = m.load();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.triangles.len(), 2, "mode {mode}");
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert_eq!((b - a).cross(c - a), Vec3::Z, "mode {mode}");
        }
    }
}

#[test]
fn interleaved_and_normalised_attributes_are_decoded() {
    let mut m = Model::new();
    let mut bytes = Vec::new();
    // Per vertex: position as 3 normalised i16 (and padding), normal as 3 floats, uv as 2 normalised u16.
    let vertices: [([i16; 3], [u16; 2]); 3] = [
        ([0, 0, 0], [0, 65535]),
        ([32767, 0, -32768], [65535, 0]),
        ([0, 32767, 0], [0, 0]),
    ];
    for (p, uv) in vertices {
        p.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.extend([0xAA; 2]);
        [0.0f32, 3.0, 0.0].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        uv.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    let view = m.view(&bytes);
    m.json["bufferViews"][view]["byteStride"] = json!(24);
    let mut at = |offset, component: u32, kind: &str, normalized| {
        let accessor = json!({"bufferView": view, "byteOffset": offset, "componentType": component, "count": 3,
            "type": kind, "normalized": normalized});
        m.push("accessors", accessor)
    };
    let (p, n, uv) = (
        at(0, I16, "VEC3", true),
        at(8, F32, "VEC3", false),
        at(20, U16, "VEC2", true),
    );
    m.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": p, "NORMAL": n, "TEXCOORD_0": uv}}]}),
    );
    m.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = m.load();
    let mesh = &scene.meshes[0];
    assert_eq!(positions(mesh), [[0.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.normals, [Vec3::Y; 3]);
    assert_eq!(mesh.uvs, [[Vec2::Y, Vec2::X, Vec2::ZERO]]);
}

#[test]
fn raw_integers_stay_integers_and_sparse_values_replace_elements() {
    let mut m = Model::new();
    let bytes: Vec<u8> = [0u16, 0, 0, 0, 500, 0, 0, 0, 0, 7, 0, 0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let p = m.bytes("VEC3", U16, 3, &bytes[..18]);
    m.json["bufferViews"][p]["byteStride"] = json!(8);
    m.json["bufferViews"][p]["byteLength"] = json!(24);
    m.bin.resize(24, 0);
    m.bin[18..24].copy_from_slice(&bytes[18..]);
    let (places, values) = (m.view(&[2]), m.view(&[9, 0, 8, 0, 1, 0]));
    m.json["accessors"][p]["sparse"] = json!({"count": 1,
        "indices": {"bufferView": places, "componentType": U8}, "values": {"bufferView": values}});
    m.push("meshes", json!({"primitives": [{"attributes": {"POSITION": p}}]}));
    let scene = m.load();
    assert_eq!(
        positions(&scene.meshes[0]),
        [[0.0, 0.0, 0.0], [500.0, 0.0, 0.0], [9.0, 8.0, 1.0]]
    );
}

#[test]
fn an_accessor_without_view_is_zeros_with_its_sparse_values() {
    let mut m = Model::new();
    let values: Vec<u8> = [1.0f32, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let (places, values) = (m.view(&[1, 0, 2, 0]), m.view(&values));
    let p = m.push(
        "accessors",
        json!({"componentType": F32, "count": 3, "type": "VEC3", "sparse": {"count": 2,
        "indices": {"bufferView": places, "componentType": U16}, "values": {"bufferView": values}}}),
    );
    m.push("meshes", json!({"primitives": [{"attributes": {"POSITION": p}}]}));
    let scene = m.load();
    assert_eq!(
        positions(&scene.meshes[0]),
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
}

#[test]
fn packed_views_are_unpacked_whatever_buffer_they_claim_to_be_in() {
    // Three vertices at (0, 0, 0), (1, 0, 0), (0, 1, 0) as bytes: all differences in sixteen plain bytes.
    let mut stream = vec![0xA0];
    for deltas in [[0u8, 2, 1], [0, 0, 2], [0, 0, 0], [0, 0, 0]] {
        stream.push(3);
        stream.extend(deltas);
        stream.extend([0; 13]);
    }
    stream.extend([0; 32]);
    let mut m = Model::new();
    let packed = m.view(&stream);
    m.json["bufferViews"][packed] = json!({"buffer": 1, "byteLength": 12, "byteStride": 4, "extensions":
        {"EXT_meshopt_compression": {"buffer": 0, "byteLength": stream.len(), "byteStride": 4, "count": 3,
            "mode": "ATTRIBUTES"}}});
    let p = m.push(
        "accessors",
        json!({"bufferView": packed, "componentType": U8, "count": 3, "type": "VEC3"}),
    );
    m.push("meshes", json!({"primitives": [{"attributes": {"POSITION": p}}]}));
    m.json["extensionsRequired"] = json!(["EXT_meshopt_compression", "KHR_mesh_quantization"]);
    assert_eq!(
        positions(&m.load().meshes[0]),
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
}

#[test]
fn primitives_of_a_mesh_share_one_mesh_with_a_slot_per_material() {
    let mut m = Model::triangle();
    let (first, second) = (m.indices(&[0, 1, 2]), m.indices(&[2, 1, 0]));
    let primitive = |i, material| json!({"attributes": {"POSITION": 0}, "indices": i, "material": material});
    m.push("materials", json!({"name": "red"}));
    m.push("materials", json!({"name": "blue"}));
    m.json["meshes"][0] = json!({"name": "both",
        "primitives": [primitive(first, 0), primitive(second, 1), primitive(first, 0)]});
    let scene = m.load();
    assert_eq!(scene.meshes.len(), 1);
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.name, "both");
    assert_eq!(mesh.triangles, [[0, 1, 2], [5, 4, 3], [6, 7, 8]]);
    assert_eq!(mesh.materials, [Some(MaterialId(0)), Some(MaterialId(1))]);
    assert_eq!((0..3).map(|f| mesh.slot(f)).collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(scene.materials[1].name, "blue");
}

#[test]
fn primitives_with_other_attributes_become_meshes_of_their_own() {
    let mut m = Model::triangle();
    let n = m.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    m.json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0, "NORMAL": n}}]);
    let scene = m.load();
    assert_eq!((scene.meshes.len(), scene.objects.len()), (2, 2));
    assert!(scene.meshes[0].normals.is_empty());
    assert_eq!(scene.meshes[1].normals, [Vec3::Z; 3]);
}

#[test]
fn a_primitive_takes_only_the_vertices_it_uses() {
    let mut m = Model::new();
    let many: Vec<f32> = (0..3000).map(|i| (i * i % 1009) as f32).collect();
    let p = m.floats("VEC3", &many);
    let i = m.indices(&[7, 900, 41]);
    m.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": p}, "indices": i}]}),
    );
    let scene = m.load();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
    let corner = |v: usize| [0, 1, 2].map(|k| f64::from(many[3 * v + k]));
    assert_eq!(positions(mesh), [corner(7), corner(41), corner(900)]);
}

#[test]
fn a_normal_map_without_tangents_gets_them_with_the_bitangent_upwards_in_the_picture() {
    // The picture's u runs along +x, then along −x; its top (v = 0) is at y = 1 both times.
    for (u, tangent) in [
        (1.0, Vec4::new(1.0, 0.0, 0.0, 1.0)),
        (-1.0, Vec4::new(-1.0, 0.0, 0.0, -1.0)),
    ] {
        let mut m = Model::with_texture(json!({"normalTexture": {"index": 0, "scale": 0.5}}));
        let uv = m.floats("VEC2", &[0.0, 1.0, u, 1.0, 0.0, 0.0]);
        m.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uv);
        let scene = m.load();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.normals, [Vec3::Z; 3], "flat normals that the tangents need");
        for (t, n) in mesh.tangents.iter().zip(&mesh.normals) {
            assert!((*t - tangent).length() < 1e-6, "{t}");
            assert!((t.w * n.cross(t.truncate()) - Vec3::Y).length() < 1e-6);
        }
        assert_eq!(scene.materials[0].normal_map.unwrap().scale, 0.5);
    }
}

#[test]
fn tangents_are_split_where_faces_disagree_and_given_ones_are_kept() {
    let mut m = Model::with_texture(json!({"normalTexture": {"index": 0}}));
    // Two triangles of a square; the second is mapped with u reversed, so they share no tangent.
    let p = m.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    let n = m.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let uv = m.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, -1.0, 0.0]);
    let i = m.indices(&[0, 1, 2, 2, 1, 3]);
    let attributes = json!({"POSITION": p, "NORMAL": n, "TEXCOORD_0": uv});
    m.json["meshes"][0]["primitives"][0] = json!({"attributes": attributes, "indices": i, "material": 0});
    let split = m.load();
    assert!(split.meshes[0].positions.len() > 4);
    let given = m.floats("VEC4", &[0.0, 2.0, 0.0, -1.0].repeat(4));
    m.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(given);
    let scene = m.load();
    assert_eq!(scene.meshes[0].tangents, [Vec4::new(0.0, 1.0, 0.0, -1.0); 4]);
    m.json["materials"][0] = json!({});
    assert!(
        m.load().meshes[0].tangents.is_empty(),
        "nobody looks at them without a normal map"
    );
}

#[test]
fn tangents_of_absurd_coordinates_are_unit_vectors_still() {
    let mut state = 12345u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        state >> 3
    };
    let odd = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-38,
        1e38,
        -3e38,
        f32::MIN_POSITIVE,
        f32::NAN,
        f32::INFINITY,
        0.5,
        7e-20,
    ];
    let mut some = move |n: usize| -> Vec<f32> { (0..n).map(|_| odd[random() as usize % odd.len()]).collect() };
    let mut checked = 0;
    for _ in 0..200 {
        let mut m = Model::with_texture(json!({"normalTexture": {"index": 0}}));
        let (p, n, uv) = (
            m.floats("VEC3", &some(36)),
            m.floats("VEC3", &some(36)),
            m.floats("VEC2", &some(24)),
        );
        let i = m.indices(&[0, 1, 2, 2, 1, 3, 4, 5, 6, 7, 8, 9, 9, 10, 11, 0, 0, 1]);
        let attributes = json!({"POSITION": p, "NORMAL": n, "TEXCOORD_0": uv});
        m.json["meshes"][0]["primitives"][0] = json!({"attributes": attributes, "indices": i, "material": 0});
        for mesh in m.load().meshes.iter() {
            assert!(mesh.normals.iter().all(|n| n.is_normalized()));
            assert_eq!(mesh.tangents.len(), mesh.positions.len());
            assert!(
                mesh.tangents
                    .iter()
                    .all(|t| t.truncate().is_normalized() && t.w.abs() == 1.0)
            );
            checked += mesh.tangents.len();
        }
    }
    assert!(checked > 1000, "{checked}");
}

#[test]
fn vertex_colours_multiply_the_base_colour_and_several_uv_sets_are_kept() {
    let mut m = Model::with_material(json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1]}}));
    let c = m.bytes("VEC4", U8, 3, &[255, 0, 51, 255, 0, 0, 0, 0, 255, 255, 255, 255]);
    m.json["accessors"][c]["normalized"] = json!(true);
    let uv = m.floats("VEC2", &[0.0, 0.5, 1.0, 0.5, 0.0, 0.25]);
    let attributes = &mut m.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["COLOR_0"] = json!(c);
    attributes["TEXCOORD_2"] = json!(uv);
    let scene = m.load();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.colors[0], Vec4::new(1.0, 0.0, 0.2, 1.0));
    assert_eq!(mesh.uvs.iter().map(Vec::len).collect::<Vec<_>>(), [0, 0, 3]);
    let base = principled(&scene).base_color;
    assert_eq!(base.factor.to_array(), [0.5, 0.25, 1.0]);
    assert_eq!(scene.textures[base.texture.unwrap().index()], Texture::VertexColor);
}

#[test]
fn faces_with_infinite_corners_are_left_out_and_counted() {
    let mut m = Model::new();
    let p = m.floats(
        "VEC3",
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, f32::NAN, 0.0, 0.0],
    );
    let i = m.indices(&[0, 1, 2, 0, 1, 3, 1, 1, 2]);
    m.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": p}, "indices": i}]}),
    );
    let (scene, diags) = m.try_load(&Default::default());
    let scene = scene.unwrap();
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert_eq!(scene.meshes[0].dropped_faces, 2, "one not finite, one degenerate");
    let warning = diags.iter().find(|d| d.severity == Severity::Warning).unwrap();
    assert_eq!(warning.code, "G0613");
    let place = "model.gltf: meshes[0].primitives[0].attributes.POSITION";
    assert_eq!(warning.place.as_deref(), Some(place));
}

#[test]
fn a_normal_without_direction_takes_that_of_its_faces() {
    let mut m = Model::triangle();
    let n = m.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, f32::NAN, 0.0]);
    m.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(n);
    assert_eq!(m.load().meshes[0].normals, [Vec3::Z, Vec3::Y, Vec3::Z]);
    assert_eq!(m.codes(), ["G0614"]);
}

#[test]
fn points_and_lines_are_skipped_with_one_note() {
    let mut m = Model::triangle();
    let primitive = |mode| json!({"attributes": {"POSITION": 0}, "mode": mode});
    m.json["meshes"][0]["primitives"] = json!([primitive(0), primitive(1), primitive(3), primitive(4)]);
    assert_eq!(m.codes(), ["G0603"]);
    assert_eq!(m.load().meshes[0].triangles.len(), 1);
}

#[test]
fn morph_targets_are_added_by_the_nodes_weights() {
    let mut m = Model::triangle();
    let delta = m.floats("VEC3", &[0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0]);
    let n = m.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let turn = m.floats("VEC3", &[0.0, 2.0, -2.0].repeat(3));
    let primitive = &mut m.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = json!(n);
    primitive["targets"] = json!([{"POSITION": delta}, {"NORMAL": turn}]);
    m.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    let mesh = m.load().meshes[0].clone();
    assert_eq!(positions(&mesh), [[0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [0.0, 2.0, 4.0]]);
    m.json["nodes"][0]["weights"] = json!([0.0, 0.5]);
    let mesh = m.load().meshes[0].clone();
    assert_eq!(positions(&mesh)[2], [0.0, 2.0, 0.0]);
    assert_eq!(mesh.normals, [Vec3::Y; 3]);
}

#[test]
fn a_skin_places_its_mesh_by_its_joints_and_not_by_its_node() {
    let mut m = Model::triangle();
    let joints = m.bytes("VEC4", U8, 3, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let weights = m.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0]);
    let mut inverse = [0.0; 32];
    for k in [0, 5, 10, 15, 16, 21, 26, 31] {
        inverse[k] = 1.0;
    }
    inverse[12] = 5.0; // the first joint's bind pose stands at x = −5
    let inverse = m.floats("MAT4", &inverse);
    let attributes = &mut m.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    m.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": inverse}]);
    m.json["nodes"] = json!([{"mesh": 0, "skin": 0, "translation": [100, 100, 100]},
        {"translation": [0, 0, 1], "children": [2]}, {"translation": [0, 8, 0]}]);
    m.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = m.load();
    assert_eq!(scene.objects[0].transform, glam::DAffine3::IDENTITY);
    // Joint 0 moves by (5, 0, 1), joint 1 by (0, 8, 1); the last vertex by a quarter of the one and three of the other.
    let want = [[5.0, 0.0, 1.0], [2.0, 8.0, 1.0], [1.25, 8.0, 1.0]];
    assert_eq!(positions(&scene.meshes[0]), want);
}

#[test]
fn a_mirroring_skeleton_keeps_the_outside_outside() {
    let mut m = Model::triangle();
    let n = m.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let joints = m.bytes("VEC4", U8, 3, &[0; 12]);
    let weights = m.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    let attributes = &mut m.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = json!(n);
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    m.json["skins"] = json!([{"joints": [1]}]);
    m.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"scale": [-1, 1, 1]}]);
    m.json["scenes"][0]["nodes"] = json!([0, 1]);
    let mesh = m.load().meshes[0].clone();
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
    let sign = if mesh.flip_winding { -1.0 } else { 1.0 };
    assert!(
        (b - a).cross(c - a).z * sign > 0.0,
        "the geometric normal follows the shading normal"
    );
}

#[test]
fn primitive_restart_values_begin_a_new_strip_with_a_warning() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, order, faces) in [
        (5, &[0u16, 1, 2, 65535, 1, 3, 2][..], 2),
        (4, &[0, 1, 2, 65535, 2, 1, 3], 2),
    ] {
        let mut m = Model::new();
        let (p, i) = (m.floats("VEC3", &square), m.indices(order));
        m.push(
            "meshes",
            json!({"primitives": [{"attributes": {"POSITION": p}, "indices": i, "mode": mode}]}),
        );
        assert_eq!(m.codes(), ["G0617"], "mode {mode}");
        let scene = m.load();
        assert_eq!(scene.meshes[0].triangles.len(), faces, "mode {mode}");
    }
}

#[test]
fn strips_and_fans_leave_out_triangles_without_area() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, order) in [(5, &[0u16, 1, 2, 2, 2, 3, 1][..]), (6, &[0, 1, 1, 3, 2, 2])] {
        let mut m = Model::new();
        let (p, i) = (m.floats("VEC3", &square), m.indices(order));
        m.push(
            "meshes",
            json!({"primitives": [{"attributes": {"POSITION": p}, "indices": i, "mode": mode}]}),
        );
        let mesh = &m.load().meshes[0];
        assert_eq!(mesh.triangles.len(), 2, "mode {mode}: {:?}", mesh.triangles);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).z != 0.0);
        }
    }
}

#[test]
fn vertex_colours_of_every_type_are_fractions() {
    let half16 = 32768.0 / 65535.0;
    for (kind, component, bytes, wanted) in [
        ("VEC3", U8, [0u8, 51, 255].repeat(3), [0.0, 0.2, 1.0, 1.0]),
        ("VEC4", U8, [0u8, 51, 255, 102].repeat(3), [0.0, 0.2, 1.0, 0.4]),
        (
            "VEC3",
            U16,
            [0u16, 32768, 65535]
                .repeat(3)
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect(),
            [0.0, half16, 1.0, 1.0],
        ),
        (
            "VEC4",
            F32,
            [0.5f32, 2.0, 0.0, 0.25]
                .repeat(3)
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect(),
            [0.5, 2.0, 0.0, 0.25],
        ),
    ] {
        for normalized in [true, false] {
            let mut m = Model::triangle();
            let width = if kind == "VEC3" { 3 } else { 4 };
            let size = bytes.len() / 3;
            assert_eq!(size % width, 0);
            let color = m.bytes(kind, component, 3, &bytes);
            m.json["accessors"][color]["normalized"] = json!(normalized && component != F32);
            m.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(color);
            let found = m.load().meshes[0].colors[1].to_array();
            assert!(
                found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6),
                "{kind} {component}: {found:?}"
            );
        }
    }
}

#[test]
fn instances_may_be_quantised() {
    let mut m = Model::triangle();
    // A quarter turn about y: (0, √½, 0, √½), as bytes and as 16-bit numbers.
    let bytes = m.bytes("VEC4", 5120, 1, &[0, 90, 0, 90]);
    let words: Vec<u8> = [0i16, 23170, 0, 23170].iter().flat_map(|v| v.to_le_bytes()).collect();
    let words = m.bytes("VEC4", I16, 1, &words);
    let far = m.bytes("VEC3", 5120, 1, &[10, 0, 0x80, 0]);
    for rotation in [bytes, words] {
        m.json["accessors"][rotation]["normalized"] = json!(true);
        let attributes = json!({"ROTATION": rotation, "TRANSLATION": far});
        m.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
        let place = m.load().objects[0].transform.transform_point3(glam::DVec3::X);
        assert!((place - glam::DVec3::new(10.0, 0.0, -129.0)).length() < 1e-6, "{place}");
    }
}

#[test]
fn mirrored_and_sheared_nodes_keep_their_matrix() {
    let shear = [
        1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 3.0, 0.0, 0.0, 1.0,
    ];
    let mut m = Model::triangle();
    m.json["nodes"][0]["matrix"] = json!(shear);
    let placed = m.load().objects[0].transform;
    assert_eq!(
        placed.transform_point3(glam::DVec3::new(1.0, 2.0, 4.0)).to_array(),
        [5.0, 2.0, -4.0]
    );
    assert!(placed.matrix3.determinant() < 0.0);
}
