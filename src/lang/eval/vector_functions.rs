//! Functions of vectors and arrays.

use super::{Interp, Num, Parsed, Value};
use crate::diag::Span;
use crate::lang::syntax::Word;
use crate::lang::transform::{rotate_about, rotation_deg};

impl Interp<'_> {
    /// Functions whose first argument is a vector.
    pub fn vector_function(&mut self, w: Word, span: Span) -> Parsed<Num> {
        let a = self.expr()?.xyz();
        if w == Word::Vlength {
            return Ok(Num::float(a.length()));
        }
        if w == Word::Vnormalize {
            let scaled = a / a.abs().max_element(); // squares of tiny components would vanish
            let unit = if a == glam::DVec3::ZERO {
                a
            } else {
                scaled.normalize_or_zero()
            };
            return Ok(Num::vec3(unit));
        }
        self.comma();
        let b = self.expr()?.xyz();
        Ok(match w {
            Word::Vdot => Num::float(a.dot(b)),
            Word::Vcross => Num::vec3(a.cross(b)),
            Word::Vrotate => Num::vec3(rotation_deg(b) * a),
            _ => {
                self.comma();
                let angle = self.float("angle")?;
                match rotate_about(b, angle) {
                    Some(m) => Num::vec3(m * a),
                    None => return Err(self.error("P0306", span, "axis of `vaxis_rotate` must not be 0")),
                }
            }
        })
    }

    /// `dimension_size` and `dimensions`.
    pub fn array_function(&mut self, w: Word, span: Span) -> Parsed<Num> {
        let Value::Array(array) = self.take_value()? else {
            return Err(self.error("P0303", span, format!("`{}` needs an array", w.text())));
        };
        if w == Word::Dimensions {
            return Ok(Num::float(array.dims.len() as f64));
        }
        let mut k = 1.0;
        if self.eat(b',') {
            k = self.float("dimension")?;
        }
        let size = (k >= 1.0).then(|| array.dims.get(k as usize - 1)).flatten();
        match size {
            Some(&n) => Ok(Num::float(n as f64)),
            None => {
                let message = format!("array has {} dimensions, asked for number {k}", array.dims.len());
                Err(self.error("P0305", span, message))
            }
        }
    }
}
