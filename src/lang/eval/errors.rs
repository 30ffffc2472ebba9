//! Reporting: every message gets its place, the macro calls and includes that led there, and a suggestion.

use super::stream::FrameKind;
use super::{Interp, MAX_ERRORS, T, Tok};
use crate::diag::{Anomaly, Diagnostic, Severity, Span};
use crate::lang::syntax::TokenKind;

/// Parsing cannot go on here; the reason has been reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop;

/// The result of parsing something.
pub type Parsed<R> = Result<R, Stop>;

/// Notes and warnings told at most.
const MAX_NOTES: usize = 500;

/// Errors while skipping after which reading stops.
const MAX_SILENT: usize = 20_000;

/// Context labels shown at most.
const MAX_CONTEXT: usize = 4;

impl Interp<'_> {
    /// Reports an error with its place.
    pub fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>) -> Stop {
        self.report(Diagnostic::error(code, message).at(span, ""))
    }

    /// Reports an error that ends the reading.
    pub fn fatal(&mut self, code: &'static str, span: Span, message: impl Into<String>) -> Stop {
        self.fatal_report(Diagnostic::error(code, message).at(span, ""))
    }

    /// Reports an error that ends the reading, even where messages are muted.
    pub fn fatal_report(&mut self, d: Diagnostic) -> Stop {
        if !self.halted {
            (self.muted, self.failed) = (0, false);
            self.report(d);
        }
        self.halted = true;
        self.ahead = None;
        Stop
    }

    /// Reports a diagnostic, adding how the reading came here.
    pub fn report(&mut self, mut d: Diagnostic) -> Stop {
        let is_error = d.severity == Severity::Error;
        if self.is_silent() {
            return Stop;
        }
        if !is_error {
            self.notes += 1;
            if self.notes > MAX_NOTES {
                return Stop;
            }
        }
        if is_error && std::mem::take(&mut self.failed) {
            return Stop;
        }
        let mut shown = 0;
        for frame in self.frames.iter().rev() {
            let Some(call) = frame.call else { continue };
            if shown == MAX_CONTEXT {
                break;
            }
            let text = match &frame.kind {
                FrameKind::Include => "included from here".to_owned(),
                FrameKind::Macro(name) => format!("in the call of macro `{}`", self.names.name(*name)),
                FrameKind::Function => "in the call of this function".to_owned(),
            };
            d = d.with_context(call, text);
            shown += 1;
        }
        self.diags.push(d);
        if is_error {
            self.errors += 1;
            if self.errors >= MAX_ERRORS {
                self.halted = true;
                self.ahead = None;
            }
        }
        Stop
    }

    /// Whether an error would not be told now. Silent errors are counted too: a loop of them must end.
    pub fn is_silent(&mut self) -> bool {
        if self.muted > 0 {
            self.silent += 1;
            if self.silent > MAX_SILENT {
                self.halted = true; // what was told before is the reason
                self.ahead = None;
            }
        }
        self.muted > 0 || self.halted
    }

    /// A failed declaration is used: told already, but a loop that does nothing else must end.
    pub fn poisoned(&mut self) -> Stop {
        self.errors += 1;
        if self.errors >= MAX_ERRORS {
            self.halted = true;
            self.ahead = None;
        }
        Stop
    }

    /// A warning with its place.
    pub fn warn(&mut self, code: &'static str, span: Span, message: impl Into<String>) {
        self.report(Diagnostic::warning(code, message).at(span, ""));
    }

    /// A warning about a value that was moved to where it means something.
    pub fn moved(&mut self, span: Span, message: impl Into<String>) {
        self.mended("P0309", span, message, Anomaly::MovedValue, 1);
    }

    /// A warning about `n` things of a kind that were mended.
    pub fn mended(&mut self, code: &'static str, span: Span, message: impl Into<String>, kind: Anomaly, n: u64) {
        self.report(Diagnostic::warning(code, message).at(span, "").counting(kind, n));
    }

    /// Whether this is the first time that something is to be told.
    pub fn told_first(&mut self, what: &str) -> bool {
        self.muted == 0 && self.told.insert(what.to_owned())
    }

    /// A warning that is told once per message.
    pub fn warn_once(&mut self, code: &'static str, span: Span, message: impl Into<String>) {
        let message = message.into();
        if self.muted == 0 && self.told.insert(message.clone()) {
            self.warn(code, span, message);
        }
    }

    /// Reports that something else was expected than the next token.
    pub fn expected(&mut self, what: &str) -> Stop {
        let tok = self.peek();
        self.expected_not(what, tok)
    }

    /// Reports that something else was expected than `tok`.
    pub fn expected_not(&mut self, what: &str, tok: Tok) -> Stop {
        if self.is_silent() {
            return Stop;
        }
        if let Some(stop) = self.bad_token(tok) {
            return stop;
        }
        if let T::Name(name) = tok.t
            && self.scopes.get(name).is_none()
        {
            return self.undefined(tok);
        }
        let found = self.describe(tok);
        let mut d = Diagnostic::error("P0201", format!("expected {what}, found {found}"));
        d = d.at(tok.span, format!("expected {what}"));
        if let (T::End, Some(&open)) = (tok.t, self.braces.last()) {
            d = d.with_context(open, "this `{` is still open");
        }
        if matches!(tok.t, T::Mark(b'=')) && self.braces.is_empty() {
            d = d.hint("declare a name with `#declare Name = value;`");
        }
        self.report(d)
    }

    /// Reports a token that is malformed in itself.
    pub fn bad_token(&mut self, tok: Tok) -> Option<Stop> {
        let (message, hint) = match tok.t {
            T::Bad(TokenKind::OpenText) => ("string is never closed", "close it with `\"` on its line"),
            T::Bad(TokenKind::OpenComment) => ("comment is never closed", "close it with `*/`; comments nest"),
            T::Bad(TokenKind::Stray) => (
                "unexpected character",
                "the scene may hold binary data or another language",
            ),
            _ => return None,
        };
        Some(self.report(Diagnostic::error("P0101", message).at(tok.span, "").hint(hint)))
    }

    /// Reports a name that nothing was declared under.
    pub fn undefined(&mut self, tok: Tok) -> Stop {
        if self.is_silent() {
            return Stop; // suggestions cost time, and a loop may come here often
        }
        let T::Name(symbol) = tok.t else {
            return self.expected_not("a name", tok);
        };
        let name = self.names.name(symbol);
        let declared: Vec<String> = self.scopes.names().map(|s| self.names.name(s).to_string()).collect();
        let mut d = Diagnostic::error("P0401", format!("`{name}` is not defined"))
            .at(tok.span, "not declared before this point");
        if let Some(best) = nearest(&name, declared.iter().map(String::as_str)) {
            d = d.hint(format!("did you mean `{best}`?")).with_fix(tok.span, best);
        } else if let Some((best, file)) = builtin_near(&name) {
            if best != &*name {
                d = d.hint(format!("did you mean `{best}`, from {file}?"));
            }
            d = d.hint(format!("add `#include \"{file}\"`"));
        }
        self.report(d)
    }

    /// Reports a word or name that has no meaning where it stands.
    pub fn unexpected(&mut self, place: &str, valid: &[&str], tok: Tok) -> Stop {
        if self.is_silent() {
            return Stop;
        }
        if let Some(stop) = self.bad_token(tok) {
            return stop;
        }
        let text = match tok.t {
            T::Word(w) => w.text().to_owned(),
            T::Name(s) => self.names.name(s).to_string(),
            _ => String::new(),
        };
        let best = nearest(&text, valid.iter().copied());
        if let (T::Name(s), None) = (tok.t, best)
            && self.scopes.get(s).is_none()
        {
            return self.undefined(tok);
        }
        let found = self.describe(tok);
        let mut d = Diagnostic::error(
            "P0202",
            format!("unexpected {} in {place}", found.trim_start_matches("a ")),
        )
        .at(tok.span, "");
        if let Some(best) = best {
            d = d.hint(format!("did you mean `{best}`?")).with_fix(tok.span, best);
        } else if let Some(meant) = foreign(&text) {
            d = d.hint(meant);
        }
        if let (true, Some(&open)) = (matches!(tok.t, T::Word(_) | T::End), self.braces.last()) {
            d = d.with_context(open, "inside this block; is its `}` missing?");
        }
        self.report(d)
    }

    /// What messages call a token.
    pub fn describe(&self, tok: Tok) -> String {
        match tok.t {
            T::Number(v) => format!("the number {v}"),
            T::Word(w) => format!("`{}`", w.text()),
            T::Name(s) => match self.scopes.get(s) {
                Some(v) => format!("`{}`, {}", self.names.name(s), v.kind()),
                None => format!("`{}`", self.names.name(s)),
            },
            T::Text => "a string".to_owned(),
            T::Mark(m) => format!("`{}`", mark_text(m)),
            T::Directive => "a directive".to_owned(),
            T::Bad(_) => "a malformed token".to_owned(),
            T::End => "the end of the text".to_owned(),
        }
    }
}

fn mark_text(mark: u8) -> String {
    use crate::lang::syntax::token::{GE, LE, NE};
    match mark {
        LE => "<=".into(),
        GE => ">=".into(),
        NE => "!=".into(),
        m => char::from(m).to_string(),
    }
}

/// The candidate that is nearest to a misspelt word: about a third of its letters off at most, case aside.
pub fn nearest<'c>(word: &str, candidates: impl Iterator<Item = &'c str>) -> Option<&'c str> {
    let lower = word.to_lowercase();
    let most = ((word.chars().count() + 1) / 3).max(1);
    let scored = candidates
        .filter(|c| *c != word && c.len() > 1 && word.len() > 1)
        .map(|c| {
            let distance = strsim::damerau_levenshtein(&lower, &c.to_lowercase());
            (distance, c)
        });
    scored.filter(|s| s.0 <= most).min().map(|s| s.1)
}

/// What somebody means who writes a word of another program.
fn foreign(word: &str) -> Option<&'static str> {
    Some(match word {
        "cube" => "a box is `box { <corner>, <corner> }`",
        "mirror" | "reflective" => "a mirror is `material { specular { color C } }`",
        "lambertian" | "matte" | "lambert" => "a matte surface is `material { diffuse { color C } }`",
        "dielectric" => "glass is `material { glass { color C ior n } }`",
        "conductor" | "metallic" => "metal is `material { glossy { color C roughness r metal } }`",
        "emissive" | "emit" => "write `emission C` inside `material { … }`",
        "position" | "origin" | "eye" => "a camera's place is `location`",
        "target" => "a camera looks towards `look_at`",
        "fov" => "the horizontal field of view is `angle`, in degrees",
        "light" => "a lamp is `light_source { <place>, colour }`",
        "skybox" | "sky" | "envmap" => "light from far away is `environment { image \"file\" }`",
        "samples" => "samples per pixel are `spp` inside `render { … }`",
        _ => return None,
    })
}

/// The name nearest to this one that a built-in include declares, and the include; the name itself comes first.
fn builtin_near(name: &str) -> Option<(&'static str, &'static str)> {
    let mut declared: Vec<(&'static str, &'static str)> = Vec::new();
    for (file, text) in crate::lang::builtin::FILES {
        for mark in ["#declare ", "#macro "] {
            declared.extend(text.match_indices(mark).filter_map(|(at, _)| {
                let rest = text.get(at + mark.len()..)?;
                let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'))?;
                Some((rest.get(..end)?, *file))
            }));
        }
    }
    if let Some(found) = declared.iter().find(|d| d.0 == name) {
        return Some(*found);
    }
    let best = nearest(name, declared.iter().map(|d| d.0))?;
    declared.into_iter().find(|d| d.0 == best)
}
