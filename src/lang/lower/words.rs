//! Which words are valid where: the same lists drive parsing, recovery and suggestions.

use crate::lang::syntax::Word;
use std::sync::OnceLock;

/// Words that begin an object (lamps included).
pub const OBJECTS: &[Word] = &[
    Word::Sphere,
    Word::Box,
    Word::Plane,
    Word::Cylinder,
    Word::Cone,
    Word::Disc,
    Word::Torus,
    Word::Triangle,
    Word::SmoothTriangle,
    Word::Mesh,
    Word::Mesh2,
    Word::Union,
    Word::Merge,
    Word::Difference,
    Word::Intersection,
    Word::Object,
    Word::LightSource,
    Word::LightGroup,
    Word::Gltf,
    Word::Obj,
    Word::BicubicPatch,
    Word::Blob,
    Word::Cubic,
    Word::HeightField,
    Word::Isosurface,
    Word::JuliaFractal,
    Word::Lathe,
    Word::Ovus,
    Word::Parametric,
    Word::Poly,
    Word::Polygon,
    Word::Prism,
    Word::Quadric,
    Word::Quartic,
    Word::Sor,
    Word::SphereSweep,
    Word::Superellipsoid,
    Word::Text,
];

/// Words that begin something at the top level beside objects.
pub const OTHER_ITEMS: &[Word] = &[
    Word::Camera,
    Word::Background,
    Word::SkySphere,
    Word::Environment,
    Word::GlobalSettings,
    Word::Render,
    Word::Fog,
    Word::Rainbow,
    Word::Media,
];

/// Words where reading goes on after an error at the top level.
pub const ITEMS: &[Word] = &[
    Word::Sphere,
    Word::Box,
    Word::Plane,
    Word::Cylinder,
    Word::Cone,
    Word::Disc,
    Word::Torus,
    Word::Triangle,
    Word::Mesh,
    Word::Mesh2,
    Word::Union,
    Word::Merge,
    Word::Difference,
    Word::Intersection,
    Word::Object,
    Word::LightSource,
    Word::Camera,
    Word::Background,
    Word::SkySphere,
    Word::Environment,
    Word::GlobalSettings,
    Word::Render,
];

/// Words that say how an object looks or is placed.
pub const MODIFIERS: &[Word] = &[
    Word::Texture,
    Word::Pigment,
    Word::Normal,
    Word::Finish,
    Word::Material,
    Word::Interior,
    Word::Translate,
    Word::Rotate,
    Word::Scale,
    Word::Matrix,
    Word::Transform,
    Word::NoShadow,
    Word::NoImage,
    Word::NoReflection,
    Word::Hollow,
    Word::Inverse,
    Word::Open,
    Word::BoundedBy,
    Word::ClippedBy,
    Word::Photons,
    Word::Sturm,
    Word::Hierarchy,
    Word::DoubleIlluminate,
    Word::UvMapping,
    Word::InteriorTexture,
    Word::Radiosity,
    Word::CutawayTextures,
    Word::SplitUnion,
    Word::NoRadiosity,
];

/// Spellings of the words that begin an item.
pub fn item_texts() -> &'static [&'static str] {
    static TEXTS: OnceLock<Vec<&'static str>> = OnceLock::new();
    TEXTS.get_or_init(|| OBJECTS.iter().chain(OTHER_ITEMS).map(|w| w.text()).collect())
}

/// Spellings of words.
pub fn texts(words: &[Word]) -> Vec<&'static str> {
    words.iter().map(|w| w.text()).collect()
}
