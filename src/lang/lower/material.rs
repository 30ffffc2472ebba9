//! `material { … }`: the language's own materials, or POV-Ray's texture and interior.

use crate::diag::{Diagnostic, Span};
use crate::lang::desc::{Desc, Look, ModelSurface, Pigment, PrincipledDesc, SurfaceDesc};
use crate::lang::eval::{Interp, MAX_DEPTH, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::scene::Principled;
use glam::DVec3;
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
                    let Some(found) = self.surface_model(w, tok.span)? else {
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
        self.assemble(look, model, emission)
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
                        span,
                    }));
                }
            }
            (None, None) => {}
        }
        Ok(look)
    }

    /// One of the language's own surfaces, whose word comes next; `None` if it is none.
    fn surface_model(&mut self, w: Word, span: Span) -> Parsed<Option<ModelSurface>> {
        let known = [
            Word::Diffuse,
            Word::Specular,
            Word::Glass,
            Word::Glossy,
            Word::Translucent,
            Word::Principled,
            Word::Mix,
        ];
        if !known.contains(&w) {
            return Ok(None);
        }
        self.bump();
        if w == Word::Mix {
            return self.block(|s| s.mix()).map(Some);
        }
        let mut items = Items::new(w, span);
        self.block(|s| s.surface_items(&mut items))?;
        let white = || Rc::new(Pigment::plain([1.0, 1.0, 1.0, 0.0, 0.0]));
        let color = items.color.clone().unwrap_or_else(white);
        let roughness = items.numbers.roughness.factor;
        Ok(Some(match w {
            Word::Diffuse => ModelSurface::Diffuse {
                color,
                sigma: items.roughness.unwrap_or(0.0),
            },
            Word::Specular => ModelSurface::Specular { color },
            Word::Glass => ModelSurface::Glass {
                color,
                ior: items.numbers.ior,
                roughness: items.roughness.unwrap_or(0.0),
                abbe: items.abbe,
                absorption: items.absorption,
            },
            Word::Glossy => ModelSurface::Glossy {
                color,
                roughness,
                ior: items.numbers.ior,
                metal: items.metal,
            },
            Word::Translucent => ModelSurface::Translucent {
                color,
                transmit: items.transmit,
            },
            _ => {
                let [specular, sheen, transmission] = items.more_colors;
                let black = Rc::new(Pigment::plain([0.0; 5]));
                ModelSurface::Principled(Box::new(PrincipledDesc {
                    base_color: color,
                    specular_color: specular.unwrap_or_else(white),
                    sheen_color: sheen.unwrap_or(black),
                    diffuse_transmission_color: transmission.unwrap_or_else(white),
                    numbers: items.numbers,
                    absorption: items.absorption,
                }))
            }
        }))
    }

    fn surface_items(&mut self, items: &mut Items) -> Parsed<()> {
        let valid = valid_words(items.word);
        let texts = super::words::texts(valid);
        loop {
            let tok = self.peek_item();
            let w = match tok.t {
                T::Mark(b'}') | T::End => return Ok(()),
                T::Mark(b',') => {
                    self.bump();
                    continue;
                }
                T::Word(w) if valid.contains(&w) => w,
                _ => return Err(self.unexpected(&format!("`{}`", items.word.text()), &texts, tok)),
            };
            self.bump();
            let n = &mut items.numbers;
            match w {
                Word::Color | Word::BaseColor => items.color = Some(self.color_source()?),
                Word::SpecularColor => items.more_colors[0] = Some(self.color_source()?),
                Word::SheenColor => items.more_colors[1] = Some(self.color_source()?),
                Word::DiffuseTransmissionColor => items.more_colors[2] = Some(self.color_source()?),
                Word::Roughness | Word::Sigma => {
                    let most = if items.word == Word::Diffuse {
                        std::f64::consts::FRAC_PI_2
                    } else {
                        1.0
                    };
                    let r = self.within("roughness", 0.0, most)?;
                    items.roughness = Some(r);
                    n.roughness = r.into();
                }
                Word::Ior => n.ior = self.within("ior", f64::MIN_POSITIVE, f64::MAX)?,
                Word::Abbe | Word::Dispersion if items.word == Word::Principled => {
                    n.dispersion = self.within("dispersion", 0.0, 1e3)?
                }
                Word::Abbe | Word::Dispersion => items.abbe = Some(self.within("Abbe number", 1.0, f64::MAX)?),
                Word::Absorption => items.absorption = self.absorption()?,
                Word::Metal => items.metal = self.flag()?,
                Word::Transmit => items.transmit = self.within("transmit", 0.0, 1.0)?,
                Word::Metallic => n.metallic = self.within("metallic", 0.0, 1.0)?.into(),
                Word::Specular => n.specular = self.within("specular", 0.0, 1.0)?.into(),
                Word::Transmission => n.transmission = self.within("transmission", 0.0, 1.0)?.into(),
                Word::Thick => n.thick = self.flag()?,
                Word::Clearcoat => n.clearcoat = self.within("clearcoat", 0.0, 1.0)?.into(),
                Word::ClearcoatRoughness => {
                    n.clearcoat_roughness = self.within("clearcoat_roughness", 0.0, 1.0)?.into()
                }
                Word::SheenRoughness => n.sheen_roughness = self.within("sheen_roughness", 0.0, 1.0)?.into(),
                Word::Anisotropy => n.anisotropy = self.within("anisotropy", 0.0, 1.0)?.into(),
                Word::AnisotropyRotation => n.anisotropy_rotation = self.finite("anisotropy_rotation")?.to_radians(),
                Word::DiffuseTransmission => {
                    n.diffuse_transmission = self.within("diffuse_transmission", 0.0, 1.0)?.into()
                }
                _ => {}
            }
        }
    }

    /// A number in a range; outside is an error, not a clamp.
    pub fn within(&mut self, what: &str, min: f64, max: f64) -> Parsed<f64> {
        let at = self.peek().span;
        let v = self.finite(what)?;
        if !(min..=max).contains(&v) {
            let range = match (min, max) {
                (_, f64::MAX) if min == f64::MIN_POSITIVE => "positive".to_owned(),
                (_, f64::MAX) => format!("at least {min}"),
                _ => format!("between {min} and {max}"),
            };
            return Err(self.error("P0311", at, format!("{what} must be {range}, found {v}")));
        }
        Ok(v)
    }

    /// A colour, or `pigment { … }`.
    pub fn color_source(&mut self) -> Parsed<Rc<Pigment>> {
        let tok = self.peek();
        if tok.t == T::Word(Word::Pigment) {
            return self.pigment();
        }
        if let T::Name(name) = tok.t
            && let Some(Value::Desc(Desc::Pigment(p))) = self.scopes.get(name).cloned()
        {
            self.bump();
            return Ok(p);
        }
        Ok(Rc::new(Pigment::plain(self.color()?)))
    }

    /// `A, B, weight` of `mix`.
    fn mix(&mut self) -> Parsed<ModelSurface> {
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
            T::Word(w) => match self.nested(tok.span, |s| s.surface_model(w, tok.span))? {
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

/// What the block of a surface has said.
struct Items {
    word: Word,
    color: Option<Rc<Pigment>>,
    /// Specular, sheen and diffuse transmission colours.
    more_colors: [Option<Rc<Pigment>>; 3],
    roughness: Option<f64>,
    abbe: Option<f64>,
    absorption: DVec3,
    metal: bool,
    transmit: f64,
    numbers: Principled,
}

impl Items {
    fn new(word: Word, _span: Span) -> Items {
        Items {
            word,
            color: None,
            more_colors: [None, None, None],
            roughness: None,
            abbe: None,
            absorption: DVec3::ZERO,
            metal: false,
            transmit: 0.5,
            numbers: Principled::default(),
        }
    }
}

/// Words of each surface.
fn valid_words(w: Word) -> &'static [Word] {
    match w {
        Word::Diffuse => &[Word::Color, Word::Roughness, Word::Sigma],
        Word::Specular => &[Word::Color],
        Word::Glass => &[
            Word::Color,
            Word::Ior,
            Word::Roughness,
            Word::Absorption,
            Word::Dispersion,
            Word::Abbe,
        ],
        Word::Glossy => &[Word::Color, Word::Roughness, Word::Ior, Word::Metal],
        Word::Translucent => &[Word::Color, Word::Transmit],
        _ => &[
            Word::BaseColor,
            Word::Color,
            Word::Metallic,
            Word::Roughness,
            Word::Ior,
            Word::Specular,
            Word::SpecularColor,
            Word::Transmission,
            Word::Thick,
            Word::Clearcoat,
            Word::ClearcoatRoughness,
            Word::SheenColor,
            Word::SheenRoughness,
            Word::Anisotropy,
            Word::AnisotropyRotation,
            Word::DiffuseTransmission,
            Word::DiffuseTransmissionColor,
            Word::Dispersion,
            Word::Absorption,
        ],
    }
}
