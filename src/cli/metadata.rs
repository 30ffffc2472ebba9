//! What a picture says about how it was made, and the fingerprint of the scene it shows.

use super::accuracy::error_to_json;
use super::args::RenderArgs;
use super::parts::anomalies_to_json;
use super::plan::Goal;
use super::replay;
use crate::files::Files;
use crate::math::fnv::Fnv;
use crate::math::words::grouped;
use crate::render::report::{Report, StopReason};
use crate::render::settings::{Filter, Settings};
use crate::render::technique::Choice;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// Files that remember the fingerprints of all contents read through them.
pub struct HashingFiles<F> {
    inner: F,
    contents: Mutex<BTreeSet<u64>>,
}

impl<F: Files> HashingFiles<F> {
    /// Nothing was read yet.
    pub fn new(inner: F) -> HashingFiles<F> {
        HashingFiles {
            inner,
            contents: Mutex::default(),
        }
    }

    /// The fingerprint of everything that was read, of the declarations, of the clock and of the shutter, as 16 hexadecimal digits.
    /// Names of files and the order of reading do not count.
    pub fn scene_hash(&self, args: &RenderArgs) -> String {
        let mut hash = Fnv::default();
        for content in self.contents.lock().unwrap_or_else(|e| e.into_inner()).iter() {
            hash.write(&content.to_le_bytes());
        }
        let load = &args.load;
        let choices = [&load.gltf_scene, &load.variant].map(|o| o.as_deref().unwrap_or_default());
        let defines = load
            .define
            .iter()
            .flat_map(|(name, value)| [name.as_str(), value.as_str()]);
        for word in defines.chain(choices) {
            hash.write(word.as_bytes());
            hash.write(&[0]);
        }
        hash.write(&load.clock.unwrap_or(0.0).to_le_bytes());
        // A clock of 0 plays a model's animations, no clock does not; a shutter of 0 is not that of the scene.
        if load.clock.is_some() || load.shutter.is_some() {
            hash.write(&[u8::from(load.clock.is_some()), u8::from(load.shutter.is_some())]);
            hash.write(&load.shutter.unwrap_or(0.0).to_le_bytes());
        }
        if let Some(animation) = &load.animation {
            hash.write(animation.as_bytes());
        }
        if let Some(glass) = load.glass {
            hash.write(format!("{glass:?}").as_bytes());
        }
        // A frame knows its animation.
        if let Some(moment) = &load.moment {
            hash.write(format!("{moment:?}").as_bytes());
        }
        format!("{:016x}", hash.value())
    }
}

impl<F: Files> Files for HashingFiles<F> {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        let data = self.inner.read(path)?;
        let mut hash = Fnv::default();
        hash.write(&data);
        self.contents
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .insert(hash.value());
        Ok(data)
    }

    fn exists(&self, path: &Path) -> bool {
        self.inner.exists(path)
    }

    fn size(&self, path: &Path) -> Option<u64> {
        self.inner.size(path)
    }

    fn list(&self, dir: &Path) -> Vec<String> {
        self.inner.list(dir)
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.inner.opened()
    }
}

/// The word for a stop reason in files and events.
pub fn stop_word(stop: StopReason) -> &'static str {
    match stop {
        StopReason::Samples => "samples",
        StopReason::Time => "time",
        StopReason::Error => "error",
        StopReason::ErrorMax => "error_max",
        StopReason::ErrorDisplay => "error_display",
        StopReason::Interrupted => "interrupted",
    }
}

/// The JSON object that is written into images. All but its story follows from the picture and the command that makes
/// it again, so that they give the same file byte by byte. `with_story` adds why the render stopped, the goals, their
/// figures, the effects of the scene and the seconds; an interrupted picture, which no command makes again, always says that it is one.
pub fn describe(
    args: &RenderArgs,
    hash: &str,
    settings: &Settings,
    goal: &Goal,
    report: &Report,
    effects: &[&str],
    with_story: bool,
) -> Value {
    let name = args.scene().file_name().map(|n| n.to_string_lossy().into_owned());
    let mut value = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": name,
        "scene_hash": hash,
        "command": replay::command(args, settings, report.spp, false),
        "seed": settings.seed,
        "spp": report.spp,
        "nets": settings.nets,
        "max_depth": (settings.technique.max_depth != u32::MAX).then_some(settings.technique.max_depth),
        "filter": filter_word(settings.filter),
        "direct": settings.technique.direct.word(),
        "confidence": goal.rules.confidence,
    });
    let mut error = report.error;
    if let Some(error) = error.as_mut().filter(|_| !with_story) {
        (error.worst, error.display) = (None, None);
    }
    value["error"] = error_to_json(error.as_ref());
    value["anomalies"] = anomalies_to_json(&report.anomalies);
    let (technique, biased) = (settings.technique.flags(), args.sampling.biased());
    stamp(&mut value, &technique, &biased, report.clamped);
    if with_story || report.stop == StopReason::Interrupted {
        value["stop"] = json!(stop_word(report.stop));
    }
    if with_story {
        let rules = &goal.rules;
        value["error_goal"] = json!(rules.error);
        value["error_max_goal"] = json!(rules.error_max);
        value["error_display_goal"] = json!(rules.error_display);
        value["effects"] = json!(effects);
        value["seconds"] = json!((report.seconds * 1e3).round() / 1e3);
    }
    value
}

/// The word of a filter on the command line.
pub fn filter_word(filter: Filter) -> &'static str {
    match filter {
        Filter::Box => "box",
        Filter::Gaussian => "gaussian",
        Filter::BlackmanHarris => "blackman-harris",
    }
}

/// Writes down by which technique a picture was made, and what biases it; nothing of the usual one.
pub fn stamp(value: &mut Value, technique: &[String], biased: &[String], clamped: u64) {
    if !technique.is_empty() {
        value["technique"] = json!(technique.join(" "));
    }
    if !biased.is_empty() {
        value["biased"] = json!(bias_words(biased, clamped));
    }
}

/// The flags that bias a picture, in one line: `--clamp 10 (12 345 samples clamped), --no-caustics`.
pub fn bias_words(biased: &[String], clamped: u64) -> String {
    let told = biased.iter().map(|flag| {
        if flag.starts_with("--clamp ") {
            format!("{flag} ({} samples clamped)", grouped(clamped))
        } else if flag.starts_with("--without ") {
            format!("{flag} (not the scene as written)")
        } else {
            flag.clone()
        }
    });
    told.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Cli, Command};
    use crate::files::MemoryFiles;
    use clap::Parser;

    fn hash(contents: &[&str], flags: &[&str]) -> String {
        let words = ["pts", "render", "a.pts"].iter().chain(flags);
        let Some(Command::Render(args)) = Cli::parse_from(words).command else {
            panic!("`render` is not the command");
        };
        let mut inner = MemoryFiles::default();
        for (i, content) in contents.iter().enumerate() {
            inner.insert(format!("{i}"), content.as_bytes());
        }
        let files = HashingFiles::new(inner);
        for i in 0..contents.len() {
            files.read(Path::new(&i.to_string())).unwrap();
        }
        files.scene_hash(&args)
    }

    #[test]
    fn the_scene_hash_depends_on_contents_and_declarations_only() {
        let base = hash(&["sphere", "box"], &[]);
        assert_eq!(base, hash(&["box", "sphere"], &["--seed", "3", "-s", "9"]));
        assert_ne!(base, hash(&["sphere", "cone"], &[]));
        assert_ne!(base, hash(&["sphere", "box"], &["-D", "r=2"]));
        assert_ne!(base, hash(&["sphere", "box"], &["--clock", "1"]));
        assert_ne!(base, hash(&["sphere", "box"], &["--shutter", "1"]));
    }
}
