//! `seed` and `rand`: the same numbers as POV-Ray, bit for bit, since scenes place objects by them.
//! Source: the sequence state ← state·1812433253 + 12345 mod 2³², value = state / (2³² − 1).

use super::Interp;

impl Interp<'_> {
    /// Starts a sequence and returns its handle.
    pub fn new_generator(&mut self, seed: f64) -> f64 {
        if self.generators.len() >= 1 << 20 {
            return 0.0; // a loop that seeds anew each time; the sequences are indistinguishable by then
        }
        self.generators.push((seed as i64) as u32);
        (self.generators.len() - 1) as f64
    }

    /// The next number of a sequence, in [0, 1]; `None` if there is no such sequence.
    pub fn next_random(&mut self, handle: f64) -> Option<f64> {
        if !(handle >= 0.0 && handle.is_finite()) {
            return None;
        }
        let state = self.generators.get_mut(handle as usize)?;
        *state = state.wrapping_mul(1_812_433_253).wrapping_add(12_345);
        Some(f64::from(*state) / f64::from(u32::MAX))
    }
}
