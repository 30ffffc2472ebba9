//! Small models made in memory.

use base64::Engine;
use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::import::gltf::{GltfOptions, load};
use pts::scene::{Mesh, Principled, Scene, SurfaceModel};
use serde_json::{Value, json};

pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A model under construction: JSON and one buffer.
pub struct Model {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Model {
    /// A scene of one node with mesh 0, which is not there yet.
    pub fn new() -> Model {
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
        });
        Model { json, bin: Vec::new() }
    }

    /// The same with a triangle of corners (0,0,0), (2,0,0), (0,2,0) in the mesh, and this material.
    pub fn triangle() -> Model {
        let mut m = Model::new();
        let p = m.floats("VEC3", &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
        m.push("meshes", json!({"primitives": [{"attributes": {"POSITION": p}}]}));
        m
    }

    /// The triangle with a material.
    pub fn with_material(material: Value) -> Model {
        let mut m = Model::triangle();
        m.push("materials", material);
        m.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        m
    }

    /// The same with texture 0 on image 0, a PNG in name only (nothing decodes it here).
    pub fn with_texture(material: Value) -> Model {
        let mut m = Model::with_material(material);
        m.push("images", json!({"uri": "data:image/png;base64,iVBORw0KGgo="}));
        m.push("textures", json!({"source": 0}));
        m
    }

    /// A `.glb` taken apart.
    pub fn from_glb(bytes: &[u8]) -> Model {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let bin = 20 + word(12);
        let mut json: Value = serde_json::from_slice(&bytes[20..bin]).unwrap();
        json["buffers"].take();
        let bin = bytes[bin + 8..].to_vec();
        Model { json, bin }
    }

    /// Appends an element to a table and returns its index.
    pub fn push(&mut self, table: &str, element: Value) -> usize {
        if self.json[table].is_null() {
            self.json[table] = json!([]);
        }
        let items = self.json[table].as_array_mut().unwrap();
        items.push(element);
        items.len() - 1
    }

    /// A view of new bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.push(
            "bufferViews",
            json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}),
        )
    }

    /// An accessor of new bytes.
    pub fn bytes(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind}),
        )
    }

    /// An accessor of new floats.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.bytes(kind, F32, values.len() / width, &bytes)
    }

    /// An accessor of new 16-bit indices.
    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.bytes("SCALAR", U16, values.len(), &bytes)
    }

    /// The model as a `.gltf` with its buffer embedded.
    pub fn text(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if !self.bin.is_empty() && json["buffers"].is_null() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.bin);
            let uri = format!("data:application/octet-stream;base64,{data}");
            json["buffers"] = json!([{"byteLength": self.bin.len(), "uri": uri}]);
        }
        serde_json::to_vec(&json).unwrap()
    }

    /// The model as a `.glb`.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut out = b"glTF".to_vec();
        for word in [2, 12 + 8 + text.len() + 8 + bin.len(), text.len(), 0x4E4F_534A] {
            out.extend((word as u32).to_le_bytes());
        }
        out.extend(text);
        out.extend((bin.len() as u32).to_le_bytes());
        out.extend(0x004E_4942u32.to_le_bytes());
        out.extend(bin);
        out
    }

    /// Loads it; panics with the diagnostics if that fails.
    pub fn load(&self) -> Scene {
        let (scene, diags) = self.try_load(&GltfOptions::default());
        scene.unwrap_or_else(|| panic!("{diags:#?}"))
    }

    /// Loads it with these options.
    pub fn try_load(&self, options: &GltfOptions) -> (Option<Scene>, Diagnostics) {
        let mut files = MemoryFiles::default();
        files.insert("model.gltf", self.text());
        load_from(&files, "model.gltf", options)
    }

    /// The codes of what loading says, in order.
    pub fn codes(&self) -> Vec<&'static str> {
        codes(&self.try_load(&GltfOptions::default()).1)
    }
}

/// Loads a model of these files.
pub fn load_from(files: &MemoryFiles, name: &str, options: &GltfOptions) -> (Option<Scene>, Diagnostics) {
    let mut diags = Diagnostics::default();
    let scene = load(name.as_ref(), files, options, &mut diags);
    assert_eq!(
        scene.is_none(),
        diags.has_errors(),
        "no scene if and only if there are errors: {diags:?}"
    );
    (scene, diags)
}

/// The codes of the diagnostics, in order.
pub fn codes(diags: &Diagnostics) -> Vec<&'static str> {
    diags.iter().map(|d| d.code).collect()
}

/// The positions of a mesh in its own space.
pub fn positions(mesh: &Mesh) -> Vec<[f64; 3]> {
    let place = |p: &glam::Vec3| (mesh.center + p.as_dvec3()).to_array();
    mesh.positions.iter().map(place).collect()
}

/// The principled surface of the first material.
pub fn principled(scene: &Scene) -> &Principled {
    match &scene.materials[0].surface {
        SurfaceModel::Principled(p) => p,
        other => panic!("{other:?}"),
    }
}
