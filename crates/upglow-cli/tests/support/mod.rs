//! A temporary folder in which tests run the program.
#![expect(dead_code, reason = "each test file uses its part")]
#![expect(clippy::unwrap_used, reason = "a test that cannot start has failed")]

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

/// The result of a run of the program.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) status: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// A temporary folder, deleted when dropped.
pub(crate) struct Folder(tempfile::TempDir);

/// The program's path.
pub(crate) fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("upglow").into()
}

/// The program, which signals stop even where these tests were started to ignore them, as under `nohup`.
pub(crate) fn stoppable() -> std::process::Command {
    let mut command = std::process::Command::new("env");
    command.arg("--default-signal=INT,TERM,HUP").arg(program());
    command
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path().join(name)).unwrap()
    }

    /// The names of everything in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.unwrap().file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }

    /// Runs the program with these arguments, separated by blanks.
    pub(crate) fn run(&self, words: &str) -> Run {
        let output = Command::new(program())
            .args(words.split_whitespace())
            .current_dir(self.path())
            .output()
            .unwrap();
        Run {
            status: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs the program, which must succeed and print nothing on standard error.
    pub(crate) fn done(&self, words: &str) -> String {
        let run = self.run(words);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{words}");
        run.stdout
    }

    /// As [`Folder::done`], for `--json`.
    pub(crate) fn json(&self, words: &str) -> Value {
        serde_json::from_str(&self.done(&format!("--json {words}"))).unwrap()
    }

    /// As [`Folder::json`], for a command on a single picture: the report on that.
    pub(crate) fn picture(&self, words: &str) -> Value {
        let mut told = self.json(words);
        assert_eq!(told["pictures"].as_array().map(Vec::len), Some(1), "{words}: {told}");
        told["pictures"][0].take()
    }

    /// Runs the program, which must fail with this status and one line, and change no file.
    pub(crate) fn refused(&self, status: i32, words: &str) -> String {
        let before = self.names();
        let run = self.run(words);
        assert_eq!((run.status, run.stdout.as_str()), (status, ""), "{words}: {}", run.stderr);
        assert_eq!(self.names(), before, "{words}");
        one_line(&run.stderr)
    }
}

/// The only line of an error message, without the program's name.
pub(crate) fn one_line(stderr: &str) -> String {
    let line = stderr.strip_prefix("upglow: ").and_then(|rest| rest.strip_suffix('\n'));
    let line = line.unwrap_or_else(|| panic!("not a line of upglow: {stderr:?}"));
    assert!(!line.contains('\n'), "more than one line: {stderr:?}");
    line.to_owned()
}

/// A file of curves over 300 to 830 nm in steps of 5 nm; `row` returns the cells after each wavelength.
pub(crate) fn curves(columns: &str, row: impl Fn(u32) -> String) -> String {
    let rows = (300..=830).step_by(5).map(|nm| format!("{nm},{}\n", row(nm)));
    format!("wavelength_nm,{columns}\n{}", rows.collect::<String>())
}

/// A file of a dye that absorbs around one wavelength and emits 30 nm above it.
pub(crate) fn dye(peak_nm: u32) -> String {
    curves("absorption,emission", |nm| {
        let bell = |center: u32| (-(f64::from(nm) - f64::from(center)).powi(2) / 800.0).exp();
        format!("{:.6},{:.6}", bell(peak_nm), bell(peak_nm + 30))
    })
}

/// A file of an observer: a bell curve each for long, middle and short wavelengths, 385 to 780 nm.
pub(crate) fn eye() -> String {
    let rows = (385..=780).step_by(5).map(|nm| {
        let bell = |center: f64| (-(f64::from(nm) - center).powi(2) / 2500.0).exp();
        format!("{nm},{:.6},{:.6},{:.6}\n", bell(600.0), bell(555.0), bell(450.0))
    });
    format!("wavelength_nm,x,y,z\n{}", rows.collect::<String>())
}
