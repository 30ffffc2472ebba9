//! `pts merge`: part files to the picture they are parts of, or to a larger part.

use super::accuracy::error_to_json;
use super::args::MergeArgs;
use super::choices::Aov;
use super::console::Console;
use super::outputs::{self, Finished, Refusal, Targets};
use super::{Exit, metadata, parts, plan, replay, signals};
use crate::math::words::{percent, rough_percent};
use crate::output::part::{Part, read_part};
use crate::render::estimate::Wanted;
use crate::render::kernel::PathStats;
use crate::render::picture::{Channels, NetSums, estimate};
use crate::render::pixels::{Overlap, Pixels, Run};
use crate::render::report::{ErrorEstimate, Picture};
use crate::render::settings::{Aovs, Region};
use crate::render::tiles::TILE;
use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Fewer samples per pixel than this give no estimate of the error.
const LEAST_SPP: u32 = 64;

/// Confidence of the error bound that is told.
const CONFIDENCE: f64 = 0.9;

/// Runs the command.
pub fn run(args: &MergeArgs) -> Exit {
    let console = Console::new(&args.terminal, None);
    signals::install(false);
    match merge(args, &console) {
        Ok(exit) => exit,
        Err((exit, message)) => {
            console.error(&message);
            exit
        }
    }
}

fn merge(args: &MergeArgs, console: &Console) -> Result<Exit, Refusal> {
    if args.output.output.is_empty() {
        let message = "merge needs to be told where the picture goes: add -o picture.exr (or -o larger.ptspart)";
        return Err((Exit::Usage, message.to_owned()));
    }
    if plan::aovs(&args.output).time {
        let message = "times cannot be merged: part files hold what was sampled, not how long it took; \
                       ask pts render for --aov time or --view time";
        return Err((Exit::Usage, message.to_owned()));
    }
    let targets = outputs::plan(&args.output, Path::new(""), &Path::to_owned)?;
    let whole = bring_together(&args.parts)?;
    let samples = whole
        .pixels
        .samples()
        .ok_or_else(|| at_fault("the parts have no samples at all"))?;
    let gap = whole.pixels.gap(&whole.frame, &samples);
    if let Some(gap) = &gap
        && !args.allow_gaps
    {
        return Err(at_fault(&format!(
            "samples {}..{} of pixel {}, {} are in no part; add the part that has them, or --allow-gaps",
            gap.samples.start, gap.samples.end, gap.x, gap.y
        )));
    }
    if let Some(gap) = &gap {
        console.warn(&format!(
            "there are gaps; the first: pixel {}, {} lacks samples {}..{}",
            gap.x, gap.y, gap.samples.start, gap.samples.end
        ));
    }
    let (parts_written, parts_done) = outputs::write_parts(&targets.parts, &whole.header, &whole.pixels, console);
    let error = (gap.is_none() && samples.end - samples.start >= LEAST_SPP)
        .then(|| whole.error())
        .flatten();
    let (images_written, images_done, view) = whole.write(args, &targets, &samples, error, console)?;
    let written = [images_written, parts_written].concat();
    if !written.is_empty() {
        let shape = whole.pixels.shape;
        console.say(&format!(
            "wrote {} ({}x{})",
            written.join(", "),
            shape.width,
            shape.height
        ));
    }
    console.say(&format!(
        "  samples {}..{} from {} parts",
        samples.start,
        samples.end,
        args.parts.len()
    ));
    if let Some(e) = error {
        let (error, bound) = (rough_percent(e.error), rough_percent(e.bound));
        let confidence = percent(CONFIDENCE);
        console.say(&format!("  error {error}, below {bound} with {confidence} confidence"));
    }
    if let Some(view) = view {
        console.say(&format!("  view: {view}"));
    }
    Ok(if parts_done && images_done {
        Exit::Done
    } else {
        Exit::Output
    })
}

fn at_fault(message: &str) -> Refusal {
    (Exit::Scene, message.to_owned())
}

/// All parts as one.
struct Whole {
    header: Value,
    pixels: Pixels,
    /// What the parts are to cover.
    frame: Region,
}

/// A part whose sums have been taken over.
struct Seen {
    path: PathBuf,
    covers: Pixels,
}

fn bring_together(paths: &[PathBuf]) -> Result<Whole, Refusal> {
    let mut seen: Vec<Seen> = Vec::new();
    let mut whole: Option<Whole> = None;
    for path in paths {
        let part = read_part(path).map_err(|e| at_fault(&e.to_string()))?;
        let covers = coverage(&part.pixels);
        match &mut whole {
            None => whole = Some(begin(part)),
            Some(whole) => add(whole, part, path, &seen)?,
        }
        seen.push(Seen {
            path: path.clone(),
            covers,
        });
    }
    whole.ok_or_else(|| at_fault("there are no parts"))
}

fn begin(part: Part) -> Whole {
    let shape = part.pixels.shape;
    Whole {
        frame: parts::frame(&part.header, shape.width, shape.height),
        header: part.header,
        pixels: part.pixels,
    }
}

fn add(whole: &mut Whole, part: Part, path: &Path, seen: &[Seen]) -> Result<(), Refusal> {
    let first = seen.first().map(|s| s.path.display().to_string()).unwrap_or_default();
    let foreign = |why: String| at_fault(&format!("{path:?} is part of another picture than {first:?}: {why}"));
    if let Some(why) = parts::difference(&part.header, &whole.header) {
        return Err(foreign(why));
    }
    let (found, expected) = (part.pixels.shape, whole.pixels.shape);
    if found != expected {
        return Err(foreign(format!("it has {found:?}, expected {expected:?}")));
    }
    let (a, b) = (whole.frame, parts::frame(&part.header, found.width, found.height));
    whole.frame = Region {
        x0: a.x0.min(b.x0),
        y0: a.y0.min(b.y0),
        x1: a.x1.max(b.x1),
        y1: a.y1.max(b.y1),
    };
    let stats = PathStats {
        rays: parts::rays(&part.header),
        clamped: parts::clamped(&part.header),
        anomalies: parts::anomalies(&part.header),
    };
    // One of two commands that differ in what does not matter: the choice must not depend on the order.
    if part.header["command"].as_str() < whole.header["command"].as_str() {
        for key in ["command", "scene", "biased"] {
            whole.header[key] = part.header[key].clone();
        }
    }
    parts::add_stats(&mut whole.header, &stats);
    let frame = whole.frame;
    whole.header["frame"] = json!([frame.x0, frame.y0, frame.x1, frame.y1]);
    whole.pixels.add(part.pixels).map_err(|overlap| {
        let Overlap { x, y, samples } = &overlap;
        let other = seen.iter().find(|s| has(&s.covers, &overlap));
        let other = other.map(|s| s.path.display().to_string()).unwrap_or_default();
        at_fault(&format!(
            "{path:?} overlaps {other:?}: both have samples {}..{} of pixel {x}, {y}; leave one of them out",
            samples.start, samples.end
        ))
    })
}

/// Which pixels have which samples, without the sums.
fn coverage(pixels: &Pixels) -> Pixels {
    let bare = |run: &Run| Run {
        columns: run.columns.clone(),
        samples: run.samples.clone(),
        sums: Vec::new(),
    };
    Pixels {
        shape: pixels.shape,
        rows: pixels.rows.iter().map(|row| row.iter().map(bare).collect()).collect(),
    }
}

fn has(covers: &Pixels, overlap: &Overlap) -> bool {
    let row = covers.rows.get(overlap.y as usize).into_iter().flatten();
    let mut samples = row.filter(|r| r.columns.contains(&overlap.x)).flat_map(|r| &r.samples);
    samples.any(|r| r.start < overlap.samples.end && overlap.samples.start < r.end)
}

impl Whole {
    /// The layers that are in the sums.
    fn layers(&self) -> Aovs {
        let has = |word: &str| {
            let layers = self.header["settings"]["layers"].as_array();
            layers.is_some_and(|l| l.iter().any(|w| w == word))
        };
        Aovs {
            depth: has("depth"),
            normal: has("normal"),
            albedo: has("albedo"),
            ..Aovs::default()
        }
    }

    /// The error of a picture without gaps; `None` for a single net, which does not tell.
    fn error(&self) -> Option<ErrorEstimate> {
        let shape = self.pixels.shape;
        let blocks: Vec<Region> = self.frame.blocks(TILE).collect();
        (shape.nets > 1).then(|| {
            let width = |block: &Region| block.width();
            let wanted = Wanted::default();
            let (found, _) = estimate(&blocks, shape.nets, wanted, CONFIDENCE, width, |block, see| {
                let mut sums = NetSums::new(shape.nets, shape.channels as usize);
                for y in block.y0..block.y1 {
                    for x in block.x0..block.x1 {
                        self.pixels.net_sums(x, y, &mut sums);
                        see(&mut sums);
                    }
                }
            });
            found
        })
    }

    fn picture(&self, aovs: Aovs, channels: &Channels) -> Picture {
        let shape = self.pixels.shape;
        let mut picture = Picture::black(shape.width, shape.height, aovs);
        let mut sums = NetSums::new(shape.nets, shape.channels as usize);
        for (y, run) in (0..)
            .zip(&self.pixels.rows)
            .flat_map(|(y, row)| row.iter().map(move |run| (y, run)))
        {
            for x in run.columns.clone() {
                self.pixels.net_sums(x, y, &mut sums);
                picture.put(x, y, &mut sums, channels);
            }
        }
        picture
    }

    /// Writes all images; fails where they cannot be made at all. Returns the names, whether all were written, and what
    /// the view shows.
    fn write(
        &self,
        args: &MergeArgs,
        targets: &Targets,
        samples: &Range<u32>,
        error: Option<ErrorEstimate>,
        console: &Console,
    ) -> Result<(Vec<String>, bool, Option<String>), Refusal> {
        let layers = self.layers();
        let channels = Channels::new(layers);
        if channels.count != self.pixels.shape.channels as usize {
            return Err(at_fault("the parts' headers tell other layers than the parts hold"));
        }
        let asked = plan::aovs(&args.output);
        let summed = [
            ("depth", asked.depth, layers.depth),
            ("normal", asked.normal, layers.normal),
            ("albedo", asked.albedo, layers.albedo),
        ];
        if let Some((name, ..)) = summed.into_iter().find(|(_, asked, there)| *asked && !there) {
            let message = format!("the parts were rendered without the layer {name}: render them with --aov {name}");
            return Err(at_fault(&message));
        }
        if let Some(why) = plan::needs_nets(&args.output).filter(|_| self.pixels.shape.nets == 1) {
            return Err(at_fault(&format!("the parts were rendered with --nets 1: {why}")));
        }
        if targets.images.is_empty() {
            return Ok((Vec::new(), true, None));
        }
        let display = parts::display(&self.header);
        let curve = args.output.tonemap.unwrap_or(display.tonemap);
        let develop = outputs::develop(&args.output, curve, display.linear);
        // Layers that the parts have are written without being asked for.
        let mut output = args.output.clone();
        let there = [
            (Aov::Depth, layers.depth),
            (Aov::Normal, layers.normal),
            (Aov::Albedo, layers.albedo),
        ];
        output
            .aov
            .extend(there.iter().filter(|(_, there)| *there).map(|(aov, _)| *aov));
        let picture = self.picture(plan::aovs(&output), &channels);
        let picture = Finished::new(picture, &output, develop);
        let metadata = self.describe(samples, error);
        let describe = |_| metadata.clone();
        let (written, done) = outputs::write_all(&targets.images, &picture, describe, console);
        Ok((written, done, picture.about_view()))
    }

    /// What images say about how they were made; the keys are those of a render without its story.
    fn describe(&self, samples: &Range<u32>, error: Option<ErrorEstimate>) -> Value {
        let (header, settings) = (&self.header, &self.header["settings"]);
        let mut command = header["command"].as_str().unwrap_or_default().to_owned();
        command += &match samples.start {
            0 => format!(" --spp {}", samples.end),
            _ => format!(" --samples {}..{}", samples.start, samples.end),
        };
        let (frame, shape) = (&self.frame, self.pixels.shape);
        if *frame != Region::whole(shape.width, shape.height) {
            command += &format!(" --region {}", replay::region_word(frame));
        }
        let mut value = json!({
            "version": header["version"],
            "scene": header["scene"],
            "scene_hash": header["scene_hash"],
            "command": command,
            "seed": settings["seed"],
            "spp": samples.end - samples.start,
            "nets": settings["nets"],
            "max_depth": settings["max_depth"],
            "filter": settings["filter"],
            "direct": settings["direct"],
            "confidence": CONFIDENCE,
            "error": error_to_json(error.as_ref()),
            "anomalies": parts::anomalies_to_json(&parts::anomalies(header)),
        });
        let words = |list: &Value| -> Vec<String> {
            let words = list.as_array().into_iter().flatten().filter_map(Value::as_str);
            words.map(str::to_owned).collect()
        };
        let (technique, biased) = (words(&settings["technique"]), words(&header["biased"]));
        metadata::stamp(&mut value, &technique, &biased, parts::clamped(header));
        value
    }
}
