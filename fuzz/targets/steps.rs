//! libFuzzer on [`asperity_fuzz::steps`].
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| asperity_fuzz::steps::check(data));
