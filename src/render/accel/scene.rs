//! The two-level structure: a tree over the objects, a tree in each mesh, and beside them the planes and few spheres.

pub use super::instructions::Instructions;

use super::bounds::Bounds;
use super::build::build_tree;
use super::mesh::MeshTree;
use super::moving::MovingTarget;
use super::node::{LEAF, Node};
use super::simd::{Baseline, Isa};
use super::spheres::{FEW, SphereList};
use super::traverse::{BoxRay, Leaf, traverse};
use super::triangle::Line;
use crate::render::motion::Motion;
use crate::render::ray::{Hit, PrimRef, Ray};
use crate::render::shape::candidates::Candidates;
use crate::render::shape::{Placed, Shape, plane, sphere};
use crate::render::technique::BuildPreset;
use glam::{DAffine3, DVec3, Vec3};
use std::marker::PhantomData;

mod placing;

/// What an object is, as rays meet it.
#[derive(Clone, Debug)]
pub(super) enum Target {
    Sphere {
        center: DVec3,
        radius_squared: f64,
    },
    Plane {
        normal: DVec3,
        distance: f64,
    },
    Placed(Box<Placed>),
    Mesh {
        mesh: u32,
        /// From the world to the unit of the mesh's tree.
        tree_from_world: Box<DAffine3>,
    },
    /// Any of the others, moving.
    Moving(Box<MovingTarget>),
}

/// An object as the tree is built over it.
#[derive(Clone, Copy, Debug)]
pub struct Item<'a> {
    /// What it is and where.
    pub shape: &'a Shape,
    /// Which rays see it: bits of [`crate::render::ray::ray_mask`].
    pub visibility: u8,
    /// How it moves from there, if it does.
    pub motion: Option<&'a Motion>,
}

/// Everything that can be hit.
#[derive(Clone, Debug)]
pub struct SceneTree {
    targets: Vec<Target>,
    visibility: Vec<u8>,
    pub(super) meshes: Vec<MeshTree>,
    planes: Vec<u32>,
    spheres: SphereList,
    nodes: Vec<Node>,
    stack_need: usize,
    /// World box of everything but the planes.
    bounds: Bounds,
    pub(super) instructions: Instructions,
}

impl SceneTree {
    /// Builds the structure over objects. Meshes out of range count as empty.
    pub fn build(objects: &[Item<'_>], meshes: Vec<MeshTree>, preset: BuildPreset) -> SceneTree {
        let mut tree = SceneTree {
            targets: Vec::with_capacity(objects.len()),
            visibility: objects.iter().map(|o| o.visibility).collect(),
            meshes,
            planes: Vec::new(),
            spheres: SphereList::default(),
            nodes: Vec::new(),
            stack_need: 0,
            bounds: Bounds::EMPTY,
            instructions: Instructions::detect(),
        };
        let is_still_sphere = |o: &&Item<'_>| matches!(o.shape, Shape::Sphere { .. }) && o.motion.is_none();
        let spheres = objects.iter().filter(is_still_sphere).count();
        let mut bounds = Vec::new();
        let mut bounded = Vec::new();
        for (i, item) in objects.iter().enumerate() {
            tree.targets.push(tree.target(item.shape, item.motion));
            if matches!(item.shape, Shape::Plane { .. }) {
                tree.planes.push(i as u32);
                continue;
            }
            let b = tree.bounds_of(item.shape, item.motion);
            if b.is_empty() {
                continue;
            }
            tree.bounds = tree.bounds.union(b);
            match *item.shape {
                Shape::Sphere { center, radius } if spheres <= FEW && item.motion.is_none() => {
                    tree.spheres.push(i as u32, center, radius, item.visibility);
                }
                _ => {
                    // The rounding of boxes and rays at this distance from the camera.
                    bounds.push(b.padded(4.0 * crate::math::robust::UNIT_ROUNDOFF));
                    bounded.push(i as u32);
                }
            }
        }
        let built = build_tree(bounds, 1, preset);
        tree.stack_need = built.stack_need;
        tree.nodes = built.nodes;
        // One object a leaf: name it in the node itself.
        for child in tree.nodes.iter_mut().flat_map(|n| n.child.iter_mut()) {
            if *child != u32::MAX && *child & LEAF != 0 {
                let item = built.primitives[(*child & !LEAF) as usize];
                *child = LEAF | bounded[item as usize];
            }
        }
        tree
    }

    /// World box of everything but the planes; `None` if there is nothing.
    pub fn bounds(&self) -> Option<Bounds> {
        (!self.bounds.is_empty()).then_some(self.bounds)
    }

    /// The tree of a mesh.
    pub fn mesh(&self, mesh: u32) -> Option<&MeshTree> {
        self.meshes.get(mesh as usize)
    }

    /// Chooses the instructions by hand; those the machine lacks are refused and leave the baseline.
    pub fn use_instructions(&mut self, wanted: Instructions) {
        self.instructions = if wanted == Instructions::detect() {
            wanted
        } else {
            Instructions::Baseline
        };
    }

    /// Memory that the trees of all meshes take.
    pub fn mesh_bytes(&self) -> usize {
        self.meshes.iter().map(|m| m.bytes()).sum()
    }

    /// The nearest hit. A ray towards a primitive (`ray.to`; `corners` are those of a mesh triangle in the mesh's own
    /// unit) ends where it meets that, see [`SceneTree::start`].
    #[inline(always)]
    pub fn closest(&self, ray: &Ray, corners: Option<[Vec3; 3]>) -> Option<Hit> {
        self.dispatch::<false>(ray, self.start(ray, corners)).hit()
    }

    /// The nearest hit but for `ray.to`, where the ray does not end.
    pub fn closest_other(&self, ray: &Ray) -> Option<Hit> {
        self.dispatch::<false>(ray, Candidates::new(ray)).hit()
    }

    /// Whether anything blocks the ray.
    #[inline(always)]
    pub fn occluded(&self, ray: &Ray, corners: Option<[Vec3; 3]>) -> bool {
        if ray.to != PrimRef::NONE && self.planes.is_empty() && self.nodes.is_empty() {
            // All spheres are looked at together: the one that the ray is sent to costs nothing there.
            let free = Ray {
                to: PrimRef::NONE,
                t_max: f32::INFINITY,
                ..*ray
            };
            let nearest = self.dispatch::<false>(&free, Candidates::new(&free));
            if !nearest.found() || nearest.prim == ray.to {
                return false;
            }
            if nearest.exact < f64::from(ray.t_max) {
                return true;
            }
        }
        self.dispatch::<true>(ray, self.start(ray, corners)).found()
    }

    /// Whether a ray towards a primitive meets that, were there nothing else.
    pub fn reaches(&self, ray: &Ray, corners: Option<[Vec3; 3]>) -> bool {
        ray.to != PrimRef::NONE && self.start(ray, corners).prim == ray.to
    }

    /// What is known before the search. Of a ray towards a primitive the end is known: where this very ray meets it. What
    /// is nearer blocks, and so does a lower primitive in the same place, just as if the ray had been sent to
    /// find the primitive. Where rounding leads the ray past it, `t_max` stands.
    #[inline(always)]
    fn start(&self, ray: &Ray, corners: Option<[Vec3; 3]>) -> Candidates {
        if ray.to == PrimRef::NONE {
            return Candidates::new(ray);
        }
        self.start_towards(ray, corners)
    }

    #[inline(never)]
    fn start_towards(&self, ray: &Ray, corners: Option<[Vec3; 3]>) -> Candidates {
        let free = Ray {
            to: PrimRef::NONE,
            t_max: f32::INFINITY,
            ..*ray
        };
        let mut end = Candidates::new(&free);
        let mut room = 0.0;
        match (self.targets.get(ray.to.object as usize), corners) {
            (Some(Target::Mesh { mesh, tree_from_world }), Some(corners)) => {
                end.enter(ray.to.object, &free);
                let line = line_in(tree_from_world, ray.origin.as_dvec3(), ray.direction());
                room = self.meshes[*mesh as usize].intersect_one(line, ray.to.prim, corners, &mut end);
            }
            (Some(Target::Mesh { .. }) | None, _) => {}
            (Some(Target::Moving(moving)), Some(corners)) => {
                end.enter(ray.to.object, &free);
                room = self.end_on_moving(moving, ray, corners, &mut end);
            }
            _ => self.meet::<false, Baseline>(ray.to.object, &free, &mut end),
        }
        if end.prim == ray.to {
            end.end_here(room);
            end
        } else {
            Candidates::new(ray)
        }
    }

    /// What a ray meets of an object at its time, and the ray's origin and direction as that sees them.
    #[cfg(test)]
    fn located(&self, object: u32, ray: &Ray) -> Option<(&Target, DVec3, DVec3)> {
        match self.targets.get(object as usize)? {
            Target::Moving(moving) => moving.line(ray).map(|(o, d)| (moving.still(), o, d)),
            target => Some((target, ray.origin.as_dvec3(), ray.direction())),
        }
    }

    #[inline(always)]
    fn dispatch<const ANY: bool>(&self, ray: &Ray, found: Candidates) -> Candidates {
        #[cfg(target_arch = "x86_64")]
        if self.instructions == Instructions::Avx2 {
            // SAFETY: `instructions` is Avx2 only where detection found it.
            #[allow(unsafe_code)]
            return unsafe {
                if self.planes.is_empty() && self.nodes.is_empty() {
                    self.trace_spheres_avx2(ray, found)
                } else {
                    self.trace_avx2::<ANY>(ray, found)
                }
            };
        }
        self.trace::<ANY, Baseline>(ray, found)
    }

    /// The same code for wider vectors. FMA stays off: a fused edge function would tell neighbours apart.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1")]
    fn trace_avx2<const ANY: bool>(&self, ray: &Ray, found: Candidates) -> Candidates {
        self.trace::<ANY, super::simd::Avx2>(ray, found)
    }

    /// Scenes of a few spheres alone: no stack of nodes to set up.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1")]
    fn trace_spheres_avx2(&self, ray: &Ray, mut found: Candidates) -> Candidates {
        self.spheres.intersect(ray, &mut found);
        found
    }

    #[inline(always)]
    fn trace<const ANY: bool, I: Isa>(&self, ray: &Ray, mut found: Candidates) -> Candidates {
        if !self.spheres.is_empty() {
            self.spheres.intersect(ray, &mut found);
            if ANY && found.found() {
                return found;
            }
        }
        for &object in &self.planes {
            if self.visibility[object as usize] & ray.mask != 0 {
                self.meet::<ANY, I>(object, ray, &mut found);
                if ANY && found.found() {
                    return found;
                }
            }
        }
        if !self.nodes.is_empty() {
            let mut leaf = Objects::<ANY, I> {
                scene: self,
                ray,
                isa: PhantomData,
            };
            // The boxes hold their own rounding already.
            let boxes = BoxRay::new(ray.origin, ray.dir, 0.0);
            traverse::<I>(&self.nodes, self.stack_need, &boxes, &mut found, &mut leaf);
        }
        found
    }

    /// Takes the path for trees deeper than the stack.
    #[cfg(test)]
    pub fn pretend_deep(&mut self) {
        self.stack_need = 1000;
        self.meshes.iter_mut().for_each(MeshTree::pretend_deep);
    }

    /// The nearest hit without any box.
    #[cfg(test)]
    pub fn closest_by_force(&self, ray: &Ray, corners: Option<[Vec3; 3]>) -> Option<Hit> {
        let mut found = self.start(ray, corners);
        for object in 0..self.targets.len() as u32 {
            if self.visibility[object as usize] & ray.mask == 0 {
                continue;
            }
            match self.located(object, ray) {
                Some((Target::Mesh { mesh, tree_from_world }, o, d)) => {
                    found.enter(object, ray);
                    self.meshes[*mesh as usize].intersect_by_force(
                        line_in(tree_from_world, o, d),
                        ray.time,
                        &mut found,
                    );
                }
                _ => self.meet::<false, Baseline>(object, ray, &mut found),
            }
        }
        found.hit()
    }

    #[inline(always)]
    fn meet<const ANY: bool, I: Isa>(&self, object: u32, ray: &Ray, found: &mut Candidates) {
        found.enter(object, ray);
        let target = &self.targets[object as usize];
        match target {
            Target::Moving(moving) => self.meet_moving::<ANY>(moving, ray, found),
            _ => self.meet_still::<ANY, I>(target, ray.origin.as_dvec3(), ray.direction(), found),
        }
    }

    /// The same code for wider vectors, apart from the walk that meets what stands still.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1")]
    pub(super) fn meet_avx2<const ANY: bool>(&self, target: &Target, o: DVec3, d: DVec3, found: &mut Candidates) {
        self.meet_still::<ANY, super::simd::Avx2>(target, o, d, found);
    }

    #[inline(always)]
    pub(super) fn meet_still<const ANY: bool, I: Isa>(
        &self,
        target: &Target,
        o: DVec3,
        d: DVec3,
        found: &mut Candidates,
    ) {
        match target {
            Target::Sphere { center, radius_squared } => {
                let dd = d.length_squared();
                let (f, d) = ((o - *center).to_array(), d.to_array());
                let t = sphere::distance(f, d, dd, 1.0 / dd, *radius_squared, found.from == 0);
                found.offer(t, 0);
            }
            Target::Plane { normal, distance } => plane::intersect(*normal, *distance, o, d, found),
            Target::Placed(placed) => placed.intersect(o, d, found),
            Target::Mesh { mesh, tree_from_world } => {
                self.meshes[*mesh as usize].intersect::<I>(line_in(tree_from_world, o, d), ANY, found);
            }
            Target::Moving(_) => {} // nothing moves twice
        }
    }
}

/// The ray in the unit of a mesh's tree.
#[inline(always)]
pub(super) fn line_in(tree_from_world: &DAffine3, o: DVec3, d: DVec3) -> Line {
    // What glam computes, inlined wherever it stands.
    let DAffine3 {
        matrix3: m,
        translation,
    } = *tree_from_world;
    Line {
        o: (m.x_axis * o.x) + (m.y_axis * o.y) + (m.z_axis * o.z) + translation,
        d: (m.x_axis * d.x) + (m.y_axis * d.y) + (m.z_axis * d.z),
    }
}

struct Objects<'a, const ANY: bool, I> {
    scene: &'a SceneTree,
    ray: &'a Ray,
    isa: PhantomData<I>,
}

impl<const ANY: bool, I: Isa> Leaf for Objects<'_, ANY, I> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, found: &mut Candidates) -> bool {
        if self.scene.visibility[leaf as usize] & self.ray.mask == 0 {
            return false;
        }
        self.scene.meet::<ANY, I>(leaf, self.ray, found);
        ANY && found.found()
    }
}
