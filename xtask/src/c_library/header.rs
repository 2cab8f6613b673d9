//! `include/upglow.h`, generated from the Rust sources.

use std::fs;
use std::path::{Path, PathBuf};

use super::FOLDER;
use crate::step::{StepError, read};

fn path(root: &Path) -> PathBuf {
    root.join(FOLDER).join("include").join("upglow.h")
}

/// Writes the header, and prints whether it changed.
pub(crate) fn write(root: &Path) -> Result<(), StepError> {
    let (path, text) = (path(root), generate(root)?);
    let is_fresh = fs::read_to_string(&path).is_ok_and(|found| found == text);
    if !is_fresh {
        fs::write(&path, text).map_err(StepError::file(&path))?;
    }
    println!("header: {}", if is_fresh { "unchanged" } else { "changed" });
    Ok(())
}

/// The committed header is the one that the sources make.
pub(super) fn check(root: &Path) -> Result<(), StepError> {
    let path = path(root);
    if read(&path)? == generate(root)? {
        return Ok(());
    }
    Err(StepError::found(format!("{} is not what `cargo xtask header` writes", path.display())))
}

fn generate(root: &Path) -> Result<String, StepError> {
    let folder = root.join(FOLDER);
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml"));
    let config = config.map_err(StepError::found)?;
    let bindings = cbindgen::Builder::new().with_crate(&folder).with_config(config).generate();
    let bindings = bindings.map_err(|error| StepError::found(error.to_string()))?;
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
