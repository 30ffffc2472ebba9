//! Meshes: primitives are read one by one and those of like attributes become one mesh of the scene, a slot per
//! material.

use super::Loader;
use super::accessor::Wanted;
use super::budget::Cost;
use super::deform::{Pose, unit_tangents};
use super::part::{Part, join};
use super::{tangent, triangles};
use crate::diag::{Anomaly, Diagnostic};
use crate::scene::{MaterialId, MeshId, SurfaceModel, Texture, TextureId};
use glam::{DAffine2, Vec2, Vec3, Vec4};
use gltf::json;
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::Checked;
use serde_json::Value;
use std::rc::Rc;

pub(super) const VEC3: Wanted = Wanted {
    components: &[3],
    normalize: false,
};
const VEC4: Wanted = Wanted {
    components: &[4],
    normalize: false,
};
const UV: Wanted = Wanted {
    components: &[2],
    normalize: false,
};
const COLOR: Wanted = Wanted {
    components: &[3, 4],
    normalize: true,
};
/// Triangles that any file may have, and how many more for each byte of its buffers: primitives that share one accessor
/// could ask for any number. Even a model whose every vertex serves ten materials stays below.
const TRIANGLES: (u64, u64) = (2_000_000, 4);

impl Loader<'_> {
    /// The meshes of the scene for mesh `index`, referred to at `at`, bent by `pose`. Unbent meshes are shared by all
    /// nodes.
    pub(super) fn meshes_of(&mut self, index: usize, pose: &Pose, at: &str) -> Rc<[MeshId]> {
        let is_plain = pose.weights.is_none() && pose.joints.is_none() && pose.later.is_empty();
        if let Some(known) = self.meshes.get(&index).filter(|_| is_plain) {
            return known.clone();
        }
        let parts = self.read_parts(index, pose, at).unwrap_or_default();
        let name = self.doc.name("meshes", index);
        let infinite: u64 = parts.iter().map(|p| p.dropped).sum();
        let meshes = join(parts, &name);
        let flat = meshes.iter().map(|m| m.dropped_faces).sum::<u64>() - infinite;
        if flat > 0 {
            let d = Diagnostic::note("G0616", format!("{flat} faces have no area and are left out"));
            self.report.push(&format!("meshes[{index}]"), d);
        }
        let made: Rc<[MeshId]> = meshes.into_iter().map(|m| self.scene.add_mesh(m)).collect();
        if is_plain {
            self.meshes.insert(index, made.clone());
        }
        made
    }

    fn read_parts(&mut self, index: usize, pose: &Pose, at: &str) -> Option<Vec<Part>> {
        let raw = self.doc.raw("meshes", index, at, &mut self.report)?;
        let primitives = raw.get("primitives").and_then(Value::as_array).map_or(0, Vec::len);
        self.afford(Cost::Primitives, primitives as u64, &format!("meshes[{index}]"))?;
        let mesh: json::Mesh = self.doc.get(index, at, &mut self.report)?;
        let weights = pose.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or(&[]);
        if mesh.primitives.is_empty() {
            self.report
                .warning("G0601", &format!("meshes[{index}]"), "has no primitives");
        }
        let mut parts = Vec::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let raw = raw.get("primitives").and_then(|ps| ps.get(p))?;
            let at = format!("meshes[{index}].primitives[{p}]");
            parts.extend(self.read_part(raw, primitive, weights, pose, &at));
        }
        Some(parts)
    }

    /// One primitive, unpacked first if Draco data hold it; `None` if it is broken (reported) or draws no triangles.
    fn read_part(
        &mut self,
        raw: &Value,
        primitive: &Primitive,
        weights: &[f32],
        pose: &Pose,
        at: &str,
    ) -> Option<Part> {
        self.triangle_mode(primitive, at)?;
        let unpacked = self.unpack_draco(raw, primitive, at)?;
        let part = self.read_plain(raw, unpacked.as_ref().unwrap_or(primitive), weights, pose, at);
        self.accessors.supplied.clear();
        part
    }

    fn read_plain(
        &mut self,
        raw: &Value,
        primitive: &Primitive,
        weights: &[f32],
        pose: &Pose,
        at: &str,
    ) -> Option<Part> {
        let mode = self.triangle_mode(primitive, at)?;
        if self.triangles > self.most_triangles() {
            return None; // reported by the primitive that went too far
        }
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|a| a.value());
        let place = |name: &str| format!("{at}.attributes.{name}");
        let Some(accessor) = attribute(Semantic::Positions) else {
            let message = "has no POSITION; the primitive is left out";
            self.report.warning("G0602", &place("POSITION"), message);
            return None;
        };
        let positions = self.floats(accessor, VEC3, &place("POSITION"))?;
        let vertices = positions.count();
        let mut faces = self.faces(primitive, mode, vertices, at)?;
        let order = triangles::compact(&mut faces, vertices);
        let position = |v: &u32| Vec3::from(positions.get(*v as usize, 0.0)).as_dvec3();
        let mut part = Part {
            positions: order.iter().map(position).collect(),
            triangles: faces,
            ..Part::default()
        };
        drop(positions);

        if let Some(accessor) = attribute(Semantic::Normals) {
            let normals = self.attribute::<3>(accessor, VEC3, &order, vertices, &place("NORMAL"))?;
            part.normals = normals.into_iter().map(Vec3::from).collect();
        }
        for set in 0..super::texture::MAX_UV_SETS {
            let Some(accessor) = attribute(Semantic::TexCoords(set)) else {
                continue;
            };
            let at = place(&format!("TEXCOORD_{set}"));
            let uvs = self.attribute::<2>(accessor, UV, &order, vertices, &at)?;
            part.uvs.resize(set as usize, Vec::new());
            let mut uvs: Vec<Vec2> = uvs.into_iter().map(Vec2::from).collect();
            self.finite_or(&mut uvs, Vec2::ZERO, Vec2::is_finite, &at);
            part.uvs.push(uvs);
        }
        if let Some(accessor) = attribute(Semantic::Colors(0)) {
            let colors = self.attribute::<4>(accessor, COLOR, &order, vertices, &place("COLOR_0"))?;
            part.colors = colors.into_iter().map(Vec4::from).collect();
            self.finite_or(&mut part.colors, Vec4::ONE, Vec4::is_finite, &place("COLOR_0"));
        }
        part.material = self.material_of(raw, !part.colors.is_empty(), at)?;
        self.check_uv_sets(&part, at);
        let needed = self.needed_tangents(part.material);
        // Tangents without normals must be ignored, and without a normal map nobody looks at them.
        if let (Some(accessor), Some(_), false) = (attribute(Semantic::Tangents), needed, part.normals.is_empty()) {
            let tangents = self.attribute::<4>(accessor, VEC4, &order, vertices, &place("TANGENT"))?;
            part.tangents = tangents.into_iter().map(Vec4::from).collect();
        }

        let rest = (!pose.later.is_empty()).then(|| (part.positions.clone(), part.normals.clone()));
        self.morph(&mut part, primitive, weights, &order, vertices, at)?;
        if let Some(joints) = &pose.joints {
            self.skin(&mut part, primitive, joints, &order, vertices, at)?;
        }
        if let Some(rest) = rest {
            self.bend(&mut part, (rest, at), primitive, weights, pose, (&order, vertices))?;
        }
        self.drop_infinite(&mut part, at);
        self.mend_normals(&mut part, &place("NORMAL"));
        part.tangents = unit_tangents(&part.tangents).unwrap_or_default();
        if let (Some((set, transform)), true) = (needed, part.tangents.is_empty()) {
            tangent::generate(&mut part, set as usize, transform);
        }
        Some(part)
    }

    /// The mode, if it makes triangles. Points and lines have no surface: one note for all of them.
    fn triangle_mode(&mut self, primitive: &Primitive, at: &str) -> Option<Mode> {
        match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => Some(mode),
            Checked::Valid(_) => {
                let d = Diagnostic::note("G0603", "points and lines have no surface and are not drawn");
                self.report.push("", d);
                None
            }
            Checked::Invalid => {
                self.report
                    .error("G0604", &format!("{at}.mode"), "is no primitive mode, expected 0 to 6");
                None
            }
        }
    }

    /// The triangles of a primitive, every corner below `vertices`.
    fn faces(&mut self, primitive: &Primitive, mode: Mode, vertices: usize, at: &str) -> Option<Vec<[u32; 3]>> {
        let place = format!("{at}.indices");
        let corners: Vec<u32> = match primitive.indices {
            Some(accessor) => self.integers(accessor.value(), &[1], &place)?,
            None => (0..u32::try_from(vertices).ok()?).collect(),
        };
        let restart = self.restart_value(primitive);
        let is_restart = |corner: &u32| Some(*corner) == restart && *corner as usize >= vertices;
        let is_bad = |corner: &u32| *corner as usize >= vertices && !is_restart(corner);
        if let Some((i, bad)) = corners.iter().enumerate().find(|(_, c)| is_bad(c)) {
            let message = format!("index {i} is {bad}, but POSITION has {vertices} elements");
            let d = Diagnostic::error("G0605", message);
            self.report
                .push(&place, d.hint("the file is damaged: copy or export it again"));
            return None;
        }
        let (count, restarts) = (corners.len(), corners.iter().filter(|c| is_restart(c)).count());
        let (faces, rest) = if restarts == 0 {
            triangles::assemble(mode, corners)
        } else {
            let message =
                format!("has {restarts} primitive restart values, which glTF forbids; a new strip begins there");
            self.report.warning("G0617", &place, message);
            let runs = corners
                .split(is_restart)
                .map(|run| triangles::assemble(mode, run.to_vec()));
            runs.fold((Vec::new(), 0), |(mut all, rest), (faces, left)| {
                all.extend(faces);
                (all, rest + left)
            })
        };
        if rest > 0 || faces.is_empty() {
            let message = format!("{count} corners make {} triangles; {rest} are left over", faces.len());
            self.report.warning("G0606", at, message);
        }
        self.triangles += faces.len() as u64;
        let most = self.most_triangles();
        if self.triangles > most {
            let message = format!("the model has more than {most} triangles, far more than its buffers hold");
            self.report.error("G0610", at, message);
            return None;
        }
        (!faces.is_empty()).then_some(faces)
    }

    /// The largest number of the indices' type, which begins a new strip in graphics libraries.
    fn restart_value(&self, primitive: &Primitive) -> Option<u32> {
        let accessor = self.doc.top("accessors")?.get(primitive.indices?.value())?;
        match accessor.get("componentType")?.as_u64()? {
            5121 => Some(u8::MAX.into()),
            5123 => Some(u16::MAX.into()),
            5125 => Some(u32::MAX),
            _ => None,
        }
    }

    /// Most triangles that the file may have, by the bytes read so far.
    pub(super) fn most_triangles(&self) -> u64 {
        TRIANGLES.0.saturating_add(TRIANGLES.1.saturating_mul(self.bytes))
    }

    /// An attribute of the used vertices, missing components being 1.
    fn attribute<const N: usize>(
        &mut self,
        accessor: usize,
        wanted: Wanted,
        order: &[u32],
        vertices: usize,
        at: &str,
    ) -> Option<Vec<[f32; N]>> {
        let numbers = self.floats(accessor, wanted, at)?;
        self.same_count(numbers.count(), vertices, at)?;
        Some(order.iter().map(|&v| numbers.get(v as usize, 1.0)).collect())
    }

    /// Attributes of one primitive must have as many elements as its POSITION.
    pub(super) fn same_count(&mut self, found: usize, vertices: usize, at: &str) -> Option<()> {
        if found != vertices {
            let message = format!("has {found} elements, but POSITION has {vertices}");
            self.report.error("G0611", at, message);
            return None;
        }
        Some(())
    }

    /// The material of a primitive in the chosen variant. Inner `None` is the default of whoever places the mesh.
    fn material_of(&mut self, raw: &Value, colors: bool, at: &str) -> Option<Option<MaterialId>> {
        let (from, at) = match self.variant_mapping(raw) {
            Some(mapping) => (mapping, format!("{at}.extensions.KHR_materials_variants")),
            None => (raw, at.to_owned()),
        };
        match super::document::index_of(from, "material", &at, &mut self.report) {
            Some(index) => Some(Some(self.material(index, colors, &format!("{at}.material"))?)),
            None => {
                let id = self.default_material(colors);
                if !colors {
                    self.scene.default_material = Some(id);
                }
                Some(colors.then_some(id))
            }
        }
    }

    /// The coordinate set and transform along which a material needs tangents, if it does.
    fn needed_tangents(&self, material: Option<MaterialId>) -> Option<(u32, DAffine2)> {
        let material = self.scene.materials.get(material?.index())?;
        let image = |texture: TextureId| match self.scene.textures.get(texture.index()) {
            Some(Texture::Image(t)) => Some((t.uv_set, t.uv_transform)),
            _ => None,
        };
        let own = material.normal_map.and_then(|n| image(n.texture));
        let SurfaceModel::Principled(p) = &material.surface else {
            return own;
        };
        let coat = p.clearcoat_normal.and_then(|n| image(n.texture));
        let turned = (p.anisotropy.factor != 0.0).then_some((0, DAffine2::IDENTITY));
        let direction = p.anisotropy_direction.and_then(image);
        own.or(coat).or(direction).or(turned)
    }

    /// Warns of images that the primitive has no coordinates for.
    fn check_uv_sets(&mut self, part: &Part, at: &str) {
        let Some(material) = part.material.and_then(|m| self.scene.materials.get(m.index())) else {
            return;
        };
        let mut textures = vec![material.emission.texture, material.normal_map.map(|n| n.texture)];
        if let SurfaceModel::Principled(p) = &material.surface {
            textures.extend([p.base_color.texture, p.metallic.texture.map(|t| t.0)]);
        }
        let mut set_of = |id: TextureId| match self.scene.textures.get(id.index())? {
            Texture::Image(t) => Some(t.uv_set),
            Texture::Product(a, _) => match self.scene.textures.get(a.index())? {
                Texture::Image(t) => Some(t.uv_set),
                _ => None,
            },
            _ => None,
        };
        let sets = textures.into_iter().flatten().filter_map(&mut set_of);
        let missing = sets
            .filter(|set| part.uvs.get(*set as usize).is_none_or(Vec::is_empty))
            .min();
        if let Some(set) = missing {
            let message = format!(
                "has no TEXCOORD_{set}, which an image of material \"{}\" needs",
                material.name
            );
            self.report.warning("G0615", &format!("{at}.attributes"), message);
        }
    }

    /// Values that are not finite become `instead`, with a warning.
    fn finite_or<T: Copy + std::fmt::Display>(
        &mut self,
        values: &mut [T],
        instead: T,
        is_finite: fn(T) -> bool,
        at: &str,
    ) {
        let mut bad = 0;
        for value in values.iter_mut().filter(|v| !is_finite(**v)) {
            *value = instead;
            bad += 1;
        }
        if bad > 0 {
            let message = format!("{bad} of {} are not finite; {instead} is used", values.len());
            self.report.mended("G0612", at, message, Anomaly::MovedValue, bad);
        }
    }
}
