//! MTL properties to the scene's materials.
//!
//! MTL describes Phong's model of 1975, later programs added a metallic-roughness set. Mapping: `illum` 4, 6, 7, 9
//! are glass; 3 and 5 mirrors; `Pr Pm Ps Pc …` the principled set; `Ks` with a highlight a dielectric whose
//! roughness matches the Phong lobe; everything else is diffuse. `Ka` has no meaning in a path tracer. Blender writes
//! its principled surface with the same words in a meaning of its own, which is taken back exactly.

use super::clean::Cleaned;
use super::mtl::{Blender, Library, Map, Mtl};
use super::report::Report;
use super::texture::Textures;
use crate::diag::Diagnostic;
use crate::files::Files;
use crate::scene::{
    BumpMap, Channel, ColorInput, Encoding, Material, MaterialId, NormalMap, Opacity, OpacityMode, Place, Principled,
    ScalarInput, Scene, SurfaceModel,
};
use glam::DVec3;

/// Converts the materials that faces use, and only those. One entry for each of [`Cleaned::materials`].
pub(super) fn add_materials(
    cleaned: &Cleaned,
    library: &Library,
    files: &dyn Files,
    scene: &mut Scene,
    report: &mut Report,
) -> Vec<Option<MaterialId>> {
    let mut used = vec![false; cleaned.materials.len()];
    for material in cleaned.faces.iter().filter_map(|f| f.material) {
        if let Some(flag) = used.get_mut(material as usize) {
            *flag = true;
        }
    }
    let mut textures = Textures::new(files);
    let mut add = |(named, used): (&super::clean::Named, bool)| {
        if !used {
            return None;
        }
        let Some(mtl) = library.get(&named.name) else {
            // A missing library has been reported; that its materials are missing too goes without saying.
            if !library.is_empty() || cleaned.libraries.is_empty() {
                let message = format!("material {:?} is not defined; its faces are white", named.name);
                let known = library.keys().min_by_key(|k| strsim::levenshtein(k, &named.name));
                let hint = known.map_or("name a library with `mtllib`".to_owned(), |k| {
                    format!("did you mean {k:?}?")
                });
                report.push(named.line, Diagnostic::warning("O0210", message).hint(hint));
            }
            return None;
        };
        let mut mapping = Mapping {
            mtl,
            textures: &mut textures,
            scene,
            report,
        };
        let mut material = mapping.material();
        material.name.clone_from(&named.name);
        Some(scene.add_material(material))
    };
    cleaned.materials.iter().zip(used).map(&mut add).collect()
}

struct Mapping<'a, 'f> {
    mtl: &'a Mtl,
    textures: &'a mut Textures<'f>,
    scene: &'a mut Scene,
    report: &'a mut Report,
}

impl Mapping<'_, '_> {
    fn number(&self, key: &str) -> Option<f64> {
        self.mtl.numbers.get(key).copied()
    }

    /// A number that must lie in [0, 1]; others are reported and moved to the nearer end.
    fn fraction(&mut self, key: &str) -> Option<f64> {
        let value = self.number(key)?;
        if !(0.0..=1.0).contains(&value) {
            self.warn(
                "O0211",
                format!("`{key} {value}` lies outside [0, 1], the nearer end is used"),
            );
        }
        Some(value.clamp(0.0, 1.0))
    }

    fn warn(&mut self, code: &'static str, message: String) {
        self.report
            .push_at(self.mtl.place.clone(), Diagnostic::warning(code, message));
    }

    /// A colour with its texture; a black factor below a texture is an exporter's slip, not a black surface.
    fn color(&mut self, key: &str, map_key: &str, default: DVec3) -> ColorInput {
        let written = self.mtl.colors.get(key).copied();
        let Some(map) = self.mtl.maps.get(map_key) else {
            return written.unwrap_or(default).into();
        };
        if map.base != 0.0 {
            let message = "the base of texture option `-mm` is not supported for colours and taken as 0";
            self.report
                .push_at(map.place.clone(), Diagnostic::warning("O0217", message));
        }
        match self.textures.add(map, Encoding::Srgb, self.scene, self.report) {
            Some(texture) => ColorInput {
                factor: written.filter(|c| *c != DVec3::ZERO).unwrap_or(DVec3::ONE) * map.gain,
                texture: Some(texture),
            },
            None => written.unwrap_or(default).into(),
        }
    }

    fn scalar(&mut self, key: &str, map_key: &str, default: f64) -> ScalarInput {
        let written = self.fraction(key);
        let Some(map) = self.mtl.maps.get(map_key) else {
            return written.unwrap_or(default).into();
        };
        match self.textures.add(map, Encoding::Linear, self.scene, self.report) {
            Some(texture) => {
                let factor = written.filter(|v| *v != 0.0).unwrap_or(1.0);
                ScalarInput {
                    factor: factor * map.gain,
                    texture: Some((texture, map.channel.unwrap_or(Channel::R))),
                    offset: factor * map.base,
                }
            }
            None => written.unwrap_or(default).into(),
        }
    }

    fn material(&mut self) -> Material {
        let mut material = Material::new(self.surface());
        material.emission = self.color("ke", "map_ke", DVec3::ZERO);
        material.place = Place::Model(self.mtl.place.clone());
        (material.normal_map, material.bump_map) = self.relief();
        if !matches!(material.surface, SurfaceModel::Glass { .. }) {
            material.opacity = self.opacity();
        }
        material
    }

    fn surface(&mut self) -> SurfaceModel {
        let illum = self.number("illum").map(|v| v as i64);
        let kd = self.color("kd", "map_kd", DVec3::splat(0.8));
        let has_pbr = ["pr", "pm", "ps", "pc"]
            .iter()
            .any(|k| self.mtl.numbers.contains_key(k))
            || ["map_pr", "map_pm", "map_ps"]
                .iter()
                .any(|k| self.mtl.maps.contains_key(k));
        // A texture without a factor stands for itself.
        let unwritten = if self.mtl.maps.contains_key("map_ks") { 0.5 } else { 0.0 };
        let ks = self.mtl.colors.get("ks").copied().unwrap_or(DVec3::splat(unwritten));
        let has_map_d = self.mtl.maps.contains_key("map_d");
        if let Some(blender) = self.mtl.blender {
            return self.blender(blender, kd, ks);
        }
        match illum {
            // Exporters choose 4 for cut-out leaves too; index 1 bends nothing and is plain transparency.
            Some(4 | 6 | 7 | 9) if !has_map_d && self.number("ni") != Some(1.0) => self.glass(),
            _ if has_pbr => self.principled(kd),
            Some(3 | 5) => self.mirror(kd, ks),
            Some(0 | 1) => diffuse(kd),
            _ if ks == DVec3::ZERO => diffuse(kd),
            _ => self.highlight(kd, ks),
        }
    }

    /// Blender's meaning of the words: a principled surface whose transparency is coverage in every `illum`. `Ka` of 3 and
    /// 6 is the metallic share, `Ks` the specular level (0.5 is an ordinary dielectric), `Ns` = most·(1 − roughness)².
    fn blender(&mut self, dialect: Blender, kd: ColorInput, ks: DVec3) -> SurfaceModel {
        let SurfaceModel::Principled(mut p) = self.principled(kd) else {
            return diffuse(kd);
        };
        if !self.mtl.numbers.contains_key("pr") && !self.mtl.maps.contains_key("map_pr") {
            let exponent = self.number("ns").unwrap_or(0.25 * dialect.most_ns).max(0.0);
            p.roughness = (1.0 - (exponent / dialect.most_ns).min(1.0).sqrt()).into();
        }
        let is_reflective = self.number("illum").is_some_and(|i| i == 3.0 || i == 6.0);
        if let (true, Some(ka)) = (is_reflective, self.mtl.colors.get("ka"))
            && !self.mtl.numbers.contains_key("pm")
        {
            p.metallic = (ka.element_sum() / 3.0).min(1.0).into();
        }
        (p.specular, p.specular_color) = self.specular(ks);
        SurfaceModel::Principled(p)
    }

    fn ior(&mut self) -> f64 {
        match self.number("ni") {
            Some(ni) if ni >= 1.0 => ni,
            Some(ni) => {
                self.warn(
                    "O0212",
                    format!("index of refraction `Ni {ni}` is below 1, 1.5 is used"),
                );
                1.5
            }
            None => 1.5,
        }
    }

    /// `Tf` tints what passes; black means that nobody set it.
    fn glass(&mut self) -> SurfaceModel {
        let tint = self
            .mtl
            .colors
            .get("tf")
            .copied()
            .filter(|c| *c != DVec3::ZERO)
            .unwrap_or(DVec3::ONE);
        SurfaceModel::Glass {
            color: tint.min(DVec3::ONE).into(),
            ior: self.ior(),
            roughness: self.scalar("pr", "map_pr", 0.0),
            abbe: None,
        }
    }

    /// `Kd` diffuse plus `Ks` mirrored, scaled down together where they would return more than they get.
    fn mirror(&mut self, kd: ColorInput, ks: DVec3) -> SurfaceModel {
        let (d, s) = (kd.factor.max_element(), ks.max_element());
        if s == 0.0 {
            return diffuse(kd);
        }
        if d == 0.0 {
            return SurfaceModel::Specular {
                color: ks.min(DVec3::ONE).into(),
            };
        }
        let total = (d + s).max(1.0);
        let weight = s / total;
        let below = ColorInput {
            factor: kd.factor / (total * (1.0 - weight)),
            texture: kd.texture,
        };
        let a = self.scene.add_material(Material::new(diffuse(below)));
        let mirror = SurfaceModel::Specular { color: (ks / s).into() };
        let b = self.scene.add_material(Material::new(mirror));
        SurfaceModel::Mix {
            a,
            b,
            weight: weight.into(),
        }
    }

    /// Phong's highlight as a rough dielectric coat: `Ks` = 0.5 reflects 4 % at normal incidence, as ordinary
    /// dielectrics do.
    fn highlight(&mut self, kd: ColorInput, ks: DVec3) -> SurfaceModel {
        let (specular, specular_color) = self.specular(ks);
        SurfaceModel::Principled(Box::new(Principled {
            base_color: kd,
            roughness: self.roughness().into(),
            specular,
            specular_color,
            ..Principled::default()
        }))
    }

    /// Strength and tint of a highlight; none at all for black.
    fn specular(&mut self, ks: DVec3) -> (ScalarInput, ColorInput) {
        let strongest = ks.max_element();
        if strongest == 0.0 {
            return (0.0.into(), DVec3::ONE.into());
        }
        let f0_scale = 2.0 * strongest;
        let tint = ks / strongest * f0_scale.max(1.0);
        let mut specular_color = ColorInput::constant(tint);
        if let Some(map) = self.mtl.maps.get("map_ks") {
            specular_color.factor *= map.gain;
            specular_color.texture = self.textures.add(map, Encoding::Srgb, self.scene, self.report);
        }
        (f0_scale.min(1.0).into(), specular_color)
    }

    /// Perceptual roughness of the Phong exponent `Ns`: α² = 2 / (Ns + 2) and α = roughness².
    /// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces" (2007), section on Phong.
    fn roughness(&mut self) -> f64 {
        let exponent = self.number("ns").unwrap_or(10.0).max(0.0);
        (2.0 / (exponent + 2.0)).sqrt().sqrt()
    }

    fn principled(&mut self, base_color: ColorInput) -> SurfaceModel {
        let from_phong = self.roughness();
        let anisotropy = self.fraction("aniso").unwrap_or(0.0);
        let sheen = self.scalar("ps", "map_ps", 0.0);
        SurfaceModel::Principled(Box::new(Principled {
            base_color,
            metallic: self.scalar("pm", "map_pm", 0.0),
            roughness: self.scalar("pr", "map_pr", from_phong),
            ior: self.ior(),
            clearcoat: self.fraction("pc").unwrap_or(0.0).into(),
            clearcoat_roughness: self.fraction("pcr").unwrap_or(0.0).into(),
            sheen_color: ColorInput {
                factor: DVec3::splat(sheen.factor),
                texture: sheen.texture.map(|t| t.0),
            },
            sheen_roughness: 0.5.into(),
            anisotropy: anisotropy.into(),
            anisotropy_rotation: self.number("anisor").unwrap_or(0.0) * std::f64::consts::TAU,
            ..Principled::default()
        }))
    }

    /// `d` is opacity, `Tr` its complement; where both are written `d` wins, since programs disagree about `Tr`.
    fn opacity(&mut self) -> Opacity {
        let transparency = self.fraction("tr").map(|t| 1.0 - t);
        let value = self.fraction("d").or(transparency).unwrap_or(1.0);
        let map = self.mtl.maps.get("map_d").or(self.mtl.maps.get("map_tr"));
        let Some(map) = map else {
            if value == 0.0 {
                let message =
                    "material is fully transparent and cannot be seen; some programs write `d` and `Tr` swapped";
                self.warn("O0213", message.to_owned());
            }
            let mode = if value < 1.0 {
                OpacityMode::Blend
            } else {
                OpacityMode::Opaque
            };
            return Opacity {
                mode,
                alpha: value.into(),
            };
        };
        let Some(texture) = self.textures.add(map, Encoding::Linear, self.scene, self.report) else {
            return Opacity::default();
        };
        // The colour image named again means its alpha, and so does an image with an alpha that varies; any other is a
        // mask in grey.
        let of_alpha = |map: &Map, report: &mut Report| {
            let same = self.mtl.maps.get("map_kd").is_some_and(|kd| kd.file == map.file);
            same || self.textures.has_alpha(map, report)
        };
        let value = if value == 0.0 { 1.0 } else { value };
        let channel = match map.channel {
            Some(channel) => channel,
            None if of_alpha(map, self.report) => Channel::A,
            None => Channel::R,
        };
        Opacity {
            mode: OpacityMode::Blend,
            alpha: ScalarInput {
                factor: value * map.gain,
                texture: Some((texture, channel)),
                offset: value * map.base,
            },
        }
    }

    /// A normal map, or else a height map. MTL says no unit of heights; as in POV-Ray, `-bm 1` sets white one texel above
    /// black, which looks alike on models of any size.
    fn relief(&mut self) -> (Option<NormalMap>, Option<BumpMap>) {
        let (map, is_normal) = match (self.mtl.maps.get("norm"), self.mtl.maps.get("bump")) {
            (Some(norm), _) => (norm, true),
            (None, Some(bump)) => (bump, self.textures.is_normal_map(bump, self.report)),
            (None, None) => return (None, None),
        };
        let Some(texture) = self.textures.add(map, Encoding::Linear, self.scene, self.report) else {
            return (None, None);
        };
        if is_normal {
            let scale = map.bump;
            return (Some(NormalMap { texture, scale }), None);
        }
        let scale = map.bump * map.gain;
        (None, Some(BumpMap { texture, scale }))
    }
}

fn diffuse(color: ColorInput) -> SurfaceModel {
    SurfaceModel::Diffuse {
        color,
        sigma: 0.0.into(),
    }
}
