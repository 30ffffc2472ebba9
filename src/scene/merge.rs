//! Taking a whole scene (an imported model) into another as a group.

use super::*;
use glam::DAffine3;

impl Scene {
    /// Moves everything of `other` but its camera, environment and settings into this scene and returns the group that
    /// holds its objects, in `other`'s own coordinates. Its lamps are placed by `to_world` at once (lamps are
    /// not objects); the caller gives the same transform to the object that places the group.
    pub fn absorb(&mut self, other: Scene, to_world: DAffine3) -> GroupId {
        let offset = Offsets {
            groups: self.groups.len() as u32,
            meshes: self.meshes.len() as u32,
            materials: self.materials.len() as u32,
            textures: self.textures.len() as u32,
            images: self.images.len() as u32,
        };
        self.left_out.extend(other.left_out);
        self.images.extend(other.images);
        self.textures
            .extend(other.textures.into_iter().map(|t| offset.texture(t)));
        self.materials
            .extend(other.materials.into_iter().map(|m| offset.material(m)));
        let theirs = Arc::unwrap_or_clone(other.meshes).into_iter().map(|mut mesh| {
            for slot in mesh.materials.iter_mut().flatten() {
                slot.0 += offset.materials;
            }
            mesh
        });
        Arc::make_mut(&mut self.meshes).extend(theirs);
        for mut group in other.groups {
            group.objects.iter_mut().for_each(|o| offset.object(o));
            self.groups.push(group);
        }
        let mut objects = other.objects;
        for object in &mut objects {
            offset.object(object);
            if object.material.is_none() {
                object.material = other.default_material.map(|m| MaterialId(m.0 + offset.materials));
            }
        }
        self.lights
            .extend(other.lights.into_iter().map(|l| l.transformed(to_world)));
        self.add_group(objects)
    }
}

/// By how much each kind of id grows.
struct Offsets {
    groups: u32,
    meshes: u32,
    materials: u32,
    textures: u32,
    images: u32,
}

impl Offsets {
    fn object(&self, object: &mut Object) {
        if let Some(m) = &mut object.material {
            m.0 += self.materials;
        }
        match &mut object.shape {
            Shape::Mesh(id) => id.0 += self.meshes,
            Shape::Group(id) => id.0 += self.groups,
            _ => {}
        }
    }

    fn texture(&self, texture: Texture) -> Texture {
        let id = |t: TextureId| TextureId(t.0 + self.textures);
        match texture {
            Texture::Constant(c) => Texture::Constant(c),
            Texture::VertexColor => Texture::VertexColor,
            Texture::Product(a, b) => Texture::Product(id(a), id(b)),
            Texture::Image(mut image) => {
                image.image.0 += self.images;
                Texture::Image(image)
            }
        }
    }

    fn color(&self, c: &mut ColorInput) {
        if let Some(t) = &mut c.texture {
            t.0 += self.textures;
        }
    }

    fn scalar(&self, s: &mut ScalarInput) {
        if let Some((t, _)) = &mut s.texture {
            t.0 += self.textures;
        }
    }

    fn normal(&self, n: &mut Option<NormalMap>) {
        if let Some(n) = n {
            n.texture.0 += self.textures;
        }
    }

    fn material(&self, mut m: Material) -> Material {
        self.color(&mut m.emission);
        self.scalar(&mut m.opacity.alpha);
        self.normal(&mut m.normal_map);
        if let Some(b) = &mut m.bump_map {
            b.texture.0 += self.textures;
        }
        match &mut m.surface {
            SurfaceModel::Diffuse { color, sigma: s }
            | SurfaceModel::Glass {
                color, roughness: s, ..
            }
            | SurfaceModel::Glossy {
                color, roughness: s, ..
            }
            | SurfaceModel::Translucent { color, transmit: s } => {
                self.color(color);
                self.scalar(s);
            }
            SurfaceModel::Specular { color } => self.color(color),
            SurfaceModel::Finish(f) => self.color(&mut f.color),
            SurfaceModel::Mix { a, b, weight } => {
                a.0 += self.materials;
                b.0 += self.materials;
                self.scalar(weight);
            }
            SurfaceModel::Principled(p) => {
                for c in [
                    &mut p.base_color,
                    &mut p.specular_color,
                    &mut p.sheen_color,
                    &mut p.diffuse_transmission_color,
                ] {
                    self.color(c);
                }
                for s in [
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
                    self.scalar(s);
                }
                if let Some(t) = &mut p.anisotropy_direction {
                    t.0 += self.textures;
                }
                self.normal(&mut p.clearcoat_normal);
            }
            SurfaceModel::Black => {}
        }
        m
    }
}

impl Light {
    /// The lamp moved by an affine map, its motion with it: places and edges are mapped, directions mapped and
    /// normalised; intensity stays.
    pub fn transformed(mut self, t: DAffine3) -> Light {
        self.kind.transform(&t);
        self.motion.iter_mut().for_each(|key| key.transform(&t));
        self
    }
}

impl LightKind {
    fn transform(&mut self, t: &DAffine3) {
        let direction = |d: glam::DVec3| t.transform_vector3(d).normalize_or(d);
        match self {
            LightKind::Point { position, .. } => *position = t.transform_point3(*position),
            LightKind::Spot { position, axis, .. } => {
                *position = t.transform_point3(*position);
                *axis = direction(*axis);
            }
            LightKind::Directional { direction: d } => *d = direction(*d),
            LightKind::Area {
                position,
                axis1,
                axis2,
                spot,
                ..
            } => {
                *position = t.transform_point3(*position);
                *axis1 = t.transform_vector3(*axis1);
                *axis2 = t.transform_vector3(*axis2);
                if let Some((axis, _)) = spot {
                    *axis = direction(*axis);
                }
            }
        }
    }
}
