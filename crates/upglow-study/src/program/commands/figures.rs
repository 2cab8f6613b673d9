//! `upglow-study figures`: draws the paper's figures, and ours.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde::Serialize;
use upglow_terminal::{Console, Failure, Report, files};

use super::failure;
use crate::args::FiguresArgs;
use crate::cubes::Cubes;
use crate::figures::{Figure, FigureOptions, figures};

/// Pixels of a PNG for each of the SVG's: 170 mm at 192 pixels to the inch.
const PNG_SCALE: f32 = 2.0;

#[derive(Clone, Debug, Serialize)]
struct FiguresReport {
    folder: String,
    figures: Vec<FigureReport>,
}

#[derive(Clone, Debug, Serialize)]
struct FigureReport {
    number: u32,
    svg: String,
    png: String,
    caption: String,
}

pub(super) fn run(args: &FiguresArgs, console: &Console) -> Result<(), Failure> {
    // The folder itself is made when there is something to put in it.
    let probe = if args.out.is_dir() { args.out.join("figure.svg") } else { args.out.clone() };
    files::check_output(&probe)?;
    let options = FigureOptions { only: args.only, display: args.display };
    let cubes = Cubes::new(args.resolution);
    let drawn = console.work(args.threads, |bar| figures(&cubes, &options, bar))?;
    let drawn = drawn.map_err(failure)?;
    files::make_folder(&args.out)?;
    let written = drawn.iter().map(|figure| write(args, figure)).collect::<Result<Vec<_>, _>>()?;
    let folder = args.out.display().to_string();
    console.print(&FiguresReport { folder, figures: written })
}

fn write(args: &FiguresArgs, figure: &Figure) -> Result<FigureReport, Failure> {
    let path = |ending: &str| -> PathBuf { args.out.join(format!("{}.{ending}", figure.name)) };
    let (svg, png) = (path("svg"), path("png"));
    files::write(&svg, figure.svg.as_bytes())?;
    files::write(&png, &figure.to_png(PNG_SCALE))?;
    Ok(FigureReport {
        number: figure.number,
        svg: svg.display().to_string(),
        png: png.display().to_string(),
        caption: figure.caption.clone(),
    })
}

impl Report for FiguresReport {
    fn text(&self) -> String {
        let mut text = String::new();
        for figure in &self.figures {
            // Writing to a string does not fail.
            let _ =
                writeln!(text, "Figure {}: {}\n{}\n", figure.number, figure.svg, figure.caption);
        }
        let _ = writeln!(
            text,
            "{} figures in {}, each as SVG and PNG",
            self.figures.len(),
            self.folder
        );
        text
    }
}
