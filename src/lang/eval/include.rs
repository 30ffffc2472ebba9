//! Finding and reading files: includes, and the paths of images and models.
//!
//! Looked up beside the including file, beside the scene, in the working directory, in the include directories, then
//! among the built-in includes; letter case, backslashes and a missing extension are forgiven with a warning, since a
//! quarter of the scenes people have were written on another system.

use super::stream::FrameKind;
use super::{Interp, Parsed};
use crate::diag::{Diagnostic, Span};
use crate::lang::builtin;
use crate::lang::syntax::{TokenFile, lex};
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

/// Where installations of POV-Ray keep `povray-*/include`.
const INSTALLED: &[&str] = &["/usr/share", "/usr/local/share", "/opt/homebrew/share"];

/// Bytes of one text; spans are 32 bits wide.
const MAX_BYTES: usize = u32::MAX as usize;

impl Interp<'_> {
    /// `#include "file"`.
    pub fn include(&mut self, span: Span) -> Parsed<()> {
        let at = self.peek().span;
        let name = self.text("file to include")?;
        let file = match self.locate(&name, at, &["", ".inc", ".pov", ".pts"])? {
            Some(path) => self.tokens_of(&path, at)?,
            None => match builtin_text(&name) {
                Some((name, text)) => {
                    if text.contains("average colour") && self.told_first(name) {
                        let message = format!("the patterns of {name} (built in) are drawn in their average colours");
                        self.report(Diagnostic::note("P0412", message).at(at, ""));
                    }
                    self.builtin_tokens(name, text)
                }
                None => return Err(self.not_found(&name, at)),
            },
        };
        let end = file.tokens.len() as u32;
        self.push_frame(file, (0, end), FrameKind::Include, Some(span.to(at)))?;
        Ok(())
    }

    /// Remembers a file that is named, once, until something drawn asks for it.
    pub fn name_file(&mut self, kind: &'static str, path: &Path, span: Span) {
        if !self.is_silent() && !self.named_files.iter().any(|(_, known, _)| known == path) {
            self.named_files.push((kind, path.to_owned(), span));
        }
    }

    fn not_found(&mut self, name: &str, span: Span) -> super::Stop {
        if self.is_silent() {
            return super::Stop;
        }
        let missing = self.missing(name, span);
        self.report(missing)
    }

    /// The error that a file is not found, with the places where it was looked for.
    pub fn missing(&self, name: &str, span: Span) -> Diagnostic {
        let places: Vec<String> = self.search_dirs().iter().map(|d| show_dir(d)).collect();
        let mut d = Diagnostic::error("P0501", format!("cannot find \"{name}\"")).at(span, "");
        d = d.hint(format!("looked in {}", places.join(", ")));
        let wanted = file_name(name);
        let mut known: Vec<String> = Vec::new();
        for dir in self.search_dirs() {
            known.extend(self.files.list(&dir));
        }
        known.extend(builtin::FILES.iter().map(|f| f.0.to_owned()));
        if let Some(best) = super::errors::nearest(&wanted, known.iter().map(String::as_str)) {
            d = d.hint(format!("a file with a similar name exists: {best}"));
        }
        d
    }

    fn search_dirs(&self) -> Vec<PathBuf> {
        let mut dirs = Vec::new();
        if let Some(dir) = self.frame().and_then(|f| f.file.dir.clone()) {
            dirs.push(dir);
        }
        dirs.push(self.scene_dir.clone());
        dirs.push(PathBuf::new());
        dirs.extend(self.options.include_dirs.iter().cloned());
        let mut seen: Vec<PathBuf> = Vec::new();
        dirs.retain(|d| {
            let new = !seen.contains(d);
            seen.push(d.clone());
            new
        });
        dirs
    }

    /// The path of a file, looked up tolerantly; `None` if there is none (or only a built-in include).
    pub fn locate(&mut self, name: &str, span: Span, extensions: &[&str]) -> Parsed<Option<PathBuf>> {
        if name.is_empty() || name.contains('\0') {
            return Err(self.error("P0501", span, "file name is empty or not a name"));
        }
        let dirs = self.search_dirs();
        for dir in &dirs {
            for extension in extensions {
                let path = dir.join(format!("{name}{extension}"));
                if self.files.exists(&path) {
                    return Ok(Some(path));
                }
            }
        }
        // Built-in includes come before guessing: `Colors.inc` is meant by it.
        let is_include = extensions.contains(&".inc");
        if is_include && builtin_text(name).is_some() {
            return Ok(None);
        }
        if is_include && let Some(path) = self.installed(name) {
            return Ok(Some(path));
        }
        let plain = name.replace('\\', "/");
        let plain = plain.trim_end_matches('.');
        for dir in &dirs {
            for extension in extensions {
                for candidate in [
                    format!("{plain}{extension}"),
                    format!("{}{extension}", file_name(plain)),
                ] {
                    if let Some(path) = self.find_ignoring_case(dir, Path::new(&candidate)) {
                        let message = format!("\"{name}\" does not exist, took {}", path.display());
                        self.warn("P0502", span, message);
                        return Ok(Some(path));
                    }
                }
            }
        }
        Ok(None)
    }

    /// The include of an installed POV-Ray: for standard files that are not built in.
    fn installed(&self, name: &str) -> Option<PathBuf> {
        for share in INSTALLED {
            let share = Path::new(share);
            for entry in self.files.list(share).into_iter().filter(|e| e.starts_with("povray")) {
                let path = share.join(entry).join("include").join(name);
                if self.files.exists(&path) {
                    return Some(path);
                }
            }
        }
        None
    }

    fn find_ignoring_case(&self, dir: &Path, name: &Path) -> Option<PathBuf> {
        let mut at = dir.to_owned();
        for part in name.components() {
            match part {
                Component::Normal(part) => {
                    let part = part.to_string_lossy().to_lowercase();
                    let names = self.files.list(&at);
                    let found = names.into_iter().find(|n| n.to_lowercase() == part)?;
                    at.push(found);
                }
                Component::CurDir => {}
                other => at.push(other.as_os_str()),
            }
        }
        self.files.exists(&at).then_some(at)
    }

    /// The tokens of a file, read once.
    pub fn tokens_of(&mut self, path: &Path, span: Span) -> Parsed<Rc<TokenFile>> {
        if let Some(file) = self.token_files.get(path) {
            return Ok(file.clone());
        }
        let bytes = match self.files.read(path) {
            Ok(bytes) => bytes,
            Err(e) => {
                let message = format!("cannot read {}: {e}", path.display());
                return Err(self.error("P0503", span, message));
            }
        };
        let dir = path.parent().map(Path::to_owned).unwrap_or_default();
        let file = match self.tokens_from(&path.display().to_string(), &bytes, dir) {
            Some(file) => file,
            None => return Err(self.error("P0503", span, format!("{} is larger than 4 GiB", path.display()))),
        };
        self.token_files.insert(path.to_owned(), file.clone());
        Ok(file)
    }

    /// Bytes to tokens; `None` if there are too many.
    pub fn tokens_from(&mut self, name: &str, bytes: &[u8], dir: PathBuf) -> Option<Rc<TokenFile>> {
        let text: Rc<str> = match std::str::from_utf8(bytes) {
            Ok(text) => text.into(),
            // Old scenes are in Latin-1, whose bytes are the first 256 code points.
            Err(_) => bytes.iter().map(|&b| char::from(b)).collect::<String>().into(),
        };
        if text.len() > MAX_BYTES {
            return None;
        }
        let id = self.sources.add(name, &*text);
        Some(Rc::new(lex(id, Some(dir), &text, &mut self.names)))
    }

    fn builtin_tokens(&mut self, name: &str, text: &str) -> Rc<TokenFile> {
        let key = PathBuf::from(format!("builtin:{name}"));
        if let Some(file) = self.token_files.get(&key) {
            return file.clone();
        }
        let id = self.sources.add(format!("{name} (built in)"), text);
        self.note_standard(id);
        let file = Rc::new(lex(id, None, text, &mut self.names));
        self.token_files.insert(key, file.clone());
        file
    }
}

fn builtin_text(name: &str) -> Option<(&'static str, &'static str)> {
    let lower = file_name(&name.replace('\\', "/")).to_lowercase();
    let found = builtin::FILES
        .iter()
        .find(|f| f.0 == lower || f.0.strip_suffix(".inc") == Some(&lower));
    found.copied()
}

fn file_name(name: &str) -> String {
    name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned()
}

fn show_dir(dir: &Path) -> String {
    if dir.as_os_str().is_empty() {
        "./".to_owned()
    } else {
        format!("{}/", dir.display())
    }
}
