//! The program `upglow-study`: the figures and claims of König et al. 2020, computed, and what the default
//! preset gives on measured surfaces.
//!
//! A command ([`commands`]) computes [`figures`], [`claims`], how surfaces look [`relight`]ed, what [`reduced`] matrices
//! make of them, or the effects of the [`rule`] of choosing, and writes them. The numbers that the
//! Python package needs too are in the library of this crate.

mod args;
mod bispectral;
mod claims;
mod commands;
mod cubes;
mod field;
mod figures;
mod lights;
mod raster;
mod reduced;
mod relight;
mod report;
mod rule;
mod samples;
mod spread;
mod svg;
mod ways;

use std::process::ExitCode;

fn main() -> ExitCode {
    upglow_terminal::run(std::env::args_os(), commands::run)
}

#[cfg(test)]
mod tests {
    mod claims;
    mod definitions;
    mod figures;
    mod reduced;
    mod relight;
    mod reradiation;
    mod rule;
}
