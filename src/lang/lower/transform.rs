//! `translate`, `rotate`, `scale`, `matrix`, `transform`.

use crate::lang::desc::Desc;
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::lang::transform::{is_invertible, rotation_deg};
use glam::{DAffine3, DMat3, DVec3};

impl Interp<'_> {
    /// A transform that begins with this word, which comes next; `None` if the word begins none.
    pub fn transform_word(&mut self, w: Word) -> Parsed<Option<DAffine3>> {
        let t = match w {
            Word::Translate => {
                self.bump();
                DAffine3::from_translation(self.vec3("translation")?)
            }
            Word::Rotate => {
                self.bump();
                DAffine3::from_mat3(rotation_deg(self.vec3("rotation")?))
            }
            Word::Scale => {
                self.bump();
                let at = self.peek().span;
                let mut v = self.vec3("scale")?;
                if v.cmpeq(DVec3::ZERO).any() {
                    // Scenes write `scale 2*x` and mean "twice as wide"; POV-Ray forgives it too.
                    self.moved(at, "scale by 0 is read as 1");
                    v = DVec3::select(v.cmpeq(DVec3::ZERO), DVec3::ONE, v);
                }
                DAffine3::from_scale(v)
            }
            Word::Matrix => self.matrix()?,
            Word::Transform => {
                self.bump();
                if self.peek().t == T::Mark(b'{') {
                    self.transform_body()?
                } else {
                    self.named_transform()?
                }
            }
            _ => return Ok(None),
        };
        Ok(Some(t))
    }

    /// `transform { … }` as a value.
    pub fn transform_block(&mut self) -> Parsed<DAffine3> {
        self.bump();
        self.transform_body()
    }

    fn transform_body(&mut self) -> Parsed<DAffine3> {
        self.block(|s| {
            let mut t = DAffine3::IDENTITY;
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => return Ok(t),
                    T::Word(Word::Inverse) => {
                        s.bump();
                        t = t.inverse();
                    }
                    T::Name(_) => t = s.named_transform()? * t,
                    T::Mark(b',') => {
                        s.bump();
                    }
                    T::Word(w) => match s.transform_word(w)? {
                        Some(next) => t = next * t,
                        None => return Err(s.unexpected("`transform`", TRANSFORM_TEXTS, tok)),
                    },
                    _ => return Err(s.unexpected("`transform`", TRANSFORM_TEXTS, tok)),
                }
            }
        })
    }

    fn named_transform(&mut self) -> Parsed<DAffine3> {
        let tok = self.peek();
        match self.take_value()? {
            Value::Desc(Desc::Transform(t)) => Ok(t),
            Value::Poison => Err(Stop),
            other => Err(self.error(
                "P0303",
                tok.span,
                format!("expected a transform, found {}", other.kind()),
            )),
        }
    }

    /// Twelve numbers, row by row; points are rows, the last row is the translation.
    fn matrix(&mut self) -> Parsed<DAffine3> {
        let start = self.bump().span;
        self.expect(b'<')?;
        let mut m = [0.0; 12];
        for slot in &mut m {
            *slot = self.nested(start, |s| s.unheld(|s| s.finite("matrix element")))?;
            self.comma();
        }
        let close = self.expect(b'>')?;
        let row = |i: usize| DVec3::new(m[3 * i], m[3 * i + 1], m[3 * i + 2]);
        let t = DAffine3::from_mat3_translation(DMat3::from_cols(row(0), row(1), row(2)), row(3));
        if !is_invertible(&t) {
            return Err(self.error(
                "P0310",
                start.to(close),
                "matrix is singular: it flattens what it is applied to",
            ));
        }
        Ok(t)
    }
}

/// Words of a transform.
pub const TRANSFORM_TEXTS: &[&str] = &["translate", "rotate", "scale", "matrix", "transform", "inverse"];
