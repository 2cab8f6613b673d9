#![no_main]
upglow_libfuzzer::target!("coefficients");
