//! Objects: the word decides the shape, what follows places and paints it.

use super::words;
use crate::lang::desc::{ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Tok};
use crate::lang::syntax::Word;
use std::rc::Rc;

impl Interp<'_> {
    /// An object, beginning with its word.
    pub fn object(&mut self) -> Parsed<Rc<ObjectDesc>> {
        let tok = self.peek();
        let T::Word(w) = tok.t else {
            return Err(self.expected_not("an object", tok));
        };
        self.count_object(tok.span)?;
        self.bump();
        let object = self.block(|s| match w {
            Word::Object => s.object_block(tok.span),
            Word::Union | Word::Merge => s.union(w, tok.span),
            Word::Difference | Word::Intersection => s.csg(w, tok.span),
            Word::LightSource => s.light_source(tok.span),
            Word::LightGroup => s.light_group(tok.span),
            Word::Gltf | Word::Obj => s.model(w, tok.span),
            _ => {
                let shape = s.shape(w, tok.span)?;
                s.finished(ObjectDesc::new(shape, tok.span), w.text())
            }
        })?;
        Ok(Rc::new(object))
    }

    /// Reads the modifiers up to the closing brace. After an error in one it goes on with the next; the object is then
    /// dropped.
    pub fn finished(&mut self, object: ObjectDesc, place: &str) -> Parsed<ObjectDesc> {
        self.finished_with(object, place, &[], &mut |_, _, _| Ok(false))
    }

    /// The same for an object that is told more: `own` reads what follows `extra` and the like, and is asked first.
    pub fn finished_with(
        &mut self,
        mut object: ObjectDesc,
        place: &str,
        extra: &[Word],
        own: &mut dyn FnMut(&mut Self, &mut ObjectDesc, Tok) -> Parsed<bool>,
    ) -> Parsed<ObjectDesc> {
        let valid = [extra, words::MODIFIERS].concat();
        let depth = self.depth();
        let mut failed = false;
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(b'}') | T::End => break,
                T::Mark(b',' | b';') => {
                    self.bump();
                    continue;
                }
                _ => {}
            }
            let before = self.steps();
            if !matches!(tok.t, T::Word(w) if valid.contains(&w))
                && let Some(stop) = self.missing_brace(tok, words::ITEMS)
            {
                return Err(stop);
            }
            let read = match own(self, &mut object, tok) {
                Ok(false) => self.modifier(&mut object, tok),
                read => read,
            };
            let done = match read {
                Ok(true) => Ok(()),
                Ok(false) => Err(self.unexpected(&format!("`{place}`"), &words::texts(&valid), tok)),
                Err(stop) => Err(stop),
            };
            if done.is_err() {
                failed = true;
                self.recover(depth, before, &valid);
            }
        }
        if failed { Err(Stop) } else { Ok(object) }
    }

    /// `object { Name … }` or `object { sphere { … } … }`.
    fn object_block(&mut self, span: crate::diag::Span) -> Parsed<ObjectDesc> {
        let tok = self.peek();
        let inner = match tok.t {
            T::Name(_) => self.named_object()?,
            T::Word(w) if words::OBJECTS.contains(&w) => self.object()?,
            _ => return Err(self.expected_not("an object or the name of one", tok)),
        };
        // Shapes are shared, so this copies the placement only. The first place wins in messages about the shape.
        let mut object = (*inner).clone();
        object.span = span;
        self.finished(object, "object")
    }

    /// Reads over the parts of a shape that cannot be drawn yet, up to its first modifier.
    pub fn unsupported_shape(&mut self, w: Word) -> Parsed<ShapeDesc> {
        let depth = self.depth();
        loop {
            let tok = self.peek();
            if let Some(stop) = self.bad_token(tok) {
                return Err(stop);
            }
            match tok.t {
                T::End => break,
                T::Mark(b'}') if self.depth() == depth => break,
                T::Mark(b'{') => self.skip_block()?,
                T::Word(m)
                    if words::MODIFIERS.contains(&m) && !matches!(m, Word::Sturm | Word::Open | Word::Hierarchy) =>
                {
                    break;
                }
                _ => {
                    self.bump();
                }
            }
        }
        Ok(ShapeDesc::Unsupported(w.text()))
    }
}
