//! Targets of fuzzing: what readers do with bytes that anyone may have made.
//!
//! A target is a function of bytes that returns, whatever they are: it panics where a reader panics, or where what it
//! accepted is not what it promised. The program of this crate runs each with altered files of the corpus, on any
//! compiler; `fuzz/libfuzzer` runs the same functions with the coverage that a nightly compiler measures.
//! `docs/reliability.md` says how, and what was found.

mod cube;
mod mutation;
mod names;
mod pictures;
mod server;
mod tables;

pub use mutation::{Mutator, Random};

/// What is run with bytes.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, and that of its folder in the corpus.
    pub name: &'static str,
    /// Runs it.
    pub run: fn(&[u8]),
}

const fn target(name: &'static str, run: fn(&[u8])) -> Target {
    Target { name, run }
}

/// All targets.
pub const TARGETS: [Target; 14] = [
    target("cube", cube::cube),
    target("coefficients", tables::coefficients),
    target("csv", tables::csv),
    target("dyes", tables::dyes),
    target("exr", pictures::exr),
    target("tiff", pictures::tiff),
    target("png", pictures::png),
    target("jpeg", pictures::jpeg),
    target("tga", pictures::tga),
    target("radiance", pictures::radiance),
    target("spectral", pictures::spectral),
    target("material", pictures::material),
    target("names", names::names),
    target("explorer", server::explorer),
];

/// Runs the target of this name.
///
/// # Panics
///
/// If no target has this name, or the target finds a fault.
pub fn run(name: &str, bytes: &[u8]) {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.expect("a target of the list").run)(bytes);
}

/// A message of an error is one line for people, of a limited length.
fn check_message(error: &impl std::error::Error) {
    let text = error.to_string();
    assert!(!text.contains(['\n', '\u{1b}']), "not one line: {text:?}");
    assert!(text.len() < MOST_MESSAGE_BYTES, "a message of {} bytes: {text:?}", text.len());
}

/// Longer than any message should be; the programs cut at fewer characters.
const MOST_MESSAGE_BYTES: usize = 2000;
