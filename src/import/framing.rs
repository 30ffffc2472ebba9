//! What a bare model lacks: a camera that shows all of it, and light.

mod studio;
mod support;

use crate::diag::Diagnostic;
use crate::scene::{
    Aspect, Camera, Environment, EnvironmentKind, Handedness, Image, ImageSource, Place, Projection, Scene,
};
use glam::{DMat3, DVec3};

/// Vertical field of view (the smaller one of a picture in portrait format): a 50 mm lens on a 35 mm film, cropped a
/// little.
const FIELD_OF_VIEW: f64 = 35.0;
/// Share of the picture that the model may fill.
const FILL: f64 = 0.92;

/// The box around all finite shapes that the camera can see, in world space: lower and upper corner. Exact for every
/// shape under every transform; only crowds of instances beyond some ten million vertices are bounded by their boxes.
/// Planes are left out. `None` if nothing is left.
pub fn bounds(scene: &Scene) -> Option<(DVec3, DVec3)> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let [x, y, z, nx, ny, nz] = support::farthest(scene, axes)?;
    Some((-DVec3::new(nx, ny, nz), DVec3::new(x, y, z)))
}

/// Whether a material of the scene lights it. A texture of at most 1 is a display or a decal, which only glows
/// itself.
pub fn emits(scene: &Scene) -> bool {
    let lights = |m: &crate::scene::Material| {
        if m.unlit {
            return false; // shows a colour, lights nothing
        }
        let most = m.emission.factor.max_element();
        most > 1.0 || (most > 0.0 && m.emission.texture.is_none())
    };
    scene.materials.iter().any(lights)
}

/// Gives a scene without camera a three-quarter view of all of it, for a picture of this width/height, and a scene
/// without lamps, environment and emission the light of a small studio. Returns a note of what was added, if anything
/// was.
pub fn frame(scene: &mut Scene, aspect: f64) -> Option<Diagnostic> {
    let aspect = if aspect > 0.0 && aspect.is_finite() {
        aspect
    } else {
        4.0 / 3.0
    };
    let mut added = Vec::new();
    let mut hint = None;
    if scene.camera().is_none() {
        if scene.cameras.is_empty() {
            let camera = choose_camera(scene, aspect);
            hint = Some(camera_as_option(&camera));
            scene.cameras.push(camera);
            added.push("a camera that shows all of it");
        }
        scene.active_camera = Some(0);
    }
    let is_dark = scene.environment.kind == EnvironmentKind::Black && scene.lights.is_empty() && !emits(scene);
    if is_dark {
        let rotation = toward_camera(scene);
        let image = scene.add_image(Image {
            name: "studio".to_owned(),
            source: ImageSource::Pixels {
                width: studio::WIDTH,
                height: studio::HEIGHT,
                data: studio::picture().into(),
            },
            fallback: None,
            place: Place::None,
        });
        scene.environment = Environment {
            kind: EnvironmentKind::Image {
                image,
                strength: 1.0,
                rotation,
            },
            backdrop: Some(DVec3::splat(studio::BACKDROP)),
            ..Environment::default()
        };
        added.push("the light of a studio");
    }
    if added.is_empty() {
        return None;
    }
    let note = Diagnostic::note(
        "F0001",
        format!("the scene brings none, so this was added: {}", added.join(", ")),
    );
    Some(match hint {
        Some(hint) => note.hint(hint),
        None => note,
    })
}

/// A three-quarter view from the front right, slightly above.
fn choose_camera(scene: &Scene, aspect: f64) -> Camera {
    let (min, max) = bounds(scene).unwrap_or((DVec3::NEG_ONE, DVec3::ONE));
    let (size, center) = (max - min, min * 0.5 + max * 0.5);
    let (azimuth, elevation) = view_angles(size);
    let front = match scene.handedness {
        Handedness::Left => -1.0,
        Handedness::Right => 1.0,
    };
    let (sin, cos) = azimuth.sin_cos();
    let to_camera = DVec3::new(sin * elevation.cos(), elevation.sin(), front * cos * elevation.cos());
    let direction = -to_camera;
    let right = direction.cross(DVec3::Y).normalize() * front;
    let up = right.cross(direction) * front;

    let half = (FIELD_OF_VIEW.to_radians() / 2.0).tan();
    let half_height = if aspect >= 1.0 { half } else { half / aspect };
    let half_width = half_height * aspect;
    let location = fit(
        scene,
        center,
        size,
        [direction, right, up],
        half_width * FILL,
        half_height * FILL,
    );
    Camera {
        name: "framing".to_owned(),
        location,
        direction,
        right: right * (2.0 * half_width),
        up: up * (2.0 * half_height),
        aspect: Aspect::FromImage,
        projection: Projection::Perspective,
        lens_radius: 0.0,
        focus_distance: (center - location).dot(direction).max(f64::MIN_POSITIVE),
        motion: Vec::new(),
        place: Place::None,
    }
}

/// Azimuth from the front and elevation, radians. What lies flat is seen from higher up, what is a thin slab facing
/// sideways from further round.
fn view_angles(size: DVec3) -> (f64, f64) {
    let thinness = |thin: f64, wide: f64| {
        if wide > 0.0 {
            (1.0 - 4.0 * thin / wide).max(0.0)
        } else {
            0.0
        }
    };
    let azimuth = 30.0 + 35.0 * thinness(size.x, size.z);
    let elevation = 17.0 + 23.0 * thinness(size.y, size.x.max(size.z));
    (azimuth.to_radians(), elevation.to_radians())
}

/// The place from which everything lies inside the pyramid of view, as near as possible. `half_*` are the tangents
/// of its half angles. A side plane of the pyramid through the camera at (x, z) holds all points if
/// x − half·z ≥ h, h being the farthest that any point lies along the plane's normal; the two planes of a pair
/// meet at the answer.
fn fit(scene: &Scene, center: DVec3, size: DVec3, axes: [DVec3; 3], half_width: f64, half_height: f64) -> DVec3 {
    let [direction, right, up] = axes;
    let normals = [
        right - direction * half_width,
        -right - direction * half_width,
        up - direction * half_height,
        -up - direction * half_height,
    ];
    let origin = normals.map(|n| n.dot(center));
    let radius = if size == DVec3::ZERO { 1.0 } else { size.length() / 2.0 };
    // Relative to the centre, so that a model far from the origin is framed as one at it.
    let h = support::farthest(scene, normals).map_or([radius; 4], |h| std::array::from_fn(|i| h[i] - origin[i]));
    let (x, back_x) = ((h[0] - h[1]) / 2.0, (h[0] + h[1]) / (2.0 * half_width));
    let (y, back_y) = ((h[2] - h[3]) / 2.0, (h[2] + h[3]) / (2.0 * half_height));
    // A needle that points at the camera would let it come too close.
    let back = back_x.max(back_y).max(1.2 * radius);
    center + right * x + up * y - direction * back
}

/// The rotation that turns the middle of the environment's picture to where the camera looks, about the vertical.
fn toward_camera(scene: &Scene) -> DMat3 {
    let Some(camera) = scene.camera() else {
        return DMat3::IDENTITY;
    };
    // A camera that looks straight down has its picture's top ahead.
    let flat = |v: DVec3| DVec3::new(v.x, 0.0, v.z).try_normalize();
    let level = camera.direction.normalize_or_zero();
    let ahead = flat(level)
        .filter(|_| level.y.abs() < 0.999)
        .or(flat(camera.up))
        .unwrap_or(DVec3::Z);
    let middle = match scene.handedness {
        Handedness::Left => 1.0,
        Handedness::Right => -1.0,
    };
    DMat3::from_rotation_y((middle * ahead.x).atan2(middle * ahead.z))
}

/// The chosen camera as the command line takes it, to start from.
fn camera_as_option(camera: &Camera) -> String {
    let angle = 2.0 * (camera.right.length() / 2.0).atan().to_degrees();
    let target = camera.location + camera.direction * camera.focus_distance;
    let digits = |v: DVec3| format!("{},{},{}", rounded(v.x), rounded(v.y), rounded(v.z));
    let (location, target) = (digits(camera.location), digits(target));
    format!("to choose another view, start from --camera \"location={location} look_at={target} angle={angle:.1}\"")
}

/// Five significant digits.
fn rounded(v: f64) -> f64 {
    format!("{v:.4e}").parse().unwrap_or(v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Object, Shape};
    use glam::DAffine3;

    fn scene_of(shape: Shape, transform: DAffine3, handedness: Handedness) -> Scene {
        let mut scene = Scene {
            handedness,
            ..Scene::default()
        };
        scene.objects.push(Object::new(shape).transformed(transform));
        scene
    }

    fn cloud(spread: DVec3) -> Vec<DVec3> {
        let share = |i: u32, p: u32| f64::from(i * p % 97) / 97.0 - 0.5;
        (0..90)
            .map(|i| DVec3::new(share(i, 31), share(i, 17), share(i, 57)) * spread)
            .collect()
    }

    /// Picture coordinates in [−1, 1] of a point in front of the camera.
    fn project(camera: &Camera, p: DVec3) -> (f64, f64) {
        let v = p - camera.location;
        let depth = v.dot(camera.direction) / camera.direction.length_squared();
        assert!(depth > 0.0, "{p} is behind the camera");
        let along = |axis: DVec3| 2.0 * v.dot(axis) / (axis.length_squared() * depth);
        (along(camera.right), along(camera.up))
    }

    #[test]
    fn models_of_every_size_shape_and_place_fill_the_picture_and_stay_inside() {
        let spreads = [
            DVec3::ONE,
            DVec3::new(1.0, 1e-3, 1.0),
            DVec3::new(1e-4, 2.0, 3.0),
            DVec3::new(0.01, 9.0, 0.02),
        ];
        let mut seen = 0;
        for (spread, scale) in spreads.iter().flat_map(|s| [1e-6, 1.0, 1e7].map(|k| (*s, k))) {
            for (hand, aspect) in [(Handedness::Left, 1.5), (Handedness::Right, 0.6)] {
                let points: Vec<DVec3> = cloud(spread * scale).iter().map(|p| *p + 3.0 * scale).collect();
                let faces: Vec<[u32; 3]> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                let mut scene = Scene {
                    handedness: hand,
                    ..Scene::default()
                };
                let mesh = scene.add_mesh(Mesh::from_f64("cloud", &points, &faces).unwrap());
                scene.objects.push(Object::new(Shape::Mesh(mesh)));
                assert!(frame(&mut scene, aspect).is_some());
                let camera = scene.camera().unwrap();
                let mut most = 0.0f64;
                for p in &points {
                    let (x, y) = project(camera, *p);
                    most = most.max(x.abs()).max(y.abs());
                }
                assert!(most <= FILL + 1e-5, "{spread} {scale}: {most}");
                assert!(most >= FILL - 1e-5, "{spread} {scale}: {most}");
                assert!((camera.right.length() / camera.up.length() - aspect).abs() < 1e-12);
                seen += 1;
            }
        }
        assert_eq!(seen, 24);
    }

    #[test]
    fn a_mirrored_world_shows_the_same_picture() {
        let make = |hand, z| {
            let points: Vec<DVec3> = cloud(DVec3::new(1.0, 2.0, 0.7))
                .iter()
                .map(|p| *p * DVec3::new(1.0, 1.0, z))
                .collect();
            let mut scene = Scene {
                handedness: hand,
                ..Scene::default()
            };
            let mesh = scene.add_mesh(Mesh::from_f64("", &points, &[[0, 1, 2], [3, 4, 5]]).unwrap());
            scene.objects.push(Object::new(Shape::Mesh(mesh)));
            frame(&mut scene, 1.2);
            let camera = scene.camera().unwrap().clone();
            points.iter().map(|p| project(&camera, *p)).collect::<Vec<_>>()
        };
        for (l, r) in make(Handedness::Left, -1.0).iter().zip(make(Handedness::Right, 1.0)) {
            assert!((l.0 - r.0).abs() < 1e-9 && (l.1 - r.1).abs() < 1e-9);
        }
    }

    #[test]
    fn the_studio_turns_with_the_camera() {
        for (hand, middle) in [(Handedness::Left, DVec3::Z), (Handedness::Right, DVec3::NEG_Z)] {
            let sphere = Shape::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
            };
            let mut scene = scene_of(sphere, DAffine3::IDENTITY, hand);
            frame(&mut scene, 1.0);
            let EnvironmentKind::Image { rotation, .. } = scene.environment.kind else {
                panic!("no studio");
            };
            let ahead = scene.camera().unwrap().direction;
            let ahead = DVec3::new(ahead.x, 0.0, ahead.z).normalize();
            assert!((rotation * middle - ahead).length() < 1e-12, "{hand:?}");
        }
    }

    #[test]
    fn nothing_is_added_to_a_scene_that_has_camera_and_light() {
        let mut scene = scene_of(
            Shape::Plane {
                normal: DVec3::Y,
                distance: 0.0,
            },
            DAffine3::IDENTITY,
            Handedness::Left,
        );
        scene.cameras.push(Camera::default());
        scene.active_camera = Some(0);
        scene.add_material(Material::diffuse(DVec3::ZERO).emitting(DVec3::ONE));
        assert_eq!(frame(&mut scene, 1.0), None);
        assert_eq!(bounds(&scene), None);
        assert_eq!((scene.cameras.len(), scene.images.len()), (1, 0));
    }
}
