//! Runs the targets with altered files of the corpus: `cargo run -p upglow-fuzz -- --seconds 60 cube tiff`.

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use upglow_fuzz::{Mutator, Random, TARGETS, Target};
use upglow_image::ExrReader;

const USAGE: &str = "expected --seconds N, --executions N, --seed N and names of targets";
/// A run that takes longer is a fault: files of the corpus take milliseconds.
const MOST_TIME: Duration = Duration::from_secs(20);
/// Faults of one target that are kept; more are the same ones again.
const MOST_FAULTS: usize = 10;

/// What to run, and for how long.
struct Plan {
    targets: Vec<Target>,
    /// Each target runs until this time is over or this many executions are done.
    time: Duration,
    most_runs: u64,
    seed: u64,
}

fn plan(args: impl Iterator<Item = String>) -> Result<Plan, String> {
    let time = Duration::from_secs(10);
    let mut plan = Plan { targets: Vec::new(), time, most_runs: u64::MAX, seed: 1 };
    let mut args = args.peekable();
    while let Some(arg) = args.next() {
        let mut number = || args.next().and_then(|text| text.parse().ok()).ok_or(USAGE);
        match &*arg {
            "--seconds" => plan.time = Duration::from_secs(number()?),
            "--executions" => plan.most_runs = number()?,
            "--seed" => plan.seed = number()?,
            name => {
                let target = TARGETS.iter().find(|target| target.name == name);
                let names = TARGETS.map(|target| target.name).join(", ");
                plan.targets.push(*target.ok_or(format!("no target {name}, expected {names}"))?);
            }
        }
    }
    if plan.targets.is_empty() {
        plan.targets = TARGETS.to_vec();
    }
    Ok(plan)
}

/// What became of one target.
#[derive(Default)]
struct Outcome {
    runs: u64,
    time: Duration,
    slowest: Duration,
    faults: usize,
}

/// What is running in a thread, so that what does not end can be kept.
type Running = Mutex<Option<(&'static str, Instant, Vec<u8>)>>;

fn main() -> ExitCode {
    let plan = match plan(std::env::args().skip(1)) {
        Ok(plan) => plan,
        Err(message) => {
            eprintln!("upglow-fuzz: {message}");
            return ExitCode::from(2);
        }
    };
    // A panic there is caught, and becomes an error of the file.
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !ExrReader::is_unpacking() {
            usual(info);
        }
    }));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (next, faults) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let running: Vec<Running> = (0..threads).map(|_| Mutex::new(None)).collect();
    println!(
        "{:<13} {:>12} {:>8} {:>11} {:>7}",
        "target", "executions", "time", "slowest", "faults"
    );
    std::thread::scope(|scope| {
        let workers: Vec<_> = running
            .iter()
            .map(|running| {
                scope.spawn(|| {
                    while let Some(target) = plan.targets.get(next.fetch_add(1, Ordering::Relaxed))
                    {
                        let found = attack(target, &plan, running);
                        let Outcome { runs, time, slowest, faults: count } = found;
                        faults.fetch_add(count, Ordering::Relaxed);
                        let (time, slowest) = (time.as_secs(), slowest.as_millis());
                        println!(
                            "{:<13} {runs:>12} {time:>6} s {slowest:>8} ms {count:>7}",
                            target.name
                        );
                    }
                })
            })
            .collect();
        while !workers.iter().all(std::thread::ScopedJoinHandle::is_finished) {
            std::thread::sleep(Duration::from_millis(100));
            running.iter().for_each(end_if_stuck);
        }
    });
    ExitCode::from(u8::from(faults.into_inner() > 0))
}

/// Ends the program if what runs does not end by itself.
fn end_if_stuck(running: &Running) {
    let Ok(running) = running.lock() else { return };
    if let Some((name, start, bytes)) = &*running
        && start.elapsed() > MOST_TIME
    {
        let path = keep(name, bytes);
        println!("{name}: over {} s: {}", MOST_TIME.as_secs(), path.display());
        std::process::exit(1);
    }
}

/// Runs a target with altered files until the time is over.
fn attack(target: &Target, plan: &Plan, running: &Running) -> Outcome {
    let files = corpus(target.name);
    let mut mutator = Mutator::new(files, Random::new(plan.seed));
    let start = Instant::now();
    let mut outcome = Outcome::default();
    let mut messages = BTreeSet::new();
    let goes_on = |runs| runs < plan.most_runs && start.elapsed() < plan.time;
    while goes_on(outcome.runs) && messages.len() < MOST_FAULTS {
        let bytes = mutator.next_file();
        let from = Instant::now();
        if let Ok(mut running) = running.lock() {
            *running = Some((target.name, from, bytes.clone()));
        }
        let ended = catch_unwind(AssertUnwindSafe(|| (target.run)(&bytes)));
        outcome.slowest = outcome.slowest.max(from.elapsed());
        outcome.runs += 1;
        if let Err(cause) = ended {
            let text = cause.downcast_ref::<String>().cloned();
            let text = text.or(cause.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            // The numbers in a message differ from file to file.
            let text = text.unwrap_or_default().replace(|c: char| c.is_ascii_digit(), "");
            let is_new = messages.insert(text.chars().take(80).collect::<String>());
            outcome.faults += 1;
            if is_new {
                println!("{}: kept as {}", target.name, keep(target.name, &bytes).display());
            }
        }
    }
    if let Ok(mut running) = running.lock() {
        *running = None;
    }
    outcome.time = start.elapsed();
    outcome
}

/// The kept files of a target; a single empty one if there are none.
fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    let files: Vec<Vec<u8>> = paths.iter().filter_map(|path| fs::read(path).ok()).collect();
    if files.is_empty() { vec![Vec::new()] } else { files }
}

/// Keeps the bytes that a target failed with, under a name that depends on them.
fn keep(name: &str, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fuzz-faults");
    let sum = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let path = folder.join(format!("{name}-{sum:016x}"));
    if let Err(error) = fs::create_dir_all(&folder).and_then(|()| fs::write(&path, bytes)) {
        println!("{}: {error}", path.display());
    }
    path
}
