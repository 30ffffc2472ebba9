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

/// Indices of violet and red that differ by more than this ratio are no material.
const LEAST_DISPERSION: f64 = 0.1;

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
                if w == Word::Media {
                    i.media.push(s.media()?);
                    continue;
                }
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
                    Word::Absorption => i.absorption = s.coefficient("absorption")?,
                    Word::Dispersion => {
                        let at = s.peek().span;
                        i.dispersion = Some((s.within("dispersion", LEAST_DISPERSION, 1.0 / LEAST_DISPERSION)?, at));
                    }
                    Word::Caustics | Word::DispersionSamples | Word::Refraction => s.skip_arguments()?,
                    _ => return Err(s.unexpected("`interior`", INTERIOR_TEXTS, tok)),
                }
            }
        })
    }
}
