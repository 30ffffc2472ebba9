//! A plain glTF writer: tables of JSON and one buffer, for models that show one feature each.

use super::Surface;
use serde_json::{Value, json};
use std::path::Path;

/// A model under construction. Every method that adds something returns its index.
pub struct Model {
    /// The document.
    pub json: Value,
    bytes: Vec<u8>,
}

/// Where a mesh's attributes lie.
#[derive(Clone)]
pub struct Stored {
    /// `attributes` of a primitive.
    pub attributes: Value,
    /// `indices` of a primitive.
    pub indices: usize,
}

impl Model {
    /// A model with one scene and nothing in it.
    pub fn new() -> Model {
        let json = json!({
            "asset": { "version": "2.0", "generator": "examples/make_models.rs" },
            "scene": 0, "scenes": [{ "nodes": [] }],
        });
        Model {
            json,
            bytes: Vec::new(),
        }
    }

    /// Appends to a table of the document.
    pub fn push(&mut self, table: &str, value: Value) -> usize {
        let list = self.json.as_object_mut().expect("an object from new() on");
        let list = list.entry(table).or_insert_with(|| json!([]));
        let list = list.as_array_mut().expect("tables are arrays");
        list.push(value);
        list.len() - 1
    }

    /// A material; the extensions it names are listed as used.
    pub fn material(&mut self, material: Value) -> usize {
        if let Some(extensions) = material["extensions"].as_object() {
            extensions.keys().for_each(|name| self.uses(name));
        }
        self.push("materials", material)
    }

    /// Lists an extension as used.
    pub fn uses(&mut self, name: &str) {
        let known = self.json["extensionsUsed"].as_array().into_iter().flatten();
        if !known.into_iter().any(|n| n == name) {
            self.push("extensionsUsed", name.into());
        }
    }

    /// A view of new bytes.
    pub fn view(&mut self, data: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len() });
        self.bytes.extend_from_slice(data);
        self.push("bufferViews", view)
    }

    /// An accessor of new bytes.
    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, data: &[u8]) -> usize {
        let view = self.view(data);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }),
        )
    }

    /// An accessor of floats.
    pub fn floats<const N: usize>(&mut self, rows: &[[f32; N]]) -> usize {
        let kind = match N {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            16 => "MAT4",
            _ => "VEC4",
        };
        let data: Vec<u8> = rows.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let index = self.accessor(kind, 5126, rows.len(), &data);
        if N == 3 {
            let fold = |f: fn(f32, f32) -> f32| -> Vec<f32> {
                (0..N).filter_map(|k| rows.iter().map(|r| r[k]).reduce(f)).collect()
            };
            self.json["accessors"][index]["min"] = json!(fold(f32::min));
            self.json["accessors"][index]["max"] = json!(fold(f32::max));
        }
        index
    }

    /// An accessor of 16-bit indices.
    pub fn indices(&mut self, values: &[u16]) -> usize {
        let data: Vec<u8> = values.iter().flat_map(|i| i.to_le_bytes()).collect();
        self.accessor("SCALAR", 5123, values.len(), &data)
    }

    /// The attributes of a surface: positions, normals, texture coordinates and tangents along u.
    pub fn store(&mut self, s: &Surface) -> Stored {
        let vec3 = |list: &[glam::DVec3]| -> Vec<[f32; 3]> { list.iter().map(|p| p.as_vec3().to_array()).collect() };
        let position = self.floats(&vec3(&s.positions));
        let normal = self.floats(&vec3(&s.normals));
        let uvs: Vec<[f32; 2]> = s.uvs.iter().map(|p| p.as_vec2().to_array()).collect();
        let uv = self.floats(&uvs);
        let indices: Vec<u16> = triangles(s).flatten().collect();
        Stored {
            attributes: json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv }),
            indices: self.indices(&indices),
        }
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, stored: &Stored, material: usize) -> usize {
        let primitive = json!({ "attributes": stored.attributes, "indices": stored.indices, "material": material });
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// A node at the root of the scene.
    pub fn root(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        let roots = self.json["scenes"][0]["nodes"].as_array_mut();
        roots.expect("there from new() on").push(index.into());
        index
    }

    /// A camera that looks along −z from `at`, with this vertical field of view (radians) and aspect.
    pub fn camera(&mut self, at: [f64; 3], yfov: f64, aspect: f64) {
        let perspective = json!({ "yfov": yfov, "aspectRatio": aspect, "znear": 0.1 });
        let camera = self.push("cameras", json!({ "type": "perspective", "perspective": perspective }));
        self.root(json!({ "camera": camera, "translation": at }));
    }

    /// Embeds a picture as PNG; returns the index of an image.
    pub fn image(&mut self, image: &image::DynamicImage) -> usize {
        let mut png = std::io::Cursor::new(Vec::new());
        let encoded = image.write_to(&mut png, image::ImageFormat::Png);
        encoded.expect("writing PNG into memory does not fail");
        let view = self.view(png.get_ref());
        self.push("images", json!({ "bufferView": view, "mimeType": "image/png" }))
    }

    /// Writes the document, and its buffer beside it under `buffer`, which other models may share.
    pub fn write(mut self, path: &Path, buffer: &str) -> std::io::Result<()> {
        if !self.bytes.is_empty() {
            self.json["buffers"] = json!([{ "uri": buffer, "byteLength": self.bytes.len() }]);
            std::fs::write(path.with_file_name(buffer), &self.bytes)?;
        }
        let text = serde_json::to_string(&self.json).map_err(std::io::Error::other)?;
        std::fs::write(path, text + "\n")
    }
}

/// The triangles of a surface. Turned shapes end in points: faces without an area are left out.
pub fn triangles(s: &Surface) -> impl Iterator<Item = [u16; 3]> + '_ {
    let all = s.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let proper = all.filter(|t| {
        let [a, b, c] = t.map(|i| s.positions[i as usize].as_vec3());
        (b - a).cross(c - a).length() > 1e-6
    });
    proper.map(|t| t.map(|i| i as u16))
}
