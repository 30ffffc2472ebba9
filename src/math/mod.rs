//! Arithmetic shared by all layers: frames, sampling maps, robust forms, portable functions, statistics,
//! and numbers in words.

pub mod color;
pub mod fnv;
pub mod frame;
pub mod portable;
pub mod robust;
pub mod stats;
pub mod warp;
pub mod words;
