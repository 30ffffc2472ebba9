//! Diagnostics as data: where something is wrong, what was expected and how to mend it.
//!
//! Every front end (text, glTF, OBJ, images) reports through [`Diagnostics`]; only `cli` turns them into
//! terminal text. A place is either a [`Span`] into a source of the [`SourceMap`] or, where a file has no
//! lines (glTF), a path inside that file such as `meshes[3].primitives[0].attributes.POSITION`.

mod anomalies;
mod guard;

pub use anomalies::{Anomalies, Anomaly};
pub use guard::{guarded, is_guarded};

use std::sync::Arc;

/// Names one source text of a [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A range of bytes in one source text: `start` inclusive, `end` exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// The source the bytes belong to.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The smallest span that covers both; `self` when they lie in different files.
    pub fn to(self, other: Span) -> Span {
        if self.file != other.file {
            return self;
        }
        Span {
            file: self.file,
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }
}

/// One source text with the name it is shown under.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// What the user calls it, usually the path as given or as found.
    pub name: String,
    /// The whole text.
    pub text: Arc<str>,
}

/// All texts that were read in one run, so that a span can be shown after loading has ended.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// Adds a text and returns its id.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        self.files.push(SourceFile {
            name: name.into(),
            text: text.into(),
        });
        FileId(self.files.len() as u32 - 1)
    }

    /// The source with this id, if it was added here.
    pub fn get(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }

    /// Line and column of the span's start, both counted from 1; columns count characters.
    /// Offsets past the end of the text give the end of the text.
    pub fn line_col(&self, span: Span) -> (usize, usize) {
        let Some(file) = self.get(span.file) else {
            return (1, 1);
        };
        let mut at = (span.start as usize).min(file.text.len());
        while !file.text.is_char_boundary(at) {
            at -= 1;
        }
        let before = &file.text[..at];
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        (line, before[line_start..].chars().count() + 1)
    }

    /// `name:line:column` of the span's start.
    pub fn place(&self, span: Span) -> String {
        let (line, col) = self.line_col(span);
        let name = self.get(span.file).map_or("?", |f| f.name.as_str());
        format!("{name}:{line}:{col}")
    }
}

/// How bad a diagnostic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; the picture is as written.
    Note,
    /// The picture may differ from what the author meant.
    Warning,
    /// No picture can be made.
    Error,
}

/// A span with a word about it. The first primary label is where the diagnostic points.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What to underline.
    pub span: Span,
    /// Short text beside the underline; may be empty.
    pub text: String,
    /// Whether this is the place itself rather than context (an include site, a macro call).
    pub primary: bool,
}

/// A textual replacement that would mend the problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// What to replace.
    pub span: Span,
    /// What to put there.
    pub replacement: String,
}

/// One thing to tell the user. Messages are lower case, name the thing first, then what was found and
/// what was expected; hints say how to mend it.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Stable code such as `P0201` (text), `G0104` (glTF), `O0003` (OBJ), `I0001` (images).
    pub code: &'static str,
    /// The message, one line.
    pub message: String,
    /// Places in source texts, the primary one first.
    pub labels: Vec<Label>,
    /// A place that is not a span: `model.gltf: nodes[4].mesh`, `model.obj:17`.
    pub place: Option<String>,
    /// How to mend it, one sentence each.
    pub hints: Vec<String>,
    /// A replacement that would mend it.
    pub fix: Option<Fix>,
    /// What was mended on the way, and how often.
    pub counts: Option<(Anomaly, u64)>,
}

impl Diagnostic {
    /// A diagnostic without a place yet.
    pub fn new(severity: Severity, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity,
            code,
            message: message.into(),
            labels: Vec::new(),
            place: None,
            hints: Vec::new(),
            fix: None,
            counts: None,
        }
    }

    /// An error without a place yet.
    pub fn error(code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Error, code, message)
    }

    /// A warning without a place yet.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Warning, code, message)
    }

    /// A note without a place yet.
    pub fn note(code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Note, code, message)
    }

    /// Points at `span`, with a short text beside it (may be empty).
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            span,
            text: text.into(),
            primary: true,
        });
        self
    }

    /// Adds context: an include site, a macro call, an earlier declaration.
    pub fn with_context(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            span,
            text: text.into(),
            primary: false,
        });
        self
    }

    /// Sets a place that is not a span.
    pub fn in_place(mut self, place: impl Into<String>) -> Diagnostic {
        self.place = Some(place.into());
        self
    }

    /// Adds a sentence that says how to mend it.
    pub fn hint(mut self, hint: impl Into<String>) -> Diagnostic {
        self.hints.push(hint.into());
        self
    }

    /// Proposes a replacement.
    pub fn with_fix(mut self, span: Span, replacement: impl Into<String>) -> Diagnostic {
        self.fix = Some(Fix {
            span,
            replacement: replacement.into(),
        });
        self
    }

    /// Counts what was mended: `n` of a kind.
    pub fn counting(mut self, kind: Anomaly, n: u64) -> Diagnostic {
        self.counts = Some((kind, n));
        self
    }

    /// The span this diagnostic points at, if it has one.
    pub fn primary_span(&self) -> Option<Span> {
        self.labels.iter().find(|l| l.primary).map(|l| l.span)
    }
}

/// The diagnostics of one run, in the order they were found, each told once.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    anomalies: Anomalies,
}

/// After this many diagnostics a run keeps counting errors but stores no more of them.
const MAX_STORED: usize = 1000;

impl Diagnostics {
    /// Adds one, unless the same one (severity, code, message, place) was told already.
    pub fn push(&mut self, d: Diagnostic) {
        // What happened again is counted again, though it is told once.
        if let Some((kind, n)) = d.counts {
            self.anomalies.count(kind, n);
        }
        let is_first_error = d.severity == Severity::Error && !self.has_errors();
        if is_first_error || (self.items.len() < MAX_STORED && !self.items.contains(&d)) {
            self.items.push(d);
        }
    }

    /// Counts what was mended where another front end has told of it already.
    pub fn count_anomaly(&mut self, kind: Anomaly, n: u64) {
        self.anomalies.count(kind, n);
    }

    /// What was mended so far, by kind.
    pub fn anomalies(&self) -> &Anomalies {
        &self.anomalies
    }

    /// Adds all of another run's.
    pub fn extend(&mut self, other: Diagnostics) {
        let mut anomalies = self.anomalies;
        anomalies.add(&other.anomalies);
        for d in other.items {
            self.push(d);
        }
        self.anomalies = anomalies; // also of those that were too many to be kept
    }

    /// Whether any of them is an error.
    pub fn has_errors(&self) -> bool {
        self.items.iter().any(|d| d.severity == Severity::Error)
    }

    /// How many there are of one severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.items.iter().filter(|d| d.severity == severity).count()
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.items.iter()
    }

    /// Whether nothing was reported.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_and_column_count_characters_from_one() {
        let mut map = SourceMap::default();
        let file = map.add("a.pts", "ab\näöx\n");
        let x = "ab\näö".len() as u32;
        let span = |s| Span {
            file,
            start: s,
            end: s + 1,
        };
        assert_eq!(map.line_col(span(0)), (1, 1));
        assert_eq!(map.line_col(span(x)), (2, 3));
        assert_eq!(map.place(span(x)), "a.pts:2:3");
        assert_eq!(map.line_col(span(10_000)), (3, 1));
    }

    #[test]
    fn the_same_diagnostic_is_told_once() {
        let mut all = Diagnostics::default();
        for _ in 0..3 {
            all.push(Diagnostic::error("P0001", "x is not defined"));
        }
        assert_eq!(all.count(Severity::Error), 1);
    }
}
