//! The outside of the file: GLB chunks or plain text, and the JSON in it.

use super::Report;
use super::buffer::Blob;
use crate::diag::Diagnostic;
use crate::files::Files;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// A file taken apart.
pub(super) struct Container {
    /// The JSON text, parsed.
    pub json: Value,
    /// The binary chunk of a GLB.
    pub binary: Option<Blob>,
    /// Bytes of the file.
    pub length: u64,
}

const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;

/// Reads and splits the file. The first bytes decide what it is, not its name.
pub(super) fn read(path: &Path, files: &dyn Files, report: &mut Report) -> Option<Container> {
    let data = match files.read(path) {
        Ok(data) => data,
        Err(error) => {
            report.error("G0101", "", format!("the model cannot be read: {error}"));
            return None;
        }
    };
    if data.starts_with(b"glTF") {
        return split_glb(data, report);
    }
    Some(Container {
        json: parse_json(&data, report)?,
        binary: None,
        length: data.len() as u64,
    })
}

/// Splits a GLB into its JSON and its first binary chunk. Chunk lengths are checked against the file, so that a wrong
/// total length in the header alone is only a warning.
fn split_glb(data: Arc<[u8]>, report: &mut Report) -> Option<Container> {
    let word = |at: usize| {
        data.get(at..at.checked_add(4)?)
            .and_then(|b| b.try_into().ok())
            .map(u32::from_le_bytes)
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        report.error("G0102", "", "the GLB header is cut: 12 bytes are needed");
        return None;
    };
    if version != 2 {
        let d = Diagnostic::error("G0102", format!("GLB of version {version} is not supported, only 2 is"));
        report.push("", d.hint("export the model as glTF 2.0"));
        return None;
    }
    if length as usize != data.len() {
        let found = data.len();
        report.warning(
            "G0102",
            "",
            format!("the GLB header says {length} bytes, the file has {found}"),
        );
    }
    let (mut json, mut binary, mut at) = (None, None, 12usize);
    while let (Some(size), Some(kind)) = (word(at), word(at + 4)) {
        // What lies behind the length of the header is no chunk, if there is something before.
        if at >= length as usize && json.is_some() {
            break;
        }
        let (start, end) = (at + 8, (at + 8).saturating_add(size as usize));
        if end > data.len() {
            let left = data.len() - start;
            let d = Diagnostic::error(
                "G0103",
                format!("the GLB chunk at byte {at} is {size} bytes long, but only {left} bytes follow"),
            );
            report.push("", d.hint("the file is cut or damaged: copy or export it again"));
            return None;
        }
        match kind {
            CHUNK_JSON if json.is_none() => json = Some(start..end),
            CHUNK_BIN if binary.is_none() => binary = Some(Blob::new(data.clone(), start..end)),
            _ => {} // other chunks are reserved for extensions and must be skipped
        }
        at = end;
    }
    let Some(range) = json else {
        report.error("G0103", "", "the GLB has no JSON chunk");
        return None;
    };
    Some(Container {
        json: parse_json(&data[range], report)?,
        binary,
        length: data.len() as u64,
    })
}

/// Parses the JSON, tolerating a byte order mark and padding by NULs or spaces.
fn parse_json(bytes: &[u8], report: &mut Report) -> Option<Value> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let end = bytes.iter().rposition(|b| !matches!(b, 0 | b' ')).map_or(0, |i| i + 1);
    let text = match std::str::from_utf8(&bytes[..end]) {
        Ok(text) => text,
        Err(error) => {
            let at = error.valid_up_to();
            let d = Diagnostic::error(
                "G0104",
                format!("this is neither GLB nor UTF-8 JSON: byte {at} is not UTF-8"),
            );
            report.push(
                "",
                d.hint("save the JSON as UTF-8, or check that this is a glTF file at all"),
            );
            return None;
        }
    };
    if values_in(text) > MOST_VALUES {
        let d = Diagnostic::error("G0105", format!("the JSON has more than {MOST_VALUES} values"));
        report.push(
            "",
            d.hint("numbers of a model belong into its buffers, not into the JSON"),
        );
        return None;
    }
    match serde_json::from_str::<Value>(text) {
        Ok(mut value) if value.is_object() => {
            whole_numbers(&mut value);
            Some(value)
        }
        Ok(_) => {
            report.error("G0104", "", "the JSON is not an object, as a glTF must be");
            None
        }
        Err(error) => {
            let place = format!("line {}, column {}", error.line(), error.column());
            report.error("G0104", &place, format!("the JSON is malformed: {error}"));
            None
        }
    }
}

/// Most values in the JSON: parsed, each takes up to a hundred bytes, though it may be written in two.
const MOST_VALUES: usize = 8_000_000;

/// How many values a text has at most if it is JSON: each but the first follows one of these marks.
fn values_in(text: &str) -> usize {
    let (mut in_string, mut escaped, mut values) = (false, false, 1);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => in_string = !in_string,
            b',' | b'[' | b'{' if !in_string => values += 1,
            _ => {}
        }
    }
    values
}

/// Turns numbers such as `24.0` into integers: some exporters write counts and indices that way. The recursion is
/// bounded by the nesting limit of the JSON parser (128).
fn whole_numbers(value: &mut Value) {
    match value {
        Value::Number(n) if n.is_f64() => {
            if let Some(f) = n.as_f64().filter(|f| f.fract() == 0.0 && *f >= 0.0 && *f < 9e15) {
                *value = Value::from(f as u64);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(whole_numbers),
        Value::Object(members) => members.values_mut().for_each(whole_numbers),
        _ => {}
    }
}
