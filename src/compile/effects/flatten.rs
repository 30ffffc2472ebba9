//! Each image of a surface becomes its mean colour. What covers and what bends normals stays as it is.

use super::image_inputs;
use crate::files::Files;
use crate::math::color::linear_from_srgb;
use crate::pictures::{self, Limits, Picture};
use crate::scene::{Encoding, Image, ImageSource, ImageTexture, Scene, SurfaceModel, Texture, TextureId};
use glam::DVec4;
use std::collections::BTreeMap;

/// Products nested deeper than this are left alone; `compile` refuses loops.
const DEEPEST: u32 = 16;

/// Replaces the images that colour surfaces.
pub fn images(scene: &mut Scene, files: &dyn Files) {
    keep_shapes(scene);
    let mut means = BTreeMap::new();
    let inputs: Vec<TextureId> = scene.materials.iter().flat_map(image_inputs).collect();
    let mut queue: Vec<(TextureId, u32)> = inputs.into_iter().map(|t| (t, 0)).collect();
    while let Some((id, depth)) = queue.pop() {
        let mean = match scene.textures.get(id.index()) {
            Some(Texture::Product(a, b)) if depth < DEEPEST => {
                queue.extend([(*a, depth + 1), (*b, depth + 1)]);
                continue;
            }
            Some(Texture::Image(image)) => {
                let key = (image.image, image.encoding == Encoding::Srgb);
                *means.entry(key).or_insert_with(|| mean(scene, image, files))
            }
            _ => continue,
        };
        // An image that cannot be read is left to `compile`, which has told so already.
        if let (Some(mean), Some(texture)) = (mean, scene.textures.get_mut(id.index())) {
            *texture = Texture::Constant(mean);
        }
    }
}

/// Gives coverage, normal maps and height maps textures of their own, which nobody else shares.
fn keep_shapes(scene: &mut Scene) {
    for i in 0..scene.materials.len() {
        let mut material = scene.materials[i].clone();
        if let Some((texture, _)) = &mut material.opacity.alpha.texture {
            *texture = copy(scene, *texture, 0);
        }
        let coat = match &mut material.surface {
            SurfaceModel::Principled(p) => p.clearcoat_normal.as_mut(),
            _ => None,
        };
        for map in [material.normal_map.as_mut(), coat].into_iter().flatten() {
            map.texture = copy(scene, map.texture, 0);
        }
        if let Some(map) = &mut material.bump_map {
            map.texture = copy(scene, map.texture, 0);
        }
        scene.materials[i] = material;
    }
}

/// A copy of a texture with everything that it is made of.
fn copy(scene: &mut Scene, id: TextureId, depth: u32) -> TextureId {
    match scene.textures.get(id.index()).cloned() {
        Some(Texture::Product(a, b)) if depth < DEEPEST => {
            let (a, b) = (copy(scene, a, depth + 1), copy(scene, b, depth + 1));
            scene.add_texture(Texture::Product(a, b))
        }
        Some(texture) => scene.add_texture(texture),
        None => id,
    }
}

/// The mean of an image's linear colour and of its alpha.
fn mean(scene: &Scene, texture: &ImageTexture, files: &dyn Files) -> Option<DVec4> {
    let picture = decode(scene.images.get(texture.image.index())?, files)?;
    let is_srgb = texture.encoding == Encoding::Srgb && !picture.is_float();
    let linear = |v: f32| match is_srgb {
        true => linear_from_srgb(f64::from(v)),
        false => f64::from(v),
    };
    let texels = (0..picture.texels.len()).filter_map(|i| picture.texels.rgba(i));
    let sum = texels.fold(DVec4::ZERO, |sum, [r, g, b, a]| {
        sum + DVec4::new(linear(r), linear(g), linear(b), f64::from(a))
    });
    let mean = sum / picture.texels.len() as f64;
    mean.is_finite().then_some(mean)
}

fn decode(image: &Image, files: &dyn Files) -> Option<Picture> {
    match &image.source {
        ImageSource::Pixels { width, height, data } => Some(Picture {
            width: *width,
            height: *height,
            texels: pictures::Texels::RgbF32(data.to_vec()),
        }),
        ImageSource::Bytes(bytes) => pictures::decode(bytes, &image.name, Limits::default()).ok(),
        ImageSource::File(path) => {
            let bytes = files.read(path).ok()?;
            pictures::decode(&bytes, &image.name, Limits::default()).ok()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;
    use crate::scene::{Channel, ImageId, Material, NormalMap, ScalarInput};
    use glam::{DAffine2, DVec3};
    use std::sync::Arc;

    fn image_texture(encoding: Encoding) -> Texture {
        Texture::Image(ImageTexture {
            image: ImageId(0),
            uv_set: 0,
            uv_transform: DAffine2::IDENTITY,
            wrap_u: Default::default(),
            wrap_v: Default::default(),
            filter: Default::default(),
            encoding,
        })
    }

    #[test]
    fn colours_become_their_mean_and_shapes_stay() {
        let mut scene = Scene::default();
        let data: Arc<[[f32; 3]]> = vec![[0.0, 1.0, 0.5], [1.0, 1.0, 0.0]].into();
        scene.add_image(Image {
            name: String::new(),
            source: ImageSource::Pixels {
                width: 2,
                height: 1,
                data,
            },
            fallback: None,
            place: Default::default(),
        });
        let texture = scene.add_texture(image_texture(Encoding::Linear));
        let mut material = Material::diffuse(DVec3::ONE);
        if let SurfaceModel::Diffuse { color, .. } = &mut material.surface {
            color.texture = Some(texture);
        }
        material.opacity.alpha = ScalarInput::scaled(1.0, Some((texture, Channel::R)));
        material.normal_map = Some(NormalMap { texture, scale: 1.0 });
        scene.add_material(material);
        images(&mut scene, &MemoryFiles::default());
        let flat = Texture::Constant(DVec4::new(0.5, 1.0, 0.25, 1.0));
        assert_eq!(scene.textures[texture.index()], flat);
        let material = &scene.materials[0];
        let kept = [
            material.opacity.alpha.texture.unwrap().0,
            material.normal_map.unwrap().texture,
        ];
        for id in kept {
            assert!(matches!(scene.textures[id.index()], Texture::Image(_)));
        }
    }
}
