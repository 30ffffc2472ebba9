//! Textures: functions of the surface point that give linear RGBA, later inputs of materials.

use super::{ImageId, TextureId};
use glam::{DAffine2, DVec4};

/// What happens to texture coordinates outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// Every second repetition is mirrored.
    Mirror,
    /// The edge texel continues.
    Clamp,
}

/// How a texel is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TexelFilter {
    /// Linear between the four nearest texel centres.
    #[default]
    Bilinear,
    /// The texel that holds the point.
    Nearest,
}

/// What the stored numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Encoding {
    /// RGB is sRGB-encoded (colour images); alpha is linear.
    #[default]
    Srgb,
    /// Data, used as it is (normals, roughness, HDR).
    Linear,
}

/// One channel of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
}

/// An image on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// The image.
    pub image: ImageId,
    /// Which set of texture coordinates of the mesh is used.
    pub uv_set: u32,
    /// Applied to (u, v) before the look-up. After it (0, 0) is the top left corner of the image, v grows downwards.
    pub uv_transform: DAffine2,
    /// Behaviour outside [0, 1] along u.
    pub wrap_u: Wrap,
    /// Behaviour outside [0, 1] along v.
    pub wrap_v: Wrap,
    /// Interpolation; done after linearisation.
    pub filter: TexelFilter,
    /// Colour or data.
    pub encoding: Encoding,
}

/// A function of the surface point; gives linear RGBA.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(DVec4),
    /// An image.
    Image(ImageTexture),
    /// The mesh's interpolated vertex colour (linear RGBA); white where a mesh has none.
    VertexColor,
    /// The component-wise product of two textures.
    Product(TextureId, TextureId),
}
