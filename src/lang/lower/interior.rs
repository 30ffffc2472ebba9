//! `interior { … }`.

use crate::lang::desc::{Desc, InteriorDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use glam::DVec3;
use std::rc::Rc;

const INTERIOR_TEXTS: &[&str] = &[
    "ior",
    "caustics",
    "dispersion",
    "dispersion_samples",
    "fade_distance",
    "fade_power",
    "fade_color",
    "absorption",
    "media",
];

impl Interp<'_> {
    /// An interior, beginning with its word.
    pub fn interior(&mut self) -> Parsed<Rc<InteriorDesc>> {
        self.interior_over(Rc::default())
    }

    /// An interior, beginning with its word, that changes another one.
    pub fn interior_over(&mut self, base: Rc<InteriorDesc>) -> Parsed<Rc<InteriorDesc>> {
        self.bump();
        self.block(|s| {
            let mut i = (*base).clone();
            loop {
                let tok = s.peek_item();
                let w = match tok.t {
                    T::Mark(b'}') | T::End => return Ok(Rc::new(i)),
                    T::Mark(b',') => {
                        s.bump();
                        continue;
                    }
                    T::Name(n) if s.scopes.get(n).is_some() => {
                        match s.take_value()? {
                            Value::Desc(Desc::Interior(named)) => i = (*named).clone(),
                            Value::Poison => return Err(Stop),
                            other => {
                                let message = format!("expected an interior, found {}", other.kind());
                                return Err(s.error("P0303", tok.span, message));
                            }
                        }
                        continue;
                    }
                    T::Word(w) => w,
                    _ => return Err(s.unexpected("`interior`", INTERIOR_TEXTS, tok)),
                };
                s.bump();
                match w {
                    Word::Ior => {
                        let at = s.peek().span;
                        let ior = s.finite("ior")?;
                        if ior <= 0.0 {
                            return Err(s.error("P0311", at, format!("ior must be positive, found {ior}")));
                        }
                        i.ior = Some(ior);
                    }
                    Word::FadeDistance => i.fade_distance = Some(s.finite("fade_distance")?),
                    Word::FadePower => i.fade_power = Some(s.finite("fade_power")?),
                    Word::FadeColor => {
                        let [r, g, b, ..] = s.color()?;
                        i.fade_color = DVec3::new(r, g, b);
                    }
                    Word::Absorption => i.absorption = s.absorption()?,
                    Word::Media => s.interior_media(&mut i, tok.span)?,
                    Word::Caustics | Word::Dispersion | Word::DispersionSamples | Word::Refraction => {
                        s.skip_arguments()?
                    }
                    _ => return Err(s.unexpected("`interior`", INTERIOR_TEXTS, tok)),
                }
            }
        })
    }

    /// An absorption coefficient per channel and unit length, ≥ 0.
    pub fn absorption(&mut self) -> Parsed<DVec3> {
        let at = self.peek().span;
        let [r, g, b, ..] = self.color()?;
        let v = DVec3::new(r, g, b);
        if v.min_element() < 0.0 {
            return Err(self.error("P0311", at, "absorption must not be negative"));
        }
        Ok(v)
    }

    /// Pure absorption is exact; everything else of a medium is told and left out where it is drawn.
    fn interior_media(&mut self, i: &mut InteriorDesc, span: crate::diag::Span) -> Parsed<()> {
        self.block(|s| {
            let depth = s.depth();
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::End => return Ok(()),
                    T::Mark(b'}') if s.depth() == depth => return Ok(()),
                    T::Word(Word::Absorption) => {
                        s.bump();
                        i.absorption += s.absorption()?;
                    }
                    T::Word(Word::Emission | Word::Scattering | Word::Density) | T::Name(_) => {
                        i.media = Some(span);
                        s.bump();
                    }
                    T::Mark(b'{') => s.skip_block()?,
                    _ => {
                        s.bump();
                    }
                }
            }
        })
    }
}
