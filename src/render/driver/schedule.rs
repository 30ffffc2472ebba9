//! When passes end, and which tile gets how many samples.

use super::super::settings::Settings;
use super::super::tiles::Tiles;

/// No pass is longer than this, so that interruptions and time limits are met.
const LONGEST_PASS: u32 = 1024;
/// The first look at the error.
pub const FIRST_LOOK: u32 = 64;
/// Looks in an octave.
const LOOKS: u32 = 8;
/// A pass under a time limit takes at most this share of what is left, so that a machine that becomes slower is seen.
const SHARE_OF_REST: f64 = 0.5;
/// With less than this share of the time limit left, another pass is not worth the risk.
const LEAST_REST: f64 = 0.01;
/// With adaptive sampling no pixel gets less than this share of the average: what was not seen yet may be there.
const LEAST_SHARE: f64 = 0.25;

/// What the clock allows.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Seconds until the time limit, less what writing takes.
    pub left: f64,
    /// Seconds a sample per pixel takes; `None` as long as it is unknown.
    pub per_sample: Option<f64>,
}

/// Where the pass after `spp` ends; `None` when samples or time are used up. Passes double, so that the first
/// pictures come early; with an error goal or adaptive sampling they end at the looks 64, 72, 80, …, 128, 144, …,
/// each a multiple of the nets.
pub fn next_pass(settings: &Settings, spp: u32, clock: Option<Clock>) -> Option<u32> {
    let stop = &settings.stop;
    if spp >= stop.spp {
        return None;
    }
    let by_looks = stop.has_error_goal() || settings.technique.adaptive;
    let wanted = if spp == 0 {
        1
    } else if by_looks && spp >= FIRST_LOOK {
        let step = (1u32 << spp.ilog2()) / LOOKS;
        spp.saturating_add(step.next_multiple_of(settings.nets))
    } else {
        spp.saturating_mul(2)
    };
    let end = wanted.min(spp.saturating_add(LONGEST_PASS)).min(stop.spp);
    let (Some(clock), Some(limit)) = (clock, stop.seconds) else {
        return Some(end);
    };
    let Some(per_sample) = clock.per_sample else {
        return Some(spp + 1); // tells how long a sample takes
    };
    let fits = (clock.left / per_sample).floor();
    if fits < 1.0 || clock.left < LEAST_REST * limit {
        return None;
    }
    if settings.technique.adaptive {
        // Rounds are what the samples' distribution depends on: they are never cut short.
        return (f64::from(end - spp) <= fits).then_some(end);
    }
    let most = (fits * SHARE_OF_REST).max(1.0).min(f64::from(u32::MAX)) as u32;
    Some(end.min(spp.saturating_add(most)))
}

/// Samples per pixel that each tile shall have when the average is `end`: the same for all, or in proportion to the
/// standard deviation of a sample of the tile (relative, as E weighs it), which makes E least for the work.
/// `shares` is E² summed over each tile's pixels, where it is known.
///
/// How many samples follow depends on those before, which all count: a tile whose light is underestimated tends to get
/// fewer. In first order, what a picture loses by this is half of the squared relative error that a tile had when its
/// samples were divided, far less than its noise, and nothing in the limit. A tile is 256 pixels, and none is given up.
pub fn targets(settings: &Settings, tiles: &Tiles, shares: Option<&[f64]>, end: u32) -> Vec<u32> {
    let uniform = || vec![end; tiles.all.len()];
    let Some(shares) = shares.filter(|s| settings.technique.adaptive && s.len() == tiles.all.len()) else {
        return uniform();
    };
    let states: Vec<State> = tiles
        .all
        .iter()
        .zip(shares)
        .map(|(tile, share)| {
            let pixels = f64::from(tile.width * tile.height);
            let taken = tile.film.samples();
            State {
                pixels,
                taken,
                deviation: (share / pixels * f64::from(taken)).sqrt(),
            }
        })
        .collect();
    allot(&states, end, settings.nets).unwrap_or_else(uniform)
}

/// A tile, as far as its number of samples depends on it.
struct State {
    pixels: f64,
    taken: u32,
    /// Relative standard deviation of a sample.
    deviation: f64,
}

/// Samples for each tile with an average of about `end`; `None` without noise.
fn allot(states: &[State], end: u32, nets: u32) -> Option<Vec<u32>> {
    let budget: f64 = f64::from(end) * states.iter().map(|s| s.pixels).sum::<f64>();
    let least = LEAST_SHARE * f64::from(end);
    let wanted = |s: &State, scale: f64| (scale * s.deviation).max(least).max(f64::from(s.taken));
    let spent = |scale: f64| states.iter().map(|s| s.pixels * wanted(s, scale)).sum::<f64>();
    let noisiest = states.iter().map(|s| s.deviation).fold(0.0, f64::max);
    if noisiest.is_nan() || noisiest <= 0.0 {
        return None;
    }
    // At `most` the noisiest tile alone would use up everything.
    let (mut few, mut most) = (0.0, budget / noisiest);
    for _ in 0..64 {
        let middle = 0.5 * (few + most);
        if spent(middle) < budget {
            few = middle;
        } else {
            most = middle;
        }
    }
    let rounded = |s: &State| (wanted(s, few) as u32).next_multiple_of(nets).max(s.taken);
    Some(states.iter().map(rounded).collect())
}

#[cfg(test)]
mod tests {
    use super::super::super::settings::StopRules;
    use super::*;

    fn ends(settings: &Settings, from: u32, count: usize) -> Vec<u32> {
        let mut spp = from;
        (0..count)
            .map_while(|_| {
                spp = next_pass(settings, spp, None)?;
                Some(spp)
            })
            .collect()
    }

    #[test]
    fn passes_double_and_looks_come_eight_times_an_octave() {
        let mut settings = Settings::new(8, 8, 200);
        assert_eq!(ends(&settings, 0, 20), [1, 2, 4, 8, 16, 32, 64, 128, 200]);
        settings.stop.error = Some(0.01);
        assert_eq!(ends(&settings, 64, 6), [72, 80, 88, 96, 104, 112]);
        assert_eq!(ends(&settings, 128, 3), [144, 160, 176]);
        settings.nets = 16;
        assert_eq!(ends(&settings, 64, 3), [80, 96, 112]);
    }

    #[test]
    fn a_time_limit_is_approached_by_halves() {
        let settings = Settings {
            stop: StopRules {
                seconds: Some(100.0),
                ..StopRules::samples(1000)
            },
            ..Settings::new(8, 8, 1000)
        };
        let pass = |spp, left, per_sample| next_pass(&settings, spp, Some(Clock { left, per_sample }));
        assert_eq!(pass(0, 100.0, None), Some(1));
        assert_eq!(pass(16, 50.0, Some(1.0)), Some(32));
        assert_eq!(pass(64, 36.0, Some(1.0)), Some(82));
        assert_eq!(pass(98, 2.0, Some(1.0)), Some(99));
        assert_eq!(pass(99, 0.9, Some(1.0)), None);
        assert_eq!(pass(64, 0.9, Some(1e-6)), None);
    }

    /// Oracle: deviations 1 and 3 over as many pixels want samples 1 : 3.
    #[test]
    fn noisy_tiles_get_samples_in_proportion_to_their_deviation() {
        let state = |deviation, taken| State {
            pixels: 256.0,
            taken,
            deviation,
        };
        assert_eq!(allot(&[state(1.0, 64), state(3.0, 64)], 160, 4), Some(vec![80, 240]));
        // What was taken stays, and a quarter of the average is the least.
        assert_eq!(allot(&[state(1.0, 128), state(3.0, 64)], 160, 4), Some(vec![128, 192]));
        assert_eq!(allot(&[state(0.0, 0), state(3.0, 64)], 160, 4), Some(vec![40, 280]));
        assert_eq!(allot(&[state(0.0, 64), state(0.0, 64)], 80, 4), None);
    }
}
