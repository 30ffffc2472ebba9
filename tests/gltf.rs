//! glTF import: what each feature of the format becomes in the scene, number by number, and what broken files say.

#[path = "gltf/animation.rs"]
mod animation;
#[path = "gltf/builder.rs"]
mod builder;
#[path = "gltf/files.rs"]
mod files;
#[path = "gltf/geometry.rs"]
mod geometry;
#[path = "gltf/malformed.rs"]
mod malformed;
#[path = "gltf/materials.rs"]
mod materials;
#[path = "gltf/packed.rs"]
mod packed;
#[path = "gltf/scenes.rs"]
mod scenes;
