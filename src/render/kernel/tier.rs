//! What a path is compiled to watch for. A scene is rendered by the smallest tier that has all it calls for; a larger
//! one gives the same bits, only slower.
//!
//! There are two, because two pay: what else was tried saves less than a twentieth of the instructions (docs/effects.md).
//! Everything that a scene may lack beside media and wavelengths is asked for once a path or once a material, or stands
//! outside of the path altogether.

use crate::render::scene::SceneTraits;

/// What the code of a path contains; what is false is not in it.
pub trait Tier {
    /// What fills solids and the space between them, and wavelengths.
    const MEDIA: bool;
}

/// All that surfaces can be, with nothing between them.
pub struct Surfaces;

impl Tier for Surfaces {
    const MEDIA: bool = false;
}

/// Everything.
pub struct All;

impl Tier for All {
    const MEDIA: bool = true;
}

/// The tiers there are, from the smallest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelTier {
    /// [`Surfaces`].
    Surfaces,
    /// [`All`].
    All,
}

impl KernelTier {
    /// The smallest tier that has all a scene calls for.
    pub fn of(traits: &SceneTraits) -> KernelTier {
        if traits.media || traits.dispersion {
            KernelTier::All
        } else {
            KernelTier::Surfaces
        }
    }

    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            KernelTier::Surfaces => "surfaces",
            KernelTier::All => "all",
        }
    }
}
