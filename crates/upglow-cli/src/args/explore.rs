//! The options of `upglow explore`.

use std::path::PathBuf;

use clap::Parser;
use upglow_terminal::{Threads, parsed};

use super::NamedCube;
use super::build::BuildArgs;

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ExploreArgs {
    /// Cube made by `upglow build` [default: one with the default options of `upglow build`]
    pub(crate) cube: Option<PathBuf>,
    #[command(flatten)]
    _named_cube: NamedCube,
    /// Port of this machine that the page is at [default: any free one]
    #[arg(long, default_value = "0", hide_default_value = true, value_name = "N", value_parser = port)]
    pub(crate) port: u16,
    /// Only print the address of the page, do not open a browser
    #[arg(long)]
    pub(crate) no_open: bool,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

fn port(text: &str) -> Result<u16, String> {
    parsed(text, format_args!("a port from 0 to {}", u16::MAX))
}

/// The options of a build that come from the page.
#[derive(Clone, Debug, Parser)]
#[command(name = "upglow build", disable_help_flag = true)]
pub(crate) struct BuildWords {
    #[command(flatten)]
    pub(crate) build: BuildArgs,
}
