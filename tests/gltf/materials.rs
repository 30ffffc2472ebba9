//! Materials and textures.

use crate::builder::*;
use glam::{DVec2, DVec3};
use pts::scene::{
    Channel, EmissionSides, Encoding, ImageSource, ImageTexture, OpacityMode, Phase, Scene, SurfaceModel, TexelFilter,
    Texture, TextureId, Wrap,
};
use serde_json::{Value, json};

fn image(scene: &Scene, id: Option<TextureId>) -> &ImageTexture {
    match &scene.textures[id.expect("a texture").index()] {
        Texture::Image(t) => t,
        other => panic!("{other:?}"),
    }
}

fn extended(name: &str, fields: Value) -> Value {
    json!({"extensions": {name: fields}})
}

#[test]
fn a_primitive_without_material_is_white_rough_metal_unless_whoever_places_it_knows_better() {
    let scene = Model::triangle().load();
    assert!(scene.meshes[0].materials.iter().all(Option::is_none));
    assert_eq!(scene.default_material.map(|m| m.0), Some(0));
    let p = principled(&scene);
    assert_eq!(
        (p.base_color.factor, p.metallic.factor, p.roughness.factor),
        (DVec3::ONE, 1.0, 1.0)
    );
    let empty = Model::with_material(json!({})).load();
    let p = principled(&empty);
    assert_eq!((p.metallic.factor, p.roughness.factor, p.ior), (1.0, 1.0, 1.5));
    assert_eq!(empty.materials[0].emission_sides, EmissionSides::Front);
}

#[test]
fn core_textures_have_their_channels_and_encodings() {
    let mut m = Model::with_texture(json!({
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 0.125, 1], "metallicFactor": 0.5, "roughnessFactor": 0.25,
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0, "texCoord": 1},
        },
        "emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": 0},
        "normalTexture": {"index": 0},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
    }));
    m.json["textures"][0]["sampler"] = json!(0);
    m.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}]);
    let scene = m.load();
    let (p, material) = (principled(&scene), &scene.materials[0]);
    assert_eq!(p.base_color.factor, DVec3::new(0.5, 0.25, 0.125));
    let base = image(&scene, p.base_color.texture);
    assert_eq!(
        (base.encoding, base.uv_set, base.filter),
        (Encoding::Srgb, 0, TexelFilter::Nearest)
    );
    assert_eq!((base.wrap_u, base.wrap_v), (Wrap::Clamp, Wrap::Mirror));
    let (metallic, roughness) = (p.metallic.texture.unwrap(), p.roughness.texture.unwrap());
    assert_eq!((p.metallic.factor, metallic.1), (0.5, Channel::B));
    assert_eq!((p.roughness.factor, roughness.1), (0.25, Channel::G));
    let data = image(&scene, Some(roughness.0));
    assert_eq!(
        (data.encoding, data.uv_set, metallic.0),
        (Encoding::Linear, 1, roughness.0)
    );
    assert_eq!(material.emission.factor, DVec3::new(8.0, 4.0, 0.0));
    assert_eq!(
        material.emission.texture, p.base_color.texture,
        "the same reference is the same texture"
    );
    assert_eq!(material.emission_sides, EmissionSides::Both);
    assert_eq!(
        image(&scene, material.normal_map.map(|n| n.texture)).encoding,
        Encoding::Linear
    );
    assert_eq!(scene.images.len(), 1);
    assert!(matches!(&scene.images[0].source, ImageSource::Bytes(b) if b[..4] == *b"\x89PNG"));
}

#[test]
fn a_texture_transform_turns_counter_clockwise_with_v_downwards() {
    let transform =
        json!({"offset": [0.5, 0.25], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 2});
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let scene = Model::with_texture(json!({"pbrMetallicRoughness": {"baseColorTexture": info}})).load();
    let texture = image(&scene, principled(&scene).base_color.texture);
    assert_eq!(texture.uv_set, 2);
    // Scaled to (2, 3); a quarter turn takes (u, v) to (v, −u).
    let uv = texture.uv_transform.transform_point2(DVec2::ONE);
    assert!((uv - DVec2::new(3.5, -1.75)).length() < 1e-12, "{uv}");
}

#[test]
fn alpha_modes_use_the_base_colours_alpha() {
    let load = |mode: &str| {
        let base = json!({"baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": {"index": 0}});
        let m = Model::with_texture(json!({"alphaMode": mode, "alphaCutoff": 0.25, "pbrMetallicRoughness": base}));
        let scene = m.load();
        scene.materials[0].opacity
    };
    let opaque = load("OPAQUE");
    assert_eq!(
        (opaque.mode, opaque.alpha.factor, opaque.alpha.texture),
        (OpacityMode::Opaque, 1.0, None)
    );
    let (mask, blend) = (load("MASK"), load("BLEND"));
    assert_eq!((mask.mode, mask.alpha.factor), (OpacityMode::Mask(0.25), 0.5));
    assert_eq!(blend.mode, OpacityMode::Blend);
    assert_eq!(blend.alpha.texture.map(|t| t.1), Some(Channel::A));
}

#[test]
fn solid_glass_absorbs_by_its_attenuation_and_thin_glass_does_not() {
    let load = |thickness: f64| {
        let extensions = json!({
            "KHR_materials_transmission": {"transmissionFactor": 0.75},
            "KHR_materials_ior": {"ior": 1.33},
            "KHR_materials_volume": {"thicknessFactor": thickness, "attenuationDistance": 2.0,
                "attenuationColor": [0.5, 1.0, 0.0]},
            "KHR_materials_dispersion": {"dispersion": 0.125},
        });
        Model::with_material(json!({"extensions": extensions})).load()
    };
    let solid = load(0.1);
    let p = principled(&solid);
    assert_eq!(
        (p.transmission.factor, p.ior, p.thick, p.dispersion),
        (0.75, 1.33, true, 0.125)
    );
    let sigma = solid.materials[0].interior.absorption;
    assert!((sigma.x - 2f64.ln() / 2.0).abs() < 1e-12);
    assert_eq!(sigma.y, 0.0);
    assert!(
        sigma.z > 300.0 && sigma.z.is_finite(),
        "black absorbs all, by a finite number"
    );
    let thin = load(0.0);
    assert!(!principled(&thin).thick);
    assert_eq!(thin.materials[0].interior.absorption, DVec3::ZERO);
}

/// Oracle: the extension's text: what is taken from the way stays σ = −ln(colour)/distance, the scattered share of it
/// makes a deep solid look like the colour.
#[test]
fn a_volume_that_scatters_splits_its_extinction() {
    let load = |volume_only: bool, transmission: &str| {
        let mut extensions = json!({
            transmission: {"transmissionFactor": 1, "diffuseTransmissionFactor": 1,
                "diffuseTransmissionColorFactor": [1, 0.5, 1]},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.5,
                "attenuationColor": [0.9, 0.9, 0.9]},
            "KHR_materials_volume_scatter": {"multiscatterColor": [0, 0.5, 1], "scatterAnisotropy": 0.25},
        });
        if volume_only {
            extensions
                .as_object_mut()
                .unwrap()
                .remove("KHR_materials_volume_scatter");
        }
        Model::with_material(json!({"extensions": extensions})).load()
    };
    let glass = "KHR_materials_transmission";
    let (scene, plain) = (load(false, glass), load(true, glass));
    let (m, extinction) = (scene.materials[0].interior, plain.materials[0].interior.absorption);
    assert!((m.absorption + m.scattering - extinction).length() < 1e-15);
    let share = m.scattering / extinction;
    assert!(
        share.x < 1e-5 && share.y > 0.5 && share.y < 1.0 && share.z > 1.0 - 1e-5,
        "{share}"
    );
    assert_eq!(m.phase, Phase::HenyeyGreenstein(0.25));
    // Light that enters diffusely enters.
    let wax = load(false, "KHR_materials_diffuse_transmission");
    let p = principled(&wax);
    assert_eq!(
        (p.transmission.factor, p.diffuse_transmission.factor, p.thick),
        (1.0, 0.0, true)
    );
    assert_eq!(p.base_color.factor, DVec3::new(1.0, 0.5, 1.0));
    let sheet = load(true, "KHR_materials_diffuse_transmission");
    assert_eq!(principled(&sheet).diffuse_transmission.factor, 1.0);
}

#[test]
fn layers_are_read_with_their_textures_and_channels() {
    let info = json!({"index": 0});
    let m = Model::with_texture(json!({"extensions": {
        "KHR_materials_specular": {"specularFactor": 0.5, "specularTexture": info, "specularColorFactor": [2, 1, 0.5],
            "specularColorTexture": info},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.25, "clearcoatTexture": info, "clearcoatRoughnessFactor": 0.125,
            "clearcoatRoughnessTexture": info, "clearcoatNormalTexture": {"index": 0, "scale": 2}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.75,
            "sheenRoughnessTexture": info},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1.5, "anisotropyTexture": info},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25,
            "diffuseTransmissionColorFactor": [1, 0, 0], "diffuseTransmissionTexture": info},
    }}));
    let scene = m.load();
    let p = principled(&scene);
    let channel = |s: pts::scene::ScalarInput| (s.factor, s.texture.map(|t| t.1));
    assert_eq!(channel(p.specular), (0.5, Some(Channel::A)));
    assert_eq!(p.specular_color.factor, DVec3::new(2.0, 1.0, 0.5));
    assert_eq!(image(&scene, p.specular_color.texture).encoding, Encoding::Srgb);
    assert_eq!(channel(p.clearcoat), (0.25, Some(Channel::R)));
    assert_eq!(channel(p.clearcoat_roughness), (0.125, Some(Channel::G)));
    assert_eq!(p.clearcoat_normal.map(|n| n.scale), Some(2.0));
    assert_eq!(p.sheen_color.factor, DVec3::new(0.1, 0.2, 0.3));
    assert_eq!(channel(p.sheen_roughness), (0.75, Some(Channel::A)));
    assert_eq!(
        (channel(p.anisotropy), p.anisotropy_rotation),
        ((0.5, Some(Channel::B)), 1.5)
    );
    assert_eq!(channel(p.diffuse_transmission), (0.25, Some(Channel::A)));
    assert_eq!(p.diffuse_transmission_color.factor, DVec3::X);
}

#[test]
fn unlit_surfaces_show_their_colour_and_scatter_nothing() {
    let mut material = extended("KHR_materials_unlit", json!({}));
    material["pbrMetallicRoughness"] = json!({"baseColorFactor": [0.25, 0.5, 1, 1], "baseColorTexture": {"index": 0}});
    let scene = Model::with_texture(material).load();
    let m = &scene.materials[0];
    assert_eq!(m.surface, SurfaceModel::Black);
    assert_eq!(
        (m.emission.factor, m.emission.texture.is_some()),
        (DVec3::new(0.25, 0.5, 1.0), true)
    );
    assert_eq!(m.emission_sides, EmissionSides::Both);
}

#[test]
fn specular_glossiness_becomes_a_dielectric_with_its_own_f0() {
    let name = "KHR_materials_pbrSpecularGlossiness";
    let fields = json!({"diffuseFactor": [0.5, 0.25, 0.125, 1], "specularFactor": [0.75, 0.5, 0.25],
        "glossinessFactor": 0.75});
    let scene = Model::with_material(extended(name, fields)).load();
    let p = principled(&scene);
    assert_eq!(p.base_color.factor, DVec3::new(0.5, 0.25, 0.125));
    assert_eq!(p.specular_color.factor, DVec3::new(0.75, 0.5, 0.25));
    assert_eq!((p.metallic.factor, p.roughness.factor, p.ior), (0.0, 0.25, 0.0));
    let with_map = json!({"glossinessFactor": 0.75, "specularGlossinessTexture": {"index": 0}});
    let scene = Model::with_texture(extended(name, with_map)).load();
    let p = principled(&scene);
    assert_eq!(scene.materials.len(), 1);
    assert_eq!((p.roughness.offset, p.roughness.factor), (1.0, -0.75));
    assert_eq!(p.roughness.texture.map(|t| t.1), Some(Channel::A));
}

/// Oracle: the extension's text. The thickness is mix(minimum, maximum, green), and the maximum without a texture.
#[test]
fn a_film_has_its_index_and_the_range_of_its_thickness() {
    let name = "KHR_materials_iridescence";
    let load = |fields: Value| Model::with_texture(extended(name, fields)).load();
    let bare = load(json!({"iridescenceFactor": 0.5}));
    let p = principled(&bare);
    assert_eq!((p.iridescence.constant(), p.iridescence_ior), (Some(0.5), 1.3));
    assert_eq!(p.iridescence_thickness.constant(), Some(400.0));
    let mapped = load(
        json!({"iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceTexture": {"index": 0},
        "iridescenceThicknessMinimum": 700, "iridescenceThicknessMaximum": 200,
        "iridescenceThicknessTexture": {"index": 0}}),
    );
    let p = principled(&mapped);
    assert_eq!(p.iridescence.texture.map(|t| t.1), Some(Channel::R));
    let thickness = p.iridescence_thickness;
    assert_eq!((thickness.offset, thickness.factor), (700.0, -500.0));
    assert_eq!(thickness.texture.map(|t| t.1), Some(Channel::G));
    assert_eq!((thickness.least(), thickness.most()), (200.0, 700.0));
    let none = load(json!({"iridescenceFactor": 0, "iridescenceThicknessTexture": {"index": 0}}));
    assert!(none.textures.is_empty(), "a film of no share reads nothing");
}

/// Red and green of the texture are a direction, blue a factor of the strength.
#[test]
fn the_texture_of_an_anisotropy_has_its_direction_too() {
    let fields = json!({"anisotropyStrength": 0.5, "anisotropyRotation": 0.25, "anisotropyTexture": {"index": 0}});
    let scene = Model::with_texture(extended("KHR_materials_anisotropy", fields)).load();
    let p = principled(&scene);
    assert_eq!((p.anisotropy.factor, p.anisotropy_rotation), (0.5, 0.25));
    let (texture, channel) = p.anisotropy.texture.unwrap();
    assert_eq!((channel, p.anisotropy_direction), (Channel::B, Some(texture)));
    assert_eq!(image(&scene, Some(texture)).encoding, Encoding::Linear);
}

#[test]
fn numbers_out_of_range_are_moved_with_a_warning_and_wrong_types_take_the_default() {
    let mut m = Model::with_material(extended("KHR_materials_ior", json!({"ior": 0.5})));
    m.json["materials"][0]["pbrMetallicRoughness"] = json!({"metallicFactor": 7});
    m.json["materials"][0]["extensions"]["KHR_materials_sheen"] = json!({"sheenRoughnessFactor": "soft"});
    let scene = m.load();
    let p = principled(&scene);
    assert_eq!((p.metallic.factor, p.ior, p.sheen_roughness.factor), (1.0, 1.0, 0.0));
    assert_eq!(m.codes(), ["G0207", "G0207", "G0206"]);
}

#[test]
fn what_a_factor_of_zero_makes_invisible_is_not_read() {
    let material = json!({
        "emissiveFactor": [0, 0, 0], "emissiveTexture": {"index": 0},
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0, "metallicRoughnessTexture": {"index": 0}},
        "occlusionTexture": {"index": 0},
        "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0, "clearcoatTexture": {"index": 0}}},
    });
    let scene = Model::with_texture(material).load();
    assert_eq!((scene.textures.len(), scene.images.len()), (0, 0));
}

#[test]
fn a_texture_without_readable_image_leaves_the_factor() {
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let mut m = Model::with_texture(base);
    m.json["textures"][0] = json!({"extensions": {"EXT_texture_avif": {"source": 0}}});
    assert_eq!(m.codes(), ["G0704"]);
    assert_eq!(principled(&m.load()).base_color.texture, None);
    m.json["textures"][0] = json!({"extensions": {"EXT_texture_webp": {"source": 0}}});
    assert_eq!(
        m.codes(),
        ["G0615"],
        "the image is taken, though this triangle has no coordinates for it"
    );
    assert!(principled(&m.load()).base_color.texture.is_some());
}
