//! `cargo xtask outputs`: every product of a program at a small size, to compare two programs with.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use sha2::{Digest as _, Sha256};

use crate::step::StepError;

/// Below here lie the texts for people, which may differ.
const TEXTS: &str = "texts";

/// Key of the seconds a run took, in JSON documents; the number after it is no product.
const TIME_KEY: &str = "\"time_s\":";

/// Exit status of a program that refuses its options.
const BAD_USAGE: i32 = 2;

/// Options of cubes that stand for the others where every command is run.
const SAMPLES: [(&str, &str); 9] = [
    ("default", ""),
    ("separate", "--mixing separate"),
    ("photon", "--mixing separate --accounting photon --quantum-yield measured"),
    ("dense", "--dyes wide14 --optical-density 1 --quantum-yield 0.8"),
    ("analytic", "--model analytic"),
    ("analytic-photon", "--model analytic --accounting photon"),
    ("reflectance", "--model reflectance"),
    ("features", "--method seed-features --slope-max-per-nm none"),
    ("srgb", "--space srgb --illuminant D50"),
];

/// Colors to look up: gray, black, white, primaries, what needs dyes, what nothing shows.
const COLORS: [&str; 7] =
    ["0.5 0.5 0.5", "0 0 0", "1 1 1", "0.9 0.1 0.1", "0.1 0.8 0.2", "0.2 0.1 0.9", "0.9 0 0.9"];

const INTERPOLATIONS: [&str; 5] = ["blend", "none", "coefficients", "features", "hybrid"];

/// Makes the outputs of `program` in `folder`, prints their sums, and compares them with those in
/// `against`; whether no product differs. Figures and the report on the paper come from `study`.
pub(crate) fn run(
    program: &Path,
    folder: &Path,
    study: &Path,
    against: Option<&Path>,
) -> Result<bool, StepError> {
    make(program, folder, study)?;
    let made = sums(folder)?;
    for (path, sum) in &made {
        println!("{sum}  {path}");
    }
    let Some(against) = against else { return Ok(true) };
    let changes = changes(&sums(against)?, &made);
    for Change { path, what, .. } in &changes {
        eprintln!("{path}: {what}");
    }
    let products = changes.iter().filter(|change| change.is_product).count();
    let texts = changes.len() - products;
    eprintln!("outputs: {} files, {products} differ; {texts} texts differ", made.len());
    Ok(products == 0)
}

/// One file that is not the same in both folders.
#[derive(Clone, Debug, PartialEq)]
struct Change {
    path: String,
    what: &'static str,
    /// Whether it may not differ: texts for people may.
    is_product: bool,
}

fn changes(old: &BTreeMap<String, String>, new: &BTreeMap<String, String>) -> Vec<Change> {
    let gone = old.keys().filter(|path| !new.contains_key(*path)).map(|path| (path, "is missing"));
    let others = new.iter().filter_map(|(path, sum)| match old.get(path) {
        None => Some((path, "is new")),
        Some(before) => (before != sum).then_some((path, "differs")),
    });
    let change = |(path, what): (&String, _)| Change {
        path: path.clone(),
        what,
        is_product: !path.starts_with(TEXTS),
    };
    gone.chain(others).map(change).collect()
}

/// SHA-256 of each file below a folder, by path.
fn sums(folder: &Path) -> Result<BTreeMap<String, String>, StepError> {
    let mut sums = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(current) = folders.pop() {
        let file = StepError::file(&current);
        for entry in fs::read_dir(&current).map_err(&file)? {
            let path = entry.map_err(&file)?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let bytes = fs::read(&path).map_err(StepError::file(&path))?;
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
            let hex = Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
                let _ = write!(hex, "{byte:02x}");
                hex
            });
            sums.insert(name, hex);
        }
    }
    Ok(sums)
}

/// A folder that programs write into. Their paths are below it, so that no output names it.
struct Outputs<'a> {
    program: &'a Path,
    folder: &'a Path,
}

fn make(program: &Path, folder: &Path, study: &Path) -> Result<(), StepError> {
    // Programs are run in another folder than the one their paths were typed in.
    let [program, study] =
        [program, study].map(|path| fs::canonicalize(path).unwrap_or(path.into()));
    fs::create_dir(folder).map_err(StepError::file(folder))?;
    let outputs = Outputs { program: &program, folder };
    outputs.write_inputs()?;
    outputs.build_cubes()?;
    outputs.show_cubes()?;
    outputs.export_cubes()?;
    outputs.bake_pictures()?;
    Outputs { program: &study, folder }.draw_study()
}

impl Outputs<'_> {
    /// An observer, a light and two dyes of our own.
    fn write_inputs(&self) -> Result<(), StepError> {
        let rows = |columns: &dyn Fn(usize) -> String| -> String {
            (300..=830).step_by(5).map(|nm| format!("{nm},{}\n", columns(nm))).collect()
        };
        // A triangle 200 nm wide.
        let bell =
            |nm: usize, peak: usize| 100usize.saturating_sub(nm.abs_diff(peak)) as f64 / 100.0;
        let observer = rows(&|nm| {
            format!("{},{},{}", bell(nm, 600) + bell(nm, 460) / 4.0, bell(nm, 555), bell(nm, 465))
        });
        self.write("inputs/observer.csv", &format!("wavelength_nm,x,y,z\n{observer}"))?;
        let light = rows(&|nm| format!("{}", nm + 1));
        self.write("inputs/light.csv", &format!("wavelength_nm,power\n{light}"))?;
        for (name, peak) in [("green", 480), ("red", 560), ("violet", 380)] {
            let dye = rows(&|nm| format!("{},{}", bell(nm, peak), bell(nm, peak + 50)));
            let text = format!("wavelength_nm,absorption,emission\n{dye}");
            self.write(&format!("inputs/dyes/{name}.csv"), &text)?;
        }
        self.write("inputs/dyes/PROVENANCE.csv", "file,quantum_yield\nred.csv,0.5\n")
    }

    /// Every model with every option of fluorescence, every method, and every meaning of RGB.
    fn build_cubes(&self) -> Result<(), StepError> {
        for options in fluorescences().into_iter().chain(methods()).chain(contracts()) {
            let name = options.replace("--", "").replace([' ', '/', ','], "_");
            self.build(&format!("all/{name}"), 3, &options)?;
        }
        for (name, options) in SAMPLES {
            self.build(name, 5, options)?;
        }
        Ok(())
    }

    fn build(&self, name: &str, resolution: u32, options: &str) -> Result<(), StepError> {
        let cube = format!("cubes/{name}.safetensors");
        self.make_room(&cube)?;
        let args = format!("build --resolution {resolution} --output {cube} {options}");
        self.json(&format!("build/{name}"), &args)
    }

    fn show_cubes(&self) -> Result<(), StepError> {
        for (name, _) in SAMPLES {
            let cube = format!("cubes/{name}.safetensors");
            self.json_and_text(&format!("inspect/{name}"), &format!("inspect {cube}"))?;
            for mode in INTERPOLATIONS {
                let args = format!("verify --points 300 --interpolation {mode} {cube}");
                self.json(&format!("verify/{name}-{mode}"), &args)?;
            }
            for (number, color) in COLORS.into_iter().enumerate() {
                let record = format!("color/{name}-{number}");
                let plot = format!("plots/{name}-{number}");
                self.make_room(&plot)?;
                let args = format!("color {cube} {color} --plot {plot}");
                self.json_and_text(&record, &format!("{args}.svg"))?;
                self.json(&format!("{record}-direct"), &format!("{args}-direct.svg --direct"))?;
                for mode in INTERPOLATIONS {
                    let args = format!("color {cube} {color} --interpolation {mode}");
                    self.json(&format!("{record}-{mode}"), &args)?;
                }
            }
        }
        Ok(())
    }

    fn export_cubes(&self) -> Result<(), StepError> {
        for (name, _) in SAMPLES {
            for format in ["csv", "wgsl", "glsl", "hlsl", "osl", "coeff"] {
                let output = format!("exports/{name}-{format}/{name}.{format}");
                self.make_room(&output)?;
                let resolution = if format == "coeff" { "--resolution 6" } else { "" };
                let args = format!("export cubes/{name}.safetensors {output} {resolution}");
                self.json(&format!("export/{name}-{format}"), &args)?;
            }
        }
        let table = "inspect exports/default-coeff/default.coeff --space acescg";
        self.json_and_text("inspect/coeff", table)
    }

    fn bake_pictures(&self) -> Result<(), StepError> {
        self.json("examples", "examples --out examples")?;
        for cube in ["default", "photon", "dense", "analytic-photon", "reflectance"] {
            for (name, form) in [
                ("material", "material"),
                ("fast", "material --fast"),
                ("float", "material --sample float"),
                ("radiance", "radiance --light D65"),
                ("radiance-a", "radiance --light A --sample float"),
            ] {
                let args = format!("bake cubes/{cube}.safetensors examples --as {form}");
                self.bake(&format!("{cube}-{name}"), "", &args)?;
            }
            // A channel for each pair of bands is slow: one picture.
            let form = "--as spectral --bands 400:700:60";
            let args = format!("bake cubes/{cube}.safetensors examples/chart.exr {form}");
            self.bake(&format!("{cube}-spectral"), "/chart.spectral.exr", &args)?;
        }
        let form = "--as spectral --bands 420:660:80 --sample float";
        let args = format!("bake cubes/default.safetensors examples/chart.exr {form}");
        self.bake("default-spectral-float", "/chart.spectral.exr", &args)?;
        for cube in ["default", "photon", "dense"] {
            let form = "--as spectral --bands 400:700:20 --compact";
            let args = format!("bake cubes/{cube}.safetensors examples {form}");
            self.bake(&format!("{cube}-compact"), "", &args)?;
        }
        // The pictures are in ACEScg, wider than sRGB.
        for repair in ["clip", "scale", "nearest"] {
            let args = format!("bake cubes/srgb.safetensors examples --repair {repair}");
            self.bake(&format!("srgb-{repair}"), "", &args)?;
        }
        for baked in ["default-spectral", "dense-spectral", "default-compact", "photon-compact"] {
            let file = format!("baked/{baked}/chart.spectral.exr");
            self.json_and_text(&format!("lint/{baked}"), &format!("lint {file}"))?;
            for at in ["7,9", "300,200", "420,330"] {
                self.json_and_text(
                    &format!("read/{baked}-{at}"),
                    &format!("read {file} --at {at}"),
                )?;
            }
        }
        self.make_room("texts/check.html")?;
        let check = "check examples --cube cubes/default.safetensors";
        self.json_and_text("check", &format!("{check} --output texts/check.html"))?;
        let heat = "check examples/chart.exr --illuminant A --adapt none --heat-map heat-map.png";
        self.json_and_text("check-heat-map", heat)
    }

    /// Writes a folder named `name`, or one `file` in it.
    fn bake(&self, name: &str, file: &str, args: &str) -> Result<(), StepError> {
        self.json(&format!("bake/{name}"), &format!("{args} --output baked/{name}{file}"))
    }

    fn draw_study(&self) -> Result<(), StepError> {
        self.json("figures", "figures --resolution 4 --out figures")?;
        let correct = "figures --resolution 4 --display correct --only 5 --out figures-correct";
        self.json("figures-correct", correct)?;
        self.make_room("texts/reproduce.md")?;
        self.json("reproduce", "reproduce --resolution 4 --output texts/reproduce.md")
    }

    fn json_and_text(&self, name: &str, args: &str) -> Result<(), StepError> {
        self.json(name, args)?;
        let text = self.output(args)?;
        self.write(&format!("{TEXTS}/{name}.txt"), &text)
    }

    /// Runs the program and keeps its JSON document.
    fn json(&self, name: &str, args: &str) -> Result<(), StepError> {
        let printed = self.output(&format!("{args} --json"))?;
        self.write(&format!("json/{name}.json"), &without_times(&printed))
    }

    /// What the program prints to standard output. Some cubes break a law between their nodes, and
    /// `verify` fails.
    fn output(&self, args: &str) -> Result<String, StepError> {
        let mut command = Command::new(self.program);
        command.args(args.split_whitespace()).arg("--quiet").current_dir(self.folder);
        let shown = || format!("{} {args}", self.program.display());
        let output = command
            .stdin(Stdio::null())
            .output()
            .map_err(|source| StepError::Start { command: shown(), source })?;
        let [mut stdout, stderr] =
            [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        if !output.status.success() {
            if !args.starts_with("verify") || output.status.code() == Some(BAD_USAGE) {
                return Err(StepError::Failed { command: shown(), output: stderr });
            }
            stdout += "a law is broken\n";
        }
        Ok(stdout)
    }

    fn write(&self, path: &str, text: &str) -> Result<(), StepError> {
        self.make_room(path)?;
        let path = self.folder.join(path);
        fs::write(&path, text).map_err(StepError::file(&path))
    }

    /// Makes the folder of a file.
    fn make_room(&self, file: &str) -> Result<(), StepError> {
        let path = self.folder.join(file).parent().map(Path::to_owned).unwrap_or_default();
        fs::create_dir_all(&path).map_err(StepError::file(&path))
    }
}

/// Every list of one word of each group, in order, joined by spaces.
fn product(groups: &[&[&str]]) -> Vec<String> {
    groups.iter().fold(vec![String::new()], |lists, words| {
        let longer = lists.iter().flat_map(|list| words.iter().map(move |word| (list, word)));
        longer.map(|(list, word)| format!("{list} {word}").trim().to_owned()).collect()
    })
}

fn fluorescences() -> Vec<String> {
    let mixing: &[&str] = &["", "--mixing separate"];
    let accounting: &[&str] = &["", "--accounting photon"];
    let density: &[&str] = &["", "--optical-density 1.5"];
    let sets: &[&str] = &["", "--dyes open8", "--dyes wide14", "--dyes inputs/dyes"];
    let yields: &[&str] = &["", "--quantum-yield 0.5", "--quantum-yield measured"];
    let bells: &[&str] = &["", "--absorption-fwhm-nm 30 --emission-fwhm-nm 60"];
    let dyes = product(&[&["--model dyes"], sets, mixing, accounting, yields, density]);
    let analytic = product(&[&["--model analytic"], bells, accounting, &yields[..2]]);
    dyes.into_iter().chain(analytic).collect()
}

fn methods() -> Vec<String> {
    product(&[
        &["--method search", "--method exhaustive", "--method seed", "--method seed-features"],
        &["--metric de76", "--metric rgb", "--metric de2000 --sweeps 3"],
        &["", "--mixing separate", "--model analytic", "--model reflectance"],
    ])
}

fn contracts() -> Vec<String> {
    let mut contracts = product(&[
        &[
            "--space acescg",
            "--space aces2065-1",
            "--space rec2020",
            "--space p3-d65",
            "--space srgb",
            "--space prophoto",
            "--space adobe-rgb",
            "--space xyz",
            "--space 0.7,0.29,0.2,0.7,0.15,0.05,0.3127,0.329",
        ],
        &["--illuminant D65", "--illuminant A", "--illuminant inputs/light.csv --adapt none"],
    ]);
    contracts.extend(product(&[
        &["--observer inputs/observer.csv"],
        &["--illuminant D60", "--illuminant D55", "--illuminant D50", "--illuminant E"],
        &["--slope-max-per-nm none", "--slope-max-per-nm 0.003", "--model analytic"],
    ]));
    contracts
}

/// A JSON document with 0 for the seconds that a run took.
fn without_times(json: &str) -> String {
    let mut parts = json.split(TIME_KEY);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find([',', '}']).unwrap_or(part.len());
        text += TIME_KEY;
        text += "0";
        text += &part[end..];
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_no_product() {
        assert_eq!(
            without_times(r#"{"time_s":1.25,"n":2}{"time_s":3}"#),
            r#"{"time_s":0,"n":2}{"time_s":0}"#
        );
        assert_eq!(without_times("{}"), "{}");
    }

    #[test]
    fn texts_may_differ_and_products_may_not() {
        let files = |list: &[(&str, &str)]| {
            list.iter().map(|&(path, sum)| (path.to_owned(), sum.to_owned())).collect()
        };
        let old = files(&[("a", "1"), ("b", "1"), ("texts/c", "1")]);
        let new = files(&[("a", "2"), ("texts/c", "2"), ("d", "1")]);
        let change = |path: &str, what, is_product| Change { path: path.into(), what, is_product };
        let expected = [
            change("b", "is missing", true),
            change("a", "differs", true),
            change("d", "is new", true),
            change("texts/c", "differs", false),
        ];
        assert_eq!(changes(&old, &new), expected);
    }

    #[test]
    fn a_product_of_options_has_every_combination() {
        let options = product(&[&["", "a"], &["b", "c"]]);
        assert_eq!(options, ["b", "c", "a b", "a c"]);
    }
}
