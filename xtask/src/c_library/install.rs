//! Installing the library below a prefix: header, libraries, and files for other build systems.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::FOLDER;
use super::isolated::isolate;
use crate::sbom::write_notices;
use crate::step::{StepError, cargo, finish, output_and_messages_of, read, target_dir};

/// All crates of the workspace have this version.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What was installed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Installed {
    pub(crate) include: PathBuf,
    pub(crate) lib: PathBuf,
    /// What the static library needs of the system, as linker arguments.
    pub(crate) native_libraries: Vec<String>,
}

/// File names of the shared library.
#[derive(Clone, Debug, PartialEq)]
struct SharedNames {
    file: String,
    /// The name that programs load when they start.
    soname: String,
    /// What the linker looks for.
    link: String,
    /// The linker argument that writes `soname` into the library.
    argument: String,
}

impl SharedNames {
    /// `None` on systems that were not tested.
    fn of_this_system() -> Option<Self> {
        let series = series();
        match std::env::consts::OS {
            "linux" => Some(Self {
                file: format!("libupglow.so.{VERSION}"),
                soname: format!("libupglow.so.{series}"),
                link: "libupglow.so".into(),
                argument: format!("-Wl,-soname,libupglow.so.{series}"),
            }),
            "macos" => Some(Self {
                file: format!("libupglow.{VERSION}.dylib"),
                soname: format!("libupglow.{series}.dylib"),
                link: "libupglow.dylib".into(),
                argument: format!("-Wl,-install_name,@rpath/libupglow.{series}.dylib"),
            }),
            _ => None,
        }
    }
}

/// Versions that programs need not be linked again for: while the first number is 0, only those
/// that share the second.
fn series() -> &'static str {
    let end = VERSION.rfind('.').unwrap_or(VERSION.len());
    &VERSION[..end]
}

/// Where libraries are below a prefix, if nothing else is said.
pub(crate) const LIB: &str = "lib";

/// Builds the library and installs it below `prefix`, libraries in the folder `lib` there; each file appears whole.
pub(crate) fn install(root: &Path, prefix: &Path, lib: &str) -> Result<Installed, StepError> {
    let depth = depth_of(lib)?;
    let names = SharedNames::of_this_system().ok_or_else(|| {
        let os = std::env::consts::OS;
        StepError::found(format!("system {os}, expected linux or macos"))
    })?;
    let built = target_dir(root)?.join("release");
    let native_libraries = build_static(root)?;
    build_shared(root, &names)?;
    let prefix = std::path::absolute(prefix).map_err(StepError::file(prefix))?;
    let installed =
        Installed { include: prefix.join("include"), lib: prefix.join(lib), native_libraries };
    let source = root.join(FOLDER);
    let folder_of_libraries = lib;
    let lib = &installed.lib;
    place(&source.join("include/upglow.h"), &installed.include.join("upglow.h"))?;
    let terms = prefix.join("share/licenses/upglow");
    for text in LICENSES {
        place(&source.join(text), &terms.join(text))?;
    }
    write_notices(root, &terms.join("THIRD-PARTY.md"))?;
    let library = lib.join("libupglow.a");
    place(&built.join("libupglow_c.a"), &library)?;
    if std::env::consts::OS == "linux" {
        isolate(&library, &library)?;
    }
    let shared =
        format!("{}upglow_c{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    place(&built.join(shared), &lib.join(&names.file))?;
    alias(&names.file, &lib.join(&names.soname))?;
    alias(&names.soname, &lib.join(&names.link))?;
    for (template, folder) in PACKAGING {
        let text = read(&source.join("packaging").join(format!("{template}.in")))?;
        let up = vec![".."; depth + folder.split('/').count()].join("/");
        let text = text.replace("@UP@", &up).replace("@LIB@", folder_of_libraries);
        let text = filled(&text, &names, &installed.native_libraries);
        put(&lib.join(folder).join(template), |path| fs::write(path, &text))?;
    }
    Ok(installed)
}

/// How many folders deep a folder below the prefix is.
fn depth_of(lib: &str) -> Result<usize, StepError> {
    let parts: Vec<_> = Path::new(lib).components().collect();
    let is_below = parts.iter().all(|part| matches!(part, std::path::Component::Normal(_)));
    if parts.is_empty() || !is_below {
        return Err(StepError::Usage(format!(
            "--libdir {lib}, expected a folder below DIR, as lib64"
        )));
    }
    Ok(parts.len())
}

/// The terms of the code and of the tables in it.
const LICENSES: [&str; 3] = ["LICENSE-APACHE", "LICENSE-MIT", "LICENSE-TABLES.md"];

/// Files for other people's build systems, and where those look for them below `lib`.
const PACKAGING: [(&str, &str); 4] = [
    ("upglow.pc", "pkgconfig"),
    ("upglow-static.pc", "pkgconfig"),
    ("upglow-config.cmake", "cmake/upglow"),
    ("upglow-config-version.cmake", "cmake/upglow"),
];

/// Builds the static library; what it needs of the system.
fn build_static(root: &Path) -> Result<Vec<String>, StepError> {
    let mut command = build(root, "staticlib");
    command.args(["--print", "native-static-libs"]);
    let (_, messages) = output_and_messages_of(command)?;
    native_libraries(&messages).ok_or_else(|| {
        StepError::found(format!("no line `native-static-libs` in what rustc says:\n{messages}"))
    })
}

fn native_libraries(messages: &str) -> Option<Vec<String>> {
    let (_, list) = messages.lines().find_map(|line| line.split_once("native-static-libs:"))?;
    Some(list.split_whitespace().map(str::to_owned).collect())
}

fn build_shared(root: &Path, names: &SharedNames) -> Result<(), StepError> {
    let mut command = build(root, "cdylib");
    command.arg("-C").arg(format!("link-arg={}", names.argument));
    finish(command)
}

fn build(root: &Path, crate_type: &str) -> Command {
    let mut command = cargo(root, "rustc --release --lib --package upglow-c --color never");
    command.args(["--crate-type", crate_type, "--"]);
    command
}

fn filled(template: &str, names: &SharedNames, native_libraries: &[String]) -> String {
    let list: Vec<&str> = native_libraries.iter().map(|l| l.trim_start_matches("-l")).collect();
    template
        .replace("@VERSION@", VERSION)
        .replace("@SERIES@", series())
        .replace("@SHARED@", &names.file)
        .replace("@SONAME@", &names.soname)
        .replace("@NATIVE_LIBRARIES@", &native_libraries.join(" "))
        .replace("@NATIVE_LIBRARY_LIST@", &list.join(";"))
}

fn place(from: &Path, to: &Path) -> Result<(), StepError> {
    put(to, |path| fs::copy(from, path).map(|_| ()))
}

/// Another name for a file of the same folder.
fn alias(file: &str, name: &Path) -> Result<(), StepError> {
    put(name, |path| link(file, path))
}

#[cfg(unix)]
fn link(file: &str, path: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(file, path)
}

#[cfg(not(unix))]
fn link(file: &str, path: &Path) -> std::io::Result<()> {
    fs::copy(path.with_file_name(file), path).map(|_| ())
}

/// Makes a file under another name, then renames it: no build ever sees half a library.
fn put(path: &Path, make: impl FnOnce(&Path) -> std::io::Result<()>) -> Result<(), StepError> {
    let mut aside = path.as_os_str().to_owned();
    aside.push(format!(".{}.part", std::process::id()));
    let aside = PathBuf::from(aside);
    let result = fs::create_dir_all(path.parent().unwrap_or(path))
        .and_then(|()| make(&aside))
        .and_then(|()| fs::rename(&aside, path));
    result.map_err(|source| {
        // The failure that is reported is the first one.
        fs::remove_file(&aside).ok();
        StepError::File { path: path.into(), source }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_systems_libraries_are_those_that_rustc_names() {
        let messages = "warning: x\nnote: native-static-libs: -lm -lc\n\n";
        assert_eq!(native_libraries(messages), Some(vec!["-lm".into(), "-lc".into()]));
        assert_eq!(native_libraries("note: nothing"), None);
    }

    #[test]
    fn libraries_are_installed_below_the_prefix() {
        assert_eq!(depth_of("lib").unwrap(), 1);
        assert_eq!(depth_of("lib/x86_64-linux-gnu").unwrap(), 2);
        for lib in ["", "/usr/lib", "../lib", "."] {
            assert!(depth_of(lib).is_err(), "{lib}");
        }
    }

    #[test]
    fn every_blank_of_every_template_is_filled() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let Some(names) = SharedNames::of_this_system() else { return };
        for (template, _) in PACKAGING {
            let path = root.join(FOLDER).join("packaging").join(format!("{template}.in"));
            let text = filled(&read(&path).unwrap(), &names, &["-lm".into(), "-lc".into()]);
            let text = text.replace("@UP@", "..").replace("@LIB@", LIB);
            assert!(!text.contains('@'), "{template}: {text}");
            assert!(text.contains(series()) || template == "upglow-config.cmake", "{template}");
        }
    }
}
