//! Options of the hidden commands that packages of the program are made with.

use std::path::PathBuf;

use clap_complete::Shell;

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct CompletionsArgs {
    /// The shell that the script is for
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// Folder for the pages; created if it does not exist
    #[arg(long, short, default_value = "man", value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}
