//! The crates as they would be published: what `cargo package` puts into each.

use std::path::Path;

use crate::step::{Step, StepError, cargo, finish, metadata, output_of};

/// What `cargo xtask check` does about the packages.
pub(crate) const STEPS: [Step; 1] = [Step {
    name: "packages",
    about: "cargo package takes every crate, with the texts of its licenses",
    run: check,
}];

/// The texts that each crate comes with.
const LICENSES: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

/// The text that a crate with measured tables comes with, because its license field names more.
const TABLES_LICENSE: &str = "LICENSE-TABLES.md";

fn check(root: &Path) -> Result<(), StepError> {
    // A package names versions of all platforms' crates; a build fetches only its own.
    finish(cargo(root, "fetch --locked"))?;
    finish(cargo(root, "package --workspace --no-verify --offline --allow-dirty --quiet"))?;
    let metadata = metadata(root)?;
    let packages = metadata["packages"].as_array().map_or(&[][..], Vec::as_slice);
    let mut problems = Vec::new();
    for package in packages.iter().filter(|package| package["publish"].is_null()) {
        let name = package["name"].as_str().unwrap_or_default();
        let list =
            cargo(root, &format!("package --list --offline --allow-dirty --quiet -p {name}"));
        let license = package["license"].as_str().unwrap_or_default();
        problems.extend(missing(name, license, &output_of(list)?));
    }
    StepError::none_of(problems)
}

/// The texts that the package of a crate lacks, one line each.
fn missing(name: &str, license: &str, files: &str) -> Vec<String> {
    let tables = license.contains("CC-BY-SA").then_some(TABLES_LICENSE);
    let wanted = LICENSES.into_iter().chain(tables);
    let lacking = wanted.filter(|text| !files.lines().any(|file| file == *text));
    lacking.map(|text| format!("{name}: no {text} in its package, expected a link to it")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_of_a_license_is_asked_for() {
        let both = "Cargo.toml\nLICENSE-APACHE\nLICENSE-MIT\nsrc/lib.rs\n";
        assert_eq!(missing("a", "MIT OR Apache-2.0", both), [""; 0]);
        let tables = missing("a", "(MIT OR Apache-2.0) AND CC-BY-SA-4.0", both);
        assert_eq!(tables, ["a: no LICENSE-TABLES.md in its package, expected a link to it"]);
        assert_eq!(missing("a", "MIT OR Apache-2.0", "src/LICENSE-MIT\n").len(), 2);
    }
}
