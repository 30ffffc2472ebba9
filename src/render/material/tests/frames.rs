//! Frames: normals of coats and bases, directions of anisotropy.

use super::*;
use crate::math::frame::Frame;
use crate::math::robust::try_normalize;

/// A world whose texture 0 leans normals by `lean` (x, y of the unit normal), tangent +x, bitangent +y.
fn leaning(lean: Vec2) -> World {
    let z = (1.0 - lean.length_squared()).sqrt();
    let texel = (lean.extend(z) * 0.5 + Vec3::splat(0.5)).extend(1.0);
    let mut world = World::default();
    world.textures.nodes = vec![Texture::Constant(texel)];
    (world.attrs.tangent, world.attrs.bitangent) = (Vec3::X, Vec3::Y);
    world
}

fn varnished(strength: f32) -> Material {
    let map = NormalMap { texture: 0, scale: 1.0 };
    let mut m = Material::new(SurfaceModel::Principled(Box::new(PrincipledInputs {
        clearcoat: ScalarInput::constant(strength),
        metallic: ScalarInput::constant(1.0),
        roughness: ScalarInput::constant(0.3),
        coat_apart: true,
        ..principled()
    })));
    m.normal_map = Some(map);
    m
}

/// The model at a point as the kernel makes it, with its frame.
fn layered(m: &Material, world: &World, wo: Vec3) -> (Frame, Bsdf) {
    let cx = world.shading();
    let frame = m.shading_frame(&cx, Vec3::Z, Vec3::Z, wo);
    let mut bsdf = m.bsdf(&cx, &mut || panic!("no choice to make"));
    if let Bsdf::Principled(p) = &mut bsdf {
        p.lean = m.lean_of_base(&cx, &frame, Vec3::Z, Vec3::Z, wo);
    }
    (frame, bsdf)
}

/// Smooth varnish over brushed flakes: it mirrors about the surface's own normal, while the base's highlight is where
/// its relief sends it. Both sides alike.
#[test]
fn a_coat_is_smooth_over_a_base_under_relief() {
    let lean = Vec2::new(0.25, -0.1);
    let world = leaning(lean);
    for side in [1.0, -1.0] {
        let wo = Vec3::new(0.2, 0.1, side * 0.97).normalize();
        let (frame, bsdf) = layered(&varnished(1.0), &world, wo);
        assert_eq!(frame.n, Vec3::Z);
        let local = frame.to_local(wo);
        let coat = bsdf.sample(local, Vec2::splat(0.5), 0.0).unwrap();
        assert!(coat.delta);
        let wi = frame.to_world(coat.wi);
        assert!((wi - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-6, "{wi}");
        // The base is brightest about its own mirror direction.
        let n = lean.extend((1.0 - lean.length_squared()).sqrt());
        let peak = n * (2.0 * n.dot(wo)) - wo;
        let at = |wi: Vec3| bsdf.eval(local, frame.to_local(wi)).x;
        for aside in [Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y] {
            let other = try_normalize(peak + aside * 0.2).unwrap();
            assert!(
                at(peak) > 1.2 * at(other),
                "{side} {aside}: {} and {}",
                at(peak),
                at(other)
            );
        }
    }
}

#[test]
fn without_a_coat_the_frame_is_that_of_the_relief() {
    let lean = Vec2::new(0.25, -0.1);
    let world = leaning(lean);
    let (frame, bsdf) = layered(&varnished(0.0), &world, Vec3::Z);
    assert!((frame.n.truncate() - lean).length() < 1e-6, "{}", frame.n);
    assert!(matches!(bsdf, Bsdf::Metal(_)));
}

/// A coat with a normal map of its own over a base without: the coat leans, the base does not.
#[test]
fn a_coat_may_have_relief_of_its_own() {
    let lean = Vec2::new(0.1, 0.2);
    let world = leaning(lean);
    let mut m = varnished(1.0);
    let map = m.normal_map.take();
    if let SurfaceModel::Principled(p) = &mut m.surface {
        p.clearcoat_normal = map;
    }
    let (frame, bsdf) = layered(&m, &world, Vec3::Z);
    assert!((frame.n.truncate() - lean).length() < 1e-6, "{}", frame.n);
    let Bsdf::Principled(p) = bsdf else { panic!("{bsdf:?}") };
    let base = frame.to_world(p.lean.extend((1.0 - p.lean.length_squared()).sqrt()));
    assert!((base - Vec3::Z).length() < 1e-6, "{base}");
    // The same map for both is one normal for both, to the bit.
    m.normal_map = map;
    let (_, bsdf) = layered(&m, &world, Vec3::Z);
    assert!(matches!(bsdf, Bsdf::Principled(p) if p.lean == Vec2::ZERO));
}

/// White below and a lossless coat: all light comes back, however the base leans. 40 000 samples of weights below 3 that
/// differ by about 0.3 have five standard errors of 0.008; 1 % is the tables' own error.
#[test]
fn leaning_layers_lose_no_light() {
    let mut rng = Pcg::new(17);
    for lean in [Vec2::new(0.3, 0.0), Vec2::new(-0.4, 0.3)] {
        let world = leaning(lean);
        for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.95, 0.312_25)] {
            for roughness in [0.0, 0.4] {
                let mut m = varnished(1.0);
                if let SurfaceModel::Principled(p) = &mut m.surface {
                    p.clearcoat_roughness = ScalarInput::constant(roughness);
                    p.sheen_color = ColorInput::constant(Vec3::splat(0.4));
                    p.sheen_roughness = ScalarInput::constant(0.5);
                }
                let (frame, bsdf) = layered(&m, &world, wo);
                let n = 40_000;
                let mut sum = 0.0;
                for _ in 0..n {
                    let s = bsdf.sample(frame.to_local(wo), rng.next_vec2(), rng.next_f32());
                    assert!(s.is_none_or(|s| s.wi.z > 0.0), "{s:?} goes through");
                    sum += s.map_or(0.0, |s| f64::from(s.weight.x));
                }
                let mean = sum / f64::from(n);
                assert!((mean - 1.0).abs() < 0.018, "{lean} {wo} {roughness}: {mean}");
            }
        }
    }
}

/// Oracle: the extension's text. (2·red − 1, 2·green − 1) turned counter-clockwise by the rotation, along tangent and
/// bitangent; a neutral texel is no direction and leaves the tangent.
#[test]
fn roughness_grows_along_the_direction_of_the_texture() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for (texel, rotation, wanted) in [
        (Vec2::new(1.0, 0.5), 0.0f32, Vec2::X),
        (Vec2::new(0.5, 1.0), 0.0, Vec2::Y),
        (Vec2::new(1.0, 1.0), 0.0, Vec2::new(half, half)),
        (Vec2::new(1.0, 0.5), std::f32::consts::FRAC_PI_2, Vec2::Y),
        (Vec2::new(0.5, 1.0), std::f32::consts::FRAC_PI_2, -Vec2::X),
        (Vec2::new(0.5, 0.5), std::f32::consts::FRAC_PI_4, Vec2::new(half, half)),
    ] {
        for mirrored in [1.0, -1.0] {
            let mut world = leaning(Vec2::ZERO);
            world.textures.nodes = vec![Texture::Constant(texel.extend(1.0).extend(1.0))];
            world.attrs.bitangent *= mirrored;
            let m = Material::new(SurfaceModel::Principled(Box::new(PrincipledInputs {
                anisotropy: ScalarInput::constant(0.5),
                anisotropy_rotation: rotation,
                anisotropy_direction: Some(0),
                ..principled()
            })));
            let frame = m.shading_frame(&world.shading(), Vec3::Z, Vec3::Z, Vec3::Z);
            let along = Vec2::new(wanted.x, wanted.y * mirrored);
            assert!(
                (frame.t.truncate() - along).length() < 1e-6,
                "{texel} {rotation}: {}",
                frame.t
            );
        }
    }
}
