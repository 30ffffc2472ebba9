//! Flags for rendering a picture in parts, and the arguments of `merge`.

use super::{OutputArgs, TerminalArgs};
use crate::cli::ranges::{self, SampleRange, Tile};
use crate::cli::values;
use crate::render::settings::Region;
use clap::Args;
use std::path::PathBuf;

const PARTS: &str = "Parts of a picture (write them with -o part.ptspart, bring them together with pts merge)";

/// Which part of a picture is rendered, and how a long render survives.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    /// Only the samples from number a to before number b of each pixel, counted from 0, for example 256..512.
    #[arg(long, value_name = "A..B", conflicts_with_all = ["spp", "time", "error", "error_max", "error_display"], help_heading = PARTS)]
    pub samples: Option<SampleRange>,
    /// Only band k of n bands of rows, counted from 0, for example 0/4.
    #[arg(long, value_name = "K/N", conflicts_with_all = ["region", "time", "error", "error_max", "error_display"], help_heading = PARTS)]
    pub tile: Option<Tile>,
    /// Only these pixels, counted from the top left, the end excluded; the others are black.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = ranges::region, help_heading = PARTS)]
    pub region: Option<Region>,
    /// Part file that keeps what has been rendered: during the render, at its end and when it is interrupted.
    #[arg(long, value_name = "FILE", help_heading = PARTS)]
    pub checkpoint: Option<PathBuf>,
    /// How often the checkpoint is written [default: 60s].
    #[arg(long, value_name = "DURATION", value_parser = values::duration, requires = "checkpoint", help_heading = PARTS)]
    pub every: Option<f64>,
    /// Go on from the checkpoint, if it is there.
    #[arg(long, requires = "checkpoint", help_heading = PARTS)]
    pub resume: bool,
}

/// The arguments of `merge`.
#[derive(Args, Clone, Debug)]
pub struct MergeArgs {
    /// The part files, in any order.
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// Accept parts that leave pixels or samples out; pixels without any sample are black.
    #[arg(long)]
    pub allow_gaps: bool,
    /// Where pictures go; a name that ends in .ptspart gets a larger part.
    #[command(flatten)]
    pub output: OutputArgs,
    /// What is said meanwhile.
    #[command(flatten)]
    pub terminal: TerminalArgs,
}
