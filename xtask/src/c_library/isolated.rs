//! The static library without the symbols of Rust's standard library.
//!
//! Two static libraries in Rust define the same global symbols, such as `rust_eh_personality`, and a program that
//! links both fails. So all objects are linked into one, in which only the functions of the header stay global.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{StepError, finish, output_of};

/// The names that stay global.
const KEPT: &str = "upglow_*";

/// Sections of bitcode, newer than what the system's tools read. No linker wants them.
const BITCODE: [&str; 2] = [".llvmbc", ".llvmcmd"];

/// Makes the library `to` of the static library `from`; its other files are written aside it and removed.
pub(super) fn isolate(from: &Path, to: &Path) -> Result<(), StepError> {
    let aside = |ending: &str| to.with_extension(ending);
    let (whole, kept, library) = (aside("whole.o"), aside("o"), aside("isolated.a"));
    let made = link(from, &whole).and_then(|()| localize(&whole, &kept)).and_then(|()| {
        let mut archive = Command::new("ar");
        archive.arg("crs").args([&library, &kept]);
        finish(archive)?;
        fs::rename(&library, to).map_err(StepError::file(to))
    });
    for path in [whole, kept, library] {
        // What is left beside the library does no harm.
        fs::remove_file(path).ok();
    }
    made
}

/// Links all objects of a library into one.
fn link(library: &Path, object: &Path) -> Result<(), StepError> {
    let mut linker = Command::new("ld");
    linker.args(["-r", "--whole-archive", "-o"]).args([object, library]);
    finish(linker)
}

fn localize(object: &Path, kept: &Path) -> Result<(), StepError> {
    let Tool { program, libraries } = Tool::find()?;
    let mut copy = Command::new(program);
    copy.env("LD_LIBRARY_PATH", libraries);
    copy.args(["--wildcard", &format!("--keep-global-symbol={KEPT}")]);
    copy.args(BITCODE.map(|section| format!("--remove-section={section}")));
    copy.args([object, kept]);
    finish(copy)
}

/// The compiler's own `objcopy`, which reads what the compiler writes.
struct Tool {
    program: PathBuf,
    libraries: PathBuf,
}

impl Tool {
    fn find() -> Result<Self, StepError> {
        let print = |what| {
            let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
            let mut command = Command::new(rustc);
            command.args(["--print", what]);
            output_of(command).map(|path| PathBuf::from(path.trim()))
        };
        let program = print("target-libdir")?.with_file_name("bin").join("rust-objcopy");
        if !program.is_file() {
            let path = program.display();
            return Err(StepError::found(format!(
                "no {path}, expected the one that rustup installs"
            )));
        }
        Ok(Self { program, libraries: print("sysroot")?.join("lib") })
    }
}
