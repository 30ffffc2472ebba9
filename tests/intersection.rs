//! The body of the fuzz target `intersect`, over a fixed sequence of pseudo-random bytes.

#[path = "support/intersection.rs"]
mod intersection;

use pts::math::stats::Pcg;

#[test]
fn random_scenes_are_hit_where_brute_force_hits_them() {
    let mut rng = Pcg::new(1);
    let mut sums = [0, 0];
    for _ in 0..10_000 {
        let length = 40 + rng.next_u32() as usize % 400;
        let bytes: Vec<u8> = (0..length).map(|_| (rng.next_u32() >> 24) as u8).collect();
        let counts = intersection::check(&bytes);
        sums = [sums[0] + counts[0], sums[1] + counts[1]];
    }
    assert!(
        sums[0] > 20_000 && sums[1] > 15_000,
        "hits and sure crossings: {sums:?}"
    );
    // What a fuzzer tries first.
    for length in 0..64 {
        intersection::check(&vec![0; length]);
        intersection::check(&vec![255; length]);
        intersection::check(&(0..length as u8).collect::<Vec<u8>>());
    }
}
