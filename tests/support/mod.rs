//! What the suites share: an independent reference renderer, statistical comparison of images, image files,
//! and the way from a scene's text to an estimate. `scenes` is the only part that calls the renderer under test.
#![allow(dead_code)] // each suite uses its own part

pub mod estimate;
pub mod images;
pub mod reference;
pub mod scenes;
pub mod ztest;
