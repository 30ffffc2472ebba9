//! Placed shapes become the engine's objects; what emits becomes a light as well.

use super::flatten::Leaf;
use super::loose::Loose;
use super::materials::Materials;
use super::motion;
use super::winding::{Solids, turn_outward};
use crate::diag::{Anomaly, Diagnostic, Diagnostics};
use crate::math::robust::try_normalize_f64;
use crate::render::bend::{Bend, Form};
use crate::render::geometry::{GeomObject, LightMap, MeshData};
use crate::render::light::{DiscLight, Light, ParallelogramLight, SphereLight, TriangleLight};
use crate::render::material::{Alpha, Material};
use crate::render::motion::Motion;
use crate::render::ray::{PrimRef, ray_mask};
use crate::render::shape::{Shape as Engine, Solid};
use crate::render::surface::Surface;
use crate::scene::{MaterialId, Mesh, MeshId, Scene, Shape, Visibility};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Collects objects, meshes and the lights among them.
pub struct Objects<'a, 'm, 'i> {
    scene: &'a Scene,
    origin: DVec3,
    materials: &'m mut Materials<'a, 'i>,
    /// By whether their solids are turned outward, which only refracting materials ask for.
    meshes_known: BTreeMap<(MeshId, bool), u32>,
    /// Loose triangles by visibility and motion, made into one mesh each at the end.
    loose: BTreeMap<(u8, Vec<u64>), Loose>,
    /// The engine's objects.
    pub objects: Vec<GeomObject>,
    /// The engine's meshes.
    pub meshes: Vec<MeshData>,
    /// Emitting shapes, indexed as the objects say.
    pub lights: Vec<Light>,
}

impl<'a, 'm, 'i> Objects<'a, 'm, 'i> {
    /// Nothing yet; `lights` are those that are no shapes.
    pub fn new(scene: &'a Scene, origin: DVec3, materials: &'m mut Materials<'a, 'i>, lights: Vec<Light>) -> Self {
        Objects {
            scene,
            origin,
            materials,
            meshes_known: BTreeMap::new(),
            loose: BTreeMap::new(),
            objects: Vec::new(),
            meshes: Vec::new(),
            lights,
        }
    }

    /// Adds a leaf.
    pub fn add(&mut self, leaf: &Leaf<'a>, diags: &mut Diagnostics) {
        let own = leaf.override_material.or(leaf.material).or(self.scene.default_material);
        let visibility = bits(leaf.visibility);
        let world = DAffine3::from_translation(-self.origin) * leaf.transform;
        let (world, motion) = motion::of_leaf(leaf, world, diags);
        let shape = match &leaf.object.shape {
            Shape::Mesh(id) => return self.add_mesh(*id, (world, motion), leaf, own, visibility, diags),
            Shape::Triangle { vertices, normals } => {
                let material = self.materials.get(own, true, diags);
                let key = (visibility, motion::bits(motion.as_deref()));
                let loose = self.loose.entry(key).or_default();
                let place = leaf.still_transform();
                loose.add(&place, vertices, normals.as_ref(), material);
                loose.motion = motion;
                return;
            }
            Shape::Group(_) => return, // flattened
            shape => shape,
        };
        let material = self.materials.get(own, is_open(shape), diags);
        let Some(engine) = placed(shape, &world) else {
            diags.push(super::at_place(
                Diagnostic::warning("C0103", "a shape without extent cannot be drawn: it is left out")
                    .counting(Anomaly::DroppedShape, 1),
                &leaf.object.place,
            ));
            return;
        };
        let mut object = GeomObject::new(engine, material);
        object.visibility = visibility;
        let emits = self.materials.materials[material as usize].is_light();
        if emits && leaf.visibility.indirect {
            let first = self.lights.len();
            let lights = self.shape_lights(&object.shape, material);
            object.lights = motion::of_lights(&mut self.lights, first, lights, motion.as_deref());
        }
        object.motion = motion;
        self.objects.push(object);
    }

    /// Turns what was collected triangle by triangle into meshes, and gives meshes the attributes that a material
    /// reads. To be called once, at the end.
    pub fn finish(&mut self, diags: &mut Diagnostics) {
        self.add_attributes();
        for ((visibility, _), mut loose) in std::mem::take(&mut self.loose) {
            let motion = loose.motion.take();
            let (mesh, materials) = loose.into_mesh();
            diags.count_anomaly(Anomaly::DroppedFace, mesh.dropped_faces);
            if mesh.triangles.is_empty() {
                continue;
            }
            let world = DAffine3::from_translation(mesh.center - self.origin);
            let mut data = mesh_data(&mesh);
            let is_solid = |m: u32| self.materials.materials[m as usize].interior;
            turn_outward(&mut data, |slot| {
                materials.get(slot as usize).is_some_and(|m| is_solid(*m))
            });
            self.meshes.push(data);
            self.place_mesh(self.meshes.len() as u32 - 1, (world, motion), materials, visibility);
        }
    }

    fn add_attributes(&mut self) {
        let mut read = vec![false; self.meshes.len()];
        for object in &self.objects {
            if let Engine::Mesh { mesh, .. } = object.shape {
                let reads = |m: &u32| self.materials.materials[*m as usize].needs_attributes;
                read[mesh as usize] |= object.materials.iter().any(reads);
            }
        }
        for ((id, _), &index) in self.meshes_known.iter().filter(|(_, i)| read[**i as usize]) {
            if let Some(mesh) = self.scene.meshes.get(id.index()) {
                let data = &mut self.meshes[index as usize];
                (data.uvs, data.tangents, data.colors) = (mesh.uvs.clone(), mesh.tangents.clone(), mesh.colors.clone());
            }
        }
    }

    fn add_mesh(
        &mut self,
        id: MeshId,
        (world, motion): (DAffine3, Option<Box<Motion>>),
        leaf: &Leaf<'a>,
        own: Option<MaterialId>,
        visibility: u8,
        diags: &mut Diagnostics,
    ) {
        let Some(mesh) = self.scene.meshes.get(id.index()) else {
            return;
        };
        if mesh.triangles.is_empty() {
            return;
        }
        let slots = mesh.materials.len().max(1) as u32;
        let pick = |slot| leaf.override_material.or(mesh.slot_material(slot)).or(own);
        let materials: Vec<u32> = (0..slots).map(|s| self.materials.get(pick(s), true, diags)).collect();
        let is_solid = |m: u32| self.materials.materials[m as usize].interior;
        let key = (id, materials.iter().any(|m| is_solid(*m)));
        let index = match self.meshes_known.get(&key) {
            Some(&index) => index,
            None => {
                // Whoever made the mesh has told where it has faces without area.
                diags.count_anomaly(Anomaly::DroppedFace, mesh.dropped_faces);
                let mut data = mesh_data(mesh);
                if key.1 {
                    let material = |slot: u32| materials.get(slot as usize).copied();
                    let found = turn_outward(&mut data, |slot| material(slot).is_some_and(is_solid));
                    tell_solids(found, mesh, leaf, diags);
                }
                self.meshes.push(data);
                let index = self.meshes.len() as u32 - 1;
                self.meshes_known.insert(key, index);
                index
            }
        };
        let world = world * DAffine3::from_translation(mesh.center);
        let bends = self.meshes[index as usize].bend.is_some();
        let motion = motion.or_else(|| bends.then(|| Box::new(Motion::still())));
        self.place_mesh(index, (world, motion), materials, visibility);
    }

    fn place_mesh(
        &mut self,
        mesh: u32,
        (world, motion): (DAffine3, Option<Box<Motion>>),
        materials: Vec<u32>,
        visibility: u8,
    ) {
        let object = self.objects.len() as u32;
        let first = self.lights.len();
        let emitting = |m: &u32| self.materials.materials[*m as usize].is_light();
        // Nobody can aim at a face that changes its form: rays find it by chance.
        let bends = self.meshes[mesh as usize].bend.is_some();
        let lights = if !bends && materials.iter().any(emitting) && visibility & ray_mask::INDIRECT != 0 {
            let data = &self.meshes[mesh as usize];
            let flipped = data.flip_winding != (world.matrix3.determinant() < 0.0);
            let mut table = vec![Surface::NOT_A_LIGHT; data.triangles.len()];
            for (i, corners) in data.triangles.iter().enumerate() {
                let slot = data.face_materials.get(i).copied().unwrap_or(0) as usize;
                let material = materials.get(slot).or(materials.last()).copied().unwrap_or(0);
                if !emitting(&material) {
                    continue;
                }
                let corner = |k: usize| world.transform_point3(data.positions[corners[k] as usize].as_dvec3());
                let p0 = corner(0);
                let prim = PrimRef { object, prim: i as u32 };
                table[i] = self.lights.len() as u32;
                let m = &self.materials.materials[material as usize];
                self.lights.push(Light::Triangle(TriangleLight {
                    p0,
                    e1: (corner(1) - p0).as_vec3(),
                    e2: (corner(2) - p0).as_vec3(),
                    flipped,
                    radiance: self.materials.mean_emission(material),
                    two_sided: m.emits_back,
                    textured: varies(m),
                    prim,
                }));
            }
            LightMap::Table(table)
        } else {
            LightMap::None
        };
        self.objects.push(GeomObject {
            shape: Engine::mesh(mesh, world),
            materials,
            visibility,
            lights: motion::of_lights(&mut self.lights, first, lights, motion.as_deref()),
            motion,
        });
    }

    /// Lights for the faces of an emitting shape. Shapes without an entry here (cones, tori, ellipsoids, planes)
    /// light the scene all the same: scattered rays find them.
    fn shape_lights(&mut self, shape: &Engine, material: u32) -> LightMap {
        let object = self.objects.len() as u32;
        let m = &self.materials.materials[material as usize];
        let (two_sided, textured) = (m.emits_back, varies(m));
        let radiance = self.materials.mean_emission(material);
        let first = self.lights.len() as u32;
        match shape {
            Engine::Sphere { center, radius } => self.lights.push(Light::Sphere(SphereLight {
                center: *center,
                radius: *radius,
                radiance,
                two_sided,
                textured,
                prim: PrimRef { object, prim: 0 },
            })),
            Engine::Placed(p) => match p.kind {
                Solid::Box { min, max } => {
                    let mut table = vec![Surface::NOT_A_LIGHT; 6];
                    for face in 0..6 {
                        // The faces of a flat box are one sheet, which rays know by the lower of the two.
                        let is_sheet = max[face as usize / 2] == min[face as usize / 2];
                        if is_sheet && face % 2 == 1 {
                            continue;
                        }
                        table[face as usize] = self.lights.len() as u32;
                        let (p0, e1, e2) = box_face(&p.world_from_object, min, max, face);
                        self.lights.push(Light::Parallelogram(ParallelogramLight {
                            p0,
                            e1: e1.as_vec3(),
                            e2: e2.as_vec3(),
                            radiance,
                            two_sided,
                            textured,
                            prim: PrimRef { object, prim: face },
                        }));
                    }
                    return LightMap::Table(table);
                }
                Solid::Disc { hole } => {
                    let m = p.world_from_object.matrix3;
                    let mirrored = m.determinant() < 0.0;
                    // z × x = y, the disc's normal.
                    let (a, b) = if mirrored {
                        (m.x_axis, m.z_axis)
                    } else {
                        (m.z_axis, m.x_axis)
                    };
                    self.lights.push(Light::Disc(Box::new(DiscLight {
                        center: p.world_from_object.translation,
                        axis1: a,
                        axis2: b,
                        hole,
                        radiance,
                        two_sided,
                        textured,
                        prim: PrimRef { object, prim: 0 },
                    })));
                }
                Solid::Sphere | Solid::Cylinder { .. } | Solid::Cone { .. } | Solid::Torus { .. } => {
                    return LightMap::None;
                }
            },
            Engine::Plane { .. } | Engine::Mesh { .. } => return LightMap::None,
        }
        LightMap::First(first)
    }
}

/// Whether what a light gives must be looked up where it is sampled: its texture, or how much of it is there.
fn varies(m: &Material) -> bool {
    m.emission_varies() || m.alpha != Alpha::Opaque
}

fn bits(v: Visibility) -> u8 {
    let bit = |on: bool, bit: u8| if on { bit } else { 0 };
    bit(v.camera, ray_mask::CAMERA) | bit(v.shadow, ray_mask::SHADOW) | bit(v.indirect, ray_mask::INDIRECT)
}

/// Whether both sides of a shape can be seen from outside.
fn is_open(shape: &Shape) -> bool {
    match shape {
        Shape::Sphere { .. } | Shape::Torus { .. } => false,
        Shape::Box { min, max } => (*max - *min).min_element() == 0.0,
        Shape::Cone { open, .. } => *open,
        Shape::Plane { .. } | Shape::Disc { .. } | Shape::Triangle { .. } | Shape::Mesh(_) | Shape::Group(_) => true,
    }
}

/// The engine's form of an analytic shape under a map to camera-relative space; `None` if it has no extent.
fn placed(shape: &Shape, world: &DAffine3) -> Option<Engine> {
    Some(match *shape {
        Shape::Sphere { center, radius } => match similarity_scale(&world.matrix3) {
            Some(scale) => Engine::Sphere {
                center: world.transform_point3(center),
                radius: radius * scale,
            },
            None => {
                let local =
                    DAffine3::from_scale_rotation_translation(DVec3::splat(radius), glam::DQuat::IDENTITY, center);
                Engine::placed(Solid::Sphere, *world * local)
            }
        },
        Shape::Plane { normal, distance } => {
            let inverse_transpose = world.matrix3.inverse().transpose();
            let n = try_normalize_f64(inverse_transpose * normal)?;
            Engine::Plane {
                normal: n,
                distance: n.dot(world.transform_point3(normal * distance)),
            }
        }
        Shape::Box { min, max } => Engine::placed(Solid::Box { min, max }, *world),
        Shape::Cone {
            base,
            base_radius,
            cap,
            cap_radius,
            open,
        } => {
            let axis = cap - base;
            let (x, z) = try_normalize_f64(axis)?.any_orthonormal_pair();
            let r = base_radius.max(cap_radius);
            // x × axis must point along z so that the frame is not mirrored.
            let z = if x.cross(axis).dot(z) < 0.0 { -z } else { z };
            let local = DAffine3::from_mat3_translation(DMat3::from_cols(x * r, axis, z * r), base);
            let kind = if base_radius == cap_radius {
                Solid::Cylinder { open }
            } else {
                Solid::Cone {
                    r0: base_radius / r,
                    r1: cap_radius / r,
                    open,
                }
            };
            Engine::placed(kind, *world * local)
        }
        Shape::Disc {
            center,
            normal,
            radius,
            hole_radius,
        } => {
            let n = try_normalize_f64(normal)?;
            let (x, z) = n.any_orthonormal_pair();
            let z = if x.cross(n).dot(z) < 0.0 { -z } else { z };
            let local = DAffine3::from_mat3_translation(DMat3::from_cols(x * radius, n * radius, z * radius), center);
            let hole = hole_radius / radius;
            Engine::placed(Solid::Disc { hole }, *world * local)
        }
        Shape::Torus { major, minor } => Engine::placed(Solid::Torus { major, minor }, *world),
        Shape::Triangle { .. } | Shape::Mesh(_) | Shape::Group(_) => return None,
    })
}

/// The factor by which a linear map scales all lengths, if it scales all alike (to 32 units of rounding).
fn similarity_scale(m: &DMat3) -> Option<f64> {
    let gram = m.transpose() * *m;
    let s2 = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
    let off = gram - DMat3::from_diagonal(DVec3::splat(s2));
    let largest = [off.x_axis, off.y_axis, off.z_axis]
        .iter()
        .map(|c| c.abs().max_element())
        .fold(0.0, f64::max);
    (largest <= 32.0 * f64::EPSILON * s2).then(|| s2.sqrt())
}

/// A box face in world space as corner and edges, e1 × e2 to the outside; faces −x, +x, −y, +y, −z, +z.
fn box_face(world: &DAffine3, min: DVec3, max: DVec3, face: u32) -> (DVec3, DVec3, DVec3) {
    let axis = (face / 2) as usize;
    let upper = face % 2 == 1;
    let mut corner = min;
    if upper {
        corner[axis] = max[axis];
    }
    let edge = |k: usize| {
        let mut e = DVec3::ZERO;
        e[k] = max[k] - min[k];
        world.transform_vector3(e)
    };
    let (a, b) = (edge((axis + 1) % 3), edge((axis + 2) % 3));
    let mirrored = world.matrix3.determinant() < 0.0;
    let p0 = world.transform_point3(corner);
    if upper != mirrored { (p0, a, b) } else { (p0, b, a) }
}

/// Tells that faces of a solid looked inward (it is drawn as if they did not), and of glass that encloses nothing.
fn tell_solids(found: Solids, mesh: &Mesh, leaf: &Leaf<'_>, diags: &mut Diagnostics) {
    let mut tell = |d: Diagnostic| diags.push(super::at_place(d, &leaf.object.place));
    if found.turned > 0 {
        let (turned, all, name) = (found.turned, mesh.triangles.len(), &mesh.name);
        tell(Diagnostic::note(
            "C0108",
            format!("{turned} of {all} faces of \"{name}\" look into the solid; they are turned outward"),
        ));
    }
    if found.open_edges > 0 {
        let message = format!(
            "the glass of \"{}\" is not closed ({} open edges): what enters it need not leave it again",
            mesh.name, found.open_edges
        );
        let hint = "give it a wall on all sides, or draw it as a thin sheet (--glass thin for glTF)";
        tell(Diagnostic::note("C0109", message).hint(hint));
    }
}

fn mesh_data(mesh: &Mesh) -> MeshData {
    MeshData {
        positions: mesh.positions.clone(),
        normals: mesh.normals.clone(),
        triangles: mesh.triangles.clone(),
        face_materials: mesh.face_materials.clone(),
        flip_winding: mesh.flip_winding,
        bend: bend_of(mesh),
        ..MeshData::default()
    }
}

fn bend_of(mesh: &Mesh) -> Option<Arc<Bend>> {
    if !mesh.bends() {
        return None;
    }
    let form = |positions: &[Vec3], normals: &[Vec3]| Form {
        positions: positions.to_vec(),
        normals: normals.to_vec(),
    };
    let later = mesh.later.iter().map(|f| form(&f.positions, &f.normals));
    let forms = std::iter::once(form(&mesh.positions, &mesh.normals)).chain(later);
    Bend::new(forms.collect()).map(Arc::new)
}
