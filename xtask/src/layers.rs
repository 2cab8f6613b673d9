//! Which crate of this workspace may use which: the arrows go one way.

use std::path::Path;

use serde_json::Value;

use crate::step::{StepError, metadata};

/// Each crate of the workspace, and the crates of the workspace that it may depend on.
///
/// Development dependencies count as well: a test that needs an upper layer belongs there.
const ALLOWED: [(&str, &[&str]); 14] = [
    ("upglow-color", &[]),
    ("upglow", &["upglow-color"]),
    ("upglow-shader", &["upglow", "upglow-color"]),
    ("upglow-fit", &["upglow", "upglow-color"]),
    ("upglow-image", &["upglow-fit", "upglow", "upglow-color"]),
    ("upglow-explorer", &["upglow-image", "upglow-shader", "upglow-fit", "upglow", "upglow-color"]),
    ("upglow-svg", &[]),
    ("upglow-terminal", &["upglow-fit", "upglow", "upglow-color"]),
    ("upglow-study", &["upglow-terminal", "upglow-svg", "upglow-fit", "upglow", "upglow-color"]),
    (
        "upglow-cli",
        &[
            "upglow-explorer",
            "upglow-terminal",
            "upglow-svg",
            "upglow-image",
            "upglow-fit",
            "upglow-shader",
            "upglow",
            "upglow-color",
        ],
    ),
    ("upglow-python", &["upglow-study", "upglow-fit", "upglow", "upglow-color"]),
    ("upglow-c", &["upglow", "upglow-color"]),
    (
        "upglow-fuzz",
        &["upglow-explorer", "upglow-image", "upglow-shader", "upglow", "upglow-color"],
    ),
    ("xtask", &[]),
];

pub(crate) fn check(root: &Path) -> Result<(), StepError> {
    StepError::none_of(violations(&metadata(root)?))
}

/// What in the output of `cargo metadata --no-deps` breaks the layers, one line each.
fn violations(metadata: &Value) -> Vec<String> {
    let packages = array(&metadata["packages"]);
    let ours: Vec<&str> = packages.iter().filter_map(|p| p["name"].as_str()).collect();
    if ours.is_empty() {
        return vec!["cargo metadata lists no package, expected the workspace's crates".to_owned()];
    }
    packages.iter().flat_map(|package| package_violations(package, &ours)).collect()
}

fn package_violations(package: &Value, ours: &[&str]) -> Vec<String> {
    let name = package["name"].as_str().unwrap_or_default();
    let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
        return vec![format!("{name} has no layer: name it in xtask/src/layers.rs")];
    };
    array(&package["dependencies"])
        .iter()
        .filter_map(|dependency| dependency["name"].as_str())
        .filter(|dependency| ours.contains(dependency) && !allowed.contains(dependency))
        .map(|dependency| format!("{name} depends on {dependency}, which its layer must not use"))
        .collect()
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn workspace(edges: &[(&str, &[&str])]) -> Value {
        let package = |(name, uses): &(&str, &[&str])| {
            let dependencies: Vec<Value> = uses.iter().map(|u| json!({ "name": u })).collect();
            json!({ "name": name, "dependencies": dependencies })
        };
        json!({ "packages": edges.iter().map(package).collect::<Vec<_>>() })
    }

    #[test]
    fn downward_and_foreign_dependencies_are_allowed() {
        let metadata =
            workspace(&[("upglow-color", &["thiserror"]), ("upglow", &["upglow-color", "serde"])]);
        assert!(violations(&metadata).is_empty());
    }

    #[test]
    fn an_upward_dependency_is_named() {
        let metadata = workspace(&[("upglow-color", &["upglow"]), ("upglow", &[])]);
        assert_eq!(
            violations(&metadata),
            ["upglow-color depends on upglow, which its layer must not use"]
        );
    }

    #[test]
    fn a_crate_without_a_layer_is_named() {
        let metadata = workspace(&[("upglow-extra", &[])]);
        assert!(violations(&metadata)[0].contains("upglow-extra has no layer"));
    }

    #[test]
    fn empty_metadata_is_a_violation() {
        assert_eq!(violations(&json!({})).len(), 1);
    }
}
