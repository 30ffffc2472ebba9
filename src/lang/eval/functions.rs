//! Words that are values: constants, and the functions of numbers, vectors and strings.

use super::colors::COLOR_WORDS;
use super::expr::is_true;
use super::stream::FrameKind;
use super::{Function, Interp, Num, Parsed, T, Tok, Value};
use crate::diag::Span;
use crate::lang::syntax::{Symbol, Word};
use crate::lang::transform::{rotate_about, rotation_deg};
use std::rc::Rc;

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
            Word::Clock => self.options.clock,
            Word::FinalClock | Word::ClockOn => f64::from(u8::from(self.options.clock != 0.0)),
            Word::ClockDelta | Word::FrameNumber | Word::InitialFrame | Word::FinalFrame | Word::InitialClock => 0.0,
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

    fn vector_function(&mut self, w: Word, span: Span) -> Parsed<Num> {
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

    fn array_function(&mut self, w: Word, span: Span) -> Parsed<Num> {
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

    /// `function (a, b) { … }`, behind the word.
    pub fn function(&mut self) -> Parsed<Value> {
        let mut params = Vec::new();
        if self.eat(b'(') {
            while self.peek().t != T::Mark(b')') {
                let tok = self.peek();
                match tok.t {
                    T::Name(n) => params.push(n),
                    T::Word(w) => params.push(Symbol(w as u32)),
                    _ => return Err(self.expected_not("a parameter name", tok)),
                }
                self.bump();
                self.comma();
            }
            self.bump();
        } else {
            params.extend([Word::X, Word::Y, Word::Z].map(|w| Symbol(w as u32)));
        }
        // `function { … }` with an image size in front is a pattern made of values.
        while self.starts_expr() {
            self.expr()?;
            self.comma();
        }
        let open = self.peek();
        if open.t != T::Mark(b'{') {
            return Err(self.expected_not("`{`", open));
        }
        let Some((file, start)) = self.frame().map(|f| (f.file.clone(), f.pos + 1)) else {
            return Err(super::Stop);
        };
        let level = self.level();
        let mut is_expression = true;
        let mut end = start;
        self.block(|s| {
            is_expression = match s.peek().t {
                T::Word(w) => s.is_value_word(w),
                _ => true,
            };
            let depth = s.depth();
            while !(s.peek().t == T::Mark(b'}') && s.depth() == depth) && s.peek().t != T::End {
                s.bump();
            }
            end = s.frame().map_or(start, |f| f.pos);
            Ok(())
        })?;
        if self.level() != level {
            is_expression = false;
        }
        Ok(Value::Function(Rc::new(Function {
            params,
            file,
            start,
            end,
            is_expression,
        })))
    }

    /// The value of a declared function, whose name has been taken.
    pub fn call_function(&mut self, f: &Rc<Function>, span: Span) -> Parsed<Num> {
        let mut args = Vec::new();
        if self.peek().t != T::Mark(b'(') {
            return Err(self.expected("`(` and the arguments of the function"));
        }
        self.bump();
        self.nested(span, |s| {
            s.unheld(|s| {
                while s.peek().t != T::Mark(b')') && args.len() < 56 {
                    args.push(s.expr()?);
                    s.comma();
                }
                Ok(())
            })
        })?;
        self.expect(b')')?;
        if !f.is_expression {
            return Err(self.error(
                "P0404",
                span,
                "functions of pigments and patterns are not supported yet",
            ));
        }
        if let [Num { len: 3, v, .. }] = args.as_slice()
            && f.params.len() == 3
        {
            args = v.iter().take(3).map(|&c| Num::float(c)).collect();
        }
        if args.len() != f.params.len() {
            let message = format!("function takes {} arguments, found {}", f.params.len(), args.len());
            return Err(self.error("P0306", span, message));
        }
        self.nested(span, |s| {
            let level = s.level();
            let scope = s.push_frame(f.file.clone(), (f.start, f.end), FrameKind::Function, Some(span))?;
            for (&name, arg) in f.params.iter().zip(args) {
                s.scopes.set(super::scope::Place { scope, name }, Value::Num(arg));
            }
            s.functions_open += 1;
            let result = s.floored(|s| s.unheld(|s| s.condition()));
            s.functions_open -= 1;
            while s.level() > level {
                s.pop_frame();
            }
            result
        })
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
