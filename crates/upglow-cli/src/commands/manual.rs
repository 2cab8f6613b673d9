//! `upglow man` and `upglow completions`, hidden: manual pages and scripts of shells, for packages of the program.

use clap::{Command, CommandFactory as _};
use clap_mangen::Man;
use serde::Serialize;
use upglow_terminal::{Console, Failure, Report};

use crate::args::{Args, CompletionsArgs, ManArgs};
use crate::files;
use crate::output::Lines;

#[derive(Clone, Debug, Serialize)]
struct Completions {
    shell: String,
    script: String,
}

#[derive(Clone, Debug, Serialize)]
struct Pages {
    files: Vec<String>,
}

/// Prints what a shell completes the command line with.
pub(crate) fn completions(args: &CompletionsArgs, console: &Console) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut shown(), "upglow", &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    console.print(&Completions { shell: args.shell.to_string(), script })
}

/// Writes a page for the program and for each command that its help lists.
pub(crate) fn man(args: &ManArgs, console: &Console) -> Result<(), Failure> {
    let mut program = shown().disable_help_subcommand(true);
    program.build();
    files::make_folder(&args.output)?;
    let mut written = Vec::new();
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let name = command.get_display_name().unwrap_or(command.get_name());
        let path = args.output.join(format!("{name}.1"));
        files::write(&path, &page(command))?;
        written.push(path.display().to_string());
    }
    console.print(&Pages { files: written })
}

/// The program with the commands that it has and its help lists.
fn shown() -> Command {
    let program = Args::command();
    let is_shown =
        |command: &&Command| !command.is_hide_set() && !command.is_disable_help_flag_set();
    let commands: Vec<Command> = program.get_subcommands().filter(is_shown).cloned().collect();
    let mut shown =
        Command::new("upglow").args(program.get_arguments().cloned()).subcommands(commands);
    shown = shown.version(env!("CARGO_PKG_VERSION"));
    shown = shown.about(program.get_about().cloned().unwrap_or_default());
    shown.after_help(program.get_after_help().cloned().unwrap_or_default())
}

fn page(command: &Command) -> Vec<u8> {
    let mut page = Vec::new();
    let source = concat!("upglow ", env!("CARGO_PKG_VERSION"));
    Man::new(command.clone())
        .source(source)
        .render(&mut page)
        .expect("writing to memory does not fail");
    page
}

impl Report for Completions {
    fn text(&self) -> String {
        self.script.clone()
    }
}

impl Report for Pages {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        for file in &self.files {
            lines.add("page", file);
        }
        lines.to_string()
    }
}
