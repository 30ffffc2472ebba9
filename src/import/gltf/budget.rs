//! What a file may cost, in proportion to its own bytes.
//!
//! Elements that are stored once can be referred to without end: accessors over one view, packed views over one stream,
//! nodes with weights of their own over one mesh. Each such way is counted for the whole file and ends at a number that
//! is far above what models need.

use super::Loader;
use crate::diag::Diagnostic;

/// Something that a small file could ask for without end.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Cost {
    /// Numbers of accessors, each time they are read.
    Numbers,
    /// Numbers of accessors without a view, each time they are read: nothing in the file holds them.
    Zeros,
    /// Bytes of packed views.
    Unpacked,
    /// Bytes of images in views.
    Images,
    /// Objects that nodes and instances place.
    Objects,
    /// Primitives, each time their mesh is read: once, or for each node that bends it.
    Primitives,
    /// Joints of skins, for each node that has the skin.
    Joints,
}

/// How many there are of them.
const KINDS: usize = 7;

impl Cost {
    /// What any file may have, how many more for each 16 of its bytes, and what to call it.
    fn bound(self) -> (u64, u64, &'static str) {
        match self {
            Cost::Numbers => (1 << 28, 16 * 64, "numbers in accessors"),
            Cost::Zeros => (1 << 24, 16 * 4, "numbers in accessors without a `bufferView`"),
            Cost::Unpacked => (1 << 28, 16 * 16, "bytes in packed views"),
            Cost::Images => (1 << 24, 16 * 4, "bytes of images in views"),
            Cost::Objects => (500_000, 4, "objects"),
            Cost::Primitives => (250_000, 2, "primitives to be read"),
            Cost::Joints => (4_000_000, 16 * 4, "joints to be placed"),
        }
    }
}

/// What was spent so far.
#[derive(Default)]
pub(super) struct Spent {
    spent: [u64; KINDS],
    told: [bool; KINDS],
}

impl Loader<'_> {
    /// Counts a cost; `None` (reported once for each kind) if the file has no right to it.
    pub(super) fn afford(&mut self, cost: Cost, amount: u64, at: &str) -> Option<()> {
        let (base, for_16_bytes, what) = cost.bound();
        let most = base.saturating_add((self.read_bytes / 16).saturating_mul(for_16_bytes));
        let spent = &mut self.spent.spent[cost as usize];
        let all = spent.saturating_add(amount);
        if all <= most {
            *spent = all;
            return Some(());
        }
        if !std::mem::replace(&mut self.spent.told[cost as usize], true) {
            let code = if cost == Cost::Zeros { "G0405" } else { "G0620" };
            let message = format!(
                "the model has {all} {what}, but at most {most} for a file of {} bytes",
                self.read_bytes
            );
            let hint = "a count is damaged, or a compressed model lost its data: export it again";
            self.report.push(at, Diagnostic::error(code, message).hint(hint));
        }
        None
    }
}
