//! Which front end reads which file: by extension, and by content where there is none.
//!
//! Also the other direction: a text scene that contains `gltf { … }` or `obj { … }` asks back through the
//! model loader here, so that `lang` and `import` need not know each other.

mod follow;
mod form;
mod motion;
mod reader;

use crate::diag::{Diagnostic, Diagnostics, SourceMap};
use crate::files::Files;
use crate::import::{gltf, obj};
use crate::lang;
use crate::scene::Scene;
use reader::{Reader, Remembered};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// The extensions that are understood, for messages.
pub const KNOWN_EXTENSIONS: &str = ".pts, .pov, .inc, .gltf, .glb, .obj";

/// The name under which [`StdinFiles`] serves what came on standard input.
pub const STDIN_NAME: &str = "<stdin>";

/// What the front ends are told.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Where text scenes look up includes and images, after their own directory.
    pub include_dirs: Vec<PathBuf>,
    /// Identifiers declared before a text scene is read.
    pub defines: Vec<(String, String)>,
    /// Width of the picture, if the command line gives it.
    pub width: Option<u32>,
    /// Height of the picture, if the command line gives it.
    pub height: Option<u32>,
    /// When the shutter opens: `clock` in text scenes (0 without), seconds of the animations of a bare glTF (at rest
    /// without).
    pub clock: Option<f64>,
    /// How long the shutter is open, in units of the clock, ≥ 0; `None` leaves it to the scene.
    pub shutter: Option<f64>,
    /// Where in an animation a text scene is read, if it is in one; its clock is `clock`.
    pub frame: Option<lang::Frame>,
    /// Which scene of a bare glTF.
    pub gltf_scene: Option<String>,
    /// Which material variant of a bare glTF.
    pub variant: Option<String>,
    /// The only animation of a bare glTF that is played.
    pub animation: Option<String>,
    /// Whether a glTF, bare or in a text scene, may read files outside its own folder.
    pub allow_outside: bool,
    /// How materials of a glTF, bare or in a text scene, that transmit are drawn.
    pub glass: gltf::Glass,
}

/// The three families of scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `.pts`, `.pov`, `.inc`.
    Text,
    /// `.gltf`, `.glb`.
    Gltf,
    /// `.obj`.
    Obj,
}

/// Reads a scene of any kind. `None` if it cannot be rendered; then `diags` has an error that says why.
pub fn load(
    path: &Path,
    files: &dyn Files,
    options: &LoadOptions,
    sources: &mut SourceMap,
    diags: &mut Diagnostics,
) -> Option<Scene> {
    let scene = match kind_of(path, files, diags)? {
        Kind::Text => {
            let models =
                |request: &lang::ModelRequest, diags: &mut Diagnostics| load_model(request, files, options, diags);
            let texts = &Remembered::new(files);
            let reader = Reader {
                path,
                files,
                texts,
                options,
            };
            let told = reader.options_at(options.clock.unwrap_or(0.0), &models);
            let mut scene = lang::load(path, texts, &told, sources, diags);
            if let Some(scene) = &mut scene {
                reader.follow(scene, told.clock_read.load(Ordering::Relaxed), diags);
            }
            scene
        }
        Kind::Gltf => {
            let options = gltf::GltfOptions {
                scene: options.gltf_scene.clone(),
                variant: options.variant.clone(),
                clock: options.clock,
                animation: options.animation.clone(),
                shutter: options.shutter.unwrap_or(0.0),
                allow_outside: options.allow_outside,
                glass: options.glass,
                node: None,
                node_is_origin: false,
            };
            gltf::load(path, files, &options, diags)
        }
        Kind::Obj => obj::load(path, files, &obj::ObjOptions::default(), diags),
    };
    if let Some(scene) = &scene {
        note_stillness(scene, options, diags);
    }
    if scene.is_none() && !diags.has_errors() {
        let message = format!("`{}` could not be read, and nobody said why", path.display());
        diags.push(Diagnostic::error("L0005", message).hint("this is a mistake in pts, please report it"));
    }
    scene.filter(|_| !diags.has_errors())
}

/// Tells that a shutter is open in vain.
fn note_stillness(scene: &Scene, options: &LoadOptions, diags: &mut Diagnostics) {
    let shutter = options.shutter.or(scene.defaults.shutter).unwrap_or(0.0);
    if shutter > 0.0 && !scene.moves() {
        let note = Diagnostic::note("L0007", "the shutter is open for a while, but nothing moves");
        diags.push(
            note.hint("in a text scene `clock` moves things, in a bare glTF its animations do; others stand still"),
        );
    }
}

/// Reads a model that a text scene asks for.
fn load_model(
    request: &lang::ModelRequest,
    files: &dyn Files,
    options: &LoadOptions,
    diags: &mut Diagnostics,
) -> Option<Scene> {
    match request.kind {
        lang::ModelKind::Gltf => {
            let wanted = &request.options;
            let options = gltf::GltfOptions {
                scene: wanted.scene.clone(),
                variant: wanted.variant.clone(),
                node: wanted.node.clone(),
                node_is_origin: wanted.node_is_origin,
                clock: wanted.clock,
                animation: wanted.animation.clone(),
                allow_outside: options.allow_outside,
                glass: options.glass,
                ..gltf::GltfOptions::default()
            };
            gltf::load(&request.path, files, &options, diags)
        }
        lang::ModelKind::Obj => obj::load(&request.path, files, &obj::ObjOptions::default(), diags),
    }
}

/// The front end for a file. Letter case of the extension does not matter.
pub fn kind_of(path: &Path, files: &dyn Files, diags: &mut Diagnostics) -> Option<Kind> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("pts" | "pov" | "inc") => Some(Kind::Text),
        Some("gltf" | "glb") => Some(Kind::Gltf),
        Some("obj") => Some(Kind::Obj),
        Some(other) => {
            let message = format!("`{}` has the unknown extension .{other}", path.display());
            diags.push(Diagnostic::error("L0001", message).hint(unknown_extension_hint(other)));
            None
        }
        None => match files.read(path) {
            Ok(data) => Some(sniff(&data)),
            Err(error) => {
                diags.push(unreadable(path, &error, files));
                None
            }
        },
    }
}

fn unknown_extension_hint(extension: &str) -> String {
    let known = format!("scenes are {KNOWN_EXTENSIONS}");
    match extension {
        "fbx" | "blend" | "dae" | "stl" | "ply" | "3ds" | "usd" | "usda" | "usdc" | "usdz" | "max" | "c4d" => {
            format!("{known}; export the model as glTF (.glb), for example from Blender")
        }
        "png" | "jpg" | "jpeg" | "exr" | "hdr" => format!("{known}; this looks like an image"),
        _ => known,
    }
}

/// Guesses the kind of a file without an extension from its first bytes; text unless it is surely something else.
fn sniff(data: &[u8]) -> Kind {
    if data.starts_with(b"glTF") {
        return Kind::Gltf;
    }
    let head = String::from_utf8_lossy(data.get(..4096).unwrap_or(data));
    let head = head.trim_start_matches('\u{feff}').trim_start();
    if head.starts_with('{') {
        return Kind::Gltf; // no text scene opens with a brace
    }
    let words = head
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty() && !l.starts_with('#'));
    let mut first = words.map(|line| line.split_whitespace().next().unwrap_or_default());
    match first.next() {
        Some("v" | "vn" | "vt" | "o" | "g" | "mtllib" | "usemtl") => Kind::Obj,
        _ => Kind::Text,
    }
}

/// The diagnostic for a scene file that cannot be read; names files that look alike.
pub fn unreadable(path: &Path, error: &io::Error, files: &dyn Files) -> Diagnostic {
    let shown = path.display();
    if error.kind() != io::ErrorKind::NotFound {
        return Diagnostic::error("L0003", format!("cannot read `{shown}`: {error}"));
    }
    let mut diagnostic = Diagnostic::error("L0002", format!("cannot read `{shown}`: no such file"));
    let dir = path.parent().unwrap_or(Path::new(""));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let close = |other: &String| strsim::damerau_levenshtein(&other.to_lowercase(), &name.to_lowercase());
    let names = files.list(dir);
    if let Some(near) = names
        .iter()
        .min_by_key(|n| close(n))
        .filter(|n| close(n) <= name.len().div_ceil(4))
    {
        diagnostic = diagnostic.hint(format!("a similar file exists: {}", dir.join(near).display()));
    }
    diagnostic
}

/// Another set of files, with one more that was read from standard input.
pub struct StdinFiles<F> {
    inner: F,
    stdin: Arc<[u8]>,
}

impl<F: Files> StdinFiles<F> {
    /// Serves `stdin` as [`STDIN_NAME`] and everything else from `inner`.
    pub fn new(inner: F, stdin: impl Into<Arc<[u8]>>) -> StdinFiles<F> {
        let stdin = stdin.into();
        StdinFiles { inner, stdin }
    }
}

impl<F: Files> Files for StdinFiles<F> {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        if path == Path::new(STDIN_NAME) {
            return Ok(self.stdin.clone());
        }
        self.inner.read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        path == Path::new(STDIN_NAME) || self.inner.exists(path)
    }

    fn size(&self, path: &Path) -> Option<u64> {
        if path == Path::new(STDIN_NAME) {
            return Some(self.stdin.len() as u64);
        }
        self.inner.size(path)
    }

    fn list(&self, dir: &Path) -> Vec<String> {
        self.inner.list(dir)
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.inner.opened()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;

    #[allow(clippy::result_large_err)] // tests want to see it
    fn kind(name: &str, content: &[u8]) -> Result<Kind, Diagnostic> {
        let mut files = MemoryFiles::default();
        files.insert(name, content);
        let mut diags = Diagnostics::default();
        let kind = kind_of(Path::new(name), &files, &mut diags);
        kind.ok_or_else(|| diags.iter().next().cloned().expect("a refusal has a reason"))
    }

    #[test]
    fn the_extension_decides_in_any_letter_case() {
        for (name, expected) in [
            ("a.pts", Kind::Text),
            ("a.POV", Kind::Text),
            ("a.gltf", Kind::Gltf),
            ("a.GLB", Kind::Gltf),
            ("a.obj", Kind::Obj),
        ] {
            assert_eq!(kind(name, b"{"), Ok(expected), "{name}");
        }
    }

    #[test]
    fn an_unknown_extension_names_the_known_ones() {
        let refused = kind("a.fbx", b"").unwrap_err();
        assert!(refused.message.contains(".fbx"), "{refused:?}");
        assert!(refused.hints[0].contains(KNOWN_EXTENSIONS), "{refused:?}");
    }

    #[test]
    fn without_an_extension_the_content_decides() {
        for (content, expected) in [
            (&b"glTF\x02\0\0\0"[..], Kind::Gltf),
            (b"\xef\xbb\xbf {\"asset\":{}}", Kind::Gltf),
            (b"# made by hand\nmtllib a.mtl\nv 0 0 0\n", Kind::Obj),
            (b"#declare V = 1;\nsphere { 0, V }", Kind::Text),
            (b"", Kind::Text),
        ] {
            assert_eq!(
                kind("scene", content),
                Ok(expected),
                "{}",
                String::from_utf8_lossy(content)
            );
        }
    }

    #[test]
    fn a_missing_file_suggests_one_that_looks_alike() {
        let mut files = MemoryFiles::default();
        files.insert("scenes/cornell.pts", &b""[..]);
        let error = io::Error::from(io::ErrorKind::NotFound);
        let d = unreadable(Path::new("scenes/cornel.pts"), &error, &files);
        assert!(d.message.contains("scenes/cornel.pts"), "{d:?}");
        assert!(d.hints[0].contains("scenes/cornell.pts"), "{d:?}");
        assert!(unreadable(Path::new("scenes/xyz.pts"), &error, &files).hints.is_empty());
    }

    #[test]
    fn standard_input_is_one_more_file() {
        let mut inner = MemoryFiles::default();
        inner.insert("a.inc", &b"inner"[..]);
        let files = StdinFiles::new(inner, &b"outer"[..]);
        assert_eq!(&*files.read(Path::new(STDIN_NAME)).unwrap(), b"outer");
        assert_eq!(&*files.read(Path::new("a.inc")).unwrap(), b"inner");
        assert!(files.read(Path::new("b.inc")).is_err());
    }
}
