//! `texture { … }` and `normal { … }`.

use super::pattern::is_pattern;
use super::transform::TRANSFORM_TEXTS;
use crate::lang::desc::{Desc, Layer, Layers, NormalDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use std::rc::Rc;

/// `bump_size` where none is written, as in POV-Ray.
const DEFAULT_BUMP_SIZE: f64 = 0.5;

/// Words of a texture.
const TEXTURE_TEXTS: &[&str] = &[
    "pigment",
    "normal",
    "finish",
    "texture_map",
    "uv_mapping",
    "scale",
    "rotate",
    "translate",
];

impl Interp<'_> {
    /// A texture, beginning with its word.
    pub fn texture(&mut self) -> Parsed<Layers> {
        self.bump();
        self.block(|s| s.texture_items(b'}'))
    }

    /// The inside of a texture up to the closing mark.
    pub fn texture_items(&mut self, close: u8) -> Parsed<Layers> {
        let start = self.peek().span;
        let mut layers: Vec<Rc<Layer>> = Vec::new();
        let mut layer = (*self.default_layer()).clone();
        layer.span = Some(start);
        // Layers that a map or a block pattern mixes: the first one stands for all.
        let mut mixed: Option<(&'static str, Layers)> = None;
        let mut uv = false;
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(m) if m == close => break,
                T::End | T::Mark(b'}') => break,
                T::Mark(b',') => {
                    self.bump();
                }
                T::Word(Word::Pigment) => layer.pigment = self.pigment_over(layer.pigment.clone())?,
                T::Word(Word::Finish) => layer.finish = self.finish_over(layer.finish.clone())?,
                T::Word(Word::Normal) => layer.normal = Some(self.normal()?),
                T::Word(Word::Texture) => {
                    let next = self.texture()?;
                    mixed.get_or_insert(("texture", next));
                }
                T::Word(w @ Word::TextureMap) => {
                    self.bump();
                    if let Some(first) = self.texture_map()? {
                        mixed.get_or_insert((w.text(), first));
                    }
                }
                T::Word(w @ (Word::Tiles | Word::MaterialMap)) => {
                    self.bump();
                    self.skip_block()?;
                    mixed.get_or_insert((w.text(), Rc::new([self.default_layer()])));
                }
                T::Word(Word::UvMapping) => {
                    self.bump();
                    uv = true;
                }
                T::Word(w) if is_pattern(w) => self.pattern(w)?,
                T::Word(w) => {
                    if self.transform_word(w)?.is_none() && !self.pattern_modifier(w)? {
                        let stop = self.unexpected("`texture`", &[TEXTURE_TEXTS, TRANSFORM_TEXTS].concat(), tok);
                        return Err(stop);
                    }
                }
                T::Name(n) if self.scopes.get(n).is_some() => match self.take_value()? {
                    Value::Desc(Desc::Texture(named)) => {
                        layers = named.to_vec();
                        if let Some(top) = layers.pop() {
                            layer = (*top).clone();
                        }
                    }
                    Value::Desc(Desc::Pigment(p)) => layer.pigment = p,
                    Value::Desc(Desc::Normal(n)) => layer.normal = Some(n),
                    Value::Desc(Desc::Finish(f)) => layer.finish = f,
                    Value::Desc(Desc::Material(look)) if look.layers.is_some() => {
                        layers = look.layers.map(|l| l.to_vec()).unwrap_or_default();
                        if let Some(top) = layers.pop() {
                            layer = (*top).clone();
                        }
                    }
                    Value::Poison => return Err(Stop),
                    other => {
                        let message = format!("expected a texture, found {}", other.kind());
                        return Err(self.error("P0303", tok.span, message));
                    }
                },
                _ => return Err(self.unexpected("`texture`", TEXTURE_TEXTS, tok)),
            }
        }
        match mixed {
            Some((what, first)) => {
                // Noted in the pigment, so that the substitution is told only where it is drawn.
                let mut out = first.to_vec();
                if let Some(top) = out.pop() {
                    let mut top = (*top).clone();
                    let mut pigment = (*top.pigment).clone();
                    pigment.pattern.get_or_insert((what, start));
                    top.pigment = Rc::new(pigment);
                    out.push(Rc::new(top));
                }
                Ok(out.into())
            }
            None => {
                if uv {
                    Rc::make_mut(&mut layer.pigment).uv = true;
                    if let Some(normal) = &mut layer.normal {
                        Rc::make_mut(normal).uv = true;
                    }
                }
                layers.push(Rc::new(layer));
                Ok(layers.into())
            }
        }
    }

    /// `{ [0 Texture] [1 …] }`: the first entry.
    fn texture_map(&mut self) -> Parsed<Option<Layers>> {
        self.block(|s| {
            let mut first = None;
            while s.eat(b'[') {
                if s.starts_expr() {
                    s.float("place in the map")?; // `average` maps may leave the weight out
                    s.comma();
                }
                let at = s.peek().span;
                let layers = s.nested(at, |s| s.texture_items(b']'))?;
                first.get_or_insert(layers);
                s.expect(b']')?;
                s.comma();
            }
            Ok(first)
        })
    }

    /// `normal { … }`: its height map, all else read over.
    pub fn normal(&mut self) -> Parsed<Rc<NormalDesc>> {
        let span = self.bump().span;
        self.block(|s| {
            let mut normal = NormalDesc {
                bump: None,
                size: DEFAULT_BUMP_SIZE,
                uv: false,
                span,
            };
            let depth = s.depth();
            loop {
                let tok = s.peek();
                if let Some(stop) = s.bad_token(tok) {
                    return Err(stop);
                }
                match tok.t {
                    T::End => return Ok(Rc::new(normal)),
                    T::Mark(b'}') if s.depth() == depth => return Ok(Rc::new(normal)),
                    T::Mark(b'{') => s.skip_block()?,
                    T::Word(Word::BumpMap) => normal.bump = s.bump_map(&mut normal.size)?,
                    T::Word(Word::BumpSize) => {
                        s.bump();
                        normal.size = s.finite("bump_size")?;
                    }
                    T::Word(Word::UvMapping) => {
                        s.bump();
                        normal.uv = true;
                    }
                    T::Name(n) if matches!(s.scopes.get(n), Some(Value::Desc(Desc::Normal(_)))) => {
                        if let Value::Desc(Desc::Normal(named)) = s.take_value()? {
                            normal = NormalDesc {
                                span,
                                ..(*named).clone()
                            };
                        }
                    }
                    _ => {
                        s.bump();
                    }
                }
            }
        })
    }
}
