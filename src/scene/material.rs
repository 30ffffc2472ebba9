//! Materials as they are written; `compile` turns them into recipes for the engine.

use super::{Channel, Medium, Place, TextureId};
use glam::DVec3;

/// A colour that may vary over the surface: `factor · texture.rgb` (or `factor` alone). Linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant factor.
    pub factor: DVec3,
    /// Texture multiplied to it.
    pub texture: Option<TextureId>,
}

impl ColorInput {
    /// The same colour everywhere.
    pub fn constant(factor: DVec3) -> ColorInput {
        ColorInput { factor, texture: None }
    }
}

impl From<DVec3> for ColorInput {
    fn from(factor: DVec3) -> ColorInput {
        ColorInput::constant(factor)
    }
}

/// A number that may vary over the surface: `offset + factor · texture.channel` (or `offset + factor` alone).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Factor of the texture; negative for complements such as 1 − gloss.
    pub factor: f64,
    /// Texture and the channel taken from it.
    pub texture: Option<(TextureId, Channel)>,
    /// Added to the product; 0 for most inputs.
    pub offset: f64,
}

impl From<f64> for ScalarInput {
    fn from(factor: f64) -> ScalarInput {
        ScalarInput {
            factor,
            texture: None,
            offset: 0.0,
        }
    }
}

impl ScalarInput {
    /// `factor · texture.channel`, or `factor` alone.
    pub fn scaled(factor: f64, texture: Option<(TextureId, Channel)>) -> ScalarInput {
        ScalarInput {
            factor,
            texture,
            offset: 0.0,
        }
    }

    /// From `from` where the texture's channel is 0 to `to` where it is 1; `to` without a texture.
    pub fn between(from: f64, to: f64, texture: Option<(TextureId, Channel)>) -> ScalarInput {
        match texture {
            Some(_) => ScalarInput {
                factor: to - from,
                texture,
                offset: from,
            },
            None => to.into(),
        }
    }

    /// The number where it is the same everywhere.
    pub fn constant(&self) -> Option<f64> {
        self.texture.is_none().then_some(self.offset + self.factor)
    }

    /// The largest that it can be, texels being in [0, 1].
    pub fn most(&self) -> f64 {
        self.constant().unwrap_or(self.offset + self.factor.max(0.0))
    }

    /// The smallest that it can be, texels being in [0, 1].
    pub fn least(&self) -> f64 {
        self.constant().unwrap_or(self.offset + self.factor.min(0.0))
    }
}

/// Which sides of a surface emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum EmissionSides {
    /// The side of the geometric normal: outside of solids, glTF without `doubleSided`.
    #[default]
    Front,
    /// Both: open surfaces of text scenes, glTF `doubleSided`.
    Both,
    /// Front on closed solids, both on open surfaces (triangles, discs, planes, meshes): what a text scene means.
    ByShape,
}

/// How coverage (alpha) is used. Coverage lets rays through unseen; it is not transmission.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum OpacityMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Fully there where alpha ≥ the cutoff, gone elsewhere.
    Mask(f64),
    /// There with probability alpha.
    Blend,
}

/// Coverage of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opacity {
    /// How alpha is used.
    pub mode: OpacityMode,
    /// Alpha in [0, 1].
    pub alpha: ScalarInput,
}

impl Default for Opacity {
    fn default() -> Opacity {
        Opacity {
            mode: OpacityMode::Opaque,
            alpha: ScalarInput::from(1.0),
        }
    }
}

/// A tangent-space normal map: `normalize((2t − 1)·(scale, scale, 1))`, +y up (OpenGL).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// A data texture.
    pub texture: TextureId,
    /// Factor on x and y.
    pub scale: f64,
}

/// A relief: white texels (by luminance) stand `scale` texels above black ones, on the outside of solids that light
/// enters and on the viewer's side of everything else. Heights in texels make slopes that depend neither on the size of the surface nor on how often the
/// image repeats on it; that is POV-Ray's meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap {
    /// A data texture; only images have slopes.
    pub texture: TextureId,
    /// Height of white over black, in texels.
    pub scale: f64,
}

/// The glTF material set (metallic-roughness with its extensions), same words in snake_case.
/// Roughness is perceptual, α = roughness².
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Base colour: diffuse albedo of the dielectric, reflectance at normal incidence of the metal.
    pub base_color: ColorInput,
    /// 0 dielectric … 1 metal.
    pub metallic: ScalarInput,
    /// Perceptual roughness in [0, 1].
    pub roughness: ScalarInput,
    /// Index of refraction of the dielectric, ≥ 1; 0 means infinite (F0 = 1).
    pub ior: f64,
    /// Strength of the dielectric's specular lobe (F90 too).
    pub specular: ScalarInput,
    /// Tint of the dielectric's F0.
    pub specular_color: ColorInput,
    /// Share of the diffuse part that is transmitted instead.
    pub transmission: ScalarInput,
    /// Whether transmission is through a solid (refracts, `KHR_materials_volume`) or a thin sheet.
    pub thick: bool,
    /// Clearcoat strength.
    pub clearcoat: ScalarInput,
    /// Clearcoat perceptual roughness.
    pub clearcoat_roughness: ScalarInput,
    /// Normal map of the coat; the vertex normal if `None`.
    pub clearcoat_normal: Option<NormalMap>,
    /// Sheen colour.
    pub sheen_color: ColorInput,
    /// Sheen perceptual roughness.
    pub sheen_roughness: ScalarInput,
    /// Anisotropy strength in [0, 1].
    pub anisotropy: ScalarInput,
    /// Rotation of the anisotropy in the tangent plane, radians.
    pub anisotropy_rotation: f64,
    /// A data texture whose red and green, 2t − 1, are the direction of the anisotropy along tangent and bitangent, before
    /// the rotation; the tangent if `None`, and where it is no direction.
    pub anisotropy_direction: Option<TextureId>,
    /// Share of the diffuse part that leaves on the far side of a thin sheet.
    pub diffuse_transmission: ScalarInput,
    /// Its colour.
    pub diffuse_transmission_color: ColorInput,
    /// 20 / Abbe number; 0 for none.
    pub dispersion: f64,
    /// Share of the surface under a thin film whose thickness shows as colours of interference, in [0, 1].
    pub iridescence: ScalarInput,
    /// Index of refraction of the film, ≥ 1.
    pub iridescence_ior: f64,
    /// Thickness of the film in nanometres, ≥ 0; 0 is no film.
    pub iridescence_thickness: ScalarInput,
}

impl Default for Principled {
    /// The text language's default: a white dielectric of roughness 0.5 (glTF's own defaults are metallic 1, roughness 1).
    fn default() -> Principled {
        Principled {
            base_color: DVec3::ONE.into(),
            metallic: 0.0.into(),
            roughness: 0.5.into(),
            ior: 1.5,
            specular: 1.0.into(),
            specular_color: DVec3::ONE.into(),
            transmission: 0.0.into(),
            thick: false,
            clearcoat: 0.0.into(),
            clearcoat_roughness: 0.0.into(),
            clearcoat_normal: None,
            sheen_color: DVec3::ZERO.into(),
            sheen_roughness: 0.0.into(),
            anisotropy: 0.0.into(),
            anisotropy_rotation: 0.0,
            anisotropy_direction: None,
            diffuse_transmission: 0.0.into(),
            diffuse_transmission_color: DVec3::ONE.into(),
            dispersion: 0.0,
            iridescence: 0.0.into(),
            iridescence_ior: 1.3,
            iridescence_thickness: 400.0.into(),
        }
    }
}

/// POV-Ray's `reflection { … }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishReflection {
    /// Reflectance at normal incidence.
    pub min: DVec3,
    /// Reflectance at grazing incidence.
    pub max: DVec3,
    /// Exponent of (1 − cos θ)^falloff between the two.
    pub falloff: f64,
    /// Fresnel with the interior's ior decides between min and max instead.
    pub fresnel: bool,
    /// Tinted by the pigment by this share.
    pub metallic: f64,
}

/// POV-Ray's pigment and finish, as written; `compile` maps them onto lobes.
#[derive(Clone, Debug, PartialEq)]
pub struct Finish {
    /// Pigment rgb.
    pub color: ColorInput,
    /// Share of light that passes straight through, tinted by the pigment.
    pub filter: f64,
    /// Share of light that passes straight through, untinted.
    pub transmit: f64,
    /// Diffuse amount of the lit side.
    pub diffuse: f64,
    /// Diffuse amount that leaves on the other side.
    pub diffuse_back: f64,
    /// Exponent of the cosine of the diffuse term.
    pub brilliance: f64,
    /// Amount of the Phong highlight.
    pub phong: f64,
    /// Exponent of the Phong highlight.
    pub phong_size: f64,
    /// Amount of the Blinn highlight.
    pub specular: f64,
    /// Roughness of the Blinn highlight (exponent 1/roughness), POV-Ray's scale.
    pub roughness: f64,
    /// Share by which highlights take the pigment's colour.
    pub metallic: f64,
    /// Mirror reflection.
    pub reflection: Option<FinishReflection>,
    /// Whether what is transmitted is reduced by what is reflected.
    pub conserve_energy: bool,
    /// `interior { ior }`: bends what passes.
    pub ior: Option<f64>,
    /// 20 / Abbe number; 0 for none.
    pub dispersion: f64,
}

impl Default for Finish {
    /// POV-Ray 3.7's defaults: black pigment, diffuse 0.6, no highlight.
    fn default() -> Finish {
        Finish {
            color: DVec3::ZERO.into(),
            filter: 0.0,
            transmit: 0.0,
            diffuse: 0.6,
            diffuse_back: 0.0,
            brilliance: 1.0,
            phong: 0.0,
            phong_size: 40.0,
            specular: 0.0,
            roughness: 0.05,
            metallic: 0.0,
            reflection: None,
            conserve_energy: false,
            ior: None,
            dispersion: 0.0,
        }
    }
}

/// How a surface scatters.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceModel {
    /// Lambert, or Oren–Nayar if `sigma` (radians) is not 0.
    Diffuse {
        /// Albedo.
        color: ColorInput,
        /// Oren–Nayar σ in radians.
        sigma: ScalarInput,
    },
    /// A perfect mirror.
    Specular {
        /// Reflectance.
        color: ColorInput,
    },
    /// A dielectric solid, smooth if `roughness` is 0. Reflection is white, each crossing is tinted by `color`.
    Glass {
        /// Tint of what is transmitted, once per crossing.
        color: ColorInput,
        /// Index of refraction, > 0.
        ior: f64,
        /// Perceptual roughness.
        roughness: ScalarInput,
        /// Abbe number, if it disperses.
        abbe: Option<f64>,
    },
    /// GGX dielectric coat over a diffuse base, or a GGX conductor if `metal`.
    Glossy {
        /// Base colour or tint.
        color: ColorInput,
        /// Perceptual roughness.
        roughness: ScalarInput,
        /// Index of refraction of the coat.
        ior: f64,
        /// A conductor tinted `color`.
        metal: bool,
    },
    /// A thin sheet that scatters to both sides.
    Translucent {
        /// Albedo.
        color: ColorInput,
        /// Share of it that leaves on the far side, [0, 1].
        transmit: ScalarInput,
    },
    /// The glTF set.
    Principled(Box<Principled>),
    /// POV-Ray's pigment and finish.
    Finish(Box<Finish>),
    /// (1 − weight)·a + weight·b.
    Mix {
        /// First material (its surface model only).
        a: super::MaterialId,
        /// Second material.
        b: super::MaterialId,
        /// Share of the second, [0, 1].
        weight: ScalarInput,
    },
    /// Emits and absorbs, scatters nothing (lamps, glTF unlit, `diffuse 0`).
    Black,
}

/// A material: how it scatters, what it emits, how much of it is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name for messages, or empty.
    pub name: String,
    /// Scattering.
    pub surface: SurfaceModel,
    /// Emitted radiance, linear RGB.
    pub emission: ColorInput,
    /// Sides that emit.
    pub emission_sides: EmissionSides,
    /// Seen by the camera and in mirrors and clear glass only: all other light passes as if nothing were there, and none
    /// comes from it (glTF's unlit surfaces, which show a colour whatever the light).
    pub unlit: bool,
    /// Coverage.
    pub opacity: Opacity,
    /// Perturbs the shading normal.
    pub normal_map: Option<NormalMap>,
    /// Perturbs the shading normal, after the normal map.
    pub bump_map: Option<BumpMap>,
    /// What fills a solid of this material.
    pub interior: Medium,
    /// Where it was written.
    pub place: Place,
}

impl Material {
    /// A material that only scatters.
    pub fn new(surface: SurfaceModel) -> Material {
        Material {
            name: String::new(),
            surface,
            emission: DVec3::ZERO.into(),
            emission_sides: EmissionSides::ByShape,
            unlit: false,
            opacity: Opacity::default(),
            normal_map: None,
            bump_map: None,
            interior: Medium::default(),
            place: Place::None,
        }
    }

    /// A Lambertian surface of this albedo.
    pub fn diffuse(albedo: DVec3) -> Material {
        Material::new(SurfaceModel::Diffuse {
            color: albedo.into(),
            sigma: 0.0.into(),
        })
    }

    /// The same material with emitted radiance added.
    pub fn emitting(mut self, radiance: DVec3) -> Material {
        self.emission = radiance.into();
        self
    }

    /// Calls `f` for every texture this material refers to (not those of the parts of a mix).
    pub fn each_texture(&self, f: &mut dyn FnMut(super::TextureId)) {
        let mut all = |colors: &[&ColorInput], scalars: &[&ScalarInput]| {
            colors.iter().filter_map(|c| c.texture).for_each(&mut *f);
            scalars.iter().filter_map(|s| s.texture.map(|t| t.0)).for_each(&mut *f);
        };
        all(&[&self.emission], &[&self.opacity.alpha]);
        match &self.surface {
            SurfaceModel::Black => {}
            SurfaceModel::Specular { color } => all(&[color], &[]),
            SurfaceModel::Finish(finish) => all(&[&finish.color], &[]),
            SurfaceModel::Mix { weight, .. } => all(&[], &[weight]),
            SurfaceModel::Diffuse { color, sigma: s }
            | SurfaceModel::Glass {
                color, roughness: s, ..
            }
            | SurfaceModel::Glossy {
                color, roughness: s, ..
            }
            | SurfaceModel::Translucent { color, transmit: s } => all(&[color], &[s]),
            SurfaceModel::Principled(p) => all(
                &[
                    &p.base_color,
                    &p.specular_color,
                    &p.sheen_color,
                    &p.diffuse_transmission_color,
                ],
                &[
                    &p.metallic,
                    &p.roughness,
                    &p.specular,
                    &p.transmission,
                    &p.clearcoat,
                    &p.clearcoat_roughness,
                    &p.sheen_roughness,
                    &p.anisotropy,
                    &p.diffuse_transmission,
                    &p.iridescence,
                    &p.iridescence_thickness,
                ],
            ),
        }
        let (coat, direction) = match &self.surface {
            SurfaceModel::Principled(p) => (p.clearcoat_normal, p.anisotropy_direction),
            _ => (None, None),
        };
        direction.into_iter().for_each(&mut *f);
        [self.normal_map, coat].into_iter().flatten().for_each(|n| f(n.texture));
        self.bump_map.into_iter().for_each(|b| f(b.texture));
    }
}
