//! A primitive's data on its way into a mesh: mending what is not finite, and joining parts of like layout.

use super::Loader;
use super::deform::Form;
use crate::diag::Anomaly;
use crate::scene::{MaterialId, Mesh, MeshForm, mend_normals};
use glam::{DVec3, Vec2, Vec3, Vec4};
use std::borrow::Cow;

/// One primitive with everything applied; optional attributes are empty or have one value per vertex.
#[derive(Default)]
pub(super) struct Part {
    pub positions: Vec<DVec3>,
    pub normals: Vec<Vec3>,
    pub tangents: Vec<Vec4>,
    pub uvs: Vec<Vec<Vec2>>,
    pub colors: Vec<Vec4>,
    pub triangles: Vec<[u32; 3]>,
    pub material: Option<MaterialId>,
    pub flip_winding: bool,
    /// Its form at later moments while the shutter is open, if it changes.
    pub later: Vec<Form>,
    pub dropped: u64,
}

impl Part {
    /// Reorders all vertex data: the new vertex i is the old vertex `order[i]`. Triangles are the caller's to
    /// renumber.
    pub(super) fn gather(&mut self, order: &[u32]) {
        fn pick<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
            if !values.is_empty() {
                *values = order.iter().map(|&v| values[v as usize]).collect();
            }
        }
        pick(&mut self.positions, order);
        pick(&mut self.normals, order);
        pick(&mut self.tangents, order);
        pick(&mut self.colors, order);
        self.uvs.iter_mut().for_each(|set| pick(set, order));
        for (positions, normals) in &mut self.later {
            pick(positions, order);
            pick(normals, order);
        }
    }

    /// Its form at later moment `k`; where faces got normals of their own, those of the bent faces.
    fn form(&self, k: usize) -> (&[DVec3], Cow<'_, [Vec3]>) {
        let Some((positions, normals)) = self.later.get(k) else {
            return (&self.positions, Cow::Borrowed(&self.normals));
        };
        if normals.len() == self.normals.len() {
            return (positions, Cow::Borrowed(normals));
        }
        let mut flat = vec![Vec3::ZERO; self.normals.len()];
        let side = if self.flip_winding { -1.0 } else { 1.0 };
        for face in &self.triangles {
            let [a, b, c] = face.map(|v| positions[v as usize]);
            let normal = ((b - a).cross(c - a) * side).normalize_or_zero().as_vec3();
            face.iter().for_each(|v| flat[*v as usize] = normal);
        }
        (positions, Cow::Owned(flat))
    }

    /// Parts with the same layout can share a mesh.
    fn layout(&self) -> (bool, bool, bool, bool, Vec<bool>) {
        let uvs = self.uvs.iter().map(Vec::is_empty).collect();
        let (normals, tangents) = (self.normals.is_empty(), self.tangents.is_empty());
        (self.flip_winding, normals, tangents, self.colors.is_empty(), uvs)
    }
}

impl Loader<'_> {
    /// Leaves out faces with a corner that is not finite.
    pub(super) fn drop_infinite(&mut self, part: &mut Part, at: &str) {
        let before = part.triangles.len();
        let positions = &part.positions;
        let is_finite = |v: u32| positions[v as usize].is_finite();
        part.triangles.retain(|face| face.iter().all(|&v| is_finite(v)));
        part.dropped = (before - part.triangles.len()) as u64;
        if part.dropped > 0 {
            let message = format!(
                "{} of {before} faces have a corner that is not finite; they are left out",
                part.dropped
            );
            self.report
                .warning("G0613", &format!("{at}.attributes.POSITION"), message);
        }
    }

    /// Normalises normals; one that cannot be is replaced by the mean of its faces'.
    pub(super) fn mend_normals(&mut self, part: &mut Part, at: &str) {
        let bad = mend_normals(&mut part.normals, &part.positions, &part.triangles, part.flip_winding);
        if bad > 0 {
            let message = format!(
                "{bad} of {} have no direction; their faces' are used",
                part.normals.len()
            );
            self.report.mended("G0614", at, message, Anomaly::ReplacedNormal, bad);
        }
    }
}

/// Joins parts of the same layout into meshes, in the order of their first parts.
pub(super) fn join(parts: Vec<Part>, name: &str) -> Vec<Mesh> {
    let mut groups: Vec<Vec<Part>> = Vec::new();
    for part in parts {
        match groups.iter_mut().find(|g| g[0].layout() == part.layout()) {
            Some(group) => group.push(part),
            None => groups.push(vec![part]),
        }
    }
    groups.into_iter().filter_map(|group| join_like(group, name)).collect()
}

/// The form of all parts together at each later moment; one that keeps its form stays as it is.
fn forms(parts: &[Part]) -> Vec<Form> {
    let moments = parts.iter().map(|p| p.later.len()).max().unwrap_or(0);
    let at = |k: usize| {
        let mut all = Form::default();
        for part in parts {
            let (positions, normals) = part.form(k);
            all.0.extend(positions);
            all.1.extend(normals.iter());
        }
        all
    };
    (0..moments).map(at).collect()
}

fn join_like(mut parts: Vec<Part>, name: &str) -> Option<Mesh> {
    let counts: Vec<usize> = parts.iter().map(|p| p.positions.len()).collect();
    let vertices: usize = counts.iter().sum();
    let faces: usize = parts.iter().map(|p| p.triangles.len()).sum();
    u32::try_from(vertices).ok()?;
    let later = forms(&parts);
    let mut positions = std::mem::take(&mut parts.first_mut()?.positions);
    positions.reserve_exact(vertices - positions.len());
    for part in &mut parts[1..] {
        positions.append(&mut std::mem::take(&mut part.positions));
    }
    let mut mesh = Mesh::from_f64(name, &positions, &[])?;
    drop(positions);
    mesh.triangles.reserve_exact(faces);
    let center = mesh.center;
    let form = |(positions, normals): Form| MeshForm {
        positions: positions.iter().map(|p| (*p - center).as_vec3()).collect(),
        normals,
    };
    mesh.later = later.into_iter().map(form).collect();
    let mut first = 0;
    for (part, count) in parts.into_iter().zip(counts) {
        let slot = mesh
            .materials
            .iter()
            .position(|m| *m == part.material)
            .unwrap_or_else(|| {
                mesh.materials.push(part.material);
                mesh.materials.len() - 1
            });
        mesh.flip_winding = part.flip_winding;
        mesh.dropped_faces += part.dropped;
        for face in &part.triangles {
            mesh.push_face(face.map(|v| v + first), (slot > 0).then_some(slot as u32));
        }
        first += count as u32;
        append(&mut mesh.normals, part.normals);
        append(&mut mesh.tangents, part.tangents);
        append(&mut mesh.colors, part.colors);
        mesh.uvs.resize(part.uvs.len(), Vec::new());
        for (to, from) in mesh.uvs.iter_mut().zip(part.uvs) {
            append(to, from);
        }
    }
    Some(mesh)
}

/// Adds values to a list; the first ones are moved, not copied.
fn append<T>(list: &mut Vec<T>, mut values: Vec<T>) {
    if list.is_empty() {
        *list = values;
    } else {
        list.append(&mut values);
    }
}
