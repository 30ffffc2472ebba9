//! The top level of a scene, values written as blocks, and `#default`.

use super::words;
use crate::lang::desc::{Desc, Layer, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Tok, Value};
use crate::lang::syntax::Word;
use std::rc::Rc;

impl Interp<'_> {
    /// Reads the whole scene. Errors are reported; reading goes on behind what failed.
    pub fn scene_items(&mut self) {
        loop {
            let tok = self.peek_item();
            if tok.t == T::End {
                return;
            }
            let before = self.steps();
            if self.scene_item(tok).is_err() {
                self.recover(0, before, words::ITEMS);
            }
        }
    }

    fn scene_item(&mut self, tok: Tok) -> Parsed<()> {
        match tok.t {
            T::Mark(b';' | b',') => {
                self.bump();
                Ok(())
            }
            T::Mark(b'}') => {
                let stop = self.error("P0104", tok.span, "this `}` closes nothing");
                self.bump();
                Err(stop)
            }
            T::Word(w) => self.word_item(w, tok),
            T::Name(_) if self.eat_word_text("default") => self.default_block(), // as `#default`, in old scenes
            T::Name(name) => match self.scopes.get(name) {
                Some(Value::Desc(Desc::Object(_))) => {
                    let d = crate::diag::Diagnostic::error("P0204", "an object's name alone draws nothing");
                    let d = d
                        .at(tok.span, "")
                        .hint(format!("write `object {{ {} }}`", self.names.name(name)));
                    self.report(d);
                    self.bump();
                    Ok(())
                }
                Some(Value::Poison) => {
                    self.bump();
                    Ok(())
                }
                _ => Err(self.unexpected("the scene", words::item_texts(), tok)),
            },
            _ => Err(self.unexpected("the scene", words::item_texts(), tok)),
        }
    }

    fn word_item(&mut self, w: Word, tok: Tok) -> Parsed<()> {
        if words::OBJECTS.contains(&w) {
            let object = self.object()?;
            self.scene.objects.push(object);
            return Ok(());
        }
        match w {
            Word::Camera => {
                let camera = self.camera()?;
                if let Some(first) = &self.scene.camera {
                    let d = crate::diag::Diagnostic::warning(
                        "P0308",
                        "the scene has several cameras, the last one is used",
                    );
                    let d = d.at(tok.span, "").with_context(first.span, "an earlier one");
                    self.report(d);
                }
                self.scene.camera = Some(camera);
                Ok(())
            }
            Word::Background => self.background(),
            Word::SkySphere => self.sky_sphere_item(),
            Word::Environment => self.environment(),
            Word::GlobalSettings => self.global_settings(),
            Word::Render => self.render_block(),
            Word::Media => {
                let media = self.media()?;
                self.scene.media.push(media);
                Ok(())
            }
            Word::Fog => {
                let fog = self.fog()?;
                self.scene.fogs.push(fog);
                Ok(())
            }
            Word::Rainbow => {
                self.warn_once(
                    "P0409",
                    tok.span,
                    format!("`{}` is not supported yet and is left out", w.text()),
                );
                self.bump();
                self.skip_block()
            }
            Word::MaxTraceLevel | Word::MaxIntersections => {
                self.bump(); // settings of POV-Ray 2
                self.float("value").map(|_| ())
            }
            Word::Texture | Word::Pigment | Word::Finish | Word::Material => {
                let stop = self.error(
                    "P0204",
                    tok.span,
                    format!("`{}` stands outside of any object", w.text()),
                );
                self.bump();
                Err(stop)
            }
            _ => {
                let stop = self.unexpected("the scene", words::item_texts(), tok);
                self.bump();
                Err(stop)
            }
        }
    }

    /// A value written as a block; `None` if the word begins none.
    pub fn describe_block(&mut self, w: Word) -> Parsed<Option<Desc>> {
        if words::OBJECTS.contains(&w) {
            return Ok(Some(Desc::Object(self.object()?)));
        }
        Ok(Some(match w {
            Word::Texture => {
                let mut layers = self.texture()?.to_vec();
                while self.peek_operator().t == T::Word(Word::Texture) {
                    layers.extend(self.texture()?.iter().cloned());
                }
                Desc::Texture(layers.into())
            }
            Word::Pigment | Word::ImageMap => Desc::Pigment(self.pigment()?),
            Word::Finish => Desc::Finish(self.finish()?),
            Word::Normal => Desc::Normal(self.normal()?),
            Word::Interior => Desc::Interior(self.interior()?),
            Word::Material => Desc::Material(self.material()?),
            Word::Transform => Desc::Transform(self.transform_block()?),
            Word::Translate | Word::Rotate | Word::Scale | Word::Matrix => {
                let mut t = glam::DAffine3::IDENTITY;
                while let T::Word(w) = self.peek_operator().t {
                    match self.transform_word(w)? {
                        Some(next) => t = next * t,
                        None => break,
                    }
                }
                Desc::Transform(t)
            }
            Word::Camera => Desc::Camera(self.camera()?),
            Word::ColorMap | Word::PigmentMap | Word::DensityMap => Desc::Map(self.map_block()?),
            Word::SkySphere => Desc::Sky(self.sky_sphere()?),
            Word::TextureMap | Word::NormalMap | Word::SlopeMap => self.opaque("a map")?,
            Word::Media => Desc::Media(self.media()?),
            Word::Density => Desc::Density(self.density()?),
            Word::Fog => Desc::Fog(self.fog()?),
            Word::Rainbow => self.opaque("a rainbow")?,
            Word::Spline => self.opaque("a spline")?,
            _ => return Ok(None),
        }))
    }

    fn opaque(&mut self, kind: &'static str) -> Parsed<Desc> {
        self.bump();
        self.skip_block()?;
        Ok(Desc::Opaque(kind))
    }

    /// `#default { texture { … } pigment { … } finish { … } camera { … } }`.
    pub fn default_block(&mut self) -> Parsed<()> {
        self.block(|s| {
            loop {
                let tok = s.peek_item();
                let mut layer = (*s.default_layer()).clone();
                match tok.t {
                    T::Word(Word::Texture) => {
                        if let Some(last) = s.texture()?.last() {
                            layer = (**last).clone();
                        }
                    }
                    T::Word(Word::Pigment) => layer.pigment = s.pigment()?,
                    T::Word(Word::Finish) => layer.finish = s.finish()?,
                    T::Word(Word::Normal) => layer.normal = Some(s.normal()?),
                    T::Word(Word::Camera) => {
                        s.scene.default_camera = Some(s.camera()?);
                        continue;
                    }
                    T::Word(Word::Radiosity | Word::Media) => {
                        s.bump();
                        s.skip_block()?;
                        continue;
                    }
                    T::Mark(b'}') | T::End => return Ok(()),
                    _ => {
                        return Err(s.unexpected(
                            "`#default`",
                            &["texture", "pigment", "finish", "normal", "camera"],
                            tok,
                        ));
                    }
                }
                s.scene.default_layer = Some(Rc::new(layer));
            }
        })
    }

    /// The texture in force as default.
    pub fn default_layer(&mut self) -> Rc<Layer> {
        if self.scene.default_layer.is_none() {
            // 3.8 made the default pigment white; before, what has no texture is black.
            let white = self.scene_version >= 3.8;
            let v = f64::from(u8::from(white));
            let mut finish = crate::lang::desc::FinishDesc::default();
            if white {
                finish.ambient = glam::DVec3::ZERO;
            }
            let layer = Layer {
                pigment: Rc::new(crate::lang::desc::Pigment::plain([v, v, v, 0.0, 0.0])),
                finish: Rc::new(finish),
                normal: None,
                span: None,
            };
            self.scene.default_layer = Some(Rc::new(layer));
        }
        match &self.scene.default_layer {
            Some(layer) => layer.clone(),
            None => Rc::new(Layer {
                pigment: Rc::new(crate::lang::desc::Pigment::plain([0.0; 5])),
                finish: Rc::default(),
                normal: None,
                span: None,
            }),
        }
    }

    /// The object of an identifier in `object { Name }` or where an object may stand.
    pub fn named_object(&mut self) -> Parsed<Rc<crate::lang::desc::ObjectDesc>> {
        let tok = self.peek();
        match self.take_value()? {
            Value::Desc(Desc::Object(o)) => Ok(o),
            Value::Poison => Err(Stop),
            other => Err(self.error("P0303", tok.span, format!("expected an object, found {}", other.kind()))),
        }
    }

    /// Whether the next token names an object that is no lamp.
    pub fn names_object(&mut self) -> bool {
        let T::Name(n) = self.peek().t else { return false };
        match self.scopes.get(n) {
            Some(Value::Desc(Desc::Object(o))) => !matches!(o.shape, ShapeDesc::Light(_)),
            _ => false,
        }
    }
}
