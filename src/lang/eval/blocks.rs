//! Blocks in braces, and getting back on track after an error: the rest of a failed block is skipped without messages,
//! so that one run reports many errors.

use super::{Interp, Parsed, Stop, T, Tok};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::Word;

impl Interp<'_> {
    /// Parses `{ … }`: `body` reads up to the closing brace. After an error inside, the rest of the block is skipped,
    /// so that the caller can go on behind it; the result is still an error.
    pub fn block<R>(&mut self, body: impl FnOnce(&mut Self) -> Parsed<R>) -> Parsed<R> {
        let open = self.expect(b'{')?;
        let depth = self.braces.len();
        let result = self.nested(open, |s| {
            s.unheld(|s| {
                let value = body(s)?;
                let tok = s.peek();
                match tok.t {
                    T::Mark(b'}') => {
                        s.bump();
                        Ok(value)
                    }
                    T::End => Err(s.unclosed(open)),
                    _ => Err(s.expected_not("`}`", tok)),
                }
            })
        });
        if result.is_err() {
            if std::mem::take(&mut self.closed_early) {
                self.braces.truncate(depth.saturating_sub(1));
            } else {
                self.skip_to_depth(depth.saturating_sub(1));
            }
            self.resumed = true;
        }
        result
    }

    /// Whether the next token begins a line of its text.
    fn begins_line(&self) -> bool {
        let span = self.here();
        let text = self
            .sources
            .get(span.file)
            .and_then(|f| f.text.get(..span.start as usize));
        text.is_some_and(|t| t.trim_end_matches([' ', '\t']).ends_with('\n'))
    }

    /// If a word begins a line that can only stand outside of the block being read, the block's `}` is missing: reports
    /// that and makes the block end here, so that reading goes on with the word.
    pub fn missing_brace(&mut self, tok: Tok, outer: &[Word]) -> Option<Stop> {
        let (T::Word(w), Some(&open)) = (tok.t, self.braces.last()) else {
            return None;
        };
        if !outer.contains(&w) || !self.begins_line() {
            return None;
        }
        let d = Diagnostic::error("P0103", "this `{` is never closed").at(open, "opened here");
        let d = d.with_context(tok.span, "a `}` is missing before this");
        self.report(d.hint("add the missing `}`"));
        self.closed_early = true;
        Some(Stop)
    }

    /// Reports a brace that is never closed and ends the reading: every enclosing one would only repeat it.
    pub fn unclosed(&mut self, open: Span) -> Stop {
        let d = Diagnostic::error("P0103", "this `{` is never closed").at(open, "opened here");
        self.fatal_report(d.hint("add the missing `}`"))
    }

    /// Skips, without messages, until so many braces are open; directives on the way still run.
    pub fn skip_to_depth(&mut self, depth: usize) {
        self.muted += 1;
        while self.braces.len() > depth && self.peek().t != T::End {
            self.bump();
        }
        self.muted = self.muted.saturating_sub(1);
        if self.braces.len() > depth {
            self.braces.truncate(depth);
        }
    }

    /// How many braces are open.
    pub fn depth(&self) -> usize {
        self.braces.len()
    }

    /// Marks that an error was just reported while looking ahead, so that its consequence is not reported too.
    pub fn mark_failed(&mut self) {
        self.failed = true;
    }

    /// The next error is told again, even right behind one that was found looking ahead.
    pub fn clear_failed(&mut self) {
        self.failed = false;
    }

    /// Whether reading has ended early.
    pub fn is_halted(&self) -> bool {
        self.halted
    }

    /// Tokens taken so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Starts or ends a stretch without messages; they nest.
    pub fn mute(&mut self, on: bool) {
        self.muted = if on {
            self.muted + 1
        } else {
            self.muted.saturating_sub(1)
        };
    }

    /// Whether the stream stands right behind a block that was skipped after an error: reading can go on here.
    pub fn has_resumed(&self) -> bool {
        self.resumed
    }

    /// Pops finished frames above a level: the macro calls whose tokens are used up.
    pub fn settle(&mut self, level: usize) {
        while self.frames.len() > level && self.frames.last().is_some_and(|f| f.pos >= f.end) {
            self.pop_frame();
        }
    }
}
