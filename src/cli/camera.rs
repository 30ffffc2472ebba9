//! `--camera`: a camera of the scene by name, or one made from numbers.

use crate::diag::{Diagnostic, Diagnostics};
use crate::scene::{Aspect, Camera, Projection, Scene};
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// What `--camera` asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraChoice {
    /// The camera of the scene with this name, or with this number, counted from 0, if no name fits.
    Name(String),
    /// The scene's camera with some of its numbers replaced.
    Spec(CameraSpec),
}

/// The numbers of a camera; what is `None` stays as in the scene's camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraSpec {
    /// Where it stands.
    pub location: Option<DVec3>,
    /// The point in the centre of the picture.
    pub look_at: Option<DVec3>,
    /// Upwards; world y by default.
    pub sky: Option<DVec3>,
    /// Horizontal field of view in degrees, in (0, 180).
    pub angle_deg: Option<f64>,
}

impl FromStr for CameraChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<CameraChoice, String> {
        if !text.contains('=') {
            return match text.trim() {
                "" => Err("expected a camera's name or \"location=x,y,z look_at=x,y,z angle=degrees\"".to_owned()),
                name => Ok(CameraChoice::Name(name.to_owned())),
            };
        }
        let mut spec = CameraSpec::default();
        for part in text.split_whitespace() {
            let (key, value) = part
                .split_once('=')
                .ok_or_else(|| format!("`{part}` is not key=value (no blanks inside a vector)"))?;
            match key {
                "location" => spec.location = Some(vector(value)?),
                "look_at" => spec.look_at = Some(vector(value)?),
                "sky" => spec.sky = Some(vector(value)?),
                "angle" => spec.angle_deg = Some(angle(value)?),
                _ => return Err(format!("`{key}` is not one of location, look_at, sky and angle")),
            }
        }
        Ok(CameraChoice::Spec(spec))
    }
}

impl fmt::Display for CameraChoice {
    /// The text from which the same choice is parsed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let spec = match self {
            CameraChoice::Name(name) => return f.write_str(name),
            CameraChoice::Spec(spec) => spec,
        };
        let vectors = [
            ("location", spec.location),
            ("look_at", spec.look_at),
            ("sky", spec.sky),
        ];
        let vectors = vectors.into_iter().filter_map(|(key, v)| Some((key, v?)));
        let mut parts: Vec<String> = vectors
            .map(|(key, v)| format!("{key}={},{},{}", v.x, v.y, v.z))
            .collect();
        parts.extend(spec.angle_deg.map(|degrees| format!("angle={degrees}")));
        f.write_str(&parts.join(" "))
    }
}

fn vector(text: &str) -> Result<DVec3, String> {
    let wrong = || format!("`{text}` is not a vector; write x,y,z without blanks");
    let inner = text.trim_start_matches('<').trim_end_matches('>');
    let parts: Vec<f64> = inner
        .split(',')
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_| wrong())?;
    match parts[..] {
        [x, y, z] if DVec3::new(x, y, z).is_finite() => Ok(DVec3::new(x, y, z)),
        _ => Err(wrong()),
    }
}

fn angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err(format!("`{text}` is not an angle between 0 and 180 degrees")),
    }
}

/// Makes the named camera the active one, or reports which ones there are.
pub fn select(scene: &mut Scene, name: &str, diags: &mut Diagnostics) {
    let by_name = scene.cameras.iter().position(|c| c.name == name);
    let by_number = || name.parse::<usize>().ok().filter(|i| *i < scene.cameras.len());
    if let Some(index) = by_name.or_else(by_number) {
        scene.active_camera = Some(index);
        return;
    }
    let found = format!("there is no camera `{name}`");
    let names: Vec<&str> = scene
        .cameras
        .iter()
        .map(|c| c.name.as_str())
        .filter(|n| !n.is_empty())
        .collect();
    let hint = match (names.len(), scene.cameras.len()) {
        (_, 0) => "the scene has no cameras; give numbers: --camera \"location=x,y,z look_at=x,y,z\"".to_owned(),
        (0, n) => format!("its cameras have no names; choose one by number, 0 to {}", n - 1),
        _ => format!("its cameras are: {}", names.join(", ")),
    };
    diags.push(Diagnostic::error("C0001", found).hint(hint));
}

/// Replaces numbers of `base`; `aspect` is the picture's width divided by its height.
/// The image plane keeps its shape and its handedness. `None` if it was reported why there is no such camera.
pub fn apply(spec: &CameraSpec, base: &Camera, aspect: f64, diags: &mut Diagnostics) -> Option<Camera> {
    let mut camera = base.clone();
    camera.motion.clear(); // what is given in numbers stands still
    camera.location = spec.location.unwrap_or(base.location);
    if spec.look_at.is_some() || spec.sky.is_some() {
        let towards = spec.look_at.map_or(base.direction, |at| at - camera.location);
        if towards.try_normalize().is_none() {
            let error = Diagnostic::error("C0002", "--camera looks at the point where it stands");
            diags.push(error.hint("give a look_at that differs from location"));
            return None;
        }
        aim(&mut camera, base, towards.normalize(), spec.sky);
    }
    if let Some(at) = spec.look_at {
        camera.focus_distance = camera.location.distance(at);
    }
    if let Some(degrees) = spec.angle_deg {
        if camera.projection == Projection::Orthographic {
            let message = "--camera angle=… has no meaning for an orthographic camera";
            diags.push(Diagnostic::error("C0003", message).hint("leave the angle out"));
            return None;
        }
        let width = match camera.aspect {
            Aspect::AsWritten => camera.right.length(),
            Aspect::FromImage => camera.up.length() * aspect,
        };
        camera.direction = camera.direction.normalize() * (0.5 * width / (0.5 * degrees.to_radians()).tan());
    }
    Some(camera)
}

/// Turns `camera` to the unit vector `ahead` with `sky` as close to upwards as can be. The lengths of the three
/// vectors stay.
fn aim(camera: &mut Camera, base: &Camera, ahead: DVec3, sky: Option<DVec3>) {
    // Straight up or down, world y says nothing; the scene's own camera or an axis does.
    let candidates = [sky.unwrap_or(DVec3::Y), base.up, base.direction, DVec3::Z, DVec3::X];
    let across = candidates.iter().find_map(|sky| {
        let across = sky.normalize_or_zero().cross(ahead);
        // The sine of the angle between two unit vectors: below this, rounding decides the direction.
        (across.length() > 1e-9).then(|| across.normalize())
    });
    let across = across.unwrap_or(DVec3::X);
    // +1 where right = up × direction (left-handed worlds), −1 where it is the opposite.
    let side = base.up.cross(base.direction).dot(base.right).signum();
    camera.direction = ahead * base.direction.length();
    camera.right = across * (side * base.right.length());
    camera.up = ahead.cross(across).normalize() * base.up.length();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(text: &str) -> CameraSpec {
        match text.parse() {
            Ok(CameraChoice::Spec(spec)) => spec,
            other => panic!("{text} is {other:?}"),
        }
    }

    #[allow(clippy::result_large_err)] // tests want to see it
    fn apply(spec: &CameraSpec, base: &Camera, aspect: f64) -> Result<Camera, Diagnostic> {
        let mut diags = Diagnostics::default();
        let camera = super::apply(spec, base, aspect, &mut diags);
        camera.ok_or_else(|| diags.iter().next().cloned().expect("a refusal has a reason"))
    }

    /// A camera as glTF has it: looks along −z, x to the right, y up, right-handed.
    fn gltf_camera() -> Camera {
        Camera {
            direction: DVec3::NEG_Z,
            right: DVec3::X,
            aspect: Aspect::FromImage,
            ..Camera::default()
        }
    }

    #[test]
    fn a_word_is_a_name_and_keys_are_numbers() {
        assert_eq!("Main".parse(), Ok(CameraChoice::Name("Main".into())));
        let spec = spec("location=1,2,-3 look_at=<0,0,0> angle=90");
        assert_eq!(spec.location, Some(DVec3::new(1.0, 2.0, -3.0)));
        assert_eq!(spec.look_at, Some(DVec3::ZERO));
        let again = CameraChoice::Spec(spec).to_string();
        assert_eq!(again, "location=1,2,-3 look_at=0,0,0 angle=90");
        for wrong in [
            "",
            "location=1,2",
            "place=1,2,3",
            "angle=180",
            "angle=0",
            "location=1,nan,2",
            "angle=1 x",
        ] {
            assert!(wrong.parse::<CameraChoice>().is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn looking_where_the_camera_looks_already_changes_nothing() {
        for (base, text) in [(Camera::default(), "look_at=0,0,5"), (gltf_camera(), "look_at=0,0,-5")] {
            let camera = apply(&spec(text), &base, 1.0).unwrap();
            for (found, expected) in [
                (camera.direction, base.direction),
                (camera.right, base.right),
                (camera.up, base.up),
            ] {
                assert!(found.distance(expected) < 1e-15, "{found} instead of {expected}");
            }
        }
    }

    #[test]
    fn a_turned_camera_keeps_handedness_and_shape() {
        for base in [Camera::default(), gltf_camera()] {
            for at in ["3,1,2", "0,-7,0", "0,7,0", "-1,-1,-1"] {
                let camera = apply(&spec(&format!("look_at={at}")), &base, 1.0).unwrap();
                let volume = |c: &Camera| c.up.cross(c.direction).dot(c.right);
                assert!((volume(&camera) - volume(&base)).abs() < 1e-12, "{at}: {camera:?}");
                assert!(camera.up.y >= 0.0, "{at} turned the camera upside down: {}", camera.up);
            }
        }
    }

    #[test]
    fn the_angle_is_that_of_the_pictures_width() {
        let half = 30f64.to_radians().tan();
        let pov = apply(&spec("angle=60"), &Camera::default(), 2.0).unwrap();
        assert!((0.5 * pov.right.length() / pov.direction.length() - half).abs() < 1e-12);
        let gltf = apply(&spec("angle=60"), &gltf_camera(), 2.0).unwrap();
        assert!((0.5 * 2.0 * gltf.up.length() / gltf.direction.length() - half).abs() < 1e-12);
    }

    #[test]
    fn a_camera_cannot_look_at_itself() {
        let camera = apply(&spec("location=1,1,1 look_at=1,1,1"), &Camera::default(), 1.0);
        assert_eq!(camera.unwrap_err().code, "C0002");
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let mut scene = Scene::default();
        for name in ["Front", "Back"] {
            scene.cameras.push(Camera {
                name: name.into(),
                ..Camera::default()
            });
        }
        let mut diags = Diagnostics::default();
        select(&mut scene, "Back", &mut diags);
        assert!(diags.is_empty());
        assert_eq!(scene.active_camera, Some(1));
        select(&mut scene, "Side", &mut diags);
        let hints: Vec<_> = diags.iter().flat_map(|d| &d.hints).collect();
        assert!(hints[0].contains("Front, Back"), "{hints:?}");
    }
}
