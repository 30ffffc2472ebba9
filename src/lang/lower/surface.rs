//! The blocks of the language's own surfaces: `diffuse`, `specular`, `glass`, `glossy`, `translucent`, `principled`.

use super::parameters::{COLORS, NUMBERS};
use crate::lang::desc::{BesideDesc, ImageDesc, ModelSurface, NormalMapDesc, NumberDesc, Pigment, PrincipledDesc};
use crate::lang::eval::{Interp, Parsed, T};
use crate::lang::syntax::Word;
use crate::scene::{Channel, Medium, OpacityMode, Phase, Principled};
use glam::DVec3;
use std::rc::Rc;

/// Coverage from which on a mask is there, as in glTF.
const DEFAULT_CUTOFF: f64 = 0.5;

/// A share.
pub(super) const UNIT: (f64, f64) = (0.0, 1.0);

/// What may be said of every surface, beside its model or inside of it.
pub(super) const BESIDE: &[Word] = &[Word::Emission, Word::NormalMap, Word::Opacity, Word::AlphaMode];

impl Interp<'_> {
    /// One of the language's own surfaces, whose word comes next, and what its block says of every surface; `None` if it
    /// is none.
    pub(super) fn surface_model(&mut self, w: Word) -> Parsed<Option<(ModelSurface, BesideDesc)>> {
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
            let mix = self.block(|s| s.mix())?;
            return Ok(Some((mix, BesideDesc::default())));
        }
        let mut items = Items::new(w);
        self.block(|s| s.surface_items(&mut items))?;
        let beside = std::mem::take(&mut items.beside);
        Ok(Some((self.surface_of(items), beside)))
    }

    fn surface_of(&mut self, items: Items) -> ModelSurface {
        let color = items.color.clone();
        let color = color.unwrap_or_else(|| Rc::new(Pigment::plain([1.0, 1.0, 1.0, 0.0, 0.0])));
        let roughness = |default: f64| items.roughness.clone().unwrap_or(default.into());
        match items.word {
            Word::Diffuse => ModelSurface::Diffuse {
                color,
                sigma: roughness(0.0),
            },
            Word::Specular => ModelSurface::Specular { color },
            Word::Glass => ModelSurface::Glass {
                color,
                ior: items.plain.ior,
                roughness: roughness(0.0),
                abbe: items.abbe,
                inside: items.inside,
            },
            Word::Glossy => ModelSurface::Glossy {
                color,
                roughness: roughness(0.5),
                ior: items.plain.ior,
                metal: items.metal,
            },
            Word::Translucent => ModelSurface::Translucent {
                color,
                transmit: items.transmit,
            },
            _ => {
                let inside = self.attenuated(&items);
                ModelSurface::Principled(Box::new(PrincipledDesc {
                    colors: items.colors,
                    numbers: items.numbers,
                    clearcoat_normal: items.clearcoat_normal,
                    anisotropy_direction: items.anisotropy_direction,
                    plain: items.plain,
                    inside,
                }))
            }
        }
    }

    /// What fills the inside, with glTF's attenuation: after its distance light has its colour.
    fn attenuated(&mut self, items: &Items) -> Medium {
        let mut inside = items.inside;
        let (color, distance) = (items.attenuation_color, items.attenuation_distance);
        let place = color.map(|c| c.1).or(distance.map(|d| d.1));
        let Some(place) = place else { return inside };
        match (color, distance) {
            (Some((color, _)), Some((distance, _))) => {
                // Black would absorb without end; the least positive number is as black, and finite.
                let color = self.linear(color).max(DVec3::splat(f64::MIN_POSITIVE));
                inside.absorption += DVec3::from_array(color.to_array().map(|c| -c.ln().min(0.0))) / distance;
                if !items.plain.thick {
                    self.warn("P0414", place, "attenuation has no effect without `thick`");
                }
            }
            _ => {
                let message = "`attenuation_color` and `attenuation_distance` have no effect without each other";
                self.warn("P0414", place, message);
            }
        }
        inside
    }

    fn surface_items(&mut self, items: &mut Items) -> Parsed<()> {
        let valid = [valid_words(items.word), BESIDE].concat();
        let texts = super::words::texts(&valid);
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
            if BESIDE.contains(&w) {
                self.beside(w, &mut items.beside)?;
                continue;
            }
            self.bump();
            if items.word == Word::Principled {
                self.principled_item(w, items)?;
            } else {
                self.surface_item(w, items)?;
            }
        }
    }

    /// What follows a word of any surface but `principled`.
    fn surface_item(&mut self, w: Word, items: &mut Items) -> Parsed<()> {
        match w {
            Word::Color if items.word == Word::Translucent && !self.begins_source() => {
                // `transmit` is a part of colours too; behind the colour of a sheet it is the sheet's.
                self.colors_end_at_transmit = true;
                let color = self.color_source();
                self.colors_end_at_transmit = false;
                items.color = Some(color?);
            }
            Word::Color => items.color = Some(self.color_source()?),
            Word::Roughness | Word::Sigma => {
                let most = match items.word {
                    Word::Diffuse => std::f64::consts::FRAC_PI_2,
                    _ => 1.0,
                };
                items.roughness = Some(self.number_source("roughness", (0.0, most), Channel::G)?);
            }
            Word::Abbe | Word::Dispersion => items.abbe = Some(self.within("Abbe number", 1.0, f64::MAX)?),
            Word::Metal => items.metal = self.flag()?,
            Word::Transmit => items.transmit = self.number_source("transmit", UNIT, Channel::R)?,
            _ => self.inside_item(w, items)?,
        }
        Ok(())
    }

    /// What follows a word of `principled`.
    fn principled_item(&mut self, w: Word, items: &mut Items) -> Parsed<()> {
        let w = if w == Word::Color { Word::BaseColor } else { w };
        if let Some(i) = NUMBERS.iter().position(|n| n.word == w) {
            let number = self.number_source(w.text(), NUMBERS[i].range, NUMBERS[i].channel)?;
            items.numbers.push((i, number));
            return Ok(());
        }
        if let Some(i) = COLORS.iter().position(|c| c.word == w) {
            let color = self.color_source()?;
            items.colors.push((i, color));
            return Ok(());
        }
        match w {
            Word::Dispersion | Word::Abbe => items.plain.dispersion = self.within("dispersion", 0.0, 1e3)?,
            Word::IridescenceIor => items.plain.iridescence_ior = self.within("iridescence_ior", 1.0, f64::MAX)?,
            Word::Thick => items.plain.thick = self.flag()?,
            Word::AnisotropyRotation => {
                items.plain.anisotropy_rotation = self.finite("anisotropy_rotation")?.to_radians();
            }
            Word::AnisotropyDirection => items.anisotropy_direction = Some(self.surface_image()?),
            Word::ClearcoatNormal => items.clearcoat_normal = Some(self.tangent_normals(w.text())?),
            Word::AttenuationColor => {
                let at = self.peek().span;
                let [r, g, b, ..] = self.color()?;
                let color = DVec3::new(r, g, b);
                if !(color.min_element() >= 0.0 && color.max_element() <= 1.0) {
                    return Err(self.error("P0311", at, "attenuation_color must be between 0 and 1"));
                }
                items.attenuation_color = Some((color, at));
            }
            Word::AttenuationDistance => {
                let at = self.peek().span;
                let distance = self.within("attenuation_distance", f64::MIN_POSITIVE, f64::MAX)?;
                items.attenuation_distance = Some((distance, at));
            }
            _ => self.inside_item(w, items)?,
        }
        Ok(())
    }

    /// What follows a word about the inside.
    fn inside_item(&mut self, w: Word, items: &mut Items) -> Parsed<()> {
        match w {
            Word::Ior => items.plain.ior = self.within("ior", f64::MIN_POSITIVE, f64::MAX)?,
            Word::Absorption => items.inside.absorption = self.coefficient("absorption")?,
            Word::Scattering => items.inside.scattering = self.coefficient("scattering")?,
            Word::Phase => items.inside.phase = Phase::HenyeyGreenstein(self.eccentricity("phase")?),
            _ => {}
        }
        Ok(())
    }

    /// What may be said of every surface, beginning with its word.
    pub(super) fn beside(&mut self, w: Word, beside: &mut BesideDesc) -> Parsed<()> {
        let at = self.bump().span;
        match w {
            Word::Emission => beside.emission = Some((self.color_source()?, at)),
            Word::NormalMap => beside.normal_map = Some(self.tangent_normals(w.text())?),
            Word::Opacity => beside.opacity = Some((self.number_source("opacity", UNIT, Channel::R)?, at)),
            Word::AlphaMode => beside.alpha_mode = Some((self.alpha_mode()?, at)),
            _ => {}
        }
        Ok(())
    }

    /// `opaque`, `mask 0.5` or `blend`.
    fn alpha_mode(&mut self) -> Parsed<OpacityMode> {
        if self.eat_word_text("mask") {
            let is_given = matches!(self.peek().t, T::Number(_) | T::Mark(b'('));
            let cutoff = match is_given {
                true => self.within("cutoff of the mask", 0.0, f64::MAX)?,
                false => DEFAULT_CUTOFF,
            };
            return Ok(OpacityMode::Mask(cutoff));
        }
        for (text, mode) in [("blend", OpacityMode::Blend), ("opaque", OpacityMode::Opaque)] {
            if self.eat_word_text(text) {
                return Ok(mode);
            }
        }
        let tok = self.peek();
        Err(self.unexpected("`alpha_mode`", &["opaque", "mask", "blend"], tok))
    }
}

/// What the block of a surface has said.
struct Items {
    word: Word,
    color: Option<Rc<Pigment>>,
    roughness: Option<NumberDesc>,
    abbe: Option<f64>,
    inside: Medium,
    metal: bool,
    transmit: NumberDesc,
    colors: Vec<(usize, Rc<Pigment>)>,
    numbers: Vec<(usize, NumberDesc)>,
    clearcoat_normal: Option<NormalMapDesc>,
    anisotropy_direction: Option<Rc<ImageDesc>>,
    attenuation_color: Option<(DVec3, crate::diag::Span)>,
    attenuation_distance: Option<(f64, crate::diag::Span)>,
    plain: Principled,
    beside: BesideDesc,
}

impl Items {
    fn new(word: Word) -> Items {
        Items {
            word,
            color: None,
            roughness: None,
            abbe: None,
            inside: Medium::default(),
            metal: false,
            transmit: 0.5.into(),
            colors: Vec::new(),
            numbers: Vec::new(),
            clearcoat_normal: None,
            anisotropy_direction: None,
            attenuation_color: None,
            attenuation_distance: None,
            plain: Principled::default(),
            beside: BesideDesc::default(),
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
            Word::ClearcoatNormal,
            Word::SheenColor,
            Word::SheenRoughness,
            Word::Anisotropy,
            Word::AnisotropyRotation,
            Word::AnisotropyDirection,
            Word::DiffuseTransmission,
            Word::DiffuseTransmissionColor,
            Word::Dispersion,
            Word::Iridescence,
            Word::IridescenceIor,
            Word::IridescenceThickness,
            Word::AttenuationColor,
            Word::AttenuationDistance,
            Word::Absorption,
            Word::Scattering,
            Word::Phase,
        ],
    }
}
