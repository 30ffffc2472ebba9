//! Malformed models and images: each is told with its place, none stops the program.

use pts::diag::{Diagnostics, Severity};
use pts::files::{DiskFiles, Files, MemoryFiles};
use pts::import::obj::{ObjOptions, load};
use pts::pictures::{Limits, decode, read_exr_channels};
use std::path::Path;

/// File, code, and the line it must point at (in the file itself or its library).
const OBJ: &[(&str, &str, &str)] = &[];

/// File and code.
const IMAGES: &[(&str, &str)] = &[];

fn names(dir: &str, ending: Option<&str>) -> Vec<String> {
    let all = DiskFiles::default().list(Path::new(dir));
    all.into_iter()
        .filter(|n| ending.is_none_or(|e| n.ends_with(e)))
        .collect()
}

#[test]
fn every_bad_model_is_told_with_its_place() {
    assert_eq!(
        names("tests/bad/obj", Some(".obj")).len(),
        OBJ.len(),
        "the table lists every file"
    );
    for (name, code, line) in OBJ {
        let path = format!("tests/bad/obj/{name}");
        let mut diags = Diagnostics::default();
        let scene = load(
            Path::new(&path),
            &DiskFiles::default(),
            &ObjOptions::default(),
            &mut diags,
        );
        assert_eq!(
            scene.is_none(),
            diags.has_errors(),
            "{name}: a scene if and only if there is no error"
        );
        let told: Vec<String> = diags
            .iter()
            .map(|d| format!("{} {:?} {}", d.code, d.place, d.message))
            .collect();
        let found = diags
            .iter()
            .find(|d| d.code == *code)
            .unwrap_or_else(|| panic!("{name}: no {code} in {told:#?}"));
        assert_eq!(
            found.place.as_deref(),
            Some(format!("tests/bad/obj/{line}").as_str()),
            "{name}: {told:#?}"
        );
        assert!(
            diags.iter().all(|d| d.place.is_some() && !d.message.contains('\n')),
            "{name}: {told:#?}"
        );
        assert!(
            diags
                .iter()
                .all(|d| d.severity != Severity::Error || !d.hints.is_empty()),
            "{name}: {told:#?}"
        );
    }
}

#[test]
fn every_bad_image_is_told_with_its_place() {
    assert_eq!(
        names("tests/bad/images", None).len(),
        IMAGES.len(),
        "the table lists every file"
    );
    for (name, code) in IMAGES {
        let bytes = std::fs::read(format!("tests/bad/images/{name}")).expect("the file is there");
        let error = decode(&bytes, name, Limits::default()).expect_err(name);
        assert_eq!(
            (error.code, error.place.as_deref()),
            (*code, Some(*name)),
            "{}",
            error.message
        );
        assert!(
            !error.hints.is_empty() && !error.message.contains('\n'),
            "{name}: {}",
            error.message
        );
    }
}
#[test]
fn zz_dump() {
    for name in names("tests/bad/obj", Some(".obj")) {
        let path = format!("tests/bad/obj/{name}");
        let mut diags = Diagnostics::default();
        let scene = load(
            Path::new(&path),
            &DiskFiles::default(),
            &ObjOptions::default(),
            &mut diags,
        );
        println!("== {name} scene {}", scene.is_some());
        for d in diags.iter() {
            println!(
                "    {:?} {} {} | {} | {:?}",
                d.severity,
                d.code,
                d.place.clone().unwrap_or_default(),
                d.message,
                d.hints
            );
        }
    }
    for name in names("tests/bad/images", None) {
        let bytes = std::fs::read(format!("tests/bad/images/{name}")).expect("the file is there");
        match decode(&bytes, &name, Limits::default()) {
            Ok(p) => println!("OK?? {name} {}x{}", p.width, p.height),
            Err(d) => println!(
                "{name} {} {} | {} | {:?}",
                d.code,
                d.place.unwrap_or_default(),
                d.message,
                d.hints
            ),
        }
    }
}
