//! What can go wrong when pixels are turned into the bytes of a file.

/// Why an image could not be encoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{format} image of {width}x{height} pixels cannot be encoded: {reason}")]
pub struct EncodeError {
    /// The format, as users call it.
    pub format: &'static str,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// What the format or the encoder objects to.
    pub reason: String,
}
