//! Reading identifiers: values, array elements, `defined` tests.

use super::scope::Place;
use super::{Array, Interp, Parsed, T, Value};
use crate::diag::Span;
use crate::lang::syntax::{Interner, Symbol, TokenKind};
use std::rc::Rc;

impl Interp<'_> {
    /// The value of the identifier that comes next, with array indices.
    pub fn take_value(&mut self) -> Parsed<Value> {
        let tok = self.peek();
        let T::Name(name) = tok.t else {
            return Err(self.expected_not("an identifier", tok));
        };
        let Some(value) = self.scopes.get(name).cloned() else {
            return Err(self.undefined(tok));
        };
        self.note_read(name);
        self.bump();
        let Value::Array(array) = &value else { return Ok(value) };
        let indices = self.indices()?;
        if indices.is_empty() {
            return Ok(value);
        }
        self.element(array, &indices, tok.span)
    }

    /// `[a][b]…` behind a name, truncated to integers.
    pub fn indices(&mut self) -> Parsed<Vec<(i64, Span)>> {
        let mut out = Vec::new();
        while self.peek_operator().t == T::Mark(b'[') {
            self.bump();
            let span = self.peek().span;
            let v = self.unheld(|s| s.float("array index"))?;
            self.expect(b']')?;
            out.push((v as i64, span));
        }
        Ok(out)
    }

    fn element(&mut self, array: &Rc<Array>, indices: &[(i64, Span)], span: Span) -> Parsed<Value> {
        let (at, rest) = self.array_index(array, indices, span)?;
        if rest.is_empty() {
            return match array.items.get(at) {
                Some(Some(v)) => Ok(v.clone()),
                _ => Err(self.error("P0402", span, "this array element has not been set")),
            };
        }
        let size: usize = rest.iter().product();
        Ok(Value::Array(Rc::new(Array {
            dims: rest,
            items: array.items.iter().skip(at).take(size).cloned().collect(),
        })))
    }

    /// The flat position of an element, or of the first of a row, and the dimensions left over.
    pub fn array_index(&mut self, array: &Array, indices: &[(i64, Span)], span: Span) -> Parsed<(usize, Vec<usize>)> {
        if indices.len() > array.dims.len() {
            let message = format!(
                "array has {} dimensions, found {} indices",
                array.dims.len(),
                indices.len()
            );
            return Err(self.error("P0305", span, message));
        }
        let mut at = 0usize;
        for (k, &(index, place)) in indices.iter().enumerate() {
            let dim = array.dims.get(k).copied().unwrap_or(0);
            let Some(i) = usize::try_from(index).ok().filter(|&i| i < dim) else {
                let message = format!("array index {index} is outside 0..{dim}");
                return Err(self.error("P0305", place, message));
            };
            at = at * dim + i;
        }
        let rest: Vec<usize> = array.dims.iter().skip(indices.len()).copied().collect();
        Ok((at * rest.iter().product::<usize>(), rest))
    }

    /// Takes a name without running or expanding anything: for declarations and `#ifdef`.
    pub fn raw_name(&mut self, what: &str) -> Parsed<(Symbol, Span)> {
        match self.raw(0) {
            Some((token, span)) if token.kind == TokenKind::Name => {
                if let Some(frame) = self.frame_mut() {
                    frame.pos += 1;
                }
                Ok((Symbol(token.data), span))
            }
            _ => Err(self.expected(what)),
        }
    }

    /// Whether a symbol may be declared; reports it if not.
    pub fn check_declarable(&mut self, name: Symbol, span: Span) -> Parsed<()> {
        match Interner::word(name) {
            Some(w) if !w.is_contextual() => {
                let d = crate::diag::Diagnostic::error("P0403", format!("`{}` is a reserved word", w.text()));
                let d = d.at(span, "cannot be declared");
                Err(self.report(d.hint("choose another name; names with a capital letter are never reserved")))
            }
            _ => Ok(()),
        }
    }

    /// `( Name )` or `( Name[i] )`: whether it is defined.
    pub fn defined_test(&mut self) -> Parsed<bool> {
        self.expect(b'(')?;
        let (name, span) = self.raw_name("a name")?;
        let place = self.scopes.find(name);
        let mut defined = place.is_some();
        if self.raw_is(0, b'[') {
            let indices = self.unheld(|s| s.indices())?;
            defined = match place.and_then(|p: Place| self.scopes.at(p)).cloned() {
                Some(Value::Array(a)) => match self.array_index(&a, &indices, span) {
                    Ok((at, rest)) => !rest.is_empty() || matches!(a.items.get(at), Some(Some(_))),
                    Err(stop) => return Err(stop),
                },
                _ => false,
            };
        } else if let Some(w) = Interner::word(name) {
            defined |= !w.is_contextual();
        }
        self.expect(b')')?;
        Ok(defined)
    }
}
