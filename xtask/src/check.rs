//! `cargo xtask check`: every step, in order, the fast ones first.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::step::{Step, StepError, cargo, finish, finish_aloud, output_of};
use crate::{
    c_library, explorer, fuzz, guide, layers, links, packages, python, python_wheel, site, tables,
    words,
};

/// Set for the slow tests, so that they may take larger samples.
const SLOW_VARIABLE: &str = "UPGLOW_SLOW";

const OPTIONS: &str = "--list, --only STEP, --from STEP, --keep-going, --slow";

const STEPS: [Step; 9] = [
    Step { name: "format", about: "cargo fmt changes nothing", run: format },
    Step { name: "tables", about: "the generated tables are those of tables/", run: tables::check },
    Step { name: "layers", about: "no crate uses one above it", run: layers::check },
    Step { name: "clippy", about: "no warnings of clippy and the compiler", run: clippy },
    Step { name: "docs", about: "no warnings of rustdoc", run: docs },
    Step {
        name: "python",
        about: "a Python environment for tests, in target/python",
        run: python_for_tests,
    },
    Step { name: "tests", about: "the tests that are not slow", run: quick_tests },
    Step { name: "guide", about: "the examples of docs/guide.md work", run: guide::check },
    Step { name: "licenses", about: "licenses and sources of the dependencies", run: licenses },
];

const SLOW_STEPS: [Step; 2] = [
    Step { name: "slow-tests", about: "the tests named slow_*, with --slow", run: slow_tests },
    fuzz::SLOW_STEP,
];

/// Every step; the slow ones are the last.
fn all_steps() -> Vec<Step> {
    let bindings = c_library::STEPS.into_iter().chain(python_wheel::STEPS);
    let texts = words::STEPS.into_iter().chain(links::STEPS).chain(site::STEPS);
    let others = texts.chain(packages::STEPS).chain(explorer::STEPS).chain(fuzz::STEPS);
    STEPS.into_iter().chain(others).chain(bindings).chain(SLOW_STEPS).collect()
}

/// The steps and options that the command line names.
#[derive(Clone, Debug, Default)]
struct Plan {
    steps: Vec<Step>,
    keep_going: bool,
    list: bool,
}

impl Plan {
    fn new(mut args: &[&str]) -> Result<Self, StepError> {
        let steps = all_steps();
        let find = |name: &str| {
            steps.iter().position(|step| step.name == name).ok_or_else(|| {
                let names: Vec<&str> = steps.iter().map(|step| step.name).collect();
                StepError::Usage(format!("no step {name}, expected {}", names.join(", ")))
            })
        };
        let mut plan = Self::default();
        let (mut only, mut from, mut slow) = (Vec::new(), 0, false);
        while let Some((&option, rest)) = args.split_first() {
            args = rest;
            match (option, rest) {
                ("--list", _) => plan.list = true,
                ("--keep-going", _) => plan.keep_going = true,
                ("--slow", _) => slow = true,
                ("--only", [name, rest @ ..]) => {
                    only.push(find(name)?);
                    args = rest;
                }
                ("--from", [name, rest @ ..]) => {
                    from = find(name)?;
                    args = rest;
                }
                _ => {
                    let problem = format!("check: {option}, expected {OPTIONS}");
                    return Err(StepError::Usage(problem));
                }
            }
        }
        let is_usual = |step: &Step| slow || SLOW_STEPS.iter().all(|other| other.name != step.name);
        let is_asked_for = |&(place, step): &(usize, &Step)| match only[..] {
            [] => place >= from && (plan.list || is_usual(step)),
            _ => only.contains(&place),
        };
        plan.steps = steps.iter().enumerate().filter(is_asked_for).map(|(_, step)| *step).collect();
        Ok(plan)
    }
}

/// Runs `cargo xtask check` with these arguments; whether every step passed.
pub(crate) fn run(root: &Path, args: &[&str]) -> Result<bool, StepError> {
    let plan = Plan::new(args)?;
    if plan.list {
        for Step { name, about, .. } in &plan.steps {
            println!("{name:<16} {about}");
        }
        return Ok(true);
    }
    Ok(run_steps(root, &plan.steps, plan.keep_going))
}

/// Runs some steps, up to the first failure or all; prints a line for each, and a summary.
pub(crate) fn run_steps(root: &Path, steps: &[Step], keep_going: bool) -> bool {
    let (mut reasons, mut failed) = (Vec::new(), Vec::new());
    for Step { name, run, .. } in steps {
        let start = Instant::now();
        let result = run(root);
        let time_s = start.elapsed().as_secs_f64();
        match result {
            Ok(()) => println!("check: {name} ok, {time_s:.1} s"),
            Err(StepError::Skipped(reason)) => {
                println!("check: {name} skipped: {reason}");
                reasons.push(reason);
            }
            Err(error) => {
                println!("{error}\ncheck: {name} failed after {time_s:.1} s");
                failed.push(*name);
                if !keep_going {
                    return false;
                }
            }
        }
    }
    println!("{}", summary(steps.len(), &reasons, &failed));
    failed.is_empty()
}

fn summary(steps: usize, reasons: &[&str], failed: &[&str]) -> String {
    let mut text = format!("check: {} steps ok", steps - reasons.len() - failed.len());
    for (names, what) in [(reasons, "skipped"), (failed, "failed")] {
        if !names.is_empty() {
            text += &format!(", {} {what} ({})", names.len(), names.join("; "));
        }
    }
    text
}

fn format(root: &Path) -> Result<(), StepError> {
    finish(cargo(root, "fmt --all --check -- --color never"))
}

fn clippy(root: &Path) -> Result<(), StepError> {
    finish(cargo(root, "clippy --workspace --all-targets --all-features -- -D warnings"))
}

fn docs(root: &Path) -> Result<(), StepError> {
    let mut command = cargo(root, "doc --workspace --no-deps");
    command.env("RUSTDOCFLAGS", "-D warnings");
    finish(command)
}

/// Tests that need it skip themselves, by name, where it is absent.
fn python_for_tests(root: &Path) -> Result<(), StepError> {
    python::prepare(root).map(|_| ())
}

fn quick_tests(root: &Path) -> Result<(), StepError> {
    finish_aloud(tests(root, "test --workspace --features upglow-cli/explore")?)
}

fn slow_tests(root: &Path) -> Result<(), StepError> {
    let mut command =
        tests(root, "test --workspace --features upglow-cli/explore -- --ignored slow_")?;
    command.env(SLOW_VARIABLE, "1");
    finish_aloud(command)
}

fn tests(root: &Path, args: &str) -> Result<Command, StepError> {
    let mut command = cargo(root, args);
    match python::prepare(root) {
        Ok(interpreter) => command.env(python::VARIABLE, interpreter),
        Err(StepError::Skipped(_)) => &mut command,
        Err(error) => return Err(error),
    };
    Ok(command)
}

fn licenses(root: &Path) -> Result<(), StepError> {
    if output_of(cargo(root, "deny --version")).is_err() {
        return Err(StepError::Skipped("cargo-deny not installed"));
    }
    // The offline check reads the manifests of every platform's crates; a build fetches only its own.
    finish(cargo(root, "fetch --locked"))?;
    finish(cargo(root, "deny --offline check licenses bans sources"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(args: &[&str]) -> Vec<&'static str> {
        Plan::new(args).unwrap().steps.iter().map(|step| step.name).collect()
    }

    #[test]
    fn the_summary_counts_steps_and_names_what_was_skipped() {
        assert_eq!(summary(2, &[], &[]), "check: 2 steps ok");
        assert_eq!(
            summary(3, &["cargo-deny not installed"], &["docs"]),
            "check: 1 steps ok, 1 skipped (cargo-deny not installed), 1 failed (docs)"
        );
    }

    #[test]
    fn steps_are_chosen_by_name_and_run_in_their_order() {
        assert_eq!(names(&["--only", "docs", "--only", "format"]), ["format", "docs"]);
        assert_eq!(names(&["--slow"]).last(), Some(&"slow-fuzz"));
        assert!(!names(&[]).contains(&"slow-tests"));
        assert_eq!(names(&["--only", "slow-tests"]), ["slow-tests"]);
        let from = names(&["--from", "licenses", "--keep-going"]);
        assert_eq!((from[0], from.len()), ("licenses", names(&[]).len() - 8));
    }

    #[test]
    fn an_unknown_step_or_option_names_the_choices() {
        let error = |args: &[&str]| Plan::new(args).unwrap_err().to_string();
        assert!(error(&["--only", "doc"]).starts_with("no step doc, expected format, tables, "));
        assert!(error(&["--fast"]).starts_with("check: --fast, expected --list, "));
        assert!(error(&["--from"]).starts_with("check: --from, expected "));
    }

    #[test]
    fn every_failure_is_told_and_the_others_are_run_on_request() {
        let step = |name, run| Step { name, about: "", run };
        let fails = step("a", |_| Err(StepError::found("no")));
        let passes = step("b", |_| Ok(()));
        let skips = step("c", |_| Err(StepError::Skipped("none")));
        assert!(!run_steps(Path::new("."), &[fails, passes], true));
        assert!(run_steps(Path::new("."), &[passes, skips], false));
    }
}
