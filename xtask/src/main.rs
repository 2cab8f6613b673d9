//! The project's own commands; run `cargo xtask help` for the list.
//!
//! `tables` turns `tables/*.csv` into committed Rust; `check` is the gate, the same on every
//! machine and in `.ci/run`.

use std::path::Path;
use std::process::{Command, ExitCode};

use step::StepError;

mod bench;
mod c_library;
mod check;
mod count;
mod explorer;
mod fuzz;
mod guide;
mod layers;
mod links;
mod llvm;
mod outputs;
mod packages;
mod python;
mod python_wheel;
mod sbom;
mod site;
mod step;
mod tables;
mod words;

const HELP: &str = "\
usage: cargo xtask COMMAND

  check            run every step of the check, up to the first that fails
      --list           print the steps
      --only STEP      run this step; may be given several times
      --from STEP      run this step and those after it
      --keep-going     run the others after a failure too
      --slow           add the tests named slow_*
  test-c           run the steps about the C library
  test-python      build the Python package's wheel and run its tests
  tables           write crates/upglow-color/src/tables from tables/*.csv
  header           write bindings/c/include/upglow.h from bindings/c/src
  memory [UPGLOW]  print the peak memory of each command for pictures of 1, 4 and 16 megapixels in every
                   format, with this executable or a new one
  bench            run every bench and write docs/PERFORMANCE.md
  install-c DIR    install the C library, its header, and files for pkg-config and CMake below DIR
      --libdir LIB     with the libraries in DIR/LIB, for example lib/x86_64-linux-gnu, instead of DIR/lib
  site             make target/site/book from the pages of this repository, with mdBook
  sbom FILE        write the packages of Cargo.lock to FILE as a CycloneDX document
  notices FILE     write the terms of all packages by others in the programs and libraries to FILE
  count [FOLDER]   count source lines, public names and the program's crates, here or in FOLDER
  outputs PROGRAM FOLDER
                   make every product of the executable PROGRAM, an `upglow` of any commit, in the
                   new FOLDER, at small sizes, and print the SHA-256 of each
      --study PROGRAM  draw the figures with this executable
      --against OLD    say which products differ from those in the folder OLD; exit 1 if any does
  help             print this";

/// Exit status on bad usage; 1 is a check that failed.
const BAD_USAGE: u8 = 2;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace");
    let args: Vec<String> = std::env::args().skip(1).collect();
    match run(root, &args.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            match error {
                StepError::Usage(_) => ExitCode::from(BAD_USAGE),
                _ => ExitCode::FAILURE,
            }
        }
    }
}

/// Runs one command; whether all is well.
fn run(root: &Path, args: &[&str]) -> Result<bool, StepError> {
    match args {
        ["check", options @ ..] => return check::run(root, options),
        ["test-c"] => return Ok(check::run_steps(root, &c_library::STEPS, false)),
        ["test-python"] => return Ok(check::run_steps(root, &python_wheel::STEPS, false)),
        ["outputs", program, folder, options @ ..] => return outputs(program, folder, options),
        ["tables"] => tables::write(root)?,
        ["memory"] => memory(root, None)?,
        ["memory", program] => memory(root, Some(Path::new(program)))?,
        ["bench"] => bench::run(root)?,
        ["header"] => c_library::write_header(root)?,
        ["install-c", prefix, options @ ..] => {
            let lib = match options {
                [] => c_library::LIB,
                ["--libdir", lib] => lib,
                _ => {
                    return Err(StepError::Usage(
                        "install-c: expected DIR, and --libdir LIB".into(),
                    ));
                }
            };
            let installed = c_library::install(root, Path::new(prefix), lib)?;
            println!("install-c: {}, {}", installed.include.display(), installed.lib.display());
        }
        ["site"] => println!("site: {}", site::build(root)?.join("index.html").display()),
        ["notices", file] => {
            println!("notices: {} packages", sbom::write_notices(root, Path::new(file))?);
        }
        ["sbom", file] => println!("sbom: {} packages", sbom::write(root, Path::new(file))?),
        ["count"] => println!("{}", count::count(root)?),
        ["count", folder] => println!("{}", count::count(Path::new(folder))?),
        ["help" | "--help" | "-h"] => println!("{HELP}"),
        [] => return Err(StepError::Usage(format!("no command, expected {}", commands()))),
        [command, ..] => {
            let problem = if commands().split(", ").any(|known| known == *command) {
                format!("{command}: wrong arguments; `cargo xtask help` lists them")
            } else {
                format!("no command {command}, expected {}", commands())
            };
            return Err(StepError::Usage(problem));
        }
    }
    Ok(true)
}

/// The names of the commands, as the help lists them.
fn commands() -> String {
    let lines = HELP.lines().filter_map(|line| line.strip_prefix("  "));
    let names = lines.filter(|line| !line.starts_with(' ')).filter_map(|l| l.split(' ').next());
    names.collect::<Vec<_>>().join(", ")
}

/// Sides of the pictures that memory is measured with.
const SIDES: [&str; 3] = ["1024", "2048", "4096"];

fn memory(root: &Path, program: Option<&Path>) -> Result<(), StepError> {
    let program = match program {
        Some(program) => program.to_owned(),
        None => step::release_bin_dir(root)?.join("upglow"),
    };
    let mut command = Command::new(python::prepare(root)?);
    command.arg(root.join("xtask/memory.py")).arg(program);
    command.arg(step::target_dir(root)?.join("memory")).args(SIDES);
    step::finish_aloud(command)
}

fn outputs(program: &str, folder: &str, mut options: &[&str]) -> Result<bool, StepError> {
    let (mut study, mut against) = (program, None);
    while let [option, rest @ ..] = options {
        match (*option, rest.first()) {
            ("--study", Some(value)) => study = value,
            ("--against", Some(value)) => against = Some(Path::new(*value)),
            _ => {
                let problem = format!("outputs: {option}, expected --study PROGRAM, --against OLD");
                return Err(StepError::Usage(problem));
            }
        }
        options = &rest[1..];
    }
    outputs::run(Path::new(program), Path::new(folder), Path::new(study), against)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(args: &[&str]) -> String {
        run(Path::new("."), args).unwrap_err().to_string()
    }

    #[test]
    fn an_unknown_command_names_the_choices() {
        assert!(error(&["chekc"]).starts_with("no command chekc, expected check, test-c, "));
        assert!(error(&[]).starts_with("no command, expected check, "));
        assert_eq!(
            error(&["tables", "x"]),
            "tables: wrong arguments; `cargo xtask help` lists them"
        );
        let outputs = error(&["outputs", "a", "b", "--with"]);
        assert_eq!(outputs, "outputs: --with, expected --study PROGRAM, --against OLD");
    }

    #[test]
    fn help_is_a_success() {
        assert!(run(Path::new("."), &["help"]).unwrap());
    }
}
