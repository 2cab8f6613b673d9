//! Which library this is.

use std::ffi::{CStr, c_char};

/// First number of the version that this header describes. While it is 0, a change of the second
/// may change any function.
pub const UPGLOW_VERSION_MAJOR: u32 = 0;
/// Second number of the version that this header describes.
pub const UPGLOW_VERSION_MINOR: u32 = 1;
/// Third number of the version that this header describes.
pub const UPGLOW_VERSION_PATCH: u32 = 0;

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => panic!("a version has no zero byte"),
    };

/// The version of the library that is linked, as in "0.1.0". It lives as long as the program.
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
