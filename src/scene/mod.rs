//! The scene as it was described: plain data with places, filled by `lang` and `import`, read by `compile`.
//!
//! Everything is f64, angles are radians, references are typed indices. Nothing here knows of acceleration
//! structures, sampling or files on disk (an image names its file, `compile` opens it if it is used).
//! World space is the front end's: left-handed for text scenes, right-handed for a bare glTF or OBJ
//! ([`Scene::handedness`]).

mod camera;
mod dump;
mod dump_material;
mod image;
mod left_out;
mod light;
mod material;
mod medium;
mod merge;
mod mesh;
pub mod motion;
mod settings;
mod shape;
mod texture;

pub use camera::{Aspect, Camera, Projection};
pub use image::{Image, ImageSource};
pub use left_out::LeftOut;
pub use light::{Environment, EnvironmentKind, Falloff, Light, LightKind, SpotProfile};
pub use material::{
    BumpMap, ColorInput, EmissionSides, Finish, FinishReflection, Material, NormalMap, Opacity, OpacityMode,
    Principled, ScalarInput, SurfaceModel,
};
pub use medium::{Fog, GroundFog, Medium, Phase};
pub use mesh::{Mesh, MeshForm, mend_normals};
pub use motion::CameraKey;
pub use settings::{FilterKind, RenderDefaults};
pub use shape::{Object, Shape, Visibility};
pub use texture::{Channel, Encoding, ImageTexture, TexelFilter, Texture, Wrap};

use crate::diag::Span;
use std::sync::Arc;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The position in the scene's table.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Index into [`Scene::meshes`].
    MeshId
);
id!(
    /// Index into [`Scene::materials`].
    MaterialId
);
id!(
    /// Index into [`Scene::textures`].
    TextureId
);
id!(
    /// Index into [`Scene::images`].
    ImageId
);
id!(
    /// Index into [`Scene::groups`].
    GroupId
);

/// Which way z points for somebody who sees x to the right and y up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Handedness {
    /// z points away from the viewer: text scenes, as in POV-Ray.
    #[default]
    Left,
    /// z points to the viewer: a bare glTF or OBJ.
    Right,
}

/// A named set of objects that can be placed many times.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// What stands in it; transforms are relative to the group.
    pub objects: Vec<Object>,
}

/// A whole scene. All ids inside refer to the tables of the same scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// World orientation.
    pub handedness: Handedness,
    /// Cameras in the order they were written; the active one is [`Scene::active_camera`].
    pub cameras: Vec<Camera>,
    /// Index of the camera to use; `None` when the scene has none and must be framed.
    pub active_camera: Option<usize>,
    /// What is drawn, in world space.
    pub objects: Vec<Object>,
    /// Object sets that `Shape::Group` places.
    pub groups: Vec<Group>,
    /// Triangle meshes that `Shape::Mesh` places; shared, so that a changed copy of a scene does not copy them.
    pub meshes: Arc<Vec<Mesh>>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures that materials refer to.
    pub textures: Vec<Texture>,
    /// Image files or embedded images, not decoded yet.
    pub images: Vec<Image>,
    /// Lamps that are not shapes.
    pub lights: Vec<Light>,
    /// Light from infinitely far away.
    pub environment: Environment,
    /// What fills the space outside of all solids.
    pub atmosphere: Medium,
    /// Where the atmosphere was written.
    pub atmosphere_place: Place,
    /// Fogs in it.
    pub fogs: Vec<Fog>,
    /// What the scene asks of the renderer.
    pub defaults: RenderDefaults,
    /// Material of objects that have none and inherit none; `None` is a white diffuse surface.
    pub default_material: Option<MaterialId>,
    /// What the files hold beside it and nobody needs; it was not read.
    pub left_out: Vec<LeftOut>,
    /// Whether pixel values are shown without sRGB encoding (POV-Ray scenes without `assumed_gamma`).
    pub display_is_linear: bool,
    /// Whether the scene is a bare model that brought neither camera nor light (framing and light are added).
    pub is_bare_model: bool,
}

impl Scene {
    /// Adds a material and returns its id.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a mesh and returns its id.
    pub fn add_mesh(&mut self, mesh: Mesh) -> MeshId {
        Arc::make_mut(&mut self.meshes).push(mesh);
        MeshId(self.meshes.len() as u32 - 1)
    }

    /// Adds a texture and returns its id.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds an image and returns its id.
    pub fn add_image(&mut self, image: Image) -> ImageId {
        self.images.push(image);
        ImageId(self.images.len() as u32 - 1)
    }

    /// Adds a group and returns its id.
    pub fn add_group(&mut self, objects: Vec<Object>) -> GroupId {
        self.groups.push(Group { objects });
        GroupId(self.groups.len() as u32 - 1)
    }

    /// The camera in use, if the scene has one.
    pub fn camera(&self) -> Option<&Camera> {
        self.active_camera.and_then(|i| self.cameras.get(i))
    }
}

/// Where a thing of the scene was written, for messages: a span of a text, a path inside a glTF, or neither.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub enum Place {
    /// Made by the program itself.
    #[default]
    None,
    /// In a text scene.
    Text(Span),
    /// In a model: `model.glb: meshes[2].primitives[0]`, `model.obj:17`.
    Model(String),
}
