//! Invalid input is reported in one line that says what was found and what was expected, and no file
//! is written.

mod support;

use std::process::Command;

use support::{Folder, curves, dye, eye, one_line, program};

fn folder_with_cube() -> Folder {
    let folder = Folder::new();
    folder.done("build --resolution 3 -o cube");
    folder
}

#[test]
fn invalid_colors() {
    let folder = folder_with_cube();
    let cases = [
        ("NaN 0 0", "R: NaN, expected 0 to 1"),
        ("0 inf 0", "G: inf, expected 0 to 1"),
        ("0 0 -0.1", "B: -0.1, expected 0 to 1"),
        ("-1e-3 0 0", "R: -1e-3, expected 0 to 1"),
        ("-inf 0 0", "R: -inf, expected 0 to 1"),
        ("-0.5 --direct 0 0 -q", "R: -0.5, expected 0 to 10"),
        ("red 0 0", "R: \"red\", expected a number from 0 to 1"),
        ("0 11 0", "G: 11, expected 0 to 1"),
        ("0 11 0 --direct", "G: 11, expected 0 to 10"),
        ("0 nan 0 --direct", "G: nan, expected 0 to 10"),
        (
            "1.58 0.34 0.05",
            "R: 1.58 is beyond the cube, expected 0 to 1, or --direct, which fits colors up to 10",
        ),
    ];
    for (rgb, line) in cases {
        assert_eq!(folder.refused(1, &format!("color cube {rgb}")), line);
    }
}

#[test]
fn files_that_are_not_cubes() {
    let folder = folder_with_cube();
    folder.write("text", "red green blue");
    folder.write("empty", "");
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let cases = [
        ("absent", "absent: no such file or folder, expected a cube made by `upglow build`"),
        ("folder", "folder: a folder, expected a cube made by `upglow build`"),
        ("text", "text: not a whole safetensors file"),
        ("empty", "empty: not a whole safetensors file"),
    ];
    for (file, line) in cases {
        for command in ["inspect FILE", "verify FILE", "color FILE 0 0 0", "export FILE nodes.csv"]
        {
            let found = folder.refused(1, &command.replace("FILE", file));
            assert!(found.starts_with(line) && found.contains("expected"), "{found}");
        }
    }
}

#[test]
fn a_cube_cut_short_or_altered() {
    let folder = folder_with_cube();
    let whole = folder.read("cube");
    for share in 0..20 {
        folder.write("cut", &whole[..whole.len() * share / 20]);
        assert!(folder.refused(1, "inspect cut").starts_with("cut: "));
        let mut altered = whole.clone();
        altered[whole.len() * share / 20] ^= 0x10;
        folder.write("altered", altered);
        assert!(folder.refused(1, "color altered 0 0 0").starts_with("altered: "));
    }
    let mut altered = whole.clone();
    altered[whole.len() - 5000] ^= 1;
    folder.write("altered", altered);
    let line = folder.refused(1, "inspect altered");
    assert!(line.contains("checksum") && line.contains("expected"), "{line}");
}

#[test]
fn invalid_dyes() {
    let good = dye(500);
    let line_of = |nm: u32| good.lines().find(|line| line.starts_with(&format!("{nm},"))).unwrap();
    let without = |nm: u32| good.replace(&format!("{}\n", line_of(nm)), "");
    let negative = good.replace(line_of(600), "600,-0.5,0");
    let swapped = good.replace(line_of(600), "590,0,0");
    let worded = good.replace(line_of(600), "600,none,0");
    let cases = [
        (without(600), "ring/bad.csv: line 62: 605 nm after 595 nm, expected steps"),
        (swapped, "ring/bad.csv: line 62: 590 nm after 595 nm, expected ascending wavelengths"),
        (negative, "ring/bad.csv: line 62: -0.5 in column \"absorption\", expected a value of 0"),
        (worded, "ring/bad.csv: line 62: \"none\" in column \"absorption\", expected a finite"),
        ("a,b\n1,2\n".into(), "ring/bad.csv: header \"a,b\", expected \"wavelength_nm,absorption"),
    ];
    for (text, line) in cases {
        let folder = Folder::new();
        folder.write("ring/good.csv", &good);
        folder.write("ring/bad.csv", text);
        let found = folder.refused(1, "build --resolution 256 --dyes ring -o cube");
        assert!(found.starts_with(line), "{found}");
    }
    let folder = Folder::new();
    folder.write("ring/readme.txt", "nothing");
    let line = folder.refused(1, "build --dyes ring -o cube");
    assert!(line.starts_with("ring: 0 dyes, expected"), "{line}");
    let header = "wavelength_nm,absorption,emission\n";
    let exchanged = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{},{}\n", cells[0], cells[2], cells[1])
    };
    let rows: String = good.lines().skip(1).map(exchanged).collect();
    folder.write("backward/a.csv", format!("{header}{rows}"));
    let line = folder.refused(1, "build --dyes backward -o cube");
    let expected =
        "backward: dye a: the emission's mean wavelength is 500.0 nm, expected at least that of";
    assert!(line.starts_with(expected), "{line}");
    for (dyes, found) in [("", "without --dyes"), ("--dyes open8", "with --dyes open8")] {
        let line = folder.refused(2, &format!("build --normalize-dyes {dyes} -o cube"));
        let expected = "expected --dyes with a folder of CSV files";
        assert_eq!(line, format!("--normalize-dyes: given {found}, {expected}"));
    }
    let line = folder.refused(1, "build --dyes no/ring -o cube");
    assert_eq!(line, "no/ring: no such file or folder, expected a folder of CSV files");
}

#[test]
fn invalid_lights() {
    let folder = Folder::new();
    folder.write("dark.csv", curves("power", |_| "0".into()));
    let line = folder.refused(1, "build --illuminant dark.csv -o cube");
    assert!(line.starts_with("dark.csv: no power"), "{line}");
    let line = folder.refused(1, "build --illuminant absent.csv -o cube");
    assert!(line.starts_with("absent.csv: no such file"), "{line}");
    for name in ["FL3.16", "500.5K", "d3000k"] {
        let line = folder.refused(2, &format!("build --illuminant {name} -o cube"));
        assert!(line.starts_with("--illuminant: ") && line.contains(", expected "), "{line}");
    }
}

#[test]
fn lights_that_end_early() {
    let folder = folder_with_cube();
    let rows = (380..=780).step_by(5).map(|nm| format!("{nm},1\n"));
    folder.write("lamp.csv", format!("wavelength_nm,power\n{}", rows.collect::<String>()));
    let commands = [
        "build --resolution 2 -o other --illuminant lamp.csv",
        "color cube 0.9 0 0.9 --light D65 --light lamp.csv",
    ];
    for command in commands {
        assert_eq!(
            folder.refused(1, command),
            "lamp.csv: covers 380 to 780 nm, expected at least 300 to 830 nm; --light-ends zero or \
             hold says what is beyond"
        );
        let said = |ends: &str| folder.run(&format!("{command} --light-ends {ends}")).stderr;
        let missing = "lamp is given from 380 nm on: what dyes absorb below is not counted";
        assert_eq!(said("zero"), format!("upglow: warning: {missing}\n"));
        assert_eq!(said("hold"), "");
        let command = command.replace("lamp.csv", "FL11");
        let line = folder.refused(2, &format!("{command} --light-ends zero"));
        assert!(line.starts_with("--light-ends: given without a light from a file"), "{line}");
    }
    let told = folder.run("--json color cube 0.9 0 0.9 --light FL11").stdout;
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let missing = |light: usize| told["lights"][light]["missing_ultraviolet"].as_str();
    let fl11 = "FL11 is given from 380 nm on: what dyes absorb below is not counted";
    assert_eq!([missing(0), missing(1)], [None, Some(fl11)]);
    // The light of a cube.
    folder.run("build --resolution 2 -o lit --illuminant FL11");
    folder.done("build --resolution 2 -o plain --illuminant FL11 --preset jakob2019");
    for command in ["inspect", "verify --points 10", "export --format csv"] {
        let command = |cube: &str| match command {
            "export --format csv" => format!("{command} {cube} {cube}.csv"),
            _ => format!("{command} {cube}"),
        };
        let run = folder.run(&format!("--json {}", command("lit")));
        assert_eq!(run.stderr, format!("upglow: warning: {fl11}\n"));
        let told: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!(told["missing_ultraviolet"], fl11);
        assert_eq!(folder.json(&command("plain"))["missing_ultraviolet"], serde_json::Value::Null);
    }
    let coefficients = folder.run("export lit lit.coeff --resolution 4");
    assert!(!coefficients.stderr.contains("FL11"), "{coefficients:?}");
    let line = folder.refused(2, "inspect cube --light-ends zero");
    assert!(line.starts_with("--light-ends: given for a cube"), "{line}");
    // Gray has no dye.
    let gray = folder.run("color cube 0.5 0.5 0.5 --light FL11");
    assert_eq!((gray.status, gray.stderr.as_str()), (0, ""));
}

#[test]
fn a_light_that_nobody_sees() {
    let folder = Folder::new();
    let rows = (300..=830).map(|nm| format!("{nm},{}\n", u32::from(nm == 342)));
    folder.write("needle.csv", format!("wavelength_nm,power\n{}", rows.collect::<String>()));
    let line = folder.refused(1, "build --illuminant needle.csv -o cube");
    assert!(
        line.starts_with("needle.csv: no power between 360 and 830 nm, expected some"),
        "{line}"
    );
}

#[test]
fn invalid_observers() {
    let folder = Folder::new();
    let build = |text: &str| {
        folder.write("eye.csv", text);
        folder.refused(1, "build --observer eye.csv -o cube")
    };
    let line = build("wavelength_nm,r,g,b\n");
    assert!(line.starts_with("eye.csv: header \"wavelength_nm,r,g,b\", expected"), "{line}");
    let line = build(&eye().replace("\n450,", "\n450,-"));
    assert!(line.starts_with("eye.csv: line 15: -"), "{line}");
    let short: String = eye().split_inclusive('\n').take(40).collect();
    let line = build(&short);
    assert!(line.starts_with("eye.csv: covers 385 to 575 nm, expected at least 400"), "{line}");
    let line = folder.refused(1, "build --observer absent.csv -o cube");
    assert!(line.starts_with("absent.csv: no such file"), "{line}");
}

#[test]
fn command_lines_that_do_not_fit() {
    let folder = folder_with_cube();
    let cases = [
        ("build --space rec7 -o x", "--space: unknown RGB space \"rec7\", expected acescg"),
        ("build --space 1,2,3 -o x", "--space: unknown RGB space"),
        ("build --illuminant F11 -o x", "--illuminant: unknown illuminant \"F11\", expected D50"),
        ("build --observer hawk -o x", "--observer: unknown observer \"hawk\", expected cie-1931"),
        ("build --dyes none -o x", "--dyes: unknown dye set \"none\", expected konig8"),
        ("build --metric lab -o x", "--metric: unknown metric \"lab\", expected de2000"),
        ("build --model paint -o x", "--model: unknown model \"paint\", expected film"),
        ("build --adapt cat02 -o x", "--adapt: unknown adaptation \"cat02\", expected bradford"),
        ("build --resolution 1 -o x", "--resolution: 1, expected a whole number from 2 to 256"),
        ("build --resolution x -o x", "--resolution: \"x\", expected a whole number from 2 to 256"),
        ("build --threads 0 -o x", "--threads: 0, expected a whole number from 1 to 1024"),
        ("build --sweeps -1 -o x", "--sweeps: \"-1\", expected a whole number of 0 or more"),
        (
            "build --slope-max-per-nm 0 -o x",
            "--slope-max-per-nm: slope limit 0/nm, expected 0.0001",
        ),
        ("build --slope-max-per-nm NaN -o x", "--slope-max-per-nm: slope limit NaN/nm, expected"),
        ("build --slope-max-per-nm x -o x", "--slope-max-per-nm: \"x\", expected a number"),
        (
            "build --slope-max-per-nm 0.01 --slope-under-dyes-per-nm 0.02 -o x",
            "--slope-under-dyes-per-nm: slope limit 0.02/nm under dyes, expected at most that \
             without dyes, 0.01/nm",
        ),
        (
            "build --slope-under-dyes-per-nm 0 -o x",
            "--slope-under-dyes-per-nm: slope limit 0/nm, expected 0.0001",
        ),
        (
            "build --preset jakob2019 --slope-under-dyes-per-nm 0.01 -o x",
            "--slope-under-dyes-per-nm: given with --model reflectance, expected --model film,",
        ),
        (
            "build --slope-limits soft -o x",
            "--slope-limits: unknown kind of slope limits \"soft\", expected hard or relaxed",
        ),
        ("build --preset paint -o x", "--preset: unknown preset \"paint\", expected natural,"),
        (
            "build --preset natural --method konig2020 -o x",
            "--method: method konig2020 with the model film, expected dyes,",
        ),
        (
            "build --preset natural --model dyes --method konig2020 -o x",
            "--method: method konig2020 with two slope limits or relaxed ones, expected one hard",
        ),
        ("export cube x.csv --slope-max-per-nm 0.01", "--slope-max-per-nm: given with --format"),
        ("build --quantum-yield 1.5 -o x", "--quantum-yield: quantum yield 1.5, expected 0 to 1"),
        ("build --quantum-yield x -o x", "--quantum-yield: unknown quantum yield \"x\", expected"),
        (
            "build --model dyes --optical-density 0 -o x",
            "--optical-density: optical density 0, expected > 0 and at most 100",
        ),
        (
            "build --model dyes --optical-density 1e3 -o x",
            "--optical-density: optical density 1000, expected > 0 and at most 100",
        ),
        (
            "build --model analytic --emission-fwhm-nm 5 -o x",
            "--emission-fwhm-nm: width 5 nm, expected 15 to 80 nm",
        ),
        (
            "build --model analytic --absorption-fwhm-nm 5 -o x",
            "--absorption-fwhm-nm: width 5 nm, expected 15 to 80 nm",
        ),
        (
            "build --model reflectance --dyes konig8 -o x",
            "--dyes: given with --model reflectance, expected --model film or dyes",
        ),
        (
            "build --model analytic --optical-density 4 -o x",
            "--optical-density: given with --model analytic, expected --model dyes",
        ),
        (
            "build --model reflectance --accounting photon -o x",
            "--accounting: given with --model reflectance, expected --model film, dyes or analytic",
        ),
        (
            "build --preset konig2020 --emission-fwhm-nm 30 -o x",
            "--emission-fwhm-nm: given with --model dyes, expected --model analytic",
        ),
        (
            "build --model analytic --quantum-yield measured -o x",
            "--quantum-yield: measured with --model analytic, expected a number from 0 to 1",
        ),
        ("build", "the following required arguments were not provided: --output <FILE>"),
        ("build --resolutoin 4 -o x", "unexpected argument '--resolutoin' found; tip: "),
        ("paint", "unrecognized subcommand 'paint'"),
        ("color cube 0 0", "the following required arguments were not provided: <B>"),
        (
            "color cube 0 0 0 --direct --interpolation none",
            "the argument '--direct' cannot be used",
        ),
        ("verify cube --interpolation cubic", "--interpolation: unknown interpolation \"cubic\""),
        ("verify cube --points many", "--points: \"many\", expected a whole number of 0 or more"),
    ];
    for (words, line) in cases {
        let found = folder.refused(2, words);
        assert!(found.starts_with(line), "{words}: {found}");
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let folder = folder_with_cube();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let cases = [
        ("folder", "folder: a folder, expected a file to write"),
        ("no/cube", "no/cube: no folder no, expected an existing one"),
        ("cube/cube", "cube/cube: no folder cube, expected an existing one"),
        #[cfg(target_os = "linux")]
        ("/proc/cube", "/proc/cube: "),
    ];
    for (path, line) in cases {
        // The build would take minutes if it started.
        let found = folder.refused(1, &format!("build --resolution 256 -o {path}"));
        assert!(found.starts_with(line), "{found}");
        let found = folder.refused(1, &format!("export cube {path} --format csv"));
        assert!(found.starts_with(line), "{found}");
        let found = folder.refused(1, &format!("color cube 0 0 0 --plot {path}"));
        assert!(found.starts_with(line), "{found}");
    }
}

#[test]
fn outputs_are_named_as_what_they_are() {
    let folder = folder_with_cube();
    let expected = |ending: &str| {
        format!("x.pdf: a name that ends in .pdf, expected one that ends in .{ending}")
    };
    for (words, ending) in [
        ("build --resolution 256 -o x.pdf", "safetensors"),
        ("color cube 0 0 0 --plot x.pdf", "svg"),
        ("export cube x.pdf --format csv", "csv"),
        ("check cube -o x.pdf", "html or .htm"),
        ("check cube --heat-map x.pdf", "png"),
    ] {
        assert_eq!(folder.refused(1, words), expected(ending), "{words}");
    }
}

#[test]
fn a_cube_is_not_replaced_by_what_is_made_of_it() {
    let folder = folder_with_cube();
    let before = folder.read("cube");
    let line = folder.refused(1, "export cube ./cube --format csv");
    assert_eq!(line, "cube: an input of this command, expected another file to write");
    folder.refused(1, "color cube 0 0 0 --plot cube");
    assert_eq!(folder.read("cube"), before);
}

#[test]
fn a_shader_needs_a_name_that_fits_into_its_text() {
    let folder = folder_with_cube();
    let line = folder.refused(1, "export cube sk,y.wgsl");
    assert_eq!(line, "sk,y.wgsl: name \"sk,y\", expected letters, digits, '.', '-' or '_'");
    assert!(!folder.path().join("sk,y.wgsl").exists());
}

/// Runs the program in a shell after `preparation`; returns status and standard error.
#[cfg(unix)]
#[expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
fn in_shell(folder: &Folder, preparation: &str, words: &str) -> (i32, String) {
    let script = format!("{preparation} exec \"$0\" {words}");
    let output = Command::new("sh")
        .args(["-c", &script])
        .arg(program())
        .current_dir(folder.path())
        .output()
        .unwrap();
    (output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).unwrap())
}

#[cfg(unix)]
#[test]
fn a_file_that_does_not_fit_leaves_the_old_one() {
    let folder = folder_with_cube();
    folder.write("old.safetensors", "old");
    folder.write("old.csv", "old");
    let names = folder.names();
    // No file may be larger than 4 kB; the signal that would end the program is ignored.
    let limit = "trap '' XFSZ; ulimit -f 8;";
    for (words, name) in [
        ("build --resolution 4 -o old.safetensors", "old.safetensors"),
        ("export cube old.csv", "old.csv"),
    ] {
        let (status, stderr) = in_shell(&folder, limit, words);
        let line = one_line(&stderr);
        assert_eq!(status, 1, "{line}");
        let expected = format!("{name}: file too large, expected room for the file");
        assert!(line.starts_with(&expected), "{line}");
        assert_eq!((folder.names(), folder.read(name)), (names.clone(), b"old".to_vec()));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_or_closed_standard_output() {
    let folder = folder_with_cube();
    let (status, stderr) = in_shell(&folder, "exec >/dev/full;", "inspect cube");
    assert_eq!(status, 1);
    assert_eq!(one_line(&stderr), "standard output: no space left on the disk, expected room");
    let output = Command::new("sh")
        .args(["-c", "\"$0\" inspect cube | true"])
        .arg(program())
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[test]
fn commands_that_moved_name_their_program() {
    let folder = Folder::new();
    for command in ["figures", "reproduce"] {
        let expected = format!(
            "{command}: now a command of the program upglow-study, run `upglow-study {command}`"
        );
        assert_eq!(folder.refused(2, &format!("{command} -o a.md --only 4 --help")), expected);
    }
}

#[test]
fn the_densest_dyes_that_build_accepts_verify_accepts_too() {
    let folder = Folder::new();
    for dyes in ["konig8", "wide8", "open8"] {
        folder.done(&format!(
            "build --model dyes --dyes {dyes} --optical-density 100 --resolution 5 -o cube"
        ));
        folder.done("verify cube --points 500");
    }
}

/// Every reader of numbers in text, with the rows of a valid file and the command that reads it.
#[test]
fn extreme_numbers_in_files_end_in_one_short_line_or_in_numbers() {
    const EXTREME: [&str; 12] = [
        "1e308", "-1e308", "5e-324", "1e-310", "1e30", "1e31", "1e-30", "1e-31", "inf", "NaN",
        "1e154", "1e-200",
    ];
    let folder = folder_with_cube();
    std::fs::create_dir(folder.path().join("dyes")).unwrap();
    folder.write("dyes/b.csv", dye(500));
    let matrix = || {
        let axis: Vec<u32> = (300..=780).step_by(20).collect();
        let row = |values: Vec<String>| values.join(",") + "\n";
        let head = axis.iter().map(u32::to_string).collect();
        let mut text = format!("outgoing_nm\\incident_nm per_band,{}", row(head));
        for out in &axis {
            let cells = axis.iter().map(|nm| if nm == out { "0.5" } else { "0" }.to_owned());
            text += &format!("{out},{}", row(cells.collect()));
        }
        text
    };
    let files = [
        (
            "light.csv",
            curves("power", |nm| format!("{}", nm / 10)),
            "relight cube 0.5 0.4 0.3 --light light.csv",
        ),
        (
            "light.csv",
            curves("power", |nm| format!("{}", nm / 10)),
            "build --resolution 2 --illuminant light.csv -o made",
        ),
        ("eye.csv", eye(), "relight cube 0.5 0.4 0.3 --observer eye.csv"),
        ("eye.csv", eye(), "build --resolution 2 --observer eye.csv -o made"),
        ("dyes/a.csv", dye(420), "build --resolution 2 --dyes dyes -o made"),
        (
            "colors.csv",
            "r,g,b\n0.5,0.4,0.3\n0.1,0.2,0.3\n".into(),
            "relight cube --colors colors.csv",
        ),
        (
            "colors.csv",
            "r,g,b\n0.5,0.4,0.3\n0.1,0.2,0.3\n".into(),
            "relight cube --colors colors.csv --direct",
        ),
        ("matrix.csv", matrix(), "fit-matrix matrix.csv"),
    ];
    let mut refused = 0;
    for (name, valid, words) in &files {
        for (turn, extreme) in EXTREME.iter().enumerate() {
            // One cell, a whole column, or all but one cell of it.
            for kind in 0..3 {
                let lines = valid.lines().count() - 1;
                let place = 1 + (lines * (turn + 1)) / (EXTREME.len() + 1);
                let edit = |(i, line): (usize, &str)| {
                    let mut cells: Vec<&str> = line.split(',').collect();
                    let is_place = i == place;
                    let hit = i > 0 && [is_place, true, !is_place][kind];
                    if hit {
                        let last = cells.len() - 1;
                        cells[(1 + turn % last).min(last)] = extreme;
                    }
                    cells.join(",") + "\n"
                };
                folder.write(name, valid.lines().enumerate().map(edit).collect::<String>());
                let run = folder.run(&format!("--quiet {words}"));
                let what = format!("{words}, {extreme}, {kind}: {}{}", run.stdout, run.stderr);
                let has_numbers = !run.stdout.contains("NaN") && !run.stdout.contains(" inf");
                match run.status {
                    0 => assert!(has_numbers, "{what}"),
                    1 | 2 => assert!(one_line(&run.stderr).len() < 250, "{what}"),
                    _ => panic!("{what}"),
                }
                refused += usize::from(run.status != 0);
            }
        }
    }
    assert!(refused > 80, "{refused}");
}
