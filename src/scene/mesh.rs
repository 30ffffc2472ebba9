//! Triangle meshes, stored in f32 around their own centre so that far-away scenes keep their precision.

use super::MaterialId;
use crate::math::robust::{try_normalize, try_normalize_f64};
use glam::{DVec3, Vec2, Vec3, Vec4};

/// Indexed triangles. Optional attributes are empty or have one value per vertex.
/// Corners of a face are counter-clockwise seen from outside in a right-handed view of the mesh's own axes,
/// clockwise when `flip_winding` is set: the geometric normal is `(v1 − v0) × (v2 − v0)`, negated if flipped.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Name for messages.
    pub name: String,
    /// The mesh's own origin; vertex i stands at `center + positions[i]`.
    pub center: DVec3,
    /// Vertex positions relative to `center`.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, or empty for flat faces. Their side decides nothing: the geometric normal does.
    pub normals: Vec<Vec3>,
    /// Tangents (xyz unit, w = sign of the bitangent `w·(n × t)`), or empty.
    pub tangents: Vec<Vec4>,
    /// Texture coordinate sets, at most four; each empty or one value per vertex.
    /// (0, 0) is the top left corner of an image, v grows downwards.
    pub uvs: Vec<Vec<Vec2>>,
    /// Linear RGBA vertex colours, or empty.
    pub colors: Vec<Vec4>,
    /// Corner indices, all below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the index into `materials`; empty means 0 everywhere.
    pub face_materials: Vec<u32>,
    /// Materials by slot; `None` takes the placing object's material. Empty means one slot of `None`.
    pub materials: Vec<Option<MaterialId>>,
    /// Whether the geometric normal of every face is negated.
    pub flip_winding: bool,
    /// Its form at later moments while the shutter is open, if it changes: together with its own positions and normals at
    /// equal steps of time, vertices on straight lines in between.
    pub later: Vec<MeshForm>,
    /// Degenerate faces (zero area, repeated or non-finite corners) that were left out on loading.
    pub dropped_faces: u64,
}

/// The form of a mesh at one moment: as the fields of [`Mesh`] of the same names, around the same centre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshForm {
    /// Vertex positions relative to the mesh's centre.
    pub positions: Vec<Vec3>,
    /// Shading normals, of any length, or empty for flat faces.
    pub normals: Vec<Vec3>,
}

impl Mesh {
    /// Whether it really changes its form while the shutter is open.
    pub fn bends(&self) -> bool {
        let differs = |f: &MeshForm| f.positions != self.positions || f.normals != self.normals;
        self.later.iter().any(differs)
    }

    /// A mesh from f64 positions: chooses the centre of the bounding box as origin and rounds the rest to f32.
    /// Faces with repeated indices, non-finite corners or exactly zero area are dropped and counted.
    /// Returns `None` for an index out of range. Attributes are added by the caller afterwards
    /// (vertices are kept, also those that only dropped faces use).
    pub fn from_f64(name: &str, positions: &[DVec3], triangles: &[[u32; 3]]) -> Option<Mesh> {
        let finite = || positions.iter().filter(|p| p.is_finite());
        let min = finite().fold(DVec3::INFINITY, |a, p| a.min(*p));
        let max = finite().fold(DVec3::NEG_INFINITY, |a, p| a.max(*p));
        let center = if min.x <= max.x {
            min * 0.5 + max * 0.5
        } else {
            DVec3::ZERO
        };
        let mut mesh = Mesh {
            name: name.to_owned(),
            center,
            positions: positions.iter().map(|p| (*p - center).as_vec3()).collect(),
            ..Mesh::default()
        };
        for t in triangles {
            if t.iter().any(|&i| i as usize >= positions.len()) {
                return None;
            }
            mesh.push_face(*t, None);
        }
        Some(mesh)
    }

    /// Adds a face unless it is degenerate, which is counted. Indices must be in range.
    /// `slot` is remembered per face once any face of the mesh names one.
    pub fn push_face(&mut self, face: [u32; 3], slot: Option<u32>) -> bool {
        if !self.is_proper(face) {
            self.dropped_faces += 1;
            return false;
        }
        if let Some(slot) = slot {
            self.face_materials.resize(self.triangles.len(), 0);
            self.face_materials.push(slot);
        } else if !self.face_materials.is_empty() {
            self.face_materials.push(0);
        }
        self.triangles.push(face);
        true
    }

    /// Whether a face has three different finite corners that span an area (computed in f64, no threshold).
    pub fn is_proper(&self, face: [u32; 3]) -> bool {
        let [a, b, c] = face.map(|i| self.positions[i as usize].as_dvec3());
        let cross = (b - a).cross(c - a);
        cross.is_finite() && cross != DVec3::ZERO
    }

    /// The slot of a face.
    pub fn slot(&self, face: usize) -> u32 {
        self.face_materials.get(face).copied().unwrap_or(0)
    }

    /// The material of a slot, `None` for the placing object's.
    pub fn slot_material(&self, slot: u32) -> Option<MaterialId> {
        self.materials.get(slot as usize).copied().flatten()
    }
}

/// Makes shading normals unit. One without direction (zero, NaN or infinite) is replaced by the mean of the faces around
/// its vertex, weighted by area; (0, 0, 1) where those have no direction either. Returns how many were replaced.
/// `flipped` says that the faces' normals are −(v1 − v0) × (v2 − v0). Indices must be in range.
pub fn mend_normals(normals: &mut [Vec3], positions: &[DVec3], triangles: &[[u32; 3]], flipped: bool) -> u64 {
    let mut bad = 0;
    for n in normals.iter_mut() {
        *n = try_normalize(*n).unwrap_or_else(|| {
            bad += 1;
            Vec3::ZERO
        });
    }
    if bad == 0 {
        return 0;
    }
    let mut sums = vec![DVec3::ZERO; normals.len()];
    for face in triangles {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let area = (b - a).cross(c - a) * if flipped { -1.0 } else { 1.0 };
        if area.is_finite() {
            face.iter().for_each(|&v| sums[v as usize] += area);
        }
    }
    for (n, sum) in normals.iter_mut().zip(sums) {
        if *n == Vec3::ZERO {
            *n = try_normalize_f64(sum).unwrap_or(DVec3::Z).as_vec3();
        }
    }
    bad
}
