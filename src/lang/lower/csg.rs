//! `union`, `merge`, `difference`, `intersection`, `light_group`.

use super::words;
use crate::diag::Span;
use crate::lang::desc::{ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T};
use crate::lang::syntax::Word;
use std::rc::Rc;

impl Interp<'_> {
    /// `union { … }` behind the brace.
    pub fn union(&mut self, w: Word, span: Span) -> Parsed<ObjectDesc> {
        let children = self.children(w)?;
        if w == Word::Merge {
            self.warn_once("P0410", span, "`merge` is drawn as a union: its inner surfaces stay");
        }
        let object = ObjectDesc::new(ShapeDesc::Union(children.into()), span);
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
        self.finished(ObjectDesc::new(ShapeDesc::Union(children.into()), span), "light_group")
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
