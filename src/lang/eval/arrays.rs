//! `array[n][m] { … }`.

use super::{Array, Interp, MAX_ARRAY_ITEMS, Parsed, T, Value};
use crate::lang::syntax::Word;
use std::rc::Rc;

impl Interp<'_> {
    /// An array, behind nothing: `array` comes next.
    pub fn array(&mut self) -> Parsed<Value> {
        let start = self.peek().span;
        if !self.eat_word(Word::Array) {
            return Err(self.expected("`array`"));
        }
        self.eat_word_text("mixed");
        let mut dims = Vec::new();
        let mut size = 1usize;
        for (v, span) in self.indices()? {
            let dim = usize::try_from(v).ok().filter(|&d| d > 0);
            let Some(dim) = dim else {
                return Err(self.error("P0305", span, format!("array size must be at least 1, found {v}")));
            };
            size = size.saturating_mul(dim);
            dims.push(dim);
            if size > MAX_ARRAY_ITEMS || dims.len() > 5 {
                let message = format!("array is too large: at most {MAX_ARRAY_ITEMS} elements in 5 dimensions");
                return Err(self.error("P0605", span, message));
            }
        }
        let sized = !dims.is_empty();
        let mut items = Vec::new();
        if self.peek_operator().t == T::Mark(b'{') {
            self.initializer(&dims, 0, &mut items)?;
            if !sized {
                dims.push(items.len().max(1));
                size = items.len().max(1);
            }
        } else if !sized {
            return Err(self.error(
                "P0305",
                start,
                "array needs a size, as in `array[3]`, or an initialiser",
            ));
        }
        items.resize(size, None);
        self.array_items += size;
        if self.array_items > MAX_ARRAY_ITEMS {
            return Err(self.fatal(
                "P0605",
                start,
                format!("arrays hold more than {MAX_ARRAY_ITEMS} elements in all"),
            ));
        }
        Ok(Value::Array(Rc::new(Array { dims, items })))
    }

    fn initializer(&mut self, dims: &[usize], depth: usize, items: &mut Vec<Option<Value>>) -> Parsed<()> {
        self.block(|s| {
            let rows_inside = depth + 1 < dims.len();
            let width: usize = dims.iter().skip(depth + 1).product();
            let mut count = 0usize;
            while s.peek().t != T::Mark(b'}') && s.peek().t != T::End {
                let span = s.peek().span;
                if dims.get(depth).is_some_and(|&d| count >= d) || items.len() >= MAX_ARRAY_ITEMS {
                    let size = dims.get(depth).copied().unwrap_or(MAX_ARRAY_ITEMS);
                    return Err(s.error(
                        "P0305",
                        span,
                        format!("array initialiser has more than {size} elements"),
                    ));
                }
                let before = items.len();
                if rows_inside {
                    s.initializer(dims, depth + 1, items)?;
                    items.resize(before + width, None);
                } else {
                    items.push(Some(s.rvalue()?));
                }
                count += 1;
                s.comma();
            }
            Ok(())
        })
    }

    /// Takes an identifier spelt like this, if it comes next.
    pub fn eat_word_text(&mut self, text: &str) -> bool {
        let found = match self.peek().t {
            T::Name(n) => &*self.names.name(n) == text && self.scopes.get(n).is_none(),
            T::Word(w) => w.text() == text,
            _ => false,
        };
        if found {
            self.bump();
        }
        found
    }
}
