//! Inputs of materials: numbers and colours that may come from textures.

use super::super::bsdf::unit;
use super::super::surface::Attributes;
use super::super::texture::Textures;
use super::Shading;
use glam::{Vec3, Vec4};

/// `factor · texture.rgb`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant factor, linear RGB.
    pub factor: Vec3,
    /// Index of a texture.
    pub texture: Option<u32>,
}

impl ColorInput {
    /// Black everywhere.
    pub const BLACK: ColorInput = ColorInput::constant(Vec3::ZERO);
    /// White everywhere.
    pub const WHITE: ColorInput = ColorInput::constant(Vec3::ONE);

    /// The same colour everywhere.
    pub const fn constant(factor: Vec3) -> ColorInput {
        ColorInput { factor, texture: None }
    }

    /// The colour at a point.
    pub fn eval(&self, textures: &Textures, attrs: &Attributes) -> Vec3 {
        match self.texture {
            None => self.factor,
            Some(id) => self.factor * textures.eval(id, attrs).truncate(),
        }
    }

    /// Whether it can be anything but black.
    pub fn is_black(&self) -> bool {
        self.factor == Vec3::ZERO
    }
}

/// `offset + factor · texture.channel`, channel 0..4 for R, G, B, A; without a texture `offset + factor`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Factor of the texture.
    pub factor: f32,
    /// Index of a texture, and the channel taken from it.
    pub texture: Option<(u32, u8)>,
    /// Added to the product.
    pub offset: f32,
}

impl ScalarInput {
    /// The same number everywhere.
    pub const fn constant(factor: f32) -> ScalarInput {
        ScalarInput {
            factor,
            texture: None,
            offset: 0.0,
        }
    }

    /// Whether it is 0 or less everywhere, texels being 0 or more.
    pub fn is_nothing(&self) -> bool {
        match self.texture {
            None => self.offset + self.factor <= 0.0,
            Some(_) => self.offset.max(self.offset + self.factor) <= 0.0,
        }
    }

    /// The number at a point.
    pub fn eval(&self, textures: &Textures, attrs: &Attributes) -> f32 {
        match self.texture {
            None => self.offset + self.factor,
            Some((id, channel)) => {
                let v: Vec4 = textures.eval(id, attrs);
                self.offset + self.factor * v.to_array().get(usize::from(channel)).copied().unwrap_or(1.0)
            }
        }
    }

    /// The number at a point, brought into [0, 1]; NaN is 0.
    pub(super) fn unit(&self, cx: &Shading<'_>) -> f32 {
        unit(self.eval(cx.textures, cx.attrs))
    }
}
