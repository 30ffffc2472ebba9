//! The body of the fuzz target `intersect`, over a fixed sequence of pseudo-random bytes.

#[path = "support/intersection.rs"]
mod intersection;

use pts::math::stats::Pcg;

#[test]
fn random_scenes_are_hit_where_brute_force_hits_them() {
    let mut rng = Pcg::new(1);
    for _ in 0..3000 {
        let length = 40 + rng.next_u32() as usize % 400;
        let bytes: Vec<u8> = (0..length).map(|_| (rng.next_u32() >> 24) as u8).collect();
        intersection::check(&bytes);
    }
    // What a fuzzer tries first.
    for length in 0..64 {
        intersection::check(&vec![0; length]);
        intersection::check(&vec![255; length]);
        intersection::check(&(0..length as u8).collect::<Vec<u8>>());
    }
}
