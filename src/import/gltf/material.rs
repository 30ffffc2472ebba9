//! Materials: the core's metallic-roughness model, coverage and emission; [`super::refine`] has the extensions.

use super::Loader;
use super::extension::{FINITE, Fields, NOT_NEGATIVE, UNIT, exact, limit};
use crate::scene::{
    Channel, ColorInput, EmissionSides, Encoding, Material, MaterialId, NormalMap, Opacity, OpacityMode, Principled,
    ScalarInput, SurfaceModel, Texture, TextureId,
};
use glam::{DVec3, DVec4};
use gltf::json;
use json::material::AlphaMode;
use json::validation::Checked;
use serde_json::Value;

/// Base colour and coverage, which share a texture.
struct Base {
    factor: DVec4,
    texture: Option<TextureId>,
}

impl Loader<'_> {
    /// The material `index`, referred to at `at`; `colors`: multiplied by the mesh's vertex colours. `None` if it is
    /// broken (reported).
    pub(super) fn material(&mut self, index: usize, colors: bool, at: &str) -> Option<MaterialId> {
        if let Some(known) = self.materials.get(&(index, colors)) {
            return *known;
        }
        let made = self.read_material(index, colors, at);
        self.materials.insert((index, colors), made);
        made
    }

    /// The material of primitives that name none: white, metallic 1, roughness 1 (specification 3.9.1).
    pub(super) fn default_material(&mut self, colors: bool) -> MaterialId {
        let key = (usize::MAX, colors);
        if let Some(Some(known)) = self.materials.get(&key) {
            return *known;
        }
        let texture = colors.then(|| self.vertex_color());
        let surface = SurfaceModel::Principled(Box::new(Principled {
            base_color: color_input(DVec3::ONE, texture),
            metallic: 1.0.into(),
            roughness: 1.0.into(),
            ..Principled::default()
        }));
        let material = Material {
            name: "default".to_owned(),
            emission_sides: EmissionSides::Front,
            place: self.report.origin(""),
            ..Material::new(surface)
        };
        let id = self.scene.add_material(material);
        self.materials.insert(key, Some(id));
        id
    }

    fn read_material(&mut self, index: usize, colors: bool, at: &str) -> Option<MaterialId> {
        let raw = self.doc.raw(TABLE, index, at, &mut self.report)?;
        let core: json::Material = self.doc.get(index, at, &mut self.report)?;
        let at = format!("{TABLE}[{index}]");
        let base = self.base_of(raw, colors, &at);
        let sides = if core.double_sided {
            EmissionSides::Both
        } else {
            EmissionSides::Front
        };
        let mut material = Material {
            name: self.doc.name(TABLE, index),
            emission_sides: sides,
            opacity: self.opacity_of(raw, &core, &base, &at),
            place: self.report.origin(&at),
            ..Material::new(SurfaceModel::Black)
        };
        if raw
            .get("extensions")
            .is_some_and(|e| e.get("KHR_materials_unlit").is_some())
        {
            // The colour is what the camera should see, from either side.
            material.emission = color_input(base.factor.truncate(), base.texture);
            material.emission_sides = EmissionSides::Both;
            material.unlit = true;
            return Some(self.scene.add_material(material));
        }
        material.emission = self.emission_of(raw, &at);
        material.normal_map = self.normal_map(raw.get("normalTexture"), &format!("{at}.normalTexture"));
        let mut surface = self.core_surface(raw, &base, &at);
        material.interior = self.refine(raw, &mut surface, &at);
        self.apply_specular_glossiness(raw, &mut surface, &at);
        material.surface = SurfaceModel::Principled(Box::new(surface));
        Some(self.scene.add_material(material))
    }

    /// Base colour factor and texture, of the metallic-roughness model or of the older specular-glossiness one.
    fn base_of(&mut self, raw: &Value, colors: bool, at: &str) -> Base {
        let (fields, factor, texture) = match Fields::of(raw, SPECULAR_GLOSSINESS, at) {
            Some(old) => (old, "diffuseFactor", "diffuseTexture"),
            None => {
                let pbr = raw.get(PBR).unwrap_or(&Value::Null);
                (
                    Fields::new(pbr, format!("{at}.{PBR}")),
                    "baseColorFactor",
                    "baseColorTexture",
                )
            }
        };
        let factor = fields.numbers(factor, [1.0; 4], UNIT, &mut self.report);
        let (info, place) = (fields.member(texture), fields.place(texture));
        let mut texture = self.texture(info, Encoding::Srgb, &place);
        if colors {
            let vertex = self.vertex_color();
            texture = Some(match texture {
                Some(image) => self.scene.add_texture(Texture::Product(image, vertex)),
                None => vertex,
            });
        }
        Base {
            factor: DVec4::from_array(factor),
            texture,
        }
    }

    fn opacity_of(&mut self, raw: &Value, core: &json::Material, base: &Base, at: &str) -> Opacity {
        let mode = match core.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => return Opacity::default(),
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = Fields::new(raw, at).number("alphaCutoff", 0.5, NOT_NEGATIVE, &mut self.report);
                OpacityMode::Mask(cutoff)
            }
            Checked::Valid(AlphaMode::Blend) => OpacityMode::Blend,
            Checked::Invalid => {
                let message = "is none of OPAQUE, MASK, BLEND; OPAQUE is used";
                self.report.warning("G0206", &format!("{at}.alphaMode"), message);
                return Opacity::default();
            }
        };
        let alpha = scalar_input(base.factor.w, base.texture, Channel::A);
        Opacity { mode, alpha }
    }

    /// Emitted radiance: `emissiveFactor · emissiveStrength · texture`, in W·sr⁻¹·m⁻².
    fn emission_of(&mut self, raw: &Value, at: &str) -> ColorInput {
        let strength = Fields::of_or_empty(raw, "KHR_materials_emissive_strength", at);
        let strength = strength.number("emissiveStrength", 1.0, NOT_NEGATIVE, &mut self.report);
        let place = format!("{at}.emissiveFactor");
        let factor: [f64; 3] = exact(raw, "emissiveFactor").unwrap_or_default();
        let factor = factor.map(|f| limit(f, NOT_NEGATIVE, &place, &mut self.report));
        let factor = DVec3::from_array(factor) * strength;
        if factor == DVec3::ZERO {
            return factor.into();
        }
        let place = format!("{at}.emissiveTexture");
        let texture = self.texture(raw.get("emissiveTexture"), Encoding::Srgb, &place);
        color_input(factor, texture)
    }

    /// The surface by the core specification alone.
    fn core_surface(&mut self, raw: &Value, base: &Base, at: &str) -> Principled {
        let at = format!("{at}.{PBR}");
        let pbr = Fields::new(raw.get(PBR).unwrap_or(&Value::Null), at.clone());
        let metallic = pbr.number("metallicFactor", 1.0, UNIT, &mut self.report);
        let roughness = pbr.number("roughnessFactor", 1.0, UNIT, &mut self.report);
        let info = raw.get(PBR).and_then(|p| p.get("metallicRoughnessTexture"));
        let info = info.filter(|_| metallic != 0.0 || roughness != 0.0);
        let texture = self.texture(info, Encoding::Linear, &format!("{at}.metallicRoughnessTexture"));
        Principled {
            base_color: color_input(base.factor.truncate(), base.texture),
            metallic: scalar_input(metallic, texture, Channel::B),
            roughness: scalar_input(roughness, texture, Channel::G),
            ..Principled::default()
        }
    }

    pub(super) fn normal_map(&mut self, info: Option<&Value>, at: &str) -> Option<NormalMap> {
        let scale = Fields::new(info?, at).number("scale", 1.0, FINITE, &mut self.report);
        let texture = self.texture(info, Encoding::Linear, at)?;
        Some(NormalMap { texture, scale })
    }

    fn vertex_color(&mut self) -> TextureId {
        let known = self.scene.textures.iter().position(|t| *t == Texture::VertexColor);
        known.map_or_else(|| self.scene.add_texture(Texture::VertexColor), |i| TextureId(i as u32))
    }
}

const TABLE: &str = "materials";
const PBR: &str = "pbrMetallicRoughness";
pub(super) const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

pub(super) fn color_input(factor: DVec3, texture: Option<TextureId>) -> ColorInput {
    ColorInput { factor, texture }
}

/// `factor · texture.channel`.
pub(super) fn scalar_input(factor: f64, texture: Option<TextureId>, channel: Channel) -> ScalarInput {
    ScalarInput::scaled(factor, texture.map(|t| (t, channel)))
}
