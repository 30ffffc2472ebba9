//! From the flags to a scene that is ready to compile: reading, replacing camera and light, framing bare models.

use super::args::{LoadArgs, ViewArgs};
use super::camera::{self, CameraChoice};
use super::console::Console;
use crate::diag::{Diagnostic, Diagnostics, SourceMap};
use crate::files::{DiskFiles, Files};
use crate::import::framing;
use crate::import::gltf::Glass;
use crate::load::{self, LoadOptions, STDIN_NAME, StdinFiles};
use crate::scene::{Environment, EnvironmentKind, Handedness, Image, ImageId, ImageSource, Place, Scene};
use glam::{DMat3, DVec3};
use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The names of commands, for those who misspell them.
const COMMANDS: [&str; 6] = ["render", "check", "inspect", "compare", "merge", "study"];

/// The files of the machine, with standard input among them where the scene is `-`, and the scene's path therein.
pub fn open(scene: &Path) -> std::io::Result<(StdinFiles<DiskFiles>, PathBuf)> {
    let mut stdin = Vec::new();
    let is_stdin = scene == Path::new("-");
    if is_stdin {
        std::io::stdin().lock().read_to_end(&mut stdin)?;
    }
    let path = if is_stdin { Path::new(STDIN_NAME) } else { scene };
    Ok((StdinFiles::new(DiskFiles::default(), stdin), path.to_owned()))
}

/// What the front ends are told by the flags; `size` is what the command line says of the picture's size.
pub fn load_options(args: &LoadArgs, size: [Option<u32>; 2]) -> LoadOptions {
    let installed = std::env::var_os("POVINC").unwrap_or_default();
    LoadOptions {
        include_dirs: include_dirs(&args.include, &installed),
        defines: args.define.clone(),
        width: size[0],
        height: size[1],
        clock: args.moment.map_or(args.clock, |m| Some(m.frame.clock)),
        shutter: args.moment.and_then(|m| m.shutter).or(args.shutter),
        frame: args.moment.map(|m| m.frame),
        gltf_scene: args.gltf_scene.clone(),
        allow_outside: args.allow_outside,
        animation: args.animation.clone(),
        glass: args.glass.map_or(Glass::AsWritten, |g| g.glass()),
        variant: args.variant.clone(),
    }
}

/// The directories of `-I`, then those of POV-Ray's variable.
fn include_dirs(flags: &[PathBuf], installed: &OsStr) -> Vec<PathBuf> {
    let installed = std::env::split_paths(installed).filter(|dir| !dir.as_os_str().is_empty());
    flags.iter().cloned().chain(installed).collect()
}

/// Reads a scene. A file that cannot even be looked at is told in the same words for all kinds.
pub fn read(
    path: &Path,
    files: &dyn Files,
    options: &LoadOptions,
    sources: &mut SourceMap,
    diags: &mut Diagnostics,
) -> Option<Scene> {
    if path != Path::new(STDIN_NAME)
        && let Err(error) = std::fs::File::open(path)
    {
        let mut diagnostic = load::unreadable(path, &error, files);
        // `pts chekc a.pts` reads as the scene `chekc`.
        let word = path.to_string_lossy();
        if let Some(command) = COMMANDS.iter().find(|c| strsim::damerau_levenshtein(c, &word) <= 2) {
            diagnostic = diagnostic.hint(format!("if you mean the command: pts {command} SCENE"));
        }
        diags.push(diagnostic);
        return None;
    }
    load::load(path, files, options, sources, diags)
}

/// Chooses the camera that is named, before the size of the picture is decided by it.
pub fn select_camera(scene: &mut Scene, view: &ViewArgs, diags: &mut Diagnostics) {
    if let Some(CameraChoice::Name(name)) = &view.camera {
        camera::select(scene, name, diags);
    }
}

/// Replaces light and camera as asked and adds what a bare model lacks.
pub fn finish(scene: &mut Scene, view: &ViewArgs, size: [u32; 2], console: &Console, diags: &mut Diagnostics) {
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    // Before framing, which adds light only where there is none; and again after it, for those who want darkness.
    replace_environment(scene, view);
    let environment = scene.environment.clone();
    if scene.handedness == Handedness::Right || scene.active_camera.is_none() {
        framing::frame(scene, aspect)
            .into_iter()
            .for_each(|note| diags.push(note));
    }
    if view.env_color.is_some() || view.env_map.is_some() {
        scene.environment = environment;
    }
    adjust_environment(scene, view, diags);
    if let Some(factor) = view.light_scale {
        scale_lights(scene, factor);
    }
    if let Some(CameraChoice::Spec(spec)) = &view.camera {
        let base = scene.camera().cloned().unwrap_or_default();
        if let Some(camera) = camera::apply(spec, &base, aspect, diags) {
            console.detail(&format!("camera: {camera:?}"));
            scene.cameras.push(camera);
            scene.active_camera = Some(scene.cameras.len() - 1);
        }
    }
}

/// `--env-color` and `--env-map`: a new environment that lights the scene, whatever the old one did.
fn replace_environment(scene: &mut Scene, view: &ViewArgs) {
    let kind = if let Some([r, g, b]) = view.env_color {
        EnvironmentKind::Constant(DVec3::new(r, g, b))
    } else if let Some(path) = &view.env_map {
        scene.images.push(Image {
            name: path.display().to_string(),
            source: ImageSource::File(path.clone()),
            fallback: None,
            place: Place::None,
        });
        EnvironmentKind::Image {
            image: ImageId(scene.images.len() as u32 - 1),
            strength: 1.0,
            rotation: DMat3::IDENTITY,
        }
    } else {
        return;
    };
    scene.environment = Environment {
        kind,
        ..Environment::default()
    };
}

/// `--env-rotate` and `--env-strength`, for whatever environment there is by now.
fn adjust_environment(scene: &mut Scene, view: &ViewArgs, diags: &mut Diagnostics) {
    let is_right_handed = scene.handedness == Handedness::Right;
    if let Some(factor) = view.env_strength {
        match &mut scene.environment.kind {
            EnvironmentKind::Black => {}
            EnvironmentKind::Constant(radiance) => *radiance *= factor,
            EnvironmentKind::Image { strength, .. } => *strength *= factor,
        }
        scene.environment.backdrop.iter_mut().for_each(|b| *b *= factor);
        if scene.environment.kind == EnvironmentKind::Black {
            diags.push(Diagnostic::note(
                "C0004",
                "--env-strength has no effect: the environment is black",
            ));
        }
    }
    let Some(degrees) = view.env_rotate else { return };
    match &mut scene.environment.kind {
        EnvironmentKind::Image { rotation, .. } => {
            // To the right from −z is the other way round than from +z.
            let angle = degrees.to_radians() * if is_right_handed { -1.0 } else { 1.0 };
            *rotation = DMat3::from_rotation_y(angle) * *rotation;
        }
        _ => {
            let note = Diagnostic::note("C0004", "--env-rotate has no effect: the environment is no image");
            diags.push(note.hint("give one with --env-map FILE"));
        }
    }
}

/// `--light-scale`: lamps and emitting surfaces, so that a light can be weighed against the environment.
fn scale_lights(scene: &mut Scene, factor: f64) {
    for light in &mut scene.lights {
        light.color *= factor;
    }
    for material in &mut scene.materials {
        material.emission.factor *= factor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Falloff, Light, LightKind, Material};

    fn view() -> ViewArgs {
        ViewArgs {
            camera: None,
            env_color: None,
            env_map: None,
            env_rotate: None,
            env_strength: None,
            light_scale: None,
        }
    }

    #[test]
    fn the_directories_of_flags_come_before_those_of_the_environment() {
        let installed = std::env::join_paths(["c", "d"]).unwrap();
        let dirs = include_dirs(&["b".into(), "a".into()], &installed);
        assert_eq!(dirs, ["b", "a", "c", "d"].map(PathBuf::from));
        assert!(include_dirs(&[], OsStr::new("")).is_empty());
    }

    #[test]
    fn a_new_environment_lights_the_scene_even_if_the_old_one_did_not() {
        let mut scene = Scene::default();
        scene.environment.illuminates = false;
        scene.environment.backdrop = Some(DVec3::ONE);
        let view = ViewArgs {
            env_map: Some("sky.hdr".into()),
            ..view()
        };
        replace_environment(&mut scene, &view);
        assert!(scene.environment.illuminates && scene.environment.backdrop.is_none());
        assert!(matches!(
            scene.environment.kind,
            EnvironmentKind::Image { image: ImageId(0), .. }
        ));
    }

    /// What is in the middle of the image is seen to the right of where it was, in both kinds of worlds.
    #[test]
    fn a_quarter_turn_of_the_environment_takes_its_middle_to_the_right() {
        for (handedness, middle) in [(Handedness::Left, DVec3::Z), (Handedness::Right, DVec3::NEG_Z)] {
            let mut scene = Scene {
                handedness,
                ..Scene::default()
            };
            scene.environment.kind = EnvironmentKind::Image {
                image: ImageId(0),
                strength: 1.5,
                rotation: DMat3::IDENTITY,
            };
            let view = ViewArgs {
                env_rotate: Some(90.0),
                env_strength: Some(2.0),
                ..view()
            };
            adjust_environment(&mut scene, &view, &mut Diagnostics::default());
            let EnvironmentKind::Image { strength, rotation, .. } = scene.environment.kind else {
                panic!("{:?}", scene.environment);
            };
            assert_eq!(strength, 3.0);
            // A quarter turn in radians is rounded once.
            assert!((rotation * middle - DVec3::X).length() < 1e-15, "{rotation}");
        }
    }

    #[test]
    fn a_turn_of_no_image_is_told() {
        let mut scene = Scene::default();
        let view = ViewArgs {
            env_rotate: Some(90.0),
            env_strength: Some(2.0),
            ..view()
        };
        let mut diags = Diagnostics::default();
        adjust_environment(&mut scene, &view, &mut diags);
        assert_eq!(diags.iter().count(), 2);
        scene.environment.kind = EnvironmentKind::Constant(DVec3::ONE);
        adjust_environment(&mut scene, &view, &mut Diagnostics::default());
        assert_eq!(scene.environment.kind, EnvironmentKind::Constant(DVec3::splat(2.0)));
    }

    #[test]
    fn the_light_scale_reaches_lamps_and_emission_but_not_the_environment() {
        let mut scene = Scene::default();
        scene.environment.kind = EnvironmentKind::Constant(DVec3::ONE);
        scene.lights.push(Light {
            name: String::new(),
            color: DVec3::ONE,
            kind: LightKind::Point {
                position: DVec3::ZERO,
                falloff: Falloff::None,
            },
            casts_shadows: true,
            motion: Vec::new(),
            place: Place::None,
        });
        let mut material = Material::diffuse(DVec3::ONE);
        material.emission.factor = DVec3::splat(2.0);
        scene.add_material(material);
        scale_lights(&mut scene, 3.0);
        assert_eq!(scene.lights[0].color, DVec3::splat(3.0));
        assert_eq!(scene.materials[0].emission.factor, DVec3::splat(6.0));
        assert_eq!(scene.environment.kind, EnvironmentKind::Constant(DVec3::ONE));
    }
}
