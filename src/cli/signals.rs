//! Ctrl-C and termination: the first one ends the render early and keeps its picture, the second quits.
//!
//! Before the first sample there is nothing to keep, so that the first one quits too.

use super::Exit;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// Signals belong to the process, and so does this state.
static STOP_ASKED: AtomicBool = AtomicBool::new(false);
static HAS_PICTURE: AtomicBool = AtomicBool::new(false);

/// Starts to listen. Without the permission to do so the default action of the signals remains.
pub fn install(announce: bool) {
    install_for(announce, "the picture so far is saved");
}

/// As [`install`], with words of its own for what is kept.
pub fn install_for(announce: bool, kept: &'static str) {
    let _ = ctrlc::set_handler(move || {
        let first = !STOP_ASKED.swap(true, Ordering::SeqCst);
        if !first || !HAS_PICTURE.load(Ordering::SeqCst) {
            std::process::exit(i32::from(Exit::Interrupted.code()));
        }
        if announce {
            let _ = writeln!(std::io::stderr(), "\nstopping; {kept} (once more to quit without it)");
        }
    });
}

/// From now on an interruption keeps the picture so far.
pub fn rendering_begins() {
    HAS_PICTURE.store(true, Ordering::SeqCst);
}

/// Whether the user wants the render to end.
pub fn stop_asked() -> bool {
    STOP_ASKED.load(Ordering::Relaxed)
}
