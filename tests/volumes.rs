//! Media, fog and dispersion against closed forms: furnaces, slabs, half-spaces, single scattering, a spectrum.
//!
//! False alarms: each comparison allows five standard errors of its own noise, once in two million times for each of
//! some three hundred channels compared; seeds are fixed.

mod support;

use glam::{DAffine3, DVec3, Vec3};
use pts::compile::compile;
use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::render::driver;
use pts::render::report::Silent;
use pts::render::settings::Settings;
use pts::render::technique::Direct;
use pts::render::wavelength::Wavelength;
use pts::scene::{
    Camera, EnvironmentKind, Finish, Fog, GroundFog, Light, LightKind, Material, Medium, Object, Phase, Place, Scene,
    Shape, SurfaceModel,
};
use support::estimate::{RegionMean, WHOLE};
use support::scenes;

const SIZE: u32 = 8;

fn grey(v: f64) -> DVec3 {
    DVec3::splat(v)
}

/// A boundary that does nothing, around a medium.
fn skin(medium: Medium) -> Material {
    let finish = Finish {
        transmit: 1.0,
        diffuse: 0.0,
        ..Finish::default()
    };
    Material {
        interior: medium,
        ..Material::new(SurfaceModel::Finish(Box::new(finish)))
    }
}

fn glass(ior: f64, roughness: f64, abbe: Option<f64>, medium: Medium) -> Material {
    Material {
        interior: medium,
        ..Material::new(SurfaceModel::Glass {
            color: DVec3::ONE.into(),
            ior,
            roughness: roughness.into(),
            abbe,
        })
    }
}

/// A scene seen from `location` towards the origin through a narrow field, in a sky of this radiance.
fn scene(location: DVec3, width: f64, sky: f64) -> Scene {
    let direction = -location.normalize();
    let right = DVec3::new(0.3, 1.0, 0.2).cross(direction).normalize();
    let mut scene = Scene::default();
    scene.cameras.push(Camera {
        location,
        direction,
        right: right * width,
        up: direction.cross(right) * width,
        ..Camera::default()
    });
    scene.active_camera = Some(0);
    if sky > 0.0 {
        scene.environment.kind = EnvironmentKind::Constant(grey(sky));
    }
    scene
}

fn place(scene: &mut Scene, shape: Shape, material: Material) {
    let material = scene.add_material(material);
    scene.objects.push(Object::new(shape).with_material(material));
}

fn ball(scene: &mut Scene, material: Material) {
    let (center, radius) = (DVec3::ZERO, 1.0);
    place(scene, Shape::Sphere { center, radius }, material);
}

fn shoot(scene: &Scene, spp: u32, change: impl FnOnce(&mut Settings)) -> RegionMean {
    let mut diags = Diagnostics::default();
    let mut settings = scenes::settings([SIZE, SIZE], spp, 1);
    change(&mut settings);
    let compiled = compile(scene, &MemoryFiles::default(), SIZE, SIZE, &mut diags).expect("the scene compiles");
    let (picture, report) = driver::render(&compiled, &settings, &Silent);
    assert!(report.anomalies.is_empty(), "{:?}", report.anomalies);
    scenes::estimate(&picture).region(WHOLE)
}

fn mean(scene: &Scene, spp: u32) -> RegionMean {
    shoot(scene, spp, |_| {})
}

/// 1 within five standard errors and a thousandth; noise beyond a tenth could not see what it looks for.
fn assert_white(found: &RegionMean, what: &str) {
    for (mean, error) in found.mean.iter().zip(found.stderr) {
        assert!(5.0 * error < 0.1, "{what}: too noisy, {found:?}");
        assert!((mean - 1.0).abs() <= 5.0 * error + 1e-3, "{what}: {found:?}");
    }
}

/// What scatters and takes nothing does not show in a sky of 1, whatever its colours, its phase and its boundary, seen
/// from outside and from inside, by light samples, by hits, and by both.
#[test]
fn a_white_medium_in_a_furnace_cannot_be_seen() {
    let media = [
        (grey(1.0), Phase::default()),
        (DVec3::new(3.0, 0.5, 0.0), Phase::HenyeyGreenstein(0.7)),
        (DVec3::new(0.2, 2.0, 8.0), Phase::HenyeyGreenstein(-0.4)),
        (grey(2.0), Phase::Rayleigh),
        (grey(1.0), Phase::Hazy),
        (DVec3::new(1.0, 0.3, 2.0), Phase::Murky),
    ];
    for (scattering, phase) in media {
        let medium = Medium {
            scattering,
            phase,
            ..Medium::default()
        };
        let boundaries = [
            ("open", skin(medium)),
            ("matched", glass(1.0, 0.0, None, medium)),
            ("glass", glass(1.5, 0.0, None, medium)),
            ("rough", glass(1.3, 0.5, None, medium)),
            ("prism", glass(1.5, 0.0, Some(20.0), medium)),
        ];
        for (name, material) in boundaries {
            for location in [DVec3::new(0.0, 0.4, -3.0), DVec3::new(0.1, 0.0, -0.6)] {
                let mut scene = scene(location, 0.5, 1.0);
                ball(&mut scene, material.clone());
                for direct in [Direct::Mis, Direct::Light, Direct::Bsdf] {
                    // Through rough glass light samples alone have no finite variance.
                    if direct == Direct::Light && name == "rough" {
                        continue;
                    }
                    let found = shoot(&scene, 1024, |s| s.technique.direct = direct);
                    let what = format!("{name}, {scattering}, {phase:?}, {direct:?}, from {location}");
                    assert_white(&found, &what);
                }
            }
        }
    }
}

/// Chandrasekhar's H for isotropic scattering of albedo ω: 1/H(μ) = √(1 − ω) + ω/2·∫ H(μ')·μ'/(μ + μ') dμ', iterated.
fn h_function(omega: f64, mu: f64) -> f64 {
    const N: usize = 400;
    let node = |i: usize| (i as f64 + 0.5) / N as f64;
    let mut h = [1.0; N];
    let at = |h: &[f64; N], mu: f64| {
        let sum: f64 = (0..N).map(|i| h[i] * node(i) / (mu + node(i))).sum();
        1.0 / ((1.0 - omega).sqrt() + 0.5 * omega * sum / N as f64)
    };
    for _ in 0..200 {
        let next: [f64; N] = std::array::from_fn(|i| at(&h, node(i)));
        h = std::array::from_fn(|i| 0.5 * (h[i] + next[i]));
    }
    at(&h, mu)
}

/// A half-space of isotropic scatterers under an even sky of 1 returns 1 − H(μ)·√(1 − ω) towards μ.
/// Source: Chandrasekhar, Radiative Transfer, 1960, by reciprocity with the albedo of a beam.
#[test]
fn a_deep_sea_is_as_bright_as_chandrasekhar_says() {
    for (omega, mu) in [(0.5, 0.9), (0.9, 0.5), (0.9, 0.2), (0.99, 0.7)] {
        let location = DVec3::new((1.0f64 - mu * mu).sqrt(), mu, 0.0) * 4.0;
        let mut scene = scene(location, 1e-3, 1.0);
        let (normal, distance) = (DVec3::Y, 0.0);
        let sea = Medium {
            scattering: grey(omega * 2.0),
            absorption: grey((1.0 - omega) * 2.0),
            ..Medium::default()
        };
        place(&mut scene, Shape::Plane { normal, distance }, skin(sea));
        let exact = 1.0 - h_function(omega, mu) * (1.0 - omega).sqrt();
        mean(&scene, 8192).assert_near([exact; 3], 0.015, 5.0, &format!("albedo {omega}, towards {mu}"));
    }
}

/// Along a way d through what shines: ε·(1 − exp(−σd))/σ + exp(−σd), without any noise.
#[test]
fn a_flame_is_the_integral_of_its_light() {
    let (absorption, emission) = (DVec3::new(0.0, 0.7, 30.0), DVec3::new(0.3, 0.2, 5.0));
    let mut scene = scene(DVec3::new(0.0, 0.0, -5.0), 1e-4, 1.0);
    let flame = Medium {
        absorption,
        emission,
        ..Medium::default()
    };
    ball(&mut scene, skin(flame));
    let exact = [0, 1, 2].map(|c| {
        let (s, e) = (absorption[c], emission[c]);
        let left = (-2.0 * s).exp();
        let light = if s == 0.0 { 2.0 * e } else { e * (1.0 - left) / s };
        light + left
    });
    let found = mean(&scene, 16);
    found.assert_near(exact, 1e-4, 5.0, "a flame");
}

/// Light of a parallel lamp behind the camera, scattered once straight back: σs·p(−1)·E·(1 − exp(−2σt·d))/2σt, d = 2.
#[test]
fn haze_in_front_of_a_lamp_is_scattered_once() {
    for (phase, back) in [
        (Phase::default(), 1.0),
        (Phase::HenyeyGreenstein(0.5), (1.0 - 0.25) / 1.5f64.powi(3)),
        (Phase::Rayleigh, 1.5),
        (Phase::Hazy, 0.5),
    ] {
        let mut scene = scene(DVec3::new(0.0, 0.0, -5.0), 1e-4, 0.0);
        let (s, a) = (DVec3::new(0.4, 1.0, 0.2), DVec3::new(0.3, 0.0, 0.1));
        let haze = Medium {
            scattering: s,
            absorption: a,
            phase,
            ..Medium::default()
        };
        ball(&mut scene, skin(haze));
        scene.lights.push(Light {
            name: String::new(),
            color: DVec3::ONE,
            kind: LightKind::Directional { direction: DVec3::Z },
            casts_shadows: true,
            motion: Vec::new(),
            place: Place::None,
        });
        let e = std::f64::consts::PI;
        let exact = [0, 1, 2].map(|c| {
            let t = s[c] + a[c];
            s[c] * back / (4.0 * e) * e * (1.0 - (-4.0 * t).exp()) / (2.0 * t)
        });
        let found = shoot(&scene, 4096, |s| s.technique.max_depth = 1);
        found.assert_near(exact, 0.01, 5.0, &format!("{phase:?}"));
    }
}

/// Scattering twice and more, by light samples against hits: a lamp of some size in a fog bank, where no closed form is.
#[test]
fn light_samples_and_hits_agree_in_a_cloud() {
    let mut scene = scene(DVec3::new(0.0, 0.5, -4.0), 0.6, 0.0);
    let medium = Medium {
        scattering: DVec3::new(1.0, 2.0, 0.5),
        absorption: DVec3::new(0.1, 0.0, 0.5),
        phase: Phase::HenyeyGreenstein(0.6),
        ..Medium::default()
    };
    ball(&mut scene, skin(medium));
    let lamp = Material::new(SurfaceModel::Black).emitting(grey(5.0));
    let (center, radius) = (DVec3::new(1.5, 1.5, -1.0), 0.8);
    place(&mut scene, Shape::Sphere { center, radius }, lamp);
    let by = |direct| shoot(&scene, 16384, |s| s.technique.direct = direct);
    let (mis, hits, light) = (by(Direct::Mis), by(Direct::Bsdf), by(Direct::Light));
    for (name, other) in [("hits", hits), ("light samples", light)] {
        for c in 0..3 {
            let noise = (mis.stderr[c].powi(2) + other.stderr[c].powi(2)).sqrt();
            assert!(noise < 0.02 * mis.mean[c], "{name}: too noisy to tell");
            let off = (mis.mean[c] - other.mean[c]).abs();
            assert!(off < 5.0 * noise, "{name}: {:?} and {:?}", mis, other);
        }
    }
}

/// A wall of 1 at a distance of 3 in fog; fog on the ground, whose integral upwards is an arc tangent; lamps undimmed.
#[test]
fn fog_hides_what_lies_behind_it() {
    let color = DVec3::new(0.2, 0.4, 0.9);
    let fog = |ground| Fog {
        color,
        distance: 2.0,
        ground,
        place: Place::None,
    };
    let blend = |left: f64| [0, 1, 2].map(|c| left + color[c] * (1.0 - left));
    let mut wall = scene(DVec3::new(0.0, 0.0, -3.0), 1e-4, 0.0);
    let (normal, distance) = (DVec3::NEG_Z, 0.0);
    let bright = Material::new(SurfaceModel::Black).emitting(grey(1.0));
    place(&mut wall, Shape::Plane { normal, distance }, bright);
    wall.fogs.push(fog(None));
    mean(&wall, 16).assert_near(blend((-1.5f64).exp()), 1e-5, 5.0, "a wall");
    // Straight up from the ground into a sky of 1: 2·π/2 of the full density's way.
    let mut up = scene(DVec3::new(0.0, -1e-3, 0.0), 1e-4, 1.0);
    up.fogs.push(fog(Some(GroundFog {
        up: DVec3::Y,
        offset: -1e-3,
        falloff: 2.0,
    })));
    mean(&up, 16).assert_near(blend((-std::f64::consts::PI / 2.0).exp()), 1e-4, 5.0, "the sky");
    // A lamp without shape is not dimmed on its way to the floor, the floor is on its way to the camera.
    let mut lit = scene(DVec3::new(0.0, 2.0, 0.0), 1e-4, 0.0);
    let (normal, distance) = (DVec3::Y, 0.0);
    place(
        &mut lit,
        Shape::Plane { normal, distance },
        Material::diffuse(grey(0.5)),
    );
    lit.fogs.push(fog(None));
    lit.lights.push(Light {
        name: String::new(),
        color: DVec3::ONE,
        kind: LightKind::Directional {
            direction: DVec3::NEG_Y,
        },
        casts_shadows: true,
        motion: Vec::new(),
        place: Place::None,
    });
    let left = (-1.0f64).exp();
    let found = shoot(&lit, 16, |s| s.technique.max_depth = 1);
    // Fog without end shines on the floor, whose albedo is a half, from everywhere.
    let exact = [0, 1, 2].map(|c| 0.5 * (1.0 + color[c]) * left + color[c] * (1.0 - left));
    found.assert_near(exact, 1e-4, 5.0, "a lamp in fog");
}

/// An atmosphere: a wall of 1 at a distance of 2, behind what only absorbs; and white haze in a room that shines: 1.
#[test]
fn an_atmosphere_fills_what_is_not_solid() {
    let mut wall = scene(DVec3::new(0.0, 0.0, -3.0), 1e-4, 0.0);
    let (normal, distance) = (DVec3::NEG_Z, 0.0);
    let bright = Material::new(SurfaceModel::Black).emitting(grey(1.0));
    place(&mut wall, Shape::Plane { normal, distance }, bright.clone());
    wall.atmosphere.absorption = DVec3::new(0.0, 0.5, 2.0);
    // A ball of glass of its own on the way displaces a length of 2 of it.
    let exact = [0.0, 0.5, 2.0].map(|s: f64| (-3.0 * s).exp());
    mean(&wall, 16).assert_near(exact, 1e-5, 5.0, "a wall");
    let (center, radius) = (DVec3::new(0.0, 0.0, -1.5), 1.0);
    place(
        &mut wall,
        Shape::Sphere { center, radius },
        glass(1.0, 0.0, None, Medium::default()),
    );
    let exact = [0.0, 0.5, 2.0].map(|s: f64| (-s).exp());
    mean(&wall, 16).assert_near(exact, 1e-5, 5.0, "a wall behind a bubble");
    // A closed room of walls that emit 1 − albedo is 1 everywhere, haze or not.
    let mut room = scene(DVec3::new(0.0, 0.2, -0.5), 1.0, 0.0);
    let (min, max) = (grey(-1.0), grey(1.0));
    let mut walls = Material::diffuse(grey(0.5)).emitting(grey(0.5));
    walls.emission_sides = pts::scene::EmissionSides::Both;
    place(&mut room, Shape::Box { min, max }, walls);
    room.atmosphere.scattering = DVec3::new(0.3, 1.0, 0.0);
    room.atmosphere.phase = Phase::HenyeyGreenstein(0.3);
    mean(&room, 4096).assert_near([1.0; 3], 0.01, 5.0, "a hazy room");
}

/// Looking into dispersive glass at 60°: a lamp inside begins where one wavelength arrives, so that the picture shows what
/// lies on one side of it. Oracle: Snell and Fresnel in f64 for each wavelength; in glass of index n a lamp counts 1/n².
#[test]
fn a_spectrum_is_cut_where_snell_says() {
    let (ior, abbe) = (1.7f64, 10.0f64);
    let sin_i = 60f64.to_radians().sin();
    let location = DVec3::new(-sin_i, 0.5, 0.0) * 4.0;
    // The lamp lies at depth 1 and begins where light of this wavelength comes down.
    for cut in [450.0f32, 540.0, 600.0] {
        let n_of = |nm: f32| {
            let weight = Vec3::ONE;
            f64::from(Wavelength { nm, weight }.ior(ior as f32, (20.0 / abbe) as f32))
        };
        let lands = |nm: f32| {
            let sin_t = sin_i / n_of(nm);
            sin_t / (1.0 - sin_t * sin_t).sqrt()
        };
        let mut scene = scene(location, 1e-6, 0.0);
        let (normal, distance) = (DVec3::Y, 0.0);
        let clear = glass(ior, 0.0, Some(abbe), Medium::default());
        place(&mut scene, Shape::Plane { normal, distance }, clear);
        // Flat: a side would be hit by what comes down in front of it.
        let (min, max) = (DVec3::new(lands(cut), -1.0, -1.0), DVec3::new(5.0, -1.0, 1.0));
        let mut lamp = Material::new(SurfaceModel::Black).emitting(grey(1.0));
        lamp.emission_sides = pts::scene::EmissionSides::Both;
        place(&mut scene, Shape::Box { min, max }, lamp);
        let steps = 100_000;
        let mut exact = [0.0; 3];
        for i in 0..steps {
            let w = Wavelength::sample((i as f32 + 0.5) / steps as f32);
            if lands(w.nm) < lands(cut) {
                continue;
            }
            let n = n_of(w.nm);
            let (cos_i, cos_t) = (0.5, (1.0 - (sin_i / n).powi(2)).sqrt());
            let rs = (cos_i - n * cos_t) / (cos_i + n * cos_t);
            let rp = (n * cos_i - cos_t) / (n * cos_i + cos_t);
            let passes = 1.0 - 0.5 * (rs * rs + rp * rp);
            for (c, e) in exact.iter_mut().enumerate() {
                *e += f64::from(w.weight[c]) * passes / (n * n) / f64::from(steps);
            }
        }
        let found = shoot(&scene, 16384, |s| s.technique.direct = Direct::Bsdf);
        for c in 0..3 {
            let off = (found.mean[c] - exact[c]).abs();
            assert!(
                off < 0.002 + 5.0 * found.stderr[c] && found.stderr[c] < 0.001,
                "cut at {cut}: {:?} ± {:?}, expected {exact:?}",
                found.mean,
                found.stderr
            );
        }
    }
}

/// Solids that touch and lie within each other: a scattering ball in a bath of another white medium does not show.
#[test]
fn media_within_media_cannot_be_seen_in_a_furnace() {
    let medium = |s: f64, g: f64| Medium {
        scattering: grey(s),
        phase: Phase::HenyeyGreenstein(g),
        ..Medium::default()
    };
    let mut scene = scene(DVec3::new(0.3, 0.4, -4.0), 0.5, 1.0);
    ball(&mut scene, glass(1.33, 0.0, None, medium(1.0, 0.5)));
    let core = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 0.5,
    };
    place(&mut scene, core, glass(1.5, 0.0, None, medium(4.0, 0.0)));
    // Two cubes face to face in front of it.
    for x in [-1.0, 0.0] {
        let unit = Shape::Box {
            min: DVec3::ZERO,
            max: DVec3::ONE,
        };
        let material = scene.add_material(glass(1.4, 0.0, None, medium(1.0 - x, 0.2)));
        let moved = Object::new(unit).with_material(material);
        let to = DAffine3::from_translation(DVec3::new(x, -0.5, -2.5));
        scene.objects.push(moved.transformed(to));
    }
    mean(&scene, 1024).assert_near([1.0; 3], 0.02, 5.0, "media in contact");
}
