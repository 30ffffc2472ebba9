//! Colours as values: `rgb`, `rgbf`, `srgb`, `color red r green g`, and components behind them.

use super::{Interp, Num, Parsed, T, Value};
use crate::lang::syntax::Word;
use crate::math::color::linear_from_srgb;

/// Words that begin a colour.
pub const COLOR_WORDS: &[Word] = &[
    Word::Color,
    Word::Rgb,
    Word::Rgbf,
    Word::Rgbt,
    Word::Rgbft,
    Word::Srgb,
    Word::Srgbf,
    Word::Srgbt,
    Word::Srgbft,
    Word::Red,
    Word::Green,
    Word::Blue,
    Word::Filter,
    Word::Transmit,
    Word::Alpha,
];

impl Interp<'_> {
    /// A colour, with or without a colour keyword: `rgb <1, 0, 0>`, `Red`, `color Red filter 0.5`.
    pub fn color(&mut self) -> Parsed<[f64; 5]> {
        let start = self.peek().span;
        if let T::Word(w) = self.peek().t
            && COLOR_WORDS.contains(&w)
        {
            let c = self.color_value()?;
            return self.finite_color(c.v, start);
        }
        let v = self.expr()?;
        let v = self.color_parts(v.five())?;
        self.finite_color(v, start)
    }

    fn finite_color(&mut self, v: [f64; 5], span: crate::diag::Span) -> Parsed<[f64; 5]> {
        if v.iter().any(|c| !c.is_finite()) {
            return Err(self.error("P0304", span, "colour is not finite"));
        }
        Ok(v)
    }

    /// A colour that begins with a colour word.
    pub fn color_value(&mut self) -> Parsed<Num> {
        self.eat_word(Word::Color);
        let mut v = [0.0; 5];
        let tok = self.peek();
        if let T::Word(w) = tok.t {
            // Positions of the components that follow, and whether they are display values.
            let layout: Option<(&[usize], bool)> = match w {
                Word::Rgb => Some((&[0, 1, 2], false)),
                Word::Rgbf => Some((&[0, 1, 2, 3], false)),
                Word::Rgbt => Some((&[0, 1, 2, 4], false)),
                Word::Rgbft => Some((&[0, 1, 2, 3, 4], false)),
                Word::Srgb => Some((&[0, 1, 2], true)),
                Word::Srgbf => Some((&[0, 1, 2, 3], true)),
                Word::Srgbt => Some((&[0, 1, 2, 4], true)),
                Word::Srgbft => Some((&[0, 1, 2, 3, 4], true)),
                _ => None,
            };
            if let Some((positions, display)) = layout {
                self.bump();
                let value = self.expr()?.five();
                for (&position, c) in positions.iter().zip(value) {
                    v[position] = c;
                }
                if display {
                    for c in v.iter_mut().take(3) {
                        *c = self.working_from_linear(linear_from_srgb(*c));
                    }
                }
                return Ok(Num::color(self.color_parts(v)?));
            }
            if !is_part(w) {
                v = self.expr()?.five();
            }
        } else {
            v = self.expr()?.five();
        }
        Ok(Num::color(self.color_parts(v)?))
    }

    /// `red 0.5`, `filter 0.7`, … behind a colour.
    fn color_parts(&mut self, mut v: [f64; 5]) -> Parsed<[f64; 5]> {
        loop {
            let tok = self.peek_operator();
            let index = match tok.t {
                T::Word(Word::Red) => 0,
                T::Word(Word::Green) => 1,
                T::Word(Word::Blue) => 2,
                T::Word(Word::Filter | Word::Alpha) => 3,
                T::Word(Word::Transmit) if !self.colors_end_at_transmit => 4,
                // `color Red rgb …` does not exist, but `color rgb Red` followed by a colour identifier does not either.
                _ => return Ok(v),
            };
            self.bump();
            v[index] = self.float("colour component")?;
        }
    }

    /// Whether a colour starts here.
    pub fn starts_color(&mut self) -> bool {
        match self.peek().t {
            T::Word(w) => COLOR_WORDS.contains(&w),
            T::Name(n) => match self.scopes.get(n) {
                Some(Value::Num(v)) => v.is_color || v.len >= 3,
                Some(Value::Array(a)) => matches!(a.items.iter().flatten().next(), Some(Value::Num(_))),
                _ => false,
            },
            _ => false,
        }
    }
}

fn is_part(w: Word) -> bool {
    use Word::*;
    matches!(w, Red | Green | Blue | Filter | Transmit | Alpha)
}
