//! Pruning: what a description holds and the picture does not need is taken out before anything is inferred or compiled.
//!
//! Each [`Pass`] is a function that looks at the description, takes one kind of thing out and says what and why. They
//! run in a fixed order, first on what the description itself tells; then the images that are left are decoded, and
//! they run once more with what the texels tell. Whatever no longer serves anything is told at last: images among it
//! were never opened, unless their texels were the reason.
//!
//! The promise of every pass is the same picture: the same bits, or, where [`Pass::keeps_bits`] says no, the same
//! expected value of every pixel from other random numbers.

mod attributes;
mod coverage;
mod fold;
mod lens;
mod lights;
mod media;
mod motion;
mod reach;
mod relief;
mod sky;
mod surfaces;
#[cfg(test)]
mod tests;
mod unreachable;
mod unseen;

pub use reach::{ObjectId, Reached, Roots, drawn};

use super::images::Images;
use crate::diag::Diagnostics;
use crate::files::Files;
use crate::scene::{ImageId, Material, Place, Scene};
use fold::Facts;
pub(super) use fold::{folded, is_at_least, is_nothing};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The passes, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Pass {
    /// A pinhole has no plane in focus.
    Lens,
    /// Keys of motion that are all the same.
    Motion,
    /// Lamps without light.
    Lights,
    /// An environment without light, a backdrop that is the environment.
    Sky,
    /// Textures that are the same everywhere become numbers; factors of 0 need no texture.
    Textures,
    /// Parts of surfaces that have no share: the other part of a mix, layers of strength 0.
    Surfaces,
    /// Coverage that is 1 everywhere.
    Coverage,
    /// Normal maps that leave the normal as it is.
    Relief,
    /// Insides that do nothing or are never entered, fog without density, dispersion without refraction.
    Media,
    /// Objects that no ray meets, or that light passes as if they were not there.
    Unseen,
    /// What nothing drawn refers to.
    Unreachable,
    /// Coordinates, tangents and colours of vertices that no material reads.
    Attributes,
}

impl Pass {
    /// All of them, in order.
    pub const ALL: [Pass; 12] = [
        Pass::Lens,
        Pass::Motion,
        Pass::Lights,
        Pass::Sky,
        Pass::Textures,
        Pass::Surfaces,
        Pass::Coverage,
        Pass::Relief,
        Pass::Media,
        Pass::Unseen,
        Pass::Unreachable,
        Pass::Attributes,
    ];

    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Pass::Lens => "lens",
            Pass::Motion => "motion",
            Pass::Lights => "lights",
            Pass::Sky => "sky",
            Pass::Textures => "textures",
            Pass::Surfaces => "surfaces",
            Pass::Coverage => "coverage",
            Pass::Relief => "relief",
            Pass::Media => "media",
            Pass::Unseen => "unseen",
            Pass::Unreachable => "unreachable",
            Pass::Attributes => "attributes",
        }
    }

    /// Whether every sample keeps its bits. Fewer lights are chosen among with other probabilities; a surface that is
    /// passed uses random numbers up and moves the ray's start by a rounding. There the expected value is kept.
    pub fn keeps_bits(self) -> bool {
        match self {
            Pass::Lights | Pass::Sky | Pass::Unseen => false,
            Pass::Lens
            | Pass::Motion
            | Pass::Textures
            | Pass::Surfaces
            | Pass::Coverage
            | Pass::Relief
            | Pass::Media
            | Pass::Unreachable
            | Pass::Attributes => true,
        }
    }
}

/// What is spared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Saved {
    /// Files that are not opened.
    pub files: Vec<PathBuf>,
    /// Bytes that are not read, decoded or kept; 0 where that is unknown.
    pub bytes: u64,
    /// Lights that are not chosen among.
    pub lights: u64,
    /// Objects that rays are not tested against.
    pub objects: u64,
}

/// Something that was taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Removal {
    /// By which pass.
    pub pass: Pass,
    /// What it is: `lamp`, `image`, `material`, …
    pub kind: &'static str,
    /// Its name, or empty.
    pub name: String,
    /// Why it is not needed.
    pub why: String,
    /// Where it was written.
    pub place: Place,
    /// What that saves.
    pub saved: Saved,
}

impl Saved {
    /// Bytes alone.
    pub fn of_bytes(bytes: u64) -> Saved {
        Saved {
            bytes,
            ..Saved::default()
        }
    }
}

impl Removal {
    fn new(pass: Pass, kind: &'static str, name: &str, why: impl Into<String>, place: &Place, saved: Saved) -> Removal {
        Removal {
            pass,
            kind,
            name: name.to_owned(),
            why: why.into(),
            place: place.clone(),
            saved,
        }
    }
}

/// A scene without what it does not need.
pub struct Pruned<'s> {
    /// The scene; borrowed if nothing had to be changed. Ids are those of the scene as it was written.
    pub scene: Cow<'s, Scene>,
    /// What was taken out, in the order of the passes.
    pub what: Vec<Removal>,
    /// What its objects refer to; forgotten when objects are taken out.
    roots: Option<Roots>,
    /// The scene as it was written.
    written: &'s Scene,
    /// Images that were decoded on the way.
    pub(super) images: Images<'s>,
    /// Why inputs with these images are no longer read.
    dropped: BTreeMap<ImageId, (Pass, String)>,
    files: &'s dyn Files,
}

impl<'s> Pruned<'s> {
    /// The scene as it is written, with everything.
    pub fn untouched(scene: &'s Scene, files: &'s dyn Files) -> Pruned<'s> {
        Pruned {
            scene: Cow::Borrowed(scene),
            what: Vec::new(),
            roots: None,
            written: scene,
            images: Images::new(&scene.images, files),
            dropped: BTreeMap::new(),
            files,
        }
    }

    /// Whether every sample has the bits that it has without pruning.
    pub fn keeps_bits(&self) -> bool {
        self.what.iter().all(|removal| removal.pass.keeps_bits())
    }

    fn tell(
        &mut self,
        pass: Pass,
        kind: &'static str,
        name: &str,
        why: impl Into<String>,
        place: &Place,
        saved: Saved,
    ) {
        self.what.push(Removal::new(pass, kind, name, why, place, saved));
    }

    fn take_roots(&mut self) -> Roots {
        self.roots.take().unwrap_or_else(|| Roots::of(&self.scene))
    }

    /// What something drawn refers to by now.
    fn reached(&mut self) -> Reached {
        let roots = self.take_roots();
        let reached = Reached::by(&roots, &self.scene);
        self.roots = Some(roots);
        reached
    }

    /// Edits each material that something drawn has. `edit` says what it took out that is worth telling; images that it
    /// took from the material's inputs are remembered with the reason that it gives for each.
    fn each_material(&mut self, pass: Pass, edit: fn(&Facts<'_>, &mut Material, &mut Notes)) {
        let roots = self.take_roots();
        let reached = Reached::by(&roots, &self.scene);
        let mut changed = Vec::new();
        {
            let facts = Facts::new(&self.scene, &self.images, &roots);
            for id in &reached.materials {
                let Some(before) = self.scene.materials.get(id.index()) else {
                    continue;
                };
                let (mut material, mut notes) = (before.clone(), Notes::default());
                edit(&facts.of(*id), &mut material, &mut notes);
                if material != *before {
                    let behind = reach::images_behind(&self.scene, before);
                    let gone = &behind - &reach::images_behind(&self.scene, &material);
                    changed.push((*id, material, notes, gone));
                }
            }
        }
        self.roots = Some(roots);
        for (id, material, notes, gone) in changed {
            for image in gone {
                let why = notes.images.get(&image).cloned();
                self.dropped
                    .entry(image)
                    .or_insert((pass, why.unwrap_or_else(|| "nothing reads it".to_owned())));
            }
            for why in notes.told {
                self.tell(pass, "material", &material.name, why, &material.place, Saved::default());
            }
            self.scene.to_mut().materials[id.index()] = material;
        }
    }
}

/// What an edit of a material has to say.
#[derive(Default)]
struct Notes {
    told: Vec<String>,
    images: BTreeMap<ImageId, String>,
}

/// Takes out of a scene what its picture does not need. Images that are left are decoded; what cannot be read is told.
pub fn prune<'s>(scene: &'s Scene, files: &'s dyn Files, diags: &mut Diagnostics) -> Pruned<'s> {
    let mut pruned = Pruned::untouched(scene, files);
    run(&mut pruned);
    let wanted: Vec<ImageId> = pruned.reached().textured.into_iter().collect();
    pruned.images.decode_all(&wanted, diags);
    run(&mut pruned);
    sky::image(&mut pruned);
    unreachable::pass(&mut pruned);
    attributes::pass(&mut pruned);
    pruned.what.sort_by_key(|removal| removal.pass);
    pruned
}

/// All passes that change something, once.
fn run(pruned: &mut Pruned<'_>) {
    lens::pass(pruned);
    motion::pass(pruned);
    lights::pass(pruned);
    sky::pass(pruned);
    fold::pass(pruned);
    surfaces::pass(pruned);
    coverage::pass(pruned);
    relief::pass(pruned);
    media::pass(pruned);
    unseen::pass(pruned);
}
