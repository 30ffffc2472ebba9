//! URIs: embedded data, and files in the model's folder.

use super::Loader;
use crate::diag::Diagnostic;
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use std::path::{Component, Path, PathBuf};

/// What a URI stands for.
pub(super) enum Resolved {
    /// The bytes themselves.
    Data(Vec<u8>),
    /// A file that exists.
    File(PathBuf),
    /// Nothing that exists; what to tell the user. Whether that is an error is the caller's to say.
    Missing(Diagnostic),
}

impl Loader<'_> {
    /// Resolves a URI written at `at`. Malformed or forbidden ones are errors (`None`).
    pub(super) fn resolve(&mut self, uri: &str, at: &str) -> Option<Resolved> {
        if let Some(rest) = strip_prefix_ignoring_case(uri, "data:") {
            return match decode_data(rest) {
                Ok(data) => Some(Resolved::Data(data)),
                Err(why) => {
                    self.report
                        .error("G0301", at, format!("the data URI is malformed: {why}"));
                    None
                }
            };
        }
        if let Some((scheme, _)) = uri.split_once("://")
            && !scheme.eq_ignore_ascii_case("file")
        {
            let d = Diagnostic::error(
                "G0302",
                format!("\"{}\" is on the network, only local files are read", short(uri)),
            );
            self.report.push(
                at,
                d.hint("download the file into the model's folder and refer to it by its name"),
            );
            return None;
        }
        let local = |prefix| strip_prefix_ignoring_case(uri, prefix);
        let bare = local("file://").or_else(|| local("file:")).unwrap_or(uri);
        let decoded = percent_decode_str(bare).decode_utf8().ok().map(|s| s.into_owned());
        let mut candidates: Vec<String> = decoded.into_iter().collect();
        if candidates.first().is_none_or(|c| c != bare) {
            candidates.push(bare.to_owned());
        }
        for name in &candidates {
            if let Some(found) = self.find_file(name, at)? {
                return Some(Resolved::File(found));
            }
        }
        let what = candidates.first().map_or(bare, String::as_str);
        let d = Diagnostic::error("G0303", format!("the file \"{}\" does not exist", short(what)));
        let shown = self.folder.display().to_string();
        let folder = if shown.is_empty() { ".".to_owned() } else { shown };
        Some(Resolved::Missing(d.hint(format!(
            "put it into the folder `{folder}`, from which the name is resolved"
        ))))
    }

    /// Looks for a relative name; inner `None` if there is no such file, outer `None` if it must not be read.
    fn find_file(&mut self, name: &str, at: &str) -> Option<Option<PathBuf>> {
        let windows = name.contains('\\') || name.as_bytes().get(1) == Some(&b':');
        let unix = name.replace('\\', "/");
        let drive = unix.as_bytes().get(1) == Some(&b':');
        match inner_path(Path::new(&unix)).filter(|_| !drive) {
            Some(inner) if inner.as_os_str().is_empty() => return Some(None),
            Some(inner) => {
                let path = self.folder.join(&inner);
                if self.files.exists(&path) {
                    return Some(Some(path));
                }
                if let Some(path) = self.find_ignoring_case(&inner) {
                    let found = path.strip_prefix(self.folder).unwrap_or(&path).display();
                    let message = format!("\"{}\" does not exist, \"{found}\" is read instead", short(name));
                    self.report.warning("G0304", at, message);
                    return Some(Some(path));
                }
            }
            None if self.options.allow_outside => {
                let path = self.folder.join(&unix);
                return Some(self.files.exists(&path).then_some(path));
            }
            None if windows => {} // a path on the author's machine: only its last part can help
            None => {
                let d = Diagnostic::error("G0305", format!("\"{}\" lies outside the model's folder", short(name)));
                let hint = "copy the file into the model's folder and refer to it by its name, \
                            or give `--allow-outside` if you trust the model";
                self.report.push(at, d.hint(hint));
                return None;
            }
        }
        let base = unix
            .rsplit('/')
            .next()
            .filter(|b| windows && !b.is_empty() && *b != "..");
        let path = base.map(|b| self.folder.join(b)).filter(|p| self.files.exists(p));
        if let (Some(path), Some(base)) = (&path, base) {
            debug_assert!(path.ends_with(base));
            let message = format!(
                "\"{}\" does not exist, \"{base}\" in the model's folder is read instead",
                short(name)
            );
            self.report.warning("G0304", at, message);
        }
        Some(path)
    }

    /// The one file whose name differs only in letter case, looked up folder by folder.
    fn find_ignoring_case(&self, inner: &Path) -> Option<PathBuf> {
        let mut path = self.folder.to_owned();
        for part in inner.iter() {
            let wanted = part.to_str()?;
            let names = self.files.list(&path);
            let exact = names.iter().find(|n| *n == wanted);
            let folded = || names.iter().find(|n| n.to_lowercase() == wanted.to_lowercase());
            path.push(exact.or_else(folded)?);
        }
        self.files.exists(&path).then_some(path)
    }
}

/// The path with `.` and `..` worked off, or `None` if it is absolute or leaves its folder.
pub(super) fn inner_path(path: &Path) -> Option<PathBuf> {
    let mut inner = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => inner.push(name),
            Component::CurDir => {}
            Component::ParentDir => {
                if !inner.pop() {
                    return None;
                }
            }
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(inner)
}

/// The bytes of what follows `data:`.
fn decode_data(rest: &str) -> Result<Vec<u8>, String> {
    let (head, body) = rest.split_once(',').ok_or("it has no comma before its data")?;
    let is_base64 = head
        .rsplit(';')
        .next()
        .is_some_and(|p| p.trim().eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Ok(percent_decode_str(body).collect());
    }
    // Exporters disagree about padding and line breaks; neither changes what is meant.
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let decoder = GeneralPurpose::new(&base64::alphabet::STANDARD, config);
    let odd = |b: &u8| b.is_ascii_whitespace() || *b == b'%';
    let cleaned: Vec<u8>;
    let body = if body.as_bytes().iter().any(odd) {
        cleaned = percent_decode_str(body).filter(|b| !b.is_ascii_whitespace()).collect();
        &cleaned
    } else {
        body.as_bytes()
    };
    decoder.decode(body).map_err(|error| error.to_string())
}

fn strip_prefix_ignoring_case<'s>(text: &'s str, prefix: &str) -> Option<&'s str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// A name short enough for a message.
fn short(text: &str) -> String {
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_leave_their_folder_are_recognised() {
        let inner = |s: &str| inner_path(Path::new(s));
        assert_eq!(inner("a/../b.bin"), Some("b.bin".into()));
        assert_eq!(inner("./t/b.bin"), Some("t/b.bin".into()));
        assert_eq!(inner("a/../../b.bin"), None);
        assert_eq!(inner("/etc/passwd"), None);
    }

    #[test]
    fn data_is_decoded_with_and_without_padding_and_base64() {
        for text in [
            "application/octet-stream;base64,AQIDBA==",
            ";base64,AQIDBA",
            ",%01%02%03%04",
            ";base64,AQID\n BA==",
        ] {
            assert_eq!(decode_data(text), Ok(vec![1, 2, 3, 4]), "{text:?}");
        }
        assert!(decode_data("base64").is_err());
        assert!(decode_data(";base64,A*").is_err());
    }
}
