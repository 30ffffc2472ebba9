//! Which runs fit into the time that is left.
//!
//! Points are taken from the cheap end: all variants at few samples, then at four times as many while that fits, at
//! twice as many where it does not. Whatever does not fit is dropped from the expensive end, the base line last.

/// The first step of a ladder: as many samples as there are nets by default.
pub const FIRST: u32 = 4;

/// The share of the time for all rows that is kept for the base line, whose ladder should reach farthest: forecasts
/// and recommendations rest on it.
pub const BASE_SHARE: f64 = 0.3;

/// Seconds that are left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Left {
    /// For everybody together.
    pub all: f64,
    /// Of these, for the base line alone.
    pub reserve: f64,
}

/// What a run is expected to cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Seconds whatever the samples: measuring the picture.
    pub fixed: f64,
    /// Seconds for a sample of each pixel.
    pub per_sample: f64,
    /// Samples per pixel below which there is no run.
    pub least_spp: u32,
}

impl Cost {
    /// Seconds of a run; 0 where there is none.
    pub fn of(&self, spp: u32) -> f64 {
        if spp < self.least_spp {
            return 0.0;
        }
        self.fixed + self.per_sample * f64::from(spp)
    }
}

/// One step of the ladder: the samples, and which variants take it.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Samples per pixel.
    pub spp: u32,
    /// Indices of variants, rising; 0 is the base line.
    pub variants: Vec<usize>,
}

/// The next step of an open ladder after one of `last` samples (`None` at the beginning), which the variants in
/// `active` took; `costs` are those of all variants. `None` if not even the base line can take one.
pub fn next(last: Option<u32>, active: &[usize], costs: &[Cost], seeds: u32, left: Left) -> Option<Level> {
    let wanted = match last {
        None => vec![FIRST],
        Some(spp) => [4, 2]
            .into_iter()
            .filter_map(|factor| spp.checked_mul(factor))
            .collect(),
    };
    let all = wanted.iter().find_map(|spp| {
        let fitting = fitting(*spp, active, costs, seeds, left);
        (fitting.variants.len() == active.len()).then_some(fitting)
    });
    // Not all can go on: the others take the smaller step, so that what is left of the time carries far.
    all.or_else(|| wanted.last().map(|spp| fitting(*spp, active, costs, seeds, left)))
        .filter(|level| !level.variants.is_empty())
}

/// The variants that can take a step of `spp` samples within what is `left`, without the dearest as far as needed.
pub fn fitting(spp: u32, active: &[usize], costs: &[Cost], seeds: u32, left: Left) -> Level {
    let mut variants: Vec<usize> = active.to_vec();
    let price = |v: &usize| costs.get(*v).map_or(f64::INFINITY, |c| c.of(spp) * f64::from(seeds));
    loop {
        let total: f64 = variants.iter().map(price).sum();
        let only_base = variants.iter().all(|v| *v == 0);
        let limit = if only_base { left.all } else { left.all - left.reserve };
        if total <= limit {
            return Level { spp, variants };
        }
        let others = variants.iter().enumerate().filter(|(_, v)| **v != 0);
        let dearest = others.max_by(|(_, a), (_, b)| price(a).total_cmp(&price(b)));
        match dearest.map(|(place, _)| place) {
            Some(place) => variants.remove(place),
            None => {
                variants.clear();
                return Level { spp, variants };
            }
        };
    }
}

/// Columns and rows of a picture like `size` in which the ladders of all variants up to 64 samples fit into `seconds`:
/// at most `widest` columns, at least 96, never more than `size`. `per_pixel` is the price of one sample.
pub fn picture_size(size: [u32; 2], widest: u32, per_pixel: f64, runs: f64, seconds: f64) -> [u32; 2] {
    const LADDER: f64 = 4.0 + 16.0 + 64.0;
    let aspect = f64::from(size[1]) / f64::from(size[0]);
    let pixels = seconds / (per_pixel * runs * LADDER);
    let width = (pixels / aspect).sqrt().clamp(96.0, f64::from(widest.max(96)));
    let width = width.min(f64::from(size[0])).floor();
    [width as u32, ((width * aspect).round() as u32).max(1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(per_sample: f64) -> Cost {
        Cost {
            fixed: 0.0,
            per_sample,
            least_spp: 1,
        }
    }

    fn left(all: f64) -> Left {
        Left { all, reserve: 0.3 }
    }

    #[test]
    fn steps_are_by_four_where_all_can_take_them_and_by_two_else() {
        let costs = [cost(0.01), cost(0.01)];
        let at = |last, seconds| next(last, &[0, 1], &costs, 5, left(seconds));
        // 4 samples of two variants and five seeds are 0.4 s, besides the reserve of 0.3 s.
        let both = |spp| {
            let variants = vec![0, 1];
            Some(Level { spp, variants })
        };
        assert_eq!(at(None, 0.75), both(4));
        assert_eq!(at(Some(4), 2.0), both(16));
        assert_eq!(at(Some(4), 1.2), both(8));
    }

    #[test]
    fn the_dearest_is_dropped_first_and_the_base_line_last() {
        let costs = [cost(0.03), cost(0.01), cost(0.02)];
        let at = |seconds| next(Some(4), &[0, 1, 2], &costs, 5, left(seconds)).map(|l| l.variants);
        // 8 samples and five seeds: 1.2 s, 0.4 s, 0.8 s.
        assert_eq!(at(2.8), Some(vec![0, 1, 2]));
        assert_eq!(at(2.5), Some(vec![0, 1]));
        assert_eq!(at(1.5), Some(vec![0]));
        assert_eq!(at(1.0), None);
    }

    #[test]
    fn the_base_line_goes_on_alone_by_as_much_as_it_can() {
        let costs = [cost(0.01)];
        let at = |seconds| next(Some(4), &[0], &costs, 5, left(seconds)).map(|l| l.spp);
        assert_eq!(at(0.81), Some(16));
        assert_eq!(at(0.79), Some(8));
    }

    #[test]
    fn who_waits_for_more_samples_costs_nothing_meanwhile() {
        let waiting = Cost {
            least_spp: 65,
            ..cost(9.0)
        };
        let level = next(Some(4), &[0, 1], &[cost(0.01), waiting], 5, left(2.0)).unwrap();
        assert_eq!((level.spp, level.variants), (16, vec![0, 1]));
    }

    #[test]
    fn the_picture_shrinks_to_what_fits_and_never_grows() {
        let size = |seconds| picture_size([800, 600], 320, 1e-6, 100.0, seconds);
        assert_eq!(size(1e6), [320, 240]);
        assert_eq!(size(0.0), [96, 72]);
        // 84·100 pictures of 120·90 pixels take 90.7 s.
        assert_eq!(size(90.8), [120, 90]);
        assert_eq!(picture_size([32, 24], 320, 1e-6, 100.0, 1e6), [32, 24]);
        assert_eq!(picture_size([1000, 1], 320, 1e-6, 100.0, 1e6), [320, 1]);
    }
}
