//! The chart of a study: error against seconds, both logarithmic.
//!
//! [`svg`] and [`png`] draw the same page. Up to five variants share one panel; more get an overview with the Pareto
//! front and, below, a panel for each axis with the base line in grey. Sizes are legible when the page is printed 16 cm
//! wide; variants differ by dash and marker besides colour. The same study gives the same bytes.

mod font;
mod labels;
mod layout;
mod panel;
mod raster;
mod scale;
mod shapes;
mod style;
mod svg;
#[cfg(test)]
mod tests;

pub use raster::PngError;

use super::experiment::Study;

/// The chart as an SVG document. Any study can be drawn, one without rows too.
pub fn svg(study: &Study) -> String {
    svg::write(&layout::page(study))
}

/// The chart as a PNG file.
pub fn png(study: &Study) -> Result<Vec<u8>, PngError> {
    raster::write(&layout::page(study))
}
