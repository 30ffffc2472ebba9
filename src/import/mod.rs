//! Models from other programs become a [`crate::scene::Scene`]: glTF and OBJ; and what a bare model lacks, a camera
//! and light, is added by [`framing`].

pub mod framing;
pub mod gltf;
pub mod obj;
