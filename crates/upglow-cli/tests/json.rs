//! What commands print with `--json` is what docs/upglow.schema.json says, and no more; CSV headers are those of
//! docs/outputs.md.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod support;

use serde_json::Value;
use support::Folder;

const SCHEMA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/upglow.schema.json");
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/outputs.md");

/// The schema of a document, checked strictly: a field that the schema does not list is a fault here, though readers
/// must pass over it.
struct Schema(Value);

impl Schema {
    fn read() -> Self {
        Self(serde_json::from_str(&std::fs::read_to_string(SCHEMA).unwrap()).unwrap())
    }

    /// What is wrong with a document of a command.
    fn faults(&self, command: &str, document: &Value) -> Vec<String> {
        let schema = &self.0["$defs"][command];
        assert!(schema.is_object(), "no schema of {command}");
        self.faults_at(command, schema, document)
    }

    fn faults_at(&self, place: &str, schema: &Value, value: &Value) -> Vec<String> {
        if let Some(reference) = schema["$ref"].as_str() {
            let name = reference.rsplit('/').next().unwrap();
            return self.faults_at(place, &self.0["$defs"][name], value);
        }
        if let Some(choices) = schema["anyOf"].as_array() {
            let faults: Vec<_> = choices.iter().map(|s| self.faults_at(place, s, value)).collect();
            let fits = faults.iter().any(Vec::is_empty);
            return if fits { Vec::new() } else { faults.concat() };
        }
        if let Some(words) = schema["enum"].as_array() {
            let is_one = words.contains(value);
            return if is_one { Vec::new() } else { vec![format!("{place}: {value}")] };
        }
        let allowed = match &schema["type"] {
            Value::Array(names) => names.iter().filter_map(Value::as_str).collect(),
            name => vec![name.as_str().unwrap()],
        };
        if !allowed.iter().any(|name| is_of(name, value)) {
            return vec![format!("{place}: {value}, expected {allowed:?}")];
        }
        match value {
            Value::Object(fields) => {
                let required = schema["required"].as_array().unwrap();
                let lacking = required.iter().filter_map(Value::as_str);
                let lacking = lacking.filter(|name| !fields.contains_key(*name));
                let mut faults: Vec<_> =
                    lacking.map(|name| format!("{place}: no field {name}")).collect();
                for (name, field) in fields {
                    let place = format!("{place}.{name}");
                    match schema["properties"].get(name) {
                        Some(schema) => faults.extend(self.faults_at(&place, schema, field)),
                        None => faults.push(format!("{place} is not in the schema")),
                    }
                }
                faults
            }
            Value::Array(items) => {
                let count = items.len() as u64;
                let [least, most] = ["minItems", "maxItems"].map(|name| schema[name].as_u64());
                if least.is_some_and(|n| count < n) || most.is_some_and(|n| count > n) {
                    return vec![format!("{place}: {count} items")];
                }
                let each = items
                    .iter()
                    .flat_map(|item| self.faults_at(&format!("{place}[]"), &schema["items"], item));
                each.collect()
            }
            _ => Vec::new(),
        }
    }
}

fn is_of(name: &str, value: &Value) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    }
}

/// Runs a command line, which may fail, and compares each document that it prints.
fn check(folder: &Folder, schema: &Schema, definition: &str, line: &str) {
    let run = folder.run(&format!("--json {line}"));
    assert!(!run.stdout.is_empty(), "{line}: {}", run.stderr);
    for document in run.stdout.lines() {
        let document: Value = serde_json::from_str(document).unwrap();
        assert_eq!(schema.faults(definition, &document), [""; 0], "{line}");
    }
}

#[test]
fn every_command_prints_what_the_schema_says() {
    let (folder, schema) = (Folder::new(), Schema::read());
    folder.write("colors.csv", "name,r,g,b\na,0.5,0.3,0.2\nwhite,1,1,1\n");
    folder.write("broken/bad.exr", "no picture");
    for (definition, line) in [
        ("build", "build --resolution 3 -o cube.safetensors"),
        ("build", "build --resolution 2 --preset konig2020 -o dyes.safetensors"),
        ("build", "build --resolution 2 --preset jakob2019 --light FL11 -o none.safetensors"),
        ("build", "build --resolution 2 --model analytic -o analytic.safetensors"),
        ("inspect", "inspect cube.safetensors"),
        ("inspect", "inspect dyes.safetensors"),
        ("inspect", "inspect none.safetensors"),
        ("inspect", "inspect analytic.safetensors"),
        ("verify", "verify cube.safetensors --points 20"),
        ("verify", "verify none.safetensors --points 20 --interpolation none"),
        ("color", "color cube.safetensors 0.9 0 0.9 --plot magenta.svg --engine rec709"),
        ("color", "color dyes.safetensors 0.9 0 0.9"),
        ("color", "color analytic.safetensors 0.9 0 0.9"),
        ("color", "color cube.safetensors 0.2 0.2 0.2 --light FL11"),
        ("color", "color cube.safetensors 3 0 3 --direct"),
        ("color", "color cube.safetensors 0.9 0.3 0.02 --kind any --known A 0.75 0.28 0.02 -o one"),
        ("relight", "relight cube.safetensors --colors colors.csv --csv a.csv --plot a.svg"),
        ("relight", "relight cube.safetensors 0.9 0 0.9 --light FL11 --observer cie-1964-10deg"),
        ("relight", "relight cube.safetensors 0.5 0.3 0.2 --kind any --band --light A"),
        ("export", "export cube.safetensors -o nodes.csv"),
        ("export", "export cube.safetensors -o cube.wgsl"),
        ("export", "export cube.safetensors -o cube.coeff --resolution 3"),
        ("export", "export cube.safetensors -o cube.mtlx --light A"),
        ("export", "export cube.safetensors -o cube.clf --resolution 3"),
        ("inspect", "inspect cube.coeff --space acescg"),
        ("examples", "examples -o pictures"),
        ("man", "man -o man"),
        ("completions", "completions bash"),
        ("bake", "bake cube.safetensors pictures/chart.exr -o material.exr"),
        ("bake", "bake cube.safetensors pictures/chart.exr -o fast.exr --fast"),
        (
            "bake",
            "bake cube.safetensors pictures/chart.exr -o compact.exr --as spectral --compact --mtlx",
        ),
        (
            "bake",
            "bake cube.safetensors pictures/chart.exr -o bands.exr --as spectral --bands 400:700:100",
        ),
        ("bake", "bake cube.safetensors pictures/chart.exr -o seen.png --as radiance --light A"),
        ("bake", "bake cube.safetensors broken -o baked"),
        ("bake-plan", "bake cube.safetensors pictures/chart.exr -o planned.exr --plan plan.json"),
        ("bake", "bake --task 1 plan.json"),
        ("lint", "lint --task 1 plan.json"),
        ("lint", "lint compact.exr bands.exr material.exr pictures/chart.exr"),
        ("check", "check pictures/chart.exr --heat-map map.png --light A"),
        ("check", "check pictures/chart.exr broken --cube none.safetensors -o report.html"),
        ("read", "read compact.exr --at 1,1"),
        ("read", "read bands.exr --at 1,1"),
        ("read", "read material.exr --at 1,1"),
        ("fit-matrix", "fit-matrix bands.exr --at 1,1 -o fitted --plot fitted.svg"),
        ("fit-matrix", "fit-matrix bands.exr --at 100,20 -o glowing"),
    ] {
        check(&folder, &schema, definition, line);
    }
    let page = std::fs::read_to_string(PAGE).unwrap();
    for (file, title) in [("nodes.csv", "**`upglow export"), ("a.csv", "**`upglow relight")] {
        let text = String::from_utf8(folder.read(file)).unwrap();
        let header = text.lines().next().unwrap();
        let table = page.split(title).nth(1).unwrap().split("\n\n").nth(1).unwrap();
        let rows = table.lines().skip(2).flat_map(|row| row.split('|').nth(1).unwrap().split(','));
        let columns: Vec<&str> = rows.map(|cell| cell.trim().trim_matches('`')).collect();
        assert_eq!(header, columns.join(","), "{file}");
    }
}

#[cfg(all(feature = "explore", unix))]
#[test]
fn the_explorer_prints_its_address_as_the_schema_says() {
    use std::io::BufRead as _;

    let folder = Folder::new();
    folder.done("build --resolution 2 -o cube");
    let mut child = std::process::Command::new(support::program())
        .args(["--json", "explore", "cube", "--no-open"])
        .current_dir(folder.path())
        .env("TMPDIR", folder.path())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    std::io::BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    let document = serde_json::from_str(&line).unwrap();
    assert_eq!(Schema::read().faults("explore", &document), [""; 0]);
}

#[test]
fn a_field_that_is_missing_or_of_another_kind_is_found() {
    let schema = Schema::read();
    let document =
        serde_json::json!({ "pictures": [{ "file": 1, "width": 2, "height": 3 }], "x": 0 });
    let faults = schema.faults("examples", &document);
    assert_eq!(faults.len(), 3, "{faults:?}");
    assert!(faults.iter().any(|fault| fault == "examples.x is not in the schema"), "{faults:?}");
}
