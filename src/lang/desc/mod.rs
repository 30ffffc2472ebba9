//! What blocks describe, before anything is drawn: shared, so that a declared object costs its size once. `lower::emit`
//! turns what the scene reaches into the IR; what is only declared is never looked at again.

mod air;
mod look;
mod surface;

pub use air::{FogDesc, MediaDesc};
pub use look::{FinishDesc, ImageDesc, InteriorDesc, Layer, Layers, Look, NormalDesc, Pigment};
pub use surface::{BesideDesc, ModelSurface, NormalMapDesc, NumberDesc, PrincipledDesc, SurfaceDesc};

use crate::diag::Span;
use crate::scene::{Mesh, RenderDefaults, Shape, Visibility};
use glam::{DAffine3, DVec3};
use std::path::PathBuf;
use std::rc::Rc;

/// A block as a value.
#[derive(Clone, Debug)]
pub enum Desc {
    /// An object or lamp.
    Object(Rc<ObjectDesc>),
    /// A texture, layers from the bottom up.
    Texture(Layers),
    /// A pigment.
    Pigment(Rc<Pigment>),
    /// A finish.
    Finish(Rc<FinishDesc>),
    /// A normal.
    Normal(Rc<NormalDesc>),
    /// An interior.
    Interior(Rc<InteriorDesc>),
    /// A material.
    Material(Look),
    /// A transform.
    Transform(DAffine3),
    /// A camera.
    Camera(Rc<CameraDesc>),
    /// A colour, pigment or texture map: its average over [0, 1].
    Map(Rc<Pigment>),
    /// A sky sphere: its average colour.
    Sky(Rc<Pigment>),
    /// A medium.
    Media(Rc<MediaDesc>),
    /// The density of a medium.
    Density(Rc<Pigment>),
    /// A fog.
    Fog(Rc<FogDesc>),
    /// Something that is parsed and has no effect yet.
    Opaque(&'static str),
}

impl Desc {
    /// What messages call it.
    pub fn kind(&self) -> &'static str {
        match self {
            Desc::Object(o) => match o.shape {
                ShapeDesc::Light(_) => "a light source",
                _ => "an object",
            },
            Desc::Texture(_) => "a texture",
            Desc::Pigment(_) => "a pigment",
            Desc::Finish(_) => "a finish",
            Desc::Normal(_) => "a normal",
            Desc::Interior(_) => "an interior",
            Desc::Material(_) => "a material",
            Desc::Transform(_) => "a transform",
            Desc::Camera(_) => "a camera",
            Desc::Map(_) => "a map",
            Desc::Sky(_) => "a sky sphere",
            Desc::Media(_) => "a medium",
            Desc::Density(_) => "a density",
            Desc::Fog(_) => "a fog",
            Desc::Opaque(kind) => kind,
        }
    }
}

/// An object: a shape, placed and painted.
#[derive(Clone, Debug)]
pub struct ObjectDesc {
    /// What it is.
    pub shape: ShapeDesc,
    /// From the shape's space to its parent's.
    pub transform: DAffine3,
    /// How it looks; empty inherits.
    pub look: Look,
    /// Which rays see it.
    pub visibility: Visibility,
    /// How deep unions are nested in it.
    pub depth: u32,
    /// How many shapes and lamps it places.
    pub leaves: u64,
    /// Where it was written.
    pub span: Span,
}

impl ObjectDesc {
    /// An unpainted object in place.
    pub fn new(shape: ShapeDesc, span: Span) -> ObjectDesc {
        ObjectDesc {
            shape,
            transform: DAffine3::IDENTITY,
            look: Look::default(),
            visibility: Visibility::default(),
            depth: 0,
            leaves: 1,
            span,
        }
    }
}

/// A shape of the language.
#[derive(Clone, Debug)]
pub enum ShapeDesc {
    /// One the IR has.
    Primitive(Rc<Shape>),
    /// Triangles.
    Mesh(Rc<MeshDesc>),
    /// Several objects.
    Union(Rc<[Rc<ObjectDesc>]>),
    /// A lamp.
    Light(Rc<LightDesc>),
    /// A glTF or OBJ file.
    Model(Rc<ModelDesc>),
    /// One that cannot be drawn yet: its word.
    Unsupported(&'static str),
}

/// Triangles with a look for each slot; slot 0 is the object's own.
#[derive(Debug)]
pub struct MeshDesc {
    /// Geometry without materials.
    pub mesh: Mesh,
    /// Looks of slots 1, 2, ….
    pub looks: Vec<Look>,
}

/// A model to be loaded when it is drawn.
#[derive(Debug)]
pub struct ModelDesc {
    /// `gltf` or `obj`.
    pub kind: crate::lang::ModelKind,
    /// The file as found.
    pub path: PathBuf,
    /// What of it.
    pub options: crate::lang::ModelOptions,
    /// Whether its lamps shine.
    pub lights: bool,
    /// Whether its cameras can be chosen.
    pub cameras: bool,
    /// `material "name" { … }`: what replaces its materials of these names, with the places of the names.
    pub materials: Vec<(String, Span, Look)>,
    /// Where it is named.
    pub span: Span,
}

/// A lamp in its own space.
#[derive(Clone, Debug)]
pub struct LightDesc {
    /// Place.
    pub position: DVec3,
    /// Colour in the scene's working gamma.
    pub color: DVec3,
    /// Where spotlights and parallel lights point.
    pub point_at: DVec3,
    /// `parallel`.
    pub parallel: bool,
    /// `spotlight`: half angles in degrees and tightness.
    pub spot: Option<[f64; 3]>,
    /// `area_light`: its edges.
    pub area: Option<[DVec3; 2]>,
    /// `circular`.
    pub circular: bool,
    /// `fade_distance`, 0 for none.
    pub fade_distance: f64,
    /// `fade_power`, 0 for none.
    pub fade_power: f64,
    /// `shadowless`.
    pub shadowless: bool,
    /// `looks_like`, in the space of the lamp's place.
    pub looks_like: Option<Rc<ObjectDesc>>,
    /// Where it was written.
    pub span: Span,
}

/// A camera as written; `None` is the default.
#[derive(Clone, Debug)]
pub struct CameraDesc {
    /// `location`.
    pub location: DVec3,
    /// `look_at`.
    pub look_at: Option<DVec3>,
    /// `right`.
    pub right: Option<DVec3>,
    /// `up`.
    pub up: Option<DVec3>,
    /// `sky`.
    pub sky: DVec3,
    /// `direction`.
    pub direction: DVec3,
    /// `angle` in degrees.
    pub angle: Option<f64>,
    /// `orthographic`.
    pub orthographic: bool,
    /// A projection that cannot be drawn yet.
    pub unsupported: Option<(&'static str, Span)>,
    /// `lens_radius`.
    pub lens_radius: Option<f64>,
    /// `focus_distance`.
    pub focus_distance: Option<f64>,
    /// `aperture`: the diameter.
    pub aperture: f64,
    /// `focal_point`.
    pub focal_point: Option<DVec3>,
    /// `blur_samples`.
    pub blur_samples: f64,
    /// Transforms behind the rest.
    pub transform: DAffine3,
    /// Where it was written.
    pub span: Span,
}

/// Light from infinitely far away as written.
#[derive(Clone, Debug)]
pub enum SkyDesc {
    /// One colour, in the scene's working gamma.
    Color(DVec3, Option<(&'static str, Span)>),
    /// An image.
    Image {
        /// File as found.
        path: PathBuf,
        /// Factor.
        strength: f64,
        /// Degrees.
        rotate: DVec3,
    },
}

/// How written colours relate to linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gamma {
    /// Colours are linear.
    Linear,
    /// Colours are display values of this exponent.
    Power(f64),
    /// Colours are sRGB display values.
    Srgb,
}

/// The scene as described.
#[derive(Debug, Default)]
pub struct SceneDesc {
    /// What stands in it.
    pub objects: Vec<Rc<ObjectDesc>>,
    /// The camera written last.
    pub camera: Option<Rc<CameraDesc>>,
    /// `#default { camera … }` is not separate: it starts every camera.
    pub default_camera: Option<Rc<CameraDesc>>,
    /// `background`, where.
    pub background: Option<(SkyDesc, Span)>,
    /// `sky_sphere`, where.
    pub sky_sphere: Option<(SkyDesc, Span)>,
    /// `environment`, where.
    pub environment: Option<(SkyDesc, Span)>,
    /// `media` of the air, all together.
    pub media: Vec<Rc<MediaDesc>>,
    /// Every `fog`.
    pub fogs: Vec<Rc<FogDesc>>,
    /// `render { … }`.
    pub defaults: RenderDefaults,
    /// `assumed_gamma`, if written.
    pub gamma: Option<Gamma>,
    /// `ambient_light`.
    pub ambient_light: Option<DVec3>,
    /// Texture that textures start from and untextured objects get.
    pub default_layer: Option<Rc<Layer>>,
}
