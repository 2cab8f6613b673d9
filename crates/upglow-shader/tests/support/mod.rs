//! Programs that tests run.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The interpreter with these packages, if there is one.
pub(crate) fn python(packages: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates = [
        std::env::var_os("UPGLOW_PYTHON").map(PathBuf::from),
        std::env::var_os("UPGLOW_BLENDER_PYTHON").map(PathBuf::from),
        Some(root.join("target/python/bin/python")),
        Some("python3".into()),
    ];
    let can_import = |python: &PathBuf| {
        let mut command = Command::new(python);
        let import = format!("import {packages}");
        command.args(["-c", &import]).output().is_ok_and(|o| o.status.success())
    };
    candidates.into_iter().flatten().find(can_import)
}

/// Whether a program can be run.
pub(crate) fn runs(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}
