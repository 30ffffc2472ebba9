//! Macros: definition, and calls that run the body's tokens in place.

use super::scope::Place;
use super::stream::FrameKind;
use super::{Interp, MAX_CALLS, Macro, Parsed, T, Value};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::{Directive, Symbol, TokenKind};
use std::rc::Rc;

/// What a parameter receives.
enum Argument {
    Value(Value),
    Reference(Place),
}

impl Interp<'_> {
    /// `#macro Name (A, B) body #end`, behind the directive: remembers where the body stands.
    pub fn define_macro(&mut self, d: Directive) -> Parsed<()> {
        let head = self.macro_head();
        let Some((file, start)) = self.frame().map(|f| (f.file.clone(), f.pos)) else {
            return Err(super::Stop);
        };
        self.jump(d.end + 1);
        let (name, params) = head?;
        let value = Value::Macro(Rc::new(Macro {
            name,
            params,
            file,
            start,
            end: d.end,
        }));
        self.scopes.set(Place { scope: 0, name }, value);
        Ok(())
    }

    fn macro_head(&mut self) -> Parsed<(Symbol, Vec<Symbol>)> {
        let (name, span) = self.raw_name("the macro's name")?;
        self.check_declarable(name, span)?;
        self.raw_mark(b'(')?;
        let mut params = Vec::new();
        while !self.raw_is(0, b')') {
            let (param, span) = self.raw_name("a parameter or `)`")?;
            self.check_declarable(param, span)?;
            params.push(param);
            if self.raw_is(0, b',') {
                self.raw_mark(b',')?;
            }
        }
        self.raw_mark(b')')?;
        Ok((name, params))
    }

    /// Takes a mark of the innermost frame itself.
    fn raw_mark(&mut self, mark: u8) -> Parsed<()> {
        if !self.raw_is(0, mark) {
            let text = format!("`{}`", char::from(mark));
            return Err(self.expected(&text));
        }
        if let Some(frame) = self.frame_mut() {
            frame.pos += 1;
        }
        Ok(())
    }

    /// Runs the call of a macro whose name comes next. Errors are reported.
    pub fn expand(&mut self, m: Rc<Macro>) {
        let call = self.here();
        let level = self.level();
        self.calls += 1;
        if self.calls > MAX_CALLS {
            self.fatal("P0606", call, format!("macros are called more than {MAX_CALLS} times"));
            return;
        }
        if let Some(frame) = self.frame_mut() {
            frame.pos += 1;
        }
        let args = self.nested(call, |s| s.unheld(|s| s.arguments(&m, call)));
        let Ok(args) = args else {
            while self.level() > level {
                self.pop_frame();
            }
            self.mark_failed();
            return;
        };
        let kind = FrameKind::Macro(m.name);
        let Ok(scope) = self.push_frame(m.file.clone(), (m.start, m.end), kind, Some(call)) else {
            return;
        };
        for (&name, arg) in m.params.iter().zip(args) {
            match arg {
                Argument::Value(v) => self.scopes.set(Place { scope, name }, v),
                Argument::Reference(place) => self.scopes.refer(scope, name, place),
            }
        }
    }

    fn arguments(&mut self, m: &Macro, call: Span) -> Parsed<Vec<Argument>> {
        if self.peek().t != T::Mark(b'(') {
            let message = format!("`(` and the arguments of macro `{}`", self.names.name(m.name));
            return Err(self.expected(&message));
        }
        self.bump();
        let mut args = Vec::new();
        while !matches!(self.raw_peek_close(), Some(true)) {
            if args.len() >= m.params.len() {
                if self.peek().t == T::Mark(b')') {
                    break; // an argument list that ends in a macro's or include's leftovers
                }
                return Err(self.argument_count(m, args.len() + 1, call));
            }
            let arg = match self.reference()? {
                Some(place) => Argument::Reference(place),
                None => Argument::Value(self.rvalue()?),
            };
            args.push(arg);
            self.comma(); // optional, as everywhere
            if self.peek().t == T::End {
                break;
            }
        }
        self.expect(b')')?;
        if args.len() != m.params.len() {
            return Err(self.argument_count(m, args.len(), call));
        }
        Ok(args)
    }

    fn raw_peek_close(&mut self) -> Option<bool> {
        self.raw(0)
            .map(|(t, _)| t.kind == TokenKind::Mark && t.data == u32::from(b')'))
    }

    /// An argument that is exactly one identifier is passed by reference.
    fn reference(&mut self) -> Parsed<Option<Place>> {
        let Some((token, _)) = self.raw(0) else { return Ok(None) };
        if token.kind != TokenKind::Name || !(self.raw_is(1, b',') || self.raw_is(1, b')')) {
            return Ok(None);
        }
        let name = Symbol(token.data);
        let Some(place) = self.scopes.find(name) else {
            return Ok(None);
        };
        match self.scopes.at(place) {
            None | Some(Value::Macro(_)) => return Ok(None),
            _ => {}
        }
        self.peek();
        self.bump();
        Ok(Some(place))
    }

    fn argument_count(&mut self, m: &Macro, found: usize, call: Span) -> super::Stop {
        let name = self.names.name(m.name);
        let wanted = m.params.len();
        let plural = if wanted == 1 { "argument" } else { "arguments" };
        let found = if found > wanted {
            "more".to_owned()
        } else {
            found.to_string()
        };
        let message = format!("macro `{name}` takes {wanted} {plural}, found {found}");
        let defined = m.file.span(m.start.saturating_sub(1));
        let d = Diagnostic::error("P0306", message)
            .at(call, "")
            .with_context(defined, "defined here");
        self.report(d)
    }
}
