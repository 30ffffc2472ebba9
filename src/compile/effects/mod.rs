//! Effects: what a scene may call for, under the names that the command line, studies and documents use.
//!
//! A scene effect belongs to the picture: without it something is missing ([`Effect::leave_out`] takes it away, all else
//! stays). A strategy is a way to compute the same picture, or a part of light that may be left out for all materials at
//! once. [`causes`] says which of them a scene has, and who calls for each.

pub mod causes;
mod flatten;
mod force;
mod leave_out;
mod motion;
mod receivers;
#[cfg(test)]
mod tests;

pub use leave_out::Cut;

use crate::scene::{Material, SurfaceModel, TextureId};

/// Something that a scene may call for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Effect {
    /// Images on surfaces.
    Textures,
    /// Normal maps and height maps.
    Bump,
    /// Coverage, and light that passes straight through surfaces.
    Alpha,
    /// What fills solids and the air: absorption, scattering, emission, fog.
    Media,
    /// An index of refraction that depends on the colour.
    Dispersion,
    /// A lens with an opening.
    Lens,
    /// What moves while the shutter is open.
    Motion,
    /// Light from infinitely far away.
    Environment,
    /// Mirrors.
    Specular,
    /// Solids and sheets that refract.
    Glass,
    /// Highlights, coats and rough metals.
    Glossy,
    /// Light that is scattered to the far side of a sheet.
    Translucent,
    /// Light that was scattered more than once.
    Indirect,
    /// Light that reaches rough surfaces by way of mirror-like ones.
    Caustics,
    /// Several lights, of which each point picks those that matter to it.
    LightTree,
}

use Effect::*;

impl Effect {
    /// All of them, in the order in which they are told.
    pub const ALL: [Effect; 15] = [
        Textures,
        Bump,
        Alpha,
        Media,
        Dispersion,
        Lens,
        Motion,
        Environment,
        Specular,
        Glass,
        Glossy,
        Translucent,
        Indirect,
        Caustics,
        LightTree,
    ];

    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Textures => "textures",
            Bump => "bump",
            Alpha => "alpha",
            Media => "media",
            Dispersion => "dispersion",
            Lens => "lens",
            Motion => "motion",
            Environment => "environment",
            Specular => "specular",
            Glass => "glass",
            Glossy => "glossy",
            Translucent => "translucent",
            Indirect => "indirect",
            Caustics => "caustics",
            LightTree => "light_tree",
        }
    }

    /// What the picture lacks without it, for help texts.
    pub fn without(self) -> &'static str {
        match self {
            Textures => "images on surfaces are their mean colour",
            Bump => "surfaces are as smooth as their shapes",
            Alpha => "surfaces are wholly there",
            Media => "solids and the air are clear",
            Dispersion => "all colours are refracted alike",
            Lens => "everything is sharp",
            Motion => "everything stands where it is when the shutter opens",
            Environment => "the sky is seen but lights nothing",
            Specular => "mirrors are black",
            Glass => "glass neither bends nor reflects",
            Glossy => "coats and highlights are gone, rough metals are mirrors",
            Translucent => "nothing shines through sheets",
            Indirect => "light is scattered once",
            Caustics => "mirrors and glass throw no light on rough surfaces",
            LightTree => "lights are picked by their power, wherever they are",
        }
    }

    /// Whether it changes how a picture is computed, rather than what the scene is.
    pub fn is_strategy(self) -> bool {
        matches!(self, Indirect | Caustics | LightTree)
    }

    /// The effect of this name.
    pub fn from_word(word: &str) -> Option<Effect> {
        Effect::ALL.into_iter().find(|e| e.word() == word)
    }
}

/// The textures of a material that colour it, normal maps, height maps and coverage left out.
pub fn image_inputs(material: &Material) -> Vec<TextureId> {
    let mut plain = material.clone();
    plain.opacity.alpha.texture = None;
    plain.normal_map = None;
    plain.bump_map = None;
    if let SurfaceModel::Principled(p) = &mut plain.surface {
        p.clearcoat_normal = None;
    }
    let mut found = Vec::new();
    plain.each_texture(&mut |t| found.push(t));
    found
}
