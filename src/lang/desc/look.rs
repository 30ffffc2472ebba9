//! How surfaces and insides are described: POV-Ray's textures, and what all looks have in common.

use super::{MediaDesc, SurfaceDesc};
use crate::diag::Span;
use crate::scene::{Channel, FinishReflection};
use glam::{DAffine3, DVec3};
use std::path::PathBuf;
use std::rc::Rc;

/// Texture layers from the bottom up.
pub type Layers = Rc<[Rc<Layer>]>;

/// How a surface and its inside look.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// POV-Ray's texture, if there is one.
    pub layers: Option<Layers>,
    /// One of the language's own materials, which then counts instead.
    pub surface: Option<Rc<SurfaceDesc>>,
    /// What fills the inside.
    pub interior: Option<Rc<InteriorDesc>>,
    /// `hollow`: the inside of a texture's solid shows its media.
    pub hollow: bool,
}

impl Look {
    /// Whether it says nothing about the surface.
    pub fn is_bare(&self) -> bool {
        self.layers.is_none() && self.surface.is_none()
    }
}

/// One layer of a texture.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Colour.
    pub pigment: Rc<Pigment>,
    /// Light response.
    pub finish: Rc<FinishDesc>,
    /// How the normal is perturbed, if it is.
    pub normal: Option<Rc<NormalDesc>>,
    /// Where it was written, unless it is the default.
    pub span: Option<Span>,
}

/// `normal { … }`.
#[derive(Clone, Debug)]
pub struct NormalDesc {
    /// The image of heights, if it is a `bump_map`; other patterns are not drawn yet.
    pub bump: Option<Rc<ImageDesc>>,
    /// `bump_size`: height of white over black, in texels.
    pub size: f64,
    /// Whether it goes by the surface's own coordinates (`uv_mapping`).
    pub uv: bool,
    /// Where it was written.
    pub span: Span,
}

/// A colour, or the average colour of a pattern.
#[derive(Clone, Debug)]
pub struct Pigment {
    /// Red, green, blue, filter, transmit, in the scene's working gamma.
    pub color: [f64; 5],
    /// The pattern it stands for, with its place.
    pub pattern: Option<(&'static str, Span)>,
    /// The image it shows, if it is an image map.
    pub image: Option<Rc<ImageDesc>>,
    /// Whether it goes by the surface's own coordinates (`uv_mapping`).
    pub uv: bool,
    /// Moves what it shows; of images by the surface's own coordinates only.
    pub transform: DAffine3,
    /// Multiplied to it, in the scene's working gamma.
    pub tint: DVec3,
}

impl Pigment {
    /// A plain colour.
    pub fn plain(color: [f64; 5]) -> Pigment {
        Pigment {
            color,
            pattern: None,
            image: None,
            uv: false,
            transform: DAffine3::IDENTITY,
            tint: DVec3::ONE,
        }
    }

    /// An image on the surface's own coordinates.
    pub fn on_surface(image: Rc<ImageDesc>) -> Pigment {
        Pigment {
            image: Some(image),
            uv: true,
            ..Pigment::plain([1.0, 1.0, 1.0, 0.0, 0.0])
        }
    }
}

/// POV-Ray's finish as written.
#[derive(Clone, Debug)]
pub struct FinishDesc {
    /// `ambient`.
    pub ambient: DVec3,
    /// `emission`.
    pub emission: DVec3,
    /// `diffuse`, front and back.
    pub diffuse: [f64; 2],
    /// `brilliance`.
    pub brilliance: f64,
    /// `phong`.
    pub phong: f64,
    /// `phong_size`.
    pub phong_size: f64,
    /// `specular`.
    pub specular: f64,
    /// `roughness`.
    pub roughness: f64,
    /// `metallic`.
    pub metallic: f64,
    /// `reflection`.
    pub reflection: Option<FinishReflection>,
    /// `conserve_energy`.
    pub conserve_energy: bool,
}

impl Default for FinishDesc {
    fn default() -> FinishDesc {
        FinishDesc {
            ambient: DVec3::splat(0.1),
            emission: DVec3::ZERO,
            diffuse: [0.6, 0.0],
            brilliance: 1.0,
            phong: 0.0,
            phong_size: 40.0,
            specular: 0.0,
            roughness: 0.05,
            metallic: 0.0,
            reflection: None,
            conserve_energy: false,
        }
    }
}

/// POV-Ray's interior as written.
#[derive(Clone, Debug, Default)]
pub struct InteriorDesc {
    /// `ior`, if written.
    pub ior: Option<f64>,
    /// `fade_distance`, if written.
    pub fade_distance: Option<f64>,
    /// `fade_power`, if written.
    pub fade_power: Option<f64>,
    /// `fade_color`.
    pub fade_color: DVec3,
    /// Absorption per unit length.
    pub absorption: DVec3,
    /// `dispersion`: index of violet over that of red, with its place.
    pub dispersion: Option<(f64, Span)>,
    /// Every `media`.
    pub media: Vec<Rc<MediaDesc>>,
}

/// `image_map { … }`.
#[derive(Clone, Debug)]
pub struct ImageDesc {
    /// The file as written.
    pub name: String,
    /// The file as found; a missing one is an error only where it is drawn.
    pub path: Option<PathBuf>,
    /// Whether it ends at its edges.
    pub once: bool,
    /// Whether values between texels are interpolated.
    pub smooth: bool,
    /// `channel`: which one is taken where a number is wanted.
    pub channel: Option<Channel>,
    /// Moves it over the surface's own coordinates.
    pub transform: DAffine3,
    /// Where it is named.
    pub span: Span,
}
