//! The C library: its header, its installation, and the programs that test both.

use std::path::{Path, PathBuf};

use crate::check::{Outcome, Step, StepError};

mod agreement;
mod header;
mod install;
mod programs;

pub(crate) use header::write as write_header;
pub(crate) use install::install;
pub(crate) use programs::missing;

/// Where the library's sources are, below the workspace's root.
const FOLDER: &str = "bindings/c";

/// What `cargo xtask check` does about the library.
pub(crate) const STEPS: [(&str, Step); 6] = [
    ("C header", header::check),
    ("C library", installs),
    ("C programs", programs::run),
    ("C programs under valgrind", programs::run_under_valgrind),
    ("C programs by pkg-config", programs::run_by_pkg_config),
    ("C programs by CMake", programs::run_by_cmake),
];

/// Where the checks install the library and build their programs.
fn scratch(root: &Path) -> Result<PathBuf, StepError> {
    Ok(crate::check::target_dir(root)?.join("c-library"))
}

fn installs(root: &Path) -> Result<Outcome, StepError> {
    prefix(root).map(|_| Outcome::Passed)
}

/// Installs the library for checks; below which folder.
pub(crate) fn prefix(root: &Path) -> Result<PathBuf, StepError> {
    let prefix = scratch(root)?.join("prefix");
    install(root, &prefix)?;
    Ok(prefix)
}
