//! Pruned scenes against the same scenes as they were written: equal in bits, or in expectation where a pass says so.

use super::*;
use crate::compile::compile_pruned;
use crate::files::MemoryFiles;
use crate::math::color::luminance;
use crate::math::stats::Pcg;
use crate::render::driver;
use crate::render::report::{Picture, Silent};
use crate::render::settings::Settings;
use crate::scene::*;
use glam::{DAffine2, DAffine3, DVec3, DVec4, Vec2, Vec3, Vec4};
use std::collections::BTreeSet;

mod generated;

use generated::{lamp, quad, scene};

/// Generated scenes; every eighth of them has nothing that a pass without bits would take out.
const SCENES: u64 = 400;

fn render(pruned: Pruned<'_>, settings: &Settings) -> Picture {
    let mut diags = Diagnostics::default();
    let (w, h) = (settings.width, settings.height);
    let compiled = compile_pruned(pruned, w, h, &settings.technique, &mut diags).expect("it compiles");
    driver::render(&compiled, settings, &Silent).0
}

fn pruned_of<'s>(scene: &'s Scene, files: &'s MemoryFiles) -> Pruned<'s> {
    prune(scene, files, &mut Diagnostics::default())
}

fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture.rgb.iter().map(|c| c.map(f32::to_bits)).collect()
}

/// Whether a pass changed which lights there are by making an emission black: they are then chosen otherwise.
fn loses_emission(pruned: &Pruned<'_>, scene: &Scene) -> bool {
    let emits = |m: &Material| m.emission.factor != DVec3::ZERO;
    scene
        .materials
        .iter()
        .zip(&pruned.scene.materials)
        .any(|(a, b)| emits(a) && !emits(b))
}

#[test]
fn pruned_scenes_give_the_same_bits() {
    let files = MemoryFiles::default();
    let mut settings = Settings::new(6, 5, 4);
    settings.technique.max_depth = 5;
    let (mut fired, mut compared) = (BTreeSet::new(), 0);
    for seed in 0..SCENES {
        let scene = scene(seed, !seed.is_multiple_of(8));
        let pruned = pruned_of(&scene, &files);
        fired.extend(pruned.what.iter().map(|r| r.pass));
        let whys: Vec<String> = pruned
            .what
            .iter()
            .map(|r| format!("{:?} {} {}", r.pass, r.kind, r.why))
            .collect();
        if !pruned.keeps_bits() || loses_emission(&pruned, &scene) {
            continue;
        }
        compared += 1;
        let (a, b) = (
            render(pruned, &settings),
            render(Pruned::untouched(&scene, &files), &settings),
        );
        assert!(bits(&a) == bits(&b), "{seed}: {whys:#?}\n{}", scene.dump());
    }
    let all: BTreeSet<Pass> = Pass::ALL.into_iter().filter(|p| *p != Pass::Lens).collect();
    assert!(fired.is_superset(&all), "only {fired:?} had something to do");
    assert!(compared > SCENES / 4, "{compared} of {SCENES} were compared");
}

#[test]
fn pruning_twice_takes_nothing_more() {
    let files = MemoryFiles::default();
    for seed in 0..SCENES {
        let scene = scene(seed, false);
        let once = pruned_of(&scene, &files).scene.into_owned();
        let again = pruned_of(&once, &files);
        let changed: Vec<&Removal> = again.what.iter().filter(|r| r.kind != "vertex data").collect();
        assert!(
            changed
                .iter()
                .all(|r| ["nothing drawn has it", "nothing places it"].contains(&&r.why[..]) || r.kind == "image"),
            "{seed}: {changed:#?}"
        );
        assert!(matches!(again.scene, Cow::Borrowed(_)), "{seed}");
    }
}

/// A sphere that everything of a case is about, on a ground under one lamp and a grey sky.
fn staged(edit: impl Fn(&mut Scene)) -> Scene {
    let mut scene = Scene::default();
    let ground = scene.add_material(Material::diffuse(DVec3::splat(0.6)));
    let plane = Shape::Plane {
        normal: DVec3::Y,
        distance: -1.0,
    };
    scene.objects.push(Object::new(plane).with_material(ground));
    scene.lights.push(lamp(DVec3::new(2.0, 4.0, -3.0), DVec3::splat(0.5)));
    scene.environment.kind = EnvironmentKind::Constant(DVec3::splat(0.3));
    scene.cameras.push(Camera {
        location: DVec3::new(0.0, 0.5, -4.0),
        ..Camera::default()
    });
    scene.active_camera = Some(0);
    edit(&mut scene);
    scene
}

fn add_ball(scene: &mut Scene, look: Material) {
    let look = scene.add_material(look);
    let ball = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    scene.objects.push(Object::new(ball).with_material(look));
}

fn glass(ior: f64) -> Material {
    Material::new(SurfaceModel::Glass {
        color: DVec3::ONE.into(),
        ior,
        roughness: 0.0.into(),
        abbe: None,
    })
}

/// Mean luminance of pictures of 24 seeds, and its standard error.
fn mean(make: &dyn Fn() -> (Scene, bool), first_seed: u64) -> (f64, f64) {
    const SEEDS: u64 = 24;
    let files = MemoryFiles::default();
    let means: Vec<f64> = (first_seed..first_seed + SEEDS)
        .map(|seed| {
            let (scene, is_pruned) = make();
            let mut settings = Settings::new(12, 8, 16);
            settings.seed = seed;
            let pruned = if is_pruned {
                pruned_of(&scene, &files)
            } else {
                Pruned::untouched(&scene, &files)
            };
            let picture = render(pruned, &settings);
            picture
                .rgb
                .iter()
                .map(|c| f64::from(luminance(Vec3::from(*c))))
                .sum::<f64>()
                / picture.rgb.len() as f64
        })
        .collect();
    let n = SEEDS as f64;
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Passes that keep expected values only, each by itself: means of independent seeds, pruned and not. Student's t of 46
/// degrees of freedom is beyond 5 with probability 10⁻⁵, for seven cases together below 10⁻⁴.
#[test]
fn passes_without_bits_keep_the_mean() {
    type Edit = fn(&mut Scene);
    let cases: [(&str, Pass, Edit); 7] = [
        ("a dark lamp", Pass::Lights, |s| {
            add_ball(s, Material::diffuse(DVec3::splat(0.8)));
            s.lights.push(lamp(DVec3::new(-3.0, 4.0, -3.0), DVec3::ZERO));
        }),
        ("a closed spot", Pass::Lights, |s| {
            add_ball(s, Material::diffuse(DVec3::splat(0.8)));
            s.lights.push(Light {
                kind: LightKind::Spot {
                    position: DVec3::new(0.0, 4.0, -1.0),
                    axis: -DVec3::Y,
                    profile: SpotProfile::Punctual { inner: 0.0, outer: 0.0 },
                    falloff: Falloff::None,
                },
                ..lamp(DVec3::ZERO, DVec3::ONE)
            });
        }),
        ("a black sky", Pass::Sky, |s| {
            add_ball(s, Material::diffuse(DVec3::splat(0.8)));
            s.environment.kind = EnvironmentKind::Constant(DVec3::ZERO);
        }),
        ("a black sky image", Pass::Sky, |s| {
            add_ball(s, Material::diffuse(DVec3::splat(0.8)));
            let image = s.add_image(Image {
                name: "night".to_owned(),
                source: ImageSource::Pixels {
                    width: 2,
                    height: 1,
                    data: vec![[0.0; 3]; 2].into(),
                },
                fallback: None,
                place: Place::None,
            });
            s.environment.kind = EnvironmentKind::Image {
                image,
                strength: 1.0,
                rotation: glam::DMat3::IDENTITY,
            };
        }),
        ("glass of ior 1", Pass::Unseen, |s| add_ball(s, glass(1.0))),
        ("a clear finish", Pass::Unseen, |s| {
            let clear = Finish {
                transmit: 1.0,
                ..Finish::default()
            };
            add_ball(s, Material::new(SurfaceModel::Finish(Box::new(clear))));
        }),
        ("coverage 0", Pass::Unseen, |s| {
            let mut gone = Material::diffuse(DVec3::ONE).emitting(DVec3::ONE);
            gone.opacity = Opacity {
                mode: OpacityMode::Blend,
                alpha: 0.0.into(),
            };
            add_ball(s, gone);
        }),
    ];
    for (what, pass, edit) in cases {
        let fired: Vec<Pass> = pruned_of(&staged(edit), &MemoryFiles::default())
            .what
            .iter()
            .map(|r| r.pass)
            .collect();
        assert!(fired.contains(&pass), "{what}: {fired:?}");
        let (a, da) = mean(&|| (staged(edit), true), 1);
        let (b, db) = mean(&|| (staged(edit), false), 1001);
        let t = (a - b) / da.hypot(db).max(f64::MIN_POSITIVE);
        assert!(
            a > 0.0 && (a == b || t.abs() < 5.0),
            "{what}: {a} ± {da} and {b} ± {db}"
        );
    }
}

/// An index of 1 inside of a solid that bends light, or that absorbs, is a bubble; so it is in fog.
#[test]
fn a_bubble_is_not_taken_for_nothing() {
    let files = MemoryFiles::default();
    let keeps = |edit: &dyn Fn(&mut Scene)| {
        let scene = staged(|s| {
            add_ball(s, glass(1.0));
            edit(s);
        });
        let pruned = pruned_of(&scene, &files);
        pruned.scene.objects.len() == scene.objects.len()
    };
    assert!(!keeps(&|_| {}));
    assert!(!keeps(&|s| add_ball(s, glass(1.0))));
    assert!(keeps(&|s| add_ball(s, glass(1.5))));
    let mut tinted = glass(1.0);
    tinted.interior.absorption = DVec3::X;
    assert!(keeps(&move |s| add_ball(s, tinted.clone())));
    assert!(keeps(&|s| {
        s.fogs.push(Fog {
            color: DVec3::ONE,
            distance: 10.0,
            ground: None,
            place: Place::None,
        })
    }));
}

fn wood(file: &str) -> Image {
    Image {
        name: file.to_owned(),
        source: ImageSource::File(file.into()),
        fallback: None,
        place: Place::None,
    }
}

fn image_texture(scene: &mut Scene, image: ImageId) -> TextureId {
    scene.add_texture(Texture::Image(ImageTexture {
        image,
        uv_set: 0,
        uv_transform: DAffine2::IDENTITY,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        filter: TexelFilter::Bilinear,
        encoding: Encoding::Srgb,
    }))
}

/// Images behind a factor of 0, an opaque alpha, a layer of strength 0 and a material that nothing has are not opened,
/// whether they exist or not; each is told once, with what it saves.
#[test]
fn images_that_nothing_shows_are_not_opened() {
    let mut files = MemoryFiles::default();
    files.insert("zero.png", vec![0; 100]);
    files.insert("spare.png", vec![0; 50]);
    let scene = staged(|s| {
        let [zero, alpha, sheen, spare] = ["zero.png", "alpha.png", "sheen.png", "spare.png"].map(|name| {
            let image = s.add_image(wood(name));
            image_texture(s, image)
        });
        let mut look = Material::new(SurfaceModel::Principled(Box::new(Principled {
            sheen_roughness: ScalarInput::scaled(1.0, Some((sheen, Channel::A))),
            ..Principled::default()
        })));
        look.emission = ColorInput {
            factor: DVec3::ZERO,
            texture: Some(zero),
        };
        look.opacity.alpha.texture = Some((alpha, Channel::A));
        add_ball(s, look);
        let mut idle = Material::diffuse(DVec3::ONE);
        idle.emission.texture = Some(spare);
        s.add_material(idle);
    });
    let mut diags = Diagnostics::default();
    let pruned = prune(&scene, &files, &mut diags);
    let told = |name: &str| {
        let of: Vec<&Removal> = pruned.what.iter().filter(|r| r.name == name).collect();
        assert_eq!(of.len(), 1, "{name}: {of:?}");
        (of[0].pass, of[0].saved.files.len(), of[0].saved.bytes)
    };
    assert_eq!(told("zero.png"), (Pass::Textures, 1, 100));
    assert_eq!(told("alpha.png"), (Pass::Coverage, 1, 0));
    assert_eq!(told("sheen.png"), (Pass::Surfaces, 1, 0));
    assert_eq!(told("spare.png"), (Pass::Unreachable, 1, 50));
    assert!(
        files.opened().is_empty() && diags.iter().next().is_none(),
        "{:?}",
        files.opened()
    );
}

/// What nothing refers to is told once and nothing else; a group's members and parts of mixtures are used.
#[test]
fn what_nothing_refers_to_is_told_once() {
    let mut scene = Scene::default();
    let [a, b] = [0, 1].map(|_| scene.add_material(Material::diffuse(DVec3::ONE)));
    let weight = 0.5.into();
    let mix = scene.add_material(Material::new(SurfaceModel::Mix { a, b, weight }));
    scene.add_material(Material {
        name: "spare".to_owned(),
        ..Material::diffuse(DVec3::ONE)
    });
    scene.add_mesh(Mesh::default());
    scene.add_image(wood("wood.png"));
    let ball = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    let group = scene.add_group(vec![Object::new(ball).with_material(mix)]);
    scene.objects.push(Object::new(Shape::Group(group)));
    let files = MemoryFiles::default();
    let pruned = pruned_of(&scene, &files);
    let found: Vec<_> = pruned.what.iter().map(|r| (r.kind, r.name.as_str())).collect();
    assert_eq!(found, [("material", "spare"), ("image", "wood.png"), ("mesh", "")]);
    assert!(
        matches!(pruned.scene, Cow::Borrowed(_)),
        "and nothing had to be changed"
    );
}

/// An override hides what a model's own materials would show.
#[test]
fn materials_under_an_override_are_not_reached() {
    let mut scene = Scene::default();
    let [own, over] = [0, 1].map(|_| scene.add_material(Material::diffuse(DVec3::ONE)));
    let mut mesh = quad(false);
    mesh.materials = vec![Some(own)];
    let mesh = scene.add_mesh(mesh);
    let group = scene.add_group(vec![Object::new(Shape::Mesh(mesh))]);
    let mut placed = Object::new(Shape::Group(group)).with_material(over);
    scene.objects.push(placed.clone());
    assert_eq!(Reached::from(&scene).materials, [own].into());
    placed.override_material = true;
    scene.objects[0] = placed;
    assert_eq!(Reached::from(&scene).materials, [over].into());
}

#[test]
fn words_are_distinct() {
    let words: BTreeSet<&str> = Pass::ALL.iter().map(|p| p.word()).collect();
    assert_eq!(words.len(), Pass::ALL.len());
    assert!(Pass::ALL.windows(2).all(|w| w[0] < w[1]));
}
