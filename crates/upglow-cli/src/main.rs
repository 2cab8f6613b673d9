//! The program `upglow`: RGB colors to physically valid spectral materials with fluorescence.
//!
//! The command line (`args`) is checked and resolved (`plan`), and a command (`commands`) does the
//! work. Data goes to standard output; progress, warnings and errors go to standard error.

mod args;
mod batch;
mod color_list;
mod commands;
mod farm;
mod files;
mod metamers;
mod name_pattern;
mod output;
mod pictures;
mod plan;
mod plot;

use std::process::ExitCode;

fn main() -> ExitCode {
    silence_panics_of_damaged_files();
    upglow_terminal::run(args::with_cube_first(std::env::args_os()), commands::run)
}

/// The OpenEXR decoder may panic on a damaged block; the panic is caught and reported as an error,
/// so its own message is not printed.
fn silence_panics_of_damaged_files() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !upglow_image::ExrReader::is_unpacking() {
            print(panic);
        }
    }));
}
