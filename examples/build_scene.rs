//! A scene built in Rust instead of text: a row of spheres from rough to smooth under a lamp.
//! `cargo run --release --example build_scene` writes `build_scene.png`.

use glam::DVec3;
use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::output::{Develop, Layers, write};
use pts::render::{driver::render, report::Silent, settings::Settings};
use pts::scene::{Camera, EnvironmentKind, Material, Object, Scene, Shape, SurfaceModel};
use std::path::Path;

fn ball(x: f64, radius: f64) -> Object {
    let center = DVec3::new(x, radius, 0.0);
    Object::new(Shape::Sphere { center, radius })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::default();
    scene.cameras.push(Camera {
        location: DVec3::new(0.0, 1.2, -8.0),
        ..Camera::default()
    });
    scene.active_camera = Some(0);
    scene.environment.kind = EnvironmentKind::Constant(DVec3::new(0.5, 0.55, 0.6));

    let floor = scene.add_material(Material::diffuse(DVec3::splat(0.5)));
    let (normal, distance) = (DVec3::Y, 0.0);
    let ground = Object::new(Shape::Plane { normal, distance });
    scene.objects.push(ground.with_material(floor));
    for i in 0..5 {
        let gold = SurfaceModel::Glossy {
            color: DVec3::new(1.0, 0.71, 0.29).into(),
            roughness: (0.05 + 0.2 * f64::from(i)).into(),
            ior: 1.5,
            metal: true,
        };
        let gold = scene.add_material(Material::new(gold));
        scene
            .objects
            .push(ball(f64::from(i - 2) * 1.3, 0.6).with_material(gold));
    }
    let lamp = scene.add_material(Material::diffuse(DVec3::ZERO).emitting(DVec3::splat(15.0)));
    let above = glam::DAffine3::from_translation(DVec3::new(2.0, 5.0, -3.0));
    scene
        .objects
        .push(ball(0.0, 0.8).with_material(lamp).transformed(above));

    let (files, mut diags) = (MemoryFiles::default(), Diagnostics::default());
    let compiled = pts::compile::compile(&scene, &files, 640, 480, &mut diags).ok_or("cannot be drawn")?;
    let (picture, _) = render(&compiled, &Settings::new(640, 480, 64), &Silent);
    let layers = Layers::from_rgb(640, 480, picture.rgb);
    write(
        Path::new("build_scene.png"),
        &layers,
        &Develop::default(),
        &serde_json::Value::Null,
    )?;
    Ok(())
}
