//! All geometry of a scene: what a ray hits, and what the surface is like there.
//!
//! `compile` fills [`GeomObject`]s and [`MeshData`]; the kernel asks [`Geometry::closest`] and [`Geometry::occluded`] and,
//! for what it hit, [`Geometry::surface`] and (textured materials only) [`Geometry::attributes`].

mod attributes;
mod moved;
mod surface;
#[cfg(test)]
mod tests;

use super::accel::mesh::MeshTree;
use super::accel::scene::{Instructions, Item, SceneTree};
use super::bend::Bend;
use super::motion::Motion;
use super::ray::{Hit, PrimRef, Ray};
use super::shape::Shape;
use super::surface::Surface;
use super::technique::BuildPreset;
use glam::{DVec3, Vec2, Vec3, Vec4};
use std::sync::Arc;

/// Which primitives of an object are lights.
#[derive(Clone, Debug, Default)]
pub enum LightMap {
    /// None is.
    #[default]
    None,
    /// Primitive i is light `first + i`.
    First(u32),
    /// By primitive; [`Surface::NOT_A_LIGHT`] where it emits nothing.
    Table(Vec<u32>),
}

impl LightMap {
    /// The light that a primitive is, or [`Surface::NOT_A_LIGHT`].
    pub fn light(&self, prim: u32) -> u32 {
        match self {
            LightMap::None => Surface::NOT_A_LIGHT,
            LightMap::First(first) => first.saturating_add(prim),
            LightMap::Table(lights) => lights.get(prim as usize).copied().unwrap_or(Surface::NOT_A_LIGHT),
        }
    }
}

/// An object of the scene.
#[derive(Clone, Debug)]
pub struct GeomObject {
    /// What it is and where.
    pub shape: Shape,
    /// Materials: by slot for meshes, by face for solids. The last one also serves all numbers beyond it.
    pub materials: Vec<u32>,
    /// Which rays see it: bits of [`super::ray::ray_mask`].
    pub visibility: u8,
    /// Its lights.
    pub lights: LightMap,
    /// From where `shape` says it is to where it is at a time, if it moves while the shutter is open.
    pub motion: Option<Box<Motion>>,
}

impl GeomObject {
    /// An object of one material that everything sees and that emits nothing.
    pub fn new(shape: Shape, material: u32) -> GeomObject {
        GeomObject {
            shape,
            materials: vec![material],
            visibility: super::ray::ray_mask::ALL,
            lights: LightMap::None,
            motion: None,
        }
    }

    /// What the tree needs to know of it.
    fn item(&self) -> Item<'_> {
        Item {
            shape: &self.shape,
            visibility: self.visibility,
            motion: self.motion.as_deref(),
        }
    }

    /// The material of a slot or face.
    pub fn material(&self, slot: u32) -> u32 {
        let last = self.materials.last().copied().unwrap_or(0);
        self.materials.get(slot as usize).copied().unwrap_or(last)
    }
}

/// A mesh: positions relative to its own centre, attributes empty or one per vertex.
#[derive(Clone, Debug, Default)]
pub struct MeshData {
    /// Corners.
    pub positions: Vec<Vec3>,
    /// Shading normals, or empty.
    pub normals: Vec<Vec3>,
    /// Tangents, w the sign of the bitangent w·(n × t), or empty.
    pub tangents: Vec<Vec4>,
    /// Texture coordinate sets; each empty or one per vertex.
    pub uvs: Vec<Vec<Vec2>>,
    /// Linear RGBA vertex colours, or empty.
    pub colors: Vec<Vec4>,
    /// Corner indices.
    pub triangles: Vec<[u32; 3]>,
    /// Material slot of each triangle; empty for slot 0 everywhere.
    pub face_materials: Vec<u32>,
    /// Whether the geometric normal is −(v1 − v0) × (v2 − v0).
    pub flip_winding: bool,
    /// How it changes its form while the shutter is open, if it does; `positions` and `normals` are those at its opening.
    /// Objects that place it are in motion, if only by standing still ([`Motion::still`]).
    pub bend: Option<Arc<Bend>>,
}

/// The compiled geometry.
#[derive(Clone, Debug)]
pub struct Geometry {
    objects: Vec<GeomObject>,
    meshes: Vec<MeshData>,
    tree: SceneTree,
}

impl Geometry {
    /// Builds all trees. Meshes are built side by side; an object whose mesh does not exist is never hit.
    pub fn build(objects: Vec<GeomObject>, meshes: Vec<MeshData>) -> Geometry {
        Geometry::build_as(BuildPreset::default(), objects, meshes)
    }

    /// As [`Geometry::build`], quickly or thoroughly: what rays hit does not depend on it.
    pub fn build_as(preset: BuildPreset, objects: Vec<GeomObject>, meshes: Vec<MeshData>) -> Geometry {
        use rayon::prelude::*;
        let trees: Vec<MeshTree> = meshes
            .par_iter()
            .map(|m| match &m.bend {
                Some(bend) => MeshTree::build_bending(bend.clone(), &m.triangles, preset),
                None => MeshTree::build(&m.positions, &m.triangles, preset),
            })
            .collect();
        let items: Vec<_> = objects.iter().map(GeomObject::item).collect();
        let tree = SceneTree::build(&items, trees, preset);
        Geometry { objects, meshes, tree }
    }

    /// The nearest hit with 0 < t < `t_max`, if any.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.tree.closest(ray, self.corners(ray))
    }

    /// The nearest hit that is not `ray.to`, whether or not that is behind it.
    pub fn closest_other(&self, ray: &Ray) -> Option<Hit> {
        self.tree.closest_other(ray)
    }

    /// Whether anything lies on the ray with 0 < t < `t_max`.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.tree.occluded(ray, self.corners(ray))
    }

    /// The nearest hit, found without any box.
    #[cfg(test)]
    pub(crate) fn closest_by_force(&self, ray: &Ray) -> Option<Hit> {
        self.tree.closest_by_force(ray, self.corners(ray))
    }

    /// Corners of the mesh triangle that a ray is sent to, in the mesh's own unit; `None` for everything else.
    fn corners(&self, ray: &Ray) -> Option<[Vec3; 3]> {
        let Shape::Mesh { mesh, .. } = &self.objects.get(ray.to.object as usize)?.shape else {
            return None;
        };
        self.meshes.get(*mesh as usize)?.corners_at(ray.to.prim, ray.time)
    }

    /// The objects, as given.
    pub fn objects(&self) -> &[GeomObject] {
        &self.objects
    }

    /// The meshes, as given.
    pub fn meshes(&self) -> &[MeshData] {
        &self.meshes
    }

    /// Memory that meshes and their trees take.
    pub fn bytes(&self) -> u64 {
        let data = self.meshes.iter().map(MeshData::bytes).sum::<usize>();
        (data + self.tree.mesh_bytes()) as u64
    }

    /// World box of everything bounded, rounded outward; `None` if there is nothing (planes are unbounded).
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.tree.bounds().map(|b| (b.min, b.max))
    }

    /// World box of one object over the whole shutter, rounded outward; `None` if it is unbounded or not there.
    pub fn bounds_of(&self, object: u32) -> Option<(Vec3, Vec3)> {
        let object = self.objects.get(object as usize)?;
        let bounds = self.tree.bounds_of(&object.shape, object.motion.as_deref());
        (!bounds.is_empty()).then_some((bounds.min, bounds.max))
    }

    /// Whether a ray towards a primitive (`ray.to`) meets that.
    pub fn reaches(&self, ray: &Ray) -> bool {
        self.tree.reaches(ray, self.corners(ray))
    }

    /// World corners of a mesh triangle, where it was compiled; `None` for everything else.
    pub fn triangle(&self, prim: PrimRef) -> Option<[DVec3; 3]> {
        let Shape::Mesh { mesh, placement } = &self.objects.get(prim.object as usize)?.shape else {
            return None;
        };
        let corners = self.meshes.get(*mesh as usize)?.corners(prim.prim)?;
        Some(corners.map(|p| placement.world_from_mesh.transform_point3(p.as_dvec3())))
    }

    /// Chooses the instructions of the walk by hand, to measure or to compare; all give the same bits.
    pub fn use_instructions(&mut self, wanted: Instructions) {
        self.tree.use_instructions(wanted);
    }
}

impl MeshData {
    fn bytes(&self) -> usize {
        let uvs: usize = self.uvs.iter().map(|set| size_of_val(&set[..])).sum();
        uvs + size_of_val(&self.positions[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.tangents[..])
            + size_of_val(&self.colors[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.face_materials[..])
            + self.bend.as_ref().map_or(0, |bend| bend.bytes())
    }

    /// The corners of a triangle, if it exists.
    pub fn corners(&self, triangle: u32) -> Option<[Vec3; 3]> {
        self.by_corner(&self.positions, triangle)
    }

    /// The same at a time.
    fn corners_at(&self, triangle: u32, time: f32) -> Option<[Vec3; 3]> {
        match &self.bend {
            None => self.corners(triangle),
            Some(bend) => bend.corners_at(*self.triangles.get(triangle as usize)?, time),
        }
    }

    /// The shading normals at a triangle's corners at a time, not normalised; `None` without any.
    fn normals_at(&self, triangle: u32, time: f32) -> Option<[Vec3; 3]> {
        match &self.bend {
            None => self.by_corner(&self.normals, triangle),
            Some(bend) => bend.normals_at(*self.triangles.get(triangle as usize)?, time),
        }
    }

    /// The values of a vertex attribute at a triangle's corners; `None` without the attribute.
    fn by_corner<T: Copy>(&self, values: &[T], triangle: u32) -> Option<[T; 3]> {
        let [a, b, c] = *self.triangles.get(triangle as usize)?;
        Some([
            *values.get(a as usize)?,
            *values.get(b as usize)?,
            *values.get(c as usize)?,
        ])
    }
}
