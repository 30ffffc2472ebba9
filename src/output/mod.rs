//! From a finished film to files: which channels are written, how light becomes display colour, and how a file
//! is put in place whole or not at all. The bytes themselves are made in [`crate::pictures`].
//!
//! A command asks [`format_of`] before it renders, so that a misspelt ending costs nothing, then calls [`write()`]
//! (or [`encode`] for a stream) with the [`Layers`] of the film.

mod channels;
mod develop;
mod error;
pub mod part;
mod tonemap;
mod view;
mod write;

pub use channels::Layers;
pub use develop::{AlphaUse, Develop, develop};
pub use error::OutputError;
pub use tonemap::ToneMap;
pub use view::{View, ViewKind, view};
pub use write::{Encoded, Format, check_place, check_target, encode, format_of, write, write_bytes};
