//! The program `upglow`: RGB colors to physically valid spectral materials with fluorescence.
//!
//! What was typed (`args`) becomes what is to be done (`plan`), and a command does it. Data goes to
//! standard output, progress, warnings and errors to standard error.

mod args;
mod commands;
mod files;
mod output;
mod pictures;
mod plan;
mod plot;

use std::process::ExitCode;

fn main() -> ExitCode {
    keep_quiet_about_damaged_files();
    upglow_terminal::run(commands::run)
}

/// A damaged OpenEXR block ends in an error of one line, not in a panic's message before it.
fn keep_quiet_about_damaged_files() {
    let speak = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !upglow_image::ExrReader::is_unpacking() {
            speak(panic);
        }
    }));
}
