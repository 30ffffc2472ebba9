//! `--checkpoint` and `--resume`: a render that survives its process.

use super::Exit;
use super::args::PartArgs;
use super::console::Console;
use super::outputs::{self, Refusal};
use super::parts;
use crate::output::part::{Part, read_part};
use serde_json::Value;
use std::path::Path;
use std::time::Duration;

/// Seconds between checkpoints.
const DEFAULT_INTERVAL: f64 = 60.0;

/// Everything that can be wrong without looking at the scene.
pub fn check(args: &PartArgs) -> Result<(), Refusal> {
    let Some(path) = &args.checkpoint else {
        return Ok(());
    };
    if path.exists() && !args.resume {
        let message =
            format!("the checkpoint {path:?} exists: add --resume to go on from it, or remove it to begin anew");
        return Err((Exit::Usage, message));
    }
    outputs::check_writable(path)
}

/// How often the checkpoint is written.
pub fn interval(args: &PartArgs) -> Duration {
    Duration::try_from_secs_f64(args.every.unwrap_or(DEFAULT_INTERVAL)).unwrap_or(Duration::MAX)
}

/// The checkpoint to go on from, which must be of the picture that `header` tells; `None` to begin anew.
pub fn resume(args: &PartArgs, header: &Value, console: &Console) -> Result<Option<Part>, Refusal> {
    let Some(path) = args.checkpoint.as_deref().filter(|_| args.resume) else {
        return Ok(None);
    };
    if !path.exists() {
        console.warn(&format!(
            "there is no checkpoint {path:?} yet: rendering begins with the first sample"
        ));
        return Ok(None);
    }
    let part = read_part(path).map_err(|e| (Exit::Scene, e.to_string()))?;
    match parts::difference(&part.header, header) {
        Some(why) => Err(cannot_resume(path, &why)),
        None => Ok(Some(part)),
    }
}

/// The refusal of a checkpoint that does not fit.
pub fn cannot_resume(path: &Path, why: &dyn std::fmt::Display) -> Refusal {
    (Exit::Scene, format!("cannot go on from {path:?}: {why}"))
}
