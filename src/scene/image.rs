//! Images that textures and environments refer to; decoding happens in `compile`, and only for used ones.

use super::Place;
use std::path::PathBuf;
use std::sync::Arc;

/// Where the bytes of an image come from.
#[derive(Clone, PartialEq)]
pub enum ImageSource {
    /// A file, to be read through `Files` when the image is used.
    File(PathBuf),
    /// Encoded bytes (PNG, JPEG, …) embedded in a model.
    Bytes(Arc<[u8]>),
    /// Linear RGB radiance made by the program, row by row from the top left.
    Pixels {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// `width · height` values.
        data: Arc<[[f32; 3]]>,
    },
}

impl std::fmt::Debug for ImageSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ImageSource::File(path) => write!(f, "File({path:?})"),
            ImageSource::Bytes(b) => write!(f, "Bytes({} bytes)", b.len()),
            ImageSource::Pixels { width, height, .. } => write!(f, "Pixels({width}x{height})"),
        }
    }
}

/// An image that is not decoded yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// What messages call it.
    pub name: String,
    /// Its bytes.
    pub source: ImageSource,
    /// The same picture in a format that more programs read, taken where `source` cannot be decoded.
    pub fallback: Option<ImageSource>,
    /// Where it was referred to.
    pub place: Place,
}
