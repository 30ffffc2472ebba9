//! Intersection against brute force in f64. The check itself also runs in the package's tests, over fixed bytes.

#![no_main]

#[path = "../../tests/support/intersection.rs"]
mod intersection;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    intersection::check(data);
});
