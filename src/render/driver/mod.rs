//! Runs a render: passes over tiles until a stop rule is met, then the picture.

mod schedule;

use super::camera::{FilterSampler, place_in_picture};
use super::estimate::{Bounded, ErrorEstimate, Wanted};
use super::forecast::{Forecast, Look};
use super::kernel::tier::{All, KernelTier, Surfaces, Tier};
use super::kernel::{Kernel, PathStats};
use super::picture::Channels;
use super::pixels::Pixels;
use super::report::{Observer, Picture, Progress, Report, StopReason};
use super::scene::CompiledScene;
use super::settings::Settings;
use super::tiles::{Misfit, Tile, Tiles};
use glam::Vec3;
use rayon::prelude::*;
pub use schedule::FIRST_LOOK;
use schedule::{Clock, next_pass, targets};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

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
        seen: Mutex::new(Seen::default()),
        checkpoint: checkpoint.map(|c| c.every),
        saved: Mutex::new(begun),
        save_due: AtomicBool::new(false),
    };
    let mut spp = kept;
    // An interruption may have left a pass half done: that pass comes first.
    let mut half_done = (most > kept && !settings.technique.adaptive).then_some(most);
    let stop = loop {
        if let Some(found) = run.look(&tiles, spp) {
            run.tell(spp);
            if let Some(reason) = reached(settings, &found) {
                break reason;
            }
        }
        let Some(end) = half_done.take().or_else(|| next_pass(settings, spp, run.clock(spp))) else {
            break if spp >= settings.stop.spp {
                StopReason::Samples
            } else {
                StopReason::Time
            };
        };
        let shares = run.seen().shares.clone();
        let targets = targets(settings, &tiles, shares.as_deref(), end);
        run.pass(&mut tiles, spp, &targets, checkpoint.map(|c| c.save));
        if run.stopped.load(Ordering::Relaxed) {
            break StopReason::Interrupted;
        }
        spp = end;
    };
    let error = run.look(&tiles, spp);
    let stats = tiles.stats();
    let report = Report {
        stop,
        spp,
        samples: run.samples.load(Ordering::Relaxed),
        rays: stats.rays,
        seconds: begun.elapsed().as_secs_f64(),
        error,
        forecast: run.seen().forecast,
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
    seen: Mutex<Seen>,
    /// How often the sums are kept, when they were, and whether it is time again.
    checkpoint: Option<Duration>,
    saved: Mutex<Instant>,
    save_due: AtomicBool,
}

impl Run<'_> {
    /// What the time limit allows after `spp` samples; `None` without one.
    fn clock(&self, spp: u32) -> Option<Clock> {
        let limit = self.settings.stop.seconds?;
        Some(Clock {
            left: limit - self.settings.started.elapsed().as_secs_f64() - self.writing_reserve(),
            per_sample: self.per_sample(spp),
        })
    }

    /// Seconds that a sample of every pixel takes; `None` before the first.
    fn per_sample(&self, spp: u32) -> Option<f64> {
        (spp > self.kept).then(|| self.begun.elapsed().as_secs_f64() / f64::from(spp - self.kept))
    }

    fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(|e| e.into_inner())
    }

    /// Seconds kept back for estimating and writing the picture: about 0.3 µs a pixel.
    fn writing_reserve(&self) -> f64 {
        f64::from(self.settings.width) * f64::from(self.settings.height) * 3e-7
    }

    /// Gives each tile the samples up to its number in `targets`; `from` are complete everywhere. A tile is finished or
    /// left as it was.
    fn pass(&self, tiles: &mut Tiles, from: u32, targets: &[u32], save: Option<&dyn Fn(&Tiles)>) {
        loop {
            tiles.all.par_iter_mut().zip(targets).for_each(|(tile, to)| {
                let taken = tile.film.samples();
                if taken >= *to || self.stopped.load(Ordering::Relaxed) || self.save_due.load(Ordering::Relaxed) {
                    return;
                }
                match self.kernel.tier() {
                    KernelTier::Surfaces => self.trace_tile::<Surfaces>(tile, *to),
                    KernelTier::All => self.trace_tile::<All>(tile, *to),
                }
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
            let is_done = |(tile, to): (&Tile, &u32)| tile.film.samples() >= *to;
            if stopped || tiles.all.iter().zip(targets).all(is_done) {
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

    fn trace_tile<T: Tier>(&self, tile: &mut Tile, to: u32) {
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
        film.extend(self.settings.first + to, |pixel, index, out| {
            if let Some(clock) = clock {
                clock.enter(pixel);
            }
            let (x, y) = (*x0 + pixel as u32 % *width, *y0 + pixel as u32 / *width);
            let sampler = self.kernel.sampler(y * self.settings.width + x, index);
            let path = self.kernel.trace::<T>(&sampler, stats, |u, time| {
                let across = place_in_picture(x, self.settings.width, self.filter.offset(u[0]));
                let down = place_in_picture(y, self.settings.height, self.filter.offset(u[1]));
                self.scene.camera.ray(across, -down, glam::Vec2::new(u[2], u[3]), time)
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
        let settings = self.settings;
        let is_complete = settings.technique.adaptive || tiles.samples() == (spp, spp);
        if spp < FIRST_LOOK || settings.nets < 2 || !is_complete {
            return None;
        }
        let mut seen = self.seen();
        if let Some((found, _)) = seen.error.filter(|(_, at)| *at == spp) {
            return Some(found);
        }
        let wanted = Wanted {
            worst: settings.stop.error_max.is_some(),
            display: settings
                .display
                .as_ref()
                .filter(|_| settings.stop.error_display.is_some()),
        };
        let (found, shares) = tiles.error(wanted, settings.stop.confidence);
        seen.looks.push(Look::new(f64::from(spp), &found));
        let per_sample = self.per_sample(spp).unwrap_or(f64::NAN);
        seen.forecast = Forecast::from_looks(&seen.looks, per_sample, distance(settings, &found));
        seen.at = self.begun.elapsed().as_secs_f64();
        seen.error = Some((found, spp));
        seen.shares = Some(shares);
        Some(found)
    }

    fn tell(&self, spp: u32) {
        let stop = &self.settings.stop;
        let pixels = self.settings.region.pixels();
        let samples = self.samples.load(Ordering::Relaxed);
        let at_most = pixels * u64::from(stop.spp) - self.samples_before;
        let elapsed = self.begun.elapsed().as_secs_f64();
        let since_start = self.settings.started.elapsed().as_secs_f64();
        let mut seen = self.seen();
        let (error, at) = (seen.error.map(|(error, _)| error), seen.at);
        // Ranges begin at the look; time has passed since.
        let forecast = seen.forecast.map(|f| Forecast {
            to_goal: f.to_goal.map(|range| range.map(|t| (t - (elapsed - at)).max(0.0))),
            ..f
        });
        let mut fraction = samples as f64 / at_most.max(1) as f64;
        // As long as nothing is known of an error goal, how far its cap is says nothing of the end.
        let is_open = stop.has_error_goal() && forecast.is_none();
        let mut remaining = if samples > 0 && !is_open {
            elapsed / samples as f64 * at_most.saturating_sub(samples) as f64
        } else {
            f64::NAN
        };
        if let Some(limit) = stop.seconds {
            fraction = fraction.max(since_start / limit);
            remaining = remaining.min(limit - since_start);
        }
        if let Some([from, to]) = forecast.and_then(|f| f.to_goal) {
            let left = (from * to).sqrt();
            fraction = fraction.max((elapsed / (elapsed + left)).min(0.99));
            remaining = remaining.min(left);
        }
        // A goal may turn out to be further away than it seemed; what is done stays done.
        seen.fraction = seen.fraction.max(fraction.clamp(0.0, 1.0));
        let fraction = seen.fraction;
        drop(seen);
        self.observer.progress(&Progress {
            spp,
            samples,
            samples_at_most: at_most,
            fraction,
            elapsed: since_start,
            remaining: remaining.is_finite().then_some(remaining.max(0.0)),
            error,
            forecast,
        });
    }
}

/// What the looks at the error have shown.
#[derive(Default)]
struct Seen {
    /// The last estimate, and at how many samples per pixel.
    error: Option<(ErrorEstimate, u32)>,
    looks: Vec<Look>,
    forecast: Option<Forecast>,
    /// Seconds of rendering at the last look.
    at: f64,
    /// E² summed over each tile's pixels.
    shares: Option<Vec<f64>>,
    /// The largest share of the work that was told.
    fraction: f64,
}

/// Each error goal, what its bound is, and what reaching it is called.
fn goals(settings: &Settings, found: &ErrorEstimate) -> [(Option<f64>, Option<Bounded>, StopReason); 3] {
    let stop = &settings.stop;
    let error = Bounded {
        value: found.error,
        bound: found.bound,
    };
    [
        (stop.error, Some(error), StopReason::Error),
        (stop.error_max, found.worst, StopReason::ErrorMax),
        (stop.error_display, found.display, StopReason::ErrorDisplay),
    ]
}

/// The first goal that is reached.
fn reached(settings: &Settings, found: &ErrorEstimate) -> Option<StopReason> {
    let is_reached = |(goal, now, _): &(Option<f64>, Option<Bounded>, StopReason)| {
        goal.zip(*now).is_some_and(|(goal, now)| now.bound <= goal)
    };
    goals(settings, found)
        .into_iter()
        .find(is_reached)
        .map(|(.., reason)| reason)
}

/// How many times too large the bound of the nearest goal is; `None` without goals.
fn distance(settings: &Settings, found: &ErrorEstimate) -> Option<f64> {
    let ratios = goals(settings, found)
        .into_iter()
        .filter_map(|(goal, now, _)| Some(now?.bound / goal?));
    ratios.reduce(f64::min)
}

impl PathStats {
    /// Adds another tile's counts.
    pub fn add(&mut self, other: &PathStats) {
        self.rays += other.rays;
        self.clamped += other.clamped;
        self.anomalies.add(&other.anomalies);
    }
}
