//! Functions that the scene declares: their body's tokens are run like a macro's, with numbers for parameters.

use super::scope::Place;
use super::stream::FrameKind;
use super::{Function, Interp, Num, Parsed, Stop, T, Value};
use crate::diag::Span;
use crate::lang::syntax::{Symbol, Word};
use std::rc::Rc;

impl Interp<'_> {
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
            return Err(Stop);
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
                s.scopes.set(Place { scope, name }, Value::Num(arg));
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
}
