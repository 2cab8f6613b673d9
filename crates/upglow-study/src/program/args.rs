//! What was typed.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use upglow::Cube;
use upglow_terminal::{in_range, threads};

use crate::figures::Display;

/// The figures and claims of König et al. 2020, computed.
#[derive(Clone, Debug, Parser)]
#[command(name = "upglow-study", version, max_term_width = 100)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print one JSON document instead of text
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Show no progress
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw the paper's eight figures from real computation, and two of ours; minutes
    Figures(FiguresArgs),
    /// Measure the paper's claims and print a report in Markdown; minutes
    Reproduce(ReproduceArgs),
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FiguresArgs {
    /// Folder for the SVG and PNG files; made if it is not there
    #[arg(long, default_value = "figures", value_name = "FOLDER")]
    pub(crate) out: PathBuf,
    /// Draw one figure only: 1 to 8 are the paper's, 9 and 10 ours
    #[arg(long, value_name = "N")]
    pub(crate) only: Option<u32>,
    /// Colors: as-srgb (ACEScg numbers shown as sRGB, as in the paper) or correct (color-managed)
    #[arg(long, default_value = "as-srgb", value_name = "NAME")]
    pub(crate) display: Display,
    /// Nodes along each axis of the cubes, 2 to 256; the paper has 32
    #[arg(long, default_value = "32", value_name = "N", value_parser = resolution)]
    pub(crate) resolution: usize,
    /// Threads; the files do not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ReproduceArgs {
    /// Write the report to this file too
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Nodes along each axis of the cubes, 2 to 256; the paper has 32
    #[arg(long, default_value = "32", value_name = "N", value_parser = resolution)]
    pub(crate) resolution: usize,
    /// Threads; the report does not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

fn resolution(text: &str) -> Result<usize, String> {
    in_range(Cube::RESOLUTIONS, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        Args::command().debug_assert();
    }
}
