//! The Python that tests run other people's readers with.

use std::path::{Path, PathBuf};
use std::process::Command;

/// An interpreter that can import these packages, if there is one.
pub(crate) fn python(packages: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates = [
        std::env::var_os("UPGLOW_PYTHON").map(PathBuf::from),
        Some(root.join("target/python/bin/python")),
        Some("python3".into()),
    ];
    let can_import = |python: &PathBuf| {
        let import = format!("import {packages}");
        Command::new(python).args(["-c", &import]).output().is_ok_and(|o| o.status.success())
    };
    candidates.into_iter().flatten().find(can_import)
}
