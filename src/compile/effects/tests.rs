//! Effects of generated scenes: every cause is needed, all together suffice, and leaving an effect out clears it.

use super::{Effect, causes};
use crate::files::MemoryFiles;
use crate::math::stats::Pcg;
use crate::render::technique::Technique;
use crate::scene::{
    BumpMap, Camera, ColorInput, EnvironmentKind, Finish, FinishReflection, Fog, Image, ImageId, ImageSource,
    ImageTexture, Material, Medium, NormalMap, Object, OpacityMode, Phase, Place, Principled, ScalarInput, Scene,
    Shape, SurfaceModel, Texture,
};
use glam::{DAffine2, DAffine3, DVec3};

const SCENES: u64 = 300;

fn chance(rng: &mut Pcg) -> bool {
    rng.next_u32().is_multiple_of(2)
}

/// A material of any kind, with whatever may be on it.
fn material(scene: &mut Scene, rng: &mut Pcg, depth: u32) -> Material {
    let texture = chance(rng).then(|| {
        scene.add_texture(Texture::Image(ImageTexture {
            image: ImageId(0),
            uv_set: 0,
            uv_transform: DAffine2::IDENTITY,
            wrap_u: Default::default(),
            wrap_v: Default::default(),
            filter: Default::default(),
            encoding: Default::default(),
        }))
    });
    let color = ColorInput {
        factor: DVec3::splat(0.5),
        texture,
    };
    let part = |rng: &mut Pcg| ScalarInput::from(if chance(rng) { 0.5 } else { 0.0 });
    let surface = match rng.next_u32() % 9 {
        0 => SurfaceModel::Diffuse {
            color,
            sigma: part(rng),
        },
        1 => SurfaceModel::Specular { color },
        2 => SurfaceModel::Glass {
            color,
            ior: if chance(rng) { 1.5 } else { 1.0 },
            roughness: part(rng),
            abbe: chance(rng).then_some(40.0),
        },
        3 | 4 => SurfaceModel::Glossy {
            color,
            roughness: part(rng),
            ior: 1.5,
            metal: chance(rng),
        },
        5 => SurfaceModel::Translucent {
            color,
            transmit: part(rng),
        },
        6 => SurfaceModel::Principled(Box::new(Principled {
            base_color: color,
            metallic: part(rng),
            transmission: part(rng),
            thick: chance(rng),
            clearcoat: part(rng),
            diffuse_transmission: part(rng),
            dispersion: if chance(rng) { 0.3 } else { 0.0 },
            ..Principled::default()
        })),
        7 => SurfaceModel::Finish(Box::new(Finish {
            color,
            filter: part(rng).factor,
            phong: part(rng).factor,
            diffuse_back: part(rng).factor,
            ior: chance(rng).then_some(1.4),
            dispersion: part(rng).factor,
            reflection: chance(rng).then_some(FinishReflection {
                min: DVec3::splat(0.1),
                max: DVec3::splat(0.5),
                falloff: 1.0,
                fresnel: false,
                metallic: 0.0,
            }),
            ..Finish::default()
        })),
        _ if depth < 2 => {
            let [a, b] = [0, 1].map(|_| {
                let part = material(scene, rng, depth + 1);
                scene.add_material(part)
            });
            let weight = [0.0, 0.3, 1.0][rng.next_u32() as usize % 3].into();
            SurfaceModel::Mix { a, b, weight }
        }
        _ => SurfaceModel::Black,
    };
    let mut m = Material::new(surface);
    if chance(rng) && chance(rng) {
        m.emission = DVec3::ONE.into();
    }
    if chance(rng) {
        m.interior = medium(rng);
    }
    if chance(rng) {
        m.opacity.mode = OpacityMode::Blend;
        m.opacity.alpha = [0.5, 1.0][rng.next_u32() as usize % 2].into();
    }
    m.normal_map = texture
        .filter(|_| chance(rng))
        .map(|texture| NormalMap { texture, scale: 1.0 });
    m.bump_map = texture.filter(|_| chance(rng)).map(|texture| BumpMap {
        texture,
        scale: [0.0, 1.0][rng.next_u32() as usize % 2],
    });
    m
}

/// A medium that does some of what media do, or nothing.
fn medium(rng: &mut Pcg) -> Medium {
    let mut some = |v: DVec3| if chance(rng) { v } else { DVec3::ZERO };
    Medium {
        absorption: some(DVec3::X),
        scattering: some(DVec3::Y),
        emission: some(DVec3::Z),
        phase: Phase::Rayleigh,
    }
}

fn scene(seed: u64) -> Scene {
    let mut rng = Pcg::new(seed);
    let mut scene = Scene::default();
    scene.add_image(Image {
        name: "wood".to_owned(),
        source: ImageSource::Pixels {
            width: 1,
            height: 1,
            data: vec![[0.5; 3]].into(),
        },
        fallback: None,
        place: Place::None,
    });
    for i in 0..1 + rng.next_u32() % 5 {
        let look = material(&mut scene, &mut rng, 0);
        let id = scene.add_material(look);
        let mut object = Object::new(Shape::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        });
        object.name = format!("ball {i}");
        // Keys that are all the same are no motion.
        let end = if chance(&mut rng) { DVec3::X } else { DVec3::ZERO };
        if chance(&mut rng) {
            object.motion = [DVec3::ZERO, end].map(DAffine3::from_translation).to_vec();
        }
        scene.objects.push(object.with_material(id));
    }
    scene.cameras.push(Camera {
        lens_radius: if chance(&mut rng) { 0.1 } else { 0.0 },
        ..Camera::default()
    });
    scene.active_camera = Some(0);
    if chance(&mut rng) {
        let mut key = scene.cameras[0].key();
        scene.cameras[0].motion.push(key);
        key.location.x += 1.0;
        scene.cameras[0].motion.push(key);
    }
    if chance(&mut rng) {
        scene.environment.kind = EnvironmentKind::Constant(DVec3::ONE);
    }
    if chance(&mut rng) {
        scene.atmosphere = medium(&mut rng);
    }
    if chance(&mut rng) {
        scene.fogs.push(Fog {
            color: DVec3::ONE,
            distance: 10.0,
            ground: None,
            place: Place::None,
        });
    }
    scene
}

/// The scene without those causes.
fn without(scene: &Scene, gone: &[causes::Cause]) -> Scene {
    let mut scene = scene.clone();
    let is_gone = |what: &str| gone.iter().any(|c| c.what == what);
    scene.objects.retain(|o| !is_gone(&format!("sphere \"{}\"", o.name)));
    if is_gone("the camera") {
        scene.cameras[0].lens_radius = 0.0;
        scene.cameras[0].motion.clear();
    }
    if is_gone("the environment") {
        scene.environment.kind = EnvironmentKind::Black;
    }
    if is_gone("the atmosphere") {
        scene.atmosphere = Medium::default();
    }
    if is_gone("the air") {
        scene.fogs.clear();
    }
    scene
}

/// Effects that need only one of their causes; caustics and the tree of lights need several things together.
fn is_plain(effect: Effect) -> bool {
    !effect.is_strategy()
}

#[test]
fn without_all_causes_there_is_no_effect_and_without_some_there_is() {
    let technique = Technique::default();
    let mut seen = std::collections::BTreeSet::new();
    for seed in 0..SCENES {
        let scene = scene(seed);
        let effects = causes::of(&scene, &technique);
        for effect in effects.iter() {
            seen.insert(effect);
            let all = effects.causes(effect);
            assert!(
                !causes::of(&without(&scene, all), &technique).has(effect),
                "{seed}: {effect:?}"
            );
            let mut whats: Vec<&str> = all.iter().map(|c| c.what.as_str()).collect();
            whats.dedup();
            if is_plain(effect) && whats.len() > 1 {
                let some: Vec<_> = all.iter().filter(|c| c.what != whats[0]).cloned().collect();
                assert!(
                    causes::of(&without(&scene, &some), &technique).has(effect),
                    "{seed}: {effect:?}"
                );
            }
        }
    }
    assert_eq!(seen.len(), Effect::ALL.len(), "not all effects came up: {seen:?}");
}

#[test]
fn an_effect_that_is_left_out_is_gone_and_others_do_not_come() {
    let files = MemoryFiles::default();
    for seed in 0..SCENES {
        let scene = scene(seed);
        let technique = Technique::default();
        let before = causes::of(&scene, &technique);
        for effect in Effect::ALL {
            let cut = effect.left_out(&scene, &technique, &files);
            let after = causes::of(&cut.scene, &cut.technique);
            assert!(
                !after.has(effect),
                "{seed}: {effect:?} is still there: {:?}",
                after.causes(effect)
            );
            let new = after.iter().find(|e| !before.has(*e));
            // A metal without its roughness is a mirror, and what is transparent without an index is a veil.
            let may_come = |e: Effect| match e {
                Effect::Specular => [Effect::Glossy, Effect::Glass].contains(&effect),
                Effect::Alpha => effect == Effect::Glass,
                _ => false,
            };
            assert!(new.is_none_or(may_come), "{seed}: without {effect:?} comes {new:?}");
        }
    }
}

/// Mixtures of mixtures that share their parts have 2⁴⁰ ways through them; each part counts once.
#[test]
fn parts_that_are_shared_are_looked_at_once() {
    let mut scene = Scene::default();
    let mut id = scene.add_material(Material::new(SurfaceModel::Specular {
        color: DVec3::ONE.into(),
    }));
    for _ in 0..40 {
        let weight = 0.5.into();
        id = scene.add_material(Material::new(SurfaceModel::Mix { a: id, b: id, weight }));
    }
    let ball = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    scene.objects.push(Object::new(ball).with_material(id));
    let effects = causes::of(&scene, &Technique::default());
    let times: Vec<u64> = effects.causes(Effect::Specular).iter().map(|c| c.times).collect();
    assert_eq!(times, [1]);
}

/// What a solid is filled with counts where light gets in, and only there.
#[test]
fn a_medium_that_no_light_reaches_is_no_effect() {
    let has_media = |surface: SurfaceModel| {
        let mut scene = Scene::default();
        let mut material = Material::new(surface);
        material.interior.scattering = DVec3::ONE;
        let id = scene.add_material(material);
        let ball = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        };
        scene.objects.push(Object::new(ball).with_material(id));
        causes::of(&scene, &Technique::default()).has(Effect::Media)
    };
    let finish = |filter: f64| {
        SurfaceModel::Finish(Box::new(Finish {
            filter,
            ..Finish::default()
        }))
    };
    assert!(has_media(finish(0.5)) && !has_media(finish(0.0)));
    let principled = |transmission: f64, thick: bool| {
        SurfaceModel::Principled(Box::new(Principled {
            transmission: transmission.into(),
            thick,
            ..Principled::default()
        }))
    };
    assert!(
        has_media(principled(0.1, true)) && !has_media(principled(0.0, true)) && !has_media(principled(0.1, false))
    );
    assert!(!has_media(SurfaceModel::Black));
}

#[test]
fn words_lead_back_to_their_effects() {
    for (i, effect) in Effect::ALL.into_iter().enumerate() {
        assert_eq!(effect as usize, i);
        assert_eq!(Effect::from_word(effect.word()), Some(effect));
    }
    assert_eq!(Effect::from_word("fog"), None);
}
