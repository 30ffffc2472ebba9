//! The token stream: frames of files and macro bodies, one token of look-ahead, braces counted for recovery.

use super::{Interp, MAX_FRAMES, MAX_STEPS, Parsed, Value};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::{Interner, Symbol, Token, TokenFile, TokenKind, Word};
use std::rc::Rc;

/// What a token is to the parser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum T {
    /// A number.
    Number(f64),
    /// A word of the language.
    Word(Word),
    /// An identifier, declared or not; never a macro.
    Name(Symbol),
    /// A string, to be taken with [`Interp::take_text`].
    Text,
    /// An operator or bracket, see `TokenKind::Mark`.
    Mark(u8),
    /// A directive that must not run yet.
    Directive,
    /// A malformed token.
    Bad(TokenKind),
    /// Nothing follows.
    End,
}

/// A token with its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tok {
    /// What it is.
    pub t: T,
    /// Where it stands.
    pub span: Span,
}

/// Why a stretch of tokens is run.
#[derive(Clone, Debug)]
pub enum FrameKind {
    /// A file.
    Include,
    /// A macro's body.
    Macro(Symbol),
    /// A function's body.
    Function,
}

/// A construct of directives that is being run.
#[derive(Clone, Debug)]
pub enum Control {
    /// A branch of `#if`.
    Branch,
    /// A `#while` at this token.
    While { at: u32, runs: u64 },
    /// A `#for` at this token.
    For {
        at: u32,
        name: Symbol,
        value: f64,
        last: f64,
        step: f64,
        runs: u64,
    },
    /// A `#switch`.
    Switch { end: u32 },
}

/// A stretch of tokens being run.
pub struct Frame {
    pub file: Rc<TokenFile>,
    pub pos: u32,
    pub end: u32,
    pub kind: FrameKind,
    /// Index of its own scope.
    pub scope: usize,
    /// Scopes open below it.
    pub scopes_below: usize,
    /// Constructs it is inside of.
    pub controls: Vec<Control>,
    /// What led here: the include or the call.
    pub call: Option<Span>,
}

impl Interp<'_> {
    /// Starts running a stretch of tokens in a scope of its own.
    pub fn push_frame(
        &mut self,
        file: Rc<TokenFile>,
        range: (u32, u32),
        kind: FrameKind,
        call: Option<Span>,
    ) -> Parsed<usize> {
        if self.frames.len() >= MAX_FRAMES {
            let what = match kind {
                FrameKind::Include => "includes",
                FrameKind::Macro(_) => "macro calls",
                FrameKind::Function => "function calls",
            };
            let span = call.unwrap_or(file.span(range.0));
            let d = Diagnostic::error("P0603", format!("{what} are nested deeper than {MAX_FRAMES} levels"));
            return Err(self.fatal_report(d.at(span, "").hint("is there an end to this recursion?")));
        }
        let scopes_below = self.scopes.len();
        let scope = self.scopes.open();
        self.frames.push(Frame {
            file,
            pos: range.0,
            end: range.1,
            kind,
            scope,
            scopes_below,
            controls: Vec::new(),
            call,
        });
        self.ahead = None;
        Ok(scope)
    }

    /// Ends the innermost frame and its locals.
    pub fn pop_frame(&mut self) {
        if let Some(frame) = self.frames.pop() {
            self.scopes.close_to(frame.scopes_below);
        }
        self.ahead = None;
    }

    /// Frames being run.
    pub fn level(&self) -> usize {
        self.frames.len()
    }

    /// The innermost frame.
    pub fn frame(&self) -> Option<&Frame> {
        self.frames.last()
    }

    /// The innermost frame, to be moved; forgets the look-ahead.
    pub fn frame_mut(&mut self) -> Option<&mut Frame> {
        self.ahead = None;
        self.frames.last_mut()
    }

    /// The next token of the innermost frame itself: nothing is run or expanded.
    pub fn raw(&self, offset: u32) -> Option<(Token, Span)> {
        let frame = self.frames.last()?;
        let pos = frame.pos.checked_add(offset).filter(|&p| p < frame.end)?;
        let token = *frame.file.tokens.get(pos as usize)?;
        Some((token, frame.file.span(pos)))
    }

    /// Where the innermost frame stands, for messages.
    pub fn here(&self) -> Span {
        match self.frames.last() {
            Some(f) => f.file.span(f.pos),
            None => Span {
                file: crate::diag::FileId(0),
                start: 0,
                end: 0,
            },
        }
    }

    /// Whether the next raw token is this mark.
    pub fn raw_is(&self, offset: u32, mark: u8) -> bool {
        self.raw(offset)
            .is_some_and(|(t, _)| t.kind == TokenKind::Mark && t.data == u32::from(mark))
    }

    /// Whether a raw token is a string.
    pub fn raw_is_text(&self, offset: u32) -> bool {
        self.raw(offset).is_some_and(|(t, _)| t.kind == TokenKind::Text)
    }

    /// The next token; directives and macro calls in front of it are run first.
    pub fn peek(&mut self) -> Tok {
        if let Some(tok) = self.ahead {
            return tok;
        }
        loop {
            let end = Tok {
                t: T::End,
                span: self.here(),
            };
            if self.halted {
                return end;
            }
            let Some(frame) = self.frames.last() else { return end };
            if frame.pos >= frame.end {
                if self.frames.len() <= self.floor.max(1) {
                    return end;
                }
                if !frame.controls.is_empty() {
                    self.error(
                        "P0102",
                        end.span,
                        "a directive is not closed by `#end` in this file or macro",
                    );
                }
                self.pop_frame();
                continue;
            }
            let Some(&token) = frame.file.tokens.get(frame.pos as usize) else {
                return end;
            };
            let t = match token.kind {
                TokenKind::Number => T::Number(frame.file.numbers.get(token.data as usize).copied().unwrap_or(0.0)),
                TokenKind::Mark if token.data == u32::from(b'#') => {
                    self.warn_once("P0206", end.span, "a `#` without a directive is skipped");
                    self.jump(self.frame().map_or(0, |f| f.pos + 1));
                    continue;
                }
                TokenKind::Mark => T::Mark(token.data as u8),
                TokenKind::Text => T::Text,
                TokenKind::Directive => {
                    self.run_directive();
                    continue;
                }
                TokenKind::Name => {
                    let symbol = Symbol(token.data);
                    match Interner::word(symbol) {
                        Some(w) if !w.is_contextual() => T::Word(w),
                        word => match (self.scopes.get(symbol), word) {
                            (Some(Value::Macro(m)), _) => {
                                let m = m.clone();
                                self.expand(m);
                                continue;
                            }
                            (None, Some(w)) => T::Word(w),
                            _ => T::Name(symbol),
                        },
                    }
                }
                kind => T::Bad(kind),
            };
            let tok = Tok { t, span: self.here() };
            self.ahead = Some(tok);
            return tok;
        }
    }

    /// Takes the next token.
    pub fn bump(&mut self) -> Tok {
        let tok = self.peek();
        if tok.t == T::End {
            return tok;
        }
        self.ahead = None;
        self.failed = false;
        self.resumed = false;
        match tok.t {
            T::Mark(b'{') => self.braces.push(tok.span),
            T::Mark(b'}') => {
                self.braces.pop();
            }
            _ => {}
        }
        if let Some(frame) = self.frames.last_mut() {
            frame.pos += 1;
        }
        self.steps += 1;
        if self.steps > MAX_STEPS {
            self.fatal(
                "P0604",
                tok.span,
                format!("the scene runs more than {MAX_STEPS} tokens"),
            );
        }
        tok
    }

    /// The next token where an operator or the end of an expression may stand. Inside a declaration a directive ends
    /// the expression: `#declare A = 3` without a semicolon must be complete before the next directive runs.
    pub fn peek_operator(&mut self) -> Tok {
        if let (None, Some(level)) = (self.ahead, self.hold) {
            while self.frames.len() > level && self.frames.last().is_some_and(|f| f.pos >= f.end) {
                self.pop_frame();
            }
            let held = Tok {
                t: T::Directive,
                span: self.here(),
            };
            if self.frames.len() == level {
                match self.raw(0) {
                    None => return held,
                    Some((t, _)) if t.kind == TokenKind::Directive => return held,
                    Some((t, _)) if t.kind == TokenKind::Name => {
                        if let Some(Value::Macro(_)) = self.scopes.get(Symbol(t.data)) {
                            return held;
                        }
                    }
                    _ => {}
                }
            }
        }
        self.peek()
    }

    /// Runs a step whose expressions do not end at directives: inside brackets everything belongs to it.
    pub fn unheld<R>(&mut self, step: impl FnOnce(&mut Self) -> R) -> R {
        let hold = self.hold.take();
        let result = step(self);
        self.hold = hold;
        result
    }

    /// Runs a step whose expressions end at the next directive of the current frame.
    pub fn held<R>(&mut self, step: impl FnOnce(&mut Self) -> R) -> R {
        let hold = self.hold.replace(self.frames.len());
        let result = step(self);
        self.hold = hold;
        result
    }

    /// Runs a step inside which the innermost frame's end is the end of the text.
    pub fn floored<R>(&mut self, step: impl FnOnce(&mut Self) -> R) -> R {
        let floor = std::mem::replace(&mut self.floor, self.frames.len());
        let result = step(self);
        self.floor = floor;
        result
    }

    /// Takes the next token if it is this mark.
    pub fn eat(&mut self, mark: u8) -> bool {
        let found = self.peek().t == T::Mark(mark);
        if found {
            self.bump();
        }
        found
    }

    /// Takes the next token if it is this word.
    pub fn eat_word(&mut self, word: Word) -> bool {
        let found = self.peek().t == T::Word(word);
        if found {
            self.bump();
        }
        found
    }

    /// Takes this mark or reports what stands there instead.
    pub fn expect(&mut self, mark: u8) -> Parsed<Span> {
        let tok = self.peek();
        if tok.t == T::Mark(mark) {
            self.bump();
            return Ok(tok.span);
        }
        Err(self.expected_not(&format!("`{}`", char::from(mark)), tok))
    }

    /// Skips one separating comma.
    pub fn comma(&mut self) {
        self.eat(b',');
    }

    /// Takes a string token.
    pub fn take_text(&mut self) -> Option<Rc<str>> {
        if self.peek().t != T::Text {
            return None;
        }
        let frame = self.frames.last()?;
        let token = frame.file.tokens.get(frame.pos as usize)?;
        let text = frame.file.texts.get(token.data as usize).cloned();
        self.bump();
        text
    }
}
