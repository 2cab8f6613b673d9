//! Names of a cube are text in all that is made of it: never code, markup, a formula or orders to a terminal.

mod support;

use support::Folder;
use upglow::{
    Accounting, Cube, DyeSet, Edge, FilmModel, FitRecord, Fluorescence, Model, Node, QuantumYield,
};
use upglow_color::{Contract, Grid, Illuminant, MeasuredDye, Observer, RgbSpace, is_plain};
use upglow_explorer::offline_page;

/// What breaks out of one language or another.
const ODD: [&str; 26] = [
    "</script><script>x()</script>",
    "<!--",
    "--!>",
    "]]>",
    "*/",
    "/*",
    "//",
    "\\",
    "\\\n",
    "\"",
    "'",
    "`",
    "${x}",
    "%>",
    "#",
    "@x@",
    "??/",
    "=1+1",
    "+1",
    "-1",
    "@SUM(A1)",
    "|x'!A0",
    ",",
    ";",
    "{",
    "}",
];

/// A small generator of random numbers.
struct Random(u64);

impl Random {
    fn below(&mut self, count: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % count
    }

    /// Any character, each plane and the controls often enough.
    fn character(&mut self) -> char {
        let most = [0x80, 0x100, 0x3000, 0x11_0000][usize::try_from(self.below(4)).expect("small")];
        loop {
            let found = u32::try_from(self.below(most)).ok().and_then(char::from_u32);
            if let Some(found) = found {
                return found;
            }
        }
    }

    fn name(&mut self) -> String {
        let mut name = String::new();
        for _ in 0..=self.below(4) {
            if self.below(2) == 0 {
                name.push(self.character());
            } else {
                name += ODD[usize::try_from(self.below(ODD.len() as u64)).expect("small")];
            }
        }
        name
    }

    /// One that a cube may have.
    fn allowed(&mut self) -> String {
        loop {
            let name = self.name();
            if name.chars().all(is_plain) {
                return name;
            }
        }
    }
}

/// A cube whose space, light, observer, dyes and record have these names.
fn cube(name: impl Fn(usize) -> String) -> Cube {
    let nm: Vec<f64> = Grid::FINE.wavelengths_nm().collect();
    let power: Vec<f64> = nm.iter().map(|nm| 1.0 + nm / 1000.0).collect();
    let eye = Observer::default();
    let space = RgbSpace::custom(&name(0), [[0.7, 0.29], [0.2, 0.7], [0.13, 0.05]], [0.32, 0.33]);
    let contract = Contract {
        space: space.expect("valid"),
        illuminant: Illuminant::from_samples(&name(1), &nm, &power, None).expect("valid"),
        observer: Observer::from_spectra(&name(2), eye.matching().clone()).expect("valid"),
        ..Contract::default()
    };
    let known = MeasuredDye::set("konig8").expect("built in").1;
    let dyes = known.into_iter().take(2).enumerate();
    let dyes = dyes.map(|(i, dye)| MeasuredDye {
        name: format!("{}{i}", name(3)),
        provenance: name(4),
        ..dye
    });
    let set = DyeSet::new(&name(5), dyes.collect()).expect("valid");
    let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Fixed(1.0)).expect("valid");
    let fit = FitRecord {
        preset: Some(name(6)),
        metric: name(7),
        method: name(8),
        ..FitRecord::default()
    };
    let edge = Edge { edge_nm: 550.0, level: 0.1, slope_per_nm: 0.005 };
    let film_of = Fluorescence::film((0, 1.5), (1, 0.5));
    let nodes = vec![Node::new(edge, film_of, 0.5); 8];
    Cube::new(contract, Model::Film(film), fit, 2, nodes).expect("valid")
}

/// What stays of text without the words of names: the code of a shader, or the signs of markup and line breaks.
fn skeleton(command: &str, text: &str) -> String {
    let is_shader = [".wgsl", ".glsl", ".hlsl", ".osl", ".js"].iter().any(|e| command.contains(e));
    if is_shader {
        let comments = || text.lines().filter(|line| line.starts_with("//"));
        assert!(!comments().any(|line| line.contains(['\\', '<', '>', '*', '?', '`'])), "{text}");
        let code = text.lines().filter(|line| !line.starts_with("//"));
        return format!("{}\n{}", comments().count(), code.collect::<Vec<_>>().join("\n"));
    }
    // Quotation marks have no meaning between elements.
    text.chars()
        .filter(|c| "<>\n".contains(*c) && !command.contains(".cube") || *c == '\n')
        .collect()
}

/// Commands that print about a cube.
const REPORTS: [&str; 5] = [
    "inspect cube",
    "color cube 0.5 0.4 0.3",
    "relight cube 0.5 0.4 0.3",
    "relight cube 0.5 0.4 0.3 --light A",
    "verify cube --points 50",
];

/// Commands that write `OUT`.
const EXPORTS: [&str; 12] = [
    "export cube OUT.wgsl",
    "export cube OUT.glsl",
    "export cube OUT.hlsl",
    "export cube OUT.osl",
    "export cube OUT.js",
    "export cube OUT.wgsl --engine srgb",
    "export cube OUT.mtlx",
    "export cube OUT.clf --resolution 2",
    "export cube OUT.cube --resolution 2",
    "color cube 0.5 0.4 0.3 --plot OUT.svg",
    "relight cube 0.5 0.4 0.3 --light A --plot OUT.svg",
    "relight cube 0.5 0.4 0.3 --csv OUT.csv",
];

fn output(command: &str, output: &str) -> String {
    let ending = command.split_once("OUT").expect("an output").1;
    output.to_owned() + ending.split(' ').next().expect("an ending")
}

fn made(folder: &Folder, command: &str) -> String {
    let run = folder.run(&command.replace("OUT", "out"));
    assert_eq!(run.status, 0, "{command}: {}", run.stderr);
    assert!(is_shown(&run.stderr), "{:?}", run.stderr);
    String::from_utf8(folder.read(&output(command, "out"))).expect("text")
}

/// Whether a terminal shows this text as it is.
fn is_shown(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || is_plain(c))
}

/// The cells of CSV text.
fn cells(text: &str) -> Vec<String> {
    let (mut cells, mut cell, mut is_quoted) = (Vec::new(), String::new(), false);
    for c in text.chars() {
        match c {
            '"' => is_quoted = !is_quoted,
            ',' | '\n' if !is_quoted => cells.push(std::mem::take(&mut cell)),
            c => cell.push(c),
        }
    }
    cells
}

#[test]
fn names_are_text_in_every_export_and_report() {
    /// Each is twenty runs of the program.
    const CUBES: u64 = 12;
    let folder = Folder::new();
    cube(|i| format!("plain{i}")).write(folder.path().join("cube")).expect("written");
    let plain = EXPORTS.map(|command| skeleton(command, &made(&folder, command)));
    let lines = REPORTS.map(|command| folder.run(command).stdout.lines().count());
    for seed in 0..CUBES {
        let mut random = Random(seed);
        let names: Vec<String> = (0..9).map(|i| format!("{}{i}", random.allowed())).collect();
        let odd = cube(|i| names[i].clone());
        odd.write(folder.path().join("cube")).expect("written");
        for (command, plain) in EXPORTS.iter().zip(&plain) {
            let text = made(&folder, command);
            if command.contains(".csv") {
                let formula = |cell: &&String| {
                    cell.starts_with(['=', '+', '-', '@']) && cell.parse::<f64>().is_err()
                };
                assert_eq!(cells(&text).iter().find(formula), None, "{names:?}");
            } else {
                assert!(skeleton(command, &text) == *plain, "{command}: {names:?}");
            }
        }
        for (command, lines) in REPORTS.iter().zip(lines) {
            let run = folder.run(command);
            assert!(is_shown(&run.stdout) && is_shown(&run.stderr), "{command}: {names:?}");
            assert_eq!(run.stdout.lines().count(), lines, "{command}: {names:?}");
            let run = folder.run(&format!("--json {command}"));
            assert!(is_shown(&run.stdout), "{command}: {names:?}");
            serde_json::from_str::<serde_json::Value>(&run.stdout).expect("JSON");
        }
    }
}

#[test]
fn names_are_text_in_the_page() {
    let signs = |cube: &Cube, name: &str| -> String {
        let page = offline_page(cube, name).expect("a page");
        page.chars().filter(|c| "<>`\"'\n".contains(*c)).collect()
    };
    let plain = signs(&cube(|i| format!("plain{i}")), "plain");
    for seed in 100..103 {
        let mut random = Random(seed);
        let names: Vec<String> = (0..9).map(|i| format!("{}{i}", random.allowed())).collect();
        assert!(signs(&cube(|i| names[i].clone()), &names[0]) == plain, "{names:?}");
    }
}

#[test]
fn names_of_files_are_shown_and_not_obeyed() {
    let folder = Folder::new();
    folder.done("build --resolution 2 -o cube");
    let mut random = Random(7);
    for _ in 0..50 {
        // Words that the shell of the tests does not divide, and that are no options.
        let name: String =
            random.name().chars().filter(|c| !c.is_whitespace() && *c != '\0').collect();
        let run = folder.run(&format!("inspect ./{name}"));
        assert!(run.status == 1 && is_shown(&run.stderr), "{:?}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{:?}", run.stderr);
        let run = folder.run(&format!("--json inspect cube {name}"));
        assert!(is_shown(&run.stderr), "{:?}", run.stderr);
    }
}

#[test]
fn names_that_a_line_cannot_hold_are_refused() {
    let mut random = Random(11);
    for _ in 0..1000 {
        let name = random.name();
        let space = RgbSpace::custom(&name, [[0.7, 0.29], [0.2, 0.7], [0.13, 0.05]], [0.32, 0.33]);
        assert_eq!(space.is_ok(), name.chars().all(is_plain), "{name:?}");
    }
}
