//! The plugins for Mitsuba 3: built by `CMake` against its Python wheel, and tested inside it.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::check::{Outcome, Step, StepError, output_of, release_bin_dir, target_dir};
use crate::python::{self, Python};
use crate::{c_library, llvm, python_wheel};

/// Where their sources are, below the workspace's root.
const FOLDER: &str = "bindings/mitsuba";

/// Tests load the plugins from the folder of this name, and skip by name where there is none.
const PLUGINS_VARIABLE: &str = "UPGLOW_MITSUBA_PLUGINS";

/// What `cargo xtask check` does about them, after the Python package is installed.
pub(crate) const STEPS: [(&str, Step); 3] = [
    ("Mitsuba plugins", builds),
    ("Mitsuba, scalar", run_scalar),
    ("Mitsuba, traced by LLVM", run_traced),
];

/// The same on their own.
pub(crate) const STEPS_WITH_PACKAGE: [(&str, Step); 4] =
    [("Python package for Mitsuba", python_wheel::installs), STEPS[0], STEPS[1], STEPS[2]];

/// The tools to build with, or what is missing.
fn prepared(root: &Path) -> Result<Python, StepError> {
    if let Some(reason) = c_library::missing(&["cmake"]) {
        return Ok(Python::Missing(reason));
    }
    let path = root.join("target/python");
    python::prepare_with_mitsuba(root).map_err(|source| StepError::File { path, source })
}

/// Where `CMake` builds them.
fn build_folder(root: &Path) -> Result<PathBuf, StepError> {
    Ok(target_dir(root)?.join("mitsuba"))
}

fn builds(root: &Path) -> Result<Outcome, StepError> {
    let interpreter = match prepared(root)? {
        Python::Ready(interpreter) => interpreter,
        Python::Missing(reason) => return Ok(Outcome::Skipped(reason)),
    };
    let (prefix, build) = (c_library::prefix(root)?, build_folder(root)?);
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(root.join(FOLDER)).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    configure.arg(format!("-DPython3_EXECUTABLE={}", interpreter.display()));
    configure.arg("-DCMAKE_CXX_FLAGS=-Werror");
    output_of(configure)?;
    let mut compile = Command::new("cmake");
    compile.arg("--build").arg(&build).args(["--parallel", "2"]);
    output_of(compile)?;
    Ok(Outcome::Passed)
}

fn run_scalar(root: &Path) -> Result<Outcome, StepError> {
    test(root, "not traced")
}

fn run_traced(root: &Path) -> Result<Outcome, StepError> {
    match llvm::library() {
        Some(_) => test(root, "traced"),
        None => Ok(Outcome::Skipped("no libLLVM 16 or later")),
    }
}

/// Runs the tests that carry a mark, or do not, and prints what pytest says of them.
fn test(root: &Path, marked: &str) -> Result<Outcome, StepError> {
    let interpreter = match prepared(root)? {
        Python::Ready(interpreter) => interpreter,
        Python::Missing(reason) => return Ok(Outcome::Skipped(reason)),
    };
    let mut tests = python_wheel::pytest(&root.join(FOLDER), &interpreter, &release_bin_dir(root)?);
    tests.args(["-m", marked, "tests"]).env(PLUGINS_VARIABLE, build_folder(root)?);
    println!("{}", python_wheel::summary(&output_of(tests)?));
    Ok(Outcome::Passed)
}
