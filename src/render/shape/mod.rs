//! The shapes a ray can hit, in camera-relative world space and f64.
//!
//! Spheres and planes stand in the world directly; the other analytic shapes are given in a space of their own and
//! placed by an affine map; meshes are shared and placed likewise. Every analytic shape answers two questions:
//! where does a line meet it ([`candidates::Candidates`] collects the answers), and what is the nearest point of its
//! surface with the outward normal there. Triangles are `accel`'s.

pub mod candidates;
mod cone;
mod cuboid;
mod disc;
pub mod placed;
pub mod plane;
pub mod sphere;
mod torus;

pub use placed::{MeshPlacement, Placed};

use candidates::Candidates;
use glam::{DAffine3, DVec3};

/// A shape of the scene.
#[derive(Clone, Debug)]
pub enum Shape {
    /// All points at `radius` from `center`.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// The points p with `normal·p = distance`; outside is where the normal points.
    Plane {
        /// Unit normal.
        normal: DVec3,
        /// Signed distance from the origin.
        distance: f64,
    },
    /// Any other analytic shape under an affine map.
    Placed(Box<Placed>),
    /// A mesh of the geometry.
    Mesh {
        /// Index of the mesh.
        mesh: u32,
        /// Where it stands.
        placement: Box<MeshPlacement>,
    },
}

impl Shape {
    /// A solid under an invertible map from its own space to the world's.
    pub fn placed(kind: Solid, world_from_object: DAffine3) -> Shape {
        Shape::Placed(Box::new(Placed::new(kind, world_from_object)))
    }

    /// A mesh under an invertible map from its own space to the world's.
    pub fn mesh(mesh: u32, world_from_mesh: DAffine3) -> Shape {
        Shape::Mesh {
            mesh,
            placement: Box::new(MeshPlacement::new(world_from_mesh)),
        }
    }
}

/// Analytic shapes in their own space. Each numbers its faces: those are the `prim` of a hit.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// The unit sphere; face 0.
    Sphere,
    /// An axis-aligned box; faces −x, +x, −y, +y, −z, +z. It may be flat (then the lower face of the two is hit).
    Box {
        /// Lower corner.
        min: DVec3,
        /// Upper corner, ≥ `min`.
        max: DVec3,
    },
    /// Radius 1 about the y axis from y = 0 to y = 1; faces: wall 0, base 1 (y = 0), cap 2 (y = 1).
    Cylinder {
        /// Whether base and cap are left out.
        open: bool,
    },
    /// A truncated cone about the y axis from radius `r0` at y = 0 to `r1` at y = 1; faces as a cylinder's.
    Cone {
        /// Radius of the base, ≥ 0.
        r0: f64,
        /// Radius of the cap, ≥ 0; one of the two is > 0.
        r1: f64,
        /// Whether base and cap are left out.
        open: bool,
    },
    /// The unit disc in y = 0 with the normal +y; face 0.
    Disc {
        /// Radius of the hole in its middle, in [0, 1).
        hole: f64,
    },
    /// A torus about the y axis; face 0.
    Torus {
        /// Distance of the tube's centre from the axis, > 0.
        major: f64,
        /// Radius of the tube, > 0.
        minor: f64,
    },
}

/// A line in a solid's own space; the ray is t > 0. The direction is never normalised, so t is the world's.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Start.
    pub o: DVec3,
    /// Direction.
    pub d: DVec3,
}

impl Line {
    /// The point at t.
    pub fn at(self, t: f64) -> DVec3 {
        self.o + self.d * t
    }
}

impl Solid {
    /// Half the size of the bounding box around [`Solid::center`].
    pub fn half_extent(&self) -> DVec3 {
        match *self {
            Solid::Sphere => DVec3::ONE,
            Solid::Box { min, max } => (max - min) * 0.5,
            Solid::Cylinder { .. } => DVec3::new(1.0, 0.5, 1.0),
            Solid::Cone { r0, r1, .. } => DVec3::new(r0.max(r1), 0.5, r0.max(r1)),
            Solid::Disc { .. } => DVec3::new(1.0, 0.0, 1.0),
            Solid::Torus { major, minor } => DVec3::new(major + minor, minor, major + minor),
        }
    }

    /// Centre of the bounding box.
    pub fn center(&self) -> DVec3 {
        match *self {
            Solid::Box { min, max } => (min + max) * 0.5,
            Solid::Cylinder { .. } | Solid::Cone { .. } => DVec3::new(0.0, 0.5, 0.0),
            Solid::Sphere | Solid::Disc { .. } | Solid::Torus { .. } => DVec3::ZERO,
        }
    }

    /// Offers every place where the line may enter or leave the surface. `shift` is added to each t.
    pub fn intersect(&self, line: Line, shift: f64, found: &mut Candidates) {
        match *self {
            Solid::Sphere => sphere::intersect_unit(line, shift, found),
            Solid::Box { min, max } => cuboid::intersect(min, max, line, shift, found),
            Solid::Cylinder { open } => cone::intersect(1.0, 1.0, open, line, shift, found),
            Solid::Cone { r0, r1, open } => cone::intersect(r0, r1, open, line, shift, found),
            Solid::Disc { hole } => disc::intersect(hole, line, shift, found),
            Solid::Torus { major, minor } => torus::intersect(major, minor, line, shift, found),
        }
    }

    /// The point of a face near `p` and the outward normal there (not normalised, never zero).
    pub fn project(&self, face: u32, p: DVec3) -> (DVec3, DVec3) {
        match *self {
            Solid::Sphere => sphere::project_unit(p),
            Solid::Box { min, max } => cuboid::project(min, max, face, p),
            Solid::Cylinder { .. } => cone::project(1.0, 1.0, face, p),
            Solid::Cone { r0, r1, .. } => cone::project(r0, r1, face, p),
            Solid::Disc { .. } => disc::project(p),
            Solid::Torus { major, minor } => torus::project(major, minor, p),
        }
    }
}
