//! What the scene declares and never reads, and what it writes to no effect: told, not drawn.

use super::Interp;
use super::value::Value;
use crate::diag::{FileId, Span};
use crate::lang::syntax::Symbol;
use crate::scene::{LeftOut, Place};
use std::collections::{HashMap, HashSet};

/// Things that were declared and not yet read, by name; and things that came to nothing.
#[derive(Default)]
pub struct Unread {
    declared: HashMap<Symbol, (Span, &'static str)>,
    idle: Vec<LeftOut>,
    /// Texts of standard includes.
    standard: HashSet<FileId>,
}

impl Interp<'_> {
    /// A thing got a name. Numbers and texts are no things; what standard includes declare is not the scene's.
    pub fn note_declared(&mut self, name: Symbol, span: Span, value: &Value) {
        let Value::Desc(desc) = value else { return };
        if !self.unread.standard.contains(&span.file) {
            let kind = desc.kind();
            let word = kind.split_once(' ').map_or(kind, |(_, word)| word);
            self.unread.declared.insert(name, (span, word));
        }
    }

    /// A text is a standard include's.
    pub fn note_standard(&mut self, file: FileId) {
        self.unread.standard.insert(file);
    }

    /// A name was read, maybe as the parameter of a macro.
    pub fn note_read(&mut self, name: Symbol) {
        if !self.unread.declared.is_empty()
            && let Some(place) = self.scopes.find(name)
        {
            self.unread.declared.remove(&place.name);
        }
    }

    /// Something that the scene says has no effect.
    pub fn note_idle(&mut self, kind: &'static str, why: &str, span: Span) {
        self.unread.idle.push(left_out(kind, "", why, span));
    }

    /// Everything of it, in the order in which it was written.
    pub fn take_unread(&mut self) -> Vec<LeftOut> {
        let Unread { declared, idle, .. } = std::mem::take(&mut self.unread);
        let mut declared: Vec<_> = declared.into_iter().collect();
        declared.sort_by_key(|(_, (span, _))| (span.file, span.start));
        let tell = |(name, (span, kind)): (Symbol, (Span, &'static str))| {
            let name = self.names.name(name);
            left_out(kind, &name, "declared, and nothing drawn uses it", span)
        };
        declared.into_iter().map(tell).chain(idle).collect()
    }
}

fn left_out(kind: &'static str, name: &str, why: &str, span: Span) -> LeftOut {
    LeftOut {
        kind,
        name: name.to_owned(),
        why: why.to_owned(),
        file: None,
        bytes: 0,
        place: Place::Text(span),
    }
}
