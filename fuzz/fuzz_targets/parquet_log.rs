#![no_main]
use libfuzzer_sys::fuzz_target;

// The library catches panics of the decoder and makes errors of them: only a panic that gets out counts.
fuzz_target!(init: std::panic::set_hook(Box::new(|_| ())), |input: &[u8]| tribo_tests::fuzz_inputs::parquet_log(input));
