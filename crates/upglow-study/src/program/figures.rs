//! The paper's eight figures and two of our own, drawn from computed data.

mod chromaticity;
mod cut;
mod display;
mod dyes;
mod features;
mod gamut;
mod interpolation;
mod mixing;
mod optimizer;
mod reachability;
mod sheet;

use upglow_color::Grid;
use upglow_fit::{BuildError, Watch};
use upglow_study::konig2020;

pub(crate) use display::Display;
use display::Painter;

use crate::cubes::Cubes;
use crate::svg::Drawing;

/// A finished drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// Its number; 1 to 8 are the paper's.
    pub(crate) number: u32,
    /// The file name without its suffix: `figure-05-interpolation`.
    pub(crate) name: String,
    /// The drawing as an SVG file, 170 mm wide.
    pub(crate) svg: String,
    /// What it shows, with the measured numbers; plain text.
    pub(crate) caption: String,
}

impl Figure {
    fn new(number: u32, name: &str, drawing: Drawing, caption: String) -> Self {
        let svg = drawing.finish(&format!("Figure {number}"), &caption);
        Self { number, name: format!("figure-{number:02}-{name}"), svg, caption }
    }
}

/// What the figures are drawn from.
struct Studio<'s> {
    cubes: &'s Cubes,
    display: Display,
    watch: &'s dyn Watch,
}

impl Studio<'_> {
    /// Returns an error if the watcher has stopped the work.
    fn go_on(&self) -> Result<(), BuildError> {
        if self.watch.stopped() { Err(BuildError::Stopped) } else { Ok(()) }
    }

    /// Converts colors of the cubes, which all have the paper's contract.
    fn painter(&self) -> Painter {
        self.display.painter(&konig2020::contract().on(Grid::FIT))
    }
}

/// Draws one figure.
type Draw = fn(&Studio<'_>) -> Result<Figure, BuildError>;

/// The number of the last figure; the first is 1.
pub(crate) const LAST_FIGURE: usize = 10;

/// Every figure in the order of their numbers.
const FIGURES: [Draw; LAST_FIGURE] = [
    gamut::figure_1,
    dyes::figure_2,
    optimizer::figure_3,
    features::figure_4,
    mixing::figure_5,
    optimizer::figure_6,
    optimizer::figure_7,
    interpolation::figure_8,
    interpolation::figure_9,
    reachability::figure_10,
];

/// Draws all figures, or `only` the one with this number. Cubes that are missing are built.
///
/// The same arguments give the same bytes, on every machine and any number of threads.
///
/// # Errors
///
/// [`BuildError`] if the resolution is out of range or `watch` stopped the work.
///
/// # Panics
///
/// If there is no figure of this number.
pub(crate) fn figures(
    cubes: &Cubes,
    only: Option<usize>,
    display: Display,
    watch: &dyn Watch,
) -> Result<Vec<Figure>, BuildError> {
    let studio = Studio { cubes, display, watch };
    let chosen = only.map_or(&FIGURES[..], |number| std::slice::from_ref(&FIGURES[number - 1]));
    let draw = |figure: &Draw| {
        studio.go_on()?;
        figure(&studio)
    };
    chosen.iter().map(draw).collect()
}

/// A share as a percentage; only exact shares of 0 and 1 are written as 0.0 % and 100.0 %.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let is_rounded_off = |end: f64| percent != end && (percent - end).abs() < 0.05;
    match percent {
        _ if is_rounded_off(0.0) => "< 0.1 %".into(),
        _ if is_rounded_off(100.0) => "> 99.9 %".into(),
        _ => format!("{percent:.1} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_do_not_round_to_all_or_none() {
        let known = [(0.0, "0.0 %"), (1e-4, "< 0.1 %"), (0.5, "50.0 %"), (0.9999, "> 99.9 %")];
        for (share, text) in known.into_iter().chain([(1.0, "100.0 %")]) {
            assert_eq!(percent(share), text);
        }
    }
}
