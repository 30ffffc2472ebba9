//! The language: each case is a scene under `tests/language/<construct>/`.
//!
//! Comments in a case say what it must give: `// error: L:C text` and `// warn: L:C text` (text is part of the
//! message; `L:C-L:C` also checks the end). A case without errors is compared with `<case>.scene`, the canonical dump;
//! `PTS_BLESS=1 cargo test --test language` rewrites those. Every file of `tests/bad/text` must give an error with a
//! place, in bounded time, without a panic.

use pts::diag::{Diagnostic, Diagnostics, Severity, SourceMap, Span};
use pts::files::DiskFiles;
use pts::lang::{LoadOptions, ModelOptions, ModelRequest, load};
use pts::scene::{Aspect, Camera, Falloff, Light, LightKind, Material, Mesh, Object, Place, Scene, Shape};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

struct Loaded {
    scene: Option<Scene>,
    sources: SourceMap,
    diags: Diagnostics,
}

/// Stands for the importers: a model is one sphere and one lamp. One that something is wanted of is named by that, and has
/// a camera, a sphere of material "Paint" and two triangles, the second of material "Glass".
fn model(request: &ModelRequest, _: &mut Diagnostics) -> Option<Scene> {
    let mut scene = Scene::default();
    scene.objects.push(Object::new(Shape::Sphere {
        center: glam::DVec3::new(0.0, 0.0, 1.0),
        radius: 1.0,
    }));
    scene.lights.push(Light {
        name: String::new(),
        color: glam::DVec3::ONE,
        kind: LightKind::Point {
            position: glam::DVec3::new(0.0, 0.0, 5.0),
            falloff: Falloff::None,
        },
        casts_shadows: true,
        motion: vec![],
        place: Place::None,
    });
    if request.options == ModelOptions::default() && !request.path.ends_with("parts.obj") {
        return Some(scene);
    }
    let names = ["Paint", "Glass"];
    let [paint, glass] = names.map(|name| {
        let material = Material::diffuse(glam::DVec3::ONE);
        let name = name.to_owned();
        scene.add_material(Material { name, ..material })
    });
    scene.objects[0].material = Some(paint);
    scene.objects[0].name = request.options.key();
    let corners = [glam::DVec3::ZERO, glam::DVec3::X, glam::DVec3::Y];
    let mut mesh = Mesh::from_f64("two", &corners, &[[0, 1, 2], [0, 2, 1]]).expect("corners in range");
    mesh.materials = vec![Some(paint), Some(glass)];
    mesh.face_materials = vec![0, 1];
    let id = scene.add_mesh(mesh);
    scene.objects.push(Object::new(Shape::Mesh(id)));
    scene.cameras.push(Camera {
        name: "Side".to_owned(),
        direction: glam::DVec3::NEG_Z,
        right: glam::DVec3::X,
        aspect: Aspect::FromImage,
        ..Camera::default()
    });
    Some(scene)
}

fn load_file(path: &Path) -> Loaded {
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let options = LoadOptions {
        include_dirs: vec![],
        defines: vec![
            ("Defined".to_owned(), "3".to_owned()),
            ("Word".to_owned(), "text".to_owned()),
        ],
        clock: 0.25,
        ..LoadOptions::new(&model)
    };
    let scene = load(path, &DiskFiles::default(), &options, &mut sources, &mut diags);
    Loaded { scene, sources, diags }
}

fn files_in(dir: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut out = Vec::new();
    let mut open = vec![PathBuf::from(dir)];
    while let Some(dir) = open.pop() {
        for entry in std::fs::read_dir(&dir).into_iter().flatten().flatten() {
            let path = entry.path();
            let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
            if path.is_dir() {
                open.push(path);
            } else if extension.is_some_and(|e| extensions.contains(&e.as_str())) {
                out.push(path);
            }
        }
    }
    out.sort();
    out
}

fn range(sources: &SourceMap, span: Span) -> String {
    let (l0, c0) = sources.line_col(span);
    let (l1, c1) = sources.line_col(Span {
        start: span.end,
        ..span
    });
    format!("{l0}:{c0}-{l1}:{c1}")
}

fn show(l: &Loaded, d: &Diagnostic) -> String {
    let place = d.primary_span().map_or("(no place)".to_owned(), |s| l.sources.place(s));
    format!("{:?} {} {place}: {} {:?}", d.severity, d.code, d.message, d.hints)
}

/// Whether a diagnostic is the one announced as `L:C text` or `L:C-L:C text`.
fn fits(l: &Loaded, d: &Diagnostic, expected: &str) -> bool {
    let (place, text) = expected.split_once(' ').unwrap_or((expected, ""));
    let found = d.primary_span().map_or(String::new(), |s| range(&l.sources, s));
    let in_place = found == place || found.split('-').next() == Some(place);
    let hinted = d.hints.iter().any(|h| h.contains(text.trim()));
    in_place && (d.message.contains(text.trim()) || hinted)
}

/// Checks one case and returns what is wrong with it.
fn check(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).expect("a test case is readable");
    let loaded = load_file(path);
    let mut wrong = Vec::new();
    for (severity, mark) in [(Severity::Error, "// error: "), (Severity::Warning, "// warn: ")] {
        let expected: Vec<&str> = text
            .lines()
            .filter_map(|l| l.split_once(mark).map(|p| p.1.trim()))
            .collect();
        let mut found: Vec<&Diagnostic> = loaded.diags.iter().filter(|d| d.severity == severity).collect();
        for e in expected {
            match found.iter().position(|d| fits(&loaded, d, e)) {
                Some(i) => drop(found.remove(i)),
                None => wrong.push(format!("missing {severity:?} {e}")),
            }
        }
        wrong.extend(found.iter().map(|d| format!("unexpected {}", show(&loaded, d))));
    }
    if loaded.scene.is_some() == loaded.diags.has_errors() {
        wrong.push("a scene must be returned exactly if there are no errors".to_owned());
    }
    let Some(scene) = &loaded.scene else { return wrong };
    let dump = scene.dump();
    let expected_path = path.with_extension("scene");
    if std::env::var_os("PTS_BLESS").is_some() {
        std::fs::write(&expected_path, &dump).expect("the expected dump is writable");
    }
    let expected = std::fs::read_to_string(&expected_path).unwrap_or_default();
    if expected != dump {
        wrong.push(format!("dump differs from {}:\n{dump}", expected_path.display()));
    }
    wrong
}

#[test]
fn every_case_gives_what_it_says() {
    let cases = files_in("tests/language", &["pts", "pov"]);
    assert!(cases.len() >= 60, "only {} cases found", cases.len());
    let mut failures = Vec::new();
    for case in &cases {
        let wrong = check(case);
        failures.extend(wrong.into_iter().map(|w| format!("{}: {w}", case.display())));
    }
    assert!(
        failures.is_empty(),
        "{}\n(PTS_BLESS=1 rewrites dumps)",
        failures.join("\n")
    );
}

#[test]
fn malformed_scenes_give_an_error_with_a_place_in_bounded_time() {
    let cases = files_in("tests/bad/text", &["pts", "pov"]);
    assert!(cases.len() >= 25, "only {} cases found", cases.len());
    for case in &cases {
        let start = Instant::now();
        let loaded = load_file(case);
        let took = start.elapsed();
        let all: Vec<String> = loaded.diags.iter().map(|d| show(&loaded, d)).collect();
        let placed = loaded
            .diags
            .iter()
            .any(|d| d.severity == Severity::Error && d.primary_span().is_some());
        assert!(loaded.scene.is_none() && placed, "{} gave {all:?}", case.display());
        assert!(took < Duration::from_secs(60), "{} took {took:?}", case.display());
    }
}
