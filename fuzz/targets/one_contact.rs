//! libFuzzer on [`asperity_fuzz::one_contact`].
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| asperity_fuzz::one_contact::check(data));
