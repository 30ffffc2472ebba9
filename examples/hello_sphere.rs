//! The shortest way to a picture: a scene as text in memory, rendered and written.
//! `cargo run --release --example hello_sphere` writes `hello_sphere.png`.

use pts::diag::{Diagnostics, SourceMap};
use pts::files::MemoryFiles;
use pts::load::{LoadOptions, load};
use pts::output::{Develop, Layers, write};
use pts::render::driver::render;
use pts::render::report::Silent;
use pts::render::settings::Settings;
use std::path::Path;

const SCENE: &str = "
camera { location <0, 1, -4> look_at <0, 0.8, 0> angle 40 }
environment { color rgb <0.6, 0.75, 1> }
sphere { <3, 5, -3>, 1 material { diffuse { color rgb 0 } emission rgb 20 } }
plane { y, 0 material { diffuse { color rgb 0.5 } } }
sphere { <0, 0.8, 0>, 0.8 material { glossy { color rgb <0.9, 0.2, 0.1> roughness 0.2 ior 1.5 } } }
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut files = MemoryFiles::default();
    files.insert("hello.pts", SCENE.as_bytes());
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load(
        Path::new("hello.pts"),
        &files,
        &LoadOptions::default(),
        &mut sources,
        &mut diags,
    );
    let scene = scene.ok_or("the scene has errors")?;
    let compiled = pts::compile::compile(&scene, &files, 400, 300, &mut diags).ok_or("the scene cannot be drawn")?;
    let (picture, report) = render(&compiled, &Settings::new(400, 300, 64), &Silent);
    let layers = Layers::from_rgb(400, 300, picture.rgb);
    write(
        Path::new("hello_sphere.png"),
        &layers,
        &Develop::default(),
        &serde_json::Value::Null,
    )?;
    println!(
        "{} samples in {:.1} s, error {:?}",
        report.samples, report.seconds, report.error
    );
    Ok(())
}
