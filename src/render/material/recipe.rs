//! What a recipe holds: inputs by the names of the description, textures by their index.

use super::{ColorInput, ScalarInput};
use glam::Vec3;

/// How coverage is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Always there.
    Opaque,
    /// Fully there where the value reaches the cutoff.
    Mask(ScalarInput, f32),
    /// There with this probability.
    Blend(ScalarInput),
}

/// A tangent-space normal map, +y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Index of a data texture.
    pub texture: u32,
    /// Factor on x and y.
    pub scale: f32,
}

/// A relief of an image's luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap {
    /// Index of an image texture; others have no slopes.
    pub texture: u32,
    /// Height of white over black, in texels.
    pub scale: f32,
}

/// The glTF set; see the fields of the same names in `scene`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names are glTF's
pub struct PrincipledInputs {
    pub base_color: ColorInput,
    pub metallic: ScalarInput,
    pub roughness: ScalarInput,
    /// Infinite for F0 = 1 (glTF's 0).
    pub ior: f32,
    pub specular: ScalarInput,
    pub specular_color: ColorInput,
    pub transmission: ScalarInput,
    pub thick: bool,
    pub clearcoat: ScalarInput,
    pub clearcoat_roughness: ScalarInput,
    /// The coat's own; the interpolated normal without one.
    pub clearcoat_normal: Option<NormalMap>,
    /// Whether the coat's normal may differ from that of what lies below.
    pub coat_apart: bool,
    pub sheen_color: ColorInput,
    pub sheen_roughness: ScalarInput,
    pub anisotropy: ScalarInput,
    /// Radians, counter-clockwise from the tangent.
    pub anisotropy_rotation: f32,
    /// Index of a data texture; its red and green, 2t − 1, stand for the tangent before the rotation.
    pub anisotropy_direction: Option<u32>,
    pub diffuse_transmission: ScalarInput,
    pub diffuse_transmission_color: ColorInput,
    pub iridescence: ScalarInput,
    pub iridescence_ior: f32,
    /// nm.
    pub iridescence_thickness: ScalarInput,
}

/// POV-Ray's pigment and finish, see the fields of the same names in `scene`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names are POV-Ray's
pub struct FinishInputs {
    pub color: ColorInput,
    pub filter: f32,
    pub transmit: f32,
    pub diffuse: f32,
    pub diffuse_back: f32,
    pub brilliance: f32,
    pub phong: f32,
    pub phong_size: f32,
    pub specular: f32,
    /// POV-Ray's scale: exponent 1/roughness.
    pub roughness: f32,
    pub metallic: f32,
    pub reflection_min: Vec3,
    pub reflection_max: Vec3,
    pub reflection_falloff: f32,
    pub reflection_fresnel: bool,
    pub reflection_metallic: f32,
    pub conserve_energy: bool,
    /// Bends what passes.
    pub ior: Option<f32>,
}

/// How a surface scatters.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // the fields are those of `scene`'s variants
pub enum SurfaceModel {
    /// Scatters nothing.
    Black,
    /// Lambert, or Oren–Nayar where σ (radians) is not 0.
    Diffuse { color: ColorInput, sigma: ScalarInput },
    /// A perfect mirror.
    Specular { color: ColorInput },
    /// A dielectric solid of [`Material::ior`]; roughness is perceptual.
    Glass { color: ColorInput, roughness: ScalarInput },
    /// A coat of [`Material::ior`] over a diffuse base, or a conductor.
    Glossy {
        color: ColorInput,
        roughness: ScalarInput,
        metal: bool,
    },
    /// A thin sheet.
    Translucent { color: ColorInput, transmit: ScalarInput },
    /// The glTF set.
    Principled(Box<PrincipledInputs>),
    /// POV-Ray's pigment and finish.
    Finish(Box<FinishInputs>),
    /// (1 − weight)·a + weight·b, by indices; must not lead back to itself.
    Mix { a: u32, b: u32, weight: ScalarInput },
}
