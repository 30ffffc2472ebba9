//! What a front end has found in a file and not read, because nothing in the scene refers to it.

use super::Place;
use std::path::PathBuf;

/// One thing that was left where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// What it is: `image`, `mesh`, `buffer`, …
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// Why it is not needed.
    pub why: String,
    /// The file that holds it and was not opened, if it has one of its own.
    pub file: Option<PathBuf>,
    /// Bytes that it takes in a file that was opened for other things; 0 if unknown.
    pub bytes: u64,
    /// Where it was written.
    pub place: Place,
}
