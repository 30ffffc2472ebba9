//! A study as tables: Markdown to read, CSV and JSON to compute with.

use super::experiment::{Ablation, Goal, Kind, Row, Study, Variant};
use super::fit::Law;
use super::points::{pareto, points};
use super::recommend::recommend;
use crate::math::words::{duration, percent, range, rough_percent, significant};
use serde_json::{Value, json};

/// Version of the layout of [`json`]: raised when a field changes its meaning or goes.
pub const FORMAT: u32 = 1;

/// The columns of [`csv`].
const COLUMNS: [&str; 28] = [
    "axis",
    "variant",
    "kind",
    "flags",
    "seed",
    "threads",
    "spp",
    "samples",
    "rays",
    "seconds",
    "seconds_load",
    "seconds_compile",
    "seconds_render",
    "error",
    "error_low",
    "error_high",
    "error_squared",
    "error_squared_se",
    "own_estimate",
    "own_bound",
    "flip",
    "energy",
    "scene",
    "width",
    "height",
    "version",
    "processor",
    "reference_error",
];

/// One line for each variant and seed after a line of names, by RFC 4180 (lines end in CR LF). Seconds; errors as
/// shares, not percent; numbers that do not exist are empty.
pub fn csv(study: &Study) -> String {
    let mut out = COLUMNS.join(",") + "\r\n";
    for row in &study.rows {
        let fields: Vec<String> = csv_fields(study, row).iter().map(|field| csv_field(field)).collect();
        out += &fields.join(",");
        out += "\r\n";
    }
    out
}

fn csv_fields(study: &Study, row: &Row) -> [String; 28] {
    let number = |x: f64| if x.is_finite() { x.to_string() } else { String::new() };
    let known = |x: Option<f64>| x.map_or(String::new(), number);
    let variant = study.variants.get(row.variant);
    let word = |of: fn(&Variant) -> &str| variant.map_or(String::new(), |v| of(v).to_owned());
    let [low, high] = row.interval();
    let [width, height] = study.size;
    [
        word(|v| &v.axis),
        word(|v| &v.name),
        word(|v| kind(v.kind)),
        word(|v| &v.flags),
        row.seed.to_string(),
        row.threads.to_string(),
        row.spp.to_string(),
        row.samples.to_string(),
        row.rays.to_string(),
        number(row.seconds.total()),
        number(row.seconds.load),
        number(row.seconds.compile),
        number(row.seconds.render),
        // max() in error() would turn NaN into 0.
        known(row.e2.is_finite().then(|| row.error())),
        known(row.e2.is_finite().then_some(low)),
        known(row.e2.is_finite().then_some(high)),
        number(row.e2),
        number(row.e2_se),
        known(row.estimate.map(|e| e[0])),
        known(row.estimate.map(|e| e[1])),
        number(row.flip),
        number(row.energy),
        study.scene.clone(),
        width.to_string(),
        height.to_string(),
        study.version.clone(),
        study.processor.clone(),
        known(study.reference.error),
    ]
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Variance => "variance",
        Kind::Bias => "bias",
    }
}

/// A field in quotes where commas, quotes or line ends ask for it.
fn csv_field(text: &str) -> String {
    match text.contains([',', '"', '\r', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// Everything in the study, its points, laws, front and recommendation. Seconds; errors as shares, not percent;
/// numbers that do not exist are null. `format` is [`FORMAT`].
pub fn json(study: &Study) -> Value {
    let points = points(study);
    let front = pareto(&points);
    let point = |(i, p): (usize, &super::experiment::Point)| {
        json!({
            "variant": p.variant, "spp": p.spp, "threads": p.threads, "rows": p.rows, "seconds": p.seconds,
            "error": p.error, "spread": [p.spread.start, p.spread.end], "front": front.contains(&i),
        })
    };
    let variant = |(i, v): (usize, &Variant)| {
        json!({
            "axis": v.axis, "name": v.name, "kind": kind(v.kind), "flags": v.flags,
            "law": Law::of(study, i).map(|law| json!({
                "exponent": law.exponent, "exponent_se": law.exponent_se, "floor": law.floor,
                "floor_bound": law.floor_bound, "seconds_setup": law.setup, "seconds_per_sample": law.per_sample,
            })),
        })
    };
    let ablation = |a: &Ablation| {
        json!({
            "effect": a.effect, "time": a.time, "time_se": a.time_se, "energy": a.energy, "energy_se": a.energy_se,
            "flip": a.flip, "blocks": a.blocks, "significant": a.significant,
        })
    };
    let recommendation = recommend(study);
    let r = &study.reference;
    json!({
        "format": FORMAT,
        "scene": study.scene,
        "width": study.size[0],
        "height": study.size[1],
        "full_width": study.full_size[0],
        "full_height": study.full_size[1],
        "command": study.command,
        "version": study.version,
        "processor": study.processor,
        "threads": study.threads,
        "seconds": study.seconds,
        "reference": { "source": r.source, "spp": r.spp, "error": r.error, "seconds": r.seconds },
        "goal": match study.goal {
            Goal::Error(e) => json!({ "error": e }),
            Goal::Seconds(s) => json!({ "seconds": s }),
        },
        "variants": study.variants.iter().enumerate().map(variant).collect::<Vec<_>>(),
        "rows": study.rows.iter().map(json_row).collect::<Vec<_>>(),
        "points": points.iter().enumerate().map(point).collect::<Vec<_>>(),
        "ablations": study.ablations.iter().map(ablation).collect::<Vec<_>>(),
        "recommendation": {
            "text": recommendation.text,
            "choice": recommendation.choice.map(|c| json!({
                "variant": c.variant, "command": c.command, "spp": c.spp, "error": c.error, "seconds": c.seconds,
            })),
        },
        "notes": study.notes,
    })
}

fn json_row(row: &Row) -> Value {
    let known = row.e2.is_finite();
    let s = &row.seconds;
    json!({
        "variant": row.variant, "seed": row.seed, "threads": row.threads, "spp": row.spp, "samples": row.samples,
        "rays": row.rays,
        "seconds": { "load": s.load, "compile": s.compile, "render": s.render, "total": s.total() },
        "error": known.then(|| row.error()), "interval": known.then(|| row.interval()),
        "error_squared": row.e2, "error_squared_se": row.e2_se,
        "estimate": row.estimate.map(|e| json!({ "error": e[0], "bound": e[1] })),
        "flip": row.flip, "energy": row.energy,
    })
}

/// The report to read: recommendation, points, Pareto front, effects, reference and machine, notes.
pub fn markdown(study: &Study) -> String {
    let [width, height] = study.size;
    let mut sections = vec![format!(
        "# Error against time: {}\n\n{width} × {height} pixels, {} threads, {}, pts {}. Made in {} by\n\n    {}",
        inline(&study.scene),
        study.threads,
        inline(&study.processor),
        inline(&study.version),
        duration(study.seconds),
        inline(&study.command),
    )];
    sections.push(format!("## Recommendation\n\n{}", recommend(study).text));
    sections.push(point_table(study));
    sections.push(front_table(study));
    if !study.ablations.is_empty() {
        let lines: Vec<String> = study.ablations.iter().map(|a| format!("- {}", effect(a))).collect();
        sections.push(format!(
            "## What effects cost\n\nEach effect left out alone: the share of the render's time and of the light that \
             goes with it, and how different the picture looks (mean FLIP, 0 to 1).\n\n{}",
            lines.join("\n")
        ));
    }
    sections.push(reference(study));
    if !study.notes.is_empty() {
        let lines: Vec<String> = study.notes.iter().map(|note| format!("- {}", inline(note))).collect();
        sections.push(format!("## Notes\n\n{}", lines.join("\n")));
    }
    sections.join("\n\n") + "\n"
}

/// `caustics: 41 % of time, 2.3 % of energy, FLIP 0.020`.
pub fn effect(ablation: &Ablation) -> String {
    let time = match ablation.time.abs() > 2.0 * ablation.time_se {
        true => format!("{} of time", rough_percent(ablation.time)),
        false => "no measurable time".to_owned(),
    };
    let name = inline(&ablation.effect);
    if !ablation.significant {
        return format!("{name}: {time}, picture not distinguishable from noise");
    }
    let energy = match ablation.energy.abs() > 2.0 * ablation.energy_se {
        true => format!("{} of energy", rough_percent(ablation.energy)),
        false => "no measurable energy".to_owned(),
    };
    format!("{name}: {time}, {energy}, FLIP {:.3}", ablation.flip)
}

fn point_table(study: &Study) -> String {
    let mut table = Table::new(&[
        "variant",
        "samples per pixel",
        "threads",
        "time",
        "error E",
        "seeds",
        "E of the seeds",
        "FLIP",
        "energy",
        "expected picture",
    ]);
    for p in points(study) {
        let rows = || {
            let own = |r: &&Row| r.variant == p.variant && r.spp == p.spp && r.threads == p.threads;
            study.rows.iter().filter(own)
        };
        let mean = |of: fn(&Row) -> f64| rows().map(of).sum::<f64>() / rows().count() as f64;
        table.line(&[
            study.label(p.variant),
            p.spp.to_string(),
            p.threads.to_string(),
            duration(p.seconds),
            error(p.error),
            p.rows.to_string(),
            range(p.spread.start, p.spread.end, percent),
            significant(mean(|r| r.flip), 2),
            percent(mean(|r| r.energy)),
            if study.is_biased(p.variant) {
                "changed"
            } else {
                "the same"
            }
            .to_owned(),
        ]);
    }
    let mut text = format!(
        "## Points\n\nMedian time, root mean square of E over the seeds, mean FLIP, mean luminance over the \
         reference's.\n\n{}",
        table.text
    );
    let floors: Vec<String> = (0..study.variants.len())
        .filter_map(|v| {
            let floor = Law::of(study, v)?.floor?;
            Some(format!(
                "- {}: E tends to {}",
                inline(&study.label(v)),
                rough_percent(floor)
            ))
        })
        .collect();
    if !floors.is_empty() {
        text += &format!("\n\nBias that stands out from the noise:\n\n{}", floors.join("\n"));
    }
    text
}

/// An E of 0 stands for one that the reference cannot tell from 0.
fn error(error: f64) -> String {
    match error > 0.0 {
        true => percent(error),
        false => "below the noise".to_owned(),
    }
}

fn front_table(study: &Study) -> String {
    let points = points(study);
    let mut table = Table::new(&["time", "error E", "variant", "samples per pixel", "flags"]);
    for p in pareto(&points).into_iter().map(|i| &points[i]) {
        let flags = study.variants.get(p.variant).map_or("", |v| v.flags.as_str());
        table.line(&[
            duration(p.seconds),
            percent(p.error),
            study.label(p.variant),
            p.spp.to_string(),
            if flags.is_empty() {
                String::new()
            } else {
                format!("`{flags}`")
            },
        ]);
    }
    format!(
        "## Pareto front\n\nNo other variant is measured to be both faster and better.\n\n{}",
        table.text
    )
}

fn reference(study: &Study) -> String {
    let r = &study.reference;
    let mut facts = vec![format!("Reference: {}", inline(&r.source))];
    facts.extend(r.spp.map(|n| format!("{n} samples per pixel")));
    facts.extend(r.seconds.map(|s| format!("rendered in {}", duration(s))));
    facts.push(match r.error {
        Some(e) => format!(
            "its own error E is {}, and its noise is subtracted from all errors above",
            percent(e)
        ),
        None => "its own error is unknown; nothing is subtracted from the errors above".to_owned(),
    });
    format!("## Reference\n\n{}.", facts.join(", "))
}

/// Text that stays on one line of Markdown.
fn inline(text: &str) -> String {
    text.split(['\n', '\r']).collect::<Vec<_>>().join(" ")
}

/// A table of Markdown.
struct Table {
    text: String,
}

impl Table {
    fn new(head: &[&str]) -> Self {
        let rule = vec!["---"; head.len()].join(" | ");
        Self {
            text: format!("| {} |\n| {rule} |", head.join(" | ")),
        }
    }

    fn line(&mut self, cells: &[String]) {
        let cells: Vec<String> = cells.iter().map(|cell| inline(cell).replace('|', r"\|")).collect();
        self.text += &format!("\n| {} |", cells.join(" | "));
    }
}

#[cfg(test)]
mod tests;
