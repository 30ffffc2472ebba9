//! What was taken out of a scene because its picture does not need it, as rows and as JSON.

use super::text::{prefix, row};
use super::{Found, place};
use crate::compile::prune::{Removal, Saved};
use crate::diag::SourceMap;
use crate::math::words::{bytes, grouped};
use serde_json::{Value, json};

/// Things of a kind that are told by name; the others are counted.
const TOLD: usize = 5;

impl Found {
    /// A row for each thing, of each kind at most a few, and a last one with all that is saved.
    pub(super) fn pruned_rows(&self, sources: &SourceMap) -> Vec<String> {
        let Some(removals) = &self.pruned else {
            return vec![row("", "nothing, as --no-prune asks")];
        };
        if removals.is_empty() {
            return vec![row("", "nothing: the picture needs all of the scene")];
        }
        let mut rows = Vec::new();
        let mut kinds: Vec<&str> = Vec::new();
        for removal in removals {
            if !kinds.contains(&removal.kind) {
                kinds.push(removal.kind);
            }
        }
        for kind in kinds {
            let of_kind: Vec<&Removal> = removals.iter().filter(|r| r.kind == kind).collect();
            for (i, removal) in of_kind.iter().take(TOLD).enumerate() {
                rows.push(row(if i == 0 { kind } else { "" }, &line(removal, sources)));
            }
            if let Some(more @ 1..) = of_kind.len().checked_sub(TOLD) {
                let rest = total(of_kind[TOLD..].iter().copied());
                rows.push(row(
                    "",
                    &format!("and {} more{}", grouped(more as u64), bracketed(&rest)),
                ));
            }
        }
        let saved = words(&total(removals.iter()));
        if !saved.is_empty() {
            rows.push(row("saved in all", &saved));
        }
        rows
    }

    /// Everything, and the sums.
    pub(super) fn pruned_json(&self, sources: &SourceMap) -> [Value; 2] {
        let removals = self.pruned.as_deref().unwrap_or_default();
        let one = |r: &Removal| {
            json!({
                "pass": r.pass.word(),
                "kind": r.kind,
                "name": r.name,
                "why": r.why,
                "place": place(&r.place, sources),
                "saved": saved_json(&r.saved),
            })
        };
        let all: Vec<Value> = removals.iter().map(one).collect();
        [Value::from(all), saved_json(&total(removals.iter()))]
    }
}

/// `a.pts:4:1: "fill" it is dark (1 light)`
fn line(removal: &Removal, sources: &SourceMap) -> String {
    let name = match removal.name.as_str() {
        "" => String::new(),
        name if removal.kind == "vertex data" => format!("{name}: "),
        name => format!("\"{name}\": "),
    };
    let (at, why) = (prefix(&removal.place, sources), &removal.why);
    format!("{at}{name}{why}{}", bracketed(&removal.saved))
}

fn bracketed(saved: &Saved) -> String {
    // An object that is gone need not be counted.
    let told = Saved {
        objects: 0,
        files: Vec::new(),
        ..saved.clone()
    };
    match words(&told) {
        empty if empty.is_empty() => empty,
        some => format!(" ({some})"),
    }
}

fn total<'r>(removals: impl Iterator<Item = &'r Removal>) -> Saved {
    let mut sum = Saved::default();
    for Removal { saved, .. } in removals {
        sum.files.extend(saved.files.iter().cloned());
        sum.bytes += saved.bytes;
        sum.lights += saved.lights;
        sum.objects += saved.objects;
    }
    sum.files.sort();
    sum.files.dedup();
    sum
}

/// `2 files not opened, 12.4 MB, 1 light, 3 objects`; empty for nothing.
fn words(saved: &Saved) -> String {
    let count = |n: u64, one: &str, many: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{} {many}", grouped(n))),
    };
    let parts = [
        count(saved.files.len() as u64, "file not opened", "files not opened"),
        (saved.bytes > 0).then(|| bytes(saved.bytes)),
        count(saved.lights, "light", "lights"),
        count(saved.objects, "object", "objects"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn saved_json(saved: &Saved) -> Value {
    let files: Vec<String> = saved.files.iter().map(|p| p.display().to_string()).collect();
    json!({"files": files, "bytes": saved.bytes, "lights": saved.lights, "objects": saved.objects})
}
