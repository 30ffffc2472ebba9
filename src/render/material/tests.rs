//! Tests of materials: choices, inputs, normals, straight passage.

mod frames;

use super::super::texture::Texture;
use super::*;
use crate::math::stats::Pcg;
use crate::math::warp::uniform_sphere;
use glam::{Vec2, Vec4};

/// Everything a material reads, owned.
#[derive(Default)]
struct World {
    materials: Vec<Material>,
    textures: Textures,
    attrs: Attributes,
}

impl World {
    fn shading(&self) -> Shading<'_> {
        Shading {
            materials: &self.materials,
            textures: &self.textures,
            attrs: &self.attrs,
            outer_ior: 1.0,
            wavelength: None,
        }
    }
}

fn diffuse(albedo: Vec3) -> Material {
    Material::new(SurfaceModel::Diffuse {
        color: ColorInput::constant(albedo),
        sigma: ScalarInput::constant(0.0),
    })
}

fn mix(a: u32, b: u32, weight: f32) -> Material {
    let weight = ScalarInput::constant(weight);
    Material::new(SurfaceModel::Mix { a, b, weight })
}

fn glass(roughness: f32) -> Material {
    let color = ColorInput::constant(Vec3::new(1.0, 0.5, 0.25));
    let roughness = ScalarInput::constant(roughness);
    Material::new(SurfaceModel::Glass { color, roughness })
}

fn principled() -> PrincipledInputs {
    let zero = ScalarInput::constant(0.0);
    let one = ScalarInput::constant(1.0);
    PrincipledInputs {
        base_color: ColorInput::WHITE,
        metallic: zero,
        roughness: ScalarInput::constant(0.5),
        ior: 1.5,
        specular: one,
        specular_color: ColorInput::WHITE,
        transmission: zero,
        thick: false,
        clearcoat: zero,
        clearcoat_roughness: zero,
        clearcoat_normal: None,
        coat_apart: false,
        sheen_color: ColorInput::BLACK,
        sheen_roughness: zero,
        anisotropy: zero,
        anisotropy_rotation: 0.0,
        anisotropy_direction: None,
        diffuse_transmission: zero,
        diffuse_transmission_color: ColorInput::WHITE,
        iridescence: zero,
        iridescence_ior: 1.3,
        iridescence_thickness: ScalarInput::constant(400.0),
    }
}

fn finish() -> FinishInputs {
    FinishInputs {
        color: ColorInput::constant(Vec3::new(0.8, 0.4, 0.2)),
        filter: 0.0,
        transmit: 0.0,
        diffuse: 0.6,
        diffuse_back: 0.0,
        brilliance: 1.0,
        phong: 0.0,
        phong_size: 40.0,
        specular: 0.0,
        roughness: 0.05,
        metallic: 0.0,
        reflection_min: Vec3::ZERO,
        reflection_max: Vec3::ZERO,
        reflection_falloff: 1.0,
        reflection_fresnel: false,
        reflection_metallic: 0.0,
        conserve_energy: false,
        ior: None,
    }
}

/// Mean albedo over many choices.
fn mean_albedo(material: &Material, world: &World, wo: Vec3) -> Vec3 {
    let mut rng = Pcg::new(2);
    let n = 40_000;
    let sum: Vec3 = (0..n)
        .map(|_| material.bsdf(&world.shading(), &mut || rng.next_f32()).albedo(wo))
        .sum();
    sum / n as f32
}

/// 0.75·(0.5·red + 0.5·green) + 0.25·blue; 40 000 choices have a standard deviation below 0.0025, ×5.
#[test]
fn nested_mixtures_are_chosen_by_their_weights() {
    let world = World {
        materials: vec![diffuse(Vec3::X), diffuse(Vec3::Y), diffuse(Vec3::Z), mix(0, 1, 0.5)],
        ..World::default()
    };
    let got = mean_albedo(&mix(3, 2, 0.25), &world, Vec3::Z);
    let off = (got - Vec3::new(0.375, 0.375, 0.25)).abs().max_element();
    assert!(off < 0.0125, "{got}");
}

#[test]
fn mixtures_that_contain_themselves_are_black() {
    let world = World {
        materials: vec![mix(0, 0, 0.5)],
        ..World::default()
    };
    let m = &world.materials[0];
    assert_eq!(m.bsdf(&world.shading(), &mut || 0.3), Bsdf::Black);
    assert_eq!(m.straight_transmittance(&world.shading(), 1.0, true), Vec3::ZERO);
}

#[test]
fn certain_choices_ask_for_no_numbers() {
    let world = World::default();
    let p = Material::new(SurfaceModel::Principled(Box::new(principled())));
    for m in [diffuse(Vec3::ONE), glass(0.3), p] {
        m.bsdf(&world.shading(), &mut || panic!("no choice to make"));
    }
}

/// Every part of the mixture is lossless, so is the whole, at any incidence; 3 % is the albedo estimates' own error.
#[test]
fn a_white_principled_surface_stays_white() {
    let world = World::default();
    let inputs = PrincipledInputs {
        metallic: ScalarInput::constant(0.3),
        transmission: ScalarInput::constant(0.4),
        clearcoat: ScalarInput::constant(0.8),
        sheen_color: ColorInput::constant(Vec3::splat(0.5)),
        sheen_roughness: ScalarInput::constant(0.4),
        ..principled()
    };
    let m = Material::new(SurfaceModel::Principled(Box::new(inputs)));
    for cos in [1.0f32, 0.5, 0.1] {
        let got = mean_albedo(&m, &world, Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos));
        assert!((got - Vec3::ONE).abs().max_element() < 0.03, "{cos}: {got}");
    }
}

/// A lamp of colour C gives irradiance π·C·cosθ, so pigment·diffuse·C·cosθ is what POV-Ray shows.
#[test]
fn a_pigment_under_a_lamp_looks_as_in_pov_ray() {
    let world = World::default();
    let m = Material::new(SurfaceModel::Finish(Box::new(finish())));
    let wi = Vec3::new(0.6, 0.0, 0.8);
    let got = m.bsdf(&world.shading(), &mut || 0.5).eval(Vec3::Z, wi) * std::f32::consts::PI;
    let want = Vec3::new(0.8, 0.4, 0.2) * 0.6 * 0.8;
    assert!((got - want).abs().max_element() < 1e-6, "{got}, {want}");
}

#[test]
fn lamps_shine_straight_through_smooth_glass_only() {
    let world = World::default();
    let cx = world.shading();
    let through = |m: &Material| m.straight_transmittance(&cx, 1.0, true);
    let want = Vec3::new(1.0, 0.5, 0.25) * 0.96; // F = 0.04 at 1.5
    assert!((through(&glass(0.0)) - want).abs().max_element() < 1e-6);
    assert_eq!(through(&glass(0.5)), Vec3::ZERO);
    assert_eq!(through(&diffuse(Vec3::ONE)), Vec3::ZERO);
    assert!(glass(0.0).may_pass_straight(&[]) && !diffuse(Vec3::ONE).may_pass_straight(&[]));
    assert!(mix(0, 1, 0.5).may_pass_straight(&[diffuse(Vec3::ONE), glass(0.0)]));
    let filtered = FinishInputs {
        filter: 0.5,
        transmit: 0.25,
        ..finish()
    };
    let got = through(&Material::new(SurfaceModel::Finish(Box::new(filtered))));
    assert!((got - Vec3::new(0.65, 0.45, 0.35)).abs().max_element() < 1e-6, "{got}");
    let thin = PrincipledInputs {
        transmission: ScalarInput::constant(0.5),
        roughness: ScalarInput::constant(0.0),
        ..principled()
    };
    let got = through(&Material::new(SurfaceModel::Principled(Box::new(thin))));
    assert!((got - Vec3::splat(0.48)).abs().max_element() < 1e-6, "{got}");
}

/// Glass in glass of the same index is invisible; the relative index is inside over outside.
#[test]
fn nested_glass_refracts_relative_to_what_encloses_it() {
    let world = World::default();
    let cx = Shading {
        outer_ior: 1.5,
        ..world.shading()
    };
    let wo = Vec3::new(0.6, 0.0, 0.8);
    let sample = glass(0.0).bsdf(&cx, &mut || 0.5).sample(wo, Vec2::splat(0.5), 0.0);
    assert!(sample.is_some_and(|s| s.wi == -wo), "{sample:?}");
}

#[test]
fn any_roughness_makes_a_finite_model() {
    let world = World::default();
    let wo = Vec3::new(0.6, 0.0, 0.8);
    for roughness in [0.0, 1e-20, 1e-3, 0.01, 0.5, 1.0, 5.0, -1.0, f32::NAN] {
        let inputs = PrincipledInputs {
            roughness: ScalarInput::constant(roughness),
            ..principled()
        };
        for m in [
            glass(roughness),
            Material::new(SurfaceModel::Principled(Box::new(inputs))),
        ] {
            let b = m.bsdf(&world.shading(), &mut || 0.5);
            for u_lobe in [0.0, 0.3, 0.9] {
                let s = b.sample(wo, Vec2::new(0.3, 0.7), u_lobe);
                assert!(
                    s.is_none_or(|s| s.weight.is_finite() && s.pdf.is_finite()),
                    "{roughness}: {s:?}"
                );
            }
        }
    }
}

/// KHR_materials_dispersion: dispersion 20/V with V = 55 and n = 1.5168 spreads by (n−1)/V between blue and red.
#[test]
fn dispersion_follows_the_abbe_number() {
    let mut m = glass(0.0);
    (m.ior, m.dispersion) = (1.5168, 20.0 / 55.0);
    let at = |nm: f32| {
        let weight = Vec3::ONE;
        m.ior_at(Some(Wavelength { nm, weight }))
    };
    let spread = at(486.13) - at(656.27);
    assert!((spread - 0.5168 / 55.0).abs() < 1e-6, "{spread}");
    assert!((at(587.56) - m.ior_at(None)).abs() < 1e-6);
}

#[test]
fn emission_and_coverage_follow_their_modes() {
    let mut world = World::default();
    world.attrs.color = Vec4::new(1.0, 1.0, 1.0, 0.4);
    world.textures.nodes = vec![Texture::VertexColor];
    let mut m = diffuse(Vec3::ONE);
    m.emission = ColorInput::constant(Vec3::ONE);
    m.emits_back = false;
    assert_eq!(m.emission(&world.shading(), true, 1.0), Vec3::ONE);
    assert_eq!(m.emission(&world.shading(), false, 1.0), Vec3::ZERO);
    let value = ScalarInput {
        texture: Some((0, 3)),
        ..ScalarInput::constant(1.0)
    };
    for (alpha, want) in [
        (Alpha::Opaque, 1.0),
        (Alpha::Blend(value), 0.4),
        (Alpha::Mask(value, 0.5), 0.0),
        (Alpha::Mask(value, 0.4), 1.0),
    ] {
        m.alpha = alpha;
        assert_eq!(m.alpha(&world.shading()), want, "{alpha:?}");
    }
}

/// The normal that a flat normal-map colour gives on a surface facing +z, tangent +x, bitangent as given.
fn mapped(color: Vec3, bitangent: Vec3, scale: f32) -> Vec3 {
    let mut world = World::default();
    world.textures.nodes = vec![Texture::Constant(color.extend(1.0))];
    (world.attrs.tangent, world.attrs.bitangent) = (Vec3::X * 7.0, bitangent);
    let mut m = diffuse(Vec3::ONE);
    m.normal_map = Some(NormalMap { texture: 0, scale });
    m.shading_frame(&world.shading(), Vec3::Z, Vec3::Z, Vec3::Z).n
}

#[test]
fn red_leans_to_the_tangent_and_green_to_the_bitangent() {
    let lean = 0.5 + 0.5 * 0.6;
    let close = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-6, "{a}, expected {b}");
    close(mapped(Vec3::new(0.5, 0.5, 1.0), Vec3::Y, 1.0), Vec3::Z);
    close(
        mapped(Vec3::new(lean, 0.5, 0.9), Vec3::Y, 1.0),
        Vec3::new(0.6, 0.0, 0.8),
    );
    close(
        mapped(Vec3::new(0.5, lean, 0.9), Vec3::Y, 1.0),
        Vec3::new(0.0, 0.6, 0.8),
    );
    close(
        mapped(Vec3::new(0.5, lean, 0.9), -Vec3::Y, 1.0),
        Vec3::new(0.0, -0.6, 0.8),
    ); // mirrored uv
    close(mapped(Vec3::new(lean, 0.5, 0.9), Vec3::Y, 0.0), Vec3::Z);
    close(mapped(Vec3::new(0.5, 0.5, 0.0), Vec3::Y, 1.0), Vec3::Z); // into the surface: refused
}

/// For any normals on one side and any view: the view and its mirror direction lie on one side of the surface, and a
/// normal for which they do already stays as it is.
#[test]
fn the_view_is_mirrored_to_its_own_side() {
    let world = World::default();
    let m = diffuse(Vec3::ONE);
    let mut rng = Pcg::new(4);
    for _ in 0..100_000 {
        let (ng, wo) = (uniform_sphere(rng.next_vec2()), uniform_sphere(rng.next_vec2()));
        let ns = uniform_sphere(rng.next_vec2());
        let ns = if ns.dot(ng) < 0.0 { -ns } else { ns };
        let n = m.shading_frame(&world.shading(), ng, ns, wo).n;
        let side = ng.dot(wo).signum();
        let mirror = |n: Vec3| (n * (2.0 * n.dot(wo)) - wo).dot(ng) * side;
        assert!(
            (n.length() - 1.0).abs() < 1e-5 && n.dot(wo) * side > 0.0,
            "{ng} {ns} {wo}: {n}"
        );
        assert!(mirror(n) > -1e-6, "{ng} {ns} {wo}: mirrored to {}", mirror(n));
        assert!(n.dot(ng) > 0.0, "{ng} {ns} {wo}: {n} on the wrong side");
        if ns.dot(wo) * side > 0.0 && mirror(ns) > 0.011 {
            assert_eq!(n, ns);
        }
    }
}

/// Any inputs, extreme ones often: what is sampled is finite and its expected weight is at most 1. 4000 random points
/// have a standard deviation below 0.03 where weights stay below 4, ×5.
#[test]
fn any_inputs_make_a_surface_that_creates_no_light() {
    let world = World::default();
    let mut rng = Pcg::new(8);
    for case in 0..300 {
        let mut number = || match rng.next_u32() % 6 {
            0 => 0.0,
            1 => 1.0,
            2 => rng.next_f32() * 1e-3,
            _ => rng.next_f32(),
        };
        let mut scalar = || ScalarInput::constant(number());
        let p = PrincipledInputs {
            metallic: scalar(),
            roughness: scalar(),
            specular: scalar(),
            transmission: scalar(),
            clearcoat: scalar(),
            clearcoat_roughness: scalar(),
            sheen_roughness: scalar(),
            diffuse_transmission: scalar(),
            thick: case % 2 == 0,
            ior: 1.0 + scalar().factor,
            iridescence: scalar(),
            iridescence_ior: 1.0 + scalar().factor,
            iridescence_thickness: ScalarInput::constant(1000.0 * scalar().factor),
            base_color: ColorInput::constant(Vec3::new(scalar().factor, scalar().factor, scalar().factor)),
            sheen_color: ColorInput::constant(Vec3::new(scalar().factor, 0.0, scalar().factor)),
            ..principled()
        };
        let f = FinishInputs {
            filter: number(),
            transmit: number(),
            diffuse: number() * 2.0,
            diffuse_back: number(),
            brilliance: number() * 4.0,
            phong: number(),
            phong_size: number() * 200.0,
            specular: number(),
            roughness: number(),
            metallic: number(),
            reflection_min: Vec3::splat(number()),
            reflection_max: Vec3::splat(number()),
            reflection_falloff: number() * 8.0,
            reflection_fresnel: case % 3 == 0,
            reflection_metallic: number(),
            conserve_energy: case % 5 == 0,
            ior: (case % 2 == 0).then_some(1.5),
            ..finish()
        };
        let cos = number().max(1e-3) * if case % 4 == 0 { -1.0 } else { 1.0 };
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let surfaces = [SurfaceModel::Principled(Box::new(p)), SurfaceModel::Finish(Box::new(f))];
        for m in surfaces.map(Material::new) {
            let mut sum = Vec3::ZERO;
            for _ in 0..4000 {
                let b = m.bsdf(&world.shading(), &mut || rng.next_f32());
                if let Some(s) = b.sample(wo, rng.next_vec2(), rng.next_f32()) {
                    assert!(
                        s.weight.is_finite() && s.pdf > 0.0 && s.pdf.is_finite(),
                        "{m:?} {cos}: {s:?}"
                    );
                    assert!((s.wi.length() - 1.0).abs() < 1e-4, "{m:?} {cos}: {s:?}");
                    sum += s.weight * (s.eta * s.eta);
                }
            }
            let mean = sum / 4000.0;
            assert!(mean.max_element() < 1.15, "{m:?} at {cos} returns {mean}");
        }
    }
}

/// Roughness from 0 through numbers whose square vanishes to 1 and beyond: below a hundredth a surface is smooth, decided
/// here and once; above, rough (glass, which bends less than a mirror, from 0.0142 on). Every model is finite at every view, and a sample never gains by being drawn.
#[test]
fn every_roughness_is_a_mirror_or_a_sound_lobe() {
    let world = World::default();
    let mut rng = Pcg::new(8);
    for roughness in [
        0.0,
        1e-38,
        1e-20,
        1e-10,
        1e-4,
        0.0099,
        0.015,
        0.05,
        0.5,
        1.0,
        7.0,
        f32::NAN,
    ] {
        let amount = ScalarInput::constant(roughness);
        let color = ColorInput::WHITE;
        let smooth = roughness.is_nan() || roughness < 0.01;
        let glossy = |metal| {
            Material::new(SurfaceModel::Glossy {
                color,
                roughness: amount,
                metal,
            })
        };
        let thin = Material::new(SurfaceModel::Principled(Box::new(PrincipledInputs {
            roughness: amount,
            transmission: ScalarInput::constant(1.0),
            ..principled()
        })));
        for material in [glass(roughness), glossy(true), glossy(false), thin] {
            let bsdf = material.bsdf(&world.shading(), &mut || 0.5);
            let rough = !smooth;
            let has_facets = format!("{bsdf:?}").contains("Ggx");
            assert_eq!(has_facets, rough, "roughness {roughness}: {bsdf:?}");
            for cos in [1.0, 0.5, 1e-2, 1e-4, 1e-20, -1e-20, -0.5] {
                let wo = Vec3::new((1.0f32 - cos * cos).sqrt(), 0.0, cos);
                for _ in 0..100 {
                    let u = rng.next_vec2();
                    let Some(s) = bsdf.sample(wo, u, rng.next_f32()) else {
                        continue;
                    };
                    assert!(
                        s.weight.is_finite() && s.weight.min_element() >= 0.0 && s.pdf > 0.0 && s.pdf.is_finite(),
                        "roughness {roughness}, {wo}: {s:?}"
                    );
                    assert!((s.wi.length() - 1.0).abs() < 1e-6, "roughness {roughness}, {wo}: {s:?}");
                }
            }
        }
    }
}
