//! The parameters of `principled { … }` that may vary over the surface: their words, and what glTF says of them.

use crate::lang::syntax::Word;
use crate::scene::{Channel, ColorInput, Principled, ScalarInput};

/// A number of the glTF set.
pub struct Number {
    /// Its word.
    pub word: Word,
    /// What it can be.
    pub range: (f64, f64),
    /// The channel of an image that it takes where none is named: glTF's, so that packed images work as they are. Where
    /// that is alpha, which images without it do not have, it is red.
    pub channel: Channel,
    /// Where it stands in the IR.
    pub slot: fn(&mut Principled) -> &mut ScalarInput,
}

/// A colour of the glTF set.
pub struct Color {
    /// Its word.
    pub word: Word,
    /// Where it stands in the IR.
    pub slot: fn(&mut Principled) -> &mut ColorInput,
}

const fn number(word: Word, channel: Channel, slot: fn(&mut Principled) -> &mut ScalarInput) -> Number {
    Number {
        word,
        range: (0.0, 1.0),
        channel,
        slot,
    }
}

const fn color(word: Word, slot: fn(&mut Principled) -> &mut ColorInput) -> Color {
    Color { word, slot }
}

/// All numbers.
pub const NUMBERS: &[Number] = &[
    number(Word::Metallic, Channel::B, |p| &mut p.metallic),
    number(Word::Roughness, Channel::G, |p| &mut p.roughness),
    number(Word::Specular, Channel::R, |p| &mut p.specular),
    number(Word::Transmission, Channel::R, |p| &mut p.transmission),
    number(Word::Clearcoat, Channel::R, |p| &mut p.clearcoat),
    number(Word::ClearcoatRoughness, Channel::G, |p| &mut p.clearcoat_roughness),
    number(Word::SheenRoughness, Channel::R, |p| &mut p.sheen_roughness),
    number(Word::Anisotropy, Channel::B, |p| &mut p.anisotropy),
    number(Word::DiffuseTransmission, Channel::R, |p| &mut p.diffuse_transmission),
    number(Word::Iridescence, Channel::R, |p| &mut p.iridescence),
    Number {
        word: Word::IridescenceThickness,
        range: (0.0, 1e6),
        channel: Channel::G,
        slot: |p| &mut p.iridescence_thickness,
    },
];

/// All colours.
pub const COLORS: &[Color] = &[
    color(Word::BaseColor, |p| &mut p.base_color),
    color(Word::SpecularColor, |p| &mut p.specular_color),
    color(Word::SheenColor, |p| &mut p.sheen_color),
    color(Word::DiffuseTransmissionColor, |p| &mut p.diffuse_transmission_color),
];
