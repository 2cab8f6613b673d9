//! `include/upglow.h`, generated from the Rust sources.

use std::fs;
use std::path::{Path, PathBuf};

use super::FOLDER;
use crate::check::{Outcome, StepError};

fn path(root: &Path) -> PathBuf {
    root.join(FOLDER).join("include").join("upglow.h")
}

/// Writes the header; whether it changed.
pub(crate) fn write(root: &Path) -> Result<bool, StepError> {
    let (path, text) = (path(root), generate(root)?);
    if fs::read_to_string(&path).is_ok_and(|found| found == text) {
        return Ok(false);
    }
    fs::write(&path, text).map_err(|source| StepError::File { path, source })?;
    Ok(true)
}

/// The committed header is the one that the sources make.
pub(super) fn check(root: &Path) -> Result<Outcome, StepError> {
    let (path, text) = (path(root), generate(root)?);
    match fs::read_to_string(&path) {
        Ok(found) if found == text => Ok(Outcome::Passed),
        Ok(_) => {
            let problem = format!("{} is not what `cargo xtask header` writes", path.display());
            Err(StepError::Found(vec![problem]))
        }
        Err(source) => Err(StepError::File { path, source }),
    }
}

fn generate(root: &Path) -> Result<String, StepError> {
    let folder = root.join(FOLDER);
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml"));
    let config = config.map_err(|error| StepError::Found(vec![error]))?;
    let bindings = cbindgen::Builder::new().with_crate(&folder).with_config(config).generate();
    let bindings = bindings.map_err(|error| StepError::Found(vec![error.to_string()]))?;
    let mut bytes = Vec::new();
    bindings.write(&mut bytes);
    Ok(for_c(&String::from_utf8_lossy(&bytes)))
}

/// Without what only readers of Rust need: the heading over what pointers must be, and the empty
/// lines that instructions to cbindgen leave.
fn for_c(text: &str) -> String {
    text.replace("//\n//\n", "//\n").replace("// # Safety\n//\n", "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_of_rust_are_left_out() {
        let text = "// One.\n//\n//\n// # Safety\n//\n// Two.\nint f(void);\n";
        assert_eq!(for_c(text), "// One.\n//\n// Two.\nint f(void);\n");
    }
}
