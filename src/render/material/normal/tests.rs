//! Tests of reliefs: height maps against planes and against each other.

use crate::math::stats::Pcg;
use crate::math::warp::uniform_sphere;
use crate::pictures::Texels;
use crate::render::material::{BumpMap, ColorInput, Material, ScalarInput, Shading, SurfaceModel};
use crate::render::surface::Attributes;
use crate::render::texture::{ImageData, ImageTexture, Texture, Textures, Wrap};
use glam::{Affine2, Mat2, Vec2, Vec3};

/// What a material reads, owned.
#[derive(Default)]
struct World {
    textures: Textures,
    attrs: Attributes,
}

impl World {
    fn shading(&self) -> Shading<'_> {
        Shading {
            materials: &[],
            textures: &self.textures,
            attrs: &self.attrs,
            outer_ior: 1.0,
            wavelength: None,
        }
    }
}

fn white() -> Material {
    Material::new(SurfaceModel::Diffuse {
        color: ColorInput::constant(Vec3::ONE),
        sigma: ScalarInput::constant(0.0),
    })
}

/// A world whose texture 0 is this image, bilinear and repeated, at the middle of it, on a surface in the xy plane that
/// faces +z with these directions of u and of the top.
fn relief(texels: Vec<f32>, width: u32, uv_transform: Affine2, frame: [Vec3; 2]) -> World {
    let height = texels.len() as u32 / width;
    let image = ImageData::new(width, height, Texels::GrayF32(texels));
    let mut world = World::default();
    world.textures.images = image.into_iter().collect();
    world.textures.nodes = vec![Texture::Image(ImageTexture {
        image: 0,
        uv_set: 0,
        uv_transform,
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        bilinear: true,
        srgb: false,
    })];
    world.attrs.uv = [uv_transform.inverse().transform_point2(Vec2::splat(0.5)); 4];
    [world.attrs.tangent, world.attrs.bitangent] = frame;
    world
}

fn raised(world: &World, scale: f32, ns: Vec3) -> Vec3 {
    let mut m = white();
    m.bump_map = Some(BumpMap { texture: 0, scale });
    m.shading_frame(&world.shading(), ns, ns, ns).n
}

/// An image of 8x8 texels that rises by these amounts a texel to the right and to the top.
fn ramp(right: f32, up: f32) -> Vec<f32> {
    let texel = |i: u32| 0.5 + right * (i % 8) as f32 - up * (i / 8) as f32;
    (0..64).map(texel).collect()
}

/// Oracle: the plane z = a·x + b·y has the normal (−a, −b, 1); here a and b are heights per texel.
#[test]
fn a_ramp_tilts_the_normal_away_from_its_rise() {
    let plane = [Vec3::X * 9.0, Vec3::Y * 3.0]; // lengths do not count
    for (right, up, scale) in [
        (0.03, 0.0, 4.0),
        (0.0, 0.02, 10.0),
        (-0.01, 0.05, -7.0),
        (0.02, 0.02, 30.0),
    ] {
        let world = relief(ramp(right, up), 8, Affine2::IDENTITY, plane);
        let want = Vec3::new(-right * scale, -up * scale, 1.0).normalize();
        let n = raised(&world, scale, Vec3::Z);
        // The slope comes from differences of values of about 1: a few roundings of 2⁻²⁴, times the scale.
        assert!(
            (n - want).length() < 8.0 * 6e-8 * (1.0 + scale.abs()),
            "{n}, expected {want}"
        );
    }
}

/// A transform of the coordinates turns the image on the surface, and the relief with it: mirrored, the ramp rises the
/// other way; turned by 90°, what rose to the right rises to the top or the bottom.
#[test]
fn the_relief_goes_with_the_image() {
    let plane = [Vec3::X, Vec3::Y];
    let lean = |m: Mat2| {
        let transform = Affine2::from_mat2_translation(m, Vec2::splat(0.5) - m * Vec2::splat(0.5));
        let n = raised(&relief(ramp(0.1, 0.0), 8, transform, plane), 1.0, Vec3::Z);
        (n / n.z * -10.0).truncate().round()
    };
    assert_eq!(lean(Mat2::IDENTITY), Vec2::X);
    assert_eq!(lean(Mat2::from_diagonal(Vec2::new(-2.0, 1.0))), -Vec2::X);
    // u of the image is v of the surface, which grows downwards.
    assert_eq!(lean(Mat2::from_cols(Vec2::NEG_Y, Vec2::X)), -Vec2::Y);
    // The bitangent of a mirrored mesh goes the other way, and so does what rises to the top.
    let mirrored = relief(ramp(0.0, 0.1), 8, Affine2::IDENTITY, [Vec3::X, -Vec3::Y]);
    assert!(raised(&mirrored, 1.0, Vec3::Z).y > 0.0);
}

/// The gradient's products with the directions of rows and columns are the slopes along them, at any angle between them.
#[test]
fn a_skew_frame_keeps_the_slopes_along_its_axes() {
    let [u, v] = [Vec3::X, Vec3::new(0.6, 0.8, 0.0)];
    let n = raised(&relief(ramp(0.03, 0.05), 8, Affine2::IDENTITY, [u, v]), 1.0, Vec3::Z);
    let gradient = -n / n.z;
    assert!(
        (gradient.dot(u) - 0.03).abs() < 1e-6 && (gradient.dot(v) - 0.05).abs() < 1e-6,
        "{n}"
    );
}

/// A sheet is raised towards whoever looks at it; a solid has one shape, whose dents are bumps from inside.
#[test]
fn a_relief_is_raised_towards_the_viewer_unless_it_is_a_solids() {
    let world = relief(ramp(0.1, 0.0), 8, Affine2::IDENTITY, [Vec3::X, Vec3::Y]);
    let mut m = white();
    m.bump_map = Some(BumpMap { texture: 0, scale: 1.0 });
    // Normals on the side of ng. Seen from behind, the mirror image in the surface has the slope to the viewer.
    let lean = |m: &Material, wo: Vec3| m.shading_frame(&world.shading(), Vec3::Z, Vec3::Z, wo).n.x;
    assert!(lean(&m, Vec3::Z) < 0.0 && lean(&m, -Vec3::Z) > 0.0);
    m.interior = true;
    assert!(lean(&m, Vec3::Z) < 0.0 && lean(&m, -Vec3::Z) < 0.0);
}

/// What is flat, or has no frame or image, changes no bit of any normal.
#[test]
fn a_flat_relief_leaves_the_normal_alone() {
    let frame = [Vec3::new(0.3, -0.7, 0.2), Vec3::new(0.1, 0.4, 0.9)];
    let mut rng = Pcg::new(3);
    for _ in 0..1000 {
        let ns = uniform_sphere(rng.next_vec2());
        let flat = relief(vec![0.7; 64], 8, Affine2::IDENTITY, frame);
        let plain = white().shading_frame(&flat.shading(), ns, ns, ns).n;
        assert_eq!(raised(&flat, 5.0, ns), plain);
        let frameless = relief(ramp(0.1, 0.1), 8, Affine2::IDENTITY, [Vec3::ZERO; 2]);
        assert_eq!(raised(&frameless, 5.0, ns), plain);
        let parallel = relief(ramp(0.1, 0.1), 8, Affine2::IDENTITY, [frame[0], frame[0] * 2.0]);
        assert!(raised(&parallel, 5.0, ns).is_finite());
    }
}
