#![no_main]
upglow_libfuzzer::target!("radiance");
