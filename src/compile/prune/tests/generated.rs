//! Generated scenes with everything that passes tell apart.

use super::*;

fn one_of<T: Clone>(rng: &mut Pcg, all: &[T]) -> T {
    all[rng.next_u32() as usize % all.len()].clone()
}

pub(super) fn chance(rng: &mut Pcg, one_in: u32) -> bool {
    rng.next_u32().is_multiple_of(one_in)
}

/// An RGBA image of 2 × 2 texels.
pub(super) fn png(texels: [[u8; 4]; 4]) -> ImageSource {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(texels.as_flattened()).expect("texels");
    writer.finish().expect("an image");
    ImageSource::Bytes(bytes.into())
}

/// Adds images of all kinds that passes tell apart, and textures of each, constants, vertex colours and products.
pub(super) fn add_textures(scene: &mut Scene) {
    let mixed = [
        [10, 200, 30, 0],
        [250, 20, 99, 255],
        [80, 80, 200, 128],
        [0, 255, 7, 30],
    ];
    let opaque = mixed.map(|[r, g, b, _]| [r, g, b, 255]);
    for (name, source) in [
        ("mixed", png(mixed)),
        ("opaque", png(opaque)),
        ("uniform", png([[90, 160, 40, 200]; 4])),
        ("black", png([[0, 0, 0, 255]; 4])),
        ("flat", png([[128, 127, 255, 255]; 4])),
    ] {
        scene.add_image(Image {
            name: name.to_owned(),
            source,
            fallback: None,
            place: Place::None,
        });
    }
    for image in 0..5 {
        for encoding in [Encoding::Srgb, Encoding::Linear] {
            scene.add_texture(Texture::Image(ImageTexture {
                image: ImageId(image),
                uv_set: 0,
                uv_transform: DAffine2::from_scale(glam::DVec2::new(1.7, -0.6)),
                wrap_u: Wrap::Mirror,
                wrap_v: Wrap::Clamp,
                filter: TexelFilter::Bilinear,
                encoding,
            }));
        }
    }
    scene.add_texture(Texture::Constant(DVec4::ONE));
    scene.add_texture(Texture::Constant(DVec4::new(0.3, 0.6, 0.9, 0.7)));
    scene.add_texture(Texture::VertexColor);
    for (a, b) in [(0, 10), (10, 12), (11, 3), (2, 12), (4, 11)] {
        scene.add_texture(Texture::Product(TextureId(a), TextureId(b)));
    }
}

fn texture(scene: &Scene, rng: &mut Pcg) -> TextureId {
    TextureId(rng.next_u32() % scene.textures.len() as u32)
}

fn color(scene: &Scene, rng: &mut Pcg) -> ColorInput {
    ColorInput {
        factor: one_of(rng, &[DVec3::ZERO, DVec3::ONE, DVec3::new(0.9, 0.5, 0.3)]),
        texture: chance(rng, 2).then(|| texture(scene, rng)),
    }
}

fn scalar(scene: &Scene, rng: &mut Pcg) -> ScalarInput {
    let channels = [Channel::R, Channel::G, Channel::B, Channel::A];
    ScalarInput {
        factor: one_of(rng, &[0.0, 1.0, 0.4]),
        texture: chance(rng, 2).then(|| (texture(scene, rng), one_of(rng, &channels))),
        offset: one_of(rng, &[0.0, 0.0, 0.5]),
    }
}

fn surface(scene: &mut Scene, rng: &mut Pcg, depth: u32) -> SurfaceModel {
    let color = color(scene, rng);
    match rng.next_u32() % 9 {
        0 => SurfaceModel::Black,
        1 => SurfaceModel::Diffuse {
            color,
            sigma: scalar(scene, rng),
        },
        2 => SurfaceModel::Glass {
            color,
            ior: one_of(rng, &[1.0, 1.5]),
            roughness: scalar(scene, rng),
            abbe: chance(rng, 2).then_some(40.0),
        },
        3 => SurfaceModel::Glossy {
            color,
            roughness: scalar(scene, rng),
            ior: 1.5,
            metal: chance(rng, 2),
        },
        4 => SurfaceModel::Translucent {
            color,
            transmit: scalar(scene, rng),
        },
        5 => SurfaceModel::Principled(Box::new(Principled {
            base_color: color,
            metallic: scalar(scene, rng),
            roughness: scalar(scene, rng),
            ior: one_of(rng, &[1.0, 1.5]),
            specular: scalar(scene, rng),
            specular_color: self::color(scene, rng),
            transmission: scalar(scene, rng),
            thick: chance(rng, 2),
            clearcoat: scalar(scene, rng),
            clearcoat_roughness: scalar(scene, rng),
            clearcoat_normal: chance(rng, 4).then(|| NormalMap {
                texture: texture(scene, rng),
                scale: 1.0,
            }),
            sheen_color: self::color(scene, rng),
            sheen_roughness: scalar(scene, rng),
            anisotropy: scalar(scene, rng),
            anisotropy_rotation: 0.5,
            anisotropy_direction: chance(rng, 4).then(|| texture(scene, rng)),
            diffuse_transmission: scalar(scene, rng),
            diffuse_transmission_color: self::color(scene, rng),
            dispersion: one_of(rng, &[0.0, 0.3]),
            iridescence: scalar(scene, rng),
            iridescence_ior: one_of(rng, &[1.0, 1.3]),
            iridescence_thickness: ScalarInput {
                factor: one_of(rng, &[0.0, 300.0]),
                ..scalar(scene, rng)
            },
        })),
        6 => SurfaceModel::Finish(Box::new(Finish {
            color,
            filter: one_of(rng, &[0.0, 0.3, 1.0]),
            transmit: one_of(rng, &[0.0, 0.2, 1.0]),
            phong: one_of(rng, &[0.0, 0.5]),
            diffuse_back: one_of(rng, &[0.0, 0.5]),
            ior: one_of(rng, &[None, Some(1.0), Some(1.4)]),
            reflection: chance(rng, 2).then(|| FinishReflection {
                min: DVec3::ZERO,
                max: one_of(rng, &[DVec3::ZERO, DVec3::splat(0.5)]),
                falloff: 1.0,
                fresnel: chance(rng, 2),
                metallic: 0.0,
            }),
            ..Finish::default()
        })),
        _ if depth < 3 => {
            let [a, b] = [0, 1].map(|_| {
                let part = material(scene, rng, depth + 1);
                scene.add_material(part)
            });
            let weight = scalar(scene, rng);
            SurfaceModel::Mix { a, b, weight }
        }
        _ => SurfaceModel::Black,
    }
}

pub(super) fn material(scene: &mut Scene, rng: &mut Pcg, depth: u32) -> Material {
    let mut m = Material::new(surface(scene, rng, depth));
    if chance(rng, 5) {
        m.emission = color(scene, rng);
    }
    if chance(rng, 3) {
        m.interior.absorption = DVec3::new(0.3, 0.1, 0.0);
        m.interior.scattering = one_of(rng, &[DVec3::ZERO, DVec3::new(0.0, 0.4, 0.4)]);
    }
    m.opacity.mode = one_of(
        rng,
        &[
            OpacityMode::Opaque,
            OpacityMode::Opaque,
            OpacityMode::Blend,
            OpacityMode::Mask(0.5),
        ],
    );
    m.opacity.alpha = scalar(scene, rng);
    m.normal_map = chance(rng, 3).then(|| NormalMap {
        texture: texture(scene, rng),
        scale: one_of(rng, &[0.0, 1.0]),
    });
    m.bump_map = chance(rng, 4).then(|| BumpMap {
        texture: texture(scene, rng),
        scale: one_of(rng, &[0.0, 0.3]),
    });
    m
}

/// A quad in the xy plane with everything that a vertex may have.
pub(super) fn quad(colors: bool) -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions: Vec<DVec3> = corners.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
    let mut mesh = Mesh::from_f64("quad", &positions, &[[0, 2, 1], [0, 3, 2]]).expect("indices in range");
    mesh.uvs = vec![corners.map(|[x, y]| Vec2::new(x as f32, y as f32) * 0.5 + 0.5).to_vec()];
    mesh.tangents = vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4];
    if colors {
        mesh.colors = (0..4)
            .map(|i| Vec4::new(0.2 * i as f32, 0.5, 1.0 - 0.3 * i as f32, 1.0))
            .collect();
    }
    mesh
}

pub(super) fn lamp(position: DVec3, color: DVec3) -> Light {
    Light {
        name: String::new(),
        color,
        kind: LightKind::Point {
            position,
            falloff: Falloff::None,
        },
        casts_shadows: true,
        motion: Vec::new(),
        place: Place::None,
    }
}

/// Shapes in front of the camera, over a ground that the camera is not inside of; `plain` ones have no dark lights.
pub(super) fn scene(seed: u64, plain: bool) -> Scene {
    let mut rng = Pcg::new(seed);
    let rng = &mut rng;
    let mut scene = Scene::default();
    add_textures(&mut scene);
    let quads = [scene.add_mesh(quad(false)), scene.add_mesh(quad(true))];
    let ground = scene.add_material(Material::diffuse(DVec3::splat(0.7)));
    scene.objects.push(
        Object::new(Shape::Plane {
            normal: DVec3::Y,
            distance: -1.2,
        })
        .with_material(ground),
    );
    let mut members = Vec::new();
    for _ in 0..2 + rng.next_u32() % 5 {
        let look = material(&mut scene, rng, 0);
        let look = scene.add_material(look);
        let unit = |rng: &mut Pcg| f64::from(rng.next_f32()) * 2.0 - 1.0;
        let place = DAffine3::from_translation(DVec3::new(unit(rng), unit(rng), 0.7 * unit(rng)));
        let shape = match rng.next_u32() % 4 {
            0 => Shape::Sphere {
                center: DVec3::ZERO,
                radius: 0.6,
            },
            1 => Shape::Box {
                min: DVec3::splat(-0.4),
                max: DVec3::splat(0.5),
            },
            _ => Shape::Mesh(one_of(rng, &quads)),
        };
        let mut object = Object::new(shape).with_material(look).transformed(place);
        if chance(rng, 8) {
            object.visibility = Visibility {
                camera: false,
                shadow: chance(rng, 2),
                indirect: false,
            };
        }
        if chance(rng, 6) {
            let end = DAffine3::from_translation(one_of(rng, &[DVec3::ZERO, DVec3::X * 0.3]));
            object.motion = vec![DAffine3::IDENTITY, end];
        }
        if chance(rng, 3) {
            members.push(object);
        } else {
            scene.objects.push(object);
        }
    }
    let group = scene.add_group(members);
    let turn = DAffine3::from_rotation_y(0.4);
    scene.objects.push(Object::new(Shape::Group(group)).transformed(turn));
    scene.lights.push(lamp(DVec3::new(2.0, 3.0, -3.0), DVec3::ONE));
    scene.cameras.push(Camera {
        location: DVec3::new(0.0, 0.0, -5.0),
        lens_radius: one_of(rng, &[0.0, 0.05]),
        focus_distance: 4.0,
        ..Camera::default()
    });
    scene.active_camera = Some(0);
    scene.environment.kind = EnvironmentKind::Constant(DVec3::splat(0.2));
    if !plain && chance(rng, 3) {
        scene.lights.push(lamp(DVec3::new(-2.0, 3.0, -3.0), DVec3::ZERO));
    }
    if !plain && chance(rng, 3) {
        scene.environment.kind = EnvironmentKind::Constant(DVec3::ZERO);
    }
    scene
}
