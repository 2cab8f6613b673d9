//! The project's own commands; run `cargo xtask` for the list.
//!
//! `tables` turns `tables/*.csv` into committed Rust; `check` is the gate, the same on every
//! machine and in `.ci/run`.

use std::path::Path;
use std::process::ExitCode;

mod bench;
mod c_library;
mod check;
mod count;
mod layers;
mod llvm;
mod mitsuba;
mod outputs;
mod python;
mod python_wheel;
mod readme;
mod tables;

const USAGE: &str = "\
usage: cargo xtask tables          write crates/upglow-color/src/tables from tables/*.csv
       cargo xtask check [--slow]  run every check; --slow adds the tests named slow_*
       cargo xtask bench           run every bench and write docs/PERFORMANCE.md
       cargo xtask header          write bindings/c/include/upglow.h from bindings/c/src
       cargo xtask install-c DIR   install the C library, its header, and files for pkg-config
                                   and CMake below DIR
       cargo xtask test-c          run the checks of the C library
       cargo xtask test-python     build the Python package's wheel and run its tests
       cargo xtask test-mitsuba    build the plugins for Mitsuba 3 and run their tests
       cargo xtask count [FOLDER]  count source lines, public names and the program's crates, here or
                                   in another checkout
       cargo xtask outputs PROGRAM FOLDER [--study PROGRAM] [--against OLDFOLDER]
                                   make every product of an `upglow` executable in the new
                                   FOLDER, at small sizes, and print the SHA-256 of each; --study draws the
                                   figures with another executable; --against says which
                                   products differ from those in OLDFOLDER";

/// Exit status on bad usage; 1 is a check that failed.
const BAD_USAGE: u8 = 2;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace");
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["tables"] => tables(root),
        ["bench"] => bench::run(root),
        ["header"] => header(root),
        ["install-c", prefix] => install_c(root, Path::new(prefix)),
        ["test-c"] => check::run_steps(root, c_library::STEPS),
        ["test-python"] => check::run_steps(root, python_wheel::STEPS),
        ["test-mitsuba"] => check::run_steps(root, mitsuba::STEPS_WITH_PACKAGE),
        ["count"] => count(root),
        ["count", folder] => count(Path::new(folder)),
        ["outputs", program, folder, ref options @ ..] => outputs(program, folder, options),
        ["check"] => check::run(root, check::Tests::Quick),
        ["check", "--slow"] => check::run(root, check::Tests::QuickAndSlow),
        _ => {
            eprintln!("{USAGE}");
            ExitCode::from(BAD_USAGE)
        }
    }
}

fn tables(root: &Path) -> ExitCode {
    let files = match tables::generate(root) {
        Ok(files) => files,
        Err(error) => return fail(&error),
    };
    match tables::write(root, &files) {
        Ok(changed) => {
            println!("tables: {} files, {changed} changed", files.len());
            ExitCode::SUCCESS
        }
        Err(error) => fail(&error),
    }
}

fn header(root: &Path) -> ExitCode {
    match c_library::write_header(root) {
        Ok(changed) => {
            println!("header: {}", if changed { "changed" } else { "unchanged" });
            ExitCode::SUCCESS
        }
        Err(error) => fail(&error),
    }
}

fn install_c(root: &Path, prefix: &Path) -> ExitCode {
    match c_library::install(root, prefix) {
        Ok(installed) => {
            println!("install-c: {}, {}", installed.include.display(), installed.lib.display());
            ExitCode::SUCCESS
        }
        Err(error) => fail(&error),
    }
}

fn count(folder: &Path) -> ExitCode {
    match count::count(folder) {
        Ok(count) => {
            println!("{count}");
            ExitCode::SUCCESS
        }
        Err(error) => fail(&error),
    }
}

fn outputs(program: &str, folder: &str, mut options: &[&str]) -> ExitCode {
    let (mut study, mut against) = (program, None);
    while let [option, value, rest @ ..] = options {
        match *option {
            "--study" => study = value,
            "--against" => against = Some(Path::new(value)),
            _ => break,
        }
        options = rest;
    }
    if !options.is_empty() {
        eprintln!("{USAGE}");
        return ExitCode::from(BAD_USAGE);
    }
    let [program, folder, study] = [program, folder, study].map(Path::new);
    outputs::run(program, folder, study, against).unwrap_or_else(|error| fail(&error))
}

fn fail(error: &dyn std::error::Error) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}
