//! Why an image could not be written.

use crate::pictures::EncodeError;
use std::path::PathBuf;

/// Why an image could not be written. The message says what was found and how to mend it.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The ending names no format we write.
    #[error(
        "output {path:?} ends in `.{extension}`, expected one of {}",
        super::Format::endings()
    )]
    UnknownFormat {
        /// The path asked for.
        path: PathBuf,
        /// Its ending without the dot.
        extension: String,
    },
    /// There is no ending to tell the format by.
    #[error(
        "output {path:?} has no ending that tells the format, expected one of {}",
        super::Format::endings()
    )]
    NoExtension {
        /// The path asked for.
        path: PathBuf,
    },
    /// A buffer does not fit the image.
    #[error("channel {channel} has {found} values, expected {expected}")]
    Size {
        /// The channel.
        channel: &'static str,
        /// Values in it.
        found: usize,
        /// Pixels of the image.
        expected: usize,
    },
    /// The format cannot hold the image.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The file system refused.
    #[error("cannot write {path:?}: {reason}")]
    Io {
        /// The path asked for.
        path: PathBuf,
        /// What failed.
        reason: String,
    },
}
