//! Tells the program which commit it was built from, if it was built from a repository of its own.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let here = std::env::var_os("CARGO_MANIFEST_DIR")
        .map(PathBuf::from)
        .unwrap_or_default();
    // A copy inside of somebody else's repository has no commit.
    let top = git(&here, &["rev-parse", "--show-toplevel"]).map(PathBuf::from);
    let is_own = top.is_some_and(|top| top.canonicalize().ok() == here.canonicalize().ok());
    if !is_own {
        return;
    }
    if let Some(log) = git(&here, &["rev-parse", "--git-path", "logs/HEAD"]).map(|log| here.join(log))
        && log.exists()
    {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    if let Some(commit) = git(&here, &["rev-parse", "--short", "HEAD"]) {
        println!("cargo:rustc-env=PTS_COMMIT={commit}");
    }
}

/// What git says in one line; `None` without git, without a repository, or where it fails.
fn git(directory: &Path, words: &[&str]) -> Option<String> {
    let output = Command::new("git").current_dir(directory).args(words).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}
