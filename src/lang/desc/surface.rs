//! The language's own materials as they are written.

use super::{ImageDesc, Look, NormalDesc, Pigment};
use crate::diag::Span;
use crate::scene::{Channel, Medium, OpacityMode};
use std::rc::Rc;

/// One of the language's own materials.
#[derive(Clone, Debug)]
pub struct SurfaceDesc {
    /// Which one.
    pub model: ModelSurface,
    /// What is said beside it.
    pub beside: BesideDesc,
    /// How deep mixes are nested in it.
    pub depth: u32,
    /// Where it was written.
    pub span: Span,
}

/// What may be said of every material.
#[derive(Clone, Debug, Default)]
pub struct BesideDesc {
    /// `emission`, in the scene's working gamma, with its place.
    pub emission: Option<(Rc<Pigment>, Span)>,
    /// `normal`: a relief.
    pub normal: Option<Rc<NormalDesc>>,
    /// `normal_map`.
    pub normal_map: Option<NormalMapDesc>,
    /// `opacity`, with its place.
    pub opacity: Option<(NumberDesc, Span)>,
    /// `alpha_mode`, with its place.
    pub alpha_mode: Option<(OpacityMode, Span)>,
}

impl BesideDesc {
    /// What is said later counts.
    pub fn take_over(&mut self, later: BesideDesc) {
        fn over<T>(slot: &mut Option<T>, later: Option<T>) {
            if later.is_some() {
                *slot = later;
            }
        }
        over(&mut self.emission, later.emission);
        over(&mut self.normal, later.normal);
        over(&mut self.normal_map, later.normal_map);
        over(&mut self.opacity, later.opacity);
        over(&mut self.alpha_mode, later.alpha_mode);
    }

    /// The word and place of something that is said about a surface, not of the light that it emits.
    pub fn about_surface(&self) -> Option<(&'static str, Span)> {
        let normal = self.normal.as_ref().map(|n| ("normal", n.span));
        let map = || self.normal_map.as_ref().map(|n| ("normal_map", n.image.span));
        let opacity = || self.opacity.as_ref().map(|o| ("opacity", o.1));
        let mode = || self.alpha_mode.as_ref().map(|a| ("alpha_mode", a.1));
        normal.or_else(map).or_else(opacity).or_else(mode)
    }
}

/// A number of a surface: the same everywhere, or `offset + factor · channel` of an image.
#[derive(Clone, Debug)]
pub struct NumberDesc {
    /// What is added to the product.
    pub offset: f64,
    /// The number, or what the channel is multiplied by.
    pub factor: f64,
    /// Where the channel comes from. Its tint is not used.
    pub source: Option<(Rc<Pigment>, Channel)>,
}

impl From<f64> for NumberDesc {
    fn from(factor: f64) -> NumberDesc {
        NumberDesc {
            offset: 0.0,
            factor,
            source: None,
        }
    }
}

/// A normal map in tangent space, +y up (OpenGL).
#[derive(Clone, Debug)]
pub struct NormalMapDesc {
    /// The image, read as data.
    pub image: Rc<ImageDesc>,
    /// How much it leans normals.
    pub scale: f64,
}

/// The materials that POV-Ray lacks. Colours are in the scene's working gamma.
#[derive(Clone, Debug)]
pub enum ModelSurface {
    /// Lambert or Oren–Nayar.
    Diffuse { color: Rc<Pigment>, sigma: NumberDesc },
    /// Mirror.
    Specular { color: Rc<Pigment> },
    /// Dielectric solid.
    Glass {
        color: Rc<Pigment>,
        ior: f64,
        roughness: NumberDesc,
        abbe: Option<f64>,
        inside: Medium,
    },
    /// Coated or metallic.
    Glossy {
        color: Rc<Pigment>,
        roughness: NumberDesc,
        ior: f64,
        metal: bool,
    },
    /// Thin sheet.
    Translucent { color: Rc<Pigment>, transmit: NumberDesc },
    /// The glTF set.
    Principled(Box<PrincipledDesc>),
    /// (1 − weight)·a + weight·b.
    Mix { a: Look, b: Look, weight: NumberDesc },
    /// Only emission.
    Black,
}

/// `principled { … }`: what may vary over the surface here, the rest as in the IR.
#[derive(Clone, Debug)]
pub struct PrincipledDesc {
    /// Colours, by their place among `lower::parameters`.
    pub colors: Vec<(usize, Rc<Pigment>)>,
    /// Numbers, by their place among `lower::parameters`.
    pub numbers: Vec<(usize, NumberDesc)>,
    /// `clearcoat_normal`.
    pub clearcoat_normal: Option<NormalMapDesc>,
    /// `anisotropy_direction`: an image whose red and green are a direction.
    pub anisotropy_direction: Option<Rc<ImageDesc>>,
    /// What does not vary.
    pub plain: crate::scene::Principled,
    /// `absorption`, `scattering`, `phase`, and what the attenuation comes to.
    pub inside: Medium,
}
