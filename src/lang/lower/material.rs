//! `material { … }`: the language's own materials, or POV-Ray's texture and interior.

use super::surface::{BESIDE, UNIT};
use crate::diag::{Diagnostic, Span};
use crate::lang::desc::{BesideDesc, Desc, Look, ModelSurface, SurfaceDesc};
use crate::lang::eval::{Interp, MAX_DEPTH, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::scene::Channel;
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
    "normal_map",
    "opacity",
    "alpha_mode",
    "texture",
    "interior",
];

impl Interp<'_> {
    /// A material, beginning with its word.
    pub fn material(&mut self) -> Parsed<Look> {
        self.bump();
        self.material_body()
    }

    /// The block of a material, behind its word.
    pub fn material_body(&mut self) -> Parsed<Look> {
        self.block(|s| s.material_items())
    }

    fn material_items(&mut self) -> Parsed<Look> {
        let mut look = Look::default();
        let mut model: Option<(ModelSurface, Span)> = None;
        let mut beside = BesideDesc::default();
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
                T::Word(Word::Normal) => beside.normal = Some(self.normal()?),
                T::Word(w) if BESIDE.contains(&w) => self.beside(w, &mut beside)?,
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
                    let Some((found, inner)) = self.surface_model(w)? else {
                        return Err(self.unexpected("`material`", MATERIAL_TEXTS, tok));
                    };
                    if let Some((_, first)) = model {
                        let d = Diagnostic::error("P0312", "material has two surfaces").at(tok.span, "the second one");
                        let d = d.with_context(first, "the first one");
                        return Err(self.report(d.hint("blend them with `mix { A, B, weight }`")));
                    }
                    beside.take_over(inner);
                    model = Some((found, tok.span));
                }
                _ => return Err(self.unexpected("`material`", MATERIAL_TEXTS, tok)),
            }
        }
        self.assemble(look, model, beside)
    }

    fn assemble(&mut self, mut look: Look, model: Option<(ModelSurface, Span)>, beside: BesideDesc) -> Parsed<Look> {
        if let Some((model, span)) = model {
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
                beside,
                span,
            }));
            return Ok(look);
        }
        if let Some(surface) = &mut look.surface {
            Rc::make_mut(surface).beside.take_over(beside);
            return Ok(look);
        }
        if let Some((word, at)) = beside.about_surface() {
            let message = format!("`{word}` in `material` needs a surface beside it");
            let d = Diagnostic::error("P0312", message).at(at, "");
            return Err(self.report(match word {
                "normal" => d.hint("write it inside the `texture { … }`"),
                _ => d.hint("write one of the language's own beside it, such as `principled { … }`"),
            }));
        }
        let Some((_, span)) = beside.emission else {
            return Ok(look);
        };
        if look.layers.is_some() {
            let d = Diagnostic::error("P0312", "`emission` cannot stand beside `texture`").at(span, "");
            return Err(self.report(d.hint("write it inside the texture's `finish { … }`")));
        }
        look.surface = Some(Rc::new(SurfaceDesc {
            depth: 0,
            model: ModelSurface::Black,
            beside,
            span,
        }));
        Ok(look)
    }

    /// `A, B, weight` of `mix`.
    pub(super) fn mix(&mut self) -> Parsed<ModelSurface> {
        let a = self.mixed_material()?;
        self.comma();
        let b = self.mixed_material()?;
        self.comma();
        let weight = self.number_source("weight of the mix", UNIT, Channel::R)?;
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
                Some((model, beside)) => self.assemble(Look::default(), Some((model, tok.span)), beside),
                None => Err(self.expected_not("a material", tok)),
            },
            _ => Err(self.expected_not("a material", tok)),
        }
    }
}

fn mix_depth(look: &Look) -> u32 {
    look.surface.as_ref().map_or(0, |s| s.depth)
}
