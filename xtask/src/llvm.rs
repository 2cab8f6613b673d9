//! The libLLVM that Mitsuba's traced variants compile with.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where Dr.Jit, which compiles for Mitsuba, looks for the library first.
const VARIABLE: &str = "DRJIT_LIBLLVM_PATH";

/// Of older ones, 15 ends the process at the smaller of two numbers.
const OLDEST: u32 = 16;

/// The version that the tests were written with. The nearest one is taken: a much newer release may
/// lack functions that Dr.Jit calls.
const TESTED: u32 = 19;

/// Where systems keep their libraries.
const FOLDERS: [&str; 7] = [
    "/usr/lib/x86_64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
    "/usr/lib64",
    "/usr/lib",
    "/usr/local/lib",
    "/opt/homebrew/opt/llvm/lib",
    "/usr/local/opt/llvm/lib",
];

/// The library: the one that the user named, or the best there is.
fn library() -> Option<PathBuf> {
    if let Some(named) = env::var_os(VARIABLE) {
        return Some(named.into());
    }
    let entries = FOLDERS.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten();
    best(entries.filter_map(Result::ok).map(|entry| entry.path()))
}

/// Names the library for a command, where there is one.
pub(crate) fn name_for(command: &mut Command) {
    if let Some(library) = library() {
        command.env(VARIABLE, library);
    }
}

fn best(paths: impl Iterator<Item = PathBuf>) -> Option<PathBuf> {
    let versions = paths.filter_map(|path| Some((version(&path)?, path)));
    let usable = versions.filter(|(version, _)| *version >= OLDEST);
    // The path decides between names of one library, so that every run takes the same.
    usable
        .min_by_key(|(version, path)| (version.abs_diff(TESTED), path.clone()))
        .map(|(_, path)| path)
}

/// The first number of its version, from names such as `libLLVM.so.19.1` and `libLLVM-16.so`.
fn version(path: &Path) -> Option<u32> {
    let rest = path.file_name()?.to_str()?.strip_prefix("libLLVM")?;
    let rest = rest.strip_prefix(".so.").or_else(|| rest.strip_prefix('-'))?;
    let digits = rest.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(rest.len());
    rest[..digits].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best_of(names: &[&str]) -> Option<PathBuf> {
        best(names.iter().map(PathBuf::from))
    }

    #[test]
    fn the_version_that_was_tested_is_taken_or_the_nearest() {
        let names = ["/a/libLLVM-16.so", "/a/libLLVM.so.19.1", "/a/libLLVM.so.20.1"];
        assert_eq!(best_of(&names), Some("/a/libLLVM.so.19.1".into()));
        assert_eq!(
            best_of(&["/a/libLLVM-16.so.1", "/a/libLLVM-17.so"]),
            Some("/a/libLLVM-17.so".into())
        );
    }

    #[test]
    fn versions_that_end_the_process_are_never_taken() {
        assert_eq!(best_of(&["/a/libLLVM-15.so", "/a/libLLVM-14.0.6.so.1"]), None);
    }

    #[test]
    fn other_files_are_no_libllvm() {
        assert_eq!(
            best_of(&["/a/libLLVM.so", "/a/libLLVMSupport.so.19", "/a/libLTO.so.19.1"]),
            None
        );
    }
}
