//! `gltf { "file" … }` and `obj { "file" … }`.

use super::modifier::apply_look;
use crate::diag::Span;
use crate::lang::ModelKind;
use crate::lang::desc::{ModelDesc, ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, T, Tok};
use crate::lang::syntax::Word;
use std::path::PathBuf;
use std::rc::Rc;

/// What a glTF file may be asked for, beside what any object may.
const GLTF_WORDS: &[Word] = &[
    Word::Scene,
    Word::Node,
    Word::Variant,
    Word::Lights,
    Word::Cameras,
    Word::Animation,
    Word::Clock,
];

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
        let (kind, words) = match w {
            Word::Gltf => (ModelKind::Gltf, GLTF_WORDS),
            _ => (ModelKind::Obj, &[][..]),
        };
        let mut model = ModelDesc {
            kind,
            path,
            options: crate::lang::ModelOptions::default(),
            lights: true,
            cameras: true,
            materials: Vec::new(),
            span: at,
        };
        // The model itself stands in the object when all is read.
        let empty = ObjectDesc::new(ShapeDesc::Unsupported(w.text()), span);
        let mut object = self.finished_with(empty, w.text(), words, &mut |s, object, tok| {
            s.model_item(&mut model, object, tok, words)
        })?;
        object.shape = ShapeDesc::Model(Rc::new(model));
        Ok(object)
    }

    /// One of the things that only models have; false if the token begins none.
    fn model_item(&mut self, model: &mut ModelDesc, object: &mut ObjectDesc, tok: Tok, words: &[Word]) -> Parsed<bool> {
        let T::Word(w) = tok.t else { return Ok(false) };
        if w == Word::Material {
            self.bump();
            let at = self.peek().span;
            if !self.starts_text() {
                let look = self.material_body()?;
                apply_look(&mut object.look, look);
                return Ok(true);
            }
            let name = self.text("name of the material")?.to_string();
            let look = self.material_body()?;
            model.materials.retain(|(known, ..)| *known != name); // the last one counts
            model.materials.push((name, at, look));
            return Ok(true);
        }
        if !words.contains(&w) {
            return Ok(false);
        }
        self.bump();
        let options = &mut model.options;
        match w {
            Word::Scene => options.scene = Some(self.text("name of the scene")?.to_string()),
            Word::Variant => options.variant = Some(self.text("name of the variant")?.to_string()),
            Word::Node => {
                options.node = Some(self.text("name of the node")?.to_string());
                options.node_is_origin = self.eat_word_text("local");
            }
            Word::Animation => options.animation = Some(self.text("name of the animation")?.to_string()),
            Word::Clock => options.clock = Some(self.finite("clock of the model")?),
            Word::Lights => model.lights = self.flag()?,
            Word::Cameras => model.cameras = self.flag()?,
            _ => return Ok(false),
        }
        Ok(true)
    }
}
