//! The Python package `upglow`: its wheel is built as users build it, installed, and tested.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::llvm;
use crate::python;
use crate::step::{Step, StepError, cargo, finish, output_of, release_bin_dir};

/// Where the package lies.
const PACKAGE: &str = "bindings/python";

/// Tests compare the package with this program, and skip by name where it is absent.
const PROGRAM_VARIABLE: &str = "UPGLOW_PROGRAM";

/// What `cargo xtask check` does about the package.
pub(crate) const STEPS: [Step; 1] = [Step {
    name: "python-package",
    about: "the wheel builds, installs, and passes its tests",
    run: check,
}];

/// Runs the tests against a program built like the wheel, and prints what pytest says of them: why
/// some were skipped, and how many passed.
fn check(root: &Path) -> Result<(), StepError> {
    let interpreter = installed(root)?;
    let tests = pytest(&root.join(PACKAGE), &interpreter, &release_bin_dir(root)?);
    println!("{}", summary(&output_of(tests)?));
    Ok(())
}

/// Builds the wheel into the environment of tests, which has all that `requirements-test.txt` lists.
/// Returns the environment's interpreter.
pub(crate) fn installed(root: &Path) -> Result<PathBuf, StepError> {
    let interpreter = python::prepare(root)?;
    match python::prepare_with_mitsuba(root) {
        // Tests of Mitsuba skip themselves, by name, where it could not be installed.
        Ok(_) | Err(StepError::Skipped(_)) => {}
        Err(error) => return Err(error),
    }
    // maturin asks for the metadata of every platform, and with it for crates that no build fetched.
    finish(cargo(root, "fetch --locked"))?;
    finish(install(root, &interpreter))?;
    Ok(interpreter)
}

/// pytest in a folder, with the program `upglow` and a libLLVM for the tests that want them.
pub(crate) fn pytest(folder: &Path, interpreter: &Path, programs: &Path) -> Command {
    let mut tests = python_in(folder, interpreter);
    tests.args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider"]);
    let program = format!("upglow{}", std::env::consts::EXE_SUFFIX);
    tests.env(PROGRAM_VARIABLE, programs.join(program));
    llvm::name_for(&mut tests);
    tests
}

/// What users type, but offline and with the build tools that are there.
fn install(root: &Path, interpreter: &Path) -> Command {
    let mut command = python_in(&root.join(PACKAGE), interpreter);
    command.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-index"]);
    command.args(["--no-deps", "--no-build-isolation", "--force-reinstall"]);
    command.arg(root.join(PACKAGE)).env("CARGO_NET_OFFLINE", "true");
    command
}

/// Python in a folder, with the commands of its environment. It leaves no files there.
fn python_in(folder: &Path, interpreter: &Path) -> Command {
    let mut paths: Vec<_> = interpreter.parent().map(Path::to_owned).into_iter().collect();
    let inherited = std::env::var_os("PATH").unwrap_or_default();
    paths.extend(std::env::split_paths(&inherited));
    let path = std::env::join_paths(paths).unwrap_or(inherited);
    let mut command = Command::new(interpreter);
    command.current_dir(folder).stdin(Stdio::null());
    command.env("PATH", path).env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// pytest's last lines: those about skipped tests, where there are any, and the counts.
pub(crate) fn summary(printed: &str) -> &str {
    let printed = printed.trim_end();
    let start = printed.find("== short test summary").or_else(|| printed.rfind('\n'));
    let start = start.and_then(|at| printed[at..].find('\n').map(|end| at + end + 1));
    &printed[start.unwrap_or_default()..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_of_pytest_are_printed() {
        assert_eq!(summary("..  [100%]\n2 passed in 0.1s\n"), "2 passed in 0.1s");
        let skips = "SKIPPED [1] tests/test_x.py:4: no program\n1 passed, 1 skipped in 0.1s";
        let printed = format!(".s  [100%]\n=== short test summary info ===\n{skips}\n");
        assert_eq!(summary(&printed), skips);
        assert_eq!(summary(""), "");
    }

    #[test]
    fn an_interpreter_that_is_not_there_is_named() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let error = output_of(install(root, Path::new("/no/such/python"))).unwrap_err();
        assert!(error.to_string().starts_with("$ python -m pip install"), "{error}");
    }

    #[test]
    fn the_commands_of_the_environment_come_first() {
        let command = python_in(Path::new("."), Path::new("/environment/bin/python"));
        let path = command.get_envs().find(|(name, _)| *name == "PATH").unwrap().1.unwrap();
        assert!(path.to_string_lossy().starts_with("/environment/bin"), "{path:?}");
    }
}
