//! The explorer's page in a browser: Node's test runner drives Chromium.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::step::{Step, StepError, finish, finish_aloud, read, release_bin_dir};

/// The tests and the list of packages that they need.
const TESTS: &str = "crates/upglow-explorer/tests/browser";

/// Names a Chromium elsewhere.
const BROWSER_VARIABLE: &str = "CHROMIUM";

/// Where Debian's package puts it.
const BROWSER: &str = "/usr/bin/chromium";

/// What `cargo xtask check` does about the page.
pub(crate) const STEPS: [Step; 1] =
    [Step { name: "explorer", about: "the explorer's page works in Chromium", run: check }];

/// Runs a copy of the tests in `target/explorer`, beside the packages installed there; the screenshots
/// that they make stay in its folder `pictures`.
fn check(root: &Path) -> Result<(), StepError> {
    let browser = std::env::var_os(BROWSER_VARIABLE).map_or(PathBuf::from(BROWSER), PathBuf::from);
    if !browser.exists() {
        return Err(StepError::Skipped("no Chromium"));
    }
    let folder = root.join("target").join("explorer");
    let tests = copy_tests(&root.join(TESTS), &folder)?;
    install(&folder)?;
    let program = format!("upglow{}", std::env::consts::EXE_SUFFIX);
    let mut run = Command::new("node");
    run.args(["--test", "--test-reporter=spec", "--test-concurrency=1"]).args(tests);
    run.env("UPGLOW", release_bin_dir(root)?.join(program));
    run.env("UPGLOW_PICTURES", folder.join("pictures")).env(BROWSER_VARIABLE, browser);
    run.current_dir(&folder).stdin(Stdio::null());
    finish_aloud(run)
}

/// Copies every file of the tests; returns the names of those that Node runs.
fn copy_tests(from: &Path, to: &Path) -> Result<Vec<String>, StepError> {
    fs::create_dir_all(to).map_err(StepError::file(to))?;
    let mut tests = Vec::new();
    for entry in fs::read_dir(from).map_err(StepError::file(from))? {
        let path = entry.map_err(StepError::file(from))?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let copy = to.join(name);
        fs::copy(&path, &copy).map_err(StepError::file(&copy))?;
        if name.ends_with(".test.mjs") {
            tests.push(name.to_owned());
        }
    }
    tests.sort_unstable();
    Ok(tests)
}

/// Installs the packages of the lock file, unless they are those that were installed last.
fn install(folder: &Path) -> Result<(), StepError> {
    let wanted = read(&folder.join("package-lock.json"))?;
    let installed = folder.join("installed.json");
    if read(&installed).is_ok_and(|found| found == wanted) {
        return Ok(());
    }
    let mut npm = Command::new("npm");
    npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(folder);
    npm.stdin(Stdio::null());
    match finish(npm) {
        Ok(()) => fs::write(&installed, wanted).map_err(StepError::file(&installed)),
        Err(StepError::Start { .. }) => Err(StepError::Skipped("no npm")),
        Err(_) => Err(StepError::Skipped("npm could not install what the explorer's tests need")),
    }
}
