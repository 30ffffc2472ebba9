//! `pts compare`: how far an image is from a reference, where, and whether that is too far.

use super::args::CompareArgs;
use super::choices::{HeatmapKind, ReportFormat};
use super::console::Console;
use super::{Exit, compare_report};
use crate::diag::{Diagnostic, Diagnostics, SourceMap};
use crate::output::{self, Develop, Layers};
use crate::study::heatmap::{self, Kind};
use crate::study::{self, CompareError, Image, Metrics, Options};
use std::io::Write;
use std::path::Path;

/// A number that is larger than it may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// What it is called, as in the report.
    pub metric: &'static str,
    /// What was measured.
    pub value: f64,
    /// What was allowed.
    pub limit: f64,
    /// Whether people write it in percent.
    pub is_share: bool,
}

/// Runs the command.
pub fn run(args: &CompareArgs) -> Exit {
    let console = Console::new(&args.terminal, None);
    match compare(args, &console) {
        Ok(exit) => exit,
        Err((exit, diagnostic)) => {
            let mut found = Diagnostics::default();
            found.push(diagnostic);
            console.diagnostics(&found, &SourceMap::default());
            exit
        }
    }
}

type Failure = (Exit, Diagnostic);

fn compare(args: &CompareArgs, console: &Console) -> Result<Exit, Failure> {
    if let Some(path) = &args.heatmap {
        // A wrong name should cost no time.
        output::format_of(path).map_err(|e| usage(&e.to_string()))?;
        output::check_target(path).map_err(|e| unwritable(&e.to_string()))?;
    }
    let (a, b) = (read(&args.image)?, read(&args.reference)?);
    let options = Options {
        exposure_ev: args.exposure,
        block_side: args.block_size,
    };
    let metrics = study::compare_with(&a, &b, &options).map_err(|e| incomparable(args, &e))?;
    for (path, count) in [&args.image, &args.reference].into_iter().zip(metrics.non_finite) {
        if count > 0 {
            let pixels = if count == 1 { "pixel is" } else { "pixels are" };
            console.warn(&format!("{}: {count} {pixels} not finite and left out", path.display()));
        }
    }
    if args.max_blocks.is_some() && metrics.noise.is_none() {
        return Err(no_noise("--max-blocks"));
    }
    if let Some(path) = &args.heatmap {
        write_heatmap(args, path, &a, &b, &options)?;
    }
    let beyond = excesses(args, &metrics);
    let report = match args.format {
        ReportFormat::Human => compare_report::to_text(args, &a, &metrics),
        ReportFormat::Json => format!("{:#}", compare_report::to_json(args, &a, &metrics, &beyond)),
    };
    if let Err(error) = writeln!(std::io::stdout().lock(), "{}", report.trim_end()) {
        return Err(unwritable(&format!("the report cannot be written: {error}")));
    }
    for excess in &beyond {
        console.error(&compare_report::excess(excess));
    }
    Ok(if beyond.is_empty() { Exit::Done } else { Exit::Beyond })
}

fn read(path: &Path) -> Result<Image, Failure> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| {
        let diagnostic = Diagnostic::error("I0006", format!("image cannot be read: {error}")).in_place(&*name);
        let diagnostic = match error.kind() {
            std::io::ErrorKind::NotFound => diagnostic.hint("check the name and the working directory"),
            _ => diagnostic,
        };
        (Exit::Output, diagnostic)
    })?;
    Image::decode(&bytes, &name).map_err(|diagnostic| (Exit::Output, diagnostic))
}

fn incomparable(args: &CompareArgs, error: &CompareError) -> Failure {
    let place = format!("{} and {}", args.image.display(), args.reference.display());
    let diagnostic = Diagnostic::error("I0007", error.to_string()).in_place(place);
    let diagnostic = match error {
        CompareError::Size { .. } => diagnostic.hint("render both at the same resolution (-r)"),
        _ => diagnostic,
    };
    (Exit::Output, diagnostic)
}

fn usage(message: &str) -> Failure {
    (Exit::Usage, Diagnostic::error("I0008", message))
}

fn unwritable(message: &str) -> Failure {
    (Exit::Output, Diagnostic::error("I0009", message))
}

/// Somebody asks for the noise test of images that cannot be tested.
fn no_noise(flag: &str) -> Failure {
    let message = format!("{flag} needs known standard errors in floating-point images, which these are not");
    let hint = "render both to .exr with at least 16 samples per pixel and more than one net";
    (Exit::Usage, Diagnostic::error("I0008", message).hint(hint))
}

fn write_heatmap(args: &CompareArgs, path: &Path, a: &Image, b: &Image, options: &Options) -> Result<(), Failure> {
    let kind = match args.heatmap_kind {
        HeatmapKind::Flip => Kind::Flip,
        HeatmapKind::HdrFlip => Kind::HdrFlip,
        HeatmapKind::Error => Kind::Error,
        HeatmapKind::Z => Kind::Z,
    };
    let map = heatmap::heatmap(a, b, kind, options).map_err(|e| incomparable(args, &e))?;
    let map = map.ok_or_else(|| no_noise("--heatmap-kind z"))?;
    let how = Develop {
        dither: false,
        ..Develop::default()
    };
    let about = compare_report::heatmap_metadata(args);
    let layers = Layers::from_rgb(a.width, a.height, map);
    output::write(path, &layers, &how, &about).map_err(|e| unwritable(&e.to_string()))?;
    Ok(())
}

/// The thresholds that the image is beyond.
fn excesses(args: &CompareArgs, metrics: &Metrics) -> Vec<Excess> {
    let blocks = metrics.noise.as_ref().map_or(0.0, |noise| noise.share());
    let all = [
        ("E", metrics.rel_rmse, args.max_e, true),
        ("RMSE", metrics.rmse, args.max_rmse, false),
        ("FLIP", metrics.flip, args.max_flip, false),
        ("HDR-FLIP", metrics.hdr_flip, args.max_hdr_flip, false),
        (
            "the share of blocks that differ beyond noise",
            blocks,
            args.max_blocks,
            true,
        ),
    ];
    let excess = |(metric, value, limit, is_share): (_, f64, Option<f64>, _)| {
        let limit = limit.filter(|limit| value > *limit)?;
        Some(Excess {
            metric,
            value,
            limit,
            is_share,
        })
    };
    all.into_iter().filter_map(excess).collect()
}
