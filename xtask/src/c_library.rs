//! The C library: its header, its installation, and the programs that test both.

use std::path::{Path, PathBuf};

use crate::step::{Step, StepError, finish, nightly_cargo, target_dir};

mod agreement;
mod header;
mod install;
mod isolated;
mod programs;

pub(crate) use header::write as write_header;
pub(crate) use install::{LIB, install};

/// Where the library's sources are, below the workspace's root.
const FOLDER: &str = "bindings/c";

/// What `cargo xtask check` does about the library.
pub(crate) const STEPS: [Step; 7] = [
    Step { name: "c-header", about: "upglow.h is generated from the sources", run: header::check },
    Step { name: "c-library", about: "the C library builds and installs", run: installs },
    Step { name: "c-programs", about: "its examples and tests pass", run: programs::run },
    Step { name: "c-valgrind", about: "the same under valgrind", run: programs::run_valgrind },
    Step { name: "c-miri", about: "its tests in Rust, interpreted by Miri", run: interpreted },
    Step {
        name: "c-pkg-config",
        about: "its example builds with pkg-config",
        run: programs::run_pkg_config,
    },
    Step { name: "c-cmake", about: "its examples build with CMake", run: programs::run_cmake },
];

/// Where the checks install the library and build their programs.
fn scratch(root: &Path) -> Result<PathBuf, StepError> {
    Ok(target_dir(root)?.join("c-library"))
}

/// Runs what calls the library from Rust where undefined behavior is an error: the interpreter of a nightly compiler.
fn interpreted(root: &Path) -> Result<(), StepError> {
    if finish(nightly_cargo(root, "miri --version")).is_err() {
        return Err(StepError::Skipped("no nightly compiler with Miri"));
    }
    finish(nightly_cargo(root, "miri test --package upglow-c"))
}

fn installs(root: &Path) -> Result<(), StepError> {
    install(root, &scratch(root)?.join("prefix"), LIB).map(|_| ())
}
