#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rockproof_fuzz::message(bytes));
