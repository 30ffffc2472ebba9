//! How far two images are apart, and whether noise explains it.
//!
//! [`Image`] is what is compared: linear colour, with the standard error of each pixel where the file has one.
//! [`metrics::compare`] gives all numbers at once, [`heatmap`] shows where they come from. The pieces, [`flip`] and
//! [`blocks`], can be used alone. Nothing of this renders, and nothing knows how images were made.
//!
//! A study does render: [`runner::run`] takes a scene through [`axes`] and [effects](crate::compile::effects), measures each picture with a
//! [`yardstick`] and fills an [`experiment::Study`].

pub mod ablation;
pub mod axes;
pub mod blocks;
pub mod chart;
pub mod experiment;
pub mod fit;
pub mod flip;
pub mod heatmap;
mod image;
pub mod ladder;
pub mod metrics;
mod points;
pub mod recommend;
pub mod runner;
#[cfg(test)]
mod synthetic;
pub mod table;
pub mod uses;
pub mod workshop;
pub mod yardstick;

use crate::math::color::luminance_f64;
pub use image::Image;
pub use metrics::{CompareError, Metrics, Options, compare, compare_with};
pub use points::{pareto, points};

/// Luminance of linear Rec. 709 in f64; exact under scaling by powers of two.
pub(crate) fn luminance(c: [f32; 3]) -> f64 {
    luminance_f64(c.map(f64::from))
}
