#![no_main]
upglow_libfuzzer::target!("csv");
