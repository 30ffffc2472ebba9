//! glTF 2.0 (`.gltf`, `.glb`) → [`Scene`].
//!
//! The `gltf` crate gives the schema: each element of the file is read as one of its typed JSON structures when it is
//! first used. Everything around it is our own, since input may be cut, cyclic or absurd: the container and its JSON
//! (`container`), the lookup of elements (`document`), files (`uri`), buffers (`buffer`, packed ones `meshopt`,
//! `deltas`, `filter`), accessors (`accessor`), packed meshes (`draco`), the node tree (`node`), primitives (`mesh`, `part`, `triangles`,
//! `deform`, `tangent`), materials (`material`, `extension`, `texture`), lamps and cameras (`light`, `camera`).
//!
//! What is not reached from the chosen scene is not read, so it cannot fail either. Errors are collected: a broken
//! mesh does not hide a broken material. Animations (`animation`) are played only for a clock or an open shutter, for which
//! nodes, cameras and lamps are given a motion and skins and morph targets their forms (`moving`).
//!
//! Memory stays in proportion to the file whatever it says (`budget`).

mod accessor;
mod animation;
mod budget;
mod buffer;
mod camera;
mod container;
mod contents;
mod deform;
mod deltas;
mod document;
mod draco;
mod extension;
mod filter;
mod left_out;
mod light;
mod material;
mod mesh;
mod meshopt;
mod moving;
mod node;
mod part;
mod refine;
mod required;
mod subtree;
mod tangent;
mod texture;
mod triangles;
mod uri;
mod variant;
mod volume;

pub use contents::{Contents, contents};

use crate::diag::{Anomaly, Diagnostic, Diagnostics, Severity};
use crate::files::Files;
use crate::scene::{Handedness, MaterialId, MeshId, Place, Scene, TextureId};
use document::Document;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// How materials with `KHR_materials_transmission` are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Glass {
    /// By the specification: solid where `KHR_materials_volume` gives a thickness, else thin sheets.
    #[default]
    AsWritten,
    /// All as solids, which refract: what Blender shows of glass that it exports without a thickness.
    Solid,
    /// All as thin sheets.
    Thin,
}

/// What the caller may choose about a glTF file.
#[derive(Clone, Debug, Default)]
pub struct GltfOptions {
    /// Name (or number) of the scene to draw; `None` is the file's own choice, else its first.
    pub scene: Option<String>,
    /// Name (or number) of a node: only it and what hangs on it is drawn, in its place; lamps and cameras too.
    pub node: Option<String>,
    /// Whether the place and pose of that node are left out, so that its own space is the scene's.
    pub node_is_origin: bool,
    /// Name of the material variant (`KHR_materials_variants`); `None` is the materials as written.
    pub variant: Option<String>,
    /// Seconds at which the file's animations are shown; without it everything stands as it is written, unless the
    /// shutter is open for a while (from 0 on then).
    pub clock: Option<f64>,
    /// Name of the only animation that is played, from second 0 on without a clock; `None` plays all that do not
    /// contradict an earlier one, if there is a clock.
    pub animation: Option<String>,
    /// How long the shutter is open, in seconds ≥ 0: what the animations move meanwhile is given a motion.
    pub shutter: f64,
    /// Whether buffers and images outside the model's folder may be read.
    pub allow_outside: bool,
    /// How materials that transmit are drawn.
    pub glass: Glass,
}

/// Reads a glTF or GLB file into a scene of its own: right-handed, metres as units, lamps and cameras in world space.
/// The first camera is active. `None` if and only if an error was reported. Without camera, lamp and emission
/// `is_bare_model` is set, and [`super::framing::frame`] adds what is missing.
pub fn load(path: &Path, files: &dyn Files, options: &GltfOptions, diags: &mut Diagnostics) -> Option<Scene> {
    let mut report = Report {
        file: path.display().to_string(),
        diags,
        failed: false,
        lenient: false,
    };
    let container = container::read(path, files, &mut report)?;
    let document = Document::new(container.json, &mut report);
    required::check(&document, &mut report);
    if report.failed {
        return None;
    }
    let mut loader = Loader {
        doc: &document,
        report,
        files,
        folder: path.parent().unwrap_or(Path::new("")),
        options,
        binary_chunk: container.binary,
        scene: Scene {
            handedness: Handedness::Right,
            ..Scene::default()
        },
        buffers: HashMap::new(),
        unpacked: HashMap::new(),
        accessors: accessor::Cache::default(),
        draco: draco::Last::default(),
        textures: HashMap::new(),
        images: HashMap::new(),
        materials: HashMap::new(),
        meshes: HashMap::new(),
        met_meshes: HashSet::new(),
        chosen_scene: None,
        variant: None,
        files_read: HashMap::new(),
        viewed_images: HashMap::new(),
        read_bytes: container.length,
        spent: budget::Spent::default(),
        bytes: 0,
        triangles: 0,
        animated: 0,
        bent: 0,
        told_still: false,
    };
    loader.variant = loader.choose_variant();
    loader.load_scene();
    loader.tell_left_out();
    let Loader { mut scene, report, .. } = loader;
    scene.active_camera = (!scene.cameras.is_empty()).then_some(0);
    scene.is_bare_model = scene.cameras.is_empty() && scene.lights.is_empty() && !super::framing::emits(&scene);
    (!report.failed).then_some(scene)
}

/// The state of one load. Its steps are the `impl` blocks of the modules.
struct Loader<'a> {
    doc: &'a Document,
    report: Report<'a>,
    files: &'a dyn Files,
    folder: &'a Path,
    options: &'a GltfOptions,
    binary_chunk: Option<buffer::Blob>,
    scene: Scene,
    buffers: HashMap<usize, Option<buffer::Blob>>,
    unpacked: HashMap<usize, Option<buffer::Blob>>,
    accessors: accessor::Cache,
    draco: draco::Last,
    textures: HashMap<texture::Key, Option<TextureId>>,
    /// By number, and by the number of what is taken instead.
    images: HashMap<(usize, Option<usize>), Option<crate::scene::ImageId>>,
    materials: HashMap<(usize, bool), Option<MaterialId>>,
    meshes: HashMap<usize, Rc<[MeshId]>>,
    /// Meshes that a visible node places.
    met_meshes: HashSet<usize>,
    /// The scene that is shown, if the file has scenes.
    chosen_scene: Option<usize>,
    variant: Option<usize>,
    /// Files of buffers by path, each read once.
    files_read: HashMap<std::path::PathBuf, Arc<[u8]>>,
    /// Images in views, by view.
    viewed_images: HashMap<usize, Arc<[u8]>>,
    /// Bytes of the file and of the buffers beside it.
    read_bytes: u64,
    spent: budget::Spent,
    /// Bytes of all buffers read and views unpacked so far, and triangles made of them.
    bytes: u64,
    triangles: u64,
    /// Numbers of animations looked at so far.
    animated: u64,
    /// Vertices of the forms that meshes change to.
    bent: u64,
    /// Whether it was told that skins and morph targets stand still.
    told_still: bool,
}

/// Collects diagnostics about one file.
struct Report<'a> {
    file: String,
    diags: &'a mut Diagnostics,
    failed: bool,
    /// Whether what is wrong costs a part of the picture only.
    lenient: bool,
}

impl Report<'_> {
    /// The file and a path inside it, as messages show it.
    fn place(&self, at: &str) -> String {
        match at {
            "" => self.file.clone(),
            at => format!("{}: {at}", self.file),
        }
    }

    /// The same for the scene's own records.
    fn origin(&self, at: &str) -> Place {
        Place::Model(self.place(at))
    }

    /// Adds a diagnostic at a path inside the file (`""` is the file itself).
    fn push(&mut self, at: &str, mut diagnostic: Diagnostic) {
        if self.lenient && diagnostic.severity == Severity::Error {
            diagnostic.severity = Severity::Warning;
            diagnostic = diagnostic.hint("the model is drawn without this texture");
        }
        self.failed |= diagnostic.severity == Severity::Error;
        self.diags.push(diagnostic.in_place(self.place(at)));
    }

    fn error(&mut self, code: &'static str, at: &str, message: impl Into<String>) {
        self.push(at, Diagnostic::error(code, message));
    }

    fn warning(&mut self, code: &'static str, at: &str, message: impl Into<String>) {
        self.push(at, Diagnostic::warning(code, message));
    }

    /// A warning about `n` things of a kind that were mended.
    fn mended(&mut self, code: &'static str, at: &str, message: impl Into<String>, kind: Anomaly, n: u64) {
        self.push(at, Diagnostic::warning(code, message).counting(kind, n));
    }
}
