#![no_main]
libfuzzer_sys::fuzz_target!(|input: &[u8]| tribo_tests::fuzz_inputs::joint_state::check(input));
