//! `pigment { … }` and colour maps.

use super::pattern::is_pattern;
use super::transform::TRANSFORM_TEXTS;
use crate::lang::desc::{Desc, Pigment};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use glam::{DAffine3, DVec3};
use std::rc::Rc;

/// Words of a pigment, for suggestions.
const PIGMENT_TEXTS: &[&str] = &[
    "color",
    "rgb",
    "rgbf",
    "rgbt",
    "rgbft",
    "srgb",
    "checker",
    "brick",
    "hexagon",
    "gradient",
    "bozo",
    "granite",
    "marble",
    "wood",
    "agate",
    "leopard",
    "radial",
    "image_map",
    "color_map",
    "pigment_map",
    "turbulence",
];

impl Interp<'_> {
    /// A pigment, beginning with its word, from the default.
    pub fn pigment(&mut self) -> Parsed<Rc<Pigment>> {
        let base = self.default_layer().pigment.clone();
        self.pigment_over(base)
    }

    /// A pigment, beginning with its word, that changes another one.
    pub fn pigment_over(&mut self, base: Rc<Pigment>) -> Parsed<Rc<Pigment>> {
        if self.peek().t == T::Word(Word::ImageMap) {
            return self.pigment_items(b';', base); // `#declare P = image_map …` has no braces of its own
        }
        self.bump();
        self.block(|s| s.pigment_items(b'}', base))
    }

    /// The inside of a pigment up to the closing mark.
    pub(super) fn pigment_items(&mut self, close: u8, base: Rc<Pigment>) -> Parsed<Rc<Pigment>> {
        let mut base = base;
        let mut pattern = None;
        let mut colors: Vec<[f64; 5]> = Vec::new();
        let mut map: Option<Rc<Pigment>> = None;
        let mut image = None;
        let mut uv = false;
        let mut moved = DAffine3::IDENTITY;
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(m) if m == close => break,
                T::End | T::Mark(b'}') => break,
                T::Mark(b',') => {
                    self.bump();
                }
                T::Word(Word::Filter | Word::Transmit) if pattern.is_some() => {
                    if let T::Word(w) = tok.t {
                        self.pattern_modifier(w)?;
                    }
                }
                _ if self.starts_color() => colors.push(self.color()?),
                T::Word(Word::ColorMap | Word::PigmentMap | Word::DensityMap) => map = Some(self.map_block()?),
                T::Word(Word::Pigment | Word::Density) => colors.push(self.pigment()?.color),
                T::Word(Word::ImageMap) => {
                    pattern = Some(("image_map", tok.span));
                    image = self.image_map()?;
                }
                T::Word(Word::UvMapping) => {
                    self.bump();
                    uv = true;
                }
                T::Word(w) if is_pattern(w) => {
                    pattern = Some((w.text(), tok.span));
                    self.pattern(w)?;
                }
                T::Word(w) => {
                    if let Some(t) = self.transform_word(w)? {
                        moved = t * moved;
                    } else if !self.pattern_modifier(w)? {
                        let stop = self.unexpected("`pigment`", &[PIGMENT_TEXTS, TRANSFORM_TEXTS].concat(), tok);
                        return Err(stop);
                    }
                }
                T::Name(n) if self.scopes.get(n).is_some() => match self.take_value()? {
                    Value::Desc(Desc::Pigment(p) | Desc::Density(p)) => base = p,
                    Value::Desc(Desc::Map(p)) => map = Some(p),
                    Value::Num(v) => colors.push(v.five()),
                    Value::Poison => return Err(Stop),
                    other => {
                        let message = format!("expected a pigment or colour, found {}", other.kind());
                        return Err(self.error("P0303", tok.span, message));
                    }
                },
                T::Mark(b'<') => {
                    let d = crate::diag::Diagnostic::error("P0205", "a vector alone is no colour").at(tok.span, "");
                    return Err(self.report(d.hint("write `rgb` before it")));
                }
                _ => return Err(self.unexpected("`pigment`", PIGMENT_TEXTS, tok)),
            }
        }
        let color = match (&map, colors.as_slice()) {
            (Some(map), _) => map.color,
            (None, []) if pattern.is_some() => match pattern.map(|p| p.0) {
                Some("checker") => [0.0, 0.5, 0.5, 0.0, 0.0], // blue and green
                _ => [0.5, 0.5, 0.5, 0.0, 0.0],
            },
            (None, []) => {
                if base.image.is_some() && (uv || moved != DAffine3::IDENTITY) {
                    let base = Rc::make_mut(&mut base);
                    base.uv |= uv;
                    base.transform = moved * base.transform;
                }
                return Ok(base);
            }
            (None, [.., last]) if pattern.is_none() => *last,
            (None, all) => mean(all),
        };
        let pattern = pattern.or(map.and_then(|m| m.pattern));
        Ok(Rc::new(Pigment {
            color,
            pattern,
            image,
            uv,
            transform: moved,
            tint: DVec3::ONE,
        }))
    }

    /// `color_map { … }`, `pigment_map { … }` or `density_map { … }`, beginning with the word: the average over [0, 1].
    pub fn map_block(&mut self) -> Parsed<Rc<Pigment>> {
        let tok = self.bump();
        let of_pigments = tok.t != T::Word(Word::ColorMap);
        let mut entries: Vec<(f64, [f64; 5])> = Vec::new();
        let base = self.block(|s| {
            if let T::Name(_) = s.peek().t {
                return match s.take_value()? {
                    Value::Desc(Desc::Map(p)) => Ok(Some(p)),
                    Value::Poison => Err(Stop),
                    other => Err(s.error("P0303", tok.span, format!("expected a map, found {}", other.kind()))),
                };
            }
            while s.eat(b'[') {
                // `average` maps may leave the weight out.
                let numbered = matches!(s.peek().t, T::Number(_) | T::Mark(b'-' | b'(')) || !of_pigments;
                let at = if numbered || (s.starts_expr() && !s.starts_color()) {
                    s.float("place in the map")?
                } else {
                    entries.len() as f64
                };
                s.comma();
                if of_pigments {
                    let here = s.peek().span;
                    let base = s.default_layer().pigment.clone();
                    let p = s.nested(here, |s| s.pigment_items(b']', base))?;
                    entries.push((at, p.color));
                } else {
                    s.color_entry(at, &mut entries)?;
                }
                s.expect(b']')?;
                s.comma();
            }
            Ok(None)
        })?;
        if let Some(base) = base {
            return Ok(base);
        }
        if entries.is_empty() {
            return Err(self.error("P0311", tok.span, "map has no entries"));
        }
        let color = average(&entries);
        let name = match tok.t {
            T::Word(w) => w.text(),
            _ => "color_map",
        };
        let varies = entries.iter().any(|e| Some(&e.1) != entries.first().map(|f| &f.1));
        Ok(Rc::new(Pigment {
            pattern: varies.then_some((name, tok.span)),
            ..Pigment::plain(color)
        }))
    }

    /// `[at colour]`, `[from to colour colour]`.
    fn color_entry(&mut self, at: f64, entries: &mut Vec<(f64, [f64; 5])>) -> Parsed<()> {
        if self.starts_color() {
            entries.push((at, self.color()?));
            self.comma();
            return Ok(());
        }
        let v = self.expr()?;
        self.comma();
        if !v.is_float() {
            entries.push((at, v.five()));
            return Ok(());
        }
        if !self.starts_color() {
            entries.push((at, v.five())); // a number is a grey
            return Ok(());
        }
        entries.push((at, self.color()?));
        self.comma();
        entries.push((v.v[0], self.color()?));
        Ok(())
    }
}

fn mean(colors: &[[f64; 5]]) -> [f64; 5] {
    let mut sum = [0.0; 5];
    for c in colors {
        for (s, v) in sum.iter_mut().zip(c) {
            *s += v / colors.len() as f64;
        }
    }
    sum
}

/// Average over [0, 1] of a map that is linear between its entries and constant outside.
fn average(entries: &[(f64, [f64; 5])]) -> [f64; 5] {
    let mut sum = [0.0; 5];
    let (Some(first), Some(last)) = (entries.first(), entries.last()) else {
        return sum;
    };
    let mut add = |from: f64, to: f64, a: &[f64; 5], b: &[f64; 5]| {
        let width = to.clamp(0.0, 1.0) - from.clamp(0.0, 1.0);
        for (s, (a, b)) in sum.iter_mut().zip(a.iter().zip(b)) {
            *s += width.max(0.0) * 0.5 * (a + b);
        }
    };
    add(0.0, first.0, &first.1, &first.1);
    for pair in entries.windows(2) {
        if let [a, b] = pair {
            add(a.0, b.0, &a.1, &b.1);
        }
    }
    add(last.0, 1.0, &last.1, &last.1);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the integral of a piecewise linear function.
    #[test]
    fn the_average_of_a_map_is_its_integral() {
        let grey = |v: f64| [v, v, v, 0.0, 0.0];
        let map = [(0.25, grey(0.0)), (0.75, grey(1.0))];
        assert!((average(&map)[0] - 0.5).abs() < 1e-15);
        let step = [(0.0, grey(1.0)), (0.5, grey(1.0)), (0.5, grey(0.0)), (1.0, grey(0.0))];
        assert!((average(&step)[0] - 0.5).abs() < 1e-15);
    }
}
