//! `upglow explore`: a page that shows a cube, from a server on this machine.

use std::collections::BTreeMap;
use std::process::{Command, Stdio};

use clap::CommandFactory as _;
use serde::Serialize;
use upglow::Cube;
use upglow_explorer::{BuildOption, Plan, Planner, Server, ServerError};
use upglow_fit::{BuildError, build_cube};
use upglow_terminal::{Console, Failure, Report, catch_stops, check_stopped, parse};

use crate::args::{BuildWords, ExploreArgs};
use crate::files;
use crate::output::warn;
use crate::plan::BuildPlan;

/// The options of `upglow build` that the page may give. All others are refused, so that no option can
/// name a file to write. Values that would be paths of files to read are refused by the server.
const FROM_PAGE: [&str; 21] = [
    "space",
    "illuminant",
    "observer",
    "adapt",
    "preset",
    "model",
    "dyes",
    "normalize-dyes",
    "accounting",
    "mixing",
    "quantum-yield",
    "optical-density",
    "absorption-fwhm-nm",
    "emission-fwhm-nm",
    "metric",
    "resolution",
    "slope-max-per-nm",
    "slope-under-dyes-per-nm",
    "slope-limits",
    "method",
    "sweeps",
];

#[derive(Debug, Serialize)]
struct Address<'s> {
    address: &'s str,
}

impl Report for Address<'_> {
    fn text(&self) -> String {
        format!("{}\n", self.address)
    }
}

pub(crate) fn run(args: &ExploreArgs, console: &Console) -> Result<(), Failure> {
    catch_stops();
    let planner = planner();
    let (cube, name) = match &args.cube {
        Some(path) => {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            (files::read_cube(path)?, name)
        }
        None => (default_cube(&planner, args, console)?, "the default cube".to_owned()),
    };
    let started = console.work(args.threads, |_| Server::new(cube, &name, planner, args.port))?;
    let server = started.map_err(|error| match error {
        ServerError::Port { .. } => Failure::option("--port", error),
        error => Failure::input("explore", error),
    })?;
    console.print(&Address { address: server.address() })?;
    if !args.no_open {
        open(server.address());
    }
    let ended = server.run(|| check_stopped().is_err());
    if let Err(error) = ended {
        warn(format_args!("dropped files stay in the system's temporary folder: {error}"));
    }
    Ok(())
}

fn default_cube(planner: &Planner, args: &ExploreArgs, console: &Console) -> Result<Cube, Failure> {
    let plan = (planner.plan)(&BTreeMap::new()).map_err(Failure::Usage)?;
    let Plan { contract, model, options, resolution } = plan;
    let built = console
        .work(args.threads, |bar| build_cube(&contract, &model, options, resolution, bar))?;
    built.map_err(|error| match error {
        BuildError::Stopped => Failure::Stopped,
        error => Failure::input("explore", error),
    })
}

/// Understands the options of `upglow build`, without those that name files to write.
fn planner() -> Planner {
    let command = BuildWords::command();
    let option = |arg: &clap::Arg| {
        let name = arg.get_long().filter(|name| FROM_PAGE.contains(name))?;
        let words = arg.get_possible_values();
        let has_value = arg.get_action().takes_values();
        Some(BuildOption {
            name: format!("--{name}"),
            heading: arg.get_help_heading().unwrap_or_default().into(),
            help: arg.get_help().map(ToString::to_string).unwrap_or_default(),
            default: arg.get_default_values().first().map(|v| v.to_string_lossy().into_owned()),
            words: words.iter().filter(|_| has_value).map(|w| w.get_name().into()).collect(),
            has_value,
        })
    };
    let options = command.get_arguments().filter_map(option).collect();
    Planner { options, plan: Box::new(|given| plan(given).map_err(|failure| failure.to_string())) }
}

fn plan(given: &BTreeMap<String, String>) -> Result<Plan, Failure> {
    // A value with its option in one word is never read as another option.
    let word = |(name, value): (&String, &String)| match value.as_str() {
        "" => name.clone(),
        value => format!("{name}={value}"),
    };
    let first = ["upglow build", "--output=cube"].map(String::from);
    let BuildWords { build } = parse(first.into_iter().chain(given.iter().map(word)))?;
    let BuildPlan { contract, model, options } = BuildPlan::without_output(&build)?;
    Ok(Plan { contract, model, options, resolution: build.fit.resolution })
}

/// Opens the user's browser where there is one. The address was printed, so a failure says nothing.
fn open(address: &str) {
    let command: &[&str] = if cfg!(target_os = "macos") {
        &["open"]
    } else if cfg!(windows) {
        &["rundll32", "url.dll,FileProtocolHandler"]
    } else if ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some()) {
        &["xdg-open"]
    } else {
        return;
    };
    let [program, words @ ..] = command else { return };
    let nothing = Stdio::null;
    let _ = Command::new(program)
        .args(words)
        .arg(address)
        .stdin(nothing())
        .stdout(nothing())
        .stderr(nothing())
        .spawn();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(options: &[(&str, &str)]) -> BTreeMap<String, String> {
        options.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect()
    }

    #[test]
    fn the_page_may_give_every_option_of_a_build_but_those_of_files_and_threads() {
        let command = BuildWords::command();
        let names: Vec<&str> = command.get_arguments().filter_map(clap::Arg::get_long).collect();
        let mut kept = FROM_PAGE.to_vec();
        // Lights that are dropped on the page do not end early.
        kept.extend(["output", "threads", "light-ends"]);
        kept.sort_unstable();
        let mut names = names;
        names.sort_unstable();
        assert_eq!(names, kept);
        assert_eq!(planner().options.len(), FROM_PAGE.len());
    }

    #[test]
    fn options_mean_what_they_mean_on_the_command_line() {
        let plan = |options: &[(&str, &str)]| (planner().plan)(&given(options));
        let found = plan(&[("--preset", "konig2020"), ("--slope-max-per-nm", "0.02")]).unwrap();
        assert_eq!(found.options.slope_under_dyes_per_nm, Some(0.02));
        assert_eq!((found.model.name(), found.resolution), ("dyes", 32));
        for (option, value, line) in [
            ("--preset", "fast", "--preset: "),
            ("--slope-max-per-nm", "9", "--slope-max-per-nm: slope limit 9/nm, expected"),
            ("--mixing", "separate", "--mixing: given with --model film, expected --model dyes"),
            ("--resolution", "-4", "--resolution: "),
            ("--space", "--output=x", "--space: "),
        ] {
            let error = plan(&[(option, value)]).unwrap_err();
            assert!(error.starts_with(line), "{error}");
        }
    }
}
