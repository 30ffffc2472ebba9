//! `#declare`, `#local`, `#undef` and what may stand on their right.

use super::scope::Place;
use super::{Interp, Parsed, T, Value};
use crate::diag::Span;
use crate::lang::syntax::{Symbol, Word};
use std::rc::Rc;

impl Interp<'_> {
    /// `#declare Name = value;`, behind the directive.
    pub fn declare(&mut self, local: bool) -> Parsed<()> {
        let scope = self.frame().map_or(0, |f| f.scope);
        let (mut name, mut span) = self.raw_name("a name to declare")?;
        if &*self.names.name(name) == "deprecated" && !self.raw_is(0, b'=') {
            self.eat_word_text("once");
            if self.starts_text() {
                self.text("advice")?;
            }
            (name, span) = self.raw_name("a name to declare")?;
        }
        self.check_declarable(name, span)?;
        let indices = self.unheld(|s| if s.raw_is(0, b'[') { s.indices() } else { Ok(Vec::new()) })?;
        // The place is found first: the value may come from a macro call whose scope is gone by then.
        let place = if local {
            self.scopes.local_place(scope, name)
        } else {
            self.scopes.declare_place(name)
        };
        self.expect(b'=')?;
        let level = self.level();
        let value = self.held(|s| s.rvalue());
        let value = match value {
            Ok(v) => v,
            Err(stop) => {
                if indices.is_empty() {
                    self.scopes.set(place, Value::Poison);
                }
                return Err(stop);
            }
        };
        self.settle(level);
        if self.raw_is(0, b';')
            && let Some(frame) = self.frame_mut()
        {
            frame.pos += 1;
        }
        if indices.is_empty() {
            self.note_declared(place.name, span, &value);
            self.scopes.set(place, value);
            return Ok(());
        }
        self.set_element(place, &indices, value, span)
    }

    fn set_element(&mut self, place: Place, indices: &[(i64, Span)], value: Value, span: Span) -> Parsed<()> {
        let Some(Value::Array(array)) = self.scopes.at(place) else {
            let name = self.names.name(place.name);
            return Err(self.error("P0303", span, format!("`{name}` is not an array")));
        };
        let array = Rc::clone(array);
        let (at, rest) = self.array_index(&array, indices, span)?;
        drop(array);
        if !rest.is_empty() {
            return Err(self.error("P0305", span, "an array row cannot be set as a whole"));
        }
        if let Some(Value::Array(array)) = self.scopes.at_mut(place)
            && let Some(slot) = Rc::make_mut(array).items.get_mut(at)
        {
            *slot = Some(value);
        }
        Ok(())
    }

    /// What may be declared, put in an array or passed to a macro.
    pub fn rvalue(&mut self) -> Parsed<Value> {
        if self.starts_text() {
            return Ok(Value::Text(self.text("value")?));
        }
        let tok = self.peek();
        match tok.t {
            T::Word(Word::Array) => self.nested(tok.span, |s| s.array()),
            T::Word(Word::Function) => {
                self.bump();
                self.nested(tok.span, |s| s.function())
            }
            T::Word(w) if self.is_value_word(w) => Ok(Value::Num(self.expr()?)),
            T::Word(w) => match self.nested(tok.span, |s| s.describe_block(w))? {
                Some(desc) => Ok(Value::Desc(desc)),
                None => Err(self.expected_not("a value", tok)),
            },
            T::Name(name) => match self.scopes.get(name) {
                Some(Value::Num(_) | Value::Function(_)) if !self.is_bare_function(name) => {
                    Ok(Value::Num(self.expr()?))
                }
                Some(Value::Array(_)) => {
                    if self.starts_expr() {
                        return Ok(Value::Num(self.expr()?));
                    }
                    self.take_value()
                }
                Some(Value::Poison) => {
                    self.bump();
                    Err(self.poisoned())
                }
                Some(_) => self.take_value(),
                None => Err(self.undefined(tok)),
            },
            _ => Ok(Value::Num(self.expr()?)),
        }
    }

    /// A function's name that is not called: it stands for the function itself.
    fn is_bare_function(&self, name: Symbol) -> bool {
        matches!(self.scopes.get(name), Some(Value::Function(_))) && !self.raw_is(1, b'(')
    }

    /// `#undef Name`.
    pub fn undef(&mut self) -> Parsed<()> {
        let (name, _) = self.raw_name("a name")?;
        if self.raw_is(0, b'[') {
            self.unheld(|s| s.indices())?;
        } else {
            self.scopes.remove(name);
        }
        Ok(())
    }
}
