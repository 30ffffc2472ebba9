//! What the pixels of a tile cost: one reading of the clock for each pixel and pass.
//!
//! Times are no part of the picture: they are not kept in part files, and two runs never agree on them.

use std::time::{Duration, Instant};

/// The wall clock time that the samples of each pixel took.
#[derive(Clone, Debug)]
pub struct PixelClock {
    spent: Vec<Duration>,
    samples: u32,
    /// The pixel that is being sampled, and since when.
    running: Option<(usize, Instant)>,
}

impl PixelClock {
    /// Of no samples.
    pub fn new(pixels: usize) -> PixelClock {
        PixelClock {
            spent: vec![Duration::ZERO; pixels],
            samples: 0,
            running: None,
        }
    }

    /// Tells that a sample of this pixel comes next. Reads the clock if the one before was of another.
    pub fn enter(&mut self, pixel: usize) {
        if self.running.is_none_or(|(before, _)| before != pixel) {
            self.switch(Some(pixel));
        }
    }

    /// Tells that every pixel has got `samples` more.
    pub fn pass_ends(&mut self, samples: u32) {
        self.switch(None);
        self.samples += samples;
    }

    fn switch(&mut self, to: Option<usize>) {
        let now = Instant::now();
        if let Some((pixel, since)) = self.running
            && let Some(spent) = self.spent.get_mut(pixel)
        {
            *spent += now - since;
        }
        self.running = to.map(|pixel| (pixel, now));
    }

    /// Nanoseconds per sample of a pixel; NaN without samples.
    pub fn per_sample(&self, pixel: usize) -> f32 {
        match self.spent.get(pixel) {
            Some(spent) if self.samples > 0 => (spent.as_nanos() as f64 / f64::from(self.samples)) as f32,
            _ => f32::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: a pixel that sleeps costs at least its sleep, and all pixels together no more than the whole.
    #[test]
    fn each_pixel_is_charged_for_its_own_samples() {
        let nap = Duration::from_millis(3);
        let begun = Instant::now();
        let mut clock = PixelClock::new(3);
        assert!(clock.per_sample(0).is_nan());
        for _ in 0..2 {
            for pixel in 0..3 {
                clock.enter(pixel);
                clock.enter(pixel);
                if pixel == 1 {
                    std::thread::sleep(nap);
                }
            }
            clock.pass_ends(2);
        }
        let whole = begun.elapsed();
        let times = [0, 1, 2].map(|p| clock.per_sample(p));
        assert!(f64::from(times[1]) >= 1e9 * 2.0 * nap.as_secs_f64() / 4.0, "{times:?}");
        let sum: f32 = times.iter().sum();
        assert!(
            4.0 * f64::from(sum) <= 1.001e9 * whole.as_secs_f64(),
            "{times:?} in {whole:?}"
        );
        assert!(clock.per_sample(3).is_nan());
    }
}
