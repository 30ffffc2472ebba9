//! What was repaired or left out, counted by kind: nothing is mended in silence.
//!
//! The front ends and `compile` count what they mend in a scene, on the diagnostic that tells of it; the engine counts
//! what goes wrong in samples. The summary of a render, its events and the metadata of images show all of it.

/// A kind of repair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anomaly {
    /// A sample with a NaN or infinite value, or one beyond the range of f32; it counts as a black sample.
    NonFinite,
    /// A path that ended because media or surfaces are nested deeper than its stack holds.
    StackOverflow,
    /// A face without area, or with a corner that is not finite.
    DroppedFace,
    /// An object or a lamp without extent, with a transform that cannot be undone, or not finite.
    DroppedShape,
    /// A shading normal without direction; that of the faces around it is used.
    ReplacedNormal,
    /// A number of the scene outside what it can mean, moved to where it means something.
    MovedValue,
    /// A texel that is not finite or, where it is light, negative; it counts as 0.
    BadTexel,
}

use Anomaly::*;

/// How often each kind happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Anomalies([u64; Anomaly::ALL.len()]);

impl Anomaly {
    /// All kinds, those of samples first.
    pub const ALL: [Anomaly; 7] = [
        NonFinite,
        StackOverflow,
        DroppedFace,
        DroppedShape,
        ReplacedNormal,
        MovedValue,
        BadTexel,
    ];

    /// Its name in files and events.
    pub fn word(self) -> &'static str {
        match self {
            NonFinite => "non_finite",
            StackOverflow => "stack_overflow",
            DroppedFace => "dropped_faces",
            DroppedShape => "dropped_shapes",
            ReplacedNormal => "replaced_normals",
            MovedValue => "moved_values",
            BadTexel => "bad_texels",
        }
    }

    /// What happened, after a number: `12 samples were not finite and count as black`.
    pub fn sentence(self) -> &'static str {
        match self {
            NonFinite => "samples were not finite and count as black",
            StackOverflow => "paths ended because media or surfaces are nested too deeply",
            DroppedFace => "faces without area or with bad corners are left out",
            DroppedShape => "objects without extent or with a bad transform are left out",
            ReplacedNormal => "normals without direction are replaced by those of their faces",
            MovedValue => "values of the scene were outside their range and are moved into it",
            BadTexel => "texels are negative or not finite and count as 0",
        }
    }

    /// Whether it happens to samples, so that more samples have more of it; otherwise it belongs to the scene.
    pub fn is_of_samples(self) -> bool {
        matches!(self, NonFinite | StackOverflow)
    }
}

impl Anomalies {
    /// Counts `n` more of a kind.
    pub fn count(&mut self, kind: Anomaly, n: u64) {
        let of_kind = &mut self.0[kind as usize];
        *of_kind = of_kind.saturating_add(n);
    }

    /// How many there are of a kind.
    pub fn of(&self, kind: Anomaly) -> u64 {
        self.0[kind as usize]
    }

    /// Whether nothing happened.
    pub fn is_empty(&self) -> bool {
        *self == Anomalies::default()
    }

    /// Every kind with its number, in the order of [`Anomaly::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Anomaly, u64)> + '_ {
        Anomaly::ALL.into_iter().map(|kind| (kind, self.of(kind)))
    }

    /// Adds another tally.
    pub fn add(&mut self, other: &Anomalies) {
        other.iter().for_each(|(kind, n)| self.count(kind, n));
    }

    /// Takes in what happened to other samples of the same scene: what belongs to the scene counts once.
    pub fn join(&mut self, other: &Anomalies) {
        for (kind, n) in other.iter() {
            if kind.is_of_samples() {
                self.count(kind, n);
            } else {
                self.0[kind as usize] = self.of(kind).max(n);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_counted_apart_and_words_differ() {
        let mut all = Anomalies::default();
        assert!(all.is_empty());
        for (i, kind) in Anomaly::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, i);
            all.count(kind, i as u64 + 1);
        }
        let words: std::collections::BTreeSet<_> = Anomaly::ALL.map(Anomaly::word).into_iter().collect();
        assert_eq!(words.len(), Anomaly::ALL.len());
        assert!(all.iter().enumerate().all(|(i, (_, n))| n == i as u64 + 1));
        all.count(NonFinite, u64::MAX);
        assert_eq!(all.of(NonFinite), u64::MAX);
    }

    #[test]
    fn parts_of_one_picture_share_what_belongs_to_the_scene() {
        let mut part = Anomalies::default();
        part.count(NonFinite, 2);
        part.count(DroppedFace, 3);
        let mut whole = part;
        whole.join(&part);
        assert_eq!((whole.of(NonFinite), whole.of(DroppedFace)), (4, 3));
    }
}
