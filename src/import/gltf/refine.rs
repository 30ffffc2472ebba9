//! The extensions that refine a material's surface.

use super::Loader;
use super::extension::{FINITE, Fields, NOT_NEGATIVE, UNIT, limit};
use super::material::{SPECULAR_GLOSSINESS, color_input, scalar_input};
use crate::scene::{Channel, ColorInput, Encoding, Medium, Principled, ScalarInput};
use glam::DVec3;
use serde_json::Value;

impl Loader<'_> {
    /// Reads the extensions that refine the surface. Returns what fills the inside.
    pub(super) fn refine(&mut self, raw: &Value, surface: &mut Principled, at: &str) -> Medium {
        if let Some(ior) = Fields::of(raw, "KHR_materials_ior", at) {
            surface.ior = ior.number("ior", 1.5, NOT_NEGATIVE, &mut self.report);
            if surface.ior != 0.0 {
                surface.ior = limit(surface.ior, 1.0..=f64::MAX, &ior.place("ior"), &mut self.report);
            }
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_specular", at) {
            surface.specular = self.scalar(&e, "specularFactor", 1.0, "specularTexture", Channel::A);
            surface.specular_color = self.color(&e, "specularColorFactor", 1.0, "specularColorTexture");
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_transmission", at) {
            surface.transmission = self.scalar(&e, "transmissionFactor", 0.0, "transmissionTexture", Channel::R);
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_clearcoat", at) {
            surface.clearcoat = self.scalar(&e, "clearcoatFactor", 0.0, "clearcoatTexture", Channel::R);
            let (factor, texture) = ("clearcoatRoughnessFactor", "clearcoatRoughnessTexture");
            surface.clearcoat_roughness = self.scalar(&e, factor, 0.0, texture, Channel::G);
            let info = e
                .member("clearcoatNormalTexture")
                .filter(|_| surface.clearcoat.factor != 0.0);
            surface.clearcoat_normal = self.normal_map(info, &e.place("clearcoatNormalTexture"));
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_sheen", at) {
            surface.sheen_color = self.color(&e, "sheenColorFactor", 0.0, "sheenColorTexture");
            let (factor, texture) = ("sheenRoughnessFactor", "sheenRoughnessTexture");
            surface.sheen_roughness = self.scalar(&e, factor, 0.0, texture, Channel::A);
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_anisotropy", at) {
            surface.anisotropy = self.scalar(&e, "anisotropyStrength", 0.0, "anisotropyTexture", Channel::B);
            surface.anisotropy_rotation = e.number("anisotropyRotation", 0.0, FINITE, &mut self.report);
            // The texture of the strength has the direction, too.
            surface.anisotropy_direction = surface.anisotropy.texture.map(|(texture, _)| texture);
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_iridescence", at) {
            self.iridescence(&e, surface);
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_diffuse_transmission", at) {
            let (factor, texture) = ("diffuseTransmissionFactor", "diffuseTransmissionTexture");
            surface.diffuse_transmission = self.scalar(&e, factor, 0.0, texture, Channel::A);
            let (factor, texture) = ("diffuseTransmissionColorFactor", "diffuseTransmissionColorTexture");
            surface.diffuse_transmission_color = self.color(&e, factor, 1.0, texture);
        }
        if let Some(e) = Fields::of(raw, "KHR_materials_dispersion", at) {
            surface.dispersion = e.number("dispersion", 0.0, NOT_NEGATIVE, &mut self.report);
        }
        self.volume(raw, surface, at)
    }

    /// `KHR_materials_iridescence`: the thickness lies between its two ends by the texture's green, and is the upper one
    /// without a texture.
    fn iridescence(&mut self, e: &Fields, surface: &mut Principled) {
        surface.iridescence = self.scalar(e, "iridescenceFactor", 0.0, "iridescenceTexture", Channel::R);
        surface.iridescence_ior = e.number("iridescenceIor", 1.3, 1.0..=f64::MAX, &mut self.report);
        let mut end = |name: &str, default: f64| e.number(name, default, NOT_NEGATIVE, &mut self.report);
        let thinnest = end("iridescenceThicknessMinimum", 100.0);
        let thickest = end("iridescenceThicknessMaximum", 400.0);
        let name = "iridescenceThicknessTexture";
        let info = e
            .member(name)
            .filter(|_| surface.iridescence.factor != 0.0 && thinnest != thickest);
        let texture = self.texture(info, Encoding::Linear, &e.place(name));
        surface.iridescence_thickness =
            ScalarInput::between(thinnest, thickest, texture.map(|texture| (texture, Channel::G)));
    }

    /// `KHR_materials_pbrSpecularGlossiness`: a dielectric whose F0 is the specular colour (ior 0 means F0 = 1 before
    /// the tint), of roughness 1 − glossiness·texture.
    pub(super) fn apply_specular_glossiness(&mut self, raw: &Value, surface: &mut Principled, at: &str) {
        let Some(old) = Fields::of(raw, SPECULAR_GLOSSINESS, at) else {
            return;
        };
        surface.metallic = 0.0.into();
        surface.ior = 0.0;
        surface.specular_color = self.color(&old, "specularFactor", 1.0, "specularGlossinessTexture");
        let gloss = old.number("glossinessFactor", 1.0, UNIT, &mut self.report);
        let (info, place) = (
            old.member("specularGlossinessTexture"),
            old.place("specularGlossinessTexture"),
        );
        let texture = self.texture(info.filter(|_| gloss > 0.0), Encoding::Srgb, &place);
        surface.roughness = ScalarInput::between(1.0, 1.0 - gloss, texture.map(|texture| (texture, Channel::A)));
    }

    /// A share with its texture; the texture of a share of 0 is not read.
    pub(super) fn scalar(
        &mut self,
        e: &Fields,
        factor: &str,
        default: f64,
        texture: &str,
        channel: Channel,
    ) -> ScalarInput {
        let factor = e.number(factor, default, UNIT, &mut self.report);
        let info = e.member(texture).filter(|_| factor != 0.0);
        scalar_input(factor, self.texture(info, Encoding::Linear, &e.place(texture)), channel)
    }

    /// A colour with its sRGB texture; the texture of black is not read.
    pub(super) fn color(&mut self, e: &Fields, factor: &str, default: f64, texture: &str) -> ColorInput {
        let factor = e.color(factor, default, NOT_NEGATIVE, &mut self.report);
        let info = e.member(texture).filter(|_| factor != DVec3::ZERO);
        color_input(factor, self.texture(info, Encoding::Srgb, &e.place(texture)))
    }
}
