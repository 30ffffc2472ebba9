//! What was found, for people.

use super::{Found, place};
use crate::compile::effects::Effect;
use crate::compile::effects::causes::Cause;
use crate::diag::SourceMap;
use crate::math::words::{bytes, grouped};
use crate::scene::Place;

/// Causes of an effect that are told by name; the others are counted.
const CAUSES_TOLD: usize = 3;

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
        let textures = format!("{} ({})", grouped(size.images), bytes(size.image_bytes));
        lines.push(row("textures", &textures));
        lines.push(row("files read", &self.opened.join(", ")));
        if !self.hints.is_empty() {
            lines.push("hints".to_owned());
            for (hint, at) in &self.hints {
                lines.push(row("", &format!("{}{hint}", prefix(at, sources))));
            }
        }
        lines.join("\n") + "\n"
    }
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
