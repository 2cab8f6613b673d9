//! The paper's eight figures and two of our own, drawn from what is computed here.

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

use upglow_fit::{BuildError, Watch};

pub(crate) use display::Display;

use crate::cubes::Cubes;
use crate::error::StudyError;
use crate::raster;
use crate::svg::Drawing;

/// A drawing, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// Its number; 1 to 8 are the paper's.
    pub(crate) number: u32,
    /// A file's name without its ending: `figure-05-interpolation`.
    pub(crate) name: String,
    /// The drawing as an SVG file, 170 mm wide.
    pub(crate) svg: String,
    /// What it shows, with the numbers measured; plain text.
    pub(crate) caption: String,
}

impl Figure {
    /// The drawing as a PNG file on white; at `scale` 1 there are 96 pixels to an inch.
    ///
    /// The typeface is embedded: the picture is the same on every machine.
    ///
    /// # Panics
    ///
    /// If `scale` is not positive, or [`Figure::svg`] was replaced by something else than SVG.
    pub(crate) fn to_png(&self, scale: f32) -> Vec<u8> {
        raster::rendered(&self.svg, scale)
    }

    fn new(number: u32, name: &str, drawing: Drawing, caption: String) -> Self {
        let svg = drawing.finish(&format!("Figure {number}"), &caption);
        Self { number, name: format!("figure-{number:02}-{name}"), svg, caption }
    }
}

/// Which figures, and in what colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FigureOptions {
    /// One number, 1 to 10, or all.
    pub(crate) only: Option<u32>,
    /// How colors of the cube become colors of the page.
    pub(crate) display: Display,
}

/// What the figures are drawn from.
struct Studio<'s> {
    cubes: &'s Cubes,
    display: Display,
    watch: &'s dyn Watch,
}

impl Studio<'_> {
    /// Nothing, or an error where the watcher wants no more.
    fn go_on(&self) -> Result<(), StudyError> {
        if self.watch.stopped() { Err(BuildError::Stopped.into()) } else { Ok(()) }
    }
}

/// Draws one figure.
type Draw = fn(&Studio<'_>) -> Result<Figure, StudyError>;

/// Every figure in the order of their numbers.
const FIGURES: [Draw; 10] = [
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

/// Draws the figures; the cubes they need are built where they are not there yet.
///
/// The same cubes and options give the same bytes, on every machine and any number of threads.
///
/// # Errors
///
/// [`StudyError`] if there is no such figure, a cube is not to be had, or `watch` stopped the work.
pub(crate) fn figures(
    cubes: &Cubes,
    options: &FigureOptions,
    watch: &dyn Watch,
) -> Result<Vec<Figure>, StudyError> {
    let studio = Studio { cubes, display: options.display, watch };
    let chosen = match options.only {
        None => &FIGURES[..],
        Some(found) => {
            let index = usize::try_from(found).unwrap_or(usize::MAX).wrapping_sub(1);
            let last = FIGURES.len();
            let figure = FIGURES.get(index).ok_or(StudyError::UnknownFigure { found, last })?;
            std::slice::from_ref(figure)
        }
    };
    let draw = |figure: &Draw| {
        studio.go_on()?;
        figure(&studio)
    };
    chosen.iter().map(draw).collect()
}

/// A share as a percentage for people: none and all are said of nothing else.
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
