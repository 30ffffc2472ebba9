//! Russian roulette: how likely a path is to go on.

use super::Kernel;
use glam::Vec3;

/// The bounce at which roulette begins. Measured on the lecture's scene: 2, 3 and 4 are equally efficient.
pub(super) const FROM: u32 = 2;
/// From this bounce on no path survives for certain, so that lossless rooms end.
pub(super) const ALWAYS_FROM: u32 = 32;
/// From this bounce on fewer survive, so that the longest of many paths stays short.
const HARDER_FROM: u32 = 4096;

/// The probability with which a path of this throughput goes on: it does if a number in [0, 1) is below it, and is then
/// divided by it. In [0, 1]; 0 exactly for a path that carries nothing, which ends before anything is divided.
/// Some texts call this number the probability of termination and use it as that of survival all the same.
#[inline(always)]
pub(super) fn survival(throughput: Vec3, bounce: u32) -> f32 {
    throughput.max_element().min(most(bounce))
}

impl Kernel<'_> {
    /// Whether a path goes on, by a number in [0, 1): its throughput is then divided by the probability of that. Before
    /// roulette begins, paths end that carry nothing.
    #[inline(always)]
    pub(super) fn survives(&self, throughput: &mut Vec3, bounce: u32, number: f32) -> bool {
        if bounce < self.roulette_from {
            return *throughput != Vec3::ZERO;
        }
        let survival = survival(*throughput, bounce);
        let goes_on = number < survival;
        if goes_on {
            *throughput /= survival;
        }
        goes_on
    }
}

/// The largest probability of surviving the k-th bounce: 1, from 32 on 1 − 1/k, from 4096 on 1 − 2/k.
///
/// Of lossless paths 32/k reach bounce k, with a weight of k/32. A fixed share instead, 1 − a, lets the weights of a room
/// of albedo 1 − ε grow like ((1 − ε)/(1 − a))^k and is of infinite variance for ε < a/2; growing like k they cost a
/// room that sums 1/ε bounces a relative variance of about 1/(384·ε).
fn most(bounce: u32) -> f32 {
    let lost = match bounce {
        0..ALWAYS_FROM => return 1.0,
        ALWAYS_FROM..HARDER_FROM => 1.0,
        _ => 2.0,
    };
    1.0 - lost / bounce as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All random numbers that there are: multiples of 2⁻²⁴ below 1.
    const NUMBERS: f64 = 16_777_216.0;

    /// How many of them let a path go on, by the comparison that the kernel makes (u < survival): counted around the
    /// border, where it falls.
    fn survivors(survival: f32) -> f64 {
        let border = (f64::from(survival) * NUMBERS).floor() as i64;
        let below = (border - 2..=border + 2)
            .filter(|&k| k >= 0 && (k as f64) < NUMBERS)
            .filter(|&k| (k as f32 / NUMBERS as f32) < survival)
            .count() as i64;
        ((border - 2).max(0) + below) as f64
    }

    /// What goes on, divided by the survival, is what came, in the mean over all numbers: the border falls between two
    /// of them, so it is off by 2⁻²⁴/q at most. With q as the probability of ending the mean would be (1 − q)/q.
    #[test]
    fn what_goes_on_makes_up_for_what_ends() {
        for i in 1..=1000 {
            let throughput = Vec3::new(0.1, 1.0, 0.5) * (i as f32 / 1000.0);
            for bounce in [FROM, ALWAYS_FROM, 40, 5000] {
                let q = survival(throughput, bounce);
                assert!(q > 0.0 && q <= most(bounce));
                let mean = survivors(q) / NUMBERS / f64::from(q);
                assert!(
                    (mean - 1.0).abs() <= 1.0 / NUMBERS / f64::from(q),
                    "{throughput}: {mean}"
                );
            }
        }
    }

    /// u = 0 is the number that would let anything go on, 1 − 2⁻²⁴ the one that would end anything.
    #[test]
    fn nothing_ends_and_everything_goes_on() {
        for bounce in [FROM, ALWAYS_FROM, 1000] {
            assert_eq!(survivors(survival(Vec3::ZERO, bounce)), 0.0);
        }
        assert_eq!(survivors(survival(Vec3::ONE, FROM)), NUMBERS);
        assert_eq!(survivors(survival(Vec3::splat(3.0), FROM)), NUMBERS);
        // The faintest path that lives is as bright as any afterwards.
        let faint = f32::from_bits(1);
        assert_eq!(faint / survival(Vec3::splat(faint), FROM), 1.0);
    }
}
