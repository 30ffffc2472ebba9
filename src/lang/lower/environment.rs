//! `background`, `sky_sphere` and `environment`.

use super::transform::TRANSFORM_TEXTS;
use crate::lang::desc::{Desc, Pigment, SkyDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use glam::DVec3;
use std::path::PathBuf;
use std::rc::Rc;

impl Interp<'_> {
    /// `background { colour }` at the top level.
    pub fn background(&mut self) -> Parsed<()> {
        let span = self.bump().span;
        let [r, g, b, ..] = self.block(|s| s.color())?;
        self.scene.background = Some((SkyDesc::Color(DVec3::new(r, g, b), None), span));
        Ok(())
    }

    /// `sky_sphere { … }` at the top level.
    pub fn sky_sphere_item(&mut self) -> Parsed<()> {
        let span = self.peek().span;
        let sky = self.sky_sphere()?;
        let [r, g, b, ..] = sky.color;
        self.scene.sky_sphere = Some((SkyDesc::Color(DVec3::new(r, g, b), sky.pattern), span));
        Ok(())
    }

    /// A sky sphere, beginning with its word: the average of its pigments, upper layers over lower ones.
    pub fn sky_sphere(&mut self) -> Parsed<Rc<Pigment>> {
        self.bump();
        self.block(|s| {
            let mut sky = Pigment::plain([0.0; 5]);
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => return Ok(Rc::new(sky)),
                    T::Word(Word::Pigment) => {
                        let over = s.pigment()?;
                        let [.., f, t] = over.color;
                        let cover = (1.0 - f - t).clamp(0.0, 1.0);
                        for (below, above) in sky.color.iter_mut().zip(over.color).take(3) {
                            *below = cover * above + *below * (t + f * above).clamp(0.0, 1.0);
                        }
                        sky.pattern = sky.pattern.or(over.pattern);
                    }
                    T::Word(Word::Emission) => {
                        s.bump();
                        s.color()?;
                    }
                    T::Name(n) if s.scopes.get(n).is_some() => match s.take_value()? {
                        Value::Desc(Desc::Sky(named)) => sky = (*named).clone(),
                        Value::Poison => return Err(Stop),
                        other => {
                            let message = format!("expected a sky sphere, found {}", other.kind());
                            return Err(s.error("P0303", tok.span, message));
                        }
                    },
                    T::Word(w) => {
                        if s.transform_word(w)?.is_none() {
                            let texts = [&["pigment"], TRANSFORM_TEXTS].concat();
                            return Err(s.unexpected("`sky_sphere`", &texts, tok));
                        }
                    }
                    _ => return Err(s.unexpected("`sky_sphere`", &["pigment"], tok)),
                }
            }
        })
    }

    /// `environment { color C }` or `environment { image "file" strength s rotate v }`.
    pub fn environment(&mut self) -> Parsed<()> {
        const TEXTS: &[&str] = &["color", "rgb", "image", "strength", "rotate"];
        let span = self.bump().span;
        let sky = self.block(|s| {
            let (mut color, mut image, mut strength, mut rotate) = (None, None, 1.0, DVec3::ZERO);
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => break,
                    T::Mark(b',') => {
                        s.bump();
                    }
                    T::Word(Word::Image) => {
                        s.bump();
                        let at = s.peek().span;
                        let name = s.text("the image's file")?;
                        image = match s.locate(&name, at, &[""])? {
                            Some(path) => Some(Ok(path)),
                            None => Some(Err((PathBuf::from(&*name), s.missing(&name, at)))),
                        };
                    }
                    T::Word(Word::Strength) => {
                        s.bump();
                        strength = s.within("strength", 0.0, f64::MAX)?;
                    }
                    T::Word(Word::Rotate) => {
                        s.bump();
                        rotate = s.vec3("rotation")?;
                    }
                    _ if s.starts_color() => {
                        let [r, g, b, ..] = s.color()?;
                        color = Some(DVec3::new(r, g, b));
                    }
                    _ => return Err(s.unexpected("`environment`", TEXTS, tok)),
                }
            }
            let image = match image {
                // Of no strength it is not needed.
                Some(Err((path, _))) if strength == 0.0 => Some(path),
                Some(Err((_, missing))) => return Err(s.report(missing)),
                Some(Ok(path)) => Some(path),
                None => None,
            };
            match (image, color) {
                (Some(path), _) => Ok(SkyDesc::Image { path, strength, rotate }),
                (None, Some(color)) => Ok(SkyDesc::Color(color * strength, None)),
                (None, None) => Err(s.error("P0316", span, "`environment` needs `color` or `image`")),
            }
        })?;
        self.scene.environment = Some((sky, span));
        Ok(())
    }
}
