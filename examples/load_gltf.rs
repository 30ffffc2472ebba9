//! A glTF model as it is: loaded, framed and lit, and every complaint told.
//! `cargo run --release --example load_gltf [model.glb]` writes `load_gltf.png`.

use pts::diag::{Diagnostics, SourceMap};
use pts::files::DiskFiles;
use pts::import::framing::frame;
use pts::load::{LoadOptions, load};
use pts::output::{Develop, Layers, ToneMap, write};
use pts::render::{driver::render, report::Silent, settings::Settings};
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model: PathBuf = std::env::args_os()
        .nth(1)
        .unwrap_or("scenes/models/lantern.glb".into())
        .into();
    let files = DiskFiles::default();
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load(&model, &files, &LoadOptions::default(), &mut sources, &mut diags);
    for d in diags.iter() {
        eprintln!(
            "{:?}: {} ({})",
            d.severity,
            d.message,
            d.place.as_deref().unwrap_or("no place")
        );
    }
    let mut scene = scene.ok_or("the model has errors")?;
    if let Some(note) = frame(&mut scene, 4.0 / 3.0) {
        println!("{}", note.message);
    }
    let compiled = pts::compile::compile(&scene, &files, 640, 480, &mut diags).ok_or("it cannot be drawn")?;
    let (picture, report) = render(&compiled, &Settings::new(640, 480, 64), &Silent);
    let develop = Develop {
        tonemap: ToneMap::Neutral,
        ..Develop::default()
    };
    let layers = Layers::from_rgb(640, 480, picture.rgb);
    write(Path::new("load_gltf.png"), &layers, &develop, &serde_json::Value::Null)?;
    println!("{:.1} s, anomalies: {:?}", report.seconds, report.anomalies);
    Ok(())
}
