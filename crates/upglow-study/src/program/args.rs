//! The command line: each option is one field here, with its default and help.

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use upglow::Cube;
use upglow_terminal::{Console, Threads, count, in_range, word};

use crate::figures::{Display, LAST_FIGURE};

/// Computes the figures and claims of König et al. 2020, and what the default preset gives on measured surfaces.
#[derive(Clone, Debug, Parser)]
#[command(name = "upglow-study", version, max_term_width = 100)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) console: Console,
}

#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute and draw the eight figures of the paper and two of our own; takes minutes
    #[command(after_help = usage::FIGURES)]
    Figures(FiguresArgs),
    /// Measure the claims of the paper and print a Markdown report; takes minutes
    #[command(after_help = usage::REPRODUCE)]
    Reproduce(ReproduceArgs),
    /// Measure how materials made from the color of real surfaces look under other lights, beside the surfaces;
    /// takes minutes
    #[command(after_help = usage::RELIGHT)]
    Relight(RelightArgs),
    /// Measure how near 4×4 matrices, for engines without spectra, come to measured fluorescent materials under
    /// other lights
    #[command(after_help = usage::REDUCED)]
    Reduced(ReducedArgs),
    /// Measure which colors get a dye by the rule of choosing, and how much more than the least; takes
    /// minutes
    #[command(after_help = usage::RULE)]
    Rule(RuleArgs),
}

/// Examples of each command, which its help ends with.
mod usage {
    pub(super) const FIGURES: &str = "\
Examples:
  upglow-study figures -o figures
  upglow-study figures --only 4 --resolution 16 -o figures";

    pub(super) const REPRODUCE: &str = "\
Examples:
  upglow-study reproduce -o report.md";

    pub(super) const RELIGHT: &str = "\
Examples:
  upglow-study relight --only natural --only konig2020";

    pub(super) const REDUCED: &str = "\
Examples:
  upglow-study reduced --bispectral measured";

    pub(super) const RULE: &str = "\
Examples:
  upglow-study rule --resolution 16 --nodes 100";
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FiguresArgs {
    /// Folder for the SVG and PNG files; created if it does not exist
    #[arg(long, short, alias = "out", default_value = "figures", value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Draw only this figure: 1 to 8 are those of the paper, 9 and 10 are our own
    #[arg(long, value_name = "N", value_parser = in_range([1, LAST_FIGURE]))]
    pub(crate) only: Option<usize>,
    /// How colors are shown: as-srgb shows ACEScg values as if they were sRGB, as the paper does;
    /// correct converts them
    #[arg(long, default_value_t = Display::AsSrgb, value_name = "NAME", value_parser = word::<Display>())]
    pub(crate) display: Display,
    /// Number of nodes along each axis of the cubes, 2 to 256; the paper uses 32
    #[arg(long, default_value = "32", value_name = "N", value_parser = in_range(Cube::RESOLUTIONS))]
    pub(crate) resolution: usize,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ReproduceArgs {
    /// Folder of measured fluorescent materials, as .BFC files of the spectrofluorimeter BFC-450, to judge how
    /// realistic fitted ones are; without it that claim is not judged
    #[arg(long, value_name = "FOLDER")]
    pub(crate) bispectral: Option<PathBuf>,
    /// Also write the report to this file
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Number of nodes along each axis of the cubes, 2 to 256; the paper uses 32
    #[arg(long, default_value = "32", value_name = "N", value_parser = in_range(Cube::RESOLUTIONS))]
    pub(crate) resolution: usize,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RelightArgs {
    /// Folder of measured fluorescent materials, as .BFC files of the spectrofluorimeter BFC-450; without it
    /// only surfaces without fluorescence are compared
    #[arg(long, value_name = "FOLDER")]
    pub(crate) bispectral: Option<PathBuf>,
    /// Only this way to make materials, such as natural or "fluorescent, single"; may be given again
    #[arg(long, value_name = "WAY")]
    pub(crate) only: Vec<String>,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ReducedArgs {
    /// Folder of measured fluorescent materials, as .BFC files of the spectrofluorimeter BFC-450; without it
    /// none are compared
    #[arg(long, value_name = "FOLDER")]
    pub(crate) bispectral: Option<PathBuf>,
    /// Also measure how much the matrices of a cube gain without their limit: the number of nodes along each
    /// of its axes, 2 to 256
    #[arg(long, value_name = "N", value_parser = in_range(Cube::RESOLUTIONS))]
    pub(crate) resolution: Option<usize>,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RuleArgs {
    /// Number of nodes along each axis of the cubes, 2 to 256
    #[arg(long, default_value = "32", value_name = "N", value_parser = in_range(Cube::RESOLUTIONS))]
    pub(crate) resolution: usize,
    /// Number of random 8-bit colors of sRGB
    #[arg(long, default_value = "20000", value_name = "N", value_parser = count::<usize>)]
    pub(crate) colors: usize,
    /// Number of nodes with dyes for which the least dose is searched for exhaustively
    #[arg(long, default_value = "500", value_name = "N", value_parser = count::<usize>)]
    pub(crate) nodes: usize,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        Args::command().debug_assert();
    }

    #[test]
    fn every_help_ends_with_examples_that_the_program_accepts() {
        for command in Args::command().get_subcommands() {
            let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let lines: Vec<&str> = text.lines().skip(1).map(str::trim).collect();
            assert!(!lines.is_empty(), "{} has no example", command.get_name());
            for line in lines {
                let read = Args::try_parse_from(line.split(' '));
                assert!(read.is_ok(), "{line}: {}", read.unwrap_err());
            }
        }
    }
}
