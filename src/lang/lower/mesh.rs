//! `mesh { … }` and `mesh2 { … }`.

use crate::diag::{Anomaly, Span};
use crate::lang::desc::{Layers, Look, MeshDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, T, Value};
use crate::lang::syntax::Word;
use crate::math::robust::try_normalize_f64;
use crate::scene::{Mesh, mend_normals};
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::rc::Rc;

/// The lists of a mesh as written: faces name a position, a normal and a texture coordinate for each corner.
#[derive(Default)]
struct Lists {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<Vec2>,
    looks: Vec<Look>,
    faces: Vec<[u32; 3]>,
    /// Slot of each face, 0 for the object's own look.
    slots: Vec<u32>,
    normal_faces: Vec<[u32; 3]>,
    uv_faces: Vec<[u32; 3]>,
}

impl Interp<'_> {
    /// `mesh { triangle { … } … }` behind the brace.
    pub fn mesh(&mut self, span: Span) -> Parsed<ShapeDesc> {
        let mut lists = Lists::default();
        let mut smooth = Vec::new();
        loop {
            let tok = self.peek_item();
            let T::Word(w @ (Word::Triangle | Word::SmoothTriangle)) = tok.t else {
                break;
            };
            self.bump();
            let (corners, normals, layers) = self.block(|s| {
                let (corners, normals) = s.corners(w == Word::SmoothTriangle)?;
                if s.eat_word(Word::UvVectors) {
                    s.skip_arguments()?;
                }
                let layers = if s.eat_word(Word::Texture) {
                    Some(s.mesh_texture()?)
                } else {
                    None
                };
                Ok((corners, normals, layers))
            })?;
            let first = lists.positions.len() as u32;
            lists.positions.extend(corners);
            lists.faces.push([first, first + 1, first + 2]);
            lists.slots.push(layers.map_or(0, |l| slot_of(&mut lists.looks, l)));
            smooth.push(normals);
            self.comma();
        }
        if smooth.iter().any(Option::is_some) {
            for (normals, face) in smooth.iter().zip(&lists.faces) {
                // A flat triangle among smooth ones gets its own normal at every corner.
                let [a, b, c] = face.map(|i| lists.positions.get(i as usize).copied().unwrap_or_default());
                let flat = (b - a).cross(c - a).normalize_or(DVec3::Y);
                lists.normals.extend(normals.unwrap_or([flat; 3]));
            }
            lists.normal_faces = lists.faces.clone();
        }
        if self.eat_word(Word::InsideVector) {
            self.vec3("inside_vector")?;
        }
        self.finish_mesh(lists, span)
    }

    /// `texture { Name }` of a triangle, behind the word.
    fn mesh_texture(&mut self) -> Parsed<Layers> {
        self.block(|s| s.texture_items(b'}'))
    }

    /// `mesh2 { … }` behind the brace.
    pub fn mesh2(&mut self, span: Span) -> Parsed<ShapeDesc> {
        let mut lists = Lists::default();
        loop {
            let tok = self.peek_item();
            let T::Word(w) = tok.t else { break };
            match w {
                Word::VertexVectors => lists.positions = self.vectors()?,
                Word::NormalVectors => lists.normals = self.vectors()?,
                Word::UvVectors => {
                    let uvs = self.vectors()?;
                    // v grows upwards here and downwards in the IR.
                    lists.uvs = uvs.iter().map(|v| Vec2::new(v.x as f32, (1.0 - v.y) as f32)).collect();
                }
                Word::TextureList => lists.looks = self.texture_list()?,
                Word::FaceIndices => self.faces(&mut lists)?,
                Word::NormalIndices => lists.normal_faces = self.index_triples("normal", lists.normals.len())?,
                Word::UvIndices => lists.uv_faces = self.index_triples("uv", lists.uvs.len())?,
                Word::InsideVector => {
                    self.bump();
                    self.vec3("inside_vector")?;
                }
                _ => break,
            }
            self.comma();
        }
        self.finish_mesh(lists, span)
    }

    /// `{ n, <…>, <…> … }` behind a word: the count is checked, not trusted.
    fn vectors(&mut self) -> Parsed<Vec<DVec3>> {
        self.bump();
        self.block(|s| {
            let at = s.peek().span;
            let count = s.float("number of vectors")?;
            s.comma();
            let mut out = Vec::new();
            while !s.at_close() {
                out.push(s.vec3("vector")?);
                s.comma();
            }
            if out.len() as f64 != count {
                return Err(s.error(
                    "P0313",
                    at,
                    format!("list announces {count} vectors, found {}", out.len()),
                ));
            }
            Ok(out)
        })
    }

    fn texture_list(&mut self) -> Parsed<Vec<Look>> {
        self.bump();
        self.block(|s| {
            s.float("number of textures")?;
            s.comma();
            let mut out = Vec::new();
            while !s.at_close() {
                let layers = match s.peek().t {
                    T::Word(Word::Texture) => s.texture()?,
                    T::Name(_) => match s.take_value()? {
                        Value::Desc(crate::lang::desc::Desc::Texture(l)) => l,
                        _ => return Err(s.expected("a texture")),
                    },
                    _ => return Err(s.expected("a texture")),
                };
                out.push(Look {
                    layers: Some(layers),
                    ..Look::default()
                });
                s.comma();
            }
            Ok(out)
        })
    }

    /// `face_indices { n, <a, b, c>, texture, … }`.
    fn faces(&mut self, lists: &mut Lists) -> Parsed<()> {
        self.bump();
        let (vertices, looks) = (lists.positions.len(), lists.looks.len());
        self.block(|s| {
            let at = s.peek().span;
            let count = s.float("number of faces")?;
            s.comma();
            while !s.at_close() {
                let face = s.index_triple("vertex", vertices)?;
                s.comma();
                let mut slot = 0;
                let mut first = true;
                // One texture for the face, or one for each corner; corners cannot differ yet.
                while matches!(s.peek().t, T::Number(_)) || (s.peek().t != T::Mark(b'<') && s.starts_expr()) {
                    let place = s.peek().span;
                    let i = s.float("texture index")?;
                    if i < 0.0 || i as usize >= looks {
                        let message = format!("texture index {i} is outside 0..{looks}");
                        return Err(s.error("P0313", place, message));
                    }
                    if std::mem::take(&mut first) {
                        slot = i as u32 + 1;
                    }
                    s.comma();
                }
                lists.faces.push(face);
                lists.slots.push(slot);
            }
            if lists.faces.len() as f64 != count {
                let message = format!("list announces {count} faces, found {}", lists.faces.len());
                return Err(s.error("P0313", at, message));
            }
            Ok(())
        })
    }

    fn index_triples(&mut self, what: &str, limit: usize) -> Parsed<Vec<[u32; 3]>> {
        self.bump();
        self.block(|s| {
            s.float("number of faces")?;
            s.comma();
            let mut out = Vec::new();
            while !s.at_close() {
                out.push(s.index_triple(what, limit)?);
                s.comma();
            }
            Ok(out)
        })
    }

    fn index_triple(&mut self, what: &str, limit: usize) -> Parsed<[u32; 3]> {
        let at = self.peek().span;
        let v = self.vec3("face")?;
        let mut out = [0u32; 3];
        for (slot, i) in out.iter_mut().zip(v.to_array()) {
            if i < 0.0 || i as usize >= limit {
                let message = format!("{what} index {i} is outside 0..{limit}");
                return Err(self.error("P0313", at, message));
            }
            *slot = i as u32;
        }
        Ok(out)
    }

    fn finish_mesh(&mut self, mut lists: Lists, span: Span) -> Parsed<ShapeDesc> {
        if lists.faces.is_empty() {
            return Err(self.error("P0313", span, "mesh has no faces"));
        }
        // Without indices of their own, normals and uvs go by the vertex.
        if lists.normal_faces.is_empty() && !lists.normals.is_empty() {
            lists.normal_faces = lists.faces.clone();
        }
        if lists.uv_faces.is_empty() && !lists.uvs.is_empty() {
            lists.uv_faces = lists.faces.clone();
        }
        let fits = |faces: &[[u32; 3]], n: usize| {
            faces.is_empty() || (faces.len() == lists.faces.len() && faces.iter().flatten().all(|&i| (i as usize) < n))
        };
        if !fits(&lists.normal_faces, lists.normals.len()) || !fits(&lists.uv_faces, lists.uvs.len()) {
            return Err(self.error("P0313", span, "normals or uvs of the mesh do not match its faces"));
        }
        let Some((mesh, mended)) = build(&lists) else {
            return Err(self.error("P0313", span, "mesh has an index out of range"));
        };
        if mended > 0 {
            let message = format!("{mended} normals without direction are replaced by those of their faces");
            self.mended("P0316", span, message, Anomaly::ReplacedNormal, mended);
        }
        if mesh.dropped_faces > 0 {
            self.warn(
                "P0314",
                span,
                format!("{} triangles without a surface were left out", mesh.dropped_faces),
            );
        }
        if mesh.triangles.is_empty() {
            return Err(self.error("P0313", span, "mesh has no triangle with a surface"));
        }
        Ok(ShapeDesc::Mesh(Rc::new(MeshDesc {
            mesh,
            looks: lists.looks,
        })))
    }
}

fn slot_of(looks: &mut Vec<Look>, layers: Layers) -> u32 {
    let known = looks
        .iter()
        .rposition(|l| l.layers.as_ref().is_some_and(|k| same(k, &layers)));
    if let Some(i) = known {
        return i as u32 + 1;
    }
    looks.push(Look {
        layers: Some(layers),
        ..Look::default()
    });
    looks.len() as u32
}

/// Whether two textures are the same declared one.
fn same(a: &Layers, b: &Layers) -> bool {
    let ends = |l: &Layers| l.first().map(|l| (Rc::as_ptr(&l.pigment), Rc::as_ptr(&l.finish)));
    a.len() == b.len() && ends(a) == ends(b)
}

/// One vertex for each combination of position, normal and uv that a corner uses; `None` for an index out of range.
/// With the mesh comes the number of its normals that had no direction.
fn build(lists: &Lists) -> Option<(Mesh, u64)> {
    let shared = (lists.normal_faces.is_empty()
        || (lists.normal_faces == lists.faces && lists.normals.len() >= lists.positions.len()))
        && (lists.uv_faces.is_empty() || (lists.uv_faces == lists.faces && lists.uvs.len() >= lists.positions.len()));
    let (mut positions, mut normals, mut uvs, mut faces) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    if shared {
        positions = lists.positions.clone();
        faces = lists.faces.clone();
        if !lists.normal_faces.is_empty() {
            normals = lists.normals.iter().take(positions.len()).copied().collect();
        }
        if !lists.uv_faces.is_empty() {
            uvs = lists.uvs.iter().take(positions.len()).copied().collect();
        }
    } else {
        let mut seen: HashMap<[u32; 3], u32> = HashMap::new();
        for (f, face) in lists.faces.iter().enumerate() {
            let mut corners = [0u32; 3];
            for (k, corner) in corners.iter_mut().enumerate() {
                let index = |faces: &[[u32; 3]]| faces.get(f).map_or(u32::MAX, |f| f[k]);
                let key = [face[k], index(&lists.normal_faces), index(&lists.uv_faces)];
                if let Some(&known) = seen.get(&key) {
                    *corner = known;
                    continue;
                }
                *corner = positions.len() as u32;
                seen.insert(key, *corner);
                positions.push(*lists.positions.get(face[k] as usize)?);
                if !lists.normal_faces.is_empty() {
                    normals.push(*lists.normals.get(key[1] as usize)?);
                }
                if !lists.uv_faces.is_empty() {
                    uvs.push(*lists.uvs.get(key[2] as usize)?);
                }
            }
            faces.push(corners);
        }
    }
    let mut mesh = Mesh::from_f64("", &positions, &[])?;
    for (f, face) in faces.iter().enumerate() {
        if face.iter().any(|&i| i as usize >= positions.len()) {
            return None;
        }
        let slot = lists.slots.get(f).copied().unwrap_or(0);
        mesh.push_face(*face, (!lists.looks.is_empty()).then_some(slot));
    }
    // Unit in f64 first: what is short or long is no zero or infinity yet.
    let unit = |n: &DVec3| try_normalize_f64(*n).map_or(Vec3::ZERO, |n| n.as_vec3());
    mesh.normals = normals.iter().map(unit).collect();
    let mended = mend_normals(&mut mesh.normals, &positions, &mesh.triangles, false);
    if !uvs.is_empty() {
        mesh.uvs = vec![uvs];
    }
    Some((mesh, mended))
}
