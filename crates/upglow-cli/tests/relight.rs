//! `upglow relight`, run on a small cube.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod support;

use serde_json::Value;
use support::{Folder, curves};

fn folder_with_cube() -> Folder {
    let folder = Folder::new();
    folder.done("build --resolution 3 -o cube");
    folder
}

/// `serde_json` reads a number as one of those next to it.
const PARSING: f64 = 1e-15;

const LIGHTS: &str = "--light A --light E --light D50";

fn views(told: &Value) -> &[Value] {
    told["views"].as_array().unwrap()
}

#[test]
fn colors_are_those_of_the_command_color() {
    let folder = folder_with_cube();
    for options in ["", "--direct"] {
        let color = folder.json(&format!("color cube 0.9 0.1 0.8 {LIGHTS} {options}"));
        let told = folder.json(&format!("relight cube 0.9 0.1 0.8 --light D65 {LIGHTS} {options}"));
        assert_eq!(views(&told).len(), 4);
        for (view, light) in views(&told).iter().zip(color["lights"].as_array().unwrap()) {
            assert_eq!(view["light"], light["name"]);
            assert_eq!(view["is_adapted"], light["is_adapted"]);
            let seen = view["colors"][0].as_object().unwrap();
            assert!(
                seen["fluorescent_share"].as_f64().is_some_and(|share| share > 0.0),
                "{seen:?}"
            );
            seen.iter().for_each(|(name, number)| assert_eq!(*number, light[name], "{name}"));
        }
    }
}

#[test]
fn without_lights_the_light_of_the_cube_is_first_and_a_lamp_last() {
    let folder = folder_with_cube();
    folder.done("build --resolution 2 -o other --illuminant A");
    for (cube, names) in
        [("cube", ["D65", "A", "E", "365 nm lamp"]), ("other", ["A", "D65", "E", "365 nm lamp"])]
    {
        let told = folder.json(&format!("relight {cube} 0.5 0.5 0.5"));
        let found: Vec<&str> = views(&told).iter().map(|v| v["light"].as_str().unwrap()).collect();
        assert_eq!(found, names);
        assert_eq!(views(&told)[3]["is_adapted"], false);
        assert_eq!(views(&told)[3]["colors"][0]["de2000"], Value::Null);
    }
}

#[test]
fn csv_and_json_agree_for_every_light_and_observer() {
    let folder = folder_with_cube();
    folder.write("list.csv", "name,r,g,b\nvest,0.9,1,0\n,1,1,1\n\"x\",0,0,0\n");
    folder.write("lamp.csv", curves("power", |nm| nm.to_string()));
    let options =
        "--light D65 --light lamp.csv --observer cie-1931-2deg --observer cie-1964-10deg --band";
    let told = folder.json(&format!("relight cube --colors list.csv {options} --csv table.csv"));
    let table = String::from_utf8(folder.read("table.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    assert_eq!(header.len(), 21);
    for view in views(&told) {
        for (color, seen) in
            told["colors"].as_array().unwrap().iter().zip(view["colors"].as_array().unwrap())
        {
            let line = lines.next().unwrap();
            let cell = |name: &str| line[header.iter().position(|found| *found == name).unwrap()];
            assert_eq!(cell("light"), view["light"]);
            assert_eq!(cell("observer"), view["observer"]);
            assert_eq!(cell("is_adapted"), view["is_adapted"].to_string());
            let numbers = [
                ("r", &color["rgb"][0]),
                ("g", &color["rgb"][1]),
                ("b", &color["rgb"][2]),
                ("x", &seen["xyz"][0]),
                ("y", &seen["xyz"][1]),
                ("z", &seen["xyz"][2]),
                ("lab_l", &seen["lab"]["l"]),
                ("lab_a", &seen["lab"]["a"]),
                ("lab_b", &seen["lab"]["b"]),
                ("r_under", &seen["rgb"][0]),
                ("g_under", &seen["rgb"][1]),
                ("b_under", &seen["rgb"][2]),
                ("de2000", &seen["de2000"]),
                ("fluorescent_share", &seen["fluorescent_share"]),
                ("whiteness", &seen["whiteness"]["whiteness"]),
                ("tint", &seen["whiteness"]["tint"]),
                ("band_de2000", &seen["band_de2000"]),
            ];
            for (name, value) in numbers {
                let (cell, told): (Option<f64>, _) = (cell(name).parse().ok(), value.as_f64());
                assert_eq!(cell.is_some(), told.is_some(), "{name}: {line:?}");
                let [cell, told] = [cell, told].map(Option::unwrap_or_default);
                assert!((cell - told).abs() <= PARSING * told.abs(), "{name}: {line:?}");
            }
        }
    }
    assert_eq!(lines.next(), None);
    assert!(table.contains("\nvest,0.9,1,0,D65,CIE 1931 2°,true,"), "{table}");
}

#[test]
fn white_is_100_under_daylight_and_undefined_under_other_light() {
    let folder = folder_with_cube();
    let told = folder.json("relight cube 1 1 1 --light D65 --light A --observer cie-1964-10deg");
    let [day, evening] = [0, 1].map(|i| &views(&told)[i]["colors"][0]["whiteness"]);
    // Rounding only.
    let number = |name: &str| day[name].as_f64().unwrap();
    assert!((number("whiteness") - 100.0).abs() < 1e-3 && number("tint").abs() < 1e-3, "{day}");
    assert_eq!(*evening, Value::Null);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = folder_with_cube();
    let run = |threads: u32| {
        folder.done(&format!("--json relight cube --nodes {LIGHTS} --threads {threads}"))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn all_nodes_are_relit_and_the_first_are_drawn_and_printed() {
    let folder = Folder::new();
    folder.done("build --resolution 5 -o cube");
    let told = folder.json("relight cube --nodes --light A");
    assert_eq!(views(&told)[0]["colors"].as_array().unwrap().len(), 125);
    let text = folder.done("relight cube --nodes --light A --plot nodes.svg");
    assert!(text.contains("61 more colors: --csv FILE.csv or --json has all."), "{text}");
    let svg = String::from_utf8(folder.read("nodes.svg")).unwrap();
    // Paper and frame beside the swatches.
    assert_eq!(svg.matches("<rect").count(), 64 + 2);
    assert!(svg.contains("The first 64 of 125 colors."));
}

#[test]
fn what_cannot_be_relit_is_refused_in_one_line() {
    let folder = folder_with_cube();
    folder.write("list.csv", "r,g,b\n0,0,0\n0,2,0\n");
    folder.write("many.csv", "r,g,b\n".to_owned() + &"0,0,0\n".repeat(500_001));
    let cases = [
        (2, "relight cube", "colors: not given, expected R G B, --colors FILE.csv or --nodes"),
        (1, "relight cube 0 0 -1", "B: -1, expected 0 to 1"),
        (
            1,
            "relight cube --colors list.csv",
            "list.csv: line 3: g: 2 is beyond the cube, expected 0 to 1, or --direct, which fits \
             colors up to 10",
        ),
        (
            1,
            "relight cube --colors absent.csv",
            "absent.csv: no such file or folder, expected a CSV file with the header r,g,b or \
             name,r,g,b",
        ),
        (
            2,
            "relight cube --colors many.csv",
            "500001 colors under 4 lights for 1 observers are 2000004 rows, expected at most \
             2000000",
        ),
        (
            1,
            "relight cube --colors list.csv --direct --csv list.csv",
            "list.csv: an input of this command, expected another file to write",
        ),
        (
            1,
            "relight cube 0 0 0 --plot x.png",
            "x.png: a name that ends in .png, expected one that ends in .svg",
        ),
        (
            1,
            "relight cube 0 0 0 --csv cube",
            "cube: an input of this command, expected another file to write",
        ),
    ];
    for (status, command, line) in cases {
        assert_eq!(folder.refused(status, command), line);
    }
    for (command, part) in [
        ("relight cube 0 0 0 --light F11", "unknown illuminant \"F11\""),
        ("relight cube 0 0 0 --observer me", "unknown observer \"me\""),
        ("relight cube 0 0", "B"),
        ("relight cube 0 0 0 --nodes", "--nodes"),
        ("relight cube --nodes --direct", "--direct"),
        ("relight cube 0 0 0 --colors list.csv", "--colors"),
    ] {
        let line = folder.refused(2, command);
        assert!(line.contains(part), "{line}");
    }
    let run = folder.run("relight cube 0.9 0 0.9 --light FL11");
    let missing = "FL11 is given from 380 nm on: what dyes absorb below is not counted";
    assert_eq!(run.stderr, format!("upglow: warning: {missing}\n"));
}
