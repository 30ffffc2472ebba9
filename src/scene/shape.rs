//! What is placed in the scene.

use super::{GroupId, MaterialId, MeshId, Place};
use glam::{DAffine3, DVec3};

/// Which rays see an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visibility {
    /// Seen by rays from the camera (off: `no_image`).
    pub camera: bool,
    /// Casts shadows (off: `no_shadow`).
    pub shadow: bool,
    /// Seen by rays that left a surface (off: `no_reflection`).
    pub indirect: bool,
}

impl Default for Visibility {
    fn default() -> Visibility {
        Visibility {
            camera: true,
            shadow: true,
            indirect: true,
        }
    }
}

/// A shape in its own space. Radii and lengths are positive and finite, normals are unit vectors.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All points at `radius` from `center`.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// The points p with `normal·p = distance`; the inside is opposite the normal.
    Plane {
        /// Unit normal.
        normal: DVec3,
        /// Signed distance from the origin along the normal.
        distance: f64,
    },
    /// An axis-aligned box; min < max in every component, flat boxes (min = max in one) included.
    Box {
        /// Lower corner.
        min: DVec3,
        /// Upper corner.
        max: DVec3,
    },
    /// A truncated cone between two circles; a cylinder when the radii are equal.
    Cone {
        /// Centre of the first circle.
        base: DVec3,
        /// Its radius, ≥ 0.
        base_radius: f64,
        /// Centre of the second circle.
        cap: DVec3,
        /// Its radius, ≥ 0; at least one of the two is > 0.
        cap_radius: f64,
        /// Whether the end discs are left out.
        open: bool,
    },
    /// A flat ring.
    Disc {
        /// Centre.
        center: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Outer radius, > 0.
        radius: f64,
        /// Radius of the hole, 0 for none, < radius.
        hole_radius: f64,
    },
    /// A torus about the y axis, centred at the origin.
    Torus {
        /// Distance of the tube's centre from the axis, > 0.
        major: f64,
        /// Radius of the tube, > 0 (may exceed `major`).
        minor: f64,
    },
    /// One triangle; `normals` are unit shading normals at its corners.
    Triangle {
        /// The corners.
        vertices: [DVec3; 3],
        /// Shading normals, if it is a smooth triangle.
        normals: Option<[DVec3; 3]>,
    },
    /// A mesh of the scene.
    Mesh(MeshId),
    /// A group of the scene.
    Group(GroupId),
}

/// A shape placed in the scene or in a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// What it is.
    pub shape: Shape,
    /// From the shape's space to the space of the scene or group. Invertible and finite; mirrors are allowed.
    pub transform: DAffine3,
    /// How it moves while the shutter is open, in its own space: at key k a point p of the shape is at
    /// `transform · motion[k] · p`. Keys are at equal steps of time, the first at the shutter's opening, matrices linear in
    /// between; empty for what stands still.
    pub motion: Vec<DAffine3>,
    /// Its material; `None` takes the enclosing object's, then the scene's default.
    pub material: Option<MaterialId>,
    /// Whether `material` replaces the materials inside a mesh or group too (an override), instead of only
    /// filling in where they have none.
    pub override_material: bool,
    /// Which rays see it; a group's visibility is combined with its members' (seen only if both are).
    pub visibility: Visibility,
    /// Name for messages, or empty.
    pub name: String,
    /// Where it was written.
    pub place: Place,
}

impl Object {
    /// An object in place, with nothing but its shape.
    pub fn new(shape: Shape) -> Object {
        Object {
            shape,
            transform: DAffine3::IDENTITY,
            motion: Vec::new(),
            material: None,
            override_material: false,
            visibility: Visibility::default(),
            name: String::new(),
            place: Place::None,
        }
    }

    /// The same object with a material.
    pub fn with_material(mut self, material: MaterialId) -> Object {
        self.material = Some(material);
        self
    }

    /// The same object moved; applied after the transforms it already has.
    pub fn transformed(mut self, transform: DAffine3) -> Object {
        self.transform = transform * self.transform;
        self
    }
}
