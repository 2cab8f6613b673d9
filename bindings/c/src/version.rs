//! The version of the library.

use std::ffi::{CStr, c_char};

/// First number of the version that this header describes. While it is 0, any function may change
/// with the second.
pub const UPGLOW_VERSION_MAJOR: u32 = 0;
/// Second number of the version that this header describes.
pub const UPGLOW_VERSION_MINOR: u32 = 2;
/// Third number of the version that this header describes.
pub const UPGLOW_VERSION_PATCH: u32 = 0;

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => panic!("a version has no zero byte"),
    };

/// The version of the library that is linked, such as "0.2.0". The text is valid until the program
/// ends.
#[unsafe(no_mangle)]
pub extern "C" fn upglow_version() -> *const c_char {
    VERSION.as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_says_the_version_of_the_package() {
        let numbers = [UPGLOW_VERSION_MAJOR, UPGLOW_VERSION_MINOR, UPGLOW_VERSION_PATCH];
        let [major, minor, patch] = numbers;
        assert_eq!(VERSION.to_str().unwrap(), format!("{major}.{minor}.{patch}"));
    }
}
