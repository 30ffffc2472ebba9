//! Reading over what is not understood, and going on after an error.

use crate::lang::eval::{Interp, Parsed, T, Tok};
use crate::lang::syntax::Word;

impl Interp<'_> {
    /// The next token where a new item of a block or of the scene may begin.
    pub fn peek_item(&mut self) -> Tok {
        let tok = self.peek();
        self.clear_failed();
        tok
    }

    /// Reads over `{ … }`; directives inside run, everything else is ignored.
    pub fn skip_block(&mut self) -> Parsed<()> {
        self.block(|s| {
            let depth = s.depth();
            loop {
                let tok = s.peek();
                if let Some(stop) = s.bad_token(tok) {
                    return Err(stop);
                }
                match tok.t {
                    T::End => return Ok(()),
                    T::Mark(b'}') if s.depth() == depth => return Ok(()),
                    _ => s.bump(),
                };
            }
        })
    }

    /// Reads over what may follow a word that has no meaning here: numbers, vectors, colours, strings, blocks.
    pub fn skip_arguments(&mut self) -> Parsed<()> {
        loop {
            let tok = self.peek();
            match tok.t {
                T::Mark(b'{') => self.skip_block()?,
                T::Mark(b',') => {
                    self.bump();
                }
                _ if self.starts_text() => {
                    self.text("value")?;
                }
                _ if self.starts_expr() => {
                    self.expr()?;
                }
                _ => return Ok(()),
            }
        }
    }

    /// An optional truth value behind a flag: `hollow`, `hollow off`.
    pub fn flag(&mut self) -> Parsed<bool> {
        let follows = match self.peek().t {
            T::Number(_) | T::Mark(b'(') => true,
            T::Word(w) => matches!(
                w,
                Word::On | Word::Off | Word::Yes | Word::No | Word::True | Word::False
            ),
            _ => false,
        };
        if follows {
            Ok(self.float("flag")? != 0.0)
        } else {
            Ok(true)
        }
    }

    /// Goes on after an error in an item of a block at this depth: skips to the next word that may begin one, or to the
    /// end of the block. `before` is the number of tokens taken when the item began.
    pub fn recover(&mut self, depth: usize, before: u64, words: &[Word]) {
        if self.has_resumed() && self.depth() == depth && self.steps() != before {
            self.clear_failed();
            return;
        }
        self.skip_to_depth(depth);
        self.mute(true);
        if self.steps() == before && !matches!(self.peek().t, T::Mark(b'}')) {
            self.bump();
        }
        loop {
            match self.peek().t {
                T::End => break,
                T::Mark(b'}') if self.depth() <= depth => {
                    if depth == 0 {
                        self.bump();
                        continue;
                    }
                    break;
                }
                T::Word(w) if self.depth() == depth && words.contains(&w) => break,
                _ => self.bump(),
            };
        }
        self.mute(false);
        self.clear_failed();
    }
}
