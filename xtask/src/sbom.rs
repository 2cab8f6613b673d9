//! The bill of materials: every package of `Cargo.lock`, as a document of the kind `CycloneDX`; and the licenses of
//! those that are shipped.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::step::{StepError, cargo, json_of, read};

/// The packages that are built and shipped; others are needed by tests, benches and `xtask`.
const SHIPPED: [&str; 4] = ["upglow-cli", "upglow-study", "upglow-c", "upglow-python"];

/// A package of `Cargo.lock`.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Package {
    name: String,
    version: String,
    /// SHA-256 of the package's file.
    checksum: Option<String>,
    /// Names, with versions where the name alone is not unique.
    dependencies: Vec<String>,
}

impl Package {
    /// The package's address, by which other documents name it.
    fn purl(&self) -> String {
        format!("pkg:cargo/{}@{}", self.name, self.version)
    }

    /// Whether a line of `dependencies` means this package.
    fn is(&self, dependency: &str) -> bool {
        let mut words = dependency.split(' ');
        words.next() == Some(&self.name) && words.next().is_none_or(|word| word == self.version)
    }
}

fn metadata(root: &Path) -> Result<Value, StepError> {
    json_of(cargo(root, "metadata --format-version 1 --locked --all-features"))
}

/// What the names of files with terms begin with.
const TERMS: [&str; 6] = ["LICENSE", "LICENC", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];

/// Writes the terms of all packages of others that are shipped, each text once; how many packages there are.
pub(crate) fn write_notices(root: &Path, file: &Path) -> Result<usize, StepError> {
    let metadata = metadata(root)?;
    let shipped = shipped(&metadata);
    let mut list = String::new();
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut count = 0;
    for package in array(&metadata["packages"]) {
        let (name, version) = (text(&package["name"]), text(&package["version"]));
        let is_ours = package["source"].is_null();
        if is_ours || !shipped.contains(&(name.clone(), version.clone())) {
            continue;
        }
        count += 1;
        let title = format!("{name} {version}");
        let manifest = text(&package["manifest_path"]);
        let terms = terms(Path::new(&manifest).parent().unwrap_or(root))?;
        let [license, place] = ["license", "repository"].map(|field| text(&package[field]));
        let lack = if terms.is_empty() { "; without a text in its package" } else { "" };
        list += &format!("- {title}: {}; {place}{lack}\n", license.replace('/', " OR "));
        terms.into_iter().for_each(|terms| texts.entry(terms).or_default().push(title.clone()));
    }
    let mut document = format!(
        "# Terms of packages by others\n\nThe programs and libraries of upglow contain these packages, on some platform or \
         with some feature:\n\n{list}"
    );
    for (terms, titles) in &texts {
        document += &format!("\n## {}\n\n```text\n{terms}\n```\n", titles.join(", "));
    }
    fs::write(file, document).map_err(StepError::file(file))?;
    Ok(count)
}

/// The texts of the files with terms in a package's folder.
fn terms(folder: &Path) -> Result<Vec<String>, StepError> {
    let entries = fs::read_dir(folder).map_err(StepError::file(folder))?.flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        path.is_file() && TERMS.iter().any(|start| name.starts_with(start))
    });
    paths.sort();
    let lines = |text: String| text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
    paths.iter().map(|path| read(path).map(|text| lines(text).trim_matches('\n').into())).collect()
}

/// Writes the document.
pub(crate) fn write(root: &Path, file: &Path) -> Result<usize, StepError> {
    let packages = packages(&read(&root.join("Cargo.lock"))?);
    let metadata = metadata(root)?;
    let document = document(&packages, &metadata);
    let text = format!("{document:#}\n");
    fs::write(file, text).map_err(StepError::file(file))?;
    Ok(packages.len())
}

/// The packages of a `Cargo.lock`, which Cargo writes one field a line.
fn packages(lock: &str) -> Vec<Package> {
    let blocks = lock.split("[[package]]").skip(1);
    blocks
        .map(|block| {
            let field = |name: &str| {
                let value =
                    block.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
                value.map(|value| value.trim_matches('"').to_owned())
            };
            let dependency =
                |line: &str| Some(line.strip_prefix(" \"")?.strip_suffix("\",")?.to_owned());
            Package {
                name: field("name").unwrap_or_default(),
                version: field("version").unwrap_or_default(),
                checksum: field("checksum"),
                dependencies: block.lines().filter_map(dependency).collect(),
            }
        })
        .collect()
}

/// The document, with what `cargo metadata` says of licenses and of which packages are shipped. It has no date
/// and no random number: the same lock file gives the same document.
fn document(packages: &[Package], metadata: &Value) -> Value {
    let licenses: BTreeMap<(&str, &str), &str> = array(&metadata["packages"])
        .iter()
        .filter_map(|p| {
            Some(((p["name"].as_str()?, p["version"].as_str()?), p["license"].as_str()?))
        })
        .collect();
    let shipped = shipped(metadata);
    let component = |package: &Package| {
        let id = (package.name.as_str(), package.version.as_str());
        let is_shipped = shipped.contains(&(id.0.to_owned(), id.1.to_owned()));
        let mut component = json!({
            "type": "library",
            "bom-ref": package.purl(),
            "name": package.name,
            "version": package.version,
            "scope": if is_shipped { "required" } else { "excluded" },
            "purl": package.purl(),
        });
        if let Some(license) = licenses.get(&id) {
            component["licenses"] = json!([{ "expression": license.replace('/', " OR ") }]);
        }
        if let Some(checksum) = &package.checksum {
            component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
        }
        component
    };
    let depends = |package: &Package| {
        let found = package.dependencies.iter().filter_map(|dependency| {
            packages.iter().find(|other| other.is(dependency)).map(Package::purl)
        });
        json!({ "ref": package.purl(), "dependsOn": found.collect::<BTreeSet<_>>() })
    };
    json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": "upglow",
                "name": "upglow",
                "version": env!("CARGO_PKG_VERSION"),
            },
        },
        "components": packages.iter().map(component).collect::<Vec<_>>(),
        "dependencies": packages.iter().map(depends).collect::<Vec<_>>(),
    })
}

/// Names and versions of the packages in what is shipped, on any platform.
fn shipped(metadata: &Value) -> BTreeSet<(String, String)> {
    let named: BTreeMap<&str, (String, String)> = array(&metadata["packages"])
        .iter()
        .filter_map(|p| Some((p["id"].as_str()?, (text(&p["name"]), text(&p["version"])))))
        .collect();
    let nodes = array(&metadata["resolve"]["nodes"]);
    let mut left: Vec<&str> = named
        .iter()
        .filter(|(_, (name, _))| SHIPPED.contains(&name.as_str()))
        .map(|(id, _)| *id)
        .collect();
    let mut found = BTreeSet::new();
    while let Some(id) = left.pop() {
        if !found.insert(id) {
            continue;
        }
        let Some(node) = nodes.iter().find(|node| node["id"] == id) else { continue };
        let is_normal =
            |edge: &&Value| array(&edge["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
        left.extend(
            array(&node["deps"]).iter().filter(is_normal).filter_map(|edge| edge["pkg"].as_str()),
        );
    }
    found.iter().filter_map(|id| named.get(id).cloned()).collect()
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_terms_of_a_package_that_is_shipped_are_told_and_those_of_one_for_tests_are_not() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let file = std::env::temp_dir().join(format!("upglow-notices-{}.md", std::process::id()));
        if write_notices(root, &file).is_err() {
            println!("skipped: `cargo fetch --locked` has not run");
            return;
        }
        let text = read(&file).unwrap();
        fs::remove_file(&file).unwrap();
        assert!(text.contains("- exr 1.") && text.contains("Redistributions in binary form"));
        assert!(!text.contains("- proptest ") && !text.contains("- upglow"));
    }

    #[test]
    fn the_components_are_the_packages_of_the_lock_file() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let found = packages(&read(&root.join("Cargo.lock")).unwrap());
        let command = "metadata --format-version 1 --locked --offline --all-features";
        // On a machine that fetched only its own platform's crates, Cargo cannot list them all.
        let Ok(metadata) = json_of(cargo(root, command)) else {
            println!("skipped: `cargo fetch --locked` has not run");
            return;
        };
        let id = |name: &Value, version: &Value| format!("{} {}", text(name), text(version));
        let known: BTreeSet<String> =
            array(&metadata["packages"]).iter().map(|p| id(&p["name"], &p["version"])).collect();
        let document = document(&found, &metadata);
        let components = array(&document["components"]);
        let listed: BTreeSet<String> =
            components.iter().map(|c| id(&c["name"], &c["version"])).collect();
        assert_eq!(listed, known);
        assert_eq!(components.len(), found.len());
        assert!(components.iter().all(|c| c["licenses"].is_array()), "a package states no license");
        let scope =
            |name: &str| components.iter().find(|c| c["name"] == name).map(|c| text(&c["scope"]));
        assert_eq!(scope("safetensors").as_deref(), Some("required"));
        assert_eq!(scope("cbindgen").as_deref(), Some("excluded"));
        let names: BTreeSet<String> = components.iter().map(|c| text(&c["bom-ref"])).collect();
        for edge in array(&document["dependencies"]).iter().flat_map(|d| array(&d["dependsOn"])) {
            assert!(names.contains(&text(edge)), "{edge}");
        }
        let count =
            |packages: &[Package]| packages.iter().map(|p| p.dependencies.len()).sum::<usize>();
        let edges = array(&document["dependencies"]).iter().map(|d| array(&d["dependsOn"]).len());
        assert_eq!(edges.sum::<usize>(), count(&found));
    }

    #[test]
    fn a_package_of_the_lock_file_is_read() {
        let lock = "version = 4\n\n[[package]]\nname = \"a\"\nversion = \"1.0.0\"\n\
                    source = \"registry\"\nchecksum = \"0f\"\ndependencies = [\n \"b 2.0.0\",\n]\n";
        let expected = Package {
            name: "a".into(),
            version: "1.0.0".into(),
            checksum: Some("0f".into()),
            dependencies: vec!["b 2.0.0".into()],
        };
        assert_eq!(packages(lock), [expected]);
    }
}
