//! Sample points: Owen-scrambled Sobol' nets, addressed by (seed, pixel, sample, bounce, decision); for comparison,
//! independent numbers by the same addresses.
//!
//! Nothing is consumed in sequence: a number depends only on its address, so threads, tiles and effects that
//! are left out shift nothing. Sample i of a pixel is point j = i div R of net r = i mod R; the R nets are
//! scrambled independently, which is what makes the spread between them an honest error bar.
//!
//! Each group of four decisions is one four-dimensional net, shuffled and scrambled by its own seed
//! (padding). Sources: Sobol' 1967 with Joe & Kuo's direction numbers; Burley, Practical Hash-based Owen
//! Scrambling, JCGT 2020; the hash is Vegdahl's improvement of Laine and Karras's.

use super::technique::SamplerKind;

/// Groups of four decisions at one bounce. The numbers are addresses: never reuse one for something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Group {
    /// Camera: position in the pixel (0, 1), on the lens (2, 3). Surface: direction (0, 1), lobe (2), roulette (3).
    Primary = 0,
    /// Camera: time (0), wavelength (1). Surface: point on the light (0, 1), which light (2), mix (3).
    Light = 1,
    /// Media: distance (0), the channel that decides it (1). Directions, roulette and lights are as at surfaces.
    Medium = 2,
    /// Spare, so that a new decision shifts nothing.
    Spare = 3,
}

/// Single decisions that may repeat at one bounce; they are hashed with a step number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Repeated {
    /// Whether the surface is there (alpha).
    Coverage = 0,
    /// Which of two mixed materials.
    Mix = 1,
    /// Scattering at a surface reached after a pass-through: direction, lobe, roulette, light.
    AfterPass = 2,
    /// Coverage along a shadow ray.
    ShadowCoverage = 3,
}

/// The numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    /// Seed of this pixel and net.
    base: u64,
    /// Bit-reversed point number within the net.
    reversed_index: u32,
    /// Hash of pixel, net and point, for repeated decisions.
    hash: u64,
}

const GROUPS: u64 = 4;

impl Sampler {
    /// The numbers of sample `sample` of the pixel, with `nets` independent nets (≥ 1). All 2³²·nets samples differ.
    pub fn new(seed: u64, pixel: u32, sample: u64, nets: u32) -> Sampler {
        Sampler::of_kind(SamplerKind::Sobol, seed, pixel, sample, nets)
    }

    /// As [`Sampler::new`], or with numbers that are hashes of the same addresses: independent of all others, within a
    /// sample and between samples.
    pub fn of_kind(kind: SamplerKind, seed: u64, pixel: u32, sample: u64, nets: u32) -> Sampler {
        let net = sample % u64::from(nets);
        let index = (sample / u64::from(nets)) as u32;
        let base = mix64(mix64(seed ^ 0x9E37_79B9_7F4A_7C15).wrapping_add(u64::from(pixel) << 8 | net));
        Sampler {
            kind,
            base,
            reversed_index: index.reverse_bits(),
            hash: mix64(base ^ (u64::from(index) << 1 | 1)),
        }
    }

    /// Four numbers in [0, 1) for a group of decisions at a bounce (0 is the camera, 1 the first surface).
    #[inline(always)]
    pub fn get4(&self, bounce: u32, group: Group) -> [f32; 4] {
        if self.kind == SamplerKind::Independent {
            return self.hashed4(bounce, group);
        }
        let h = mix64(
            self.base
                .wrapping_add((u64::from(bounce) * GROUPS + group as u64) << 1 | 1),
        );
        let index = laine_karras(self.reversed_index, h as u32).to_le_bytes();
        let mut out = [0; 4];
        for (table, byte) in TABLES.iter().zip(index) {
            let column = &table[byte as usize];
            for (o, c) in out.iter_mut().zip(column) {
                *o ^= c;
            }
        }
        let seed = (h >> 32) as u32;
        let mut u = [0.0; 4];
        for (d, (u, o)) in u.iter_mut().zip(out).enumerate() {
            let scrambled = laine_karras(o, mix32(seed.wrapping_add(0x9E37_79B9u32.wrapping_mul(d as u32 + 1))));
            *u = unit_f32(scrambled.reverse_bits());
        }
        u
    }

    /// As [`Sampler::get4`] without any net. Apart from it, so that the usual way stays short.
    #[inline(never)]
    fn hashed4(&self, bounce: u32, group: Group) -> [f32; 4] {
        // Above the addresses of repeated decisions, which use up to 4·2³² of each bounce's 2⁴⁰.
        let address = (u64::from(bounce) << 40) | ((GROUPS + group as u64) << 32);
        let pair = |i: u64| {
            let h = mix64(self.hash ^ mix64(address | i));
            [unit_f32(h as u32), unit_f32((h >> 32) as u32)]
        };
        let ([a, b], [c, d]) = (pair(0), pair(1));
        [a, b, c, d]
    }

    /// A number in [0, 1) for the `step`-th repetition of a decision at a bounce; independent, not stratified.
    pub fn repeated(&self, bounce: u32, decision: Repeated, step: u32) -> f32 {
        let address = (u64::from(bounce) << 40) | ((decision as u64) << 32) | u64::from(step);
        unit_f32((mix64(self.hash ^ mix64(address)) >> 32) as u32)
    }

    /// Four numbers for scattering after `step` pass-throughs at a bounce.
    pub fn repeated4(&self, bounce: u32, group: Group, step: u32) -> [f32; 4] {
        let step = (step * GROUPS as u32 + group as u32) * 4;
        std::array::from_fn(|i| self.repeated(bounce, Repeated::AfterPass, step + i as u32))
    }
}

/// The 24 high bits as a number in [0, 1).
fn unit_f32(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A hash in which each bit depends only on itself and lower bits: on reversed numbers, an Owen scramble.
#[inline(always)]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Finaliser of SplitMix64 (Steele, Lea & Flood 2014).
#[inline(always)]
fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// A 32-bit finaliser (Wellons, hash prospector "lowbias32").
#[inline(always)]
fn mix32(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// `TABLES[k][b][d]`: what byte `b` at place `k` of the *bit-reversed* point number contributes to the
/// *bit-reversed* coordinate `d`.
static TABLES: [[[u32; 4]; 256]; 4] = tables();

/// Direction numbers of the first four Sobol' dimensions (Joe & Kuo 2008, new-joe-kuo-6): bit `i` of the
/// point number, counted from the lowest, contributes `v[i]`.
const fn direction_numbers(dim: usize) -> [u32; 32] {
    // Degree, inner coefficients and initial numbers of the primitive polynomials.
    let (degree, coefficients, initial): (usize, u32, [u32; 3]) = match dim {
        1 => (1, 0, [1, 0, 0]),
        2 => (2, 1, [1, 3, 0]),
        _ => (3, 1, [1, 3, 1]),
    };
    let mut v = [0u32; 32];
    let mut i = 0;
    while i < 32 {
        if dim == 0 {
            v[i] = 1 << (31 - i);
        } else if i < degree {
            v[i] = initial[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if (coefficients >> (degree - 1 - k)) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    v
}

const fn tables() -> [[[u32; 4]; 256]; 4] {
    let mut t = [[[0u32; 4]; 256]; 4];
    let mut d = 0;
    while d < 4 {
        let v = direction_numbers(d);
        let mut place = 0;
        while place < 4 {
            let mut byte = 0;
            while byte < 256 {
                let mut bit = 0;
                while bit < 8 {
                    if (byte >> bit) & 1 == 1 {
                        // Bit `8·place + bit` of the reversed number is bit `31 − …` of the number.
                        t[place][byte][d] ^= v[31 - (place * 8 + bit)].reverse_bits();
                    }
                    bit += 1;
                }
                byte += 1;
            }
            place += 1;
        }
        d += 1;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The defining property of a (0, m, 2)-net and of stratification: of 2^m points of a net, each of the 2^m
    /// intervals of every coordinate holds one, and so does each elementary rectangle of the first two.
    #[test]
    fn every_power_of_two_points_are_stratified() {
        for m in [4u32, 7, 10] {
            let n = 1u32 << m;
            for pixel in 0..5 {
                let points: Vec<[f32; 4]> = (0..n)
                    .map(|j| Sampler::new(3, pixel, u64::from(j), 1).get4(2, Group::Light))
                    .collect();
                for d in 0..4 {
                    let mut seen = vec![0; n as usize];
                    points.iter().for_each(|p| seen[(p[d] * n as f32) as usize] += 1);
                    assert!(seen.iter().all(|&c| c == 1), "dimension {d} of 2^{m} points");
                }
                for a in 0..=m {
                    let (wa, wb) = (1u32 << a, 1u32 << (m - a));
                    let mut seen = vec![0; n as usize];
                    for p in &points {
                        let cell = (p[0] * wa as f32) as u32 * wb + (p[1] * wb as f32) as u32;
                        seen[cell as usize] += 1;
                    }
                    assert!(seen.iter().all(|&c| c == 1), "rectangles 2^-{a} of 2^{m} points");
                }
            }
        }
    }

    /// Exactly: each of the 2¹³ largest and smallest integers gives its 24 high bits, and none gives 1. A plain
    /// conversion of the integer gives 1 for the 128 largest.
    #[test]
    fn random_numbers_never_reach_one() {
        let largest = 1.0 - 2f64.powi(-24);
        for k in 0..=1 << 13 {
            for x in [k, u32::MAX - k] {
                let found = unit_f32(x);
                assert_eq!(f64::from(found), f64::from(x >> 8) * 2f64.powi(-24), "{x}");
                assert!(f64::from(found) <= largest, "{x} gives {found}");
            }
        }
        assert!((u32::MAX - 127..=u32::MAX).all(|x| x as f32 * 2f32.powi(-32) == 1.0));
        assert_eq!(f64::from(unit_f32(u32::MAX)), largest);
    }

    /// All numbers of all kinds are made of integers in that way: stratified ones in the last stratum as well. Of 2¹⁶
    /// points of a net one has the largest stratum of each coordinate, wherever in it.
    #[test]
    fn no_kind_of_number_reaches_one() {
        let n = 1u32 << 16;
        for kind in [SamplerKind::Sobol, SamplerKind::Independent] {
            let mut in_last = [0; 4];
            for sample in (0..n).chain(u32::MAX - 100..=u32::MAX) {
                let s = Sampler::of_kind(kind, 3, 5, u64::from(sample), 1);
                let numbers = s.get4(1, Group::Primary);
                for u in numbers.into_iter().chain(s.repeated4(2, Group::Light, sample & 0xffff)) {
                    assert!((0.0..1.0).contains(&u), "{kind:?}, sample {sample}: {u}");
                }
                for (count, u) in in_last.iter_mut().zip(numbers) {
                    *count += u32::from(sample < n && u >= 1.0 - 1.0 / n as f32);
                }
            }
            assert!(kind != SamplerKind::Sobol || in_last == [1; 4], "{in_last:?}");
        }
    }

    /// A number far beyond 2¹⁶ samples and at a deep bounce is as good as any: no wrap.
    #[test]
    fn late_samples_and_deep_bounces_do_not_repeat() {
        let a = Sampler::new(0, 9, 70_000, 1).get4(500, Group::Primary);
        let b = Sampler::new(0, 9, 70_000 - 65_536, 1).get4(500, Group::Primary);
        assert_ne!(a, b);
        assert!(a.iter().all(|u| (0.0..1.0).contains(u)));
    }

    /// χ² of pairs of one sample, over consecutive samples and over pixels, each at a false-alarm rate of 10⁻⁴: hashed
    /// numbers know nothing of one another. A net's would fail the first by being too even, which the bound from the
    /// other side shows.
    #[test]
    fn independent_numbers_are_uniform_and_not_stratified() {
        let n = 1u32 << 16;
        let k = 64;
        let p_of = |kind, numbers: &dyn Fn(&Sampler) -> (f32, f32), place: &dyn Fn(u32) -> (u32, u64)| {
            let mut counts = vec![0.0; k * k];
            for i in 0..n {
                let (pixel, sample) = place(i);
                let (x, y) = numbers(&Sampler::of_kind(kind, 5, pixel, sample, 4));
                counts[(x * k as f32) as usize * k + (y * k as f32) as usize] += 1.0;
            }
            crate::math::stats::chi2_test(&counts, &vec![f64::from(n) / (k * k) as f64; k * k])
        };
        let one = |s: &Sampler| {
            let u = s.get4(3, Group::Light);
            (u[0], u[1])
        };
        let two = |s: &Sampler| (s.get4(1, Group::Primary)[3], s.get4(2, Group::Light)[2]);
        let samples = |i: u32| (9, u64::from(i));
        let pixels = |i: u32| (i, 9);
        let independent = SamplerKind::Independent;
        for p in [
            p_of(independent, &one, &samples),
            p_of(independent, &one, &pixels),
            p_of(independent, &two, &samples),
            p_of(independent, &two, &pixels),
        ] {
            assert!(p > 1e-4 && p < 1.0 - 1e-4, "p = {p}");
        }
        let net = p_of(SamplerKind::Sobol, &one, &samples);
        assert!(net > 1.0 - 1e-4, "the net is no more even than chance: p = {net}");
    }

    /// χ² over pixels: the nets of different pixels and groups are scrambled independently.
    #[test]
    fn numbers_of_one_sample_are_uniform_over_pixels() {
        let k = 16;
        let mut counts = vec![0.0; k * k];
        let n = 100_000;
        for pixel in 0..n {
            let s = Sampler::new(1, pixel, 0, 4);
            let (x, y) = (s.get4(0, Group::Primary)[0], s.get4(1, Group::Light)[0]);
            counts[(x * k as f32) as usize * k + (y * k as f32) as usize] += 1.0;
        }
        let p = crate::math::stats::chi2_test(&counts, &vec![f64::from(n) / (k * k) as f64; k * k]);
        assert!(p > 1e-4, "p = {p}");
    }
}
