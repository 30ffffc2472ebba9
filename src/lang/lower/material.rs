//! `material { … }`: the language's own materials, or POV-Ray's texture and interior.

use crate::diag::{Diagnostic, Span};
use crate::lang::desc::{Desc, Look, ModelSurface, Pigment, SurfaceDesc};
use crate::lang::eval::{Interp, MAX_DEPTH, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use std::rc::Rc;

const MATERIAL_TEXTS: &[&str] = &[
    "diffuse",
    "specular",
    "glass",
    "glossy",
    "translucent",
    "principled",
    "mix",
    "emission",
    "normal",
    "texture",
    "interior",
];

impl Interp<'_> {
    /// A material, beginning with its word.
    pub fn material(&mut self) -> Parsed<Look> {
        self.bump();
        self.block(|s| s.material_items())
    }

    fn material_items(&mut self) -> Parsed<Look> {
        let mut look = Look::default();
        let mut model: Option<(ModelSurface, Span)> = None;
        let mut emission: Option<(Rc<Pigment>, Span)> = None;
        let mut normal = None;
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(b'}') | T::End => break,
                T::Mark(b',') => {
                    self.bump();
                }
                T::Word(Word::Texture) => {
                    let mut layers = look.layers.as_ref().map(|l| l.to_vec()).unwrap_or_default();
                    layers.extend(self.texture()?.iter().cloned());
                    look.layers = Some(layers.into());
                }
                T::Word(Word::Interior) => {
                    let base = look.interior.clone().unwrap_or_default();
                    look.interior = Some(self.interior_over(base)?);
                }
                T::Word(Word::InteriorTexture) => {
                    self.bump();
                    self.skip_block()?;
                }
                T::Word(Word::Normal) => normal = Some(self.normal()?),
                T::Word(Word::Emission) => {
                    self.bump();
                    emission = Some((self.color_source()?, tok.span));
                }
                T::Name(n) if self.scopes.get(n).is_some() => match self.take_value()? {
                    Value::Desc(Desc::Material(named)) => look = named,
                    Value::Desc(Desc::Texture(layers)) => look.layers = Some(layers),
                    Value::Desc(Desc::Interior(i)) => look.interior = Some(i),
                    Value::Poison => return Err(Stop),
                    other => {
                        let message = format!("expected a material, found {}", other.kind());
                        return Err(self.error("P0303", tok.span, message));
                    }
                },
                T::Word(w) => {
                    if let Some(t) = self.transform_word(w)? {
                        let _ = t; // plain colours do not move
                        continue;
                    }
                    let Some(found) = self.surface_model(w)? else {
                        return Err(self.unexpected("`material`", MATERIAL_TEXTS, tok));
                    };
                    if let Some((_, first)) = model {
                        let d = Diagnostic::error("P0312", "material has two surfaces").at(tok.span, "the second one");
                        let d = d.with_context(first, "the first one");
                        return Err(self.report(d.hint("blend them with `mix { A, B, weight }`")));
                    }
                    model = Some((found, tok.span));
                }
                _ => return Err(self.unexpected("`material`", MATERIAL_TEXTS, tok)),
            }
        }
        let mut look = self.assemble(look, model, emission)?;
        let Some(normal) = normal else { return Ok(look) };
        if let Some(surface) = &mut look.surface {
            Rc::make_mut(surface).normal = Some(normal);
            return Ok(look);
        }
        let d = Diagnostic::error("P0312", "`normal` in `material` needs a surface beside it").at(normal.span, "");
        Err(self.report(d.hint("write it inside the `texture { … }`")))
    }

    fn assemble(
        &mut self,
        mut look: Look,
        model: Option<(ModelSurface, Span)>,
        emission: Option<(Rc<Pigment>, Span)>,
    ) -> Parsed<Look> {
        match (model, emission) {
            (Some((model, span)), emission) => {
                look.layers = None;
                let depth = match &model {
                    ModelSurface::Mix { a, b, .. } => 1 + mix_depth(a).max(mix_depth(b)),
                    _ => 0,
                };
                if depth > MAX_DEPTH {
                    let message = format!("mixes are nested deeper than {MAX_DEPTH} levels");
                    return Err(self.fatal("P0601", span, message));
                }
                look.surface = Some(Rc::new(SurfaceDesc {
                    depth,
                    model,
                    emission: emission.map(|e| e.0),
                    normal: None,
                    span,
                }));
            }
            (None, Some((color, span))) => {
                if let Some(surface) = &look.surface {
                    let mut surface = (**surface).clone();
                    surface.emission = Some(color);
                    look.surface = Some(Rc::new(surface));
                } else if look.layers.is_some() {
                    let d = Diagnostic::error("P0312", "`emission` cannot stand beside `texture`").at(span, "");
                    return Err(self.report(d.hint("write it inside the texture's `finish { … }`")));
                } else {
                    look.surface = Some(Rc::new(SurfaceDesc {
                        depth: 0,
                        model: ModelSurface::Black,
                        emission: Some(color),
                        normal: None,
                        span,
                    }));
                }
            }
            (None, None) => {}
        }
        Ok(look)
    }

    /// `A, B, weight` of `mix`.
    pub(super) fn mix(&mut self) -> Parsed<ModelSurface> {
        let a = self.mixed_material()?;
        self.comma();
        let b = self.mixed_material()?;
        self.comma();
        let weight = self.within("weight of the mix", 0.0, 1.0)?;
        Ok(ModelSurface::Mix { a, b, weight })
    }

    fn mixed_material(&mut self) -> Parsed<Look> {
        let tok = self.peek();
        match tok.t {
            T::Word(Word::Material) => self.material(),
            T::Name(n) if self.scopes.get(n).is_some() => match self.take_value()? {
                Value::Desc(Desc::Material(look)) => Ok(look),
                Value::Desc(Desc::Texture(layers)) => Ok(Look {
                    layers: Some(layers),
                    ..Look::default()
                }),
                Value::Poison => Err(Stop),
                other => Err(self.error(
                    "P0303",
                    tok.span,
                    format!("expected a material, found {}", other.kind()),
                )),
            },
            T::Word(w) => match self.nested(tok.span, |s| s.surface_model(w))? {
                Some(model) => self.assemble(Look::default(), Some((model, tok.span)), None),
                None => Err(self.expected_not("a material", tok)),
            },
            _ => Err(self.expected_not("a material", tok)),
        }
    }
}

fn mix_depth(look: &Look) -> u32 {
    look.surface.as_ref().map_or(0, |s| s.depth)
}
