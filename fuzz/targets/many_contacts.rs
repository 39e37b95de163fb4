//! libFuzzer on [`asperity_fuzz::many_contacts`].
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| asperity_fuzz::many_contacts::check(data));
