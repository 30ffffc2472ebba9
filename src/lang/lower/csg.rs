//! `union`, `merge`, `difference`, `intersection`, `light_group`.

use super::words;
use crate::diag::Span;
use crate::lang::desc::{ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, MAX_DEPTH, Parsed, Stop, T};
use crate::lang::syntax::Word;
use std::rc::Rc;

impl Interp<'_> {
    /// `union { … }` behind the brace.
    pub fn union(&mut self, w: Word, span: Span) -> Parsed<ObjectDesc> {
        let children = self.children(w)?;
        if w == Word::Merge {
            self.warn_once("P0410", span, "`merge` is drawn as a union: its inner surfaces stay");
        }
        let object = self.union_of(children, span)?;
        self.finished(object, w.text())
    }

    /// `difference` and `intersection` behind the brace: everything is read, nothing is drawn yet.
    pub fn csg(&mut self, w: Word, span: Span) -> Parsed<ObjectDesc> {
        self.children(w)?;
        self.finished(ObjectDesc::new(ShapeDesc::Unsupported(w.text()), span), w.text())
    }

    /// `light_group { lights and objects, global_lights … }` is a union whose lamps shine everywhere.
    pub fn light_group(&mut self, span: Span) -> Parsed<ObjectDesc> {
        self.warn_once(
            "P0410",
            span,
            "`light_group` is read as a union: its lamps light everything",
        );
        let children = self.children(Word::LightGroup)?;
        if self.eat_word(Word::GlobalLights) {
            self.flag()?;
        }
        let object = self.union_of(children, span)?;
        self.finished(object, "light_group")
    }

    /// A union, unless its nesting gets too deep for those who walk it.
    fn union_of(&mut self, children: Vec<Rc<ObjectDesc>>, span: Span) -> Parsed<ObjectDesc> {
        let depth = 1 + children.iter().map(|c| c.depth).max().unwrap_or(0);
        if depth > MAX_DEPTH {
            return Err(self.fatal(
                "P0601",
                span,
                format!("unions are nested deeper than {MAX_DEPTH} levels"),
            ));
        }
        let object_leaves = children.iter().fold(0u64, |n, c| n.saturating_add(c.leaves));
        let mut object = ObjectDesc::new(ShapeDesc::Union(children.into()), span);
        object.leaves = object_leaves;
        object.depth = depth;
        Ok(object)
    }

    /// The objects at the front of a block. After an error in one the next is read; the whole is then dropped.
    fn children(&mut self, w: Word) -> Parsed<Vec<Rc<ObjectDesc>>> {
        let depth = self.depth();
        let mut children = Vec::new();
        let mut failed = false;
        loop {
            let tok = self.peek_item();
            let before = self.steps();
            let child = match tok.t {
                T::Word(o) if words::OBJECTS.contains(&o) => self.object(),
                T::Name(_) if self.names_object() => self.named_object(),
                T::Word(m) if words::MODIFIERS.contains(&m) || m == Word::GlobalLights => break,
                T::Mark(b'}') | T::End => break,
                T::Mark(b',' | b';') => {
                    self.bump();
                    continue;
                }
                T::Name(n) if self.scopes.get(n).is_some() => break, // a look's name
                _ => Err(self.unexpected(&format!("`{}`", w.text()), words::item_texts(), tok)),
            };
            match child {
                Ok(child) => children.push(child),
                Err(_) => {
                    failed = true;
                    self.recover(depth, before, words::ITEMS);
                }
            }
        }
        if failed { Err(Stop) } else { Ok(children) }
    }
}
