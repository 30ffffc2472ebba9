//! Surfaces of glTF in furnaces: each extension alone, over roughness, and with each other one. A white box in white light
//! cannot be seen where nothing is lost, and is nowhere brighter than the light.
//!
//! Every comparison allows five standard errors of its own noise, a false alarm in two million for each of some thousand
//! channels, plus what the tables of lost light are off: 1 % (see the tests beside the lobes).

#[path = "gltf/builder.rs"]
#[allow(dead_code)]
mod builder;
mod support;

use builder::Model;
use glam::DVec3;
use pts::compile::compile;
use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::render::driver;
use pts::render::report::Silent;
use pts::scene::{Camera, EnvironmentKind, Scene};
use serde_json::{Value, json};
use support::estimate::{RegionMean, WHOLE};
use support::scenes;

const SIZE: u32 = 8;

/// The six faces of a box of half width 1 with this material, seen askew from near by so that it fills the picture.
fn boxed(material: Value) -> Scene {
    let mut m = Model::new();
    let (mut points, mut normals, mut tangents, mut uvs, mut indices) = (vec![], vec![], vec![], vec![], vec![]);
    for axis in 0..3usize {
        for side in [-1.0f32, 1.0] {
            let first = (points.len() / 3) as u16;
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for (a, b) in [(-1.0f32, -1.0f32), (side, -side), (1.0, 1.0), (-side, side)] {
                let mut p = [0.0; 3];
                (p[axis], p[u], p[v]) = (side, a, b);
                points.extend(p);
                let mut n = [0.0; 3];
                n[axis] = side;
                normals.extend(n);
                let mut t = [0.0, 0.0, 0.0, 1.0];
                t[u] = 1.0;
                tangents.extend(t);
                uvs.extend([0.5 + 0.5 * a, 0.5 + 0.5 * b]);
            }
            indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        }
    }
    let (p, n) = (m.floats("VEC3", &points), m.floats("VEC3", &normals));
    let (t, uv) = (m.floats("VEC4", &tangents), m.floats("VEC2", &uvs));
    let i = m.indices(&indices);
    let attributes = json!({"POSITION": p, "NORMAL": n, "TANGENT": t, "TEXCOORD_0": uv});
    let primitive = json!({"attributes": attributes, "indices": i, "material": 0});
    m.push("meshes", json!({"primitives": [primitive]}));
    m.push("materials", material);
    let mut scene = m.load();
    look(&mut scene, DVec3::new(0.5, 0.7, 1.9));
    scene
}

fn look(scene: &mut Scene, location: DVec3) {
    let direction = -location.normalize();
    let right = direction.cross(DVec3::Y).normalize();
    scene.cameras = vec![Camera {
        location,
        direction,
        right: right * 0.5,
        up: right.cross(direction) * 0.5,
        ..Camera::default()
    }];
    scene.active_camera = Some(0);
}

fn shoot(mut scene: Scene, sky: f64, spp: u32) -> RegionMean {
    scene.environment.kind = match sky {
        0.0 => EnvironmentKind::Black,
        sky => EnvironmentKind::Constant(DVec3::splat(sky)),
    };
    let mut diags = Diagnostics::default();
    let settings = scenes::settings([SIZE, SIZE], spp, 1);
    let compiled = compile(&scene, &MemoryFiles::default(), SIZE, SIZE, &mut diags);
    let compiled = compiled.unwrap_or_else(|| panic!("{diags:?}"));
    let (picture, report) = driver::render(&compiled, &settings, &Silent);
    assert!(report.anomalies.is_empty(), "{:?}", report.anomalies);
    scenes::estimate(&picture).region(WHOLE)
}

/// What an extension adds to a material, white where it has a colour; several members may be of the core.
fn extensions() -> Vec<(&'static str, Value)> {
    vec![
        ("metal", json!({"core": {"metallicFactor": 1}})),
        ("half metal", json!({"core": {"metallicFactor": 0.5}})),
        ("ior", json!({"KHR_materials_ior": {"ior": 2.0}})),
        ("ior 0", json!({"KHR_materials_ior": {"ior": 0}})),
        (
            "specular",
            json!({"KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [3, 3, 3]}}),
        ),
        (
            "transmission",
            json!({"KHR_materials_transmission": {"transmissionFactor": 1}}),
        ),
        (
            "volume",
            json!({"KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 1}}),
        ),
        (
            "dispersion",
            json!({"KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 1}, "KHR_materials_dispersion": {"dispersion": 0.5}}),
        ),
        (
            "clearcoat",
            json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.4}}),
        ),
        ("varnish", json!({"KHR_materials_clearcoat": {"clearcoatFactor": 0.7}})),
        (
            "sheen",
            json!({"KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 0.5}}),
        ),
        (
            "anisotropy",
            json!({"KHR_materials_anisotropy": {"anisotropyStrength": 0.7, "anisotropyRotation": 0.5}}),
        ),
        (
            "iridescence",
            json!({"KHR_materials_iridescence": {"iridescenceFactor": 1}}),
        ),
        (
            "half a film",
            json!({"KHR_materials_iridescence": {"iridescenceFactor": 0.5, "iridescenceIor": 1.8,
            "iridescenceThicknessMaximum": 700}}),
        ),
        (
            "diffuse transmission",
            json!({"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.6}}),
        ),
        ("unlit", json!({"KHR_materials_unlit": {}})),
        (
            "strong emission of none",
            json!({"KHR_materials_emissive_strength": {"emissiveStrength": 9}}),
        ),
        (
            "specular glossiness",
            json!({"KHR_materials_pbrSpecularGlossiness": {"specularFactor": [0.5, 0.5, 0.5],
            "glossinessFactor": 0.5}}),
        ),
    ]
}

fn material(parts: &[&Value], roughness: f64, color: [f64; 4]) -> Value {
    let mut core = json!({"metallicFactor": 0, "roughnessFactor": roughness, "baseColorFactor": color});
    let mut extensions = json!({});
    for (name, fields) in parts.iter().flat_map(|part| part.as_object().unwrap()) {
        let target = if name == "core" {
            &mut core
        } else {
            &mut extensions[name]
        };
        match target.as_object_mut() {
            Some(known) => known.extend(fields.as_object().unwrap().clone()),
            None => *target = fields.clone(),
        }
    }
    json!({"pbrMetallicRoughness": core, "extensions": extensions})
}

/// The brightest channel of the picture is at least `low` and at most `high`. What is noisy gets more samples.
fn check(name: &str, material: Value, low: f64, high: f64) {
    let scene = boxed(material);
    for spp in [64, 512, 4096] {
        let found = shoot(scene.clone(), 1.0, spp);
        let noise = 5.0 * found.stderr.iter().fold(0.0, |a: f64, b| a.max(*b));
        let most = found.mean.iter().fold(0.0, |a: f64, b| a.max(*b));
        if noise < 0.01 || spp == 4096 {
            assert!(noise < 0.03, "{name}: noise of {noise}");
            assert!(most < high + noise && most > low - noise, "{name}: {found:?}");
            return;
        }
    }
}

const WHITE: [f64; 4] = [1.0; 4];

/// The least that is left of white: films lose what their brightest channel has more than the others, at each view.
fn least(names: &[&str]) -> f64 {
    let has_film = names.iter().any(|n| n.contains("iridescence") || n.contains("film"));
    if has_film { 0.96 } else { 0.99 }
}

#[test]
fn white_is_lost_under_no_extension_alone() {
    for (name, part) in extensions() {
        for roughness in [0.0, 0.1, 0.5, 1.0] {
            let name = format!("{name} of roughness {roughness}");
            check(&name, material(&[&part], roughness, WHITE), least(&[&name]), 1.01);
        }
    }
}

#[test]
fn white_is_lost_under_no_two_extensions() {
    let all = extensions();
    for (i, (a, part)) in all.iter().enumerate() {
        for (b, other) in &all[i + 1..] {
            if *a == "unlit" || *b == "unlit" {
                continue; // excludes all others
            }
            // Alternating keeps the time.
            let roughness = if (i + b.len()) % 2 == 0 { 0.15 } else { 0.6 };
            let name = format!("{a} with {b}, roughness {roughness}");
            check(&name, material(&[part, other], roughness, WHITE), least(&[a, b]), 1.01);
        }
    }
}

/// Colours take light away and never give it: dark and saturated ones, with extensions at odd strengths.
#[test]
fn no_colour_creates_light() {
    let coloured = json!({
        "KHR_materials_specular": {"specularColorFactor": [2, 0.5, 9]},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.6, "clearcoatRoughnessFactor": 0.2},
        "KHR_materials_sheen": {"sheenColorFactor": [0.2, 0.9, 0.4], "sheenRoughnessFactor": 0.3},
        "KHR_materials_iridescence": {"iridescenceFactor": 0.8, "iridescenceThicknessMaximum": 500},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.9},
    });
    let transmissions = [
        json!({}),
        json!({"KHR_materials_transmission": {"transmissionFactor": 0.5}}),
        json!({"KHR_materials_transmission": {"transmissionFactor": 0.8}, "KHR_materials_volume": {"thicknessFactor": 1}}),
        json!({"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5,
            "diffuseTransmissionColorFactor": [1, 0.5, 0]}}),
        json!({"core": {"metallicFactor": 0.5}}),
    ];
    for part in &transmissions {
        for roughness in [0.0, 0.3, 1.0] {
            let material = material(&[&coloured, part], roughness, [0.9, 0.4, 0.1, 1.0]);
            check(&format!("{part} {roughness}"), material, 0.0, 1.01);
        }
    }
}

/// A film without share, and one without thickness, leave every bit as it is.
#[test]
fn a_film_that_is_not_there_changes_no_bit() {
    let shot = |part: Value, roughness| {
        let found = shoot(boxed(material(&[&part], roughness, [0.8, 0.5, 0.3, 1.0])), 1.0, 16);
        found.mean
    };
    for roughness in [0.0, 0.4] {
        for core in [json!({"metallicFactor": 1}), json!({})] {
            let film = |fields: Value| json!({"core": core, "KHR_materials_iridescence": fields});
            let bare = shot(json!({"core": core}), roughness);
            assert_eq!(bare, shot(film(json!({})), roughness));
            let none = json!({"iridescenceFactor": 1, "iridescenceThicknessMaximum": 0});
            assert_eq!(bare, shot(film(none), roughness));
            let some = shot(film(json!({"iridescenceFactor": 1})), roughness);
            assert_ne!(bare, some);
        }
    }
}

/// Oracle: the extension's text, emission · (1 − clearcoat · F) with Schlick's curve from 0.04, in the dark. The camera looks
/// straight at the middle of a face through so narrow a field that the cosine is 1 to 10⁻³.
#[test]
fn a_coat_dims_what_glows_below_it() {
    let mut glowing = material(
        &[&json!({"KHR_materials_clearcoat": {"clearcoatFactor": 0.5},
            "KHR_materials_emissive_strength": {"emissiveStrength": 4}})],
        0.5,
        [0.0, 0.0, 0.0, 1.0],
    );
    glowing["emissiveFactor"] = json!([1, 0.5, 0.25]);
    for (location, cos) in [(DVec3::new(0.0, 0.0, 3.0), 1.0f64), (DVec3::new(2.0, 0.0, 3.5), 0.0)] {
        let mut scene = boxed(glowing.clone());
        look(&mut scene, location);
        scene.cameras[0].right *= 0.02;
        scene.cameras[0].up *= 0.02;
        // Aimed at the centre of the box, the ray meets the face z = 1.
        let cos = if cos > 0.0 { cos } else { location.z / location.length() };
        let fresnel = 0.04 + 0.96 * (1.0 - cos).powi(5);
        let found = shoot(scene, 0.0, 4).mean;
        for (found, factor) in found.iter().zip([4.0, 2.0, 1.0]) {
            let wanted = factor * (1.0 - 0.5 * fresnel);
            assert!((found / wanted - 1.0).abs() < 1e-3, "{found}, not {wanted}");
        }
    }
}

/// A floor below an unlit sheet, in a white sky: it gets all light of the sky, as if nothing hung over it, and none of the
/// sheet's; the camera above sees the sheet's colour.
#[test]
fn unlit_surfaces_are_seen_and_neither_light_nor_shade() {
    let scene = |has_sheet: bool, eye: f64| {
        let mut m = Model::new();
        let quad = |m: &mut Model, y: f32| {
            let p = m.floats("VEC3", &[-9.0, y, -9.0, -9.0, y, 9.0, 9.0, y, 9.0, 9.0, y, -9.0]);
            let i = m.indices(&[0, 1, 2, 0, 2, 3]);
            (p, i)
        };
        let mut primitives = vec![];
        for (material, y) in [0.0f32, 1.0].into_iter().enumerate().take(1 + usize::from(has_sheet)) {
            let (p, i) = quad(&mut m, y);
            primitives.push(json!({"attributes": {"POSITION": p}, "indices": i, "material": material}));
        }
        m.push("meshes", json!({"primitives": primitives}));
        m.push("materials", material(&[], 1.0, [0.5, 0.5, 0.5, 1.0]));
        let unlit = json!({"KHR_materials_unlit": {}});
        m.push("materials", material(&[&unlit], 1.0, [0.9, 0.1, 0.3, 1.0]));
        let mut scene = m.load();
        look(&mut scene, DVec3::new(0.0, eye, 0.001));
        scene
    };
    let open = shoot(scene(false, 0.5), 1.0, 64);
    let below = shoot(scene(true, 0.5), 1.0, 64);
    for c in 0..3 {
        let noise = 5.0 * (open.stderr[c].powi(2) + below.stderr[c].powi(2)).sqrt();
        assert!(
            (open.mean[c] - below.mean[c]).abs() <= noise,
            "{open:?}, below {below:?}"
        );
    }
    let above = shoot(scene(true, 3.0), 1.0, 4);
    for (found, wanted) in above.mean.iter().zip([0.9, 0.1, 0.3]) {
        assert!((found - wanted).abs() < 1e-6, "{above:?}");
    }
}

/// Light that seeps into a solid through its diffuse skin is absorbed inside by the colour of the volume: the channel that
/// nothing absorbs stays white, the others lose by the way.
#[test]
fn what_seeps_into_a_volume_is_absorbed() {
    let inside = |distance: f64| {
        let part = json!({
            "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [1, 0.5, 0.25],
                "attenuationDistance": distance},
        });
        shoot(boxed(material(&[&part], 0.5, WHITE)), 1.0, 256)
    };
    let (short, long) = (inside(2.0), inside(8.0));
    for found in [&short, &long] {
        let [r, g, b] = found.mean;
        assert!((r - 1.0).abs() < 0.01 + 5.0 * found.stderr[0], "{found:?}");
        assert!(g < 0.95 && b < g - 0.05, "{found:?}");
    }
    assert!(long.mean[1] > short.mean[1] + 0.1, "{short:?}, {long:?}");
}
