//! `gltf { "file" … }` and `obj { "file" … }`.

use crate::diag::Span;
use crate::lang::ModelKind;
use crate::lang::desc::{ModelDesc, ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, T};
use crate::lang::syntax::Word;
use std::path::PathBuf;
use std::rc::Rc;

impl Interp<'_> {
    /// A model behind its opening brace. Its file is read when it is drawn, and need not exist before.
    pub fn model(&mut self, w: Word, span: Span) -> Parsed<ObjectDesc> {
        let at = self.peek().span;
        let name = self.text("the model's file")?;
        let path = match self.locate(&name, at, &[""])? {
            Some(path) => path,
            None => {
                let path = PathBuf::from(&*name);
                let missing = self.missing(&name, at);
                self.missing_models.push((path.clone(), missing));
                path
            }
        };
        self.name_file("model", &path, at);
        self.comma();
        let (mut scene, mut variant) = (None, None);
        loop {
            let slot = match self.peek().t {
                T::Word(Word::Scene) => &mut scene,
                T::Word(Word::Variant) => &mut variant,
                _ => break,
            };
            self.bump();
            *slot = Some(self.text("name in the model")?.to_string());
            self.comma();
        }
        let kind = if w == Word::Gltf {
            ModelKind::Gltf
        } else {
            ModelKind::Obj
        };
        let model = ModelDesc {
            kind,
            path,
            scene,
            variant,
            span: at,
        };
        self.finished(ObjectDesc::new(ShapeDesc::Model(Rc::new(model)), span), w.text())
    }
}
