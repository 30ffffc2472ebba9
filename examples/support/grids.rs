//! One grid of balls for each material extension of glTF: columns and rows are its parameters. All grids share the ball,
//! the wall behind it and their buffer.

use super::gltf::{Model, Stored};
use super::{Surface, shapes};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::path::Path;

/// The name of a grid, and the material of the ball in a column (0 to 4) and a row (0 to 2).
type Grid = (&'static str, fn(usize, usize) -> Value);

const COLUMNS: usize = 5;
const ROWS: usize = 3;

/// Every grid; what its columns and rows are stands in docs/gallery.md.
const GRIDS: [Grid; 15] = [
    ("metallic_roughness", |c, r| {
        plain([0.95, 0.64, 0.38], 0.5 * r as f64, [0.0, 0.15, 0.35, 0.6, 1.0][c])
    }),
    ("ior", |c, r| {
        let ior = [1.0, 1.2, 1.5, 2.0, 3.0][c];
        extended([0.05, 0.12, 0.2], 0.0, 0.3 * r as f64, json!({ "ior": { "ior": ior } }))
    }),
    ("specular", |c, r| {
        let color = [[1.0, 1.0, 1.0], [1.0, 0.5, 0.2], [8.0, 4.0, 1.0]][r];
        let specular = json!({ "specularFactor": quarter(c), "specularColorFactor": color });
        extended([0.08, 0.08, 0.1], 0.0, 0.15, json!({ "specular": specular }))
    }),
    ("transmission", |c, r| {
        let color = [[1.0, 1.0, 1.0], [0.4, 0.8, 0.5], [0.4, 0.8, 0.5]][r];
        let transmission = json!({ "transmissionFactor": ([1.0, 1.0, 0.5][r]) });
        extended(
            color,
            0.0,
            [0.0, 0.1, 0.2, 0.4, 0.8][c],
            json!({ "transmission": transmission }),
        )
    }),
    ("volume", |c, r| {
        let distance = [0.1, 0.3, 1.0, 3.0][c.min(3)];
        let mut volume = json!({ "thicknessFactor": 0.84, "attenuationColor": [0.9, 0.5, 0.15] });
        if c < 4 {
            volume["attenuationDistance"] = json!(distance);
        }
        let extensions = json!({ "transmission": { "transmissionFactor": 1.0 }, "volume": volume,
            "ior": { "ior": ([1.5, 1.5, 1.1][r]) } });
        extended([1.0; 3], 0.0, [0.0, 0.3, 0.0][r], extensions)
    }),
    ("dispersion", |c, r| {
        let extensions = json!({ "transmission": { "transmissionFactor": 1.0 }, "volume": { "thicknessFactor": 0.84 },
            "ior": { "ior": ([1.3, 1.5, 1.9][r]) }, "dispersion": { "dispersion": ([0.0, 0.5, 1.0, 2.5, 6.0][c]) } });
        extended([1.0; 3], 0.0, 0.0, extensions)
    }),
    ("clearcoat", |c, r| {
        let coat = json!({ "clearcoatFactor": quarter(c), "clearcoatRoughnessFactor": ([0.0, 0.2, 0.5][r]) });
        extended([0.6, 0.05, 0.04], 0.5, 0.7, json!({ "clearcoat": coat }))
    }),
    ("sheen", |c, r| {
        let color = [[1.0, 1.0, 1.0], [0.9, 0.3, 0.1], [0.2, 0.4, 1.0]][r];
        let sheen = json!({ "sheenColorFactor": color, "sheenRoughnessFactor": ([0.1, 0.25, 0.45, 0.7, 1.0][c]) });
        extended([0.05, 0.02, 0.04], 0.0, 0.9, json!({ "sheen": sheen }))
    }),
    ("anisotropy", |c, r| {
        let turn = [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_2][r];
        let anisotropy = json!({ "anisotropyStrength": quarter(c), "anisotropyRotation": turn });
        extended([0.9, 0.85, 0.8], 1.0, 0.3, json!({ "anisotropy": anisotropy }))
    }),
    ("iridescence", |c, r| {
        let film = json!({ "iridescenceFactor": 1.0, "iridescenceIor": ([1.3, 1.3, 1.8][r]),
            "iridescenceThicknessMaximum": ([150.0, 250.0, 350.0, 500.0, 800.0][c]) });
        extended(
            [0.5, 0.5, 0.5],
            [0.0, 1.0, 0.0][r],
            0.15,
            json!({ "iridescence": film }),
        )
    }),
    ("diffuse_transmission", |c, r| {
        let color = [[1.0, 1.0, 1.0], [0.9, 0.4, 0.1], [0.2, 0.7, 0.2]][r];
        let through = json!({ "diffuseTransmissionFactor": quarter(c), "diffuseTransmissionColorFactor": color });
        extended([0.7; 3], 0.0, 0.6, json!({ "diffuse_transmission": through }))
    }),
    ("emissive_strength", |c, r| {
        let strength = json!({ "emissive_strength": { "emissiveStrength": ([0.0, 0.3, 1.0, 3.0, 10.0][c]) } });
        let mut material = extended([0.02; 3], 0.0, 0.4, strength);
        material["emissiveFactor"] = json!([[1.0, 0.9, 0.7], [1.0, 0.3, 0.1], [0.1, 0.4, 1.0]][r]);
        material
    }),
    ("unlit", |c, r| {
        let mut material = plain([0.2 * c as f64, 0.5, 1.0 - 0.2 * c as f64], 0.0, 0.6);
        if r != 1 {
            material["extensions"] = json!({ "KHR_materials_unlit": {} });
        }
        material
    }),
    ("specular_glossiness", |c, r| {
        let old = json!({ "diffuseFactor": [0.5, 0.2, 0.1, 1.0], "glossinessFactor": quarter(c),
            "specularFactor": ([[0.04, 0.04, 0.04], [0.5, 0.4, 0.1], [0.9, 0.9, 0.9]][r]) });
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": old } })
    }),
    ("alpha", |c, r| {
        let mut material = plain([0.8, 0.3, 0.2], 0.0, 0.5);
        material["pbrMetallicRoughness"]["baseColorFactor"][3] = json!(quarter(c));
        material["alphaMode"] = json!(["OPAQUE", "MASK", "BLEND"][r]);
        material
    }),
];

fn quarter(column: usize) -> f64 {
    0.25 * column as f64
}

fn plain(color: [f64; 3], metallic: f64, roughness: f64) -> Value {
    let [r, g, b] = color;
    json!({ "pbrMetallicRoughness":
        { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness } })
}

/// A plain material with extensions, named without the `KHR_materials_` that all begin with.
fn extended(color: [f64; 3], metallic: f64, roughness: f64, extensions: Value) -> Value {
    let mut material = plain(color, metallic, roughness);
    let named = extensions.as_object().into_iter().flatten();
    let named = named.map(|(name, value)| (format!("KHR_materials_{name}"), value.clone()));
    material["extensions"] = Value::Object(named.collect());
    material
}

/// Writes all grids, and the buffer they share.
pub fn write(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    for (name, material) in GRIDS {
        let mut model = Model::new();
        let ball = model.store(&shapes::ball(0.42, 40, 20));
        // A model without tangents gets them along u too; given ones make the grids independent of how.
        let tangents = tangents(&shapes::ball(0.42, 40, 20));
        let tangents = model.floats(&tangents);
        let with_tangents = Stored {
            attributes: {
                let mut attributes = ball.attributes.clone();
                attributes["TANGENT"] = tangents.into();
                attributes
            },
            indices: ball.indices,
        };
        let wall = model.store(&wall());
        let tiles = model.image(&tiles(16).into());
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let made = model.material(material(column, row));
                let is_turned = name == "anisotropy";
                let mesh = model.mesh(if is_turned { &with_tangents } else { &ball }, made);
                let at = [column as f64 - 2.0, 1.0 - row as f64, 0.0];
                model.root(json!({ "name": format!("{column}, {row}"), "mesh": mesh, "translation": at }));
            }
        }
        let sampler = model.push("samplers", json!({ "magFilter": 9728 }));
        let texture = model.push("textures", json!({ "source": tiles, "sampler": sampler }));
        let mut behind = plain([1.0; 3], 0.0, 0.9);
        behind["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
        let behind = model.material(behind);
        let wall = model.mesh(&wall, behind);
        model.root(json!({ "name": "wall", "mesh": wall, "translation": [0.0, 0.0, -0.7] }));
        model.camera([0.0, 0.0, 8.0], 0.385, 5.0 / 3.0);
        model.write(&folder.join(format!("{name}.gltf")), "grid.bin")?;
    }
    Ok(())
}

/// A wall larger than the picture, in cells of a quarter of a ball's place.
fn wall() -> Surface {
    let (w, h) = (3.5, 2.25);
    Surface {
        positions: vec![
            DVec3::new(-w, -h, 0.0),
            DVec3::new(w, -h, 0.0),
            DVec3::new(w, h, 0.0),
            DVec3::new(-w, h, 0.0),
        ],
        normals: vec![DVec3::Z; 4],
        uvs: [(0.0, 9.0), (14.0, 9.0), (14.0, 0.0), (0.0, 0.0)]
            .map(|(u, v)| DVec2::new(u, v))
            .to_vec(),
        quads: vec![[0, 1, 2, 3]],
    }
}

/// Two by two cells, light and dark.
fn tiles(size: u32) -> image::GrayImage {
    image::GrayImage::from_fn(size, size, |x, y| {
        let is_dark = (2 * x / size + 2 * y / size) % 2 == 1;
        image::Luma([if is_dark { 90 } else { 200 }])
    })
}

/// Along growing u, right-handed.
fn tangents(s: &Surface) -> Vec<[f32; 4]> {
    let along = |n: &DVec3| DVec3::Y.cross(*n).normalize_or(DVec3::X).as_vec3();
    s.normals.iter().map(|n| along(n).extend(1.0).to_array()).collect()
}
