//! The tiles a picture is rendered in.

use super::clock::PixelClock;
use super::estimate::Wanted;
use super::film::TileFilm;
use super::kernel::PathStats;
use super::picture::{Channels, NetSums, estimate};
use super::pixels::{Pixels, Rows, Run, Shape, pixel_len, push_run};
use super::report::{ErrorEstimate, Picture};
use super::settings::{Aovs, Region, Settings};

/// Side of a tile in pixels: small enough that an interruption is answered at once.
pub const TILE: u32 = 16;

/// One tile: its place and its sums.
pub struct Tile {
    /// Left column.
    pub x0: u32,
    /// Top row.
    pub y0: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Its sums.
    pub film: TileFilm,
    /// What happened in it.
    pub stats: PathStats,
    /// What its pixels cost, if that is asked for.
    pub clock: Option<PixelClock>,
}

/// Why a render cannot go on from sums that were kept.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// Another picture altogether.
    #[error("it holds {found:?}, expected {expected:?}")]
    Shape {
        /// What the sums are about.
        found: Shape,
        /// What is to be rendered.
        expected: Shape,
    },
    /// Pixels outside the region that is to be rendered.
    #[error("it has samples of pixel {x}, {y}, which is outside the region to be rendered")]
    Outside {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Samples that do not begin where the render does, or with gaps.
    #[error("pixel {x}, {y} has samples {found}, expected a single range that begins at {first}")]
    Ranges {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// The ranges.
        found: String,
        /// Where the render begins.
        first: u32,
    },
    /// More samples than are asked for.
    #[error("it has {found} samples per pixel already, more than the {asked} that are asked for")]
    TooMany {
        /// Samples per pixel.
        found: u32,
        /// Samples asked for.
        asked: u32,
    },
    /// Pixels of one tile with different samples.
    #[error("pixels of the tile at {x}, {y} have different samples: it was merged from parts that cut across tiles")]
    Uneven {
        /// Left column.
        x: u32,
        /// Top row.
        y: u32,
    },
}

/// All tiles of a picture or a region of it, row by row.
pub struct Tiles {
    /// The tiles.
    pub all: Vec<Tile>,
    /// Tiles side by side.
    columns: usize,
    region: Region,
    shape: Shape,
    aovs: Aovs,
    channels: Channels,
}

impl Tiles {
    /// Without samples.
    pub fn new(settings: &Settings) -> Tiles {
        let channels = Channels::new(settings.aovs);
        let region = settings.region;
        let film = |tile: &Region| {
            let pixels = (tile.width() * tile.height()) as usize;
            TileFilm::new(pixels, settings.nets, channels.count, settings.first)
        };
        let tile = |r: Region| Tile {
            x0: r.x0,
            y0: r.y0,
            width: r.width(),
            height: r.height(),
            film: film(&r),
            stats: PathStats::default(),
            clock: settings.aovs.time.then(|| PixelClock::new(r.pixels() as usize)),
        };
        Tiles {
            all: region.blocks(TILE).map(tile).collect(),
            columns: region.width().div_ceil(TILE) as usize,
            region,
            shape: Shape {
                width: settings.width,
                height: settings.height,
                nets: settings.nets,
                channels: channels.count as u32,
            },
            aovs: settings.aovs,
            channels,
        }
    }

    /// With the samples that were kept from an earlier render.
    pub fn restore(settings: &Settings, kept: &Pixels) -> Result<Tiles, Misfit> {
        let mut tiles = Tiles::new(settings);
        if kept.shape != tiles.shape {
            return Err(Misfit::Shape {
                found: kept.shape,
                expected: tiles.shape,
            });
        }
        for (y, run) in (0..)
            .zip(&kept.rows)
            .flat_map(|(y, runs)| runs.iter().map(move |r| (y, r)))
        {
            tiles.check(y, run, settings)?;
        }
        for tile in &mut tiles.all {
            let mut pixels: Vec<&[f64]> = Vec::with_capacity((tile.width * tile.height) as usize);
            let mut samples = None;
            for y in tile.y0..tile.y0 + tile.height {
                for x in tile.x0..tile.x0 + tile.width {
                    let run = kept.rows[y as usize].iter().find(|r| r.columns.contains(&x));
                    let range = run.map_or(settings.first..settings.first, |r| r.samples[0].clone());
                    if *samples.get_or_insert_with(|| range.clone()) != range {
                        let (x, y) = (tile.x0, tile.y0);
                        return Err(Misfit::Uneven { x, y });
                    }
                    let len = pixel_len(&[range], settings.nets, tiles.channels.count);
                    pixels.push(run.map_or(&[], |r| &r.sums[(x - r.columns.start) as usize * len..][..len]));
                }
            }
            if let Some(range) = samples {
                tile.film = TileFilm::restore(settings.nets, tiles.channels.count, range, pixels.into_iter());
            }
        }
        Ok(tiles)
    }

    fn check(&self, y: u32, run: &Run, settings: &Settings) -> Result<(), Misfit> {
        let (x, r) = (run.columns.start, &self.region);
        if x < r.x0 || run.columns.end > r.x1 || y < r.y0 || y >= r.y1 {
            return Err(Misfit::Outside { x, y });
        }
        match run.samples[..] {
            [ref one] if one.start == settings.first => {
                let (found, asked) = (one.end - one.start, settings.stop.spp);
                if found > asked {
                    return Err(Misfit::TooMany { found, asked });
                }
                Ok(())
            }
            _ => Err(Misfit::Ranges {
                x,
                y,
                found: run
                    .samples
                    .iter()
                    .map(|r| format!("{}..{}", r.start, r.end))
                    .collect::<Vec<_>>()
                    .join(", "),
                first: settings.first,
            }),
        }
    }

    /// The least and the largest number of samples of a pixel.
    pub fn samples(&self) -> (u32, u32) {
        let samples = || self.all.iter().map(|t| t.film.samples());
        (samples().min().unwrap_or(0), samples().max().unwrap_or(0))
    }

    /// What happened in all of them.
    pub fn stats(&self) -> PathStats {
        let mut stats = PathStats::default();
        self.all.iter().for_each(|t| stats.add(&t.stats));
        stats
    }

    /// The picture so far.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.shape.width, self.shape.height, self.aovs);
        let mut sums = NetSums::new(self.shape.nets, self.channels.count);
        for tile in &self.all {
            for pixel in 0..tile.width * tile.height {
                tile.net_sums(pixel as usize, &mut sums);
                let (x, y) = (tile.x0 + pixel % tile.width, tile.y0 + pixel / tile.width);
                picture.put(x, y, &mut sums, &self.channels);
                if let (Some(layer), Some(clock)) = (&mut picture.time, &tile.clock) {
                    layer[y as usize * self.shape.width as usize + x as usize] = clock.per_sample(pixel as usize);
                }
            }
        }
        picture
    }

    /// Its error, and the share of E² that each tile has, summed over its pixels. All pixels need samples of all nets.
    pub fn error(&self, wanted: Wanted, confidence: f64) -> (ErrorEstimate, Vec<f64>) {
        let width = |tile: &Tile| tile.width;
        estimate(&self.all, self.shape.nets, wanted, confidence, width, |tile, see| {
            let mut sums = NetSums::new(self.shape.nets, self.channels.count);
            for pixel in 0..tile.width * tile.height {
                tile.net_sums(pixel as usize, &mut sums);
                see(&mut sums);
            }
        })
    }
}

impl Tile {
    fn net_sums(&self, pixel: usize, out: &mut NetSums) {
        for net in 0..out.nets() {
            let (sum, points) = out.net_mut(net);
            *points = self.film.net_sum(pixel, net, sum);
        }
    }
}

impl Rows for Tiles {
    fn shape(&self) -> Shape {
        self.shape
    }

    fn row(&self, y: u32) -> Vec<Run> {
        let mut runs = Vec::new();
        if !(self.region.y0..self.region.y1).contains(&y) {
            return runs;
        }
        let first = ((y - self.region.y0) / TILE) as usize * self.columns;
        for tile in &self.all[first..][..self.columns] {
            if tile.film.samples() == 0 {
                continue;
            }
            let mut sums = Vec::new();
            let row = (y - tile.y0) * tile.width;
            (row..row + tile.width).for_each(|pixel| tile.film.pixel_sums(pixel as usize, &mut sums));
            let run = Run {
                columns: tile.x0..tile.x0 + tile.width,
                samples: vec![tile.film.range().clone()],
                sums,
            };
            push_run(&mut runs, run);
        }
        runs
    }
}
