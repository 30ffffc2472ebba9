//! Materials and textures that are used become the engine's recipes.

use super::images::Images;
use super::prune::{Roots, folded, is_at_least, is_nothing};
use crate::diag::{Diagnostic, Diagnostics};
use crate::render::material as engine;
use crate::render::medium::CLEAR;
use crate::render::technique::{Technique, TextureFilter};
use crate::render::texture as tex;
use crate::scene::{
    BumpMap, Channel, ColorInput, EmissionSides, Encoding, Finish, ImageId, Material, MaterialId, NormalMap,
    OpacityMode, Principled, ScalarInput, Scene, SurfaceModel, TexelFilter, Texture, TextureId, Wrap,
};
use glam::{Affine2, DVec3, Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Compiles materials on demand and remembers them.
pub struct Materials<'a, 'i> {
    scene: &'a Scene,
    images: &'i mut Images<'a>,
    /// Materials that vertex colours may reach.
    colored: BTreeSet<MaterialId>,
    /// Compiled ones by material and whether the shape is open (emission may differ).
    known: BTreeMap<(Option<MaterialId>, bool), u32>,
    textures: BTreeMap<TextureId, Option<u32>>,
    scattering: engine::Scattering,
    filter: TextureFilter,
    /// The engine's materials.
    pub materials: Vec<engine::Material>,
    /// What fills solids.
    pub media: super::media::Media,
    /// The engine's textures.
    pub nodes: Vec<tex::Texture>,
}

/// Mixtures may be nested this deep; one that contains itself is found out by it.
const DEEPEST_MIX: usize = 64;

impl<'a, 'i> Materials<'a, 'i> {
    /// Nothing compiled yet.
    pub fn new(scene: &'a Scene, images: &'i mut Images<'a>, technique: &Technique) -> Materials<'a, 'i> {
        Materials {
            scene,
            images,
            colored: Roots::of(scene).colored(scene),
            known: BTreeMap::new(),
            textures: BTreeMap::new(),
            scattering: engine::Scattering::from(technique),
            filter: technique.textures,
            materials: Vec::new(),
            media: super::media::Media::new(),
            nodes: Vec::new(),
        }
    }

    /// The engine's index of a material on an open or closed shape; `None` is white diffuse.
    pub fn get(&mut self, id: Option<MaterialId>, open: bool, diags: &mut Diagnostics) -> u32 {
        self.compile(id, open, 0, diags)
    }

    fn compile(&mut self, id: Option<MaterialId>, open: bool, depth: usize, diags: &mut Diagnostics) -> u32 {
        if let Some(&known) = self.known.get(&(id, open)) {
            return known;
        }
        let fallback = Material::diffuse(DVec3::splat(0.8));
        let material = id
            .and_then(|id| self.scene.materials.get(id.index()))
            .unwrap_or(&fallback)
            .clone();
        if depth > DEEPEST_MIX {
            diags.push(super::at_place(
                Diagnostic::error("C0301", format!("mixes are nested more than {DEEPEST_MIX} deep"))
                    .hint("a mix must not contain itself"),
                &material.place,
            ));
            return 0;
        }
        let surface = self.surface(&material, open, depth, diags);
        let mut out = engine::Material::new(surface);
        out.scattering = self.scattering;
        out.emission = self.color(&material.emission, diags);
        let emits = !out.emission.is_black();
        (out.emits_front, out.emits_back) = match material.emission_sides {
            EmissionSides::Front => (emits, false),
            EmissionSides::Both => (emits, emits),
            EmissionSides::ByShape => (emits, emits && open),
        };
        out.unlit = material.unlit;
        out.alpha = match material.opacity.mode {
            OpacityMode::Opaque => engine::Alpha::Opaque,
            OpacityMode::Mask(cutoff) => {
                engine::Alpha::Mask(self.scalar(&material.opacity.alpha, diags), cutoff as f32)
            }
            OpacityMode::Blend => engine::Alpha::Blend(self.scalar(&material.opacity.alpha, diags)),
        };
        out.normal_map = material.normal_map.as_ref().and_then(|n| self.normal_map(n, diags));
        if let engine::SurfaceModel::Principled(p) = &mut out.surface {
            let has_relief = material.normal_map.is_some() || material.bump_map.is_some();
            p.coat_apart = !p.clearcoat.is_nothing() && (has_relief || p.clearcoat_normal.is_some());
        }
        out.medium = self.media.add(&material.interior);
        out.bump_map = material.bump_map.as_ref().and_then(|b| self.bump_map(b, diags));
        let is_colored = id.is_some_and(|id| self.colored.contains(&id));
        let folded = folded(self.scene, self.images, is_colored, &material);
        (out.ior, out.dispersion, out.interior) = solid(&folded);
        if let (engine::SurfaceModel::Mix { a, b, .. }, SurfaceModel::Mix { weight, .. }) =
            (&out.surface, &folded.surface)
        {
            // What is glass in part is a solid as a whole; a part without share is none.
            let parts = [(a, is_at_least(weight, 1.0)), (b, is_nothing(weight))];
            let parts = parts.into_iter().filter(|(_, is_absent)| !is_absent);
            let mut parts = parts.map(|(id, _)| &self.materials[*id as usize]);
            if let Some(part) = parts.find(|m| m.interior) {
                (out.ior, out.dispersion, out.interior) = (part.ior, part.dispersion, true);
                if out.medium == CLEAR {
                    out.medium = part.medium;
                }
            }
        }
        out.needs_attributes = self.needs_attributes(&out);
        self.materials.push(out);
        let place = self.materials.len() as u32 - 1;
        self.known.insert((id, open), place);
        place
    }

    fn surface(
        &mut self,
        material: &Material,
        open: bool,
        depth: usize,
        diags: &mut Diagnostics,
    ) -> engine::SurfaceModel {
        use engine::SurfaceModel as Engine;
        match &material.surface {
            SurfaceModel::Black => Engine::Black,
            SurfaceModel::Diffuse { color, sigma } => Engine::Diffuse {
                color: self.color(color, diags),
                sigma: self.scalar(sigma, diags),
            },
            SurfaceModel::Specular { color } => Engine::Specular {
                color: self.color(color, diags),
            },
            SurfaceModel::Glass { color, roughness, .. } => Engine::Glass {
                color: self.color(color, diags),
                roughness: self.scalar(roughness, diags),
            },
            SurfaceModel::Glossy {
                color,
                roughness,
                metal,
                ..
            } => Engine::Glossy {
                color: self.color(color, diags),
                roughness: self.scalar(roughness, diags),
                metal: *metal,
            },
            SurfaceModel::Translucent { color, transmit } => Engine::Translucent {
                color: self.color(color, diags),
                transmit: self.scalar(transmit, diags),
            },
            SurfaceModel::Principled(p) => Engine::Principled(Box::new(self.principled(p, diags))),
            SurfaceModel::Finish(f) => Engine::Finish(Box::new(self.finish(f, diags))),
            SurfaceModel::Mix { a, b, weight } => {
                let [a, b] = [*a, *b].map(|id| self.compile(Some(id), open, depth + 1, diags));
                Engine::Mix {
                    a,
                    b,
                    weight: self.scalar(weight, diags),
                }
            }
        }
    }

    fn principled(&mut self, p: &Principled, diags: &mut Diagnostics) -> engine::PrincipledInputs {
        engine::PrincipledInputs {
            base_color: self.color(&p.base_color, diags),
            metallic: self.scalar(&p.metallic, diags),
            roughness: self.scalar(&p.roughness, diags),
            ior: if p.ior == 0.0 { f32::INFINITY } else { p.ior as f32 },
            specular: self.scalar(&p.specular, diags),
            specular_color: self.color(&p.specular_color, diags),
            transmission: self.scalar(&p.transmission, diags),
            thick: p.thick,
            clearcoat: self.scalar(&p.clearcoat, diags),
            clearcoat_roughness: self.scalar(&p.clearcoat_roughness, diags),
            clearcoat_normal: p.clearcoat_normal.as_ref().and_then(|n| self.normal_map(n, diags)),
            coat_apart: false, // see where the material is put together
            sheen_color: self.color(&p.sheen_color, diags),
            sheen_roughness: self.scalar(&p.sheen_roughness, diags),
            anisotropy: self.scalar(&p.anisotropy, diags),
            anisotropy_rotation: p.anisotropy_rotation as f32,
            diffuse_transmission: self.scalar(&p.diffuse_transmission, diags),
            diffuse_transmission_color: self.color(&p.diffuse_transmission_color, diags),
            anisotropy_direction: p.anisotropy_direction.and_then(|t| self.texture(t, diags)),
            iridescence: self.scalar(&p.iridescence, diags),
            iridescence_ior: p.iridescence_ior as f32,
            iridescence_thickness: self.scalar(&p.iridescence_thickness, diags),
        }
    }

    fn finish(&mut self, f: &Finish, diags: &mut Diagnostics) -> engine::FinishInputs {
        let reflection = f.reflection.as_ref();
        engine::FinishInputs {
            color: self.color(&f.color, diags),
            filter: f.filter as f32,
            transmit: f.transmit as f32,
            diffuse: f.diffuse as f32,
            diffuse_back: f.diffuse_back as f32,
            brilliance: f.brilliance as f32,
            phong: f.phong as f32,
            phong_size: f.phong_size as f32,
            specular: f.specular as f32,
            roughness: f.roughness as f32,
            metallic: f.metallic as f32,
            reflection_min: reflection.map_or(Vec3::ZERO, |r| r.min.as_vec3()),
            reflection_max: reflection.map_or(Vec3::ZERO, |r| r.max.as_vec3()),
            reflection_falloff: reflection.map_or(1.0, |r| r.falloff as f32),
            reflection_fresnel: reflection.is_some_and(|r| r.fresnel),
            reflection_metallic: reflection.map_or(0.0, |r| r.metallic as f32),
            conserve_energy: f.conserve_energy,
            ior: f.ior.map(|ior| ior as f32),
        }
    }

    fn color(&mut self, c: &ColorInput, diags: &mut Diagnostics) -> engine::ColorInput {
        engine::ColorInput {
            factor: c.factor.as_vec3(),
            texture: c.texture.and_then(|t| self.texture(t, diags)),
        }
    }

    fn scalar(&mut self, s: &ScalarInput, diags: &mut Diagnostics) -> engine::ScalarInput {
        let channel = |c: Channel| match c {
            Channel::R => 0,
            Channel::G => 1,
            Channel::B => 2,
            Channel::A => 3,
        };
        engine::ScalarInput {
            factor: s.factor as f32,
            texture: s.texture.and_then(|(t, c)| Some((self.texture(t, diags)?, channel(c)))),
            offset: s.offset as f32,
        }
    }

    fn normal_map(&mut self, n: &NormalMap, diags: &mut Diagnostics) -> Option<engine::NormalMap> {
        let scale = n.scale as f32;
        if let Some(Texture::Image(t)) = self.scene.textures.get(n.texture.index()) {
            self.images.decode_all(&[t.image], diags);
            if self.images.is_flat(t.image) {
                // 8 bits have no number for a normal that is not leant; now it is one half.
                self.nodes
                    .push(tex::Texture::Constant(Vec3::new(0.5, 0.5, 1.0).extend(1.0)));
                let texture = self.nodes.len() as u32 - 1;
                return Some(engine::NormalMap { texture, scale });
            }
        }
        let texture = self.texture(n.texture, diags)?;
        Some(engine::NormalMap { texture, scale })
    }

    fn bump_map(&mut self, b: &BumpMap, diags: &mut Diagnostics) -> Option<engine::BumpMap> {
        Some(engine::BumpMap {
            texture: self.texture(b.texture, diags)?,
            scale: b.scale as f32,
        })
    }

    /// The engine's index of a texture; `None` if its image could not be read. Parts come before products.
    fn texture(&mut self, id: TextureId, diags: &mut Diagnostics) -> Option<u32> {
        if let Some(known) = self.textures.get(&id) {
            return *known;
        }
        // A product that contains itself finds this and is white.
        self.textures.insert(id, None);
        let node = match self.scene.textures.get(id.index()).cloned()? {
            Texture::Constant(c) => Some(tex::Texture::Constant(c.as_vec4())),
            Texture::VertexColor => Some(tex::Texture::VertexColor),
            Texture::Product(a, b) => match (self.texture(a, diags), self.texture(b, diags)) {
                (Some(a), Some(b)) => Some(tex::Texture::Product(a, b)),
                (one, other) => {
                    let left = one.or(other);
                    self.textures.insert(id, left);
                    return left;
                }
            },
            Texture::Image(t) => {
                self.images.decode_all(&[t.image], diags);
                self.images.place(t.image).map(|image| {
                    let m = t.uv_transform;
                    let v = |v: glam::DVec2| Vec2::new(v.x as f32, v.y as f32);
                    tex::Texture::Image(tex::ImageTexture {
                        image,
                        uv_set: t.uv_set,
                        uv_transform: Affine2::from_cols(v(m.matrix2.x_axis), v(m.matrix2.y_axis), v(m.translation)),
                        wrap_u: wrap(t.wrap_u),
                        wrap_v: wrap(t.wrap_v),
                        bilinear: t.filter == TexelFilter::Bilinear && self.filter == TextureFilter::AsWritten,
                        srgb: t.encoding == Encoding::Srgb,
                    })
                })
            }
        };
        let place = node.map(|node| {
            self.nodes.push(node);
            self.nodes.len() as u32 - 1
        });
        self.textures.insert(id, place);
        place
    }

    /// Mean emitted radiance over the texture of a material's emission, for choosing lights.
    pub fn mean_emission(&self, material: u32) -> Vec3 {
        let emission = &self.materials[material as usize].emission;
        emission.factor * emission.texture.map_or(Vec3::ONE, |t| self.mean(t))
    }

    fn mean(&self, texture: u32) -> Vec3 {
        match &self.nodes[texture as usize] {
            tex::Texture::Constant(c) => c.truncate(),
            tex::Texture::VertexColor => Vec3::ONE,
            tex::Texture::Product(a, b) => self.mean(*a) * self.mean(*b),
            tex::Texture::Image(t) => Vec3::from_array(self.images.mean(t.image, t.srgb).map(|v| v as f32)),
        }
    }

    fn needs_attributes(&self, m: &engine::Material) -> bool {
        let color = |c: &engine::ColorInput| c.texture.is_some();
        let scalar = |s: &engine::ScalarInput| s.texture.is_some();
        let alpha = match &m.alpha {
            engine::Alpha::Opaque => false,
            engine::Alpha::Mask(a, _) | engine::Alpha::Blend(a) => scalar(a),
        };
        let surface = match &m.surface {
            engine::SurfaceModel::Black => false,
            engine::SurfaceModel::Diffuse { color: c, sigma: s }
            | engine::SurfaceModel::Glass { color: c, roughness: s }
            | engine::SurfaceModel::Glossy {
                color: c, roughness: s, ..
            }
            | engine::SurfaceModel::Translucent { color: c, transmit: s } => color(c) || scalar(s),
            engine::SurfaceModel::Specular { color: c } => color(c),
            engine::SurfaceModel::Finish(f) => color(&f.color),
            engine::SurfaceModel::Mix { a, b, weight } => {
                let part = |id: u32| self.materials[id as usize].needs_attributes;
                part(*a) || part(*b) || scalar(weight)
            }
            engine::SurfaceModel::Principled(p) => {
                let colors = [
                    &p.base_color,
                    &p.specular_color,
                    &p.sheen_color,
                    &p.diffuse_transmission_color,
                ];
                let scalars = [
                    &p.metallic,
                    &p.roughness,
                    &p.specular,
                    &p.transmission,
                    &p.clearcoat,
                    &p.clearcoat_roughness,
                    &p.sheen_roughness,
                    &p.anisotropy,
                    &p.diffuse_transmission,
                    &p.iridescence,
                    &p.iridescence_thickness,
                ];
                let is_directed = !p.anisotropy.is_nothing() || p.clearcoat_normal.is_some();
                is_directed || colors.into_iter().any(color) || scalars.into_iter().any(scalar)
            }
        };
        alpha || surface || color(&m.emission) || m.normal_map.is_some() || m.bump_map.is_some()
    }
}

fn wrap(w: Wrap) -> tex::Wrap {
    match w {
        Wrap::Repeat => tex::Wrap::Repeat,
        Wrap::Mirror => tex::Wrap::Mirror,
        Wrap::Clamp => tex::Wrap::Clamp,
    }
}

/// Index of refraction, dispersion (20/Abbe) and whether crossing the surface enters a solid.
pub(super) fn solid(material: &Material) -> (f32, f32, bool) {
    match &material.surface {
        SurfaceModel::Glass { ior, abbe, .. } => {
            let dispersion = abbe.map_or(0.0, |v| 20.0 / v as f32);
            (*ior as f32, spread(dispersion, *ior), true)
        }
        SurfaceModel::Glossy { ior, .. } => (*ior as f32, 0.0, false),
        SurfaceModel::Principled(p) => {
            let is_metal = is_at_least(&p.metallic, 1.0);
            let transmits = p.thick && p.transmission.most() > 0.0 && !is_metal;
            // Light that only seeps in is bent nowhere: there is nothing but the filling.
            let seeps = p.thick && p.diffuse_transmission.most() > 0.0 && !is_metal;
            if seeps && !transmits && !material.interior.is_clear() {
                return (1.0, 0.0, true);
            }
            (
                if p.ior == 0.0 { f32::INFINITY } else { p.ior as f32 },
                if transmits {
                    spread(p.dispersion as f32, p.ior)
                } else {
                    0.0
                },
                transmits,
            )
        }
        SurfaceModel::Finish(f) => {
            let passes = f.filter > 0.0 || f.transmit > 0.0;
            let is_filled = !material.interior.is_clear();
            let dispersion = f.ior.map_or(0.0, |ior| spread(f.dispersion as f32, ior));
            (
                f.ior.unwrap_or(1.0) as f32,
                dispersion,
                passes && (f.ior.is_some() || is_filled),
            )
        }
        SurfaceModel::Black
        | SurfaceModel::Diffuse { .. }
        | SurfaceModel::Specular { .. }
        | SurfaceModel::Translucent { .. }
        | SurfaceModel::Mix { .. } => (1.5, 0.0, false),
    }
}

/// An index of 1 is the same for all wavelengths: it disperses nothing.
fn spread(dispersion: f32, ior: f64) -> f32 {
    if ior == 1.0 { 0.0 } else { dispersion }
}

/// All images that these materials use, so that they can be decoded side by side.
pub fn images_of(scene: &Scene, materials: impl Iterator<Item = MaterialId>) -> Vec<ImageId> {
    let mut textures: Vec<TextureId> = Vec::new();
    let mut to_do: Vec<MaterialId> = materials.collect();
    let mut seen = std::collections::BTreeSet::new();
    while let Some(id) = to_do.pop() {
        let Some(m) = scene.materials.get(id.index()) else {
            continue;
        };
        if !seen.insert(id) {
            continue;
        }
        m.each_texture(&mut |t| textures.push(t));
        if let SurfaceModel::Mix { a, b, .. } = &m.surface {
            to_do.extend([*a, *b]);
        }
    }
    let mut images = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    while let Some(id) = textures.pop() {
        if !seen.insert(id) {
            continue;
        }
        match scene.textures.get(id.index()) {
            Some(Texture::Image(t)) => images.push(t.image),
            Some(Texture::Product(a, b)) => textures.extend([*a, *b]),
            _ => {}
        }
    }
    images
}
