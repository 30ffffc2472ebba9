//! The classic box against an independent f64 path tracer (`support/reference.rs`), and the ways of finding direct
//! light against one another. All seeds are fixed: what passes here passes everywhere and always. The limits are
//! those that a correct renderer would miss with the stated probability, had the seed been drawn anew.

mod support;

use pts::render::settings::Settings;
use pts::render::technique::{Direct, Technique};
use support::estimate::{Estimate, Region, RegionMean, WHOLE};
use support::reference::{CORNELL_REGIONS, cornell, render};
use support::{images, scenes, ztest};

const SCENE: &str = "scenes/cornell.pts";
const SIZE: [u32; 2] = [96, 72];

/// Pictures that agree are told apart once in a thousand draws of the seed.
const ALPHA: f64 = 1e-3;

fn regions() -> impl Iterator<Item = Region> {
    CORNELL_REGIONS.into_iter().chain([WHOLE])
}

#[track_caller]
fn assert_same_picture(name: &str, expected: &Estimate, found: &Estimate, block: usize) {
    let verdict = ztest::compare(found, expected, block, ALPHA);
    assert!(
        verdict.agree(),
        "{name}: {verdict}\nsee {}",
        images::write_strip(name, expected, found).display()
    );
}

/// Block by block against the reference as it runs now, with other random numbers and other formulas.
#[test]
fn the_classic_box_is_the_reference_block_by_block() {
    let expected = render(&cornell(4.0 / 3.0), SIZE[0] as usize, SIZE[1] as usize, 250, 11);
    let found = scenes::ready(SCENE, &[], SIZE).estimate(1024, 1);
    assert_same_picture("reference", &expected, &found, 12);
}

/// Region means of the reference, from a run of 60 000 samples a pixel at this size: mean and standard error
/// (PTS_BLESS=1 PTS_BLESS_SPP=60000 prints a new table).
const MEANS: &[(&str, [f64; 3], [f64; 3])] = &[
    (
        "red wall",
        [0.288554, 0.086628, 0.107087],
        [0.000267, 0.000083, 0.000106],
    ),
    (
        "blue wall",
        [0.106031, 0.086227, 0.288715],
        [0.000118, 0.000096, 0.000312],
    ),
    (
        "back wall",
        [0.246193, 0.188725, 0.250483],
        [0.000211, 0.000176, 0.000214],
    ),
    (
        "ceiling",
        [0.152575, 0.099175, 0.135652],
        [0.000488, 0.000352, 0.000457],
    ),
    ("floor", [0.514630, 0.439179, 0.493743], [0.000480, 0.000440, 0.000473]),
    (
        "mirror ball",
        [0.555191, 0.418477, 0.468545],
        [0.000556, 0.000421, 0.000476],
    ),
    (
        "glass ball",
        [0.254127, 0.219123, 0.335564],
        [0.000356, 0.000316, 0.000426],
    ),
    (
        "whole image",
        [0.355191, 0.273274, 0.357279],
        [0.000068, 0.000052, 0.000069],
    ),
];

/// The image and each thing in it, within 0.5 % of a long run of the reference. Three standard errors of noise are
/// allowed on top; they may be 2 % in the noisiest region (the ceiling) and are a quarter of that in most.
#[test]
fn every_part_of_the_classic_box_has_its_mean() {
    if std::env::var_os("PTS_BLESS").is_some() {
        bless();
    }
    let found = scenes::ready(SCENE, &[], SIZE).estimate(4096, 2);
    assert_eq!(MEANS.len(), regions().count());
    for region in regions() {
        let (_, mean, stderr) = MEANS
            .iter()
            .find(|(n, ..)| *n == region.name)
            .expect("the region was blessed");
        let expected = RegionMean {
            mean: *mean,
            stderr: *stderr,
        };
        let found = found.region(region);
        println!("{:12} {:?} against {:?}", region.name, found.mean, mean);
        for (c, &m) in mean.iter().enumerate() {
            let noise = 3.0 * found.stderr[c].hypot(expected.stderr[c]);
            assert!(noise <= 0.02 * m, "{}: too noisy to judge: {noise} of {m}", region.name);
        }
        found.assert_agrees(&expected, 0.005, 3.0, region.name);
    }
}

/// Prints the table of region means.
fn bless() {
    let spp = std::env::var("PTS_BLESS_SPP")
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(4000);
    let long = render(&cornell(4.0 / 3.0), SIZE[0] as usize, SIZE[1] as usize, spp, 77);
    for region in regions() {
        let RegionMean { mean, stderr } = long.region(region);
        println!("BLESSED ({:?}, {mean:.6?}, {stderr:.6?}),", region.name);
    }
}

/// Light sampling, hits, and both together are three estimators of one picture.
#[test]
fn all_ways_of_finding_direct_light_agree() {
    let cases: [(&str, &str, [u32; 3]); 4] = [
        ("box", SCENE, [256, 256, 512]),
        ("lamps", "tests/hard/direct/lamps.pts", [256, 256, 4096]),
        ("sky", "tests/hard/direct/sky.pts", [256, 256, 2048]),
        ("glass", "tests/hard/direct/glass.pts", [512, 512, 1024]),
    ];
    for (name, scene, spp) in cases {
        let size = [48, 36];
        let ready = scenes::ready(scene, &[], size);
        let shots = [Direct::Mis, Direct::Light, Direct::Bsdf].map(|direct| {
            let spp = spp[direct as usize];
            let technique = Technique {
                direct,
                ..Technique::default()
            };
            let settings = Settings {
                technique,
                ..scenes::settings(size, spp, 3 + direct as u64)
            };
            ready.shoot(&settings).estimate
        });
        let [mis, light, bsdf] = &shots;
        assert_same_picture(&format!("{name}-light"), mis, light, 6);
        assert_same_picture(&format!("{name}-bsdf"), mis, bsdf, 6);
        assert_same_picture(&format!("{name}-light-bsdf"), light, bsdf, 6);
    }
}
