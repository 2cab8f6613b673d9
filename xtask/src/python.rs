//! The Python that tests run other people's readers with, in a folder of its own.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Tests run this interpreter, and skip by name where there is none.
pub(crate) const VARIABLE: &str = "UPGLOW_PYTHON";

/// The lists of packages that tests need, with pinned versions.
const REQUIREMENTS: [&str; 3] = [
    "bindings/python/requirements-test.txt",
    "crates/upglow-image/tests/readers/requirements.txt",
    "crates/upglow-shader/tests/drivers/requirements.txt",
];

/// The list of what the plugins for Mitsuba need, on top of the others: not every platform has it.
const MITSUBA_REQUIREMENTS: &str = "bindings/mitsuba/requirements.txt";

/// Whether tests have their Python.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Python {
    /// The interpreter with every package.
    Ready(PathBuf),
    /// Why there is none.
    Missing(&'static str),
}

/// Makes `target/python` hold every package that tests need. What is there already stays.
pub(crate) fn prepare(root: &Path) -> io::Result<Python> {
    let folder = root.join("target").join("python");
    let interpreter = folder.join("bin").join("python");
    let wanted = requirements(root)?;
    let installed = folder.join("installed.txt");
    if interpreter.exists() && fs::read_to_string(&installed).is_ok_and(|found| found == wanted) {
        return Ok(Python::Ready(interpreter));
    }
    if !succeeds(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder)) {
        return Ok(Python::Missing("no python3 with venv"));
    }
    let lists = REQUIREMENTS.map(|list| root.join(list));
    if !succeeds(&mut install(&interpreter, &lists)) {
        return Ok(Python::Missing("pip could not install the readers"));
    }
    fs::write(installed, wanted)?;
    Ok(Python::Ready(interpreter))
}

/// Makes `target/python` hold Mitsuba as well.
pub(crate) fn prepare_with_mitsuba(root: &Path) -> io::Result<Python> {
    let interpreter = match prepare(root)? {
        Python::Ready(interpreter) => interpreter,
        missing => return Ok(missing),
    };
    let list = root.join(MITSUBA_REQUIREMENTS);
    let wanted = fs::read_to_string(&list)?;
    let installed = root.join("target").join("python").join("installed-mitsuba.txt");
    if fs::read_to_string(&installed).is_ok_and(|found| found == wanted) {
        return Ok(Python::Ready(interpreter));
    }
    if !succeeds(&mut install(&interpreter, &[list])) {
        return Ok(Python::Missing("pip could not install Mitsuba"));
    }
    fs::write(installed, wanted)?;
    Ok(Python::Ready(interpreter))
}

fn install(interpreter: &Path, lists: &[PathBuf]) -> Command {
    let mut install = Command::new(interpreter);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    for list in lists {
        install.arg("--requirement").arg(list);
    }
    install
}

/// All lists, one after the other.
fn requirements(root: &Path) -> io::Result<String> {
    REQUIREMENTS.iter().map(|list| fs::read_to_string(root.join(list))).collect()
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
        let mitsuba = fs::read_to_string(root.join(MITSUBA_REQUIREMENTS)).unwrap();
        let lists = requirements(root).unwrap() + &mitsuba;
        let packages = lists.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        for package in packages {
            assert!(package.contains("=="), "{package}");
        }
    }
}
