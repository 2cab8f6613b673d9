//! Altered files, which readers must refuse or read: the targets of `fuzz`.

use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

use crate::step::{Step, StepError, cargo, finish, finish_aloud, nightly_cargo};

/// What `cargo xtask check` does about it.
pub(crate) const STEPS: [Step; 1] =
    [Step { name: "fuzz", about: "altered files of fuzz/corpus are read or refused", run: quick }];

/// The same for an hour each, with `--slow`.
pub(crate) const SLOW_STEP: Step =
    Step { name: "slow-fuzz", about: "the same, an hour each, with --slow", run: slow };

/// For how long each target runs on any compiler, s: enough for what a change broke for good.
const QUICK_SECONDS: u64 = 3;
/// For how long with the coverage of a nightly compiler, s, where there is one with cargo-fuzz.
const NIGHTLY_SECONDS: u64 = 60;
const SLOW_SECONDS: u64 = 3600;

fn quick(root: &Path) -> Result<(), StepError> {
    on_any_compiler(root, QUICK_SECONDS)?;
    with_coverage(root, NIGHTLY_SECONDS)
}

fn slow(root: &Path) -> Result<(), StepError> {
    on_any_compiler(root, SLOW_SECONDS)?;
    with_coverage(root, SLOW_SECONDS)
}

fn on_any_compiler(root: &Path, seconds: u64) -> Result<(), StepError> {
    finish_aloud(cargo(root, &format!("run --quiet --package upglow-fuzz -- --seconds {seconds}")))
}

/// Runs the targets with libFuzzer, on all processors; where it is not installed, only says so.
fn with_coverage(root: &Path, seconds: u64) -> Result<(), StepError> {
    if finish(nightly_cargo(root, "fuzz --version")).is_err() {
        println!("check: fuzz: no nightly compiler with cargo-fuzz, so without coverage");
        return Ok(());
    }
    finish(nightly_cargo(root, "fuzz build --fuzz-dir fuzz/libfuzzer"))?;
    let waiting = Mutex::new(targets(root)?);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = || waiting.lock().ok().and_then(|mut names| names.pop());
    std::thread::scope(|scope| {
        let worker = || -> Result<(), StepError> {
            while let Some(name) = next() {
                finish(run(root, &name, seconds)?)?;
            }
            Ok(())
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let ended = workers.into_iter().map(|worker| worker.join().expect("it does not panic"));
        ended.collect::<Vec<_>>().into_iter().collect()
    })
}

/// The names of the targets of libFuzzer.
fn targets(root: &Path) -> Result<Vec<String>, StepError> {
    let folder = root.join("fuzz/libfuzzer/fuzz_targets");
    let entries = std::fs::read_dir(&folder).map_err(StepError::file(&folder))?;
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| Some(entry.path().file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    names.reverse();
    Ok(names)
}

/// One target, which starts from the kept files and from those that it found before, in `target/fuzz-found`.
fn run(root: &Path, name: &str, seconds: u64) -> Result<Command, StepError> {
    let found = root.join("target/fuzz-found").join(name);
    std::fs::create_dir_all(&found).map_err(StepError::file(&found))?;
    let mut command = nightly_cargo(root, "fuzz run --fuzz-dir fuzz/libfuzzer");
    command.arg(name).arg(&found);
    command.arg(root.join("fuzz/corpus").join(name));
    command.args(["--", "-timeout=20", "-rss_limit_mb=4096"]);
    command.arg(format!("-max_total_time={seconds}"));
    Ok(command)
}
