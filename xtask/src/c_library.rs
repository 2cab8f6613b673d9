//! The C library: its header, its installation, and the programs that test both.

use std::path::{Path, PathBuf};

use crate::step::{Step, StepError, target_dir};

mod agreement;
mod header;
mod install;
mod isolated;
mod programs;

pub(crate) use header::write as write_header;
pub(crate) use install::install;

/// Where the library's sources are, below the workspace's root.
const FOLDER: &str = "bindings/c";

/// What `cargo xtask check` does about the library.
pub(crate) const STEPS: [Step; 6] = [
    Step { name: "c-header", about: "upglow.h is generated from the sources", run: header::check },
    Step { name: "c-library", about: "the C library builds and installs", run: installs },
    Step { name: "c-programs", about: "its examples and tests pass", run: programs::run },
    Step { name: "c-valgrind", about: "the same under valgrind", run: programs::run_valgrind },
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

fn installs(root: &Path) -> Result<(), StepError> {
    install(root, &scratch(root)?.join("prefix")).map(|_| ())
}
