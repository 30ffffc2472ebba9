//! Wavefront OBJ with MTL.
//!
//! OBJ has no owner any more, and what programs write under its name varies. Loading therefore has four steps:
//! `lines` splits bytes into statements (continuations, comments, any encoding), `clean` checks each statement,
//! mends or reports it with its line, and hands `tobj` a text that it can read without surprises, `mesh` turns
//! polygons into triangles with normals, and `mtl` with `material` maps the materials.
//!
//! Numbers are taken as they are: right-handed, y up, no unit. `vt` counts from the bottom left in OBJ and from
//! the top left here.

mod clean;
mod face;
mod lines;
mod material;
mod mesh;
mod mtl;
mod normals;
mod polygon;
mod report;
mod tangents;
#[cfg(test)]
mod tests;
mod texture;

use crate::diag::{Diagnostic, Diagnostics};
use crate::files::Files;
use crate::scene::{Handedness, Scene};
use report::Report;
use std::path::{Path, PathBuf};

/// How an OBJ file is to be read. There is nothing to choose yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjOptions {}

/// Loads an OBJ file and the material libraries it names. Returns `None` if and only if it reported an error.
/// The scene is right-handed and a bare model: it has neither camera nor lamps.
pub fn load(path: &Path, files: &dyn Files, _options: &ObjOptions, diags: &mut Diagnostics) -> Option<Scene> {
    let name = path.display().to_string();
    let bytes = match files.read(path) {
        Ok(bytes) => bytes,
        Err(e) => {
            diags.push(Diagnostic::error("O0001", format!("OBJ file cannot be read: {e}")).in_place(name));
            return None;
        }
    };
    let mut report = Report::new(name);
    let scene = load_bytes(path, &bytes, files, &mut report);
    let has_errors = report.has_errors();
    diags.extend(report.finish());
    scene.filter(|_| !has_errors)
}

fn load_bytes(path: &Path, bytes: &[u8], files: &dyn Files, report: &mut Report) -> Option<Scene> {
    if bytes.contains(&0) {
        let message = "not an OBJ file: found binary data (a zero byte), expected text";
        report.push(
            1,
            Diagnostic::error("O0002", message).hint("check that the file is what its name says"),
        );
        return None;
    }
    let mut cleaned = clean::clean(bytes, report);
    if report.has_errors() {
        return None;
    }
    if cleaned.faces.is_empty() {
        let found = cleaned.inventory();
        let message = format!("OBJ file has no faces: found {found}, expected `f` statements");
        report.push(
            1,
            Diagnostic::error("O0003", message).hint("export the model with its surfaces, as polygons"),
        );
        return None;
    }
    let mut scene = Scene {
        handedness: Handedness::Right,
        is_bare_model: true,
        ..Scene::default()
    };
    let directory = path.parent().map(Path::to_owned).unwrap_or_default();
    let stem = path
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned())
        .unwrap_or_default();
    let beside = format!("{stem}.mtl");
    if cleaned.libraries.is_empty() && !cleaned.materials.is_empty() && files.exists(&directory.join(&beside)) {
        // Some programs write the library and forget to name it.
        let message = format!("model names no material library; {beside:?} beside it is used");
        report.push(1, Diagnostic::note("O0215", message));
        cleaned.libraries.push(clean::Named { name: beside, line: 1 });
    }
    let library = mtl::load_libraries(&cleaned.libraries, &directory, files, report);
    let materials = material::add_materials(&cleaned, &library, files, &mut scene, report);
    mesh::add_meshes(&cleaned, &materials, &stem, &mut scene, report)?;
    Some(scene)
}

/// Finds a file that a model names: as written, with backslashes turned, without regard to letter case, and at
/// last by its bare name beside the model. What was written on another machine often fits only so.
fn find_file(files: &dyn Files, directory: &Path, written: &str) -> Option<PathBuf> {
    let written = written.trim().trim_matches('"');
    let turned = written.replace('\\', "/");
    let last = turned.rsplit('/').next().unwrap_or_default();
    for candidate in [written, turned.as_str(), last] {
        if candidate.is_empty() {
            continue;
        }
        let path = directory.join(candidate);
        if files.exists(&path) {
            return Some(path);
        }
        if let Some(path) = find_ignoring_case(files, directory, candidate) {
            return Some(path);
        }
    }
    None
}

fn find_ignoring_case(files: &dyn Files, directory: &Path, candidate: &str) -> Option<PathBuf> {
    let mut path = directory.to_owned();
    let parts: Vec<&str> = candidate.split('/').filter(|p| !p.is_empty() && *p != ".").collect();
    for part in parts {
        if part == ".." {
            path.push("..");
            continue;
        }
        let entry = files.list(&path).into_iter().find(|e| e.eq_ignore_ascii_case(part))?;
        path.push(entry);
    }
    files.exists(&path).then_some(path)
}
