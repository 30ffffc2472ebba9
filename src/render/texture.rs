//! Textures: functions of the surface point that give linear RGBA.
//!
//! Images keep the precision they came with (8 bits stay 8 bits); sRGB is decoded by a table before interpolation.
//! Any coordinate is safe: infinite and NaN ones read the first texel.

use super::surface::Attributes;
use crate::math::color::luminance;
use crate::math::portable::pow;
use crate::pictures::Texels;
use glam::{Affine2, Vec2, Vec3, Vec4};
use std::sync::LazyLock;

/// A decoded image of at least one texel, as its file stores it: float texels are linear, integers may be sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageData {
    width: u32,
    height: u32,
    texels: Texels,
}

/// sRGB-encoded value in [0, 1] to linear, IEC 61966-2-1.
fn linear(v: f32) -> f32 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        pow((v + 0.055) / 1.055, 2.4)
    }
}

/// [`linear`] of all 8-bit values.
static LINEAR_FROM_SRGB8: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| linear(i as f32 / 255.0)));

impl ImageData {
    /// An image of `width`·`height` texels; `None` if there are none or not as many.
    pub fn new(width: u32, height: u32, texels: Texels) -> Option<ImageData> {
        let count = (width as usize).checked_mul(height as usize)?;
        (count > 0 && texels.len() == count).then_some(ImageData { width, height, texels })
    }

    /// Memory that the texels take.
    pub fn bytes(&self) -> u64 {
        self.texels.len() as u64 * self.texels.bytes_per_texel() as u64
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// One texel, linear; the nearest one if the place is outside. `srgb` decodes the colour of integer texels.
    pub fn texel(&self, x: u32, y: u32, srgb: bool) -> Vec4 {
        let i = y.min(self.height - 1) as usize * self.width as usize + x.min(self.width - 1) as usize;
        let alpha = |v: u8| f32::from(v) / 255.0;
        let byte = |v: u8| {
            if srgb {
                LINEAR_FROM_SRGB8[usize::from(v)]
            } else {
                alpha(v)
            }
        };
        let word_alpha = |v: u16| f32::from(v) / 65535.0;
        let word = |v: u16| if srgb { linear(word_alpha(v)) } else { word_alpha(v) };
        match &self.texels {
            Texels::Gray8(v) => Vec3::splat(byte(v[i])).extend(1.0),
            Texels::Rgb8(v) => Vec3::from(v[i].map(byte)).extend(1.0),
            Texels::Rgba8(v) => {
                let [r, g, b, a] = v[i];
                Vec4::new(byte(r), byte(g), byte(b), alpha(a))
            }
            Texels::Gray16(v) => Vec3::splat(word(v[i])).extend(1.0),
            Texels::Rgb16(v) => Vec3::from(v[i].map(word)).extend(1.0),
            Texels::Rgba16(v) => {
                let [r, g, b, a] = v[i];
                Vec4::new(word(r), word(g), word(b), word_alpha(a))
            }
            Texels::GrayF32(v) => Vec3::splat(v[i]).extend(1.0),
            Texels::RgbF32(v) => Vec3::from(v[i]).extend(1.0),
            Texels::RgbaF32(v) => Vec4::from(v[i]),
        }
    }
}

/// What happens outside [0, 1].
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

impl Wrap {
    /// A coordinate in [0, 1] that reads the same texels; 0 for NaN and infinities.
    fn reduce(self, x: f32) -> f32 {
        if !x.is_finite() {
            return 0.0;
        }
        match self {
            Wrap::Repeat => x - x.floor(),
            Wrap::Mirror => {
                let m = x - 2.0 * (x * 0.5).floor();
                if m > 1.0 { 2.0 - m } else { m }
            }
            Wrap::Clamp => x.clamp(0.0, 1.0),
        }
    }

    /// The texel at index `i` ∈ [−1, n] of `n`: a mirrored image repeats its edge texel, as a clamped one does.
    fn index(self, i: i64, n: u32) -> u32 {
        let n = i64::from(n);
        let j = match self {
            Wrap::Repeat => i.rem_euclid(n),
            Wrap::Mirror | Wrap::Clamp => i.clamp(0, n - 1),
        };
        j as u32
    }
}

/// An image on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// Index into [`Textures::images`].
    pub image: u32,
    /// Set of texture coordinates, 0..4.
    pub uv_set: u32,
    /// Applied first; after it (0, 0) is the top left corner of the image and v grows downwards.
    pub uv_transform: Affine2,
    /// Along u.
    pub wrap_u: Wrap,
    /// Along v.
    pub wrap_v: Wrap,
    /// Linear between texel centres, else the texel that holds the point.
    pub bilinear: bool,
    /// Colours of integer images are sRGB-encoded.
    pub srgb: bool,
}

impl ImageTexture {
    /// Linear RGBA at texture coordinates of the image (after the transform).
    fn look_up(&self, image: &ImageData, uv: Vec2) -> Vec4 {
        let (w, h) = (image.width, image.height);
        let x = self.wrap_u.reduce(uv.x) * w as f32;
        let y = self.wrap_v.reduce(uv.y) * h as f32;
        if !self.bilinear {
            return image.texel(x as u32, y as u32, self.srgb);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (fx, fy) = (x.floor(), y.floor());
        let (wx, wy) = (x - fx, y - fy);
        let (i, j) = (fx as i64, fy as i64);
        let columns = [self.wrap_u.index(i, w), self.wrap_u.index(i + 1, w)];
        let row = |j: i64| {
            let y = self.wrap_v.index(j, h);
            let (a, b) = (
                image.texel(columns[0], y, self.srgb),
                image.texel(columns[1], y, self.srgb),
            );
            a + (b - a) * wx
        };
        let (top, bottom) = (row(j), row(j + 1));
        top + (bottom - top) * wy
    }
}

/// How an image rises at a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// Luminance per texel towards the right.
    pub right: f32,
    /// Luminance per texel towards the top.
    pub up: f32,
    /// World direction of the image's rows, not normalised; zero without a tangent frame.
    pub to_right: Vec3,
    /// World direction of the image's columns, upwards, not normalised.
    pub to_top: Vec3,
}

/// A function of the surface point.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Vec4),
    /// An image.
    Image(ImageTexture),
    /// The interpolated vertex colour.
    VertexColor,
    /// The product of two textures that stand before this one.
    Product(u32, u32),
}

/// All textures of a scene and the images they read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textures {
    /// Textures; a product refers to earlier ones only.
    pub nodes: Vec<Texture>,
    /// Images.
    pub images: Vec<ImageData>,
}

impl Textures {
    /// How an image texture rises at a surface point, by differences over one texel; `None` for other textures, and where
    /// the transform of the coordinates has no inverse.
    pub fn slope(&self, id: u32, attrs: &Attributes) -> Option<Slope> {
        let Some(Texture::Image(t)) = self.nodes.get(id as usize) else {
            return None;
        };
        let image = self.images.get(t.image as usize)?;
        let to_image = t.uv_transform.matrix2;
        if to_image.determinant() == 0.0 {
            return None;
        }
        let uv = attrs.uv.get(t.uv_set as usize).copied().unwrap_or(attrs.uv[0]);
        let uv = t.uv_transform.transform_point2(uv);
        let height = |uv: Vec2| luminance(t.look_up(image, uv).truncate());
        let rise = |step: Vec2| height(uv + step) - height(uv - step);
        // Columns of the inverse: where the surface's coordinates go for a step in the image. Both v grow downwards.
        let from_image = to_image.inverse();
        let world = |step: Vec2| attrs.tangent * step.x - attrs.bitangent * step.y;
        Some(Slope {
            right: rise(Vec2::new(0.5 / image.width as f32, 0.0)),
            up: rise(Vec2::new(0.0, -0.5 / image.height as f32)),
            to_right: world(from_image.x_axis),
            to_top: -world(from_image.y_axis),
        })
    }

    /// Linear RGBA of a texture at a surface point; white for a reference that leads nowhere.
    pub fn eval(&self, id: u32, attrs: &Attributes) -> Vec4 {
        match self.nodes.get(id as usize) {
            None => Vec4::ONE,
            Some(Texture::Constant(c)) => *c,
            Some(Texture::VertexColor) => attrs.color,
            Some(&Texture::Product(a, b)) if a < id && b < id => self.eval(a, attrs) * self.eval(b, attrs),
            Some(Texture::Product(..)) => Vec4::ONE,
            Some(Texture::Image(t)) => {
                let uv = attrs.uv.get(t.uv_set as usize).copied().unwrap_or(attrs.uv[0]);
                match self.images.get(t.image as usize) {
                    Some(image) => t.look_up(image, t.uv_transform.transform_point2(uv)),
                    None => Vec4::ONE,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(wrap: Wrap, bilinear: bool, srgb: bool) -> ImageTexture {
        ImageTexture {
            image: 0,
            uv_set: 0,
            uv_transform: Affine2::IDENTITY,
            wrap_u: wrap,
            wrap_v: wrap,
            bilinear,
            srgb,
        }
    }

    fn textures(texture: ImageTexture, width: u32, height: u32, texels: Texels) -> Textures {
        let images: Vec<ImageData> = ImageData::new(width, height, texels).into_iter().collect();
        assert_eq!(images.len(), 1);
        Textures {
            nodes: vec![Texture::Image(texture)],
            images,
        }
    }

    fn red(t: &Textures, u: f32, v: f32) -> f32 {
        let attrs = Attributes {
            uv: [Vec2::new(u, v); 4],
            ..Attributes::default()
        };
        t.eval(0, &attrs).x
    }

    /// Row of 4 texels 0, 85, 170, 255, i.e. k/3; centres at 1/8, 3/8, 5/8, 7/8.
    const ROW: [u8; 4] = [0, 85, 170, 255];

    #[test]
    fn texels_are_interpolated_between_their_centres() {
        let t = textures(texture(Wrap::Clamp, true, false), 4, 1, Texels::Gray8(ROW.to_vec()));
        for (u, want) in [
            (0.0, 0.0),
            (0.125, 0.0),
            (0.25, 1.0 / 6.0),
            (0.375, 1.0 / 3.0),
            (0.5, 0.5),
            (0.875, 1.0),
            (1.0, 1.0),
            (9.0, 1.0),
            (-9.0, 0.0),
        ] {
            assert!((red(&t, u, 0.5) - want).abs() < 1e-6, "{u}: {}", red(&t, u, 0.5));
        }
    }

    #[test]
    fn wrapping_continues_the_image() {
        let t = textures(texture(Wrap::Repeat, true, false), 4, 1, Texels::Gray8(ROW.to_vec()));
        for (u, want) in [
            (0.0, 0.5),
            (1.0, 0.5),
            (-1.0, 0.5),
            (1.375, 1.0 / 3.0),
            (-0.125, 1.0),
            (1e9, 0.5),
        ] {
            assert!((red(&t, u, 0.5) - want).abs() < 1e-6, "repeat {u}: {}", red(&t, u, 0.5));
        }
        let t = textures(texture(Wrap::Mirror, true, false), 4, 1, Texels::Gray8(ROW.to_vec()));
        for (u, want) in [
            (0.0, 0.0),
            (1.0, 1.0),
            (-0.375, 1.0 / 3.0),
            (1.625, 1.0 / 3.0),
            (2.375, 1.0 / 3.0),
        ] {
            assert!((red(&t, u, 0.5) - want).abs() < 1e-6, "mirror {u}: {}", red(&t, u, 0.5));
        }
        let t = textures(texture(Wrap::Repeat, false, false), 4, 1, Texels::Gray8(ROW.to_vec()));
        for (u, want) in [
            (0.0, 0.0),
            (0.26, 1.0 / 3.0),
            (0.999_999_9, 1.0),
            (-0.01, 1.0),
            (1.0, 0.0),
        ] {
            assert!(
                (red(&t, u, 0.5) - want).abs() < 1e-6,
                "nearest {u}: {}",
                red(&t, u, 0.5)
            );
        }
    }

    #[test]
    fn any_coordinate_reads_a_texel() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for bilinear in [false, true] {
                let t = textures(texture(wrap, bilinear, false), 4, 1, Texels::Gray8(ROW.to_vec()));
                for u in [
                    f32::NAN,
                    f32::INFINITY,
                    -f32::INFINITY,
                    f32::MAX,
                    f32::MIN,
                    -1e-30,
                    1e-45,
                ] {
                    let v = red(&t, u, u);
                    assert!((0.0..=1.0).contains(&v), "{wrap:?} {u}: {v}");
                }
            }
        }
    }

    /// Halfway between black and white is 0.5 in linear light, not the 0.214 of the decoded mean.
    #[test]
    fn interpolation_comes_after_decoding() {
        let t = textures(texture(Wrap::Clamp, true, true), 2, 1, Texels::Gray8(vec![0, 255]));
        assert!((red(&t, 0.5, 0.5) - 0.5).abs() < 1e-6);
        for i in 0..=255u8 {
            let want = crate::math::color::linear_from_srgb(f64::from(i) / 255.0);
            let t = textures(
                texture(Wrap::Clamp, false, true),
                1,
                1,
                Texels::Rgba8(vec![[i, 0, 0, i]]),
            );
            assert!((f64::from(red(&t, 0.0, 0.0)) - want).abs() < 1e-6, "{i}");
            let alpha = t.eval(0, &Attributes::default()).w;
            assert_eq!(alpha, f32::from(i) / 255.0); // alpha is never encoded
        }
    }

    #[test]
    fn v_grows_downwards_and_the_transform_comes_first() {
        let mut tex = texture(Wrap::Repeat, false, false);
        let t = textures(tex.clone(), 1, 2, Texels::Gray16(vec![0, 65535]));
        assert_eq!((red(&t, 0.5, 0.25), red(&t, 0.5, 0.75)), (0.0, 1.0));
        tex.uv_transform = Affine2::from_translation(Vec2::new(0.0, 0.5));
        let t = textures(tex, 1, 2, Texels::Gray16(vec![0, 65535]));
        assert_eq!((red(&t, 0.5, 0.25), red(&t, 0.5, 0.75)), (1.0, 0.0));
    }

    #[test]
    fn products_multiply_and_never_loop() {
        let half = Texture::Constant(Vec4::splat(0.5));
        let t = Textures {
            nodes: vec![
                half,
                Texture::VertexColor,
                Texture::Product(0, 1),
                Texture::Product(3, 2),
            ],
            images: Vec::new(),
        };
        let attrs = Attributes {
            color: Vec4::new(0.2, 0.4, 0.6, 1.0),
            ..Attributes::default()
        };
        assert_eq!(t.eval(2, &attrs), Vec4::new(0.1, 0.2, 0.3, 0.5));
        assert_eq!(t.eval(3, &attrs), Vec4::ONE);
        assert_eq!(t.eval(99, &attrs), Vec4::ONE);
    }

    #[test]
    fn images_of_the_wrong_size_are_refused() {
        assert!(ImageData::new(2, 2, Texels::Gray8(vec![0; 3])).is_none());
        assert!(ImageData::new(0, 2, Texels::Gray8(Vec::new())).is_none());
        assert!(ImageData::new(u32::MAX, u32::MAX, Texels::Gray8(Vec::new())).is_none());
    }
}
