//! Pictures in every format. The check itself also runs in the package's tests, over the seeds and damage done to them.

#![no_main]

#[path = "../../tests/support/model_damage.rs"]
#[allow(dead_code)]
mod model_damage;

libfuzzer_sys::fuzz_target!(|data: &[u8]| model_damage::check_picture(data));
