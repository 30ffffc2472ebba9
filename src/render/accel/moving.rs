//! Objects that move: rays meet them where they are at the ray's time.

use super::mesh::MeshTree;
use super::scene::{Instructions, SceneTree, Target, line_in};
use super::simd::Baseline;
use super::triangle::Line;
use crate::render::motion::Motion;
use crate::render::ray::Ray;
use crate::render::shape::candidates::Candidates;
use glam::{DMat3, DVec3, Vec3};

/// An object that moves, as rays meet it.
#[derive(Clone, Debug)]
pub(super) struct MovingTarget {
    still: Target,
    motion: Motion,
    /// Whether it is neither turned nor stretched on its way: no map has to be inverted then.
    shifts: bool,
}

impl MovingTarget {
    /// Moves what is compiled as `still`.
    pub fn new(still: Target, motion: Motion) -> MovingTarget {
        let shifts = motion.keys().iter().all(|key| key.matrix3 == DMat3::IDENTITY);
        MovingTarget { still, motion, shifts }
    }

    /// The object where it was compiled.
    pub fn still(&self) -> &Target {
        &self.still
    }

    /// Origin and direction of the ray as the object would see it where it was compiled; `None` at a moment at which the
    /// object is flattened to nothing.
    pub fn line(&self, ray: &Ray) -> Option<(DVec3, DVec3)> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction());
        if self.shifts {
            return Some((o - self.motion.shift_at(ray.time), d));
        }
        let back = self.motion.at(ray.time).inverse();
        let (o, d) = (back.transform_point3(o), back.transform_vector3(d));
        (o.is_finite() && d.is_finite()).then_some((o, d))
    }
}

impl SceneTree {
    /// Where a ray ends on a triangle of a mesh that moves; the room around that.
    #[inline(never)]
    pub(super) fn end_on_moving(
        &self,
        moving: &MovingTarget,
        ray: &Ray,
        corners: [Vec3; 3],
        end: &mut Candidates,
    ) -> f64 {
        match (moving.still(), moving.line(ray)) {
            (Target::Mesh { mesh, tree_from_world }, Some((o, d))) => {
                let line = line_in(tree_from_world, o, d);
                self.meshes[*mesh as usize].intersect_one(line, ray.to.prim, corners, end)
            }
            _ => 0.0,
        }
    }

    /// Moves the ray to where the object was compiled. The direction is mapped and not normalised, so that t stays what
    /// it is.
    #[inline(never)]
    pub(super) fn meet_moving<const ANY: bool>(&self, moving: &MovingTarget, ray: &Ray, found: &mut Candidates) {
        let Some((o, d)) = moving.line(ray) else { return };
        if let Target::Mesh { mesh, tree_from_world } = moving.still()
            && self.meshes[*mesh as usize].bends()
        {
            let line = line_in(tree_from_world, o, d);
            return self.meet_bending::<ANY>(*mesh, line, ray.time, found);
        }
        #[cfg(target_arch = "x86_64")]
        if self.instructions == Instructions::Avx2 {
            // SAFETY: `instructions` is Avx2 only where detection found it.
            #[allow(unsafe_code)]
            return unsafe { self.meet_avx2::<ANY>(moving.still(), o, d, found) };
        }
        self.meet_still::<ANY, Baseline>(moving.still(), o, d, found);
    }

    /// A mesh where it is, in its form at a time.
    #[inline(never)]
    fn meet_bending<const ANY: bool>(&self, mesh: u32, line: Line, time: f32, found: &mut Candidates) {
        let mesh = &self.meshes[mesh as usize];
        #[cfg(target_arch = "x86_64")]
        if self.instructions == Instructions::Avx2 {
            // SAFETY: `instructions` is Avx2 only where detection found it.
            #[allow(unsafe_code)]
            return unsafe { bending_avx2::<ANY>(mesh, line, time, found) };
        }
        mesh.intersect_at::<Baseline>(line, time, ANY, found);
    }
}

/// The same code for wider vectors.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1")]
fn bending_avx2<const ANY: bool>(mesh: &MeshTree, line: Line, time: f32, found: &mut Candidates) {
    mesh.intersect_at::<super::simd::Avx2>(line, time, ANY, found);
}
