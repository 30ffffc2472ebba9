//! What a scene uses, so that a study varies only what can matter for it.
//!
//! Read from the description, which tells every cause; materials that nothing refers to do not count. What cannot be
//! excluded counts as used: an axis that turns out to change nothing costs time, a missing one hides something.

use crate::compile::effects::image_inputs;
use crate::compile::prune::Reached;
use crate::render::light::LightSet;
use crate::scene::{
    Environment, EnvironmentKind, Material, Object, OpacityMode, Principled, Scene, Shape, SurfaceModel, Texture,
    TextureId,
};
use std::collections::BTreeSet;

/// What can matter for the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Uses {
    /// Lights, as the engine counts them: lamps, emitting shapes, the environment.
    pub lights: usize,
    /// Lights that rays can hit, so that there is a choice between sampling and hitting them.
    pub hittable_lights: bool,
    /// Surfaces that share light between reflection and transmission (or a base) by Fresnel's equations.
    pub dielectrics: bool,
    /// Rough specular lobes, between whose facets light may bounce.
    pub rough_lobes: bool,
    /// Surfaces or solids that are specular, so that there may be caustics.
    pub specular: bool,
    /// Images on surfaces.
    pub images: bool,
    /// Normal maps and height maps.
    pub normal_maps: bool,
    /// Coverage by alpha.
    pub alpha: bool,
    /// Media inside of solids or in the air, and fogs.
    pub media: bool,
    /// POV-Ray's highlights, or coats over a diffuse base.
    pub highlights: bool,
    /// Mirrors and reflecting finishes.
    pub mirrors: bool,
    /// An environment that lights the scene.
    pub environment: bool,
    /// A lens with an opening.
    pub lens: bool,
    /// So many shapes and triangles that it matters how the tree of boxes is built.
    pub many_shapes: bool,
}

/// A tree of no more shapes than this has two levels at most, whoever builds it.
const FEW_SHAPES: usize = 16;

impl Uses {
    /// What this scene uses; `lights` are those of the compiled scene.
    pub fn of(scene: &Scene, lights: &LightSet) -> Uses {
        let delta = |i: &u32| lights.get(*i).is_some_and(|l| l.is_delta());
        let mut uses = Uses {
            lights: lights.len(),
            hittable_lights: (0..lights.len() as u32).any(|i| !delta(&i)),
            environment: is_lighting(&scene.environment),
            lens: scene.camera().is_some_and(|c| c.lens_radius > 0.0),
            media: !scene.atmosphere.is_clear() || !scene.fogs.is_empty(),
            many_shapes: is_beyond(scene, FEW_SHAPES),
            ..Uses::default()
        };
        for id in Reached::from(scene).materials {
            if let Some(material) = scene.materials.get(id.index()) {
                uses.add(scene, material);
            }
        }
        uses
    }

    fn add(&mut self, scene: &Scene, material: &Material) {
        self.images |= image_inputs(material).iter().any(|t| has_image(scene, *t));
        self.alpha |= material.opacity.mode != OpacityMode::Opaque;
        self.media |= !material.interior.is_clear();
        self.normal_maps |= material.normal_map.is_some_and(|n| n.scale != 0.0);
        self.normal_maps |= material.bump_map.is_some_and(|b| b.scale != 0.0);
        match &material.surface {
            SurfaceModel::Black
            | SurfaceModel::Diffuse { .. }
            | SurfaceModel::Translucent { .. }
            | SurfaceModel::Mix { .. } => {}
            SurfaceModel::Specular { .. } => {
                self.specular = true;
                self.mirrors = true;
            }
            SurfaceModel::Glass { roughness, .. } => {
                self.specular = true;
                self.dielectrics = true;
                self.rough_lobes |= roughness.most() > 0.0;
            }
            SurfaceModel::Glossy { metal, .. } => {
                self.specular = true;
                self.rough_lobes = true;
                self.dielectrics |= !metal;
                self.highlights |= !metal;
            }
            SurfaceModel::Principled(p) => self.add_principled(p),
            SurfaceModel::Finish(f) => {
                let highlight = f.phong > 0.0 || f.specular > 0.0;
                let fresnel = f.reflection.is_some_and(|r| r.fresnel);
                self.highlights |= highlight;
                self.rough_lobes |= highlight;
                self.mirrors |= f.reflection.is_some();
                self.dielectrics |= fresnel || f.ior.is_some();
                self.specular |= highlight || f.reflection.is_some() || f.ior.is_some();
            }
        }
    }

    fn add_principled(&mut self, p: &Principled) {
        let coat = p.specular.most() > 0.0 || p.clearcoat.most() > 0.0;
        self.dielectrics |= (coat && p.metallic.least() < 1.0) || p.transmission.most() > 0.0;
        self.specular = true;
        self.rough_lobes |= p.roughness.most() > 0.0;
        self.normal_maps |= p.clearcoat_normal.is_some();
    }
}

/// Whether surfaces get light from the environment.
fn is_lighting(environment: &Environment) -> bool {
    let shines = match &environment.kind {
        EnvironmentKind::Black => false,
        EnvironmentKind::Constant(radiance) => radiance.max_element() > 0.0,
        EnvironmentKind::Image { strength, .. } => *strength > 0.0,
    };
    environment.illuminates && shines
}

/// Whether more shapes and triangles than this are drawn; what stands in groups counts as many.
fn is_beyond(scene: &Scene, few: usize) -> bool {
    let weight = |object: &Object| match object.shape {
        Shape::Group(_) => few + 1,
        Shape::Mesh(id) => scene.meshes.get(id.index()).map_or(0, |m| m.triangles.len()),
        _ => 1,
    };
    scene.objects.iter().map(weight).sum::<usize>() > few
}

/// Whether an image is behind a texture; products may be nested.
fn has_image(scene: &Scene, texture: TextureId) -> bool {
    let (mut queue, mut seen) = (vec![texture], BTreeSet::new());
    while let Some(id) = queue.pop() {
        match scene.textures.get(id.index()) {
            Some(Texture::Image(_)) => return true,
            Some(Texture::Product(a, b)) if seen.insert(id) => queue.extend([*a, *b]),
            _ => {}
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ImageId, ImageTexture, MaterialId};
    use glam::{DAffine2, DVec3, DVec4};

    fn sphere(material: MaterialId) -> Object {
        let shape = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        };
        Object::new(shape).with_material(material)
    }

    fn glass() -> Material {
        Material::new(SurfaceModel::Glass {
            color: DVec3::ONE.into(),
            ior: 1.5,
            roughness: 0.0.into(),
            abbe: None,
        })
    }

    #[test]
    fn what_nothing_refers_to_is_not_used() {
        let mut scene = Scene::default();
        let wall = scene.add_material(Material::diffuse(DVec3::ONE));
        let unused = scene.add_material(glass());
        scene.objects.push(sphere(wall));
        let uses = Uses::of(&scene, &LightSet::default());
        assert!(!uses.dielectrics && !uses.specular, "{uses:?}");
        let group = scene.add_group(vec![sphere(unused)]);
        scene.objects.push(Object::new(Shape::Group(group)));
        let uses = Uses::of(&scene, &LightSet::default());
        assert!(uses.dielectrics && uses.specular && !uses.rough_lobes, "{uses:?}");
    }

    #[test]
    fn the_parts_of_a_mixture_are_used() {
        let mut scene = Scene::default();
        let a = scene.add_material(Material::diffuse(DVec3::ONE));
        let b = scene.add_material(glass());
        let weight = 0.5.into();
        let mix = scene.add_material(Material::new(SurfaceModel::Mix { a, b, weight }));
        scene.objects.push(sphere(mix));
        assert_eq!(Reached::from(&scene).materials, [a, b, mix].into());
        assert!(Uses::of(&scene, &LightSet::default()).dielectrics);
    }

    #[test]
    fn images_are_found_behind_products_and_constants_are_none() {
        let mut scene = Scene::default();
        let white = scene.add_texture(Texture::Constant(DVec4::ONE));
        let image = scene.add_texture(Texture::Image(ImageTexture {
            image: ImageId(0),
            uv_set: 0,
            uv_transform: DAffine2::IDENTITY,
            wrap_u: Default::default(),
            wrap_v: Default::default(),
            filter: Default::default(),
            encoding: Default::default(),
        }));
        let product = scene.add_texture(Texture::Product(white, image));
        assert!(has_image(&scene, product) && has_image(&scene, image) && !has_image(&scene, white));
        let looped = TextureId(scene.textures.len() as u32);
        scene.add_texture(Texture::Product(looped, white));
        assert!(!has_image(&scene, looped), "and it ends");
    }
}
