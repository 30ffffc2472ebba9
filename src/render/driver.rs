//! Runs a render: passes over tiles until a stop rule is met, then the picture.

use super::camera::FilterSampler;
use super::kernel::{Kernel, PathStats};
use super::picture::Channels;
use super::pixels::Pixels;
use super::report::{Anomalies, ErrorEstimate, Observer, Picture, Progress, Report, StopReason};
use super::scene::CompiledScene;
use super::settings::Settings;
use super::tiles::{Misfit, Tile, Tiles};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// No pass is longer than this, so that interruptions and time limits are met.
const LONGEST_PASS: u32 = 1024;
/// The first look at the error.
const FIRST_LOOK: u32 = 64;

/// Where to begin, and where to keep what has been done.
#[derive(Default)]
pub struct Continuity<'a> {
    /// Sums of an earlier render of the same picture.
    pub kept: Option<&'a Pixels>,
    /// Keeps the sums now and then.
    pub checkpoint: Option<Checkpoint<'a>>,
}

/// Keeps the sums of a running render.
#[derive(Clone, Copy)]
pub struct Checkpoint<'a> {
    /// How often.
    pub every: Duration,
    /// What keeps them. Nothing is rendered meanwhile.
    pub save: &'a dyn Fn(&Tiles),
}

/// What a render gives.
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
    /// What was done.
    pub report: Report,
    /// The sums behind the picture.
    pub tiles: Tiles,
}

/// Renders a scene on the current thread pool. The picture depends on scene and settings only, not on threads
/// or time, except that a time limit or an interruption decides how many samples there are.
pub fn render(scene: &CompiledScene, settings: &Settings, observer: &dyn Observer) -> (Picture, Report) {
    let tiles = Tiles::new(settings);
    let rendered = render_tiles(scene, settings, observer, tiles, None);
    (rendered.picture, rendered.report)
}

/// As [`render`], going on from where an earlier render ended. Interrupted and continued or not: the bits are the same.
pub fn render_on(
    scene: &CompiledScene,
    settings: &Settings,
    observer: &dyn Observer,
    continuity: Continuity,
) -> Result<Rendered, Misfit> {
    let tiles = match continuity.kept {
        Some(kept) => Tiles::restore(settings, kept)?,
        None => Tiles::new(settings),
    };
    Ok(render_tiles(scene, settings, observer, tiles, continuity.checkpoint))
}

fn render_tiles(
    scene: &CompiledScene,
    settings: &Settings,
    observer: &dyn Observer,
    mut tiles: Tiles,
    checkpoint: Option<Checkpoint>,
) -> Rendered {
    let begun = Instant::now();
    let (kept, most) = tiles.samples();
    let before = |t: &Tile| u64::from(t.width * t.height) * u64::from(t.film.samples());
    let run = Run {
        scene,
        settings,
        observer,
        channels: Channels::new(settings.aovs),
        kernel: Kernel::new(scene, settings),
        filter: FilterSampler::new(settings.filter),
        begun,
        kept,
        samples_before: tiles.all.iter().map(before).sum(),
        samples: AtomicU64::new(0),
        stopped: AtomicBool::new(false),
        error: Mutex::new(None),
        checkpoint: checkpoint.map(|c| c.every),
        saved: Mutex::new(begun),
        save_due: AtomicBool::new(false),
    };
    let mut spp = kept;
    // An interruption may have left a pass half done: that pass comes first.
    let mut half_done = (most > kept).then_some(most);
    let stop = loop {
        if let Some(found) = run.look(&tiles, spp) {
            run.tell(spp);
            if settings.stop.error.is_some_and(|goal| found.bound <= goal) {
                break StopReason::Error;
            }
        }
        let Some(end) = half_done.take().or_else(|| run.next_pass(spp)) else {
            break if spp >= settings.stop.spp {
                StopReason::Samples
            } else {
                StopReason::Time
            };
        };
        run.pass(&mut tiles, spp, end, checkpoint.map(|c| c.save));
        if run.stopped.load(Ordering::Relaxed) {
            break StopReason::Interrupted;
        }
        spp = end;
    };
    let stats = tiles.stats();
    let report = Report {
        stop,
        spp,
        samples: run.samples.load(Ordering::Relaxed),
        rays: stats.rays,
        seconds: begun.elapsed().as_secs_f64(),
        error: run.look(&tiles, spp),
        anomalies: stats.anomalies,
        clamped: stats.clamped,
    };
    Rendered {
        picture: tiles.picture(),
        report,
        tiles,
    }
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
    /// Samples per pixel, and of all pixels, that there were at the beginning.
    kept: u32,
    samples_before: u64,
    samples: AtomicU64,
    stopped: AtomicBool,
    error: Mutex<Option<(ErrorEstimate, u32)>>,
    /// How often the sums are kept, when they were, and whether it is time again.
    checkpoint: Option<Duration>,
    saved: Mutex<Instant>,
    save_due: AtomicBool,
}

impl Run<'_> {
    /// Where the next pass ends; `None` when the samples or the time are used up. Passes double, so that the
    /// first pictures come early; with an error goal they end at the looks 64, 80, 96, 112, 128, 160, …
    fn next_pass(&self, spp: u32) -> Option<u32> {
        let stop = &self.settings.stop;
        if spp >= stop.spp {
            return None;
        }
        let wanted = if spp == 0 {
            1
        } else if stop.seconds.is_some() && spp == self.kept {
            spp.saturating_add(1) // the first pass after a pause tells how long a sample takes
        } else if stop.error.is_some() && spp >= FIRST_LOOK {
            let octave = 1u32 << spp.ilog2();
            spp.saturating_add(octave / 4)
        } else {
            spp.saturating_mul(2)
        };
        let mut end = wanted.min(spp.saturating_add(LONGEST_PASS)).min(stop.spp);
        if let Some(limit) = stop.seconds
            && spp > self.kept
        {
            let left = limit - self.settings.started.elapsed().as_secs_f64() - self.writing_reserve();
            let per_sample = self.begun.elapsed().as_secs_f64() / f64::from(spp - self.kept);
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

    /// Takes all samples up to number `to` of every pixel; `from` are complete. A tile is finished or left as it was.
    fn pass(&self, tiles: &mut Tiles, from: u32, to: u32, save: Option<&dyn Fn(&Tiles)>) {
        loop {
            tiles.all.par_iter_mut().for_each(|tile| {
                let taken = tile.film.samples();
                if taken >= to || self.stopped.load(Ordering::Relaxed) || self.save_due.load(Ordering::Relaxed) {
                    return;
                }
                self.trace_tile(tile, to);
                let taken = u64::from(tile.width * tile.height) * u64::from(to - taken);
                self.samples.fetch_add(taken, Ordering::Relaxed);
                self.tell(from);
                self.look_at_the_clock();
                if self.observer.should_stop() {
                    self.stopped.store(true, Ordering::Relaxed);
                }
            });
            let stopped = self.stopped.load(Ordering::Relaxed);
            // Who ends keeps the sums at the end anyway.
            if self.save_due.swap(false, Ordering::Relaxed) && !stopped {
                save.into_iter().for_each(|save| save(tiles));
                *self.saved.lock().unwrap_or_else(|e| e.into_inner()) = Instant::now();
            }
            if stopped || tiles.all.iter().all(|t| t.film.samples() >= to) {
                return;
            }
        }
    }

    fn look_at_the_clock(&self) {
        if let Some(every) = self.checkpoint
            && self.saved.lock().unwrap_or_else(|e| e.into_inner()).elapsed() >= every
        {
            self.save_due.store(true, Ordering::Relaxed);
        }
    }

    fn trace_tile(&self, tile: &mut Tile, to: u32) {
        let Tile {
            x0,
            y0,
            width,
            film,
            stats,
            clock,
            ..
        } = tile;
        let taken = film.samples();
        let (w, h) = (f64::from(self.settings.width), f64::from(self.settings.height));
        film.extend(self.settings.first + to, |pixel, index, out| {
            if let Some(clock) = clock {
                clock.enter(pixel);
            }
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
        if let Some(clock) = clock {
            clock.pass_ends(to - taken);
        }
    }

    /// Estimates the error after a pass; `None` where it cannot be known.
    fn look(&self, tiles: &Tiles, spp: u32) -> Option<ErrorEstimate> {
        if spp < FIRST_LOOK || self.settings.nets < 2 || tiles.samples() != (spp, spp) {
            return None;
        }
        let mut last = self.error.lock().unwrap_or_else(|e| e.into_inner());
        if let Some((found, at)) = *last
            && at == spp
        {
            return Some(found);
        }
        let found = tiles.error(self.settings.stop.confidence);
        *last = Some((found, spp));
        Some(found)
    }

    fn tell(&self, spp: u32) {
        let stop = &self.settings.stop;
        let pixels = self.settings.region.pixels();
        let samples = self.samples.load(Ordering::Relaxed);
        let at_most = pixels * u64::from(stop.spp) - self.samples_before;
        let elapsed = self.begun.elapsed().as_secs_f64();
        let since_start = self.settings.started.elapsed().as_secs_f64();
        let error = self
            .error
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .map(|(e, at)| (e, at));
        let mut fraction = samples as f64 / at_most.max(1) as f64;
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
            let needed = f64::from(at) * ratio * ratio * pixels as f64 - self.samples_before as f64;
            fraction = fraction.max((samples as f64 / needed).clamp(0.0, 0.99));
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
}

impl PathStats {
    /// Adds another tile's counts.
    pub fn add(&mut self, other: &PathStats) {
        self.rays += other.rays;
        self.clamped += other.clamped;
        let mut all: Anomalies = self.anomalies;
        all.add(&other.anomalies);
        self.anomalies = all;
    }
}
