//! `KHR_draco_mesh_compression`: a primitive's triangles and attributes packed together in one view.
//!
//! What the stream holds takes the place of the accessors of the primitive: their numbers are read from the unpacked
//! data, everything else (normalisation, checks, morph targets, skins) goes on as for any accessor. Where the file
//! also has the accessors' own data, a stream that cannot be read costs a warning only.

use super::Loader;
use super::accessor::Supplied;
use super::buffer::Blob;
use super::extension::Fields;
use crate::diag::{Diagnostic, guarded};
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use gltf::json;
use json::accessor::ComponentType;
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::Checked;
use std::rc::Rc;

/// The stream unpacked last, by its view: primitives that share one follow each other. `None` if it was refused.
#[derive(Default)]
pub(super) struct Last(Option<(usize, Result<Rc<Mesh>, String>)>);

/// Most bytes of attributes for each triangle that a stream may hold.
const BYTES_PER_TRIANGLE: u64 = 192;
/// Stands for the accessor of the indices of a primitive that has none.
const NO_ACCESSOR: u32 = u32::MAX;

impl Loader<'_> {
    /// The primitive with its Draco data as the content of its accessors. Inner `None` if it has no such data (or can
    /// do without), outer `None` if they cannot be read (reported).
    pub(super) fn unpack_draco(
        &mut self,
        raw: &serde_json::Value,
        primitive: &Primitive,
        at: &str,
    ) -> Option<Option<Primitive>> {
        let Some(fields) = Fields::of(raw, "KHR_draco_mesh_compression", at) else {
            return Some(None);
        };
        let why = match self.supply(&fields, primitive) {
            Ok(unpacked) => return Some(Some(unpacked)),
            Err(why) => why,
        };
        self.accessors.supplied.clear();
        if self.has_own_data(primitive) {
            let message = format!("{why}; the uncompressed data beside them are used");
            self.report.warning("G0315", fields.at(), message);
            return Some(None);
        }
        let d = Diagnostic::error("G0315", why);
        let hint = "the file is cut or damaged: copy or export it again";
        self.report.push(fields.at(), d.hint(hint));
        None
    }

    /// Whether all accessors of the primitive have data of their own.
    fn has_own_data(&self, primitive: &Primitive) -> bool {
        let indices = primitive.indices.iter();
        let mut all = primitive.attributes.values().chain(indices);
        all.all(|accessor| {
            let table = self.doc.top("accessors");
            let accessor = table.and_then(|t| t.get(accessor.value()));
            accessor.is_some_and(|a| a.get("bufferView").is_some())
        })
    }

    /// Unpacks the stream and gives its content to the primitive's accessors.
    fn supply(&mut self, fields: &Fields, primitive: &Primitive) -> Result<Primitive, String> {
        let mesh = self.unpacked_mesh(fields)?;
        let ids = fields.member("attributes").and_then(|a| a.as_object());
        let ids = ids.ok_or("the Draco extension has no `attributes`")?;
        let points = mesh.num_points();
        for (semantic, id) in ids {
            let is_it = |key: &Checked<Semantic>| matches!(key, Checked::Valid(s) if s.to_string() == *semantic);
            let accessor = primitive
                .attributes
                .iter()
                .find(|(key, _)| is_it(key))
                .map(|(_, a)| a.value());
            // An attribute that the primitive does not name is none of it.
            let Some(accessor) = accessor else { continue };
            let id = id.as_u64().and_then(|id| u32::try_from(id).ok());
            let attribute = id.and_then(|id| mesh.attribute_by_unique_id(id));
            let attribute = attribute.ok_or_else(|| format!("the Draco data have no attribute for {semantic}"))?;
            let normalized = self.normalized(accessor, attribute);
            let supplied = expand(attribute, points, normalized);
            let supplied = supplied.ok_or_else(|| format!("the Draco data of {semantic} are inconsistent"))?;
            self.accessors.supplied.insert(accessor, supplied);
        }
        let mut unpacked = primitive.clone();
        // Also where strips were packed, the stream holds triangles.
        unpacked.mode = Checked::Valid(Mode::Triangles);
        let indices = *unpacked.indices.get_or_insert(json::Index::new(NO_ACCESSOR));
        let faces = mesh.faces().iter().flatten();
        let bytes = faces.flat_map(|corner| corner.0.to_le_bytes()).collect();
        let corners = Supplied {
            kind: ComponentType::U32,
            components: 1,
            normalized: false,
            count: mesh.num_faces() * 3,
            bytes: whole(bytes),
        };
        self.accessors.supplied.insert(indices.value(), corners);
        Ok(unpacked)
    }

    /// Whether the integers of an attribute are fractions: the accessor says so, unless the stream has other numbers.
    fn normalized(&self, accessor: usize, attribute: &PointAttribute) -> bool {
        let table = self.doc.top("accessors");
        let accessor = table.and_then(|t| t.get(accessor));
        let kind = accessor.and_then(|a| a.get("componentType")?.as_u64());
        let said = accessor.and_then(|a| a.get("normalized")?.as_bool());
        match kind_of(attribute.data_type()) {
            Some(found) if kind.is_none_or(|k| k == u64::from(found.as_gl_enum())) => said.unwrap_or(false),
            _ => attribute.normalized(),
        }
    }

    /// The mesh in the view that the extension names.
    fn unpacked_mesh(&mut self, fields: &Fields) -> Result<Rc<Mesh>, String> {
        let view = fields.member("bufferView").and_then(|v| v.as_u64());
        let view = view.and_then(|v| usize::try_from(v).ok());
        let view = view.ok_or("the Draco extension has no `bufferView`")?;
        if let Some((known, mesh)) = &self.draco.0
            && *known == view
        {
            return mesh.clone();
        }
        self.draco.0 = None;
        let mesh = self.unpack_view(view, fields).map(Rc::new);
        self.draco.0 = Some((view, mesh.clone()));
        mesh
    }

    fn unpack_view(&mut self, view: usize, fields: &Fields) -> Result<Mesh, String> {
        let data = self.view(view, &fields.place("bufferView"));
        let data = data.ok_or("the view of the Draco data cannot be read")?.bytes;
        let left = self.most_triangles().saturating_sub(self.triangles);
        let limits = DecodeLimits::default()
            .with_max_faces(left)
            .with_max_points(left.saturating_mul(3))
            .with_max_decoded_bytes(left.saturating_mul(BYTES_PER_TRIANGLE));
        let mesh = decode(&data, limits)?;
        let (points, faces) = (mesh.num_points(), mesh.num_faces());
        if faces == 0 {
            return Err("the Draco data have no triangles".to_owned());
        }
        // Each triangle has three points of its own at most; others serve nothing but to take memory.
        if points > faces.saturating_mul(3) {
            return Err(format!("the Draco data have {points} points for {faces} triangles"));
        }
        if mesh.faces().iter().flatten().any(|corner| corner.0 as usize >= points) {
            return Err("a triangle of the Draco data has a corner that is not there".to_owned());
        }
        let attributes = (0..mesh.num_attributes()).map(|i| mesh.attribute(i).buffer().data_size());
        self.bytes += attributes.sum::<usize>() as u64;
        Ok(mesh)
    }
}

/// Decodes a stream: no more than `limits` allow, and without panics.
fn decode(data: &[u8], limits: DecodeLimits) -> Result<Mesh, String> {
    let attempt = guarded(|| {
        let mut mesh = Mesh::new();
        let mut buffer = DecoderBuffer::new(data).with_limits(limits);
        let result = MeshDecoder::new().decode(&mut buffer, &mut mesh);
        result.map(|()| mesh).map_err(|error| error.to_string())
    });
    let result = attempt.unwrap_or_else(|| Err("they are inconsistent".to_owned()));
    result.map_err(|why| format!("the Draco data cannot be decoded: {why}"))
}

/// The attribute's value of every point, one after another.
fn expand(attribute: &PointAttribute, points: usize, normalized: bool) -> Option<Supplied> {
    let components = usize::from(attribute.num_components());
    let Some(kind) = kind_of(attribute.data_type()) else {
        // Numbers that glTF has no type for.
        let values = guarded(|| attribute.read_f32s(points, components))?;
        let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        return Some(Supplied {
            kind: ComponentType::F32,
            components,
            normalized: false,
            count: points,
            bytes: whole(bytes),
        });
    };
    let (size, data) = (components * kind.size(), attribute.buffer().data());
    let stride = usize::try_from(attribute.byte_stride()).ok()?;
    let mut bytes = Vec::with_capacity(points.checked_mul(size)?);
    for point in 0..u32::try_from(points).ok()? {
        let value = attribute.mapped_index(PointIndex(point)).0 as usize;
        let start = value.checked_mul(stride)?;
        bytes.extend_from_slice(data.get(start..start.checked_add(size)?)?);
    }
    Some(Supplied {
        kind,
        components,
        normalized,
        count: points,
        bytes: whole(bytes),
    })
}

/// The same type of component in glTF.
fn kind_of(kind: DataType) -> Option<ComponentType> {
    Some(match kind {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 | DataType::Bool => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        _ => return None,
    })
}

fn whole(bytes: Vec<u8>) -> Blob {
    let all = 0..bytes.len();
    Blob::new(bytes.into(), all)
}
