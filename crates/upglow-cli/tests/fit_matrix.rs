//! `upglow fit-matrix`: from a measured re-radiation matrix to a material.

mod support;

use std::path::Path;

use support::Folder;

/// A matrix of a yellow sample: violet and blue light is absorbed, and a third of it leaves green.
fn sample() -> String {
    let bands: Vec<u32> = (380..=740).step_by(20).collect();
    let names: Vec<String> = bands.iter().map(u32::to_string).collect();
    let mut text = format!("outgoing_nm\\incident_nm per_band,{}\n", names.join(","));
    for outgoing in &bands {
        let value = |incident: &u32| match (*incident, *outgoing) {
            (380..=460, 500..=560) => 0.08,
            (i, o) if i == o => {
                if i < 480 {
                    0.1
                } else {
                    0.8
                }
            }
            _ => 0.0,
        };
        let cells: Vec<String> = bands.iter().map(|i| value(i).to_string()).collect();
        text += &format!("{outgoing},{}\n", cells.join(","));
    }
    text
}

#[test]
fn a_matrix_becomes_a_material_a_picture_and_a_cube() {
    let folder = Folder::new();
    folder.write("sample.csv", sample());
    let report = folder.json("fit-matrix sample.csv --plot sample.svg -o sample.safetensors");
    assert!(report["mean_de2000"].as_f64().is_some_and(|mean| mean < 1.0), "{report}");
    assert_eq!(report["dyes"][0]["name"].as_str().map(|name| &name[..8]), Some("measured"));
    assert_eq!(
        (report["unit"].as_str(), report["incident"]["count"].as_u64()),
        (Some("per band"), Some(19))
    );
    let svg = String::from_utf8(folder.read("sample.svg")).unwrap_or_default();
    assert!(svg.contains("<polyline") && svg.contains("measured</text>"));
    // The color under A, by the matrix and by the cube's sums over 5 nm.
    let shown = folder.json("color sample.safetensors 0.5 0.5 0.5 --light A");
    let [fitted, looked_up] = [&report["lights"][1]["fitted"][1], &shown["lights"][1]["xyz"][1]]
        .map(|y| y.as_f64().unwrap_or(f64::NAN));
    assert!((fitted - looked_up).abs() < 0.02, "{fitted} {looked_up}");
}

#[test]
fn faults_are_named_in_one_line() {
    let folder = Folder::new();
    folder.write("sample.csv", sample());
    folder.write("bad.csv", sample().replace("500,0.08", "500,much"));
    folder.write("plain.csv", "wavelength_nm,power\n300,1\n");
    folder.write("empty.bfc", "");
    folder.write("text.exr", "no picture");
    let names = ["outgoing_nm\\incident_nm", "incident_nm\\outgoing_nm"];
    assert!(sample().starts_with(names[0]));
    folder.write("exchanged.csv", sample().replace(names[0], names[1]));
    let cases = [
        ("sample.txt", "sample.txt: a file .txt, expected a measured matrix, .bfc, .csv or .exr"),
        (
            "absent.csv",
            "absent.csv: no such file or folder, expected a matrix as CSV with named axes",
        ),
        ("bad.csv", "bad.csv: line 8, cell 2: \"much\", expected a number"),
        (
            "plain.csv",
            "plain.csv: line 1 starts with \"wavelength_nm\", expected outgoing_nm\\incident_nm",
        ),
        ("empty.bfc", "empty.bfc: line 2 is missing, expected BFC-450 Matrix File"),
        ("text.exr", "text.exr: "),
        ("exchanged.csv", "exchanged.csv: light that arrives at "),
        (
            "sample.csv --plot sample.csv",
            "sample.csv: a name that ends in .csv, expected one that ends in .svg",
        ),
    ];
    for (words, line) in cases {
        let found = folder.refused(1, &format!("fit-matrix {words}"));
        assert!(found.starts_with(line), "{found}");
    }
    for (words, line) in [
        ("--at 1,1", "--at: given with a file .csv, expected it with an EXR"),
        (
            "--dyes all --reflectance measured",
            "--reflectance: measured with dyes of a table, expected",
        ),
        (
            "--count 2 --reflectance measured",
            "--reflectance: measured with two emitting dyes, expected",
        ),
        ("--dyes nowhere", "--dyes: unknown dye set \"nowhere\", expected"),
        ("--count 3", "--count: 3, expected a whole number from 1 to 2"),
    ] {
        let found = folder.run(&format!("fit-matrix sample.csv {words}"));
        assert!(found.status != 0 && found.stderr.contains(line), "{found:?}");
    }
}

#[test]
fn a_measured_sample_of_the_bfc_450_is_fitted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
    if !folder.is_dir() {
        eprintln!(
            "skipped: a_measured_sample_of_the_bfc_450_is_fitted (no ../shared/data/bispectral)"
        );
        return;
    }
    let file = folder.join("TEXTYELL.BFC");
    let report =
        Folder::new().json(&format!("fit-matrix {} --light A --light FL2", file.display()));
    assert!(report["max_de2000"].as_f64().is_some_and(|most| most < 1.0), "{report}");
    let missing = |light: usize| report["lights"][light]["missing_ultraviolet"].as_str();
    let fl2 = "FL2 is given from 380 nm on: what dyes absorb below is not counted";
    assert_eq!([missing(0), missing(1)], [None, Some(fl2)]);
}
