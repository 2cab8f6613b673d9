//! The program `upglow-study`: the figures and claims of König et al. 2020, computed.
//!
//! What was typed ([`args`]) becomes figures or claims, and a command writes them. The numbers that
//! Python needs as well are in the library of this package.

mod args;
mod claims;
mod commands;
mod cubes;
mod error;
mod field;
mod figures;
mod fonts;
mod raster;
mod report;
mod spread;
mod svg;

use std::process::ExitCode;

fn main() -> ExitCode {
    upglow_terminal::run(commands::run)
}

#[cfg(test)]
mod tests {
    mod claims;
    mod figures;
}
