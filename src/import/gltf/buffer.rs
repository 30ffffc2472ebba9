//! Buffers and the views into them.

use super::budget::Cost;
use super::extension::Fields;
use super::meshopt::{self, Packing};
use super::uri::Resolved;
use super::{Loader, Report};
use crate::diag::Diagnostic;
use gltf::json;
use std::ops::{Deref, Range};
use std::path::PathBuf;
use std::sync::Arc;

/// A range of shared bytes.
#[derive(Clone)]
pub(super) struct Blob {
    data: Arc<[u8]>,
    range: Range<usize>,
}

impl Blob {
    /// The range is cut to the data.
    pub fn new(data: Arc<[u8]>, range: Range<usize>) -> Blob {
        let end = range.end.min(data.len());
        let range = range.start.min(end)..end;
        Blob { data, range }
    }

    /// Part of it, if it lies inside.
    pub fn part(&self, offset: u64, length: u64) -> Option<Blob> {
        let end = offset.checked_add(length).filter(|end| *end <= self.len() as u64)?;
        let at = |n: u64| self.range.start + n as usize;
        Some(Blob {
            data: self.data.clone(),
            range: at(offset)..at(end),
        })
    }
}

impl Deref for Blob {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.data[self.range.clone()]
    }
}

/// A view into a buffer.
pub(super) struct View {
    /// Its bytes.
    pub bytes: Blob,
    /// Distance between elements, if they are not packed.
    pub stride: Option<u64>,
}

impl Loader<'_> {
    /// The view `index`, referred to at `at`.
    pub(super) fn view(&mut self, index: usize, at: &str) -> Option<View> {
        let raw = self.doc.raw("bufferViews", index, at, &mut self.report)?;
        let view: json::buffer::View = self.doc.get(index, at, &mut self.report)?;
        let at = format!("bufferViews[{index}]");
        let stride = view.byte_stride.map(|s| s.0 as u64).filter(|s| *s > 0);
        let packed = PACKINGS.iter().find_map(|name| Fields::of(raw, name, &at));
        if let Some(packed) = packed {
            let bytes = match self.unpacked.get(&index) {
                Some(known) => known.clone(),
                None => {
                    let unpacked = self.unpack(&packed);
                    self.bytes += unpacked.as_ref().map_or(0, |b| b.len() as u64);
                    if unpacked.is_some() || !self.report.lenient {
                        self.unpacked.insert(index, unpacked.clone());
                    }
                    unpacked
                }
            }?;
            return Some(View { bytes, stride });
        }
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let bytes = self.part(view.buffer.value(), offset, length, &at)?;
        Some(View { bytes, stride })
    }

    /// Part of a buffer, for what stands at `at`.
    fn part(&mut self, buffer: usize, offset: u64, length: u64, at: &str) -> Option<Blob> {
        let bytes = self.buffer(buffer, &format!("{at}.buffer"))?;
        let part = bytes.part(offset, length);
        if part.is_none() {
            let found = bytes.len();
            let message = format!("{length} bytes from {offset} on are asked for, but buffer {buffer} has {found}");
            self.report.push(at, Diagnostic::error("G0311", message).hint(CUT));
        }
        part
    }

    /// The bytes of a packed view.
    fn unpack(&mut self, packed: &Fields) -> Option<Blob> {
        let mut whole = |key: &str, default: u64| {
            let value = packed.member(key).map_or(Some(default), |v| v.as_u64());
            if value.is_none() {
                self.report.error("G0203", &packed.place(key), "is not a whole number");
            }
            value
        };
        let (offset, length) = (whole("byteOffset", 0)?, whole("byteLength", 0)?);
        let (count, stride, buffer) = (whole("count", 0)?, whole("byteStride", 0)?, whole("buffer", 0)?);
        let text = |key: &str| packed.member(key).and_then(|v| v.as_str());
        let packing = Packing {
            mode: text("mode").unwrap_or(""),
            filter: text("filter").unwrap_or("NONE"),
            count: usize::try_from(count).ok()?,
            stride: usize::try_from(stride).ok()?,
        };
        let at = packed.at();
        self.afford(Cost::Unpacked, count.saturating_mul(stride), at)?;
        let data = self.part(usize::try_from(buffer).ok()?, offset, length, at)?;
        match meshopt::unpack(&packing, &data) {
            Ok(bytes) => {
                let all = 0..bytes.len();
                Some(Blob::new(bytes.into(), all))
            }
            Err(why) => {
                let d = Diagnostic::error("G0314", format!("the packed view cannot be read: {why}"));
                self.report.push(at, d.hint(CUT));
                None
            }
        }
    }

    /// The bytes of buffer `index`, read once.
    fn buffer(&mut self, index: usize, at: &str) -> Option<Blob> {
        if let Some(known) = self.buffers.get(&index) {
            return known.clone();
        }
        let blob = self.read_buffer(index, at);
        self.bytes += blob.as_ref().map_or(0, |b| b.len() as u64);
        // A failure that was but a warning for a texture is an error for whoever asks next.
        if blob.is_some() || !self.report.lenient {
            self.buffers.insert(index, blob.clone());
        }
        blob
    }

    fn read_buffer(&mut self, index: usize, at: &str) -> Option<Blob> {
        let raw = self.doc.raw("buffers", index, at, &mut self.report)?;
        let at = format!("buffers[{index}]");
        let Some(length) = raw.get("byteLength").and_then(|l| l.as_u64()) else {
            self.report
                .error("G0203", &format!("{at}.byteLength"), "is missing or not a whole number");
            return None;
        };
        let data = match raw.get("uri") {
            None if index == 0 && self.binary_chunk.is_some() => self.binary_chunk.clone()?,
            None => {
                let d = Diagnostic::error(
                    "G0312",
                    "the buffer has no `uri`, and the file has no binary chunk for it",
                );
                self.report
                    .push(&at, d.hint("the model was split or damaged: export it again"));
                return None;
            }
            Some(uri) => {
                let at = format!("{at}.uri");
                let Some(uri) = uri.as_str() else {
                    self.report.error("G0203", &at, "is not a string");
                    return None;
                };
                self.read_uri(uri, &at)?
            }
        };
        check_length(&mut self.report, &at, length, data)
    }

    /// The bytes of a file, which several buffers may name.
    fn read_once(&mut self, path: PathBuf) -> std::io::Result<Arc<[u8]>> {
        if let Some(known) = self.files_read.get(&path) {
            return Ok(known.clone());
        }
        let data = self.files.read(&path)?;
        self.read_bytes += data.len() as u64;
        self.files_read.insert(path, data.clone());
        Ok(data)
    }

    /// The bytes behind a URI; everything that keeps them from being read is an error.
    fn read_uri(&mut self, uri: &str, at: &str) -> Option<Blob> {
        let data: Arc<[u8]> = match self.resolve(uri, at)? {
            Resolved::Data(data) => data.into(),
            Resolved::Missing(why) => {
                self.report.push(at, why);
                return None;
            }
            Resolved::File(path) => match self.read_once(path.clone()) {
                Ok(data) => data,
                Err(error) => {
                    self.report
                        .error("G0303", at, format!("`{}` cannot be read: {error}", path.display()));
                    return None;
                }
            },
        };
        let all = 0..data.len();
        Some(Blob::new(data, all))
    }
}

const PACKINGS: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];
const CUT: &str = "the file is cut or damaged: copy or export it again";

/// Refuses a buffer shorter than it says; a longer one (padding) is cut to its length.
fn check_length(report: &mut Report, at: &str, length: u64, data: Blob) -> Option<Blob> {
    let part = data.part(0, length);
    if part.is_none() {
        let d = Diagnostic::error(
            "G0313",
            format!("the buffer says {length} bytes, but only {} are there", data.len()),
        );
        report.push(at, d.hint(CUT));
    }
    part
}
