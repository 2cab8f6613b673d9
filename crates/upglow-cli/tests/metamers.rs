//! Materials of paints, of which colors are known under one or more lights.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod support;

use serde_json::Value;
use support::Folder;

fn folder_with_cube() -> Folder {
    let folder = Folder::new();
    folder.done("build --resolution 3 -o cube");
    folder
}

fn light<'a>(told: &'a Value, name: &str) -> &'a Value {
    told["lights"].as_array().unwrap().iter().find(|light| light["name"] == name).unwrap()
}

fn numbers(told: &Value) -> String {
    let numbers = told.as_array().unwrap();
    numbers.iter().map(Value::to_string).collect::<Vec<_>>().join(" ")
}

#[test]
fn a_second_color_narrows_the_band_and_is_met() {
    let folder = folder_with_cube();
    let lights = "--light A --light E";
    let one = folder.json(&format!("color cube 0.9 0.3 0.02 --kind fluorescent {lights}"));
    assert_eq!(one["paint"]["known"], Value::Array(Vec::new()));
    // What the program shows under a light is what it takes for that light.
    let a = numbers(&light(&one, "A")["rgb"]);
    for answer in ["single", "mixture"] {
        let two = folder
            .json(&format!("color cube 0.9 0.3 0.02 --known A {a} --answer {answer} {lights}"));
        assert_eq!(two["paint"]["kind"], "any");
        assert_eq!(two["paint"]["answer"], answer);
        assert!(two["de2000"].as_f64().unwrap() <= 0.01);
        assert!(two["paint"]["known"][0]["de2000"].as_f64().unwrap() < 1.0, "{}", two["paint"]);
        for name in ["A", "E"] {
            let [wide, narrow] =
                [&one, &two].map(|told| light(told, name)["band_de2000"].as_f64().unwrap());
            assert!(narrow < wide, "{name}: {narrow} {wide}");
        }
    }
}

#[test]
fn a_paint_may_be_brighter_than_white_and_is_written_as_a_cube() {
    let folder = folder_with_cube();
    let told = folder.json("color cube 1.2 0.4 0.05 --kind fluorescent -o paint.safetensors");
    assert_eq!(told["paint"]["kind"], "fluorescent");
    assert!(told["paint"]["fluorescent_probability"].as_f64().unwrap() > 0.99);
    let read = folder.json("color paint.safetensors 0.1 0.2 0.3");
    for (ours, theirs) in
        told["lights"].as_array().unwrap().iter().zip(read["lights"].as_array().unwrap())
    {
        // A blend of one material four times rounds otherwise than the material.
        for k in 0..3 {
            let [one, two] = [ours, theirs].map(|told| told["xyz"][k].as_f64().unwrap());
            assert!((one - two).abs() < 1e-12, "{one} {two}");
        }
    }
    folder.done("verify paint.safetensors --points 100");
}

#[test]
fn an_ordinary_paint_does_not_emit_and_the_program_says_what_the_wrong_kind_costs() {
    let folder = folder_with_cube();
    let ordinary = folder.done("color cube 0.5 0.4 0.3 --kind ordinary");
    assert!(ordinary.contains("no, as asked; by its color with a probability of less than 1 %"));
    assert!(ordinary.contains("with dyes that absorb only"), "{ordinary}");
    let fluorescent = folder.done("color cube 0.5 0.4 0.3 --kind fluorescent");
    assert!(fluorescent.contains("A paint that does not is shown worse"), "{fluorescent}");
}

#[test]
fn relight_takes_kinds_and_shows_bands() {
    let folder = folder_with_cube();
    folder.write("list.csv", "r,g,b\n0.5,0.4,0.3\n1.2,0.4,0.05\n");
    let kind = folder.json("relight cube --colors list.csv --kind any --light D65 --light A");
    let bands = |told: &Value, view: usize| -> Vec<f64> {
        let seen = told["views"][view]["colors"].as_array().unwrap().iter();
        seen.map(|seen| seen["band_de2000"].as_f64().unwrap()).collect()
    };
    assert!(bands(&kind, 0).iter().all(|band| *band < 0.1), "{:?}", bands(&kind, 0));
    assert!(bands(&kind, 1).iter().all(|band| *band > 0.5), "{:?}", bands(&kind, 1));
    let share = |color: usize| kind["views"][0]["colors"][color]["fluorescent_share"].as_f64();
    assert!(share(0) < Some(0.01) && share(1) > Some(0.05));
    // Beside what the cube gives, a band says how far off that may be.
    let looked_up = folder.json("relight cube 0.5 0.4 0.3 --band --light A");
    let plain = folder.json("relight cube 0.5 0.4 0.3 --light A");
    assert_eq!(looked_up["views"][0]["colors"][0]["xyz"], plain["views"][0]["colors"][0]["xyz"]);
    assert!(bands(&looked_up, 0)[0] > 0.5);
    assert_eq!(plain["views"][0]["colors"][0]["band_de2000"], Value::Null);
}

#[test]
fn a_known_color_under_a_light_of_unknown_ultraviolet_is_told_once() {
    let folder = folder_with_cube();
    let known = "--json color cube 0.9 0.3 0.02 --known FL2 0.8 0.3 0.05 --light A";
    for command in [known.to_owned(), format!("{known} --light FL2")] {
        let told = folder.run(&command);
        assert_eq!(
            told.stderr.matches("FL2 is given from 380 nm on").count(),
            1,
            "{}",
            told.stderr
        );
        let json: Value = serde_json::from_str(&told.stdout).unwrap();
        let known = &json["paint"]["known"][0];
        assert!(known["missing_ultraviolet"].is_string(), "{known}");
    }
}

#[test]
fn the_brightest_colors_of_the_help_are_searched() {
    let folder = folder_with_cube();
    folder.write("bright.csv", "r,g,b\n10,10,10\n");
    for line in ["color cube 10 10 10 --kind any", "relight cube --colors bright.csv --kind any"] {
        let run = folder.run(line);
        assert_eq!(run.status, 0, "{line}: {}", run.stderr);
    }
}

#[test]
fn faults_are_named_in_one_line() {
    let folder = folder_with_cube();
    let color = "color cube 0.5 0.4 0.3";
    let many = format!("r,g,b\n{}", "0.5,0.5,0.5\n".repeat(1001));
    folder.write("many.csv", many);
    for (status, command, fault) in [
        (2, format!("{color} --answer mixture"), "--answer: given without --kind or --known"),
        (2, format!("{color} -o x.safetensors"), "--output: given without --kind or --known"),
        (
            2,
            format!("{color} --known A 0.5 0.4 red"),
            "--known: \"red\", expected a number from -10",
        ),
        (2, format!("{color} --known X 0.5 0.4 0.3"), "unknown illuminant \"X\""),
        (
            2,
            format!("{color} --known A 0 0 0 --known E 0 0 0 --known FL2 0 0 0"),
            "--known: colors under 4 lights, expected at most 3",
        ),
        (2, format!("{color} --kind odd"), "expected any, ordinary or fluorescent"),
        (2, "relight cube 0.5 0.4 0.3 --answer mixture".into(), "--answer: given without --kind"),
        (2, "relight cube --colors many.csv --band".into(), "1001 colors, expected at most 1000"),
    ] {
        let told = folder.refused(status, &command);
        assert!(told.contains(fault), "{command}: {told}");
    }
}
