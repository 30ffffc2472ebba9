//! Textures that are known without looking at a point become factors.
//!
//! Kept to the bit: products are formed as the engine forms them, in f32, and a look-up in a channel that is the same
//! in all texels gives exactly that number, whatever the coordinates.

use super::super::images::Images;
use super::reach::Roots;
use super::{Notes, Pass, Pruned};
use crate::scene::{
    Channel, ColorInput, Encoding, ImageId, Material, MaterialId, ScalarInput, Scene, SurfaceModel, Texture, TextureId,
};
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;

/// Products nested deeper than this are left alone; `compile` refuses loops.
const DEEPEST: u32 = 16;

/// What is known of a scene's textures.
pub struct Facts<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What was decoded of its images.
    pub images: &'a Images<'a>,
    /// Materials on meshes with vertex colours.
    colored: BTreeSet<MaterialId>,
    is_colored: bool,
}

impl<'a> Facts<'a> {
    /// About a scene.
    pub fn new(scene: &'a Scene, images: &'a Images<'a>, roots: &Roots) -> Facts<'a> {
        Facts {
            scene,
            images,
            colored: roots.colored(scene),
            is_colored: true,
        }
    }

    /// As seen by one of its materials.
    pub fn of(&self, material: MaterialId) -> Facts<'a> {
        Facts {
            scene: self.scene,
            images: self.images,
            colored: BTreeSet::new(),
            is_colored: self.colored.contains(&material),
        }
    }

    /// The channels of a texture that are the same everywhere.
    pub fn known(&self, texture: TextureId) -> [Option<f32>; 4] {
        self.known_within(texture, DEEPEST)
    }

    fn known_within(&self, texture: TextureId, depth: u32) -> [Option<f32>; 4] {
        match self.scene.textures.get(texture.index()) {
            Some(Texture::Constant(c)) => c.as_vec4().to_array().map(Some),
            Some(Texture::VertexColor) if !self.is_colored => [Some(1.0); 4],
            Some(Texture::Image(t)) => self.images.uniform(t.image, t.encoding == Encoding::Srgb),
            Some(Texture::Product(a, b)) if depth > 0 => {
                let [a, b] = [*a, *b].map(|t| self.known_within(t, depth - 1));
                std::array::from_fn(|c| Some(a[c]? * b[c]?))
            }
            _ => [None; 4],
        }
    }

    /// The texture without factors that are 1 everywhere.
    fn without_ones(&self, texture: TextureId) -> TextureId {
        let mut texture = texture;
        for _ in 0..DEEPEST {
            let Some(Texture::Product(a, b)) = self.scene.textures.get(texture.index()) else {
                break;
            };
            let is_one = |t: TextureId| self.known(t) == [Some(1.0); 4];
            texture = match (is_one(*a), is_one(*b)) {
                (true, _) => *b,
                (_, true) => *a,
                _ => break,
            };
        }
        texture
    }

    /// The images behind a texture.
    pub fn images_of(&self, texture: TextureId) -> BTreeSet<ImageId> {
        let mut plain = Material::diffuse(DVec3::ZERO);
        plain.emission.texture = Some(texture);
        super::reach::images_behind(self.scene, &plain)
    }
}

/// Folds the inputs of all materials.
pub fn pass(pruned: &mut Pruned<'_>) {
    pruned.each_material(Pass::Textures, fold);
}

/// A material whose inputs are numbers where they can be; `is_colored` if it is on a mesh with vertex colours. What is a
/// solid and what not is judged by it, also where nothing is pruned.
pub fn folded(scene: &Scene, images: &Images<'_>, is_colored: bool, material: &Material) -> Material {
    let facts = Facts {
        scene,
        images,
        colored: BTreeSet::new(),
        is_colored,
    };
    let mut material = material.clone();
    fold(&facts, &mut material, &mut Notes::default());
    material
}

fn fold(facts: &Facts<'_>, material: &mut Material, notes: &mut Notes) {
    let mut folder = Folder { facts, notes };
    folder.color(&mut material.emission);
    folder.scalar(&mut material.opacity.alpha);
    match &mut material.surface {
        SurfaceModel::Black => {}
        SurfaceModel::Specular { color } => folder.color(color),
        SurfaceModel::Finish(f) => folder.color(&mut f.color),
        SurfaceModel::Mix { weight, .. } => folder.scalar(weight),
        SurfaceModel::Diffuse { color, sigma: s }
        | SurfaceModel::Glass {
            color, roughness: s, ..
        }
        | SurfaceModel::Glossy {
            color, roughness: s, ..
        }
        | SurfaceModel::Translucent { color, transmit: s } => {
            folder.color(color);
            folder.scalar(s);
        }
        SurfaceModel::Principled(p) => {
            for color in [
                &mut p.base_color,
                &mut p.specular_color,
                &mut p.sheen_color,
                &mut p.diffuse_transmission_color,
            ] {
                folder.color(color);
            }
            for scalar in [
                &mut p.metallic,
                &mut p.roughness,
                &mut p.specular,
                &mut p.transmission,
                &mut p.clearcoat,
                &mut p.clearcoat_roughness,
                &mut p.sheen_roughness,
                &mut p.anisotropy,
                &mut p.diffuse_transmission,
                &mut p.iridescence,
                &mut p.iridescence_thickness,
            ] {
                folder.scalar(scalar);
            }
        }
    }
}

struct Folder<'f, 'a, 'n> {
    facts: &'f Facts<'a>,
    notes: &'n mut Notes,
}

impl Folder<'_, '_, '_> {
    fn color(&mut self, input: &mut ColorInput) {
        let Some(texture) = input.texture else { return };
        if input.factor == DVec3::ZERO {
            input.texture = None;
            return self.drop(texture, "it is multiplied by 0");
        }
        if let [Some(r), Some(g), Some(b), _] = self.facts.known(texture) {
            *input = ColorInput::constant((input.factor.as_vec3() * Vec3::new(r, g, b)).as_dvec3());
            return self.drop(texture, "it is one colour all over");
        }
        input.texture = Some(self.facts.without_ones(texture));
    }

    fn scalar(&mut self, input: &mut ScalarInput) {
        let Some((texture, channel)) = input.texture else {
            if input.offset != 0.0 {
                *input = f64::from(input.offset as f32 + input.factor as f32).into();
            }
            return;
        };
        if input.factor == 0.0 {
            *input = input.offset.into();
            return self.drop(texture, "it is multiplied by 0");
        }
        let index = match channel {
            Channel::R => 0,
            Channel::G => 1,
            Channel::B => 2,
            Channel::A => 3,
        };
        if let Some(value) = self.facts.known(texture)[index] {
            *input = f64::from(input.offset as f32 + input.factor as f32 * value).into();
            return self.drop(texture, "what is read of it is the same all over");
        }
        input.texture = Some((self.facts.without_ones(texture), channel));
    }

    fn drop(&mut self, texture: TextureId, why: &str) {
        for image in self.facts.images_of(texture) {
            self.notes.images.entry(image).or_insert(why.to_owned());
        }
    }
}

/// Whether an input is this number or more everywhere.
pub fn is_at_least(input: &ScalarInput, value: f64) -> bool {
    input.constant().is_some_and(|v| v >= value)
}

/// Whether an input is 0 or less everywhere, which counts as 0.
pub fn is_nothing(input: &ScalarInput) -> bool {
    input.constant().is_some_and(|v| v <= 0.0)
}

/// Whether a colour is black everywhere.
pub fn is_black(input: &ColorInput) -> bool {
    input.texture.is_none() && input.factor == DVec3::ZERO
}
