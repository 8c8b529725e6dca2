#![no_main]

libfuzzer_sys::fuzz_target!(|random: fuzz::trains::Random| random.check());
