//! Colours, numbers and normal maps to inputs of the IR: images become textures, each once.

use crate::diag::Span;
use crate::lang::desc::{ImageDesc, NormalMapDesc, NumberDesc, Pigment};
use crate::lang::eval::Interp;
use crate::scene::{
    Channel, ColorInput, Encoding, Image, ImageId, ImageSource, ImageTexture, MaterialId, NormalMap, Place,
    ScalarInput, Scene, Shape, TexelFilter, Texture, TextureId, Wrap,
};
use glam::{DAffine2, DAffine3, DMat2, DVec2, DVec3};

impl Interp<'_> {
    /// Tells, once a kind, that a pattern is drawn as its average colour.
    pub fn warn_pattern(&mut self, word: &'static str, at: Span) {
        self.warn_once(
            "P0412",
            at,
            format!("`{word}` is not supported yet and is drawn in its average colour"),
        );
    }

    /// The linear rgb of a pigment, patterns being told.
    pub fn pigment_color(&mut self, p: &Pigment) -> DVec3 {
        if let Some((word, at)) = p.pattern {
            self.warn_pattern(word, at);
        }
        let [r, g, b, ..] = p.color;
        self.linear(DVec3::new(r, g, b)) * self.linear(p.tint)
    }

    /// The colour of a pigment: its image where that goes by the surface's coordinates, else a linear rgb.
    pub fn pigment_input(&mut self, p: &Pigment, out: &mut Scene) -> ColorInput {
        let (Some(image), true) = (&p.image, p.uv) else {
            return self.pigment_color(p).into();
        };
        let encoding = if self.display_is_linear() {
            Encoding::Linear
        } else {
            Encoding::Srgb
        };
        ColorInput {
            factor: self.linear(p.tint),
            texture: self.image_texture(image, &p.transform, encoding, out),
        }
    }

    /// A number, which an image that holds data may vary. Of a pigment's colour the channel is taken as it is written.
    pub(super) fn number_input(&mut self, n: &NumberDesc, out: &mut Scene) -> ScalarInput {
        let Some((pigment, channel)) = &n.source else {
            return n.factor.into();
        };
        if let (Some(image), true) = (&pigment.image, pigment.uv) {
            let texture = self.image_texture(image, &pigment.transform, Encoding::Linear, out);
            return ScalarInput {
                factor: n.factor,
                texture: texture.map(|t| (t, *channel)),
                offset: n.offset,
            };
        }
        if let Some((word, at)) = pigment.pattern {
            self.warn_pattern(word, at);
        }
        let [r, g, b, filter, transmit] = pigment.color;
        let value = match channel {
            Channel::R => r,
            Channel::G => g,
            Channel::B => b,
            Channel::A => 1.0 - filter - transmit,
        };
        (n.offset + n.factor * value.clamp(0.0, 1.0)).into()
    }

    /// Tells, once, that an image has nowhere to lie: of shapes only spheres have coordinates of their own.
    pub(super) fn warn_without_coordinates(&mut self, shape: &Shape, id: MaterialId, at: Span, out: &Scene) {
        let Some(material) = out
            .materials
            .get(id.index())
            .filter(|_| !matches!(shape, Shape::Sphere { .. }))
        else {
            return;
        };
        let mut shows_image = false;
        let is_image = |t: TextureId| matches!(out.textures.get(t.index()), Some(Texture::Image(_)));
        material.each_texture(&mut |t| shows_image |= is_image(t));
        if shows_image {
            let message = "this shape has no texture coordinates: images on it show one texel";
            self.warn_once("P0417", at, message);
        }
    }

    /// A normal map.
    pub(super) fn normal_map_input(&mut self, n: &NormalMapDesc, out: &mut Scene) -> Option<NormalMap> {
        let texture = self.image_texture(&n.image, &DAffine3::IDENTITY, Encoding::Linear, out)?;
        Some(NormalMap {
            texture,
            scale: n.scale,
        })
    }

    /// The texture of an image, moved over the surface's coordinates by its own transform and then by `moved`; a missing
    /// file is an error.
    pub(super) fn image_texture(
        &mut self,
        image: &ImageDesc,
        moved: &DAffine3,
        encoding: Encoding,
        out: &mut Scene,
    ) -> Option<TextureId> {
        let Some(path) = &image.path else {
            self.error("P0501", image.span, format!("cannot find \"{}\"", image.name));
            return None;
        };
        let Some(uv_transform) = uv_transform(&(*moved * image.transform)) else {
            let message = "transforms leave the range of numbers: the image vanishes or is infinite";
            self.error("P0310", image.span, message);
            return None;
        };
        let source = ImageSource::File(path.clone());
        let known = out.images.iter().position(|i| i.source == source);
        let id = match known {
            Some(i) => ImageId(i as u32),
            None => out.add_image(Image {
                name: image.name.clone(),
                source,
                fallback: None,
                place: Place::Text(image.span),
            }),
        };
        let wrap = if image.once { Wrap::Clamp } else { Wrap::Repeat };
        let texture = Texture::Image(ImageTexture {
            image: id,
            uv_set: 0,
            uv_transform,
            wrap_u: wrap,
            wrap_v: wrap,
            filter: if image.smooth {
                TexelFilter::Bilinear
            } else {
                TexelFilter::Nearest
            },
            encoding,
        });
        let known = out.textures.iter().position(|t| *t == texture);
        Some(known.map_or_else(|| out.add_texture(texture), |i| TextureId(i as u32)))
    }
}

/// The map of texture coordinates (v downwards) under which an image looks moved by `t`, which moves points (u, v, 0) with
/// v upwards, as POV-Ray does. `None` if it cannot be undone.
fn uv_transform(t: &DAffine3) -> Option<DAffine2> {
    if *t == DAffine3::IDENTITY {
        return Some(DAffine2::IDENTITY);
    }
    if !crate::lang::transform::is_invertible(t) {
        return None;
    }
    let back = t.inverse();
    let (x, y, at) = (back.matrix3.x_axis, back.matrix3.y_axis, back.translation);
    let map = DAffine2 {
        matrix2: DMat2::from_cols(DVec2::new(x.x, 0.0 - x.y), DVec2::new(0.0 - y.x, y.y)),
        translation: DVec2::new(at.x + y.x, 1.0 - at.y - y.y),
    };
    map.is_finite().then_some(map)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of the surface shows what the unmoved image shows where the transform takes it from.
    #[test]
    fn an_image_moves_as_its_transform_says() {
        let turn = DAffine3::from_rotation_z(0.3);
        let t = DAffine3::from_translation(DVec3::new(0.2, -0.1, 0.0)) * turn * DAffine3::from_scale(DVec3::splat(0.5));
        let map = uv_transform(&t).expect("the transform can be undone");
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.25, 0.75)] {
            // Where the image has (x, y), v upwards, it is seen at t · (x, y, 0).
            let seen = t.transform_point3(DVec3::new(x, y, 0.0));
            let found = map.transform_point2(DVec2::new(seen.x, 1.0 - seen.y));
            let wanted = DVec2::new(x, 1.0 - y);
            assert!((found - wanted).length() < 1e-14, "{found} instead of {wanted}");
        }
        assert_eq!(uv_transform(&DAffine3::IDENTITY), Some(DAffine2::IDENTITY));
        assert_eq!(uv_transform(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))), None);
    }
}
