//! The blocks of the language's own surfaces: `diffuse`, `specular`, `glass`, `glossy`, `translucent`, `principled`.

use crate::lang::desc::{Desc, ModelSurface, Pigment, PrincipledDesc};
use crate::lang::eval::{Interp, Parsed, T, Value};
use crate::lang::syntax::Word;
use crate::scene::{Medium, Phase, Principled};
use std::rc::Rc;

impl Interp<'_> {
    /// One of the language's own surfaces, whose word comes next; `None` if it is none.
    pub(super) fn surface_model(&mut self, w: Word) -> Parsed<Option<ModelSurface>> {
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
        let mut items = Items::new(w);
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
                inside: items.inside,
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
                    inside: items.inside,
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
                Word::Color if items.word == Word::Translucent && self.peek().t != T::Word(Word::Pigment) => {
                    // `transmit` is a part of colours too; behind the colour of a sheet it is the sheet's.
                    self.colors_end_at_transmit = true;
                    let color = self.color_source();
                    self.colors_end_at_transmit = false;
                    items.color = Some(color?);
                }
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
                Word::Absorption => items.inside.absorption = self.coefficient("absorption")?,
                Word::Scattering => items.inside.scattering = self.coefficient("scattering")?,
                Word::Phase => items.inside.phase = Phase::HenyeyGreenstein(self.eccentricity("phase")?),
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
            self.note_read(name);
            self.bump();
            return Ok(p);
        }
        Ok(Rc::new(Pigment::plain(self.color()?)))
    }
}

/// What the block of a surface has said.
struct Items {
    word: Word,
    color: Option<Rc<Pigment>>,
    /// Specular, sheen and diffuse transmission colours.
    more_colors: [Option<Rc<Pigment>>; 3],
    roughness: Option<f64>,
    abbe: Option<f64>,
    inside: Medium,
    metal: bool,
    transmit: f64,
    numbers: Principled,
}

impl Items {
    fn new(word: Word) -> Items {
        Items {
            word,
            color: None,
            more_colors: [None, None, None],
            roughness: None,
            abbe: None,
            inside: Medium::default(),
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
            Word::Scattering,
            Word::Phase,
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
            Word::Scattering,
            Word::Phase,
        ],
    }
}
