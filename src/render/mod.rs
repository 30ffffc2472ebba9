//! The engine: from compiled data to pixels. It knows no names, no source places and no files.
//!
//! All positions are f32 relative to [`scene::CompiledScene::origin`] (the camera), which keeps digits where they matter;
//! transforms and analytic shapes stay f64. `compile` fills the data, `driver` runs passes over tiles,
//! `kernel` traces one path, `film` sums.

pub mod accel;
pub mod geometry;
pub mod ray;
pub mod report;
pub mod settings;
pub mod shape;
pub mod surface;
