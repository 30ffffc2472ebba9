//! Words that are values: constants, and the functions of numbers, vectors and strings.

use super::colors::COLOR_WORDS;
use super::expr::is_true;
use super::{Interp, Num, Parsed, Tok, Value};
use crate::diag::Span;
use crate::lang::syntax::{Symbol, Word};
use std::sync::atomic::Ordering;

const TRUE: f64 = 1.0;

impl Interp<'_> {
    /// Whether a word begins a number, vector or colour.
    pub fn is_value_word(&self, w: Word) -> bool {
        use Word::*;
        constant(w).is_some()
            || COLOR_WORDS.contains(&w)
            || matches!(
                w,
                Clock
                    | ClockDelta
                    | ClockOn
                    | FrameNumber
                    | InitialFrame
                    | FinalFrame
                    | InitialClock
                    | FinalClock
                    | ImageWidth
                    | ImageHeight
                    | Version
                    | Now
                    | Abs
                    | Acos
                    | Acosh
                    | Asc
                    | Asin
                    | Asinh
                    | Atan
                    | Atan2
                    | Atanh
                    | Ceil
                    | Cos
                    | Cosh
                    | Defined
                    | Degrees
                    | DimensionSize
                    | Dimensions
                    | Div
                    | Exp
                    | FileExists
                    | Floor
                    | Int
                    | Ln
                    | Log
                    | Max
                    | Min
                    | Mod
                    | Pow
                    | Radians
                    | Rand
                    | Seed
                    | Select
                    | Sin
                    | Sinh
                    | Sqrt
                    | Strcmp
                    | Strlen
                    | Tan
                    | Tanh
                    | Val
                    | Vdot
                    | Vlength
                    | Vnormalize
                    | Vcross
                    | Vrotate
                    | VaxisRotate
                    | Sqr
                    | Sum
                    | Prod
                    | Trace
                    | Inside
                    | MinExtent
                    | MaxExtent
                    | Vturbulence
            )
    }

    /// The value of a word that is one.
    pub fn word_value(&mut self, w: Word, tok: Tok) -> Parsed<Num> {
        if self.functions_open > 0
            && matches!(w, Word::X | Word::Y | Word::Z | Word::U | Word::V | Word::T)
            && let Some(Value::Num(v)) = self.scopes.get(Symbol(w as u32))
        {
            let v = *v;
            self.bump();
            return Ok(v);
        }
        if let Some(v) = constant(w) {
            self.bump();
            return Ok(v);
        }
        if COLOR_WORDS.contains(&w) {
            return self.nested(tok.span, |s| s.color_value());
        }
        let variable = match w {
            Word::Clock => {
                self.options.clock_read.store(true, Ordering::Relaxed);
                self.options.clock
            }
            Word::FinalClock
            | Word::ClockOn
            | Word::ClockDelta
            | Word::FrameNumber
            | Word::InitialFrame
            | Word::FinalFrame
            | Word::InitialClock => self.animation_value(w),
            Word::Now => 0.0, // a scene must not depend on the day it is rendered
            Word::Version => self.version,
            Word::ImageWidth | Word::ImageHeight => {
                self.size_used.get_or_insert(tok.span);
                let [width, height] = self.resolution();
                f64::from(if w == Word::ImageWidth { width } else { height })
            }
            _ if self.is_value_word(w) => return self.call_builtin(w, tok),
            _ => return Err(self.expected_not("a number, vector or colour", tok)),
        };
        self.bump();
        Ok(Num::float(variable))
    }

    /// What a scene may know of the animation that it is in; the same for all moments at which the shutter is open.
    fn animation_value(&self, w: Word) -> f64 {
        let Some(frame) = self.options.frame else {
            let clock = self.options.opening.unwrap_or(self.options.clock);
            return match w {
                Word::FinalClock | Word::ClockOn => f64::from(u8::from(clock != 0.0)),
                _ => 0.0,
            };
        };
        match w {
            Word::ClockOn => 1.0,
            Word::ClockDelta => frame.delta,
            Word::FrameNumber => f64::from(frame.number),
            Word::InitialFrame => f64::from(frame.frames[0]),
            Word::FinalFrame => f64::from(frame.frames[1]),
            Word::InitialClock => frame.clocks[0],
            _ => frame.clocks[1],
        }
    }

    /// Width and height of the image as far as known: the command line's, the scene's so far, or 800×600.
    pub fn resolution(&self) -> [u32; 2] {
        let [width, height] = self.scene.defaults.resolution.unwrap_or([800, 600]);
        [
            self.options.width.unwrap_or(width),
            self.options.height.unwrap_or(height),
        ]
    }

    fn call_builtin(&mut self, w: Word, tok: Tok) -> Parsed<Num> {
        self.bump();
        if w == Word::Defined {
            return Ok(Num::float(f64::from(u8::from(self.defined_test()?))));
        }
        self.expect(b'(')?;
        let result = self.nested(tok.span, |s| s.unheld(|s| s.builtin(w, tok.span)))?;
        self.expect(b')')?;
        Ok(result)
    }

    fn builtin(&mut self, w: Word, span: Span) -> Parsed<Num> {
        use Word::*;
        match w {
            Vlength | Vnormalize | Vcross | Vdot | Vrotate | VaxisRotate => return self.vector_function(w, span),
            Strlen => {
                let text = self.text("argument of `strlen`")?;
                return Ok(Num::float(text.chars().count() as f64));
            }
            Strcmp => {
                let a = self.text("first argument of `strcmp`")?;
                self.comma();
                let b = self.text("second argument of `strcmp`")?;
                return Ok(Num::float(f64::from(a.cmp(&b) as i8)));
            }
            Asc => {
                let text = self.text("argument of `asc`")?;
                return Ok(Num::float(text.chars().next().map_or(0.0, |c| f64::from(u32::from(c)))));
            }
            Val => {
                let text = self.text("argument of `val`")?;
                return match text.trim().parse::<f64>() {
                    Ok(v) => Ok(Num::float(v)),
                    Err(_) => Err(self.error(
                        "P0306",
                        span,
                        format!("`val` needs a number in its string, found \"{text}\""),
                    )),
                };
            }
            FileExists => {
                let name = self.text("file name")?;
                let found = self.files.exists(&self.scene_dir.join(&*name));
                return Ok(Num::float(f64::from(u8::from(found))));
            }
            DimensionSize | Dimensions => return self.array_function(w, span),
            Min | Max => {
                let mut v = self.float("argument")?;
                while self.eat(b',') {
                    let other = self.float("argument")?;
                    v = if w == Min { v.min(other) } else { v.max(other) };
                }
                return Ok(Num::float(v));
            }
            Select => {
                let test = self.float("first argument of `select`")?;
                let mut rest = Vec::new();
                while self.eat(b',') && rest.len() < 3 {
                    rest.push(self.expr()?);
                }
                let index = if test < 0.0 {
                    0
                } else if test == 0.0 || rest.len() < 3 {
                    1
                } else {
                    2
                };
                return match rest.get(index) {
                    Some(v) if rest.len() >= 2 => Ok(*v),
                    _ => Err(self.error("P0306", span, "`select` needs 3 or 4 arguments")),
                };
            }
            Vturbulence => {
                self.skip_arguments()?;
                self.warn_once("P0409", span, "`vturbulence` is not supported yet and is taken as 0");
                return Ok(Num::vec3(glam::DVec3::ZERO));
            }
            MinExtent | MaxExtent => {
                let [min, max] = self.extent(span)?;
                return Ok(Num::vec3(if w == MinExtent { min } else { max }));
            }
            Trace | Inside | Sum | Prod => {
                let message = format!("`{}` is not supported yet", w.text());
                return Err(self.error("P0404", span, message));
            }
            _ => {}
        }
        let a = self.float(&format!("argument of `{}`", w.text()))?;
        let mut b = 0.0;
        if matches!(w, Atan2 | Div | Mod | Pow) {
            self.comma();
            b = self.float(&format!("second argument of `{}`", w.text()))?;
        }
        let v = match w {
            Abs => a.abs(),
            Acos => a.acos(),
            Acosh => a.acosh(),
            Asin => a.asin(),
            Asinh => a.asinh(),
            Atan => a.atan(),
            Atan2 => a.atan2(b),
            Atanh => a.atanh(),
            Ceil => a.ceil(),
            Cos => a.cos(),
            Cosh => a.cosh(),
            Degrees => a.to_degrees(),
            Div => (a / b).trunc(),
            Exp => a.exp(),
            Floor => a.floor(),
            Int => a.trunc(),
            Ln => a.ln(),
            Log => a.log10(),
            Mod => a % b,
            Pow => a.powf(b),
            Radians => a.to_radians(),
            Seed => self.new_generator(a),
            Rand => match self.next_random(a) {
                Some(v) => v,
                None => return Err(self.error("P0306", span, "`rand` needs a sequence made by `seed`")),
            },
            Sin => a.sin(),
            Sinh => a.sinh(),
            Sqr => a * a,
            Sqrt => a.sqrt(),
            Tan => a.tan(),
            Tanh => a.tanh(),
            _ => a,
        };
        if v.is_nan() && !a.is_nan() && !b.is_nan() {
            let list = if matches!(w, Atan2 | Div | Mod | Pow) {
                format!("{a}, {b}")
            } else {
                format!("{a}")
            };
            return Err(self.error("P0306", span, format!("`{}({list})` has no value", w.text())));
        }
        Ok(Num::float(v))
    }

    /// `(condition)` of a directive.
    pub fn directive_condition(&mut self) -> Parsed<bool> {
        self.expect(b'(')?;
        let at = self.here();
        let v = self.nested(at, |s| s.unheld(|s| s.condition()))?;
        self.expect(b')')?;
        Ok(is_true(v.v[0]))
    }
}

fn constant(w: Word) -> Option<Num> {
    let unit = |i: usize, len: u8| {
        let mut v = [0.0; 5];
        v[i] = 1.0;
        Num {
            v,
            len,
            is_color: false,
        }
    };
    Some(match w {
        Word::X => unit(0, 3),
        Word::Y => unit(1, 3),
        Word::Z => unit(2, 3),
        Word::U => unit(0, 2),
        Word::V => unit(1, 2),
        Word::T => unit(3, 4),
        Word::Pi => Num::float(std::f64::consts::PI),
        Word::True | Word::Yes | Word::On => Num::float(TRUE),
        Word::False | Word::No | Word::Off => Num::float(0.0),
        _ => return None,
    })
}
