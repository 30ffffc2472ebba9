//! Made-up studies for tests: laws that are known, noise from a fixed seed.

use super::experiment::*;

/// A small generator (SplitMix64; Steele, Lea and Flood 2014) for the noise.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Sum of twelve uniforms: close to a standard normal.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// The law of one variant: E² = b² + (c·n^−a)², t = 0.05 s + k·n.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    pub c: f64,
    pub a: f64,
    pub b: f64,
    pub k: f64,
}

pub const BASE: Law = Law {
    c: 0.6,
    a: 0.52,
    b: 0.0,
    k: 0.02,
};

pub const LADDER: [u32; 5] = [4, 16, 64, 256, 1024];

/// Axis, name, kind, law.
pub type Entry = (&'static str, &'static str, Kind, Law);

/// With the base line's noise and seconds for a sample times the given factors.
pub fn entry(axis: &'static str, name: &'static str, kind: Kind, noise: f64, bias: f64, cost: f64) -> Entry {
    let law = Law {
        c: BASE.c * noise,
        a: BASE.a,
        b: bias,
        k: BASE.k * cost,
    };
    (axis, name, kind, law)
}

/// Twenty-four ways around the base line, on twelve axes.
pub fn entries() -> Vec<Entry> {
    use Kind::{Bias, Variance};
    let mut independent = entry("sampler", "independent", Variance, 1.5, 0.0, 0.95);
    independent.3.a = 0.5;
    vec![
        independent,
        entry("direct", "bsdf", Variance, 6.0, 0.0, 0.7),
        entry("direct", "light", Variance, 1.3, 0.0, 0.9),
        entry("depth", "2", Bias, 0.7, 0.12, 0.45),
        entry("depth", "4", Bias, 0.9, 0.03, 0.7),
        entry("depth", "8", Bias, 1.0, 0.006, 0.9),
        entry("depth", "64", Variance, 1.0, 0.0, 1.02),
        entry("roulette", "off", Variance, 0.93, 0.0, 1.6),
        entry("roulette", "late", Variance, 0.97, 0.0, 1.2),
        entry("lights", "uniform", Variance, 2.1, 0.0, 0.97),
        entry("lights", "power", Variance, 1.2, 0.0, 0.98),
        entry("fresnel", "schlick", Bias, 1.0, 0.011, 0.99),
        entry("fresnel", "schlick wrong side", Bias, 1.0, 0.09, 0.99),
        entry("compensation", "off", Bias, 0.98, 0.02, 0.97),
        entry("textures", "nearest", Bias, 1.05, 0.015, 0.93),
        entry("textures", "bilinear", Bias, 1.01, 0.004, 0.97),
        entry("clamp", "10", Bias, 0.7, 0.012, 1.0),
        entry("clamp", "1", Bias, 0.4, 0.07, 1.0),
        entry("adaptive", "on", Variance, 0.85, 0.0, 1.1),
        entry("threads", "1", Variance, 1.0, 0.0, 7.4),
        entry("threads", "2", Variance, 1.0, 0.0, 3.8),
        entry("threads", "4", Variance, 1.0, 0.0, 1.95),
        entry("build", "fast", Variance, 1.0, 0.0, 1.3),
        entry("build", "best", Variance, 1.0, 0.0, 0.94),
    ]
}

/// A study of the base line and the first `variants − 1` of [`entries`].
pub fn study(variants: usize) -> Study {
    with(entries().into_iter().take(variants.saturating_sub(1)).collect())
}

/// A study of the base line and the given ways; five seeds a point.
pub fn with(entries: Vec<Entry>) -> Study {
    let base = ("samples", "as written", Kind::Variance, BASE);
    let all: Vec<Entry> = std::iter::once(base).chain(entries).collect();
    let variant = |(axis, name, kind, _): &Entry| Variant {
        axis: (*axis).to_owned(),
        name: (*name).to_owned(),
        kind: *kind,
        flags: match *axis {
            "samples" => String::new(),
            _ => format!("--{axis} {name}"),
        },
    };
    let mut noise = Noise(7);
    let mut rows = Vec::new();
    for (index, (axis, name, _, law)) in all.iter().enumerate() {
        for (rung, &spp) in LADDER.iter().enumerate() {
            // Side axes climb a shorter ladder.
            if index > 0 && !(1..=3).contains(&rung) {
                continue;
            }
            rows.extend((1..=5).map(|seed| row(&mut noise, index, law, axis, name, spp, seed)));
        }
    }
    Study {
        scene: "cornell.pts".to_owned(),
        size: [640, 480],
        full_size: [640, 480],
        command: "pts study cornell.pts --budget 10m --error 2%".to_owned(),

        scene_flags: String::new(),
        version: "0.1.0 (1a42351)".to_owned(),
        processor: "AMD EPYC 7763 64-Core Processor".to_owned(),
        threads: 8,
        seconds: 612.0,
        reference: Reference {
            source: "rendered here, seed 1000".to_owned(),
            spp: Some(16384),
            error: Some(0.0021),
            seconds: Some(320.0),
        },
        goal: Goal::Error(0.02),
        variants: all.iter().map(variant).collect(),
        rows,
        ablations: ablations(),
        notes: vec!["The axis media was left out: the scene has no fog.".to_owned()],
    }
}

fn row(noise: &mut Noise, index: usize, law: &Law, axis: &str, name: &str, spp: u32, seed: u64) -> Row {
    let n = f64::from(spp);
    let variance = (law.c * n.powf(-law.a)).powi(2);
    let e2 = law.b.powi(2) + variance * (1.0 + 0.06 * noise.normal());
    let threads = match axis {
        "threads" => name.parse().unwrap_or(8),
        _ => 8,
    };
    Row {
        variant: index,
        seed,
        threads,
        seconds: Phases {
            load: 0.03,
            compile: 0.02,
            render: law.k * n * (1.0 + 0.02 * noise.normal()),
        },
        spp,
        samples: u64::from(spp) * 640 * 480,
        rays: u64::from(spp) * 640 * 480 * 9,
        e2,
        e2_se: 0.06 * variance + 2e-7,
        estimate: Some([variance.sqrt() * 1.04, variance.sqrt() * 1.12]),
        flip: 0.4 * e2.max(0.0).sqrt(),
        energy: 1.0 - law.b + 0.001 * noise.normal(),
    }
}

fn ablations() -> Vec<Ablation> {
    let ablation = |effect: &str, time: f64, energy: f64, flip: f64, significant: bool| Ablation {
        effect: effect.to_owned(),
        time,
        time_se: 0.01,
        energy,
        energy_se: 0.001,
        flip,
        blocks: if significant { 0.4 } else { 0.001 },
        significant,
    };
    vec![
        ablation("caustics", 0.41, 0.023, 0.020, true),
        ablation("roughness", 0.02, -0.004, 0.008, true),
        ablation("textures", -0.003, 0.0002, 0.001, false),
    ]
}
