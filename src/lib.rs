//! A path tracer as a pipeline: text, glTF or OBJ → [`scene`] → [`compile`] → [`render`] → [`output`].

pub mod cli;
pub mod compile;
pub mod diag;
pub mod files;
pub mod import;
pub mod lang;
pub mod load;
pub mod math;
pub mod output;
pub mod pictures;
pub mod render;
pub mod scene;
pub mod study;
