//! Polygons with separate indices to the scene's triangle meshes, one an object.

use super::clean::{Cleaned, FaceInfo};
use super::normals::{Chains, SmoothNormals, face_normal};
use super::polygon::triangulate;
use super::report::Report;
use super::tangents::add_tangents;
use crate::diag::Diagnostic;
use crate::math::color::linear_from_srgb;
use crate::scene::{Material, MaterialId, Mesh, Object, Place, Scene, Shape, SurfaceModel, Texture};
use glam::{DVec3, Vec2, Vec3, Vec4};
use std::ops::Range;

/// Adds one mesh and one object for each `o` that has faces. `materials` has an entry for each of
/// [`Cleaned::materials`]. `None` if the text could not be read, which is reported.
pub(super) fn add_meshes(
    cleaned: &Cleaned,
    materials: &[Option<MaterialId>],
    stem: &str,
    scene: &mut Scene,
    report: &mut Report,
) -> Option<()> {
    let source = match read(cleaned) {
        Ok(source) => source,
        Err(reason) => {
            let message = format!("OBJ geometry cannot be read: {reason}");
            report.push(1, Diagnostic::error("O0004", message).hint("export the model again"));
            return None;
        }
    };
    let colored = cleaned.has_colors.then(|| vertex_color_material(scene));
    let mut faces = 0..0;
    while faces.end < cleaned.faces.len() {
        let object = cleaned.faces.get(faces.end).map_or(0, |f| f.object);
        let run = cleaned
            .faces
            .iter()
            .skip(faces.end)
            .take_while(|f| f.object == object)
            .count();
        faces = faces.end..faces.end + run;
        let named = cleaned.objects.get(object as usize);
        let name = named.map(|o| o.name.as_str()).filter(|n| !n.is_empty()).unwrap_or(stem);
        let line = named.map_or(1, |o| o.line);
        let mut builder = Builder::new(cleaned, &source, faces.clone());
        builder.add_faces(cleaned, materials, colored, report);
        let mut mesh = builder.finish(name);
        let in_relief = |m: &MaterialId| {
            let material = scene.materials.get(m.index());
            material.is_some_and(|m| m.normal_map.is_some() || m.bump_map.is_some())
        };
        if mesh.materials.iter().flatten().any(in_relief) {
            add_tangents(&mut mesh);
        }
        if mesh.dropped_faces > 0 {
            let message = format!(
                "{} triangles of {name:?} have no area and are left out",
                mesh.dropped_faces
            );
            report.push(line, Diagnostic::warning("O0120", message));
        }
        let shape = Shape::Mesh(scene.add_mesh(mesh));
        scene.objects.push(Object {
            name: name.to_owned(),
            place: Place::Model(report.place(line)),
            ..Object::new(shape)
        });
    }
    Some(())
}

/// Faces without a material show the colours of their vertices.
fn vertex_color_material(scene: &mut Scene) -> MaterialId {
    let mut material = Material::diffuse(DVec3::ONE);
    let texture = scene.add_texture(Texture::VertexColor);
    if let SurfaceModel::Diffuse { color, .. } = &mut material.surface {
        color.texture = Some(texture);
    }
    material.name = "vertex colours".to_owned();
    scene.add_material(material)
}

/// What `tobj` read, with the start of each face's corners.
struct Source {
    mesh: tobj::Mesh,
    starts: Vec<usize>,
}

fn read(cleaned: &Cleaned) -> Result<Source, String> {
    let options = tobj::LoadOptions::default();
    let mut reader = cleaned.obj.as_slice();
    let (models, _) = tobj::load_obj_buf(&mut reader, &options, |_| Err(tobj::LoadError::GenericFailure))
        .map_err(|e| e.to_string())?;
    let mesh = models.into_iter().next().ok_or("no model was found")?.mesh;
    let mut starts = vec![0];
    let mut end = 0_usize;
    for face in 0..cleaned.faces.len() {
        // An empty list of arities means triangles throughout.
        end += mesh.face_arities.get(face).map_or(3, |&n| n as usize);
        starts.push(end);
    }
    if end != mesh.indices.len() {
        return Err(format!("{} corners were read, {end} were written", mesh.indices.len()));
    }
    Ok(Source { mesh, starts })
}

impl Source {
    fn corners(&self, face: usize) -> Range<usize> {
        match self.starts.get(face..face + 2) {
            Some(&[start, end]) => start..end,
            _ => 0..0,
        }
    }

    fn vertex(&self, corner: usize) -> u32 {
        self.mesh.indices.get(corner).copied().unwrap_or(0)
    }

    fn position(&self, vertex: u32) -> Vec3 {
        triple(&self.mesh.positions, vertex)
    }

    fn texcoord(&self, corner: usize) -> (u32, Vec2) {
        let index = self.mesh.texcoord_indices.get(corner).copied().unwrap_or(0);
        let at = index as usize * 2;
        let uv = self.mesh.texcoords.get(at..at + 2).map_or(Vec2::ZERO, Vec2::from_slice);
        (index, uv)
    }

    /// The corner's own normal, if it has one.
    fn normal(&self, corner: usize) -> Option<(u32, Vec3)> {
        let index = self.mesh.normal_indices.get(corner).copied()?;
        let normal = triple(&self.mesh.normals, index);
        (normal != Vec3::ZERO).then_some((index, normal))
    }
}

fn triple(values: &[f32], index: u32) -> Vec3 {
    let at = index as usize * 3;
    values.get(at..at + 3).map_or(Vec3::ZERO, Vec3::from_slice)
}

/// Where the normal of a corner comes from; corners that agree in this, position and texture coordinate
/// become one vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NormalKey {
    /// The mesh has no normals at all.
    Absent,
    Given(u32),
    Smooth(u32),
    Flat(u32),
}

/// One mesh while its faces are collected.
struct Builder<'a> {
    source: &'a Source,
    origin: DVec3,
    faces: Range<usize>,
    has_normals: bool,
    smooth: SmoothNormals,
    vertices: Chains<(u32, NormalKey), u32>,
    positions: Vec<DVec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    colors: Vec<Vec4>,
    triangles: Vec<([u32; 3], u32)>,
    slots: Vec<Option<MaterialId>>,
}

impl<'a> Builder<'a> {
    fn new(cleaned: &Cleaned, source: &'a Source, faces: Range<usize>) -> Builder<'a> {
        let base = faces
            .clone()
            .flat_map(|f| source.corners(f))
            .map(|c| source.vertex(c))
            .min()
            .unwrap_or(0);
        let mut builder = Builder {
            source,
            origin: cleaned.origin,
            faces,
            has_normals: false,
            smooth: SmoothNormals::from_vertex(base),
            vertices: Chains::from_vertex(base),
            positions: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            colors: Vec::new(),
            triangles: Vec::new(),
            slots: Vec::new(),
        };
        let mut corners = Vec::new();
        for face in builder.faces.clone() {
            let smoothing = cleaned.faces.get(face).map_or(0, |f| f.smoothing);
            let given = |c| source.normal(c).is_some();
            builder.has_normals |= smoothing > 0 || source.corners(face).any(given);
            if smoothing > 0 && !source.corners(face).all(given) {
                corners.clear();
                corners.extend(source.corners(face).map(|c| {
                    let vertex = source.vertex(c);
                    (vertex, source.position(vertex).as_dvec3())
                }));
                builder.smooth.add_face(smoothing, &corners);
            }
        }
        builder
    }

    fn add_faces(
        &mut self,
        cleaned: &Cleaned,
        materials: &[Option<MaterialId>],
        colored: Option<MaterialId>,
        report: &mut Report,
    ) {
        let mut polygon = Vec::new();
        for face in self.faces.clone() {
            let Some(info) = cleaned.faces.get(face) else { continue };
            let material = info
                .material
                .and_then(|m| materials.get(m as usize).copied().flatten())
                .or(colored);
            let slot = self.slot(material);
            let corners = self.source.corners(face);
            polygon.clear();
            polygon.extend(
                corners
                    .clone()
                    .map(|c| self.source.position(self.source.vertex(c)).as_dvec3()),
            );
            let vertices: Vec<u32> = corners.map(|c| self.vertex(c, face, info, &polygon)).collect();
            let cut = triangulate(&polygon);
            if cut.is_crossed {
                let message =
                    "face `f` crosses itself or has too many corners; its triangles may overlap or leave gaps";
                report.push(info.line, Diagnostic::warning("O0121", message));
            }
            for [a, b, c] in cut.triangles {
                if let (Some(&a), Some(&b), Some(&c)) = (vertices.get(a), vertices.get(b), vertices.get(c)) {
                    self.triangles.push(([a, b, c], slot));
                }
            }
        }
    }

    fn slot(&mut self, material: Option<MaterialId>) -> u32 {
        // Neighbouring faces mostly agree, and objects have few materials.
        if let Some(at) = self.slots.iter().rposition(|s| *s == material) {
            return at as u32;
        }
        self.slots.push(material);
        self.slots.len() as u32 - 1
    }

    fn vertex(&mut self, corner: usize, face: usize, info: &FaceInfo, polygon: &[DVec3]) -> u32 {
        let source = self.source;
        let vertex = source.vertex(corner);
        let (uv_index, uv) = source.texcoord(corner);
        let given = source.normal(corner);
        let key = match given {
            _ if !self.has_normals => NormalKey::Absent,
            Some((index, _)) => NormalKey::Given(index),
            None if info.smoothing > 0 => NormalKey::Smooth(info.smoothing),
            None => NormalKey::Flat(face as u32),
        };
        if let Some(&known) = self.vertices.get(vertex, (uv_index, key)) {
            return known;
        }
        let new = self.positions.len() as u32;
        self.vertices.entry(vertex, (uv_index, key), || new);
        self.positions.push(self.origin + source.position(vertex).as_dvec3());
        self.uvs.push(uv);
        if self.has_normals {
            let flat = || face_normal(polygon.iter().copied()).unwrap_or(DVec3::Z).as_vec3();
            let smooth = || self.smooth.get(vertex, info.smoothing);
            self.normals
                .push(given.map(|g| g.1).or_else(smooth).unwrap_or_else(flat));
        }
        if !source.mesh.vertex_color.is_empty() {
            // Programs that write colours beside positions mean display values.
            let linear = |v: f32| linear_from_srgb(f64::from(v)) as f32;
            let color = triple(&source.mesh.vertex_color, vertex);
            self.colors.push(color.map(linear).extend(1.0));
        }
        new
    }

    fn finish(self, name: &str) -> Mesh {
        // Without faces there is no index that could be out of range.
        let mut mesh = Mesh::from_f64(name, &self.positions, &[]).unwrap_or_default();
        mesh.normals = self.normals;
        mesh.colors = self.colors;
        if self.uvs.iter().any(|uv| *uv != Vec2::ZERO) {
            mesh.uvs = vec![self.uvs.iter().map(|uv| Vec2::new(uv.x, 1.0 - uv.y)).collect()];
        }
        let many = self.slots.len() > 1;
        for (triangle, slot) in self.triangles {
            mesh.push_face(triangle, many.then_some(slot));
        }
        mesh.materials = self.slots;
        mesh
    }
}
