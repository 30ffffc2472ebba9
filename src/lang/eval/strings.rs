//! Strings: literals, identifiers and the functions that make them.

use super::{Interp, MAX_TEXT, Parsed, Stop, T, Value};
use crate::diag::Span;
use crate::lang::syntax::Word;
use std::rc::Rc;

/// Words that begin a string.
const TEXT_WORDS: &[Word] = &[
    Word::Concat,
    Word::Str,
    Word::Substr,
    Word::Strupr,
    Word::Strlwr,
    Word::Chr,
    Word::Vstr,
];

impl Interp<'_> {
    /// Whether a string starts here.
    pub fn starts_text(&mut self) -> bool {
        match self.peek().t {
            T::Text => true,
            T::Word(w) => TEXT_WORDS.contains(&w),
            T::Name(n) => match self.scopes.get(n) {
                Some(Value::Text(_)) => true,
                Some(Value::Array(a)) => {
                    matches!(a.items.iter().flatten().next(), Some(Value::Text(_))) && self.raw_is(1, b'[')
                }
                _ => false,
            },
            _ => false,
        }
    }

    /// A string.
    pub fn text(&mut self, what: &str) -> Parsed<Rc<str>> {
        let tok = self.peek();
        match tok.t {
            T::Text => self.take_text().ok_or(Stop),
            T::Word(w) if TEXT_WORDS.contains(&w) => {
                self.bump();
                self.expect(b'(')?;
                let text = self.nested(tok.span, |s| s.unheld(|s| s.text_function(w, tok.span)))?;
                self.expect(b')')?;
                if text.len() > MAX_TEXT {
                    return Err(self.error("P0605", tok.span, format!("string is longer than {MAX_TEXT} bytes")));
                }
                Ok(text.into())
            }
            T::Name(_) => match self.take_value()? {
                Value::Text(t) => Ok(t),
                Value::Poison => Err(self.poisoned()),
                other => Err(self.error(
                    "P0303",
                    tok.span,
                    format!("{what} must be a string, found {}", other.kind()),
                )),
            },
            _ => Err(self.expected_not(&format!("a string ({what})"), tok)),
        }
    }

    fn text_function(&mut self, word: Word, span: Span) -> Parsed<String> {
        Ok(match word {
            Word::Concat => {
                let mut out = String::new();
                loop {
                    out.push_str(&self.text("argument of `concat`")?);
                    if out.len() > MAX_TEXT || !self.eat(b',') {
                        return Ok(out);
                    }
                }
            }
            Word::Str => {
                let v = self.float("number to print")?;
                self.comma();
                let width = self.float("width")?;
                self.comma();
                let precision = self.float("precision")?;
                format_number(v, width, precision)
            }
            Word::Vstr => {
                let n = self.float("number of components")?;
                self.comma();
                let v = self.expr()?.five();
                self.comma();
                let separator = self.text("separator")?;
                self.comma();
                let width = self.float("width")?;
                self.comma();
                let precision = self.float("precision")?;
                let n = (n as i64).clamp(2, 5) as usize;
                let parts: Vec<String> = v.iter().take(n).map(|&c| format_number(c, width, precision)).collect();
                parts.join(&separator)
            }
            Word::Substr => {
                let text = self.text("string to cut")?;
                self.comma();
                let start = self.float("start")?;
                self.comma();
                let len = self.float("length")?;
                let count = text.chars().count();
                let (first, n) = (start as i64, len as i64);
                if first < 1 || n < 0 || (first - 1).saturating_add(n) > count as i64 {
                    let message = format!(
                        "substr takes characters {first} to {} of a string of {count}",
                        first.saturating_add(n) - 1
                    );
                    return Err(self.error("P0305", span, message));
                }
                text.chars().skip((first - 1) as usize).take(n as usize).collect()
            }
            Word::Strupr => self.text("string")?.to_uppercase(),
            Word::Strlwr => self.text("string")?.to_lowercase(),
            _ => {
                let code = self.float("character code")?;
                let c = char::from_u32(code.clamp(0.0, 1_114_111.0) as u32);
                c.map(String::from).unwrap_or_default()
            }
        })
    }
}

/// `str(v, width, precision)`: a negative width pads with zeros, a negative precision means six decimals.
fn format_number(v: f64, width: f64, precision: f64) -> String {
    let precision = if precision < 0.0 {
        6
    } else {
        (precision as usize).min(64)
    };
    let text = format!("{v:.precision$}");
    let fill = (width.abs() as usize).min(1024).saturating_sub(text.len());
    match (width < 0.0, text.strip_prefix('-')) {
        (true, Some(rest)) => format!("-{}{rest}", "0".repeat(fill)),
        (true, None) => format!("{}{text}", "0".repeat(fill)),
        (false, _) => format!("{}{text}", " ".repeat(fill)),
    }
}
