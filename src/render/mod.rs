//! The engine: from compiled data to pixels. It knows no names, no source places and no files.
//!
//! All positions are f32 relative to [`scene::CompiledScene::origin`] (the camera), which keeps digits where they matter;
//! transforms and analytic shapes stay f64. `compile` fills the data, `driver` runs passes over tiles,
//! `kernel` traces one path, `film` sums.

pub mod accel;
pub mod bend;
pub mod bsdf;
pub mod camera;
pub mod clock;
pub mod driver;
pub mod estimate;
pub mod film;
pub mod forecast;
pub mod geometry;
pub mod kernel;
pub mod light;
pub mod material;
pub mod medium;
pub mod motion;
pub mod picture;
pub mod pixels;
pub mod ray;
pub mod report;
pub mod sampler;
pub mod scene;
pub mod settings;
pub mod shape;
pub mod surface;
pub mod technique;
pub mod texture;
pub mod tiles;
pub mod wavelength;
