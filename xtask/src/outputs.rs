//! `cargo xtask outputs`: every product of a program at a small size, to compare two programs.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use sha2::{Digest as _, Sha256};

use crate::step::StepError;

/// The folder of texts for people, which may differ.
const TEXTS: &str = "texts";

/// Key of a run's duration in JSON documents, which differs from run to run.
const TIME_KEY: &str = "\"time_s\":";

/// Exit status of a program that refuses its options.
const BAD_USAGE: i32 = 2;

/// What is run, and how its output is kept.
const SCRIPT: &str = include_str!("../outputs.txt");

/// Makes the outputs of `program` in `folder`, prints their sums, and compares them with those in
/// `against`; returns whether all products are the same. Figures and the report on the paper come
/// from `study`.
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

fn make(program: &Path, folder: &Path, study: &Path) -> Result<(), StepError> {
    // Programs are run in another folder than the one their paths were typed in.
    let [program, study] =
        [program, study].map(|path| fs::canonicalize(path).unwrap_or(path.into()));
    fs::create_dir(folder).map_err(StepError::file(folder))?;
    let outputs = Outputs { program: &program, folder };
    outputs.write_inputs()?;
    for Run { kind, name, args } in runs(SCRIPT) {
        match kind.as_str() {
            "study" => Outputs { program: &study, folder }.json(&name, &args)?,
            _ => outputs.json(&name, &args)?,
        }
        if kind == "both" {
            outputs.write(&format!("{TEXTS}/{name}.txt"), &outputs.output(&args)?)?;
        }
    }
    Ok(())
}

/// One run of a program.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    /// How its output is kept, by the words of `outputs.txt`.
    kind: String,
    /// Under which name.
    name: String,
    args: String,
}

/// The choices of one name: the word of each, and its options.
type Choices<'a> = Vec<(String, &'a str)>;

/// Every run of a script, in order.
fn runs(script: &str) -> Vec<Run> {
    let mut choices: BTreeMap<&str, Choices<'_>> = BTreeMap::new();
    let mut runs = Vec::new();
    for line in script.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if let Some((name, list)) = line.strip_prefix('$').and_then(|rest| rest.split_once(" =")) {
            choices.insert(name, list.split('|').map(str::trim).map(choice_of).collect());
            continue;
        }
        for expanded in expanded(line, &choices, "") {
            let (kind, rest) = expanded.split_once(' ').expect("a line has a kind");
            let (name, args) = rest.split_once(": ").expect("a line has a name and arguments");
            runs.push(Run { kind: kind.into(), name: name.into(), args: args.into() });
        }
    }
    runs
}

/// The word of a choice, and its options: the same but for blanks, unless it states both.
fn choice_of(choice: &str) -> (String, &str) {
    match choice.split_once('=') {
        Some((word, options)) => (word.to_owned(), options),
        None => (word(choice), choice),
    }
}

/// Options as one word.
fn word(options: &str) -> String {
    let words: Vec<&str> = options.split_whitespace().collect();
    words.join("_").replace("--", "").replace(['/', ','], "_")
}

/// A line with every choice in place of each name; `options` are those that were put in before.
fn expanded(line: &str, choices: &BTreeMap<&str, Choices<'_>>, options: &str) -> Vec<String> {
    let Some(start) = line.find(['$', '%']) else { return vec![line.replace('@', &word(options))] };
    let name = &line[start + 1..];
    let name = &name[..name.find(|c: char| !c.is_alphanumeric()).unwrap_or(name.len())];
    let with = |(word, chosen): &(String, &str)| {
        let line = line.replace(&format!("${name}"), word).replace(&format!("%{name}"), chosen);
        expanded(&line, choices, &format!("{options} {chosen}"))
    };
    choices[name].iter().flat_map(with).collect()
}

/// A folder that programs write into. Their paths are below it, so that no output names it.
struct Outputs<'a> {
    program: &'a Path,
    folder: &'a Path,
}

impl Outputs<'_> {
    /// An observer, a light, three dyes, a measured matrix and a list of colors as CSV files.
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
        self.write(
            "inputs/colors.csv",
            "name,r,g,b\nwhite,1,1,1\nmagenta,0.9,0,0.9\n,0.3,0.4,0.2\n",
        )?;
        let axis = |first: usize| (first..=780).step_by(20);
        let shares = |out: usize| -> String {
            let share = |nm: usize| match out.cmp(&nm) {
                Ordering::Less => 0.0,
                Ordering::Equal => 0.2 + bell(nm, 640) / 2.0,
                Ordering::Greater => bell(nm, 480) * bell(out, 560) / 20.0,
            };
            axis(300).map(|nm| format!(",{}", share(nm))).collect()
        };
        let head: String = axis(300).map(|nm| format!(",{nm}")).collect();
        let rows_of_matrix: String =
            axis(380).map(|out| format!("{out}{}\n", shares(out))).collect();
        let matrix = format!("outgoing_nm\\incident_nm per_band{head}\n{rows_of_matrix}");
        self.write("inputs/matrix.csv", &matrix)?;
        for (name, peak) in [("green", 480), ("red", 560), ("violet", 380)] {
            let dye = rows(&|nm| format!("{},{}", bell(nm, peak), bell(nm, peak + 50)));
            let text = format!("wavelength_nm,absorption,emission\n{dye}");
            self.write(&format!("inputs/dyes/{name}.csv"), &text)?;
        }
        self.write("inputs/dyes/PROVENANCE.csv", "file,quantum_yield\nred.csv,0.5\n")
    }

    /// Runs the program and keeps its JSON document.
    fn json(&self, name: &str, args: &str) -> Result<(), StepError> {
        let printed = self.output(&format!("{args} --json"))?;
        self.write(&format!("json/{name}.json"), &without_times(&printed))
    }

    /// What the program prints to standard output. Some cubes break a law between their nodes, and
    /// `verify` fails.
    fn output(&self, args: &str) -> Result<String, StepError> {
        // Programs do not make the folders of the files that they write.
        for path in args.split_whitespace().filter(|word| word.contains('/')) {
            self.make_room(path)?;
        }
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
    fn a_line_runs_once_for_each_combination_of_choices() {
        let script = "# a\n$b = |--c d\n$e = f=--g|h\njson @/$e: x %b %e cubes/$e\nboth y: z\n";
        let run = |kind: &str, name: &str, args: &str| Run {
            kind: kind.into(),
            name: name.into(),
            args: args.into(),
        };
        let expected = [
            run("json", "g/f", "x  --g cubes/f"),
            run("json", "g_c_d/f", "x --c d --g cubes/f"),
            run("json", "h/h", "x  h cubes/h"),
            run("json", "h_c_d/h", "x --c d h cubes/h"),
            run("both", "y", "z"),
        ];
        let found = runs(script);
        assert_eq!(found.len(), expected.len());
        assert!(expected.iter().all(|run| found.contains(run)), "{found:?}");
    }

    #[test]
    fn no_two_runs_have_one_name() {
        let mut names: Vec<String> = runs(SCRIPT).into_iter().map(|run| run.name).collect();
        assert!(names.len() > 500, "{}", names.len());
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
