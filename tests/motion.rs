//! Motion blur against closed forms, against itself seen from elsewhere, and against still pictures of every moment.
//! Seeds are fixed; where noise decides, the rate of false alarms is stated.

mod support;

use glam::{DAffine3, DVec3};
use pts::compile::compile_with;
use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::render::driver;
use pts::render::report::{Picture, Silent};
use pts::render::settings::Settings;
use pts::render::technique::{Direct, Technique};
use pts::scene::{
    Camera, CameraKey, Falloff, Light, LightKind, Material, Mesh, Object, Place, Projection, Scene, Shape,
};
use support::scenes::{bits, estimate, settings};
use support::ztest;

/// Pictures that agree are told apart once in a thousand draws of the seed, for each comparison.
const ALPHA: f64 = 1e-3;

/// Parallel rays along z; the picture shows x in [−2, 2] and y in [−1, 1].
fn camera() -> Camera {
    Camera {
        location: DVec3::new(0.0, 0.0, -5.0),
        direction: DVec3::Z,
        right: DVec3::X * 4.0,
        up: DVec3::Y * 2.0,
        projection: Projection::Orthographic,
        ..Camera::default()
    }
}

fn scene_of(camera: Camera) -> Scene {
    let mut scene = Scene::default();
    scene.cameras.push(camera);
    scene.active_camera = Some(0);
    scene
}

fn boxed(half: DVec3) -> Object {
    Object::new(Shape::Box { min: -half, max: half })
}

fn steps(keys: usize, at: impl Fn(f64) -> DAffine3) -> Vec<DAffine3> {
    (0..keys).map(|k| at(k as f64 / (keys - 1) as f64)).collect()
}

fn shift(by: DVec3) -> impl Fn(f64) -> DAffine3 {
    move |t| DAffine3::from_translation(by * t)
}

fn shoot_as(scene: &Scene, settings: &Settings) -> Picture {
    let mut diags = Diagnostics::default();
    let technique = &settings.technique;
    let files = MemoryFiles::default();
    let compiled = compile_with(scene, &files, settings.width, settings.height, technique, &mut diags);
    let told: Vec<String> = diags.iter().map(|d| d.message.clone()).collect();
    let compiled = compiled.unwrap_or_else(|| panic!("{told:?}"));
    let (picture, report) = driver::render(&compiled, settings, &Silent);
    assert!(report.anomalies.is_empty(), "{:?}", report.anomalies);
    picture
}

fn shoot(scene: &Scene, size: [u32; 2], spp: u32, seed: u64) -> Picture {
    shoot_as(scene, &settings(size, spp, seed))
}

/// An open scene with a lamp that shines, a floor and three things in front of it, which the caller may move.
fn still_life() -> (Scene, Vec<usize>) {
    let mut scene = scene_of(Camera {
        location: DVec3::new(0.0, 1.0, -6.0),
        direction: DVec3::Z * 2.0,
        right: DVec3::X * 2.0,
        up: DVec3::Y * 1.5,
        ..Camera::default()
    });
    let grey = scene.add_material(Material::diffuse(DVec3::splat(0.6)));
    let red = scene.add_material(Material::diffuse(DVec3::new(0.8, 0.2, 0.1)));
    let lamp = scene.add_material(Material::diffuse(DVec3::ZERO).emitting(DVec3::splat(5.0)));
    let floor = Shape::Plane {
        normal: DVec3::Y,
        distance: -1.0,
    };
    scene.objects.push(Object::new(floor).with_material(grey));
    let place = |x, y| DAffine3::from_translation(DVec3::new(x, y, 0.0));
    let ball = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 0.6,
    };
    scene
        .objects
        .push(Object::new(ball).with_material(red).transformed(place(-1.2, 0.0)));
    let block = boxed(DVec3::new(0.4, 0.6, 0.4)).with_material(grey);
    scene.objects.push(block.transformed(place(0.6, 0.0)));
    let shade = boxed(DVec3::new(0.7, 0.0, 0.7)).with_material(lamp);
    scene.objects.push(shade.transformed(place(0.0, 2.5)));
    (scene, vec![1, 2, 3])
}

/// A shining board of width 0.6 crosses the picture from x = −1 to x = 1: at each x it is seen for the share of the time
/// in which it is there. 16 rows of 256 samples, binomial at worst: columns are off by 5.5 standard errors once in 2·10⁷,
/// one of 64 once in 4·10⁵.
#[test]
fn a_board_that_crosses_the_picture_leaves_a_ramp() {
    for keys in [2, 5] {
        let mut scene = scene_of(camera());
        let lamp = scene.add_material(Material::diffuse(DVec3::ZERO).emitting(DVec3::ONE));
        let mut board = boxed(DVec3::new(0.3, 2.0, 0.0)).with_material(lamp);
        board = board.transformed(DAffine3::from_translation(-DVec3::X));
        board.motion = steps(keys, shift(DVec3::X * 2.0));
        scene.objects.push(board);
        let (size, spp) = ([64u32, 16u32], 256);
        let picture = shoot(&scene, size, spp, 3);
        // ∫ of the share of time up to x; the share is that of t with |x − (2t − 1)| ≤ 0.3.
        let share = |x: f64| (((x + 0.3).clamp(-1.0, 1.0) - (x - 0.3).clamp(-1.0, 1.0)) / 2.0).max(0.0);
        for column in 0..64usize {
            let (fine, x0) = (1000, column as f64 / 16.0 - 2.0);
            let expected: f64 =
                (0..fine).map(|i| share(x0 + (f64::from(i) + 0.5) / 16e3)).sum::<f64>() / f64::from(fine);
            let found = (0..16)
                .map(|row| f64::from(picture.rgb[row * 64 + column][0]))
                .sum::<f64>()
                / 16.0;
            let sigma = (expected * (1.0 - expected) / f64::from(spp * 16)).sqrt();
            assert!(
                (found - expected).abs() <= 5.5 * sigma + 1e-6,
                "column {column}: {found}, in closed form {expected}"
            );
        }
    }
}

/// A lamp that flies over a floor: the irradiance is the mean over its way, found by quadrature.
#[test]
fn a_lamp_that_flies_lights_by_the_mean_over_its_way() {
    let mut scene = scene_of(camera());
    let albedo = 0.5;
    let white = scene.add_material(Material::diffuse(DVec3::splat(albedo)));
    scene
        .objects
        .push(boxed(DVec3::new(4.0, 4.0, 0.0)).with_material(white));
    let at = |t: f64| LightKind::Point {
        position: DVec3::new(3.0 * t - 1.5, 0.2, -1.0),
        falloff: Falloff::InverseSquare { range: None },
    };
    scene.lights.push(Light {
        name: String::new(),
        color: DVec3::ONE,
        kind: at(0.0),
        casts_shadows: true,
        motion: vec![at(0.0), at(0.5), at(1.0)],
        place: Place::None,
    });
    let picture = shoot(&scene, [32, 16], 1024, 5);
    let e = estimate(&picture);
    let radiance = |x: f64, y: f64| {
        let n = 2000;
        let mean = (0..n).map(|i| {
            let LightKind::Point { position, .. } = at((f64::from(i) + 0.5) / f64::from(n)) else {
                unreachable!()
            };
            let d = position - DVec3::new(x, y, 0.0);
            -d.z / d.length().powi(3)
        });
        albedo / std::f64::consts::PI * mean.sum::<f64>() / f64::from(n)
    };
    for (i, mean) in e.mean.iter().enumerate() {
        let (x, y) = ((i % 32) as f64 / 8.0 - 2.0, 1.0 - (i / 32) as f64 / 8.0);
        let fine = 8;
        let inside = |k: i32| (f64::from(k) + 0.5) / f64::from(8 * fine);
        let cells = (0..fine * fine).map(|k| radiance(x + inside(k % fine), y - inside(k / fine)));
        let expected = cells.sum::<f64>() / f64::from(fine * fine);
        // 512 pixels; the midpoint rule over a pixel is right to 1e-4.
        let noise = 6.0 * e.variance[i][0].sqrt() + 2e-4 * expected;
        assert!(
            (mean[0] - expected).abs() <= noise,
            "{i}: {} instead of {expected}",
            mean[0]
        );
        assert!(noise < 0.05 * expected, "{noise} says nothing of {expected}");
    }
}

/// The mean of still pictures at 64 moments in the middle of equal steps is the picture over the whole time, but for the
/// steps: they are many, and everything moves by a few pixels.
#[test]
fn a_blurred_picture_is_the_mean_of_all_moments() {
    let (mut scene, moving) = still_life();
    let turn = |t: f64| DAffine3::from_rotation_z(0.5 * t);
    scene.objects[moving[0]].motion = steps(2, shift(DVec3::new(0.4, 0.2, 0.0)));
    scene.objects[moving[1]].motion = steps(9, turn);
    scene.objects[moving[2]].motion = steps(2, shift(DVec3::X * 0.5));
    let size = [32, 24];
    let blurred = estimate(&shoot(&scene, size, 1024, 7));
    let moments = 64;
    let mut mean: Option<support::estimate::Estimate> = None;
    for m in 0..moments {
        let t = (f64::from(m) + 0.5) / f64::from(moments);
        let mut still = scene.clone();
        for &i in &moving {
            let keys = std::mem::take(&mut still.objects[i].motion);
            let x = t * (keys.len() - 1) as f64;
            let k = x as usize;
            let w = x - k as f64;
            let (a, b) = (keys[k].to_cols_array(), keys[k + 1].to_cols_array());
            let between = DAffine3::from_cols_array(&std::array::from_fn(|j| a[j] * (1.0 - w) + b[j] * w));
            still.objects[i].transform *= between;
        }
        let e = estimate(&shoot(&still, size, 64, 100 + u64::from(m as u32)));
        let scaled = |v: &[f64; 3], by: f64| v.map(|x| x / by);
        let sum = mean.get_or_insert_with(|| support::estimate::Estimate {
            mean: vec![[0.0; 3]; e.mean.len()],
            variance: vec![[0.0; 3]; e.mean.len()],
            width: e.width,
            height: e.height,
        });
        let n = f64::from(moments);
        for (s, v) in sum.mean.iter_mut().zip(&e.mean) {
            *s = std::array::from_fn(|c| s[c] + scaled(v, n)[c]);
        }
        for (s, v) in sum.variance.iter_mut().zip(&e.variance) {
            *s = std::array::from_fn(|c| s[c] + scaled(v, n * n)[c]);
        }
    }
    let mean = mean.expect("moments");
    let verdict = ztest::compare(&blurred, &mean, 4, ALPHA);
    assert!(verdict.agree(), "{verdict}");
    // The test can fail: the picture of the opening alone is told apart.
    scene.hold_still();
    let opening = estimate(&shoot(&scene, size, 1024, 7));
    assert!(!ztest::compare(&opening, &mean, 4, ALPHA).agree());
}

/// A camera that flies past what stands still sees what a still camera sees when all flies the other way.
#[test]
fn a_camera_that_moves_is_a_scene_that_moves() {
    let (scene, _) = still_life();
    let by = DVec3::new(0.3, 0.1, 0.5);
    let mut by_camera = scene.clone();
    let key = by_camera.cameras[0].key();
    let end = CameraKey {
        location: key.location + by,
        ..key
    };
    by_camera.cameras[0].motion = vec![key, end];
    let mut by_objects = scene.clone();
    for object in &mut by_objects.objects {
        let back = object.transform.inverse();
        object.motion = steps(2, |t| DAffine3::from_translation(back.transform_vector3(-by * t)));
    }
    let size = [32, 24];
    let [a, b] = [&by_camera, &by_objects].map(|s| estimate(&shoot(s, size, 512, 9)));
    let verdict = ztest::compare(&a, &b, 4, ALPHA);
    assert!(verdict.agree(), "{verdict}");
    let still = estimate(&shoot(&scene, size, 512, 9));
    assert!(!ztest::compare(&a, &still, 4, ALPHA).agree(), "the camera stands still");
}

/// A mesh that moves, a group with it that moves, and loose triangles that move are the same.
#[test]
fn a_mesh_its_triangles_and_its_group_move_alike() {
    let (scene, moving) = still_life();
    let corners = [
        DVec3::new(-0.5, -0.5, -1.0),
        DVec3::new(0.0, 0.7, -1.0),
        DVec3::new(0.5, -0.5, -1.0),
        DVec3::new(0.9, 0.7, -0.5),
    ];
    let faces = [[0, 1, 2], [2, 1, 3]];
    let motion = steps(5, |t| {
        DAffine3::from_rotation_translation(glam::DQuat::from_rotation_y(t), DVec3::X * t)
    });
    let red = scene.objects[moving[0]].material.expect("painted");
    let variants: Vec<Scene> = (0..3)
        .map(|kind| {
            let mut scene = scene.clone();
            let mesh = Mesh::from_f64("wing", &corners, &faces).expect("a mesh");
            let mesh = scene.add_mesh(mesh);
            let mut objects = match kind {
                0 | 1 => vec![Object::new(Shape::Mesh(mesh))],
                _ => faces
                    .map(|f| {
                        Object::new(Shape::Triangle {
                            vertices: f.map(|i| corners[i as usize]),
                            normals: None,
                        })
                    })
                    .to_vec(),
            };
            if kind == 1 {
                let group = scene.add_group(objects);
                objects = vec![Object::new(Shape::Group(group))];
            }
            for mut object in objects {
                object.material = Some(red);
                object.motion = motion.clone();
                scene.objects.push(object);
            }
            scene
        })
        .collect();
    let pictures = [0, 1, 2].map(|i| shoot(&variants[i], [32, 24], 64, 11));
    assert_eq!(bits(&pictures[0]), bits(&pictures[1]), "a group of one mesh");
    // Triangles are rounded about another centre.
    let verdict = ztest::compare(&estimate(&pictures[0]), &estimate(&pictures[2]), 4, ALPHA);
    assert!(verdict.agree(), "{verdict}");
    assert_ne!(bits(&pictures[0]), bits(&shoot(&scene, [32, 24], 64, 11)));
}

/// Keys that say the same change nothing, whatever they say.
#[test]
fn keys_that_are_all_the_same_are_no_motion() {
    let (scene, _) = still_life();
    let plain = bits(&shoot(&scene, [32, 24], 16, 13));
    let mut held = scene.clone();
    for object in &mut held.objects {
        object.motion = vec![DAffine3::IDENTITY; 5];
    }
    let key = held.cameras[0].key();
    held.cameras[0].motion = vec![key; 5];
    assert_eq!(bits(&shoot(&held, [32, 24], 16, 13)), plain);
    let mut moved = scene.clone();
    let by = DAffine3::from_translation(DVec3::new(0.25, 0.5, 0.0));
    moved.objects[1].transform *= by;
    held.objects[1].motion = vec![by; 3];
    assert_eq!(
        bits(&shoot(&held, [32, 24], 16, 13)),
        bits(&shoot(&moved, [32, 24], 16, 13))
    );
}

/// Threads take paths in any order.
#[test]
fn the_number_of_threads_changes_no_bit() {
    let (mut scene, moving) = still_life();
    for &i in &moving {
        scene.objects[i].motion = steps(3, shift(DVec3::new(0.4, 0.2, -0.1)));
    }
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| shoot(&scene, [40, 24], 16, 1))
    };
    assert_eq!(bits(&with(1)), bits(&with(4)));
}

/// Shining things that move are aimed at where they are at a path's time; found by chance they are the same. A mesh, a
/// box, a disc and a sphere, which all keep their kind; one that is turned and stretched does not.
#[test]
fn moving_emitters_are_the_same_however_they_are_found() {
    let (mut scene, moving) = still_life();
    let lamp = scene.objects[moving[2]].material;
    let square = [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]].map(|[x, z]| DVec3::new(x, 0.0, z));
    let mesh = Mesh::from_f64("lamp", &square, &[[0, 1, 2], [0, 2, 3]]).expect("a mesh");
    let mesh = scene.add_mesh(mesh);
    let ball = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 0.3,
    };
    let disc = Shape::Disc {
        center: DVec3::ZERO,
        normal: -DVec3::Y,
        radius: 0.4,
        hole_radius: 0.1,
    };
    let shapes = [Shape::Mesh(mesh), ball.clone(), disc, ball];
    for (i, shape) in shapes.into_iter().enumerate() {
        let mut object = Object::new(shape);
        object.material = lamp;
        let x = i as f64 - 1.5;
        object = object.transformed(DAffine3::from_translation(DVec3::new(x, 1.4, 0.3 * x)));
        object.motion = match i {
            0 => steps(5, DAffine3::from_rotation_z),
            3 => steps(3, |t| DAffine3::from_scale(DVec3::new(1.0 + t, 1.0, 1.0))),
            _ => steps(3, |t| {
                let grown = DAffine3::from_scale(DVec3::splat(1.0 + 0.5 * t));
                DAffine3::from_translation(DVec3::new(0.3, -0.2, 0.5) * t) * grown
            }),
        };
        scene.objects.push(object);
    }
    scene.objects[moving[2]].motion = steps(3, shift(DVec3::X));
    let by = |direct| {
        let settings = Settings {
            technique: Technique {
                direct,
                ..Technique::default()
            },
            ..settings([32, 24], 512, 15)
        };
        estimate(&shoot_as(&scene, &settings))
    };
    let both = by(Direct::Mis);
    for other in [Direct::Bsdf, Direct::Light] {
        let verdict = ztest::compare(&both, &by(other), 4, ALPHA);
        assert!(verdict.agree(), "{other:?}: {verdict}");
    }
}

/// A glass ball that flies over a camera: a path that starts inside of it is bent as one that entered it. The camera
/// stands in the middle of the ball at half time, so that straight paths see what is behind without a change; what
/// absorbs in the ball tells how long the camera was inside.
#[test]
fn what_the_camera_is_inside_of_changes_with_the_time() {
    let mut scene = scene_of(Camera {
        location: DVec3::ZERO,
        direction: DVec3::Z * 100.0, // a narrow view: all rays are as good as parallel to z
        right: DVec3::X,
        up: DVec3::Y,
        ..Camera::default()
    });
    let lamp = scene.add_material(Material::diffuse(DVec3::ZERO).emitting(DVec3::ONE));
    let mut ink = Material::diffuse(DVec3::ONE);
    ink.surface = pts::scene::SurfaceModel::Glass {
        color: DVec3::ONE.into(),
        ior: 1.0,
        roughness: 0.0.into(),
        abbe: None,
    };
    ink.interior.absorption = DVec3::splat(0.7);
    let ink = scene.add_material(ink);
    let wall = boxed(DVec3::new(9.0, 9.0, 0.0)).with_material(lamp);
    scene
        .objects
        .push(wall.transformed(DAffine3::from_translation(DVec3::Z * 5.0)));
    // A block two long, from behind the camera to before it.
    let mut block = boxed(DVec3::ONE).with_material(ink);
    block = block.transformed(DAffine3::from_translation(-DVec3::Z * 2.0));
    block.motion = steps(2, shift(DVec3::Z * 4.0));
    scene.objects.push(block);
    let e = estimate(&shoot(&scene, [8, 8], 512, 17));
    // The way through the block at time t: its front end is at 4t − 1, its back end at 4t − 3.
    let n = 100_000;
    let mean = (0..n).map(|i| {
        let t = 4.0 * (f64::from(i) + 0.5) / f64::from(n);
        (-0.7 * ((t - 1.0).max(0.0) - (t - 3.0).max(0.0))).exp()
    });
    let expected = mean.sum::<f64>() / f64::from(n);
    let found = e.mean.iter().map(|v| v[0]).sum::<f64>() / 64.0;
    let sigma = e.variance.iter().map(|v| v[0]).sum::<f64>().sqrt() / 64.0;
    // Five standard errors: once in two million; rays leave the axis by 0.5 % at most, which lengthens no way by 1e-4.
    assert!(
        (found - expected).abs() < 5.0 * sigma + 1e-4,
        "{found} instead of {expected} ± {sigma}"
    );
    assert!(sigma < 0.01, "{sigma} says nothing");
}
