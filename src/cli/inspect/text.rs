//! What was found, for people.

use super::measure::Until;
use super::{Found, place};
use crate::compile::effects::Effect;
use crate::compile::effects::causes::Cause;
use crate::diag::SourceMap;
use crate::math::words::{bytes, duration, grouped};
use crate::render::kernel::tier::KernelTier;
use crate::scene::Place;
use std::path::Path;

/// Causes of an effect that are told by name; the others are counted.
const CAUSES_TOLD: usize = 3;
/// Files that are told by name.
const FILES_TOLD: usize = 12;

impl Found {
    /// Sections of rows: what, then what there is to say about it.
    pub(super) fn text(&self, sources: &SourceMap) -> String {
        let mut lines = vec![format!("{}  {}x{}", self.name, self.size[0], self.size[1])];
        lines.push("effects".to_owned());
        for effect in self.effects.iter() {
            let causes = self.effects.causes(effect);
            let mut told: Vec<String> = causes.iter().take(CAUSES_TOLD).map(|c| cause(c, sources)).collect();
            if causes.len() > CAUSES_TOLD {
                told.push(format!("and {} more", grouped((causes.len() - CAUSES_TOLD) as u64)));
            }
            for (i, told) in told.iter().enumerate() {
                lines.push(row(if i == 0 { effect.word() } else { "" }, told));
            }
            let share = self.measured.as_ref().and_then(|m| m.share(effect));
            lines.extend(share.map(|(share, error)| row("", &time_share(share, error))));
        }
        let off = Effect::ALL.into_iter().filter(|e| !self.effects.has(*e));
        let off: Vec<&str> = off.map(Effect::word).collect();
        lines.push("not called for".to_owned());
        lines.push(row("", &off.join(", ")));
        lines.push("pruned".to_owned());
        lines.extend(self.pruned_rows(sources));
        lines.push("size".to_owned());
        let size = self.measure();
        lines.push(row("objects", &grouped(size.objects)));
        let triangles = format!("{} ({})", grouped(size.triangles), bytes(size.mesh_bytes));
        lines.push(row("triangles", &triangles));
        lines.push(row("lights", &grouped(size.lights)));
        if size.solids > 0 {
            let pairs = match size.meetings {
                0 => "none within another".to_owned(),
                1 => "two may touch or lie within each other".to_owned(),
                n => format!("{} pairs may touch or lie within each other", grouped(n)),
            };
            lines.push(row("solids", &format!("{} ({pairs})", grouped(size.solids))));
        }
        if size.media > 0 {
            lines.push(row("media", &grouped(size.media)));
        }
        let depth = self
            .scene
            .defaults
            .max_depth
            .map_or("no limit".to_owned(), |n| n.to_string());
        lines.push(row("bounces", &depth));
        let kernel = match size.kernel {
            KernelTier::Surfaces => "surfaces: without media and dispersion",
            KernelTier::All => "all: with media and dispersion",
        };
        lines.push(row("kernel", kernel));
        let textures = format!("{} ({})", grouped(size.images), bytes(size.image_bytes));
        lines.push(row("textures", &textures));
        let files = self.opened.iter().take(FILES_TOLD);
        lines.extend(
            files
                .enumerate()
                .map(|(i, file)| row(if i == 0 { "files read" } else { "" }, file)),
        );
        if self.opened.len() > FILES_TOLD {
            let more = grouped((self.opened.len() - FILES_TOLD) as u64);
            lines.push(row("", &format!("and {more} more")));
        }
        lines.extend(self.names.rows());
        if let Some(measured) = &self.measured {
            lines.push("measured".to_owned());
            if let Some(until) = &measured.forecast {
                lines.push(row("forecast", &forecast(until, self.size)));
            }
            let [w, h] = measured.size;
            lines.push(row("", &format!("with pictures of {w}x{h}, on all threads")));
            lines.extend(measured.notes.iter().map(|note| row("", note)));
        }
        if !self.hints.is_empty() {
            lines.push("hints".to_owned());
            for (hint, at) in &self.hints {
                lines.push(row("", &format!("{}{hint}", prefix(at, sources))));
            }
        }
        self.shorten(&mut lines[1..]);
        lines.join("\n") + "\n"
    }

    /// In a model all places are in one file, and the files it reads lie beside it: neither is told again in each line.
    fn shorten(&self, lines: &mut [String]) {
        let extension = Path::new(&self.name)
            .extension()
            .unwrap_or_default()
            .to_ascii_lowercase();
        if !["gltf", "glb", "obj"].iter().any(|e| extension == *e) {
            return;
        }
        let here = format!("{}: ", self.name);
        let folder = Path::new(&self.name).parent().filter(|f| *f != Path::new(""));
        let folder = folder.map(|f| format!("{}/", f.display()));
        for line in lines {
            *line = line.replace(&here, "");
            if let Some(folder) = &folder {
                *line = line.replace(folder, "");
            }
        }
    }
}

/// `38 ± 2 % of the time`
fn time_share(share: f64, error: f64) -> String {
    format!(
        "takes {:.0} ± {:.0} % of the time",
        share * 100.0,
        (error * 100.0).max(1.0)
    )
}

/// `28 s to 1:00 min until an error of 2 % at 800x600`
fn forecast(until: &Until, [w, h]: [u32; 2]) -> String {
    let [from, to] = until.seconds;
    let goal = until.goal * 100.0;
    let time = match from == to {
        true => format!("about {}", duration(from)),
        false => format!("{} to {}", duration(from), duration(to)),
    };
    format!("{time} until an error of {goal} % at {w}x{h}")
}

/// A line of a section.
pub(super) fn row(head: &str, rest: &str) -> String {
    format!("  {head:<13} {rest}").trim_end().to_owned()
}

/// A place with a colon, or nothing.
pub(super) fn prefix(at: &Place, sources: &SourceMap) -> String {
    place(at, sources).map_or(String::new(), |p| format!("{p}: "))
}

/// `scene.pts:41:3: sphere "ball" (glass of ior 1.5)`
fn cause(c: &Cause, sources: &SourceMap) -> String {
    let times = if c.times > 1 {
        format!(", {} times", grouped(c.times))
    } else {
        String::new()
    };
    format!("{}{} ({}{times})", prefix(&c.place, sources), c.what, c.why)
}
