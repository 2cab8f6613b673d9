//! A target of `upglow-fuzz` under libFuzzer.

pub use libfuzzer_sys;

/// A panic ends the program with a report, but for those in a decompressor that are caught.
pub fn set_hook() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !upglow_image::ExrReader::is_unpacking() {
            usual(info);
        }
    }));
}

/// The program of the target of this name.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(
            init: $crate::set_hook(),
            |bytes: &[u8]| upglow_fuzz::run($name, bytes)
        );
    };
}
