//! The plugins for Mitsuba 3: built by `CMake` against its Python wheel, and tested inside it.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{Step, StepError, finish, output_of, release_bin_dir, target_dir};
use crate::{c_library, llvm, python, python_wheel};

/// Where their sources are, below the workspace's root.
const FOLDER: &str = "bindings/mitsuba";

/// Tests load the plugins from the folder of this name, and skip by name where it is absent.
const PLUGINS_VARIABLE: &str = "UPGLOW_MITSUBA_PLUGINS";

/// What `cargo xtask check` does about them, after the Python package is installed.
pub(crate) const STEPS: [Step; 3] = [
    Step { name: "mitsuba-plugins", about: "the plugins for Mitsuba 3 build", run: build },
    Step { name: "mitsuba-scalar", about: "the plugins' tests, scalar variants", run: test_scalar },
    Step { name: "mitsuba-traced", about: "the plugins' tests, LLVM variants", run: test_traced },
];

/// The same on their own.
pub(crate) const STEPS_WITH_PACKAGE: [Step; 4] = [
    Step {
        name: "python-install",
        about: "the Python package is installed",
        run: |root| python_wheel::installed(root).map(|_| ()),
    },
    STEPS[0],
    STEPS[1],
    STEPS[2],
];

/// Where `CMake` builds them.
fn build_folder(root: &Path) -> Result<PathBuf, StepError> {
    Ok(target_dir(root)?.join("mitsuba"))
}

fn build(root: &Path) -> Result<(), StepError> {
    c_library::need(&["cmake"])?;
    let interpreter = python::prepare_with_mitsuba(root)?;
    let (prefix, build) = (c_library::prefix(root)?, build_folder(root)?);
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(root.join(FOLDER)).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    configure.arg(format!("-DPython3_EXECUTABLE={}", interpreter.display()));
    configure.arg("-DCMAKE_CXX_FLAGS=-Werror");
    finish(configure)?;
    let mut compile = Command::new("cmake");
    compile.arg("--build").arg(&build).args(["--parallel", "2"]);
    finish(compile)
}

fn test_scalar(root: &Path) -> Result<(), StepError> {
    test(root, "not traced")
}

fn test_traced(root: &Path) -> Result<(), StepError> {
    llvm::library().ok_or(StepError::Skipped("no libLLVM 16 or later"))?;
    test(root, "traced")
}

/// Runs the tests that have a mark, or those that do not, and prints pytest's summary.
fn test(root: &Path, marked: &str) -> Result<(), StepError> {
    c_library::need(&["cmake"])?;
    let interpreter = python::prepare_with_mitsuba(root)?;
    let mut tests = python_wheel::pytest(&root.join(FOLDER), &interpreter, &release_bin_dir(root)?);
    tests.args(["-m", marked, "tests"]).env(PLUGINS_VARIABLE, build_folder(root)?);
    println!("{}", python_wheel::summary(&output_of(tests)?));
    Ok(())
}
