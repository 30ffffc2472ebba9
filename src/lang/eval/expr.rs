//! Expressions over numbers, vectors and colours. Comparisons, `&`, `|` and `?:` exist only inside parentheses (or
//! directive conditions), as in POV-Ray: in the open, `<` begins a vector.

use super::{ImageFactor, Interp, Num, Parsed, T, Tok, Value};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::token::{GE, LE, NE};
use crate::lang::syntax::{Symbol, Word};
use glam::DVec3;

/// Values nearer to 0 than this are false, and numbers nearer to each other are equal (POV-Ray's rule).
const TRUTH: f64 = 1e-10;

/// Whether a number counts as true.
pub fn is_true(v: f64) -> bool {
    v.abs() >= TRUTH
}

impl Interp<'_> {
    /// A number, vector or colour: sums of products.
    pub fn expr(&mut self) -> Parsed<Num> {
        let mut left = self.product()?;
        loop {
            let op: fn(f64, f64) -> f64 = match self.peek_operator().t {
                T::Mark(b'+') => |a, b| a + b,
                T::Mark(b'-') => |a, b| a - b,
                _ => return Ok(left),
            };
            let at = self.bump().span;
            let is_image = self.image_factor == ImageFactor::May && self.begins_source();
            let right = if is_image { Num::float(1.0) } else { self.product()? };
            if is_image || matches!(self.image_factor, ImageFactor::Met(_)) {
                if left.len > 1 {
                    let d = Diagnostic::error("P0303", "only a number can be added to an image").at(at, "");
                    return Err(self.report(d));
                }
                self.image_factor = ImageFactor::Met(Some((left.v[0], at)));
                return Ok(right.map(|c| op(0.0, c)));
            }
            left = left.zip(right, op);
        }
    }

    fn product(&mut self) -> Parsed<Num> {
        let mut left = self.unary()?;
        loop {
            let tok = self.peek_operator();
            match tok.t {
                T::Mark(b'*') => {
                    self.bump();
                    if self.image_factor == ImageFactor::May && self.begins_source() {
                        self.image_factor = ImageFactor::Met(None);
                        return Ok(left);
                    }
                    let right = self.unary()?;
                    left = left.zip(right, |a, b| a * b);
                }
                T::Mark(b'/') => {
                    self.bump();
                    let at = self.peek().span;
                    let right = self.unary()?;
                    let zero = right.v.iter().take(usize::from(right.len)).any(|&c| c == 0.0);
                    if zero && left.len == 1 && right.len == 1 {
                        self.warn("P0302", at, "division by zero");
                    }
                    left = left.zip(right, |a, b| a / b);
                }
                _ => return Ok(left),
            }
        }
    }

    /// A value that operators have not been applied to, but for its sign.
    pub fn unary(&mut self) -> Parsed<Num> {
        let mut negative = false;
        loop {
            let tok = self.peek();
            match tok.t {
                T::Mark(b'-') => negative = !negative,
                T::Mark(b'+') => {}
                T::Mark(b'!') => {
                    self.bump();
                    let v = self.nested(tok.span, |s| s.unary())?;
                    return Ok(Num::float(if is_true(v.v[0]) { 0.0 } else { 1.0 }));
                }
                _ => break,
            }
            self.bump();
        }
        let v = self.primary()?;
        Ok(if negative { v.map(|c| -c) } else { v })
    }

    fn primary(&mut self) -> Parsed<Num> {
        let tok = self.peek();
        let value = match tok.t {
            T::Number(v) => {
                self.bump();
                if !v.is_finite() {
                    return Err(self.error("P0301", tok.span, "number is too large for double precision"));
                }
                Num::float(v)
            }
            T::Mark(b'(') => {
                self.bump();
                let v = self.nested(tok.span, |s| s.unheld(|s| s.condition()))?;
                self.expect(b')')?;
                v
            }
            T::Mark(b'<') => self.vector()?,
            T::Word(w) => self.word_value(w, tok)?,
            T::Name(name) => self.name_value(name, tok)?,
            _ => return Err(self.expected_not("a number, vector or colour", tok)),
        };
        self.components(value)
    }

    /// `.x`, `.red` and the like behind a value.
    fn components(&mut self, mut value: Num) -> Parsed<Num> {
        while self.peek_operator().t == T::Mark(b'.') {
            self.bump();
            let tok = self.peek();
            let index = match tok.t {
                T::Word(Word::X | Word::U | Word::Red) => 0,
                T::Word(Word::Y | Word::V | Word::Green) => 1,
                T::Word(Word::Z | Word::Blue) => 2,
                T::Word(Word::T | Word::Filter) => 3,
                T::Word(Word::Transmit) => 4,
                T::Word(Word::Gray) => {
                    self.bump();
                    let [r, g, b, ..] = value.five();
                    value = Num::float(0.297 * r + 0.589 * g + 0.114 * b);
                    continue;
                }
                _ => return Err(self.expected_not("a component such as `x` or `red`", tok)),
            };
            self.bump();
            value = Num::float(value.five().get(index).copied().unwrap_or(0.0));
        }
        Ok(value)
    }

    /// `< a, b, … >`, two to five components; commas may be left out.
    fn vector(&mut self) -> Parsed<Num> {
        let open = self.expect(b'<')?;
        let (v, len) = self.nested(open, |s| {
            s.unheld(|s| {
                let (mut v, mut len) = ([0.0; 5], 0usize);
                while s.peek().t != T::Mark(b'>') {
                    let at = s.peek().span;
                    let c = s.expr()?;
                    if !c.is_float() {
                        return Err(s.error("P0303", at, "vector component must be a number, found a vector"));
                    }
                    match v.get_mut(len) {
                        Some(slot) => *slot = c.v[0],
                        None => return Err(s.error("P0303", at, "vector has more than 5 components")),
                    }
                    len += 1;
                    s.comma();
                }
                Ok((v, len))
            })
        })?;
        let close = self.expect(b'>')?;
        if len < 2 {
            let message = format!("vector needs 2 to 5 components, found {len}");
            return Err(self.error("P0303", open.to(close), message));
        }
        Ok(Num {
            v,
            len: len as u8,
            is_color: false,
        })
    }

    /// The inside of parentheses: comparisons, logic and `?:`.
    pub fn condition(&mut self) -> Parsed<Num> {
        let test = self.logic()?;
        if !self.eat(b'?') {
            return Ok(test);
        }
        let at = self.here();
        self.nested(at, |s| {
            let yes = s.condition()?;
            s.expect(b':')?;
            let no = s.condition()?;
            Ok(if is_true(test.v[0]) { yes } else { no })
        })
    }

    fn logic(&mut self) -> Parsed<Num> {
        let mut left = self.comparison()?;
        loop {
            let tok = self.peek();
            let (T::Mark(b'&') | T::Mark(b'|')) = tok.t else {
                return Ok(left);
            };
            self.bump();
            let right = self.comparison()?;
            let (a, b) = (is_true(left.v[0]), is_true(right.v[0]));
            let both = tok.t == T::Mark(b'&');
            left = Num::float(f64::from(u8::from(if both { a && b } else { a || b })));
        }
    }

    fn comparison(&mut self) -> Parsed<Num> {
        // Strings compare too: `(A = "x")` reads as well as `(strcmp(A, "x") = 0)`.
        if self.starts_text() {
            return self.text_comparison();
        }
        let mut left = self.expr()?;
        loop {
            let T::Mark(mark) = self.peek().t else { return Ok(left) };
            let test: fn(f64, f64) -> bool = match mark {
                b'<' => |a, b| a < b && (a - b).abs() >= TRUTH,
                b'>' => |a, b| a > b && (a - b).abs() >= TRUTH,
                LE => |a, b| a <= b || (a - b).abs() < TRUTH,
                GE => |a, b| a >= b || (a - b).abs() < TRUTH,
                b'=' => |a, b| a == b || (a - b).abs() < TRUTH,
                NE => |a, b| !(a == b || (a - b).abs() < TRUTH),
                _ => return Ok(left),
            };
            self.bump();
            let right = self.expr()?;
            let n = usize::from(left.len.max(right.len));
            let (a, b) = (left.five(), right.five());
            let pairs = || a.iter().zip(&b).take(n);
            let holds = match mark {
                NE => pairs().any(|(a, b)| test(*a, *b)),
                _ => pairs().all(|(a, b)| test(*a, *b)),
            };
            left = Num::float(f64::from(u8::from(holds)));
        }
    }

    fn text_comparison(&mut self) -> Parsed<Num> {
        let left = self.text("left side")?;
        let tok = self.peek();
        let T::Mark(mark @ (b'=' | b'<' | b'>' | NE | LE | GE)) = tok.t else {
            return Err(self.expected_not("a comparison of strings", tok));
        };
        self.bump();
        let right = self.text("right side")?;
        let order = left.cmp(&right);
        let holds = match mark {
            b'=' => order.is_eq(),
            NE => order.is_ne(),
            b'<' => order.is_lt(),
            b'>' => order.is_gt(),
            LE => order.is_le(),
            _ => order.is_ge(),
        };
        Ok(Num::float(f64::from(u8::from(holds))))
    }

    /// A float.
    pub fn float(&mut self, what: &str) -> Parsed<f64> {
        let start = self.value_start(what, "a number")?;
        let v = self.expr()?;
        self.as_float(v, start, what)
    }

    /// A finite float.
    pub fn finite(&mut self, what: &str) -> Parsed<f64> {
        let start = self.value_start(what, "a number")?;
        let v = self.expr()?;
        let v = self.as_float(v, start, what)?;
        if !v.is_finite() {
            return Err(self.error("P0304", start, format!("{what} is not a finite number")));
        }
        Ok(v)
    }

    /// The place where a value begins; an error that names it if none does.
    fn value_start(&mut self, what: &str, kind: &str) -> Parsed<Span> {
        let tok = self.peek();
        let begins = match tok.t {
            T::Number(_) | T::Name(_) | T::Mark(b'(' | b'<' | b'+' | b'-' | b'!') => true,
            T::Word(w) => self.is_value_word(w),
            _ => false,
        };
        if begins {
            return Ok(tok.span);
        }
        Err(self.expected_not(&format!("the {what}, {kind}"), tok))
    }

    fn as_float(&mut self, v: Num, span: Span, what: &str) -> Parsed<f64> {
        if !v.is_float() {
            let found = if v.is_color { "a colour" } else { "a vector" };
            return Err(self.error("P0303", span, format!("{what} must be a number, found {found}")));
        }
        Ok(v.v[0])
    }

    /// A vector of three finite components; a float stands for all three.
    pub fn vec3(&mut self, what: &str) -> Parsed<DVec3> {
        let start = self.value_start(what, "a vector")?;
        let v = self.expr()?.xyz();
        if !v.is_finite() {
            return Err(self.error("P0304", start, format!("{what} is not finite")));
        }
        Ok(v)
    }

    /// Whether an expression starts here.
    pub fn starts_expr(&mut self) -> bool {
        match self.peek().t {
            T::Number(_) | T::Mark(b'(' | b'<' | b'+' | b'-' | b'!') => true,
            T::Word(w) => self.is_value_word(w),
            T::Name(n) => {
                matches!(
                    self.scopes.get(n),
                    Some(Value::Num(_) | Value::Function(_) | Value::Poison)
                ) || self.is_numeric_array(n)
            }
            _ => false,
        }
    }

    fn is_numeric_array(&self, name: Symbol) -> bool {
        match self.scopes.get(name) {
            Some(Value::Array(a)) => {
                let first = a.items.iter().flatten().next();
                matches!(first, Some(Value::Num(_))) && self.raw_is(1, b'[')
            }
            _ => false,
        }
    }

    fn name_value(&mut self, name: Symbol, tok: Tok) -> Parsed<Num> {
        match self.scopes.get(name) {
            Some(Value::Num(v)) => {
                let v = *v;
                self.bump();
                return Ok(v);
            }
            Some(Value::Function(f)) => {
                let f = f.clone();
                self.bump();
                return self.call_function(&f, tok.span);
            }
            None => return Err(self.undefined(tok)),
            _ => {}
        }
        match self.take_value()? {
            Value::Num(v) => Ok(v),
            Value::Poison => Err(self.poisoned()),
            other => {
                let message = format!("expected a number, vector or colour, found {}", other.kind());
                Err(self.error("P0303", tok.span, message))
            }
        }
    }
}
