//! What a description holds and the picture does not need: it is neither compiled nor opened.

use crate::scene::{
    EnvironmentKind, GroupId, ImageId, ImageSource, MaterialId, MeshId, Object, Place, Scene, Shape, SurfaceModel,
    Texture, TextureId,
};
use std::collections::BTreeSet;

/// Something that is left alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Unused {
    /// What it is: `material`, `image`, `mesh`, `lamp`, `environment`, `object`.
    pub kind: &'static str,
    /// Its name, or empty.
    pub name: String,
    /// Why it is not needed.
    pub why: &'static str,
    /// Where it was written.
    pub place: Place,
    /// Bytes of the description that it takes; for images in files, which are not opened, 0.
    pub bytes: u64,
}

/// What something drawn refers to.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// Materials, parts of mixtures included.
    pub materials: BTreeSet<MaterialId>,
    /// Meshes.
    pub meshes: BTreeSet<MeshId>,
    /// Images of the materials and of the environment.
    pub images: BTreeSet<ImageId>,
    groups: BTreeSet<GroupId>,
}

impl Reached {
    /// Follows all references from what is drawn.
    pub fn from(scene: &Scene) -> Reached {
        let mut reached = Reached::default();
        reached.materials.extend(scene.default_material);
        let mut queue: Vec<&Object> = scene.objects.iter().collect();
        while let Some(object) = queue.pop() {
            reached.materials.extend(object.material);
            match object.shape {
                Shape::Mesh(id) if reached.meshes.insert(id) => {
                    let mesh = scene.meshes.get(id.index());
                    let slots = mesh.into_iter().flat_map(|m| m.materials.iter().copied().flatten());
                    reached.materials.extend(slots);
                }
                Shape::Group(id) if reached.groups.insert(id) => {
                    queue.extend(scene.groups.get(id.index()).into_iter().flat_map(|g| &g.objects));
                }
                _ => {}
            }
        }
        reached.add_parts(scene);
        reached.add_images(scene);
        reached
    }

    fn add_parts(&mut self, scene: &Scene) {
        let mut parts: Vec<MaterialId> = self.materials.iter().copied().collect();
        while let Some(id) = parts.pop() {
            if let Some(SurfaceModel::Mix { a, b, .. }) = scene.materials.get(id.index()).map(|m| &m.surface) {
                parts.extend([*a, *b].into_iter().filter(|part| self.materials.insert(*part)));
            }
        }
    }

    fn add_images(&mut self, scene: &Scene) {
        let mut queue: Vec<TextureId> = Vec::new();
        for material in self.materials.iter().filter_map(|id| scene.materials.get(id.index())) {
            material.each_texture(&mut |t| queue.push(t));
        }
        let mut seen = BTreeSet::new();
        while let Some(id) = queue.pop() {
            match scene.textures.get(id.index()) {
                Some(Texture::Image(image)) => {
                    self.images.insert(image.image);
                }
                Some(Texture::Product(a, b)) if seen.insert(id) => queue.extend([*a, *b]),
                _ => {}
            }
        }
        if let EnvironmentKind::Image { image, .. } = &scene.environment.kind {
            self.images.insert(*image);
        }
    }
}

/// Everything that the picture does not need.
pub fn of(scene: &Scene) -> Vec<Unused> {
    let reached = Reached::from(scene);
    let mut out = Vec::new();
    let mut leave = |kind, name: &str, why, place: &Place, bytes: u64| {
        let (name, place) = (name.to_owned(), place.clone());
        out.push(Unused {
            kind,
            name,
            why,
            place,
            bytes,
        });
    };
    for (i, material) in scene.materials.iter().enumerate() {
        if !reached.materials.contains(&MaterialId(i as u32)) {
            leave("material", &material.name, "nothing drawn has it", &material.place, 0);
        }
    }
    for (i, image) in scene.images.iter().enumerate() {
        if !reached.images.contains(&ImageId(i as u32)) {
            let (why, bytes) = match &image.source {
                ImageSource::File(_) => ("nothing drawn shows it: it is not opened", 0),
                ImageSource::Bytes(b) => ("nothing drawn shows it: it is not decoded", b.len() as u64),
                ImageSource::Pixels { data, .. } => ("nothing drawn shows it", size_of_val(&data[..]) as u64),
            };
            leave("image", &image.name, why, &image.place, bytes);
        }
    }
    for (i, mesh) in scene.meshes.iter().enumerate() {
        if !reached.meshes.contains(&MeshId(i as u32)) {
            let bytes = (mesh.positions.len() + mesh.normals.len() + mesh.triangles.len()) * 12;
            leave("mesh", &mesh.name, "nothing places it", &Place::None, bytes as u64);
        }
    }
    for lamp in scene.lights.iter().filter(|l| l.color.max_element() <= 0.0) {
        leave("lamp", &lamp.name, "it is dark", &lamp.place, 0);
    }
    let dark = match &scene.environment.kind {
        EnvironmentKind::Black => false,
        EnvironmentKind::Constant(c) => c.max_element() <= 0.0,
        EnvironmentKind::Image { strength, .. } => *strength <= 0.0,
    };
    if dark {
        leave("environment", "", "it is black", &Place::None, 0);
    }
    let unseen = |o: &&Object| !(o.visibility.camera || o.visibility.shadow || o.visibility.indirect);
    for object in scene.objects.iter().filter(unseen) {
        leave("object", &object.name, "no ray sees it", &object.place, 0);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Image, Material, Mesh};
    use glam::DVec3;

    #[test]
    fn what_nothing_refers_to_is_told_once_and_nothing_else() {
        let mut scene = Scene::default();
        let used = scene.add_material(Material::diffuse(DVec3::ONE));
        scene.add_material(Material {
            name: "spare".to_owned(),
            ..Material::diffuse(DVec3::ONE)
        });
        scene.add_mesh(Mesh::default());
        scene.add_image(Image {
            name: "wood.png".to_owned(),
            source: ImageSource::File("wood.png".into()),
            place: Place::None,
        });
        let shape = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        };
        let ball = Object::new(shape).with_material(used);
        let group = scene.add_group(vec![ball]);
        scene.objects.push(Object::new(Shape::Group(group)));
        scene.environment.kind = EnvironmentKind::Constant(DVec3::ZERO);
        let found: Vec<_> = of(&scene).into_iter().map(|u| (u.kind, u.name)).collect();
        let expected = [
            ("material", "spare"),
            ("image", "wood.png"),
            ("mesh", ""),
            ("environment", ""),
        ];
        assert_eq!(found, expected.map(|(k, n)| (k, n.to_owned())));
    }
}
