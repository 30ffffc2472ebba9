//! Models of other formats to the scene description.

pub mod obj;
