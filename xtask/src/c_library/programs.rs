//! C and C++ programs against the installed library: compiled, run, compared with `upglow color`.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::agreement::differences;
use super::install::{Installed, LIB, install};
use super::{FOLDER, scratch};
use crate::step::{StepError, finish, json_of, output_of, read, release_bin_dir};

/// A gray, and two colors that need fluorescence.
const COLORS: [[&str; 3]; 3] =
    [["0.4", "0.4", "0.4"], ["0.05", "0.9", "0.1"], ["0.9", "0.05", "0.8"]];

/// Enough for a cube with every kind of node, and built in less than a second.
const RESOLUTION: &str = "8";

/// Warnings are for the header as much as for the programs.
const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"];

/// Every byte that was not freed is an error, reachable or not.
const VALGRIND: [&str; 5] = [
    "--quiet",
    "--error-exitcode=99",
    "--leak-check=full",
    "--show-leak-kinds=all",
    "--errors-for-leak-kinds=all",
];

/// A program in the sources.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Program {
    source: &'static str,
    language: Language,
    /// Whether it takes a color after the cube.
    takes_color: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Language {
    C,
    Cxx,
}

const RENDER: Program =
    Program { source: "examples/render.c", language: Language::C, takes_color: true };
const SAMPLING: Program =
    Program { source: "examples/sampling.cpp", language: Language::Cxx, takes_color: true };
const HOSTILE: Program =
    Program { source: "tests/hostile.c", language: Language::C, takes_color: false };

#[derive(Clone, Copy, Debug, PartialEq)]
enum Linking {
    Static,
    Shared,
}

impl Language {
    /// The compiler, if there is one.
    fn compiler(self) -> Option<OsString> {
        let (variable, usual) = match self {
            Self::C => ("CC", "cc"),
            Self::Cxx => ("CXX", "c++"),
        };
        let compiler = env::var_os(variable).unwrap_or_else(|| usual.into());
        is_there(&compiler).then_some(compiler)
    }

    fn standard(self) -> &'static str {
        match self {
            Self::C => "-std=c11",
            Self::Cxx => "-std=c++17",
        }
    }
}

/// Skips a step without the compilers or one of these tools.
fn need(tools: &[&str]) -> Result<(), StepError> {
    let reason = if Language::C.compiler().is_none() {
        "no C compiler, neither $CC nor cc"
    } else if Language::Cxx.compiler().is_none() {
        "no C++ compiler, neither $CXX nor c++"
    } else {
        match tools.iter().find(|tool| !is_there(&OsString::from(tool))) {
            None => return Ok(()),
            Some(&"valgrind") => "valgrind not installed",
            Some(&"pkg-config") => "pkg-config not installed",
            Some(&"cmake") => "cmake not installed",
            Some(_) => "a tool is not installed",
        }
    };
    Err(StepError::Skipped(reason))
}

fn is_there(tool: &OsString) -> bool {
    Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Static and shared, each as a user would link it.
pub(super) fn run(root: &Path) -> Result<(), StepError> {
    need(&[])?;
    let bench = Bench::new(root)?;
    bench.run_readme()?;
    bench.run_all(&[])
}

pub(super) fn run_valgrind(root: &Path) -> Result<(), StepError> {
    need(&["valgrind"])?;
    Bench::new(root)?.run_all(&[&["valgrind"], &VALGRIND[..]].concat())
}

pub(super) fn run_pkg_config(root: &Path) -> Result<(), StepError> {
    need(&["pkg-config"])?;
    // As on Debian, whose libraries of several processors lie beside each other.
    let bench = Bench::with_libraries_in(root, "lib/of-a-processor")?;
    for package in ["upglow", "upglow-static"] {
        let mut query = Command::new("pkg-config");
        query.args(["--cflags", "--libs", package]);
        query.env("PKG_CONFIG_PATH", bench.installed.lib.join("pkgconfig"));
        let flags = output_of(query)?;
        let executable = bench.folder.join(format!("render-{package}"));
        let mut compile = bench.compiler(RENDER, &executable);
        compile.args(flags.split_whitespace()).arg(bench.run_path());
        finish(compile)?;
        bench.run_with_colors(RENDER, &executable, &[])?;
    }
    Ok(())
}

pub(super) fn run_cmake(root: &Path) -> Result<(), StepError> {
    need(&["cmake"])?;
    let bench = Bench::new(root)?;
    let build = bench.folder.join("cmake");
    let prefix = bench.folder.join("prefix");
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(bench.sources.join("examples")).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    finish(configure)?;
    let mut compile = Command::new("cmake");
    compile.arg("--build").arg(&build);
    finish(compile)?;
    for linking in ["static", "shared"] {
        bench.run_with_colors(RENDER, &build.join(format!("render_{linking}")), &[])?;
        bench.run_with_colors(SAMPLING, &build.join(format!("sampling_{linking}")), &[])?;
    }
    Ok(())
}

/// The compiler with all but what the library needs.
fn compiler(language: Language, source: &Path, executable: &Path) -> Command {
    let mut compile = Command::new(language.compiler().unwrap_or_default());
    compile.arg(language.standard()).args(WARNINGS).arg(source).arg("-o").arg(executable);
    compile
}

/// The first block of C in Markdown.
fn first_program(markdown: &str) -> Option<&str> {
    let (_, rest) = markdown.split_once("```c\n")?;
    rest.split_once("```").map(|(program, _)| program)
}

/// The library installed, the program built, a cube made.
#[derive(Clone, Debug)]
struct Bench {
    sources: PathBuf,
    folder: PathBuf,
    installed: Installed,
    /// The program that has the last word.
    upglow: PathBuf,
    cube: PathBuf,
}

impl Bench {
    fn new(root: &Path) -> Result<Self, StepError> {
        Self::with_libraries_in(root, LIB)
    }

    /// With the libraries in this folder below the prefix.
    fn with_libraries_in(root: &Path, lib: &str) -> Result<Self, StepError> {
        let folder = scratch(root)?;
        let installed = install(root, &folder.join("prefix"), lib)?;
        fs::create_dir_all(&folder).map_err(StepError::file(&folder))?;
        let upglow = release_bin_dir(root)?.join("upglow");
        let cube = folder.join("cube.safetensors");
        let mut build = Command::new(&upglow);
        build.args(["build", "--quiet", "--resolution", RESOLUTION, "--output"]).arg(&cube);
        finish(build)?;
        Ok(Self { sources: root.join(FOLDER), folder, installed, upglow, cube })
    }

    /// Runs every program, each after the words of `before`.
    fn run_all(&self, before: &[&str]) -> Result<(), StepError> {
        for linking in [Linking::Static, Linking::Shared] {
            for program in [RENDER, SAMPLING, HOSTILE] {
                let executable = self.compiled(program, linking)?;
                if program.takes_color {
                    self.run_with_colors(program, &executable, before)?;
                } else {
                    finish(self.command(&executable, before))?;
                }
            }
        }
        Ok(())
    }

    fn compiled(&self, program: Program, linking: Linking) -> Result<PathBuf, StepError> {
        let name = Path::new(program.source).file_stem().unwrap_or_default().to_string_lossy();
        let executable = self.folder.join(format!("{name}-{linking:?}").to_lowercase());
        let compile = self.compiler(program, &executable);
        finish(self.linked(compile, linking))?;
        Ok(executable)
    }

    /// A compiler's command with the library.
    fn linked(&self, mut compile: Command, linking: Linking) -> Command {
        compile.arg("-I").arg(&self.installed.include);
        match linking {
            Linking::Static => {
                compile.arg(self.installed.lib.join("libupglow.a"));
                compile.args(&self.installed.native_libraries);
            }
            Linking::Shared => {
                compile.arg("-L").arg(&self.installed.lib).args(["-lupglow", "-pthread"]);
                compile.arg(self.run_path());
            }
        }
        compile
    }

    /// The first program of the README, beside a cube of the name that it opens.
    fn run_readme(&self) -> Result<(), StepError> {
        let path = self.sources.join("README.md");
        let text = read(&path)?;
        let program = first_program(&text).ok_or_else(|| {
            StepError::found(format!("{}: no block of C, expected one", path.display()))
        })?;
        let file = StepError::file(&self.folder);
        let (source, executable) = (self.folder.join("first.c"), self.folder.join("first"));
        fs::write(&source, program).map_err(&file)?;
        fs::copy(&self.cube, self.folder.join("acescg.safetensors")).map_err(file)?;
        let compile = compiler(Language::C, &source, &executable);
        finish(self.linked(compile, Linking::Static))?;
        let mut run = Command::new(&executable);
        run.current_dir(&self.folder);
        finish(run)
    }

    /// The compiler with all but what the library needs.
    fn compiler(&self, Program { source, language, .. }: Program, executable: &Path) -> Command {
        compiler(language, &self.sources.join(source), executable)
    }

    /// Where programs find the shared library when they start.
    fn run_path(&self) -> String {
        format!("-Wl,-rpath,{}", self.installed.lib.display())
    }

    fn command(&self, executable: &Path, before: &[&str]) -> Command {
        let mut words = before.iter().map(OsString::from).chain([executable.into()]);
        let mut command = Command::new(words.next().unwrap_or_default());
        command.args(words).arg(&self.cube);
        command
    }

    fn run_with_colors(
        &self,
        program: Program,
        executable: &Path,
        before: &[&str],
    ) -> Result<(), StepError> {
        for color in COLORS {
            let mut command = self.command(executable, before);
            command.args(color);
            let printed = output_of(command)?;
            if program == RENDER {
                self.compare(executable, color, &printed)?;
            }
        }
        Ok(())
    }

    /// The program and `upglow color` must say the same.
    fn compare(&self, executable: &Path, color: [&str; 3], printed: &str) -> Result<(), StepError> {
        let mut command = Command::new(&self.upglow);
        command.args(["color", "--json"]).arg(&self.cube).args(color);
        let mut problems = differences(printed, &json_of(command)?);
        if problems.is_empty() {
            return Ok(());
        }
        problems.insert(0, format!("{} {}:", executable.display(), color.join(" ")));
        Err(StepError::Found(problems))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_program_is_the_first_block_of_c() {
        let text = "a\n```sh\nls\n```\nb\n```c\nint x;\n```\n```c\nint y;\n```\n";
        assert_eq!(first_program(text), Some("int x;\n"));
        assert_eq!(first_program("```c\nint x;"), None);
    }
}
