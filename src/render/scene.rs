//! A scene ready to be traced: what `compile` makes and the kernel reads.

use super::camera::Camera;
use super::geometry::Geometry;
use super::light::LightSet;
use super::material::Material;
use super::medium::Medium;
use super::medium::fog::Fog;
use super::texture::Textures;
use glam::{DVec3, Vec3};

/// Everything the kernel reads, in camera-relative space: the camera stands at the origin, axes are the world's.
pub struct CompiledScene {
    /// Where the camera stands in world space.
    pub origin: DVec3,
    /// The camera.
    pub camera: Camera,
    /// Shapes and trees.
    pub geometry: Geometry,
    /// Materials by index.
    pub materials: Vec<Material>,
    /// Textures and images that materials use.
    pub textures: Textures,
    /// What fills solids and the space between them; the first is [`super::medium::CLEAR`].
    pub media: Vec<Medium>,
    /// Index of the medium outside of all solids.
    pub atmosphere: u32,
    /// Fogs outside of all solids.
    pub fogs: Vec<Fog>,
    /// Lamps, emitting shapes, environment.
    pub lights: LightSet,
    /// What camera rays see instead of the environment.
    pub backdrop: Option<Vec3>,
    /// What has to be watched for along a path.
    pub traits: SceneTraits,
    /// Boxes in which solids that refract or absorb may touch: where one ends another may begin.
    pub contacts: Vec<(Vec3, Vec3)>,
}

/// What a path has to watch for in this scene; what is false costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneTraits {
    /// Some surface lets light through unbent (alpha, filter, transmit): shadow rays must look at what they meet.
    pub see_through: bool,
    /// Some solid refracts and point lamps exist: their shadow rays pass tinted through smooth glass.
    pub lamp_through_glass: bool,
    /// Some solid refracts, or something fills one: paths keep track of what they are inside of.
    pub solids: bool,
    /// Something fills a solid or the space between them.
    pub media: bool,
    /// Some glass refracts colours differently.
    pub dispersion: bool,
    /// Something moves while the shutter is open: paths have a time.
    pub moves: bool,
}
