//! A small GLB writer: images, materials, meshes of one primitive, nodes.

use super::Surface;
use image::RgbImage;
use serde_json::{Value, json};
use std::path::Path;

/// A model under construction. Every method that adds something returns its index.
pub struct Glb {
    json: Value,
    bytes: Vec<u8>,
}

impl Glb {
    /// An empty model.
    pub fn new() -> Glb {
        let json = json!({
            "asset": { "version": "2.0", "generator": "examples/make_models.rs" },
            "extensionsUsed": ["KHR_materials_emissive_strength"],
            "bufferViews": [], "accessors": [], "images": [], "textures": [],
            "samplers": [{ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497 }],
            "materials": [], "meshes": [], "nodes": [],
        });
        Glb {
            json,
            bytes: Vec::new(),
        }
    }

    fn push(&mut self, table: &str, value: Value) -> usize {
        let list = self.json[table].as_array_mut().expect("all tables are made in new()");
        list.push(value);
        list.len() - 1
    }

    fn view(&mut self, data: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(data);
        self.push("bufferViews", view)
    }

    /// Embeds a PNG; returns the index of a texture.
    pub fn image(&mut self, name: &str, image: &RgbImage) -> usize {
        let mut png = std::io::Cursor::new(Vec::new());
        let encoded = image.write_to(&mut png, image::ImageFormat::Png);
        encoded.expect("writing PNG into memory does not fail");
        let view = self.view(png.get_ref(), None);
        let source = self.push(
            "images",
            json!({ "name": name, "mimeType": "image/png", "bufferView": view }),
        );
        self.push("textures", json!({ "source": source, "sampler": 0 }))
    }

    /// A dielectric with colour, normal and roughness maps.
    pub fn textured(&mut self, name: &str, color: usize, normals: usize, roughness: usize) -> usize {
        let pbr = json!({
            "baseColorTexture": { "index": color },
            "metallicRoughnessTexture": { "index": roughness },
            "metallicFactor": 0.0,
        });
        let material = json!({ "name": name, "pbrMetallicRoughness": pbr, "normalTexture": { "index": normals } });
        self.push("materials", material)
    }

    /// A plain metal.
    pub fn metal(&mut self, name: &str, color: [f64; 3], roughness: f64) -> usize {
        let [r, g, b] = color;
        let pbr = json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 1.0, "roughnessFactor": roughness });
        self.push("materials", json!({ "name": name, "pbrMetallicRoughness": pbr }))
    }

    /// A surface that emits `color · strength`.
    pub fn glowing(&mut self, name: &str, color: [f64; 3], strength: f64) -> usize {
        let material = json!({
            "name": name,
            "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0 },
            "emissiveFactor": color,
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } },
        });
        self.push("materials", material)
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, name: &str, material: usize, s: &Surface) -> usize {
        let floats = |values: &mut dyn Iterator<Item = f64>| -> Vec<u8> {
            values.flat_map(|v| (v as f32).to_le_bytes()).collect()
        };
        let fold = |f: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3)
                .filter_map(|k| s.positions.iter().map(|p| p[k] as f32).reduce(f))
                .collect()
        };
        let count = s.positions.len();
        let data = floats(&mut s.positions.iter().flat_map(|p| p.to_array()));
        let view = self.view(&data, Some(34962));
        let position = json!({ "bufferView": view, "componentType": 5126, "count": count, "type": "VEC3",
            "min": fold(f32::min), "max": fold(f32::max) });
        let position = self.push("accessors", position);
        let data = floats(&mut s.normals.iter().flat_map(|p| p.to_array()));
        let view = self.view(&data, Some(34962));
        let normal = json!({ "bufferView": view, "componentType": 5126, "count": count, "type": "VEC3" });
        let normal = self.push("accessors", normal);
        let data = floats(&mut s.uvs.iter().flat_map(|p| p.to_array()));
        let view = self.view(&data, Some(34962));
        let uv = json!({ "bufferView": view, "componentType": 5126, "count": count, "type": "VEC2" });
        let uv = self.push("accessors", uv);
        let triangles = s.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        // Turned shapes end in points: faces without an area are left out.
        let proper = triangles.filter(|t| {
            let [a, b, c] = t.map(|i| s.positions[i as usize].as_vec3());
            (b - a).cross(c - a) != glam::Vec3::ZERO
        });
        let indices: Vec<u16> = proper.flatten().map(|i| i as u16).collect();
        let data: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&data, Some(34963));
        let index = json!({ "bufferView": view, "componentType": 5123, "count": indices.len(), "type": "SCALAR" });
        let index = self.push("accessors", index);
        let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv });
        let primitive = json!({ "attributes": attributes, "indices": index, "material": material });
        self.push("meshes", json!({ "name": name, "primitives": [primitive] }))
    }

    /// A node, turned about y by degrees, scaled, moved.
    pub fn node(&mut self, name: &str, mesh: Option<usize>, at: [f64; 3], y: f64, scale: f64, kids: &[usize]) -> usize {
        let (s, c) = (y.to_radians() / 2.0).sin_cos();
        let mut node =
            json!({ "name": name, "translation": at, "rotation": [0.0, s, 0.0, c], "scale": [scale, scale, scale] });
        if let Some(mesh) = mesh {
            node["mesh"] = mesh.into();
        }
        if !kids.is_empty() {
            node["children"] = kids.into();
        }
        self.push("nodes", node)
    }

    /// Writes the model with `root` as its only scene's only root.
    pub fn write(mut self, path: &Path, root: usize) -> std::io::Result<()> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        self.json["scenes"] = json!([{ "nodes": [root] }]);
        self.json["scene"] = 0.into();
        let mut text = self.json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes()[..], kind, data].concat();
        let body = [chunk(b"JSON", &text), chunk(b"BIN\0", &self.bytes)].concat();
        let header = [
            &b"glTF"[..],
            &2u32.to_le_bytes(),
            &(body.len() as u32 + 12).to_le_bytes(),
        ]
        .concat();
        std::fs::write(path, [header, body].concat())
    }
}
