//! Choosing one of several things by probability, so that the stated probability is the realised one.

/// A random number with 52 bits whose first 24 are those of `u`; the rest is a hash of `u` and `salt`.
///
/// A choice among many needs finer numbers than f32 has: with 24 bits a light of probability 10⁻⁶ gets 16 or 17 of
/// the numbers, which is 6 % off. `salt` should come from another random number of the same sample.
pub(crate) fn extend(u: f32, salt: u32) -> f64 {
    let mut h = u.to_bits() ^ salt.rotate_left(13) ^ 0x9e37_79b9;
    // Source of the mixing constants: Mueller, "lowbias32", found by exhaustive search for low bias.
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^= h >> 16;
    let low = f64::from(h >> 4) / f64::from(1u32 << 28);
    (f64::from(u) + low / 16_777_216.0).min(1.0 - f64::EPSILON)
}

/// Where `x` lies between `a` and `b`, in [0, 1): the number left over after a choice, as good as a new one.
pub(crate) fn remap(x: f64, a: f64, b: f64) -> f64 {
    if b > a {
        ((x - a) / (b - a)).clamp(0.0, 1.0 - f64::EPSILON)
    } else {
        0.0
    }
}

/// Fixed probabilities, chosen by bisection of cumulative sums in f64.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// Cumulative, ending in 1.
    ends: Vec<f64>,
}

impl Table {
    /// Probabilities proportional to `weights`, mixed with an even `share` so that no positive weight is starved;
    /// zero weights stay at 0. Even if no weight is positive.
    pub fn new(weights: &[f64], share: f64) -> Table {
        let usable = |w: f64| if w > 0.0 && w.is_finite() { w } else { 0.0 };
        let total: f64 = weights.iter().map(|&w| usable(w)).sum();
        let lit = weights.iter().filter(|&&w| usable(w) > 0.0).count();
        let mut sum = 0.0;
        let mut ends: Vec<f64> = weights
            .iter()
            .map(|&w| {
                sum += if total > 0.0 && total.is_finite() {
                    if usable(w) > 0.0 {
                        (1.0 - share) * usable(w) / total + share / lit as f64
                    } else {
                        0.0
                    }
                } else {
                    1.0 / weights.len() as f64
                };
                sum
            })
            .collect();
        let last = (0..ends.len())
            .rev()
            .find(|&i| i == 0 || ends[i] > ends[i - 1])
            .unwrap_or(0);
        for end in ends.iter_mut().skip(last) {
            *end = 1.0;
        }
        Table { ends }
    }

    /// The chosen index and its probability.
    pub fn sample(&self, u: f64) -> Option<(usize, f64)> {
        let i = self.ends.partition_point(|&c| c <= u);
        (i < self.ends.len()).then(|| (i, self.probability(i)))
    }

    /// Probability of index `i`, 0 outside.
    pub fn probability(&self, i: usize) -> f64 {
        let end = self.ends.get(i).copied().unwrap_or(0.0);
        let start = if i == 0 {
            0.0
        } else {
            self.ends.get(i - 1).copied().unwrap_or(0.0)
        };
        end - start
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::robust::ONE_MINUS;

    /// The longer number lies in the step of the short one it came from, and below 1 also after the longest; what is left
    /// over after a choice is below 1 as well.
    #[test]
    fn longer_numbers_stay_below_one_and_in_their_step() {
        let step = 2f64.powi(-24);
        for k in 0..1u32 << 12 {
            for u in [k as f32 / 16_777_216.0, ONE_MINUS - k as f32 / 16_777_216.0] {
                for salt in [0, 1, 0x8000_0000, u32::MAX, k.wrapping_mul(0x9e37_79b9)] {
                    let x = extend(u, salt);
                    assert!(
                        x < 1.0 && x >= f64::from(u) && x <= f64::from(u) + step,
                        "{u}, {salt}: {x}"
                    );
                    for (a, b) in [(0.0, 1.0), (0.0, x + 1e-18), (x - 1e-9, x + f64::EPSILON), (x, x)] {
                        assert!((0.0..1.0).contains(&remap(x, a, b)), "{x} between {a} and {b}");
                    }
                }
            }
        }
    }
}
