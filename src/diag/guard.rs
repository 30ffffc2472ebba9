//! Decoders of other people's, fed with bytes that we do not control.

use std::cell::Cell;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder; `None` if it panics, which is a fault of its input that the caller reports as any other. The
/// program's panic hook stays silent meanwhile.
pub fn guarded<T>(decode: impl FnOnce() -> T) -> Option<T> {
    let before = GUARDED.replace(true);
    // What the decoder has half written is dropped with it.
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)).ok();
    GUARDED.set(before);
    result
}

/// Whether a panic on this thread would be caught by [`guarded`].
pub fn is_guarded() -> bool {
    GUARDED.get()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_nothing_and_the_guard_ends_with_it() {
        assert_eq!(guarded(|| (is_guarded(), 7)), Some((true, 7)));
        let nothing: Option<()> = guarded(|| std::panic::resume_unwind(Box::new("decoder")));
        assert_eq!(nothing, None);
        assert!(!is_guarded());
        let outer = guarded(|| (guarded(|| ()).is_some(), is_guarded()));
        assert_eq!(outer, Some((true, true)), "the outer guard outlives the inner");
    }
}
