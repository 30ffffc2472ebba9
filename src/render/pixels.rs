//! Sums of pixels apart from the render that made them: what part files hold, and how parts become one.
//!
//! Nothing here depends on tiles, passes or threads: the same samples of the same pixels are the same runs with
//! the same bits, whoever took them and in whatever order they were brought together.

use super::film::range::{Accumulator, Layout, add_total, net_range};
use super::picture::NetSums;
use super::settings::Region;
use std::ops::Range;

/// Neighbouring pixels of a row with samples of the same ranges.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Columns.
    pub columns: Range<u32>,
    /// Samples of each pixel: ascending, not empty, apart from each other.
    pub samples: Vec<Range<u32>>,
    /// Pixel by pixel, range by range, net by net the vectors of a range of points.
    pub sums: Vec<f64>,
}

/// Numbers kept of a pixel with these samples.
pub fn pixel_len(samples: &[Range<u32>], nets: u32, channels: usize) -> usize {
    let vectors = |range| {
        (0..nets)
            .map(|net| Layout::of(&net_range(range, net, nets)).len())
            .sum::<usize>()
    };
    samples.iter().map(vectors).sum::<usize>() * channels
}

/// What a set of sums is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Columns of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// Independent nets.
    pub nets: u32,
    /// Numbers of a sample.
    pub channels: u32,
}

/// Sums that can be read row by row.
pub trait Rows {
    /// What they are about.
    fn shape(&self) -> Shape;
    /// The pixels of a row that have samples: ascending, as few runs as possible.
    fn row(&self, y: u32) -> Vec<Run>;
}

/// Sums of pixels, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// What they are about.
    pub shape: Shape,
    /// As many as the picture has.
    pub rows: Vec<Vec<Run>>,
}

impl Rows for Pixels {
    fn shape(&self) -> Shape {
        self.shape
    }

    fn row(&self, y: u32) -> Vec<Run> {
        self.rows.get(y as usize).cloned().unwrap_or_default()
    }
}

/// Samples that two parts both have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overlap {
    /// The first pixel's column.
    pub x: u32,
    /// Its row.
    pub y: u32,
    /// The samples.
    pub samples: Range<u32>,
}

/// Pixels without the samples that others have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The first pixel's column.
    pub x: u32,
    /// Its row.
    pub y: u32,
    /// The samples that are missing there.
    pub samples: Range<u32>,
}

impl Pixels {
    /// No samples at all.
    pub fn new(shape: Shape) -> Pixels {
        Pixels {
            shape,
            rows: vec![Vec::new(); shape.height as usize],
        }
    }

    /// Adds the samples of another part of the same picture. After an overlap is found the sums are of no use.
    pub fn add(&mut self, other: Pixels) -> Result<(), Overlap> {
        for (y, (own, more)) in self.rows.iter_mut().zip(other.rows).enumerate() {
            if own.is_empty() {
                *own = more;
            } else if !more.is_empty() {
                *own = join_rows(own, &more, self.shape).map_err(|(x, samples)| Overlap {
                    x,
                    y: y as u32,
                    samples,
                })?;
            }
        }
        Ok(())
    }

    /// The first and the last sample of any pixel; `None` without samples.
    pub fn samples(&self) -> Option<Range<u32>> {
        let ranges = || self.rows.iter().flatten().flat_map(|run| &run.samples);
        Some(ranges().map(|r| r.start).min()?..ranges().map(|r| r.end).max()?)
    }

    /// The first pixel of the region that lacks some of the samples.
    pub fn gap(&self, region: &Region, samples: &Range<u32>) -> Option<Gap> {
        for y in region.y0..region.y1 {
            let mut x = region.x0;
            for run in self.rows.get(y as usize).into_iter().flatten() {
                if run.columns.start > x {
                    break;
                }
                if let Some(samples) = first_missing(&run.samples, samples) {
                    let x = run.columns.start.max(region.x0);
                    return Some(Gap { x, y, samples });
                }
                x = x.max(run.columns.end);
            }
            if x < region.x1 {
                let samples = samples.clone();
                return Some(Gap { x, y, samples });
            }
        }
        None
    }

    /// The sums of a pixel's nets over all its samples; none for a pixel that is not there.
    pub fn net_sums(&self, x: u32, y: u32, out: &mut NetSums) {
        out.clear();
        let runs = self.rows.get(y as usize).map(Vec::as_slice).unwrap_or_default();
        let Some(run) = runs.iter().find(|run| run.columns.contains(&x)) else {
            return;
        };
        let (nets, channels) = (self.shape.nets, self.shape.channels as usize);
        // From the last range to the first, as inside a range.
        for piece in pieces(run, x, self.shape).iter().rev() {
            let mut sums = piece.sums;
            for net in 0..nets {
                let points = net_range(&piece.samples, net, nets);
                let (own, rest) = sums.split_at(Layout::of(&points).len() * channels);
                let (total, count) = out.net_mut(net);
                add_total(own, total);
                *count += points.len() as u32;
                sums = rest;
            }
        }
    }
}

fn first_missing(have: &[Range<u32>], wanted: &Range<u32>) -> Option<Range<u32>> {
    let mut at = wanted.start;
    for range in have {
        if range.start > at {
            return Some(at..range.start.min(wanted.end));
        }
        at = at.max(range.end);
    }
    (at < wanted.end).then_some(at..wanted.end)
}

/// One range of samples of one pixel.
#[derive(Clone)]
struct Piece<'a> {
    samples: Range<u32>,
    sums: &'a [f64],
}

/// What a run has of column `x`.
fn pieces(run: &Run, x: u32, shape: Shape) -> Vec<Piece<'_>> {
    let channels = shape.channels as usize;
    let len = pixel_len(&run.samples, shape.nets, channels);
    let mut sums = &run.sums[(x - run.columns.start) as usize * len..][..len];
    let mut all = Vec::with_capacity(run.samples.len());
    for samples in &run.samples {
        let (own, rest) = sums.split_at(pixel_len(std::slice::from_ref(samples), shape.nets, channels));
        all.push(Piece {
            samples: samples.clone(),
            sums: own,
        });
        sums = rest;
    }
    all
}

/// Joins two rows; fails with the first column and the samples that both have.
fn join_rows(a: &[Run], b: &[Run], shape: Shape) -> Result<Vec<Run>, (u32, Range<u32>)> {
    let mut cuts: Vec<u32> = a
        .iter()
        .chain(b)
        .flat_map(|r| [r.columns.start, r.columns.end])
        .collect();
    cuts.sort_unstable();
    cuts.dedup();
    let at = |runs: &'_ [Run], x: u32| runs.iter().position(|r| r.columns.contains(&x));
    let mut joined: Vec<Run> = Vec::new();
    for columns in cuts.windows(2).map(|w| w[0]..w[1]) {
        let here = [at(a, columns.start).map(|i| &a[i]), at(b, columns.start).map(|i| &b[i])];
        let mut run = Run {
            columns: columns.clone(),
            samples: Vec::new(),
            sums: Vec::new(),
        };
        for x in columns.clone() {
            let mut all: Vec<Piece> = here.iter().flatten().flat_map(|run| pieces(run, x, shape)).collect();
            all.sort_by_key(|p| p.samples.start);
            if let Some(w) = all.windows(2).find(|w| w[0].samples.end > w[1].samples.start) {
                return Err((x, w[1].samples.start..w[0].samples.end.min(w[1].samples.end)));
            }
            run.samples = join_pixel(&all, shape, &mut run.sums);
        }
        push_run(&mut joined, run);
    }
    Ok(joined)
}

/// Appends a run, as part of the one before where they differ in their place only.
pub fn push_run(runs: &mut Vec<Run>, run: Run) {
    if run.samples.is_empty() || run.columns.is_empty() {
        return;
    }
    match runs.last_mut() {
        Some(last) if last.columns.end == run.columns.start && last.samples == run.samples => {
            last.columns.end = run.columns.end;
            last.sums.extend_from_slice(&run.sums);
        }
        _ => runs.push(run),
    }
}

/// Joins ranges of one pixel where they meet, appends the sums, and returns the ranges that result.
fn join_pixel(ascending: &[Piece], shape: Shape, out: &mut Vec<f64>) -> Vec<Range<u32>> {
    let mut ranges = Vec::new();
    for chain in ascending.chunk_by(|a, b| a.samples.end == b.samples.start) {
        let (Some(first), Some(last)) = (chain.first(), chain.last()) else {
            continue;
        };
        let whole = first.samples.start..last.samples.end;
        if chain.len() == 1 {
            out.extend_from_slice(first.sums);
        } else {
            join_chain(chain, &whole, shape, out);
        }
        ranges.push(whole);
    }
    ranges
}

fn join_chain(chain: &[Piece], whole: &Range<u32>, shape: Shape, out: &mut Vec<f64>) {
    let channels = shape.channels as usize;
    let mut rest: Vec<&[f64]> = chain.iter().map(|p| p.sums).collect();
    let mut sums = Accumulator::new(channels);
    for net in 0..shape.nets {
        for (i, (piece, rest)) in chain.iter().zip(&mut rest).enumerate() {
            let points = net_range(&piece.samples, net, shape.nets);
            let (own, later) = rest.split_at(Layout::of(&points).len() * channels);
            *rest = later;
            match i {
                0 => sums.load(&points, own),
                _ => sums.join(&points, own),
            }
        }
        let points = net_range(whole, net, shape.nets);
        out.extend_from_slice(sums.finish(points.start, points.end));
    }
}
