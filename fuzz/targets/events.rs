//! libFuzzer on [`asperity_fuzz::events`].
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| asperity_fuzz::events::check(data));
