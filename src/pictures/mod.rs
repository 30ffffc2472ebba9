//! Image files in and out, without any knowledge of scenes.
//!
//! [`fn@decode`] turns the bytes of a texture or an environment into a [`Picture`] that keeps the file's own
//! precision. [`read_exr_channels`] gives every channel of an OpenEXR file by name, for comparing renders.
//! The encoders ([`png`], [`jpeg`], [`hdr`], [`ppm`], [`exr`]) turn finished pixels into the bytes of a file;
//! what those pixels are (tone mapping, channel names) is decided in `output`.

pub mod colormap;
mod decode;
mod decode_exr;
mod decode_ktx2;
mod encode_exr;
mod error;
mod exr_channels;
pub mod hdr;
pub mod jpeg;
mod picture;
pub mod png;
pub mod ppm;
mod quantize;
mod uniform;

pub use decode::{Cost, Limits, cost, decode};
pub use error::EncodeError;
pub use picture::{Picture, Texels};
pub use quantize::{Quantized, Transfer, quantize};

/// OpenEXR: all channels by name, both ways.
pub mod exr {
    pub use super::encode_exr::{ChannelData, NamedChannel, encode};
    pub use super::exr_channels::{ExrChannel, ExrImage, ExrSamples, read_channels};
}

pub use exr_channels::read_channels as read_exr_channels;
