//! Finding what a ray hits: box trees over objects and over the triangles of each mesh, and a flat list for few spheres.
//!
//! obvhs builds the binary trees, [`build`] collapses them into 8-wide nodes, [`traverse`] walks those. All of it is
//! array code without fused operations, compiled once for the baseline and once for AVX2: the same bits, only faster.
//! The answer never depends on the tree: boxes are conservative and of two hits at equal t the lower primitive wins.

pub mod bounds;
pub mod build;
pub mod instructions;
pub mod mesh;
mod moving;
pub mod node;
pub mod scene;
pub mod simd;
pub mod spheres;
pub mod traverse;
pub mod triangle;
