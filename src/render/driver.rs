//! Runs a render: passes over tiles until a stop rule is met, then the picture.

use super::camera::FilterSampler;
use super::estimate::{ErrorSums, standard_error};
use super::film::TileFilm;
use super::kernel::{Kernel, PathStats};
use super::report::{Anomalies, ErrorEstimate, Observer, Picture, Progress, Report, StopReason};
use super::scene::CompiledScene;
use super::settings::{Aovs, Settings};
use crate::math::color::luminance;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// Side of a tile in pixels: small enough that an interruption is answered at once.
const TILE: u32 = 16;
/// No pass is longer than this, so that interruptions and time limits are met.
const LONGEST_PASS: u32 = 1024;
/// The first look at the error.
const FIRST_LOOK: u32 = 64;

/// One tile: its place and its sums.
struct Tile {
    x0: u32,
    y0: u32,
    width: u32,
    height: u32,
    film: TileFilm,
    stats: PathStats,
}

/// Offsets of the extra layers among the channels of a sample.
#[derive(Clone, Copy)]
struct Channels {
    depth: Option<usize>,
    normal: Option<usize>,
    albedo: Option<usize>,
    count: usize,
}

impl Channels {
    fn new(aovs: Aovs) -> Channels {
        let mut count = 3;
        let mut take = |wanted: bool, n: usize| {
            let at = wanted.then_some(count);
            count += if wanted { n } else { 0 };
            at
        };
        // Depth is a sum and the number of samples that hit something.
        let (depth, normal, albedo) = (take(aovs.depth, 2), take(aovs.normal, 3), take(aovs.albedo, 3));
        Channels {
            depth,
            normal,
            albedo,
            count,
        }
    }
}

/// Renders a scene on the current thread pool. The picture depends on scene and settings only, not on threads
/// or time, except that a time limit or an interruption decides how many samples there are.
pub fn render(scene: &CompiledScene, settings: &Settings, observer: &dyn Observer) -> (Picture, Report) {
    let begun = Instant::now();
    let channels = Channels::new(settings.aovs);
    let run = Run {
        scene,
        settings,
        observer,
        channels,
        kernel: Kernel::new(scene, settings),
        filter: FilterSampler::new(settings.filter),
        begun,
        samples: AtomicU64::new(0),
        stopped: AtomicBool::new(false),
        error: Mutex::new(None),
    };
    let mut tiles = run.tiles();
    let mut spp = 0;
    let stop = loop {
        let Some(end) = run.next_pass(spp) else {
            break if spp >= settings.stop.spp {
                StopReason::Samples
            } else {
                StopReason::Time
            };
        };
        run.pass(&mut tiles, spp, end);
        if run.stopped.load(Ordering::Relaxed) {
            break StopReason::Interrupted;
        }
        spp = end;
        if let Some(found) = run.look(&tiles, spp) {
            run.tell(spp);
            if settings.stop.error.is_some_and(|goal| found.bound <= goal) {
                break StopReason::Error;
            }
        }
    };
    let mut stats = PathStats::default();
    tiles.iter().for_each(|t| stats.add(&t.stats));
    let picture = run.picture(&tiles);
    let report = Report {
        stop,
        spp,
        samples: run.samples.load(Ordering::Relaxed),
        rays: stats.rays,
        seconds: begun.elapsed().as_secs_f64(),
        error: run.look(&tiles, spp),
        anomalies: stats.anomalies,
    };
    (picture, report)
}

/// What all threads of a render share.
struct Run<'a> {
    scene: &'a CompiledScene,
    settings: &'a Settings,
    observer: &'a dyn Observer,
    channels: Channels,
    kernel: Kernel<'a>,
    filter: FilterSampler,
    begun: Instant,
    samples: AtomicU64,
    stopped: AtomicBool,
    error: Mutex<Option<(ErrorEstimate, u32)>>,
}

impl Run<'_> {
    fn tiles(&self) -> Vec<Tile> {
        let (w, h) = (self.settings.width, self.settings.height);
        let rows = (0..h).step_by(TILE as usize);
        let places = rows.flat_map(|y| (0..w).step_by(TILE as usize).map(move |x| (x, y)));
        places
            .map(|(x0, y0)| {
                let (width, height) = (TILE.min(w - x0), TILE.min(h - y0));
                Tile {
                    x0,
                    y0,
                    width,
                    height,
                    film: TileFilm::new((width * height) as usize, self.settings.nets, self.channels.count),
                    stats: PathStats::default(),
                }
            })
            .collect()
    }

    /// Where the next pass ends; `None` when the samples or the time are used up. Passes double, so that the
    /// first pictures come early; with an error goal they end at the looks 64, 80, 96, 112, 128, 160, …
    fn next_pass(&self, spp: u32) -> Option<u32> {
        let stop = &self.settings.stop;
        if spp >= stop.spp {
            return None;
        }
        let wanted = if spp == 0 {
            1
        } else if stop.error.is_some() && spp >= FIRST_LOOK {
            let octave = 1u32 << spp.ilog2();
            spp.saturating_add(octave / 4)
        } else {
            spp.saturating_mul(2)
        };
        let mut end = wanted.min(spp.saturating_add(LONGEST_PASS)).min(stop.spp);
        if let Some(limit) = stop.seconds
            && spp > 0
        {
            let left = limit - self.settings.started.elapsed().as_secs_f64() - self.writing_reserve();
            let per_sample = self.begun.elapsed().as_secs_f64() / f64::from(spp);
            let fits = (left / per_sample).floor();
            if fits < 1.0 {
                return None;
            }
            end = end.min(spp.saturating_add(fits.min(f64::from(u32::MAX)) as u32));
        }
        Some(end)
    }

    /// Seconds kept back for estimating and writing the picture: about 0.3 µs a pixel.
    fn writing_reserve(&self) -> f64 {
        f64::from(self.settings.width) * f64::from(self.settings.height) * 3e-7
    }

    /// Takes samples `from..to` of every pixel. A tile is finished or left as it was.
    fn pass(&self, tiles: &mut [Tile], from: u32, to: u32) {
        tiles.par_iter_mut().for_each(|tile| {
            if self.stopped.load(Ordering::Relaxed) {
                return;
            }
            self.trace_tile(tile, to);
            let taken = u64::from(tile.width * tile.height) * u64::from(to - from);
            self.samples.fetch_add(taken, Ordering::Relaxed);
            self.tell(from);
            if self.observer.should_stop() {
                self.stopped.store(true, Ordering::Relaxed);
            }
        });
    }

    fn trace_tile(&self, tile: &mut Tile, to: u32) {
        let Tile {
            x0,
            y0,
            width,
            film,
            stats,
            ..
        } = tile;
        let (w, h) = (f64::from(self.settings.width), f64::from(self.settings.height));
        film.extend(to, |pixel, index, out| {
            let (x, y) = (*x0 + pixel as u32 % *width, *y0 + pixel as u32 / *width);
            let sampler = self.kernel.sampler(y * self.settings.width + x, index);
            let path = self.kernel.trace(&sampler, stats, |u| {
                // The pixel's centre is exact; only the small offset inside it is random.
                let px = (f64::from(x) + 0.5 - 0.5 * w) + f64::from(self.filter.offset(u[0]));
                let py = (0.5 * h - f64::from(y) - 0.5) - f64::from(self.filter.offset(u[1]));
                self.scene.camera.ray(px / w, py / h, glam::Vec2::new(u[2], u[3]))
            });
            out[0] = f64::from(path.radiance.x);
            out[1] = f64::from(path.radiance.y);
            out[2] = f64::from(path.radiance.z);
            if let Some(at) = self.channels.depth {
                let hit = path.first.depth.is_finite();
                out[at] = if hit { f64::from(path.first.depth) } else { 0.0 };
                out[at + 1] = f64::from(u8::from(hit));
            }
            let mut put = |at: Option<usize>, v: Vec3| {
                if let Some(at) = at {
                    out[at..at + 3].copy_from_slice(&v.as_dvec3().to_array());
                }
            };
            put(self.channels.normal, path.first.normal);
            put(self.channels.albedo, path.first.albedo);
        });
    }

    /// Estimates the error after a pass: with a goal at every look, otherwise whenever the samples doubled.
    fn look(&self, tiles: &[Tile], spp: u32) -> Option<ErrorEstimate> {
        if spp < FIRST_LOOK || self.settings.nets < 2 || tiles.iter().any(|t| t.film.samples() != spp) {
            return None;
        }
        let mut last = self.error.lock().unwrap_or_else(|e| e.into_inner());
        if let Some((found, at)) = *last
            && at == spp
        {
            return Some(found);
        }
        let total: f64 = tiles
            .par_iter()
            .map(|t| self.tile_luminance(t))
            .collect::<Vec<f64>>()
            .iter()
            .sum();
        let mean = total / (f64::from(self.settings.width) * f64::from(self.settings.height));
        let mut sums = ErrorSums::new(mean, tiles.len());
        let mut means = vec![[0.0; 3]; self.settings.nets as usize];
        for (block, tile) in tiles.iter().enumerate() {
            for pixel in 0..(tile.width * tile.height) as usize {
                self.net_means(tile, pixel, &mut means);
                sums.add(block, &means);
            }
        }
        let found = sums.estimate(self.settings.stop.confidence);
        *last = Some((found, spp));
        Some(found)
    }

    fn tile_luminance(&self, tile: &Tile) -> f64 {
        (0..(tile.width * tile.height) as usize)
            .map(|p| f64::from(luminance(Vec3::from_array(self.mean(tile, p, 0)))))
            .sum()
    }

    /// Colour means of each net; only for sample counts that give every net as many points.
    fn net_means(&self, tile: &Tile, pixel: usize, means: &mut [[f64; 3]]) {
        let mut sum = vec![0.0; self.channels.count];
        for (net, mean) in means.iter_mut().enumerate() {
            let points = tile.film.net_sum(pixel, net as u32, &mut sum);
            *mean = std::array::from_fn(|c| sum[c] / f64::from(points));
        }
    }

    /// The mean of three channels from `at` on over all samples of a pixel; black without samples.
    fn mean(&self, tile: &Tile, pixel: usize, at: usize) -> [f32; 3] {
        let mut total = [0.0; 3];
        let mut sum = vec![0.0; self.channels.count];
        for net in 0..self.settings.nets {
            tile.film.net_sum(pixel, net, &mut sum);
            total.iter_mut().zip(&sum[at..]).for_each(|(t, s)| *t += s);
        }
        let n = f64::from(tile.film.samples());
        total.map(|t| if n > 0.0 { (t / n) as f32 } else { 0.0 })
    }

    fn tell(&self, spp: u32) {
        let stop = &self.settings.stop;
        let pixels = u64::from(self.settings.width) * u64::from(self.settings.height);
        let samples = self.samples.load(Ordering::Relaxed);
        let at_most = pixels * u64::from(stop.spp);
        let elapsed = self.begun.elapsed().as_secs_f64();
        let since_start = self.settings.started.elapsed().as_secs_f64();
        let error = self
            .error
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .map(|(e, at)| (e, at));
        let mut fraction = samples as f64 / at_most as f64;
        let mut remaining = if samples > 0 {
            elapsed / samples as f64 * (at_most - samples) as f64
        } else {
            f64::NAN
        };
        if let Some(limit) = stop.seconds {
            fraction = fraction.max(since_start / limit);
            remaining = remaining.min(limit - since_start);
        }
        if let (Some(goal), Some((found, at))) = (stop.error, error) {
            // Noise falls like the square root of the samples; better than that is a gift.
            let ratio = found.bound / goal;
            let needed = f64::from(at) * ratio * ratio * pixels as f64;
            fraction = fraction.max((samples as f64 / needed).min(0.99));
            remaining = remaining.min(elapsed / samples as f64 * (needed - samples as f64).max(0.0));
        }
        self.observer.progress(&Progress {
            spp,
            samples,
            samples_at_most: at_most,
            fraction: fraction.clamp(0.0, 1.0),
            elapsed: since_start,
            remaining: remaining.is_finite().then_some(remaining.max(0.0)),
            error: error.map(|(e, _)| e),
        });
    }

    fn picture(&self, tiles: &[Tile]) -> Picture {
        let (w, h) = (self.settings.width, self.settings.height);
        let n = w as usize * h as usize;
        let mut picture = Picture {
            width: w,
            height: h,
            rgb: vec![[0.0; 3]; n],
            stderr: vec![[f32::NAN; 3]; n],
            samples: vec![0; n],
            depth: self.channels.depth.map(|_| vec![f32::INFINITY; n]),
            normal: self.channels.normal.map(|_| vec![[0.0; 3]; n]),
            albedo: self.channels.albedo.map(|_| vec![[0.0; 3]; n]),
        };
        let mut means = vec![[0.0; 3]; self.settings.nets as usize];
        for tile in tiles {
            for pixel in 0..(tile.width * tile.height) as usize {
                let (x, y) = (tile.x0 + pixel as u32 % tile.width, tile.y0 + pixel as u32 / tile.width);
                let at = (y * w + x) as usize;
                let samples = tile.film.samples();
                picture.rgb[at] = self.mean(tile, pixel, 0);
                picture.samples[at] = samples;
                if samples >= 16 {
                    self.net_means(tile, pixel, &mut means);
                    picture.stderr[at] = standard_error(&means);
                }
                if let (Some(layer), Some(c)) = (&mut picture.depth, self.channels.depth) {
                    let [sum, hits, _] = self.mean_pair(tile, pixel, c);
                    layer[at] = if hits > 0.0 { sum / hits } else { f32::INFINITY };
                }
                if let (Some(layer), Some(c)) = (&mut picture.normal, self.channels.normal) {
                    let n = Vec3::from_array(self.mean(tile, pixel, c));
                    layer[at] = crate::math::robust::try_normalize(n).unwrap_or(Vec3::ZERO).to_array();
                }
                if let (Some(layer), Some(c)) = (&mut picture.albedo, self.channels.albedo) {
                    layer[at] = self.mean(tile, pixel, c);
                }
            }
        }
        picture
    }

    fn mean_pair(&self, tile: &Tile, pixel: usize, at: usize) -> [f32; 3] {
        let mut total = [0.0f64; 3];
        let mut sum = vec![0.0; self.channels.count];
        for net in 0..self.settings.nets {
            tile.film.net_sum(pixel, net, &mut sum);
            total[0] += sum[at];
            total[1] += sum[at + 1];
        }
        total.map(|t| t as f32)
    }
}

impl PathStats {
    /// Adds another tile's counts.
    pub fn add(&mut self, other: &PathStats) {
        self.rays += other.rays;
        let mut all: Anomalies = self.anomalies;
        all.add(&other.anomalies);
        self.anomalies = all;
    }
}
