//! Tokens: small, copied freely, cached per file and run many times by loops and macros.

use super::words::{ALIASES, ALL, Word};
use crate::diag::{FileId, Span};
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

/// An interned name. Words of the language come first, at the position of their [`Word`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(pub u32);

/// Names by number and numbers by name.
#[derive(Debug)]
pub struct Interner {
    names: Vec<Rc<str>>,
    ids: HashMap<Rc<str>, Symbol>,
}

impl Default for Interner {
    fn default() -> Interner {
        let mut interner = Interner {
            names: Vec::with_capacity(ALL.len() * 2),
            ids: HashMap::with_capacity(ALL.len() * 2),
        };
        for (_, text) in ALL {
            interner.intern(text);
        }
        for &(alias, word) in ALIASES {
            interner.ids.insert(alias.into(), Symbol(word as u32));
        }
        interner
    }
}

impl Interner {
    /// The symbol of a name, new or known.
    pub fn intern(&mut self, name: &str) -> Symbol {
        if let Some(&id) = self.ids.get(name) {
            return id;
        }
        let id = Symbol(self.names.len() as u32);
        let name: Rc<str> = name.into();
        self.names.push(name.clone());
        self.ids.insert(name, id);
        id
    }

    /// The name of a symbol.
    pub fn name(&self, symbol: Symbol) -> Rc<str> {
        self.names.get(symbol.0 as usize).cloned().unwrap_or_else(|| "".into())
    }

    /// The word a symbol stands for, if it is one.
    pub fn word(symbol: Symbol) -> Option<Word> {
        ALL.get(symbol.0 as usize).map(|w| w.0)
    }
}

/// What a token is; [`Token::data`] says more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TokenKind {
    /// `data` indexes [`TokenFile::numbers`].
    Number,
    /// A word or identifier; `data` is its [`Symbol`].
    Name,
    /// A string; `data` indexes [`TokenFile::texts`].
    Text,
    /// An operator or bracket; `data` is its ASCII code, or that of a letter for the double ones, see [`LE`].
    Mark,
    /// `#word`; `data` indexes [`TokenFile::directives`].
    Directive,
    /// A string without its closing quote.
    OpenText,
    /// A block comment without its end.
    OpenComment,
    /// A character that belongs to no token.
    Stray,
}

/// `<=` as the `data` of a [`TokenKind::Mark`].
pub const LE: u8 = b'l';
/// `>=` as the `data` of a [`TokenKind::Mark`].
pub const GE: u8 = b'g';
/// `!=` as the `data` of a [`TokenKind::Mark`].
pub const NE: u8 = b'n';

/// One token of a file.
#[derive(Clone, Copy, Debug)]
pub struct Token {
    /// Kind.
    pub kind: TokenKind,
    /// Meaning depends on the kind.
    pub data: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// Which directive stands behind a `#`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum DirectiveKind {
    Declare,
    Local,
    Undef,
    Include,
    If,
    Ifdef,
    Ifndef,
    Elseif,
    Else,
    End,
    While,
    For,
    Switch,
    Case,
    Range,
    Break,
    Macro,
    Version,
    Default,
    Debug,
    Warning,
    Error,
    Statistics,
    Render,
    Fopen,
    Fclose,
    Read,
    Write,
    Unknown,
}

/// Spellings of the directives, for the lexer and for suggestions.
pub const DIRECTIVES: &[(&str, DirectiveKind)] = &[
    ("declare", DirectiveKind::Declare),
    ("local", DirectiveKind::Local),
    ("undef", DirectiveKind::Undef),
    ("include", DirectiveKind::Include),
    ("if", DirectiveKind::If),
    ("ifdef", DirectiveKind::Ifdef),
    ("ifndef", DirectiveKind::Ifndef),
    ("elseif", DirectiveKind::Elseif),
    ("else", DirectiveKind::Else),
    ("end", DirectiveKind::End),
    ("while", DirectiveKind::While),
    ("for", DirectiveKind::For),
    ("switch", DirectiveKind::Switch),
    ("case", DirectiveKind::Case),
    ("range", DirectiveKind::Range),
    ("break", DirectiveKind::Break),
    ("macro", DirectiveKind::Macro),
    ("version", DirectiveKind::Version),
    ("default", DirectiveKind::Default),
    ("debug", DirectiveKind::Debug),
    ("warning", DirectiveKind::Warning),
    ("error", DirectiveKind::Error),
    ("statistics", DirectiveKind::Statistics),
    ("render", DirectiveKind::Render),
    ("fopen", DirectiveKind::Fopen),
    ("fclose", DirectiveKind::Fclose),
    ("read", DirectiveKind::Read),
    ("write", DirectiveKind::Write),
];

/// No token: the directive is not matched.
pub const NONE: u32 = u32::MAX;

/// A directive and how it nests. Positions are indices of tokens.
#[derive(Clone, Copy, Debug)]
pub struct Directive {
    /// Which one.
    pub kind: DirectiveKind,
    /// The next clause of the same construct (`#elseif #else #case #range #end`), or [`NONE`].
    pub next: u32,
    /// The `#end` of the construct, or [`NONE`].
    pub end: u32,
    /// The opening directive of the construct, itself for openers, or [`NONE`] for a stray clause.
    pub opener: u32,
}

/// A file as tokens.
#[derive(Debug)]
pub struct TokenFile {
    /// Its source.
    pub file: FileId,
    /// Its directory, where its includes are looked up first; `None` for built-in includes.
    pub dir: Option<PathBuf>,
    /// The tokens in order.
    pub tokens: Vec<Token>,
    /// Values of number tokens; infinite where the text is too large for a double.
    pub numbers: Vec<f64>,
    /// Values of string tokens, escapes resolved.
    pub texts: Vec<Rc<str>>,
    /// Directives in order.
    pub directives: Vec<Directive>,
}

impl TokenFile {
    /// Where a token stands; the end of the last token for positions past the end.
    pub fn span(&self, pos: u32) -> Span {
        let (start, end) = match self.tokens.get(pos as usize) {
            Some(t) => (t.start, t.end),
            None => self.tokens.last().map_or((0, 0), |t| (t.end, t.end)),
        };
        Span {
            file: self.file,
            start,
            end,
        }
    }

    /// The directive that a token is, if it is one.
    pub fn directive(&self, pos: u32) -> Option<&Directive> {
        let token = self.tokens.get(pos as usize)?;
        match token.kind {
            TokenKind::Directive => self.directives.get(token.data as usize),
            _ => None,
        }
    }
}
