//! The Python that tests run other people's readers with, in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::step::{StepError, read};

/// Tests run this interpreter, and skip by name where it is absent.
pub(crate) const VARIABLE: &str = "UPGLOW_PYTHON";

/// The lists of packages that tests need, with pinned versions.
const REQUIREMENTS: [&str; 6] = [
    "xtask/requirements.txt",
    "bindings/python/requirements-test.txt",
    "crates/upglow-cli/tests/farm/requirements.txt",
    "crates/upglow-cli/tests/luts/requirements.txt",
    "crates/upglow-image/tests/readers/requirements.txt",
    "crates/upglow-shader/tests/drivers/requirements.txt",
];

/// The renderer that `upglow.mitsuba` works in; not every platform has it.
const MITSUBA_REQUIREMENTS: &str = "bindings/python/requirements-mitsuba.txt";

/// Makes `target/python` hold every package that tests need; the interpreter. What is there already
/// stays.
pub(crate) fn prepare(root: &Path) -> Result<PathBuf, StepError> {
    let folder = root.join("target").join("python");
    let interpreter = folder.join("bin").join("python");
    let installed = folder.join("installed.txt");
    let lists = REQUIREMENTS.map(|list| root.join(list));
    if interpreter.exists() && holds(&installed, &lists)? {
        return Ok(interpreter);
    }
    if !succeeds(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder)) {
        return Err(StepError::Skipped("no python3 with venv"));
    }
    install(&interpreter, &lists, &installed, "pip could not install what tests need")?;
    Ok(interpreter)
}

/// Makes `target/python` hold Mitsuba as well.
pub(crate) fn prepare_with_mitsuba(root: &Path) -> Result<PathBuf, StepError> {
    let interpreter = prepare(root)?;
    let lists = [root.join(MITSUBA_REQUIREMENTS)];
    let installed = root.join("target").join("python").join("installed-mitsuba.txt");
    if !holds(&installed, &lists)? {
        install(&interpreter, &lists, &installed, "pip could not install Mitsuba")?;
    }
    Ok(interpreter)
}

/// Whether these lists were installed, as they are now.
fn holds(installed: &Path, lists: &[PathBuf]) -> Result<bool, StepError> {
    let wanted = together(lists)?;
    Ok(fs::read_to_string(installed).is_ok_and(|found| found == wanted))
}

/// All lists, one after the other.
fn together(lists: &[PathBuf]) -> Result<String, StepError> {
    lists.iter().map(|list| read(list)).collect()
}

fn install(
    interpreter: &Path,
    lists: &[PathBuf],
    installed: &Path,
    failure: &'static str,
) -> Result<(), StepError> {
    let mut install = Command::new(interpreter);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    for list in lists {
        install.arg("--requirement").arg(list);
    }
    if !succeeds(&mut install) {
        return Err(StepError::Skipped(failure));
    }
    fs::write(installed, together(lists)?).map_err(StepError::file(installed))
}

fn succeeds(command: &mut Command) -> bool {
    let silent = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    silent.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_is_there_and_pins_its_packages() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let lists = REQUIREMENTS.into_iter().chain([MITSUBA_REQUIREMENTS]);
        let lists = together(&lists.map(|list| root.join(list)).collect::<Vec<_>>()).unwrap();
        let packages = lists.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        for package in packages {
            assert!(package.contains("=="), "{package}");
        }
    }
}
