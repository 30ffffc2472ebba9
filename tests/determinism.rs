//! The same scene, seed and sample count give the same bits: whatever the threads, whatever the passes.

mod support;

use pts::render::settings::Settings;
use support::scenes;

const SCENES: &[&str] = &[
    "scenes/cornell.pts",
    "tests/hard/direct/lamps.pts",
    "tests/hard/direct/sky.pts",
    "scenes/glass.pts",
    "scenes/gltf.pts",
    "scenes/obj.pts",
];

fn bits_with(threads: usize, ready: &scenes::Ready, settings: &Settings) -> Vec<[u32; 3]> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool");
    pool.install(|| scenes::bits(&ready.shoot(settings).picture))
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for scene in SCENES {
        let ready = scenes::ready(scene, &[], [40, 30]);
        let settings = Settings::new(40, 30, 20);
        let one = bits_with(1, &ready, &settings);
        for threads in [2, 3] {
            assert!(
                one == bits_with(threads, &ready, &settings),
                "{scene} differs with {threads} threads"
            );
        }
    }
}

/// An error goal that cannot be met only adds looks: passes end elsewhere, the samples are the same.
#[test]
fn the_passes_do_not_matter() {
    let ready = scenes::ready(SCENES[0], &[], [40, 30]);
    for spp in [100, 130] {
        let plain = Settings::new(40, 30, spp);
        let mut looking = plain.clone();
        looking.stop.error = Some(1e-9);
        assert!(
            bits_with(2, &ready, &plain) == bits_with(2, &ready, &looking),
            "{spp} samples"
        );
    }
}

#[test]
fn another_seed_gives_another_picture() {
    let ready = scenes::ready(SCENES[0], &[], [40, 30]);
    let settings = Settings::new(40, 30, 16);
    let other = Settings {
        seed: 1,
        ..settings.clone()
    };
    assert!(bits_with(2, &ready, &settings) != bits_with(2, &ready, &other));
}
